// A cloth over bodies.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_check.h"
#include "tools/rig/layers_text.h"
#include "tools/rig/wrap.h"

#include <algorithm>
#include <cmath>

namespace sinew::rig {

using engine::Severity;

namespace {

double mean_edge(const Part& part) {
    double sum = 0;
    for (const solver::Triangle& t : part.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            sum += (part.points[static_cast<std::size_t>(t[i])] - part.points[static_cast<std::size_t>(t[(i + 1) % 3])])
                       .norm();
    return sum / (3 * static_cast<double>(part.triangles.size()));
}

} // namespace

Rig guess_cloth(const std::vector<std::string>& bodies, const std::string& cloth, const GuessOptions& options) {
    Rig rig;
    rig.parts = read_parts(options.files, mesh_files(options.files, bodies, rig.notes), {cloth}, rig.notes, "cloth");
    set_space(rig, options);
    Part sheet = std::move(rig.parts.back());
    rig.parts.pop_back();
    const solver::MeshCheck check = solver::check_mesh(sheet.points, sheet.triangles);
    if (check.non_manifold_edges)
        throw engine::Failure(say(Severity::error, "DG161", sheet.name,
                                  sheet.file + ": a cloth has at most two triangles at an edge, but there is " +
                                      solver::describe(check.non_manifold_edges, "edge with more", "edges with more"),
                                  "Take the sheets apart where three of them meet."));
    wrap_open(rig.parts, rig.notes, options.stop);
    for (const Part& body : rig.parts) {
        const solver::SurfaceTree tree(body.points, body.triangles);
        const auto inside = std::count_if(sheet.points.begin(), sheet.points.end(),
                                          [&](const solver::Vec3& p) { return tree.inside(p); });
        if (inside > 0)
            rig.notes.push_back(say(Severity::warning, "DG162", sheet.name,
                                    std::to_string(inside) + " of its " + std::to_string(sheet.points.size()) +
                                        " vertices begin inside of " + body.name + ", which pushes them out at once",
                                    body.is_wrapped
                                        ? "Move them outside, half a thickness away. If " + body.name +
                                              " is a cloth, too: only the last mesh is made one, the others are bodies "
                                              "that it lies on."
                                        : "Move them outside, half a thickness away."));
    }
    rig.parts.push_back(std::move(sheet));
    return rig;
}

std::string cloth_text(const Rig& rig, const TextOptions& options) {
    GraphText text;
    std::vector<std::string> bodies;
    const Part& cloth = rig.parts.back();
    text.comment("What the cloth lies on: as hard as the cloth can press, and not slippery.");
    for (const Part& part : rig.parts) {
        if (&part == &cloth) continue;
        write_bone(text, rig, part, options, {{"contactStiffness", "1e7"}, {"contactFriction", "0.5"}});
        bodies.push_back(wire(part.name, "outBody"));
    }
    text.blank();
    text.comment(
        "The cloth: a woollen blanket. Stretch along its threads, shear between them, bending; thickness is in "
        "metres. To hold it somewhere, paint weights and connect a zAttachment to the solver's attachments.");
    text.node("fabric", "zMaterial",
              {{"tensileStiffness", "5000"},
               {"shearStiffness", "200"},
               {"bendStiffness", "0.001"},
               {"clothMassDensity", "0.3"}});
    write_mesh(text, rig, cloth, options);
    text.node(cloth.name, "zCloth",
              {{"mesh", wire(cloth.name + "Mesh", "outMesh")},
               {"materials", list({wire("fabric", "outMaterial")})},
               {"thickness", "0.002"},
               {"contactStiffness", "1e6"},
               {"contactFriction", "0.5"}});
    bodies.push_back(wire(cloth.name, "outBody"));
    text.blank();
    const double spacing = std::clamp(mean_edge(cloth) / rig.unit.per_metre, 1e-4, 1.0);
    text.comment(
        "collisionPointSpacing: the length of the cloth's edges, so that what is sharp does not come through.");
    Inputs inputs{{"bodies", list(bodies)},
                  {"collisionDetection", "true"},
                  {"collisionSubdivision", "true"},
                  {"collisionPointSpacing", number(spacing)},
                  {"substeps", "2"},
                  {"stiffnessDamping", "0.005"},
                  {"maxNewtonIterations", "60"}};
    add_space(inputs, rig);
    text.node("solver", "zSolver", inputs);
    return text.file(head_text(rig, options), 1, last_frame(options), graph_fps);
}

} // namespace sinew::rig
