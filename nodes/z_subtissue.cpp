// zSubtissue: a muscle or other part inside a tissue, with materials and fibres of its own on the tissue's tets.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/appearance.h"
#include "nodes/subtissues.h"
#include "nodes/surface_forces.h"
#include "solver/meshing/layer_place.h"
#include "solver/terms/elastic/rest_change.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The part's closed surface as modelled inside of the tissue, in scene units; it does not change over time. "
           "The tissue's tets are split along it, so that its border is sharp.",
};
const WireList<Material> materials{
    .name = "materials",
    .doc = "Material layers from bottom to top; one at least. They stand where the part is in place of the tissue's, "
           "painted on this mesh.",
};
const WireList<Fiber> fibers{
    .name = "fibers",
    .doc = "Muscle fibres of the part, painted on this mesh, in place of the tissue's; they act and grow within the "
           "part alone.",
};
const Input<double> rest_scale_envelope{
    .name = "restScaleEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "The power to which the restScale of these materials is taken, as with zTissue.",
};
const Input<double> pressure_envelope{
    .name = "pressureEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "Multiplies the pressure of these materials, which acts on this mesh; below 0 it pushes the other way.",
};
const Input<double> surface_tension_envelope{
    .name = "surfaceTensionEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "Multiplies the surfaceTension of these materials, which acts on this mesh; below 0 the surface spreads.",
};
const Input<std::string> appearance = appearance_input(Matter::muscle);
const Input<Vec3> colour = colour_input({0.68, 0.235, 0.2});
const Output<Body> out_body{
    .name = "outBody",
    .doc = "The part: for subtissues of the tissue or part that it lies in, and for zSolver.bodies (beside the tissue, "
           "for its mesh carried along), zAttachment, zGoalAttachment and zEmbedder.",
};

template <class T>
std::vector<T> copies(const std::vector<std::reference_wrapper<const T>>& all) {
    return {all.begin(), all.end()};
}

void compute(const Reads& in, Writes& out) {
    auto part = std::make_shared<Subtissue>();
    part->mesh = in[mesh];
    const auto layers = in[materials];
    check_layers(in, materials.name, layers, part->mesh);
    check_fibers(in, fibers.name, in[fibers], part->mesh);
    struct Kept {
        std::shared_ptr<const solver::Solid> place;
    };
    const Digest shape =
        Hasher().add("zSubtissue.mesh").add(part->mesh.topology->digest).add(part->mesh.points_digest).finish();
    auto kept = in.lease<Kept>(shape, [&] {
        return guarded(in, mesh.name, [&] {
            return std::make_shared<Kept>(Kept{std::make_shared<const solver::Solid>(
                solver::make_layer_place(*part->mesh.points, part->mesh.topology->triangles, meshing_control(in)))});
        });
    });
    part->place = kept->place;
    part->materials = copies(layers), part->fibers = copies(in[fibers]);
    part->rest_scale_envelope = in[rest_scale_envelope];
    part->parts = read_subtissues(in);
    part->digest = static_digest(*part);

    Body body;
    auto rest = in.lease<BodyRest>(part->digest, [&] {
        auto surface = std::make_shared<solver::TissueRest>();
        surface->surface = *part->mesh.points;
        surface->triangles = part->mesh.topology->triangles;
        auto made = std::make_shared<BodyRest>();
        made->data = std::shared_ptr<const solver::TissueRest>(std::move(surface));
        made->mesh = part->mesh;
        made->digest = part->digest;
        return made;
    });
    body.rest = std::make_shared<const BodyRest>(*rest);
    solver::TissueInputs values;
    values.layers = part_inputs(*part).layers;
    for (const Fiber& f : part->fibers) values.fibers.push_back(f.values);
    values.rest_scale_envelope = part->rest_scale_envelope;
    guarded(in, rest_scale_envelope.name, [&] { solver::check_rest_scale(values); });
    guarded(in, fibers.name, [&] { solver::check_growth(values); });
    std::vector<std::reference_wrapper<const Fiber>> all(part->fibers.begin(), part->fibers.end());
    for (const NestedPart& inner : nested_parts(part->parts)) {
        values.subtissues.push_back(part_inputs(*inner.part));
        for (const Fiber& f : inner.part->fibers) values.fibers.push_back(f.values);
        all.insert(all.end(), inner.part->fibers.begin(), inner.part->fibers.end());
    }
    body.lines = lines_of(all); // followed by the tissue; here they say that the part is another at every frame
    body.values = std::move(values);
    add_pressure(in, part->mesh, layers, in[pressure_envelope], body.forces);
    add_surface_tension(in, part->mesh, layers, in[surface_tension_envelope], body.forces);
    body.subtissue = std::move(part);
    out.set(out_body, std::move(body));
}

} // namespace

void add_z_subtissue(Registry& registry) {
    NodeType type;
    type.name = "zSubtissue";
    type.doc =
        "A part of a tissue, such as a muscle in the flesh of an arm: a closed mesh inside it with materials and "
        "fibres of its own. It has no tets and no elastic law but the tissue's, comes out carried by the "
        "tissue, and touches nothing by itself.";
    type.inputs = {describe(mesh),
                   describe(materials),
                   describe(fibers),
                   describe(subtissues),
                   describe(rest_scale_envelope),
                   describe(pressure_envelope),
                   describe(surface_tension_envelope),
                   describe(appearance),
                   describe(colour)};
    type.outputs = {describe(out_body)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
