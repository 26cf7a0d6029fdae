// curve: a polyline, from numbers in the graph or from a file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/json_file.h"

#include <locale>
#include <sstream>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<NumberList> points{
    .name = "points",
    .doc = "The points one after the other: x, y, z, x, y, z, … in scene units.",
};
const Input<File> file{
    .name = "file",
    .doc = "A file with the points, instead of `points`: JSON (a list of [x, y, z]) or text (three "
           "numbers a line).",
};
const Input<std::string> key{
    .name = "key",
    .doc = "JSON files: pointer to the list, for example /lines_of_action/biceps/polyline; "
           "empty if the file is the list.",
};
const Output<CurvePoints> out_curve{.name = "outCurve", .doc = "The polyline, in scene units."};

NumberList from_text(const std::string& path) {
    std::istringstream text(read_text(path));
    text.imbue(std::locale::classic());
    NumberList out;
    for (double number = 0; text >> number;) out.push_back(number);
    if (!text.eof())
        throw solver::Error("IO403", "'" + path + "' holds more than numbers", "Write three numbers a line.");
    return out;
}

NumberList from_file(const std::string& path, const std::string& pointer) {
    if (!path.ends_with(".json")) return from_text(path);
    const nlohmann::json json = read_json(path);
    return numbers_of(part_of(json, pointer, path), "the curve", path);
}

void compute(const Reads& in, Writes& out) {
    const bool by_file = !in[file].path.empty();
    const std::string_view source = by_file ? file.name : points.name;
    if (by_file && !in[points].empty())
        in.fail(points.name, "DG110", "both points and file are given", "Keep one of them.");
    const NumberList numbers =
        by_file ? guarded(in, file.name, [&] { return from_file(in[file].path, in[key]); }) : in[points];
    if (numbers.size() % 3 != 0 || numbers.size() < 6)
        in.fail(source, "FE216", std::to_string(numbers.size()) + " numbers do not make a polyline",
                "Give x, y and z of two points or more.");
    CurvePoints curve;
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        curve.points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    out.set(out_curve, std::move(curve));
}

} // namespace

void add_curve(Registry& registry) {
    NodeType type;
    type.name = "curve";
    type.doc = "A polyline, for example a muscle's line of action.";
    type.inputs = {describe(points), describe(file), describe(key)};
    type.outputs = {describe(out_curve)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
