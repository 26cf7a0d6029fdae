// zTet: the tets of a tissue, as a lattice around its mesh or as the user's own.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/options.h"
#include "solver/meshing/lattice.h"

#include <algorithm>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{.name = "mesh", .doc = "The tissue's surface.", .required = false};
const Input<double> tet_size{
    .name = "tetSize",
    .def = 0,
    .limits = {.min = 0, .max = 1e60},
    .doc = "Side of the lattice's cubes, in scene units, where nothing is refined; no tet is wider. 0 takes "
           "the longest side of the mesh's bounding box / 3.5. Parts nearer to each other than two tets may share "
           "vertices, which tie them together (FE262). Every tet counts as at least a thousandth solid; tets so "
           "large that this adds more than a tenth to the mesh's volume are refused. What the tissue weighs is exact.",
    .keyable = false,
};
const Input<NumberList> weights{
    .name = "weights",
    .def = {0},
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Where the lattice is refined: one number per vertex of the mesh, one for all, or none for 1 "
           "everywhere. Linear between vertices.",
    .keyable = false,
};
const Input<double> surface_refinement{
    .name = "surfaceRefinement",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 20},
    .doc = "How often the tet size is halved at the surface where weights are 1. At a point of the surface it "
           "is tetSize / 2^n, n = envelope * weight * surfaceRefinement rounded up; so with 1, any weight "
           "above 0 halves it once. A tet takes the finest size that its piece of the surface asks for.",
    .keyable = false,
};
const Input<double> refinement_propagation{
    .name = "refinementPropagation",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "How far the inside follows the surface: its size is tetSize / 2^m, m the whole number nearest to "
           "refinementPropagation * n, with n of the nearest surface point. 0 keeps the inside as coarse as "
           "its neighbours allow, 1 makes it as fine as the surface nearby.",
    .keyable = false,
};
const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Strength of the painted refinement: times the weights; 0 is the lattice without refinement.",
    .keyable = false,
};
const Input<std::string> fill_interior{
    .name = "fillInterior",
    .def = std::string(word_of(solver::Fill::filled_cavities)),
    .doc =
        "Which tets are kept. SurfaceOnly: those that the surface passes through, a shell one tet thick, and one more "
        "around each closed surface inside another, which bounds a cavity; a sheet, open or flat, is as thick as "
        "thickness says. FilledCavities: all inside the outer "
        "surface; closed surfaces inside others count for nothing, "
        "and holes and cracks are closed. EmptyCavities: a closed surface inside another bounds an empty "
        "cavity, whichever way it is turned; the mesh must be watertight.",
    .keyable = false,
    .options = words(options_of<solver::Fill>),
};
const Input<double> thickness{
    .name = "thickness",
    .def = 0,
    .limits = {.min = 0, .max = 1e60},
    .doc = "SurfaceOnly: how thick the shell is that the mesh stands for, half of it on either side, in scene units; "
           "tets are solid as far as they lie in it. 0 takes a tenth of tetSize for sheets, open meshes and flat ones, "
           "and of closed meshes all that the shell of tets holds.",
    .keyable = false,
};
const Input<std::int64_t> max_resolution{
    .name = "maxResolution",
    .def = 150,
    .limits = {.min = 1, .max = 100000},
    .doc = "A safety stop: a lattice whose finest cubes would be more than this along the longest side is "
           "refused.",
    .keyable = false,
};
const Input<std::string> element{
    .name = "element",
    .def = std::string(word_of(solver::ElementKind::linear)),
    .doc = "Shape functions of the tets. linear: one strain a tet, quick, too stiff in bending unless tets are small. "
           "quadratic: a further vertex on each edge; takes about ten times as long a tet and is worth it: a few large "
           "tets bend as well as thousands of linear ones, and nearly incompressible flesh does not lock.",
    .keyable = false,
    .options = words(options_of<solver::ElementKind>),
};
const Input<bool> cache_tet_mesh{
    .name = "cacheTetMesh",
    .def = false,
    .doc =
        "Keeps the tets on disk, so that a later run reads them instead of meshing. What is read is what was made, to "
        "the "
        "last bit; when an input has changed, tets are made and kept anew. The folder: `--cache` on the command line, "
        "StorePolicy::disk_folder in a program.",
    .keyable = false,
    .affects = Affects::nothing,
};
const Wire<TetMeshValue> tets{
    .name = "tets",
    .doc = "A tet mesh of your own, used instead of the lattice; mesh, sizes, weights and fillInterior then count for "
           "nothing.",
    .required = false,
};
const Output<TetMeshValue> out_tets{
    .name = "outTets",
    .doc = "The tets, in scene units; connect to zTissue.tets.",
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The boundary triangles of the tets, facing outwards, to look at them, or to carry them along by "
           "zEmbedder; its vertices are those of the tet mesh, numbered alike.",
};

solver::ElementKind element_of(const Reads& in) { return meaning(options_of<solver::ElementKind>, in[element]); }

TetMeshValue make_tets(const Reads& in) {
    const Mesh* m = in.find(mesh);
    if (!m) in.fail(mesh.name, "DG110", "neither mesh nor tets is connected", "Connect the tissue's mesh.");
    const NumberList& painted = in[weights];
    check_map(in, weights.name, painted, m->points->size(), "weights", "vertex", in.source_name(weights.name));
    solver::LatticeOptions options;
    options.tet_size = in[tet_size];
    options.max_resolution = static_cast<int>(in[max_resolution]);
    options.fill = meaning(options_of<solver::Fill>, in[fill_interior]);
    options.thickness = options.fill == solver::Fill::surface_only ? in[thickness] : 0;
    options.propagation = in[refinement_propagation];
    if (element_of(in) == solver::ElementKind::quadratic) options.moments = 4;
    options.refinement = painted.empty() ? NumberList{1} : painted;
    for (double& w : options.refinement) w *= in[envelope] * in[surface_refinement];
    const bool is_refined =
        std::any_of(options.refinement.begin(), options.refinement.end(), [](double levels) { return levels > 0; });
    return guarded(in, mesh.name,
                   [&] {
                       return TetMeshValue::from(
                           solver::make_lattice(*m->points, m->topology->triangles, options, meshing_control(in)));
                   },
                   {{"FE222", tet_size.name},
                    {"FE210", is_refined ? surface_refinement.name : tet_size.name},
                    {"FE220", fill_interior.name},
                    {"FE298", thickness.name}});
}

void compute(const Reads& in, Writes& out) {
    const TetMeshValue* own = in.find(tets);
    if (own && element_of(in) == solver::ElementKind::quadratic && !own->mesh->cut.tets.empty() &&
        own->mesh->cut.degree != 4)
        in.fail(tets.name, "DG110", "these tets are a lattice for linear elements; here element is quadratic",
                "Set element to quadratic on the zTet that makes the lattice.");
    const auto is_thinner = [](double share) { return share < 1; };
    if (own && element_of(in) == solver::ElementKind::quadratic && own->mesh->cut.tets.empty() &&
        std::ranges::any_of(own->mesh->coverage, is_thinner))
        in.warn(tets.name, "FE346",
                "of tets that the surface cuts only the share that is solid is known, so quadratic ones are taken for "
                "thinner all over",
                "Connect the tissue's mesh and let zTet make the tets, or take linear ones, to which the share is "
                "nearly enough.");
    TetMeshValue result = (own ? *own : make_tets(in)).with_element(element_of(in));
    out.set(out_mesh, Mesh::from(solver::SurfaceMesh::from_triangles(result.mesh->vertices,
                                                                     solver::boundary_triangles(result.mesh->tets))));
    out.set(out_tets, std::move(result));
}

} // namespace

void add_z_tet(Registry& registry) {
    NodeType type;
    type.name = "zTet";
    // 2: closed surfaces inside others are filled unless fillInterior says otherwise
    // 3: triangles and parts that face the wrong way are turned; too large tets refused
    // 4: tets that the surface cuts know the moments of their part inside
    // 5: SurfaceOnly keeps the skins of cavities
    // 6: SurfaceOnly takes sheets for shells
    type.numerics = 7; // sides of triangles in sharp folds are known
    type.doc = "Fills a mesh with tets: a body-centred cubic lattice, 12 tets a cube, that the mesh is embedded "
               "in; finer where weights are painted, without gaps between the sizes. Every tet knows how much "
               "of it is inside the mesh. The mesh may have holes, cracks and parts that cross. Tets are made "
               "anew only when an input changes.";
    type.inputs = {describe(mesh),
                   describe(tet_size),
                   describe(weights),
                   describe(surface_refinement),
                   describe(refinement_propagation),
                   describe(envelope),
                   describe(fill_interior),
                   describe(thickness),
                   describe(max_resolution),
                   describe(element),
                   describe(cache_tet_mesh),
                   describe(tets)};
    type.outputs = {describe(out_tets), describe(out_mesh)};
    type.kept_when = cache_tet_mesh.name;
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
