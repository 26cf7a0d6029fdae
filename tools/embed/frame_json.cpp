// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/embed/frame_json.h"

#include <nlohmann/json.hpp>

namespace sinew::embed {

using Json = nlohmann::ordered_json;

std::string name_at(const std::vector<std::string>& names, int i) {
    return i >= 0 && i < static_cast<int>(names.size()) ? names[static_cast<std::size_t>(i)] : std::to_string(i);
}

Json step_json(const solver::StepRecord& r) {
    Json terms = Json::object();
    for (const solver::Measured& m : r.measured) {
        Json& entry = terms[std::string(m.what->term)][std::string(m.what->name)];
        if (m.part < 0)
            entry = m.value;
        else
            entry.push_back(m.value); // a list: a number for each of the term's parts
    }
    return {{"phases",
             {{"assembly", r.seconds_assembly},
              {"factor", r.seconds_factor},
              {"solve", r.seconds_solve},
              {"other", r.seconds_other}}},
            {"substeps", r.substeps},
            {"newton", r.newton_iterations},
            {"linear_iterations", r.linear_iterations},
            {"factorizations", r.factorizations},
            {"halvings", r.halvings},
            {"residual", r.residual},
            {"converged", r.converged},
            {"energy", r.energy},
            {"min_J", r.min_j},
            {"inverted", r.inverted},
            {"terms", terms}};
}

Json line_json(const nodes::LineReport& r) {
    return {{"body", r.body},
            {"fiber", r.fiber},
            {"rest_length_m", r.line.rest_length},
            {"length_m", r.line.length},
            {"loaValue", r.line.value},
            {"excitation", r.excitation},
            {"growth", r.growth}};
}

Json where_json(const nodes::WorstPlaces& w, const std::vector<std::string>& bodies,
                const std::vector<std::string>& attachments) {
    Json out = Json::object();
    if (w.residual_body >= 0) out["residual"] = {{"body", name_at(bodies, w.residual_body)}};
    if (w.tet >= 0) out["min_J"] = {{"tissue", name_at(bodies, w.body)}, {"tet", w.tet}, {"at", w.tet_place}};
    if (w.attachment >= 0)
        out["max_stretch_m"] = {{"attachment", name_at(attachments, w.attachment)},
                                {"body", name_at(bodies, w.source_body)},
                                {"vertex", w.vertex},
                                {"at", w.stretch_place}};
    if (w.contact_body >= 0)
        out["max_depth_m"] = {{"body", name_at(bodies, w.contact_body)},
                              {"in", name_at(bodies, w.contact_target)},
                              {"depth_m", w.depth},
                              {"at", w.contact_place}};
    if (w.deep_body >= 0)
        out["deep_contact"] = {{"body", name_at(bodies, w.deep_body)},
                               {"in", name_at(bodies, w.deep_target)},
                               {"depth_m", w.deep},
                               {"at", w.deep_place}};
    return out;
}

Json size_json(const nodes::SolveReport& r) {
    return {{"bodies", r.bodies},           {"tets", r.tets},  {"triangles", r.triangles}, {"dofs", r.dofs},
            {"attachments", r.attachments}, {"terms", r.terms}};
}

} // namespace sinew::embed
