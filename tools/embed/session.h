// What a host program holds: a graph, what has been computed of it, and what the host sends. The C interface and the
// Python module are thin layers on it; hosts in C++ may use it or the engine itself.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "nodes/values.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace sinew::embed {

/// The host asks for something that cannot be (codes DG12x and wrong plugs): its code is to be repaired, not the graph.
class Misuse : public engine::Failure {
  public:
    using Failure::Failure;
    Misuse(std::string code, std::string message, std::string hint, engine::Plug at = {});
};

struct Options {
    /// Node types; null: Sinew's own. A host adds types of its own to nodes::register_all's.
    std::shared_ptr<const engine::Registry> registry = {};
    int threads = 0;              ///< 0: all of the machine
    std::size_t memory_bytes = 0; ///< for results that are kept; 0: a quarter of the machine's
    /// Where frames are kept for later processes; made when first written to. Empty: nowhere.
    std::string cache_folder = {};
    std::uintmax_t cache_bytes = std::uintmax_t{10} << 30;
    /// The only folder in which files are opened and written that graphs and the host name, wherever "..", absolute
    /// paths and links lead. Empty: anywhere. Failure IO411 where there is none, IO410 about a path that leads out.
    std::string root_folder = {};
};

/// What has been done since the session began. Look-ups cost nothing and count as reused.
struct Counts {
    std::int64_t simulated = 0; ///< steps of simulations, the start frame among them
    std::int64_t computed = 0;  ///< other nodes that ran
    std::int64_t reused = 0;    ///< results that were there
};

/// A value as hosts hold it: numbers, or a text. One number is a switch, a whole number or a number, three are a
/// vector, 16 a matrix row by row; a text is a word, a text, the path of a file or a number with its unit.
using HostValue = std::variant<std::vector<double>, std::string>;

struct Setting {
    engine::Plug input; ///< node and attribute
    HostValue value;
};

/// A mesh that the host sends, in scene units. Faces are wanted once for each node; later calls may leave them out.
struct HostMesh {
    std::span<const double> points;     ///< x, y, z of each vertex
    std::span<const int> face_sizes;    ///< corners of each face; empty: triangles
    std::span<const int> face_vertices; ///< corners, face after face; empty: the faces stay
};

/// What one evaluation gave. Owns all that it shows, whatever becomes of the session.
struct Frame {
    engine::Plug plug;
    double number = 0;
    engine::Value value;
    std::vector<nodes::Mesh> meshes;              ///< those in the value
    std::vector<std::string> names;               ///< of the meshes: the bodies' nodes; as many
    std::optional<engine::Value> report;          ///< nodes::SolveReport of the solver that the plug depends on
    std::vector<std::string> bodies, attachments; ///< of that solver, in its order
    /// Place of the mesh of that name; none if there is none.
    std::optional<std::size_t> find(std::string_view name) const;
    /// The report's numbers as JSON on one line: those of a frame in `sinew run --report`, and "size". "{}" where no
    /// solver is involved.
    std::string report_json() const;
};

/// Thread-safe: edits come one after the other, evaluations run side by side and each sees the graph as it was when it
/// began. Throws Failure with every problem (Misuse where the call itself is wrong), SolveFailure, Cancelled.
class Session {
  public:
    /// \param watch told of what goes on, from worker threads, one call at a time; may not call the session but for
    /// cancel(), counts() and graph() (Misuse DG140). What it throws stops the evaluations that run, as cancel() does,
    /// and comes out of one of them, or of the load; finished frames stay.
    explicit Session(Options options = {}, engine::Observer* watch = nullptr);
    ~Session();
    Session(const Session&) = delete;

    /// In place of the graph before; what has been computed stays and is found again where it fits.
    void load_file(const std::string& path);
    /// \param file_name stands in messages; relative paths in the graph start at its folder
    void load_text(std::string_view json, const std::string& file_name = "graph.json");
    /// The graph as it is now. Throws Misuse DG121 where none is loaded.
    std::shared_ptr<const engine::Graph> graph() const;
    /// One transaction on the graph.
    void edit(const std::function<void(engine::Edit&)>& changes);

    /// What stands in the graph file at this input: a literal, {value, unit}, {keys}, {from}, [ … ].
    void set_json(const engine::Plug& input, const std::string& json);
    /// At all frames alike.
    void set(std::span<const Setting> settings);
    /// From `frame` on; frames before keep what they have (engine::Edit::set_input).
    void set_at(double frame, std::span<const Setting> settings);
    /// The same of a hostMesh node. The first mesh holds for the frames before it, too. Throws Misuse DG125, and leaves
    /// all as it is, where the faces are none of the points.
    void set_mesh(const std::string& node, double frame, const HostMesh& mesh);

    /// \param plug "node.output"; empty: outMeshes of the solver that no other one reads
    Frame evaluate(double frame, std::string_view plug = {}, std::stop_token stop = {});
    /// Whether that would be a look-up.
    bool is_ready(double frame, std::string_view plug = {}) const;
    /// "Why would this run?"
    engine::Verdict explain(double frame, std::string_view plug = {}) const;
    /// Throws Misuse DG140 within a callback of this session, on the thread that it is on. All that may not be called
    /// there begins with it; layers that go on in a thread of their own call it before.
    void refuse_in_callback() const;
    /// Stops the evaluations that are running now; finished frames stay.
    void cancel();
    Counts counts() const;

  private:
    Frame evaluated(double frame, std::string_view plug, std::stop_token stop);
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::embed
