// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/doubts/doubts.h"

#include "tools/doubts/kinds.h"
#include "tools/embed/graph_walk.h"

namespace sinew::doubts {

namespace {

void look_at_solver(Doubting& d, const std::string& name) {
    std::vector<Member> members;
    std::size_t disabled = 0;
    for (const engine::Plug& plug : d.plugs(name, "bodies"))
        if (auto body = d.value<nodes::Body>(plug)) {
            const bool stays_off = !body->takes_part || d.number<bool>(plug.node, "enable") == false;
            if (!stays_off && !body->enable) return; // comes later
            disabled += stays_off ? 1 : 0;
            if (!stays_off) members.push_back({plug.node, std::move(*body)});
        }
    const auto units = d.number<double>(name, "scale");
    if (members.size() + disabled != d.plugs(name, "bodies").size() || !units) return; // told elsewhere
    doubt_gravity(d, name);
    doubt_fields_on_cloth(d, name, members);
    doubt_floating(d, name, members);
    doubt_sizes(d, name, members, *units);
    for (const Member& m : members)
        if (!m.body.is_bone()) doubt_moving_mesh(d, m.name);
    for (const Member& m : members)
        if (!m.body.subtissue) doubt_mesh(d, m), doubt_bone(d, m, members), doubt_thickness(d, m, *units);
    for (const Member& m : members)
        if (!m.body.subtissue) doubt_tets(d, m);
    doubt_whole_attachments(d, name, members);
    doubt_contacts(d, name, members, *units);
}

} // namespace

std::vector<engine::Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                            double frame, Look look, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures) {
    Doubting d(graph, evaluator, look, frame, stop, failures);
    std::vector<std::string> transforms, solvers;
    for (const std::string& name : nodes) {
        const engine::Node* node = graph->find(name);
        if (!node || !node->type) continue;
        const std::string_view type = node->type->name;
        if (type == "zMaterial") doubt_material(d, name);
        if (type == "zFiber") doubt_fiber(d, name);
        doubt_idle_values(d, name);
        if (type == "transform") transforms.push_back(name);
        if (type == "zBone") doubt_matrix(d, name);
        if (type == "zCloth") doubt_weight_of_cloth(d, name);
        if (node->type->find_input("materials")) doubt_blank_paint(d, name);
        if (type == "weights") doubt_reach_of_paint(d, name, false);
        if (type == "zHold") doubt_hold(d, name);
        if (type == "zAttachment") doubt_attachment(d, name);
        if (type == "zSolver") solvers.push_back(name);
    }
    doubt_transforms(d, transforms);
    for (const std::string& name : solvers) look_at_solver(d, name);
    doubt_unread_values(d);
    doubt_idle_parts(d);
    doubt_idle_damping(d);
    doubt_idle_contact(d);
    doubt_passive_muscles(d, nodes);
    return d.take();
}

std::vector<engine::Diagnostic> find_unit_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                                 engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                                 double frame, std::stop_token stop,
                                                 const std::shared_ptr<engine::Failures>& failures) {
    Doubting d(graph, evaluator, Look::in_passing, frame, stop, failures);
    for (const std::string& name : nodes)
        if (const engine::Node* node = graph->find(name); node && node->type) {
            if (node->type->name == "zSolver") doubt_units_of_meshes(d, name);
            if (node->type->name == "weights") doubt_reach_of_paint(d, name, true);
        }
    return d.take();
}

} // namespace sinew::doubts
