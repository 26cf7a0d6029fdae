// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/subtissues.h"

#include "engine/text.h"
#include "nodes/adapters.h"

#include <algorithm>

namespace sinew::nodes {

using engine::Hasher;
using engine::Reads;

namespace {

std::string percent(double share) { return engine::rough_text(100 * share, 2) + " %"; }

/// "tendon", as its node is called; deeper than within a direct part "a part of biceps".
std::string name_of(const Reads& in, const std::vector<NestedPart>& nested, std::size_t at) {
    const NestedPart& part = nested[at];
    const std::string direct = in.source_name(subtissues.name, part.top);
    if (part.within < 0) return direct;
    std::string name;
    if (nested[static_cast<std::size_t>(part.within)].within < 0) {
        std::size_t entry = 0;
        for (std::size_t i = 0; i < at; ++i) entry += nested[i].within == part.within;
        name = in.source_behind(subtissues.name, part.top, subtissues.name, entry);
    }
    return name.empty() ? "a part of " + direct : name;
}

/// A part that stands in another stands in what that one is a part of, too: listed again, the two would share it.
void refuse_in_two(const Reads& in, const std::vector<NestedPart>& nested) {
    for (std::size_t i = 0; i < nested.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            if (nested[k].part->digest != nested[i].part->digest) continue;
            const std::string name = name_of(in, nested, k), other = name_of(in, nested, i),
                              holder = in.source_name(subtissues.name, nested[i].top);
            const bool is_deep = other == "a part of " + holder;
            if (!is_deep && name != other)
                in.fail(subtissues.name, "FE213",
                        name + " and " + other + ", a part of " + holder + ", are alike in mesh and paint",
                        "Remove one of the two.");
            if (nested[k].within < 0)
                in.fail(subtissues.name, "FE228", name + " is connected here, but is a part of " + holder + " already",
                        "Remove it here: what is a part of " + holder + " is within this one, too.");
            in.fail(subtissues.name, "FE228",
                    name + " is a part of both " + in.source_name(subtissues.name, nested[k].top) + " and " + holder,
                    "Connect it to subtissues of one of the two alone.");
        }
}

} // namespace

std::vector<std::shared_ptr<const Subtissue>> read_subtissues(const Reads& in) {
    std::vector<std::shared_ptr<const Subtissue>> out;
    const auto all = in[subtissues];
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Body& body = all[i];
        const std::string name = in.source_name(subtissues.name, i);
        if (!body.subtissue)
            in.fail(
                subtissues.name, "FE228",
                name + (body.is_bone() ? " is a bone" : " has tets of its own") + ", so it cannot be a part of another",
                "Make it a zSubtissue, which takes the tets and the elastic law of what it is a part of; or tie the "
                "two by a zAttachment.");
        for (std::size_t k = 0; k < i; ++k)
            if (out[k]->digest == body.subtissue->digest)
                in.fail(subtissues.name, "FE213",
                        name + " and " + in.source_name(subtissues.name, k) + " are alike in mesh and paint",
                        "Remove one of the two.");
        out.push_back(body.subtissue);
    }
    refuse_in_two(in, nested_parts(out));
    return out;
}

void check_layers(const Reads& in, std::string_view attribute,
                  const std::vector<std::reference_wrapper<const Material>>& layers, const Mesh& mesh) {
    if (layers.empty())
        in.fail(attribute, "FE206", "a tissue without material has neither stiffness nor mass",
                "Connect a zMaterial's outMaterial to materials.");
    for (std::size_t i = 0; i < layers.size(); ++i)
        check_map(in, attribute, layers[i].get().weights, mesh.points->size(),
                  "weights of " + in.source_name(attribute, i), "vertex", in.source_behind(attribute, i, "weights"));
}

void check_fibers(const Reads& in, std::string_view attribute,
                  const std::vector<std::reference_wrapper<const Fiber>>& fibers, const Mesh& mesh) {
    const std::size_t count = mesh.points->size();
    refuse_twice(in, attribute, fibers.size(), "pull");
    for (std::size_t i = 0; i < fibers.size(); ++i) {
        const Fiber& f = fibers[i];
        const std::string name = in.source_name(attribute, i);
        check_map(in, attribute, f.weights, count, "weights of " + name, "vertex",
                  in.source_behind(attribute, i, "weights"));
        if (!f.directions.empty()) continue;
        if (f.end_points.size() > 1)
            check_map(in, attribute, f.end_points, count, "endPoints of " + name, "vertex",
                      in.source_behind(attribute, i, "endPoints"));
        const bool begins = std::any_of(f.end_points.begin(), f.end_points.end(), is_source);
        const bool ends = std::any_of(f.end_points.begin(), f.end_points.end(), is_sink);
        if (!begins || !ends)
            in.fail(
                attribute, "FE205",
                "the fibres of " + name + " have no " +
                    (begins ? "sink"
                     : ends ? "source"
                            : "end points") +
                    " on this tissue",
                "Paint endPoints: up to 0.1 where the fibres begin, from 0.9 on where they end; or give the fibres a "
                "direction.");
    }
}

engine::Digest static_digest(const Subtissue& part) {
    Hasher h;
    h.add("subtissue").add(part.mesh.topology->digest).add(part.mesh.points_digest);
    h.add(static_cast<std::uint64_t>(part.materials.size()));
    for (std::size_t i = 1; i < part.materials.size(); ++i) // the first covers all of the part
        h.add_doubles(part.materials[i].weights).add(part.materials[i].place_digest);
    h.add(static_cast<std::uint64_t>(part.fibers.size()));
    for (const Fiber& f : part.fibers)
        h.add_doubles(f.weights)
            .add(f.directions.empty())
            .add_doubles(f.directions.empty() ? f.end_points : f.directions);
    h.add(static_cast<std::uint64_t>(part.parts.size()));
    for (const auto& inner : part.parts) h.add(inner->digest);
    return h.finish();
}

solver::SubtissueInputs part_inputs(const Subtissue& part) {
    solver::SubtissueInputs out;
    out.rest_scale_envelope = part.rest_scale_envelope;
    for (const Material& m : part.materials) out.layers.push_back(m.values);
    out.layers.front().envelope = 1; // the first layer covers everything
    return out;
}

std::vector<FiberLine> lines_of(const std::vector<std::reference_wrapper<const Fiber>>& fibers) {
    std::vector<FiberLine> out;
    for (std::size_t k = 0; k < fibers.size(); ++k)
        if (const Fiber& f = fibers[k]; f.line) out.push_back({k, f.line, f.growth_follows_line});
    return out;
}

void warn_of_parts(const Reads& in, const std::vector<NestedPart>& nested, const FoundParts& found) {
    // Tets stand for a curved border by flat sides, so a few per cent say nothing.
    constexpr double noticed = 0.05;
    for (std::size_t i = 0; i < nested.size(); ++i) {
        const std::string name = name_of(in, nested, i);
        if (found.inside[i] == 0)
            in.fail(subtissues.name, "FE229", "nothing of " + name + " lies inside of the tissue",
                    "Model it where the tissue is at rest, in the same units.");
        if (found.inside[i] < 1 - noticed)
            in.warn(subtissues.name, "FE229",
                    percent(1 - found.inside[i]) + " of " + name +
                        " lie outside of the tissue, where nothing is simulated",
                    "Model it inside of the tissue, or make the tissue's mesh reach around it.");
        if (found.shared[i] > noticed)
            in.warn(subtissues.name, "FE249",
                    percent(found.shared[i]) + " of " + name +
                        " go to another part that overlaps it, or lie outside of the part that it is in",
                    "Keep parts beside each other, or put one inside of the other by its own subtissues.");
    }
}

void refuse_subtissue(const Reads& in, std::string_view attribute, const Body& body, const std::string& name) {
    if (body.subtissue)
        in.fail(attribute, "FE228", name + " is a subtissue, which has no tets of its own",
                "Connect the tissue that it is a part of.");
}

} // namespace sinew::nodes
