// muscleCurve: a first curve through a muscle, for a line of action.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/options.h"
#include "nodes/painted_volume.h"
#include "solver/fiber/muscle_path.h"
#include "solver/linear/blas_kernel.h"
#include "solver/meshing/lattice.h"

#include <algorithm>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{.name = "mesh", .doc = "The muscle's surface as modelled, that of zTissue.mesh."};
const Wire<TetMeshValue> tets{
    .name = "tets",
    .doc = "The muscle's tets, from zTet or a file. Without it: a lattice of the default size.",
    .required = false,
};
const Input<NumberList> end_points{
    .name = "endPoints",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Where the fibres begin and end, as zFiber.endPoints takes it; connect endPoints.outEndPoints.",
    .required = true,
};
const Input<std::int64_t> count{
    .name = "pointCount",
    .def = 6,
    .limits = {.min = 2, .max = 1000},
    .doc = "How many points the curve has: the middles of origin and insertion, and of sections between.",
    .keyable = false,
};
const Input<std::string> form{
    .name = "form",
    .def = std::string(word_of(solver::CurveForm::cubic)),
    .doc = "As curve.form; a cubic of fewer than four points is a polyline.",
    .keyable = false,
    .options = words(options_of<solver::CurveForm>),
};
const Output<CurvePoints> out_curve{
    .name = "outCurve",
    .doc = "The curve where the muscle is modelled, in scene units; for zRivetToBone.curve. `sinew eval GRAPH "
           "NODE.outCurve` prints its points, to be written into a curve and moved by hand.",
};

void compute(const Reads& in, Writes& out) {
    const Mesh& m = in[mesh];
    const NumberList& given = in[end_points];
    check_map(in, end_points.name, given, m.points->size(), "endPoints of the muscle's curve", "vertex",
              in.source_name(end_points.name));
    std::vector<char> painted;
    NumberList ends;
    for (const double e : per_vertex(given, m.points->size())) {
        painted.push_back(is_source(e) || is_sink(e));
        ends.push_back(is_source(e) ? 0.0 : is_sink(e) ? 1.0 : e);
    }
    const bool begins = std::any_of(ends.begin(), ends.end(), [](double e) { return e == 0; });
    if (!begins || std::none_of(ends.begin(), ends.end(), [](double e) { return e == 1; }))
        in.fail(end_points.name, "FE205",
                std::string("the muscle's curve has no ") + (begins ? "sink" : "source") + " to run between",
                "Paint endPoints: up to 0.1 where the fibres begin, from 0.9 on where they end.");
    CurvePoints curve;
    curve.points = guarded(in, mesh.name, [&] {
        solver::check_usable(m.surface());
        const TetMeshValue* given_tets = in.find(tets);
        const std::vector<solver::Triangle>& triangles = m.topology->triangles;
        const solver::TetMesh made =
            given_tets ? solver::TetMesh{} : solver::make_lattice(*m.points, triangles, {}, meshing_control(in));
        const solver::TetMesh& use = given_tets ? *given_tets->mesh : made;
        const solver::Embedding embedding = solver::embed(use, *m.points);
        return solver::muscle_path(use, {*m.points, triangles, embedding}, ends, painted, static_cast<int>(in[count]));
    });
    curve.modelled = curve.points;
    curve.form = meaning(options_of<solver::CurveForm>, in[form]);
    if (curve.points.size() < 4) curve.form = solver::CurveForm::polyline;
    out.set(out_curve, std::move(curve));
}

} // namespace

void add_muscle_curve(Registry& registry) {
    NodeType type;
    type.name = "muscleCurve";
    type.machine = solver::machine_numerics();
    type.doc = "Lays a curve through a muscle from origin to insertion: a first path for its line of action.";
    type.inputs = {describe(mesh), describe(tets), describe(end_points), describe(count), describe(form)};
    type.outputs = {describe(out_curve)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
