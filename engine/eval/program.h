// A graph snapshot made ready for evaluation: nodes by number, inputs resolved to literals, curves and
// sources, and the answer to "does this change over time?" for each node. Holds the keys and frame chains
// found so far.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/file_digests.h"
#include "engine/graph.h"

#include <unordered_map>
#include <unordered_set>

namespace sinew::engine {

struct Entry;

struct Source {
    int node = -1, output = -1;
    /// When it is read: at the reader's time, at a whole frame beside it, or at the graph's first.
    enum class At { time, frame_before, frame_after, start } at = At::time;
};

/// Whether some key of a switch puts it on.
bool is_ever_on(const Curve& curve);

/// One declared input of one node.
struct Slot {
    enum class Kind { none, constant, curve, wire, list };
    const AttributeInfo* info = nullptr;
    Kind kind = Kind::none;
    Value constant;
    const Curve* curve = nullptr;
    std::vector<Source> sources;
    /// The literal or key value at a frame.
    Value sample(double frame) const;
    Digest digest_at(double frame) const;
    /// Of a switch that looks ahead (Input::looks_ahead).
    bool is_ever_on() const;
    /// The digest of what the slot holds now, for keys; of a switch that looks ahead with what it will be.
    Digest ahead_digest(const Value& now) const;
    bool read_by_compute() const { return info->affects != Affects::nothing; }
};

struct Place {
    std::string name;
    const Node* node = nullptr;
    const NodeType* type = nullptr;
    std::vector<Slot> slots; ///< in the order of the type's inputs
    bool uses_frame = false; ///< compute may ask for the frame
    bool dynamic = false;    ///< the value can differ between frames
    int start_frame = 0;     ///< simulations
    int substeps_slot = -1, stages_slot = -1;
    bool after_simulation = false; ///< depends on a simulation other than itself
    std::optional<Digest> static_key;
    std::vector<Digest> chain;     ///< simulations: S(start), S(start + 1), …
    std::optional<Digest> reached; ///< simulations: the key of the state that they were last brought to
    std::vector<Diagnostic> problems;
    bool is_simulation() const { return type && type->simulation; }
    /// The node asks for its outputs to be kept on disk.
    bool is_kept() const;
};

/// A node at a frame; for nodes that do not change over time the frame is always 0.
struct Site {
    int node = -1;
    double frame = 0;
    friend bool operator==(const Site&, const Site&) = default;
};
struct SiteHash {
    std::size_t operator()(const Site& s) const {
        return std::hash<double>()(s.frame) * 1000003u ^ std::hash<int>()(s.node);
    }
};

class Program {
  public:
    explicit Program(std::shared_ptr<const Graph> graph);
    const std::shared_ptr<const Graph>& graph() const { return graph_; }
    Place& place(int node) { return places_[static_cast<std::size_t>(node)]; }
    const Place& place(int node) const { return places_[static_cast<std::size_t>(node)]; }
    int find(std::string_view name) const; ///< -1 if there is none
    /// Throws Failure for a fraction of a frame on a simulation.
    Site site(int node, double frame) const;
    Site site(const Source& s, double frame) const;
    int substeps(const Place& p, int frame) const;
    /// Fractions of the sub-step that ends at `time` at which a simulation reads its inputs too.
    std::vector<double> stages(const Place& p, double time) const;
    /// Everything that the node needs, itself included, sources first. Throws Failure on a cycle, a node of
    /// unknown type or a missing input. Computed once a node.
    const std::vector<int>& cone(int node) { return known_cone(node).nodes; }
    /// Whether what the cone of `node` reads of a simulation's outputs is among those that an entry has. The entry is
    /// of `simulation`; `output` of `node` itself is read too.
    bool suffices(int node, int output, int simulation, const Entry& entry);
    /// The files that the cone names.
    std::vector<std::string> file_paths(int node);
    /// Puts the files' contents into the keys. False if one has changed since this program first saw it: the
    /// program is then out of date as a whole. Throws Failure if files are missing.
    bool set_files(int node, const FileContents& contents);
    /// A diagnostic about this node, placed in the graph file as exactly as possible.
    Diagnostic about(const Place& p, std::string_view attribute, std::string_view code, std::string message,
                     std::string hint = {}) const;

    /// Everything that the graph says and that enters a node's key: each input upstream with its content, by name. For
    /// people and `explain`; keys hold no names.
    std::vector<std::pair<std::string, Digest>> recipe(int node, double frame);

    /// The states that its simulations were last brought to.
    std::vector<Digest> reached() const;
    /// Takes those of a program with the same nodes, for simulations that have not been run in this one.
    void carry_reached(const Program& from);

    /// Keys whose warnings have reached the observer.
    std::unordered_set<Digest, DigestHash> delivered;
    /// True once something was pulled through this snapshot; explain compares against such.
    bool pulled = false;

  private:
    struct Cone {
        std::vector<int> nodes;
        std::vector<std::pair<int, int>> files; ///< (node, slot) of each literal that names a file
        std::vector<std::pair<int, int>> reads; ///< (simulation, output) of each connection to one
    };
    Cone make_cone(int node);
    const Cone& known_cone(int node);
    void resolve(Place& p);
    void find_times(Place& p);
    std::int64_t entry_place(const Place& p, const AttributeInfo& info, const Value& name) const;
    std::shared_ptr<const Graph> graph_;
    std::vector<Place> places_;
    std::unordered_map<std::string, int> index_;
    std::unordered_map<int, Cone> cones_;
};

/// Fills in node, attribute, the best known spot and the severity's default.
void locate(Diagnostic& d, const Graph& graph, const std::string& node);

} // namespace sinew::engine
