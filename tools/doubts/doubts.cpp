// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/doubts/doubts.h"

#include "tools/cli/open_graph.h"
#include "tools/doubts/kinds.h"

namespace sinew::cli {

namespace {

void look_at_solver(Doubting& d, const std::string& name) {
    std::vector<Member> members;
    std::size_t disabled = 0;
    for (const engine::Plug& plug : d.plugs(name, "bodies"))
        if (auto body = d.value<nodes::Body>(plug)) {
            if (body->takes_part && !body->enable) return; // comes later
            disabled += body->takes_part ? 0 : 1;
            if (body->takes_part) members.push_back({plug.node, std::move(*body)});
        }
    const auto units = d.number<double>(name, "scale");
    if (members.size() + disabled != d.plugs(name, "bodies").size() || !units) return; // told elsewhere
    doubt_gravity(d, name);
    doubt_floating(d, name, members);
    doubt_sizes(d, name, members, *units);
    for (const Member& m : members)
        if (!m.body.subtissue) doubt_mesh(d, m), doubt_sheet(d, m, *units);
    for (const Member& m : members)
        if (!m.body.subtissue) doubt_tets(d, m);
    doubt_paint(d, name, members);
}

} // namespace

std::vector<engine::Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                            Look look, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures) {
    Doubting d(graph, evaluator, look, start_frame(*graph, nodes), stop, failures);
    std::vector<std::string> transforms, fibers;
    for (const std::string& name : nodes) {
        const engine::Node* node = graph->find(name);
        if (!node || !node->type) continue;
        const std::string_view type = node->type->name;
        if (type == "zMaterial") doubt_material(d, name);
        if (type == "zFiber") doubt_fiber(d, name), fibers.push_back(name);
        if (type == "zMaterial" || type == "zFiber") doubt_blank_paint(d, name);
        if (type == "transform") transforms.push_back(name);
        if (type == "zBone") doubt_matrix(d, name);
        if (type == "zHold") doubt_hold(d, name);
        if (type == "zAttachment") doubt_attachment(d, name);
        if (type == "zSolver") look_at_solver(d, name);
    }
    doubt_transforms(d, transforms);
    doubt_passive_muscles(d, fibers);
    return d.take();
}

std::vector<engine::Diagnostic> find_unit_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                                 engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                                 std::stop_token stop,
                                                 const std::shared_ptr<engine::Failures>& failures) {
    Doubting d(graph, evaluator, Look::in_passing, start_frame(*graph, nodes), stop, failures);
    for (const std::string& name : nodes)
        if (const engine::Node* node = graph->find(name); node && node->type && node->type->name == "zSolver")
            doubt_units_of_meshes(d, name);
    return d.take();
}

} // namespace sinew::cli
