// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/overlays.h"

#include <algorithm>

namespace sinew::viewer {

using engine::NumberList;
using engine::Plug;

namespace {

bool varies(const NumberList& map) {
    return std::any_of(map.begin(), map.end(), [&](double w) { return w != map.front(); });
}

/// Lines drawn of one attachment.
constexpr std::size_t most_anchors = 400;

ViewCarried carried(const solver::AnchorEnd& end, const nodes::BodyRest& body) {
    ViewCarried out;
    if (const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&body.data))
        out.host = (*tissue)->tets.tets[static_cast<std::size_t>(end.tet)];
    else
        std::copy(end.vertices.begin(), end.vertices.end(), out.host.begin());
    for (std::size_t k = 0; k < 4; ++k) out.weights[k] = static_cast<float>(end.coordinates[k]);
    return out;
}

/// A map with one number a triangle as one with one number a vertex, the largest of its triangles.
NumberList on_vertices(const nodes::Mesh& mesh, const NumberList& map) {
    NumberList out(mesh.points->size(), 0.0);
    for (std::size_t t = 0; t < map.size(); ++t)
        for (const int v : mesh.topology->triangles[t])
            out[static_cast<std::size_t>(v)] = std::max(out[static_cast<std::size_t>(v)], map[t]);
    return out;
}

void add_map(std::vector<ViewMap>& maps, const std::string& node, const std::string& name, const NumberList& values) {
    if (!varies(values)) return;
    ViewMap map{node, name, {}};
    for (const double v : values) map.values.push_back(static_cast<float>(v));
    maps.push_back(std::move(map));
}

} // namespace

std::vector<Plug> connections(const engine::Graph& graph, const std::string& node, std::string_view attribute) {
    const engine::Node* n = graph.find(node);
    const auto it = n ? n->inputs.find(attribute) : decltype(n->inputs.end()){};
    if (!n || it == n->inputs.end()) return {};
    if (const auto* plug = std::get_if<Plug>(&it->second)) return {*plug};
    if (const auto* list = std::get_if<std::vector<Plug>>(&it->second)) return *list;
    return {};
}

std::vector<ViewFibres> fibres_of(const engine::Graph& graph, const std::string& node,
                                  const solver::TissueRest& tissue) {
    const std::vector<Plug> plugs = connections(graph, node, "fibers");
    std::vector<ViewFibres> out;
    for (std::size_t i = 0; i < tissue.fibers.size(); ++i) {
        const solver::FiberRest& rest = tissue.fibers[i];
        ViewFibres& view = out.emplace_back();
        view.node = i < plugs.size() ? plugs[i].node : node;
        for (std::size_t t = 0; t < rest.directions.size(); ++t) {
            if (rest.weights[t] <= 0 || rest.directions[t].isZero()) continue;
            view.tets.push_back(static_cast<int>(t));
            for (int c = 0; c < 3; ++c) view.directions.push_back(static_cast<float>(rest.directions[t][c]));
            view.weights.push_back(static_cast<float>(rest.weights[t]));
        }
    }
    return out;
}

std::vector<ViewMap> maps_of(const engine::Graph& graph, const std::string& node, const Puller& pull) {
    std::vector<ViewMap> maps;
    for (const Plug& plug : connections(graph, node, "materials"))
        add_map(maps, plug.node, "material weights", pull(plug).as<nodes::Material>().weights);
    for (const Plug& plug : connections(graph, node, "fibers")) {
        const engine::Value value = pull(plug);
        add_map(maps, plug.node, "fibre end points", value.as<nodes::Fiber>().end_points);
        add_map(maps, plug.node, "fibre weights", value.as<nodes::Fiber>().weights);
    }
    for (const std::string& name : graph.node_names()) {
        if (graph.find(name)->type_name != "zAttachment") continue;
        for (const char* end : {"source", "target"}) {
            const bool from = std::string_view(end) == "source";
            const std::vector<Plug> body = connections(graph, name, end),
                                    map = connections(graph, name, from ? "weights" : "targetWeights");
            if (body.empty() || body.front().node != node || map.empty()) continue;
            const engine::Value value = pull({name, "outAttachment"}), at_end = pull(body.front());
            const solver::AttachmentRest& rest = value.as<nodes::Attachment>().rest;
            const NumberList& weights = from ? rest.source_weights : rest.target_weights;
            const bool by_faces = (from ? rest.source_painted : rest.target_painted) == solver::PaintedOn::faces;
            add_map(maps, name, std::string("attachment ") + end,
                    by_faces ? on_vertices(at_end.as<nodes::Body>().rest->mesh, weights) : weights);
        }
    }
    return maps;
}

void add_marks(const nodes::MarkList& list, const std::vector<std::size_t>& bodies, std::vector<ViewMarks>& out) {
    const auto body_of = [&](int k) {
        const auto i = static_cast<std::size_t>(k);
        return k >= 0 && i < bodies.size() ? static_cast<int>(bodies[i]) : -1;
    };
    const auto single = [](const solver::Vec3& p) {
        return std::array{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    };
    for (const solver::MarkGroup& group : list.groups) {
        const auto same = [&](const ViewMarks& v) {
            return v.term == group.term && v.what == group.what && v.unit == group.unit;
        };
        auto at = std::find_if(out.begin(), out.end(), same);
        if (at == out.end())
            at = out.insert(at, {std::string(group.term), std::string(group.what), std::string(group.unit), {}});
        for (const solver::Mark& m : group.marks)
            at->marks.push_back({single(m.from),
                                 single(m.to),
                                 static_cast<float>(m.value),
                                 {body_of(m.bodies[0]), body_of(m.bodies[1])}});
    }
}

std::vector<ActingAttachment> acting_attachments(const engine::Graph& graph, const std::string& solver,
                                                 const nodes::Solved& solved, const Puller& pull) {
    std::vector<ActingAttachment> out;
    for (const Plug& plug : connections(graph, solver, "attachments")) {
        const engine::Value value = pull(plug);
        const auto& a = value.as<nodes::Attachment>();
        // The same choice as zSolver's: both ends are simulated (twins are simulated too).
        const bool acts = nodes::find_body(solved.bodies, a.source_body) != nodes::body_missing &&
                          nodes::find_body(solved.bodies, a.target_body) != nodes::body_missing;
        if (acts) out.push_back({plug.node, a.values.mode() == solver::AttachmentMode::fixed});
    }
    return out;
}

ViewAttachment attachment_of(std::span<const solver::Anchor> anchors, const nodes::BodyRest& source,
                             const nodes::BodyRest& target, double units_per_metre) {
    ViewAttachment out;
    const std::size_t drawn = std::min(anchors.size(), most_anchors);
    for (std::size_t i = 0; i < drawn; ++i) {
        const solver::Anchor& anchor = anchors[i * anchors.size() / drawn];
        ViewAnchor& view = out.anchors.emplace_back();
        view.source = carried(anchor.source, source);
        view.target = carried(anchor.target, target);
        for (std::size_t k = 0; k < 3; ++k) view.offset[k] = static_cast<float>(anchor.offset[k] * units_per_metre);
    }
    return out;
}

} // namespace sinew::viewer
