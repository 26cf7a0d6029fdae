// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "tools/doubts/kinds.h"

#include <algorithm>

namespace sinew::doubts {

namespace {

/// Attached shares of a surface from which on the whole is meant, or nothing was painted.
constexpr double nearly_whole = 0.9;

/// [N/m^3]: by what is softer the weight of 10 cm of flesh hangs a metre away, and that of a heavy cloth.
constexpr double least_tie = 1000, least_tie_of_cloth = 10;

/// Weights below which it is the paint that leaves nothing of a stiffness.
constexpr double faintly = 0.1;

/// Of the surface, by area, from 0 to 1: exactly 1 where all of it is.
double painted_share(const nodes::Body& body, const std::vector<double>& weights) {
    if (std::all_of(weights.begin(), weights.end(), [](double w) { return w > 0; })) return 1;
    const solver::Points& points = *body.rest->mesh.points;
    double all = 0, painted = 0;
    for (const solver::Triangle& t : body.rest->mesh.topology->triangles) {
        const auto corner = [&](std::size_t i) -> const solver::Vec3& { return points[at(t[i])]; };
        const double third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
        for (std::size_t i = 0; i < 3; ++i) {
            all += third;
            if (weights.size() > at(t[i]) && weights[at(t[i])] > 0) painted += third;
        }
    }
    return all > 0 ? std::min(painted / all, 0.99) : 0;
}

void whole_body(Doubting& d, const std::string& name, const nodes::Attachment& a, const std::vector<Member>& members,
                const std::vector<nodes::BodyId>& ids) {
    // To draw all of a body to its animated copy is what goals are for.
    if (d.graph().find(name)->type->name == "zGoalAttachment") return;
    const int source = find_body(ids, a.source_body);
    if (source < 0 || members[at(source)].body.is_bone() || a.values.mode() != solver::AttachmentMode::fixed) return;
    // A fascia of cloth may well cling to the flesh below it everywhere.
    const int target = find_body(ids, a.target_body);
    if (members[at(source)].body.is_cloth() && target >= 0 && !members[at(target)].body.is_bone()) return;
    const double share = painted_share(members[at(source)].body, a.rest.source_weights);
    if (share < nearly_whole) return;
    d.doubt("FE264", name, "weights",
            "ties " + (share < 1 ? std::to_string(static_cast<int>(100 * share)) + " % of" : std::string("the whole")) +
                (share < 1 ? " the" : "") + " surface of " + members[at(source)].name,
            "paint where it holds on: a node weights with the mesh of " + members[at(source)].name +
                ", for example with mode near");
}

} // namespace

void doubt_attachment(Doubting& d, const std::string& name) {
    // Keys may release it for a while: what is doubted is that it never holds.
    const std::vector<double> all = all_values(d, name, "stiffness"), envelopes = all_values(d, name, "envelope");
    const double stiffness = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
    if (stiffness <= 0) return; // 0: released
    const auto attachment = d.value<nodes::Attachment>({name, "outAttachment"});
    if (!attachment || attachment->values.mode() == solver::AttachmentMode::none) return;
    bool of_cloth = false;
    for (const char* end : {"source", "target"})
        for (const engine::Plug& plug : d.plugs(name, end))
            if (const auto body = d.value<nodes::Body>(plug)) of_cloth = of_cloth || body->is_cloth();
    const double least = of_cloth ? least_tie_of_cloth : least_tie;
    const std::vector<double>& weights = attachment->rest.source_weights;
    const double envelope = envelopes.empty() ? 1 : *std::max_element(envelopes.begin(), envelopes.end()),
                 most = envelope *
                        (weights.empty() ? 1 : std::max(0.0, *std::max_element(weights.begin(), weights.end())));
    if (stiffness >= least && most > 0 && most < faintly && most * stiffness < least)
        d.doubt("FE326", name, "weights",
                "it holds nothing: weights and envelope are " + engine::rough_text(most, 2) +
                    " at most, which leaves " + engine::rough_text(most * stiffness, 2) + " N/m^3 of its stiffness",
                "paint 1 where it is to hold fully: both multiply the stiffness");
    if (stiffness >= least) return;
    d.doubt("FE326", name, "stiffness",
            engine::number_text(stiffness) +
                " N/m^3 holds nothing: the weight of a sheet of flesh 1 cm thick stretches it by " +
                (stiffness < 1e-6 ? "kilometres" : rough(9.8 * 10 / stiffness) + " m"),
            "it is a force per area and length, not a factor: tendons take 1e8 to 1e10, soft ties 1e5");
}

void doubt_hold(Doubting& d, const std::string& name) {
    if (d.number<bool>(name, "enable") == false) return;
    auto weights = d.number<engine::NumberList>(name, "weights");
    for (const engine::Plug& plug : d.plugs(name, "weights")) weights = d.value<engine::NumberList>(plug);
    if (!weights || !std::all_of(weights->begin(), weights->end(), [](double w) { return w > 0; })) return;
    for (const engine::Plug& plug : d.plugs(name, "tissue"))
        d.doubt("FE331", name, "weights",
                "holds the whole of " + plug.node + ", so nothing of it moves or deforms by itself",
                "paint what is to be held: a node weights with the mesh of " + plug.node +
                    ", for example with mode near; what is to move as a whole is a zBone");
}

void doubt_whole_attachments(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    std::vector<nodes::BodyId> ids;
    for (const Member& m : members) ids.push_back(id_of(m.body));
    for (const engine::Plug& plug : d.plugs(solver, "attachments"))
        if (const auto a = d.value<nodes::Attachment>(plug)) whole_body(d, plug.node, *a, members, ids);
}

} // namespace sinew::doubts
