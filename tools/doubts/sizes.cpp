// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace sinew::doubts {

namespace {

/// Longest sides of a tissue between which it is taken as flesh [m]: from a muscle of the hand to a whale's back.
constexpr double least_extent = 0.01, largest_extent = 5;
/// Of what has fibres: longer than any muscle of a horse, shorter than a calf muscle in millimetres [m].
constexpr double largest_muscle = 2.2;
/// By the size of a scene how far it may lie from the origin. What is 1000 sizes away keeps four digits of its shape in
/// numbers of 32 bits, which GLB and the graphics of computers have.
constexpr double farthest_sizes = 1000;
/// No body of a scene is so many times as large as another and none between them, if they are in one unit.
constexpr double unit_gap = 60;
/// Nothing that is simulated stands on, or hangs on, anything longer, whatever made it [m].
constexpr double largest_body = 1000;

/// "1.2 mm", "35 cm", "18 m".
std::string length_text(double metres) {
    if (metres < 0.01) return rough(1000 * metres) + " mm";
    if (metres >= 1000) return rough(metres / 1000) + " km";
    return metres < 1 ? rough(100 * metres) + " cm" : rough(metres) + " m";
}

/// The largest tissue that is not told of already. Whether it was told.
bool implausible_size(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units,
                      const std::set<std::string>& odd) {
    const Member* largest = nullptr;
    double found = 0; // scene units
    const auto too_long = [&](const Member& m, double metres) {
        return metres > (d.plugs(m.name, "fibers").empty() ? largest_extent : largest_muscle);
    };
    for (const Member& m : members)
        if (!m.body.is_bone() && !odd.contains(m.name) && extent(*m.body.rest->mesh.points) > found)
            found = extent(*m.body.rest->mesh.points), largest = &m;
    const double metres = found / units;
    if (!largest || (metres >= least_extent && !too_long(*largest, metres))) return false;
    constexpr std::array<std::pair<double, const char*>, 3> usual{
        {{100, "centimetres"}, {1000, "millimetres"}, {1, "metres"}}};
    std::string cure;
    for (const auto& [per_metre, unit] : usual) {
        const double length = found / per_metre;
        if (length < least_extent || too_long(*largest, length)) continue;
        const std::string scale = engine::number_text(per_metre), size = "which makes it " + length_text(length);
        cure += cure.empty() ? "if it is modelled in " + std::string(unit) + ", write \"scale\": " + scale + ", " + size
                             : "; if in " + std::string(unit) + ", " + scale + ", " + size;
    }
    if (cure.empty()) cure = "scale is the number of scene units in a metre; choose it, or scale the meshes";
    if (const std::string file = d.file_of(largest->name); file.ends_with(".glb") && units != 1)
        cure += "; what a GLB holds is in metres by its format: \"scale\": 1";
    d.doubt("FE261", solver, "scale",
            largest->name + " is " + length_text(metres) + " long: " + rough(found) + " scene units, " +
                engine::number_text(units) + " a metre",
            cure);
    return true;
}

/// The largest bone, or cloth, that is not told of already.
void implausible_body(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units,
                      const std::set<std::string>& odd) {
    const Member* largest = nullptr;
    double found = 0; // scene units
    for (const Member& m : members)
        if (const double length = extent(*mesh_of(m.body).points); !odd.contains(m.name) && length > found)
            found = length, largest = &m;
    if (!largest || !(found > largest_body * units)) return;
    d.doubt("FE320", solver, "bodies",
            largest->name + " is " + length_text(found / units) + " long: " + rough(found) + " scene units, " +
                engine::number_text(units) + " a metre",
            "give it a size in scene units that suits the other bodies; where it is in another unit, scale it by a "
            "transform");
}

/// What a few bodies are to be multiplied by to be among the others, by the middles of both in powers of ten.
struct Missing {
    double factor = 1;
    bool is_usual = true; ///< as if one unit were taken for another
};

Missing missing_factor(double few, double others) {
    const double ratio = std::max(few, others) / std::min(few, others);
    // What is that far off then lies within the gap that is doubted.
    const double most_usual = 1000 * unit_gap;
    Missing out;
    out.is_usual = ratio < most_usual;
    const double power = !out.is_usual ? std::round(std::log10(ratio)) : ratio < 316 ? 2 : 3;
    out.factor = std::pow(10, few < others ? power : -power);
    return out;
}

/// The names of those that are in another unit.
std::set<std::string> other_units(Doubting& d, const std::string& solver,
                                  std::vector<std::pair<double, std::string>> sizes) {
    std::sort(sizes.begin(), sizes.end());
    for (std::size_t k = 1; k < sizes.size(); ++k) {
        const double below = sizes[k - 1].first, above = sizes[k].first;
        if (!(below > 0 && above > unit_gap * below)) continue;
        // The fewer are taken for the mistake; what is made by a node is as large as the graph says.
        std::vector<std::string> few;
        bool small = 2 * k <= sizes.size();
        const auto take_files = [&] {
            for (std::size_t i = small ? 0 : k; i < (small ? k : sizes.size()); ++i)
                if (!d.file_of(sizes[i].second).empty()) few.push_back(sizes[i].second);
        };
        take_files();
        if (few.empty() && 2 * k == sizes.size()) small = false, take_files();
        if (few.empty()) return {};
        std::string names;
        for (const std::string& name : few) names += (names.empty() ? "" : ", ") + name;
        const double ratio = sizes.back().first / sizes.front().first;
        double least = 0, most = 0; // of the few
        for (const auto& [size, name] : sizes)
            if (std::find(few.begin(), few.end(), name) != few.end()) least = least > 0 ? least : size, most = size;
        const double low = small ? above : sizes.front().first, high = small ? sizes.back().first : below;
        const Missing missing = missing_factor(std::sqrt(least) * std::sqrt(most), std::sqrt(low) * std::sqrt(high));
        const std::string factor = engine::number_text(missing.factor);
        const auto range = [](double least, double most) {
            return rough(least) + (rough(least) == rough(most) ? "" : " to " + rough(most)) + " scene units";
        };
        const std::string one = range(sizes.front().first, below), other = range(above, sizes.back().first);
        d.doubt("FE320", solver, "bodies",
                names + (few.size() == 1 ? " is " : " are ") + (small ? one : other) + " long, the other bodies " +
                    (small ? other : one) + ": " + (small ? "smaller" : "larger") + " by a factor of about " +
                    rough(ratio),
                missing.is_usual ? "if they are modelled in different units, put a transform with scale " + factor +
                                       " between the file and " + names
                                 : "no two usual units are so far apart: look at how it was exported; a transform "
                                   "with scale " +
                                       factor + " between the file and " + names + " would make it fit");
        return {few.begin(), few.end()};
    }
    return {};
}

void far_away(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    solver::Points corners; // of all that is simulated
    for (const Member& m : members)
        if (!m.body.is_bone() && !m.body.subtissue && !m.body.rest->mesh.points->empty()) {
            const solver::Box box = solver::bounding_box(*m.body.rest->mesh.points);
            corners.push_back(box.min), corners.push_back(box.max);
        }
    if (corners.empty()) return;
    const solver::Box box = solver::bounding_box(corners);
    const double size = box.size().norm(), away = box.centre().norm();
    if (away <= farthest_sizes * size) return;
    d.doubt("FE345", solver, "bodies",
            "the scene lies " + rough(away) + " scene units from the origin, " + rough(away / size) +
                " times its size: files and pictures hold places in 32 bits, here to " + rough(away * 6e-8) +
                " scene units",
            "model it near the origin, and move what comes out; or write --format obj, which holds all digits");
}

} // namespace

void doubt_sizes(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units) {
    // A scale for all would be the wrong cure where one body is odd among others.
    std::vector<std::pair<double, std::string>> sizes;
    for (const Member& m : members)
        if (!m.body.subtissue) sizes.emplace_back(extent(*mesh_of(m.body).points), m.name);
    const std::set<std::string> odd = other_units(d, solver, std::move(sizes));
    if (!implausible_size(d, solver, members, units, odd)) implausible_body(d, solver, members, units, odd);
    far_away(d, solver, members);
}

void doubt_units_of_meshes(Doubting& d, const std::string& solver) {
    std::vector<std::pair<double, std::string>> sizes;
    for (const engine::Plug& plug : d.plugs(solver, "bodies")) {
        const engine::Node* node = d.graph().find(plug.node);
        if (!node || !node->type || node->type->name == "zSubtissue") continue;
        if (const auto body = d.value<nodes::Body>(plug)) {
            if (!mesh_of(*body).points->empty()) sizes.emplace_back(extent(*mesh_of(*body).points), plug.node);
            continue;
        }
        for (const engine::Plug& mesh : d.plugs(plug.node, "mesh"))
            if (const auto m = d.value<nodes::Mesh>(mesh); m && !m->points->empty())
                sizes.emplace_back(extent(*m->points), plug.node);
    }
    other_units(d, solver, std::move(sizes));
}

} // namespace sinew::doubts
