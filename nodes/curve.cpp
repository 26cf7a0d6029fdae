// curve: a polyline or a cubic by its control points, from numbers in the graph or from a file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/curve_file.h"
#include "nodes/json_file.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"
#include "nodes/options.h"
#include "solver/mesh/coordinates.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<NumberList> points{
    .name = "points",
    .limits = within_reach,
    .doc = "The points one after the other: x, y, z, x, y, z, … in scene units.",
};
const Input<File> file{
    .name = "file",
    .doc = "A file with the points, instead of `points`: JSON (a list of [x, y, z]) or text (three "
           "numbers a line; # begins a comment).",
};
const Input<std::string> key{
    .name = "key",
    .doc = "JSON files: pointer to the list, for example /lines_of_action/biceps/polyline; "
           "empty if the file is the list.",
};
const Input<std::string> form{
    .name = "form",
    .def = std::string(word_of(solver::CurveForm::polyline)),
    .doc = "polyline goes through all points; cubic is smooth, begins at the first and ends at the last of four points "
           "or more and lies near those between, as curves of degree 3 do elsewhere.",
    .keyable = false,
    .options = words(options_of<solver::CurveForm>),
};
const Input<Matrix4> matrix{
    .name = "matrix",
    .def = identity_matrix,
    .limits = within_reach,
    .doc = "Moves all points; connect transform.outMatrix. Where points shall follow bones: zRivetToBone.",
};
const Output<CurvePoints> out_curve{.name = "outCurve", .doc = "The curve, in scene units."};
const Output<double> out_length{.name = "outLength", .doc = "Its length, in scene units."};

void compute(const Reads& in, Writes& out) {
    const bool by_file = !in[file].path.empty();
    const std::string_view source = by_file ? file.name : points.name;
    if (by_file && !in[points].empty())
        in.fail(points.name, "DG110", "both points and file are given", "Keep one of them.");
    const NumberList numbers =
        by_file ? guarded(in, file.name,
                          [&] {
                              return parse_curve(read_text(in.files(), in[file].path, most_json_bytes), in[file].path,
                                                 in[key]);
                          })
                : in[points];
    if (numbers.size() % 3 != 0 || numbers.size() < 6)
        in.fail(source, "FE216", std::to_string(numbers.size()) + " numbers do not make a polyline",
                "Give x, y and z of two points or more.");
    check_affine(in, matrix.name, in[matrix]);
    CurvePoints curve;
    curve.form = meaning(options_of<solver::CurveForm>, in[form]);
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        curve.modelled.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    guarded(in, source, [&] { solver::check_coordinates(curve.modelled); });
    curve.points = guarded(in, matrix.name, [&] { return moved(curve.modelled, in[matrix]); });
    guarded(in, form.name, [&] { solver::check_curve(curve); });
    out.set(out_length, solver::curve_length(curve));
    out.set(out_curve, std::move(curve));
}

} // namespace

void add_curve(Registry& registry) {
    NodeType type;
    type.name = "curve";
    type.doc = "A curve in space, for example the path of a muscle for zLineOfAction.";
    type.inputs = {describe(points), describe(file), describe(key), describe(form), describe(matrix)};
    type.outputs = {describe(out_curve), describe(out_length)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
