// What every adapter needs: the solver's errors as diagnostics that name node and attribute, and painted maps
// by vertex.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"
#include "solver/error.h"
#include "solver/meshing/meshing_control.h"

#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace sinew::nodes {

/// Lets the host watch and stop meshing. Must not outlive `in`.
inline solver::MeshingControl meshing_control(const engine::Reads& in) {
    return {[&in] { return in.stop_requested(); },
            [&in](double done, std::string_view what) { in.progress(done, what); }};
}

/// Runs `call`; what the solver throws becomes a diagnostic at `attribute` of this node, or at another one where
/// `blame` names it for the code ({code, attribute}); a stop that the host asked for becomes Cancelled.
template <class Call>
auto guarded(const engine::Reads& in, std::string_view attribute, Call&& call,
             std::initializer_list<std::pair<std::string_view, std::string_view>> blame = {}) {
    try {
        return call();
    } catch (const solver::Stopped&) {
        throw engine::Cancelled();
    } catch (const solver::Error& e) {
        for (const auto& [code, other] : blame)
            if (e.code == code) attribute = other;
        in.fail(attribute, e.code, e.what(), e.hint);
    }
}

/// Fails with FE204 unless a painted map fits: no entry (= 1 everywhere), one for all, or one per vertex (or face).
/// \param whose "weights of biceps", for the message
/// \param what "vertex" or "face"
/// \param maker the node that the map comes from; empty for one that is typed
inline void check_map(const engine::Reads& in, std::string_view attribute, const engine::NumberList& map,
                      std::size_t count, const std::string& whose, std::string_view what = "vertex",
                      const std::string& maker = {}) {
    if (map.size() <= 1 || map.size() == count) return;
    in.fail(attribute, "FE204",
            whose + (maker.empty() ? "" : ", made by " + maker) + ": " + std::to_string(map.size()) +
                " numbers for a mesh of " + std::to_string(count) + (what == "vertex" ? " vertices" : " faces"),
            "Give one number per " + std::string(what) + ", one number for all, or none for 1 everywhere; " +
                (maker.empty() ? "the map may have been made for another mesh."
                               : maker + " may be made for another mesh: let what paints it read this one."));
}

/// Fails with FE213 where a node is connected twice to a list whose entries add up.
/// \param again what it would do twice: "pull"
inline void refuse_twice(const engine::Reads& in, std::string_view attribute, std::size_t count,
                         const std::string& again) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < count; ++i)
        if (const std::string name = in.source_name(attribute, i); !names.insert(name).second)
            in.fail(attribute, "FE213", name + " is connected twice, so it would " + again + " twice",
                    "Remove one of the two connections.");
}

/// A map of a polygon mesh's faces with one number per triangle.
inline engine::NumberList per_triangle(const MeshTopology& topology, const engine::NumberList& of_faces) {
    engine::NumberList out;
    out.reserve(topology.triangles.size());
    for (std::size_t f = 0; f < topology.face_sizes.size(); ++f)
        out.insert(out.end(), static_cast<std::size_t>(topology.face_sizes[f] - 2), of_faces[f]);
    return out;
}

/// The map with one number per vertex.
inline engine::NumberList per_vertex(const engine::NumberList& map, std::size_t vertex_count) {
    if (map.size() > 1) return map;
    return engine::NumberList(vertex_count, map.empty() ? 1.0 : map.front());
}

} // namespace sinew::nodes
