// zIsoMesh: a clean triangle mesh at a distance from any polygons.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/meshing_time.h"
#include "solver/meshing/iso_deviation.h"
#include "solver/meshing/iso_mesh.h"

#include <cmath>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;

namespace {

const WireList<Mesh> meshes{
    .name = "meshes",
    .doc = "The polygons, of one mesh or several: open or closed, overlapping, cracked, in any direction. A closed "
           "part inside another is a "
           "hollow where it faces the other way (FE274).",
    .min_count = 1,
};
const Input<double> iso_value{
    .name = "isoValue",
    .def = 0,
    .limits = within_reach,
    .doc = "Distance of the new surface from the polygons, in scene units: above 0 grows, 0 remeshes, below 0 "
           "shrinks. Polygons that are not closed have no inside and need a value above 0; holes smaller than "
           "twice the value are then closed. Around polygons that are not closed it should be half a grid cell (see "
           "resolution) or more; a thinner sheet may be lost between cells (FE231).",
    .keyable = false,
};
const Input<double> triangle_size{
    .name = "triangleSize",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1e6, .open_min = true},
    .doc = "Size of the triangles: 1 makes their edges about a fortieth of the diagonal of the polygons' "
           "bounding "
           "box long, 2 makes them twice as long. Where the surface bends sharply they are smaller. Edges shorter than "
           "half a grid cell (see resolution) follow the grid and "
           "may never end (FE234).",
    .keyable = false,
};
const Input<std::int64_t> resolution{
    .name = "resolution",
    .def = 128,
    .limits = {.min = 16, .max = 1024},
    .doc = "Cells along the longest side of the grid that holds the distance. Detail and gaps smaller than a "
           "cell "
           "are lost; time and memory grow with its square.",
    .keyable = false,
};
const Input<bool> produce_manifold_mesh{
    .name = "produceManifoldMesh",
    .def = true,
    .doc = "Refines until the mesh is a closed 2-manifold, as zDelaunayTetMesh and collisions want it. Off "
           "saves "
           "about a quarter of the time and may leave edges with one triangle or more than two. Angles are at "
           "least 30 degrees either way.",
    .keyable = false,
};
const Output<double> out_distance{
    .name = "outDistance",
    .doc =
        "The largest distance measured between outMesh and where it should be, in scene units: the larger of that of "
        "its points from the level set and, for isoValue 0 and above, that of the polygons from it.",
};
const Output<double> out_volume_ratio{
    .name = "outVolumeRatio",
    .doc = "isoValue 0: the volume of outMesh by that of the polygons; 0 where that cannot be told (parts that overlap "
           "or face different ways).",
    .unit = "1",
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The triangles, facing outwards, no angle below 30 degrees, in scene units.",
};

/// The mesh with what the warning needs. Kept under the digest of all that it depends on, so that polygons
/// whose node reads the time are not meshed again at every frame.
struct Made {
    Mesh mesh;
    std::size_t components = 0, lost = 0, buried = 0;
    solver::IsoDeviation deviation;
    double triangle = 0; ///< asked for, in scene units
};

/// What passes for remeshing: volume within this share, and no place farther off than so many triangles.
constexpr double usual_volume = 0.05, usual_triangles = 2;

Digest key_of(const Reads& in) {
    return Hasher()
        .add("zIsoMesh")
        .add(in.digest_of(meshes.name))
        .add(in[iso_value])
        .add(in[triangle_size])
        .add(in[resolution])
        .add(in[produce_manifold_mesh])
        .finish();
}

Made make(const Reads& in) {
    solver::Points points;
    std::vector<solver::Triangle> triangles;
    for (const Mesh& m : in[meshes]) {
        const int first = static_cast<int>(points.size());
        points.insert(points.end(), m.points->begin(), m.points->end());
        for (const auto& [a, b, c] : m.topology->triangles) triangles.push_back({first + a, first + b, first + c});
    }
    solver::IsoMeshOptions options;
    options.iso_value = in[iso_value];
    options.resolution = static_cast<int>(in[resolution]);
    options.is_manifold = in[produce_manifold_mesh];
    options.most_seconds = in[max_time];
    solver::IsoMesh mesh = guarded(in, meshes.name,
                                   [&] {
                                       options.triangle_size =
                                           in[triangle_size] * solver::default_triangle_size(points, triangles);
                                       return solver::make_iso_mesh(points, triangles, options, meshing_control(in));
                                   },
                                   {{"FE230", iso_value.name},
                                    {"FE231", iso_value.name},
                                    {"FE232", triangle_size.name},
                                    {"FE233", max_time.name},
                                    {"FE234", iso_value.name}});
    const auto deviation = guarded(in, meshes.name, [&] {
        return solver::measure_iso_mesh(points, triangles, options.iso_value, mesh.points, mesh.triangles);
    });
    return {Mesh::from(solver::SurfaceMesh::from_triangles(std::move(mesh.points), std::move(mesh.triangles))),
            mesh.components,
            mesh.lost,
            mesh.buried,
            deviation,
            options.triangle_size};
}

std::string rough(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

void warn_of_loss(const Reads& in, const Made& made) {
    const auto& [distance, place, ratio] = made.deviation;
    const bool volume = std::abs(ratio - 1) > usual_volume, detail = distance > usual_triangles * made.triangle;
    if (!volume && !detail) return;
    std::string what;
    if (volume) what = "the new surface encloses " + rough(100 * ratio) + " % of the polygons' volume";
    if (detail)
        what += std::string(volume ? ", and" : "the new surface") + " is off by up to " + rough(distance) + ", " +
                rough(distance / made.triangle) + " triangles, near (" + rough(place.x()) + ", " + rough(place.y()) +
                ", " + rough(place.z()) + ")";
    in.warn(resolution.name, "FE253", what + ": what is thinner than a grid cell or a triangle is lost",
            "Choose a higher resolution and a smaller triangleSize.");
}

void compute(const Reads& in, Writes& out) {
    auto made = in.lease<Made>(key_of(in), [&] { return std::make_shared<Made>(make(in)); });
    if (made->lost > 0)
        in.warn(triangle_size.name, "FE235",
                std::to_string(made->lost) + " of the surface's " + std::to_string(made->components) +
                    " pieces are smaller than a triangle and left out",
                "Choose a smaller triangleSize to keep them.");
    if (made->buried > 0)
        in.warn(meshes.name, "FE274",
                (made->buried == 1 ? std::string("a closed part lies")
                                   : std::to_string(made->buried) + " closed parts lie") +
                    " inside another that faces the same way and bounds no hollow there: the inside is filled",
                "Turn the faces of what shall be a hollow the other way.");
    warn_of_loss(in, *made);
    out.set(out_mesh, made->mesh);
    out.set(out_distance, made->deviation.distance);
    out.set(out_volume_ratio, std::isnan(made->deviation.volume_ratio) ? 0 : made->deviation.volume_ratio);
}

} // namespace

void add_z_iso_mesh(Registry& registry) {
    NodeType type;
    type.name = "zIsoMesh";
    // 2: doubled faces do not count for isoValue <= 0; made near the origin
    type.numerics = 4; // made about the surface's middle, in its size
    type.doc = "Wraps or remeshes polygons: triangles without small angles on the surface at a distance from them.";
    type.inputs = {describe(meshes),     describe(iso_value), describe(triangle_size),
                   describe(resolution), describe(max_time),  describe(produce_manifold_mesh)};
    type.outputs = {describe(out_mesh), describe(out_distance), describe(out_volume_ratio)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
