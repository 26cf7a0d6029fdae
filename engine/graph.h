// Immutable graph snapshots and edits. An edit gives a new snapshot and its inverse; the base is untouched.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/curve.h"
#include "engine/file_access.h"
#include "engine/registry.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sinew::engine {

/// "biceps.outBody"
struct Plug {
    std::string node, attribute;
    friend auto operator<=>(const Plug&, const Plug&) = default;
    std::string text() const { return node + "." + attribute; }
};

/// What stands at an input: a literal, a keyed curve, a connection, or a list of connections.
using Binding = std::variant<Value, Curve, Plug, std::vector<Plug>>;

struct NodeOrigin;
struct SourceText;
class Graph;

/// What a person wrote beside the data of a graph file; written again with the graph.
struct Remark {
    std::vector<std::string> lines; ///< "// …" and "/* … */", in front of it
    std::vector<std::string> last;  ///< the same, behind all that it holds
    std::string json;               ///< the value of its key "comment", as it stood; empty: it has none
};
using Remarks = std::map<std::string, Remark, std::less<>>;

struct Node {
    std::string type_name;
    const NodeType* type = nullptr; ///< nullptr: a type that this program does not know; fails only when pulled
    std::map<std::string, Binding, std::less<>> inputs; ///< only what the file or an edit set
    std::string raw_json;                               ///< unknown types: the node as it stood in the file
    std::vector<std::string> input_order;               ///< the order in which a file lists `inputs`
    Remarks remarks;                                    ///< by input; "" for the node itself
    std::shared_ptr<const NodeOrigin> origin;           ///< where it stood in a file; nullptr if it came from an edit
    /// Of included nodes: the inputs that this graph sets instead of the included one, each with its place in this
    /// graph's file, or npos if it came from an edit. `remarks` are then those of the overrides.
    std::map<std::string, std::size_t, std::less<>> overrides;
};

/// A graph whose nodes stand in another one under a prefix: its node "biceps" is "left.biceps" there.
struct Include {
    std::string file;                        ///< the path to open
    std::shared_ptr<const Graph> graph;      ///< as the file says, what it includes itself in it
    std::vector<std::string> override_order; ///< "node.attribute", as the file lists them
    Remark remark;
    std::shared_ptr<const SourceText> source; ///< of the including file
    std::size_t at = 0;                       ///< of the prefix in it
};

/// "left.arm.biceps" -> "left" and "arm.biceps"; of a graph's own node the prefix is empty.
struct IncludedName {
    std::string_view prefix, name;
};
IncludedName included_name(std::string_view node);
inline bool is_included(std::string_view node) { return node.find('.') != std::string_view::npos; }

struct Timing {
    double fps = 24;
    int start = 1, end = 1;
};

/// What a literal input holds that nothing was given.
Value default_value(const AttributeInfo& input, const Timing& timing);

class Graph {
  public:
    explicit Graph(std::shared_ptr<const Registry> registry);
    const Registry& registry() const { return *registry_; }
    const std::shared_ptr<const Registry>& registry_ptr() const { return registry_; }
    /// nullptr if there is none.
    const Node* find(std::string_view name) const;
    std::vector<std::string> node_names() const; ///< in file order, included ones first
    /// By prefix, in file order.
    const std::vector<std::pair<std::string, std::shared_ptr<const Include>>>& includes() const { return includes_; }
    const Include* find_include(std::string_view prefix) const; ///< nullptr if there is none
    /// What stands at an input of an included node as long as this graph does not override it; nothing if the included
    /// graph leaves it at its default. Names are those of this graph.
    std::optional<Binding> included_binding(std::string_view node, std::string_view attribute) const;
    const Timing& timing() const { return timing_; }
    const std::string& file() const { return file_; }
    /// How the files are opened that it names.
    const FileAccess& files() const { return files_; }
    const std::string& editor_json() const { return editor_json_; }
    /// By top-level key of the file; "" for its end. "$schema" has its value for `json`.
    const Remarks& remarks() const { return remarks_; }
    /// Where an input (or a node, with an empty attribute) stands in the graph file, if it came from one; of included
    /// nodes in the included file, or in the one that overrides the input.
    std::optional<SourceSpot> spot(std::string_view node, std::string_view attribute = {}) const;

  private:
    friend class Edit;
    friend class GraphReader;
    std::shared_ptr<const Registry> registry_;
    std::vector<std::string> order_;
    std::map<std::string, std::shared_ptr<const Node>, std::less<>> nodes_; ///< shared between snapshots
    std::vector<std::pair<std::string, std::shared_ptr<const Include>>> includes_;
    Timing timing_;
    std::string file_, editor_json_ = "{}";
    FileAccess files_;
    Remarks remarks_;
};

/// A transaction: all or nothing. Every call is checked at commit, and all problems are thrown at once as
/// Failure.
class Edit {
  public:
    struct Done; // {graph, inverse}
    explicit Edit(std::shared_ptr<const Graph> base);
    Edit& add_node(std::string name, std::string type);
    Edit& remove_node(std::string name);                 ///< a node of its own: what is included stays as its file says
    Edit& rename_node(std::string from, std::string to); ///< connections follow; not what is included
    Edit& set(Plug input, Binding binding);
    /// `json` is what a graph file would hold at this input: literal, {value, unit}, {keys}, {from}, [ … ].
    Edit& set_json(Plug input, std::string json);
    Edit& set_key(Plug input, double frame,
                  double value); ///< adds or replaces one key; a literal becomes a curve
    /// What a host sends frame by frame: at `frame` the input holds `value`, and from there on until the next frame
    /// that was sent, in whatever order they are, or the next key of the graph. Up to the whole frame before,
    /// everything stays as it is, to the bit; in between sub-steps interpolate (stepped for bool, integers and words;
    /// matrices turn as recorded motion does). So a simulation goes on from frame-1, and the same values sent again
    /// find the same frames. Kept as keys: a literal becomes a curve. DG043 where a curve would have to be cut between
    /// two keys of different values, or is smooth: earlier frames could not stay.
    Edit& set_input(Plug input, double frame, Value value);
    Edit& reset(Plug input); ///< back to the default, disconnected; of included nodes to what their file says
    Edit& set_editor_json(std::string json);
    Edit& set_timing(Timing timing);
    Done commit() const;
    /// Applies the same operations to another snapshot; how an inverse is used.
    Edit rebased(std::shared_ptr<const Graph> base) const;

  private:
    struct Operation;
    class Draft;
    Edit& push(Operation op);
    std::shared_ptr<const Graph> base_;
    std::vector<std::shared_ptr<const Operation>> operations_;
};

struct Edit::Done {
    std::shared_ptr<const Graph> graph;
    std::shared_ptr<const Edit> inverse; ///< based on `graph`; inverse->commit() restores the base
};

/// The path "a.out -> b.in … -> a" of a connection cycle, or empty.
std::string find_cycle(const Graph& graph);

} // namespace sinew::engine
