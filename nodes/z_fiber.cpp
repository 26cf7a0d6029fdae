// zFiber: muscle fibres that pull along the muscle when they are excited, and across which it may grow.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/json_file.h"
#include "nodes/limits.h"

#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Scales the excitation, and is an exponent of the growth.",
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc =
        "Local strength: one number per vertex of the tissue's mesh, one for all, or none for full strength. Also an "
        "exponent of the growth: 0 does not grow.",
};
const Input<NumberList> end_points{
    .name = "endPoints",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "One number per vertex: up to 0.1 where the fibres begin, from 0.9 on where they end, else in "
           "between. "
           "The fibres run from the first to the second, as many from each piece of the area where they begin and to "
           "each where they end; connect endPoints.outEndPoints. Not needed where direction, directions or "
           "directionsFile say how they run.",
};
const Input<Vec3> direction{
    .name = "direction",
    .unit = "1",
    .limits = within_reach,
    .doc = "The direction of all fibres, in scene space as the tissue is modelled; of any length, which does not "
           "count. 0 0 0: it follows from the others.",
    .keyable = false,
};
const Input<NumberList> directions{
    .name = "directions",
    .unit = "1",
    .limits = within_reach,
    .doc = "The direction of the fibres in each tet: 3 numbers a tet in the order of zTissue.tets, or 3 for all. "
           "Of any length, which does not count; where it is 0 there is no fibre.",
    .keyable = false,
};
const Input<File> directions_file{
    .name = "directionsFile",
    .doc = "A JSON file with a list as directions takes it; lists of three in a list will do too.",
};
const Input<std::string> directions_key{
    .name = "directionsKey",
    .doc = "JSON pointer to the list in directionsFile, for example /biceps/directions; empty if the file is the list.",
};
const Input<double> strength{
    .name = "strength",
    .def = 12e3,
    .unit = "Pa",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Stiffness of the pull along the fibres at full excitation.",
};
const Input<double> contraction_limit{
    .name = "contractionLimit",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "The share of its length that a fibre pulls towards: 0 to nothing, 0.5 to half, 1 stiffens without "
           "shortening.",
};
const Input<double> excitation{
    .name = "excitation",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc =
        "0 relaxed to 1 fully excited; usually keyed or driven by trackChannel.outValue. What a line of action gives "
        "is added, and the sum kept between 0 and 1.",
};
const Wire<LineOfAction> line_of_action{
    .name = "lineOfAction",
    .doc = "The muscle's path, from zLineOfAction.outLineOfAction; its shortening excites the fibres.",
    .required = false,
};
const Input<bool> enable_muscle_growth{
    .name = "enableMuscleGrowth",
    .def = false,
    .doc = "Lets the muscle be thicker or thinner at rest by muscleGrowthScale.",
};
const Input<double> muscle_growth_scale{
    .name = "muscleGrowthScale",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1000, .open_min = true},
    .doc = "Scales the muscle's width at rest across the fibres by this to the power of envelope and weights; its "
           "length along them stays. 2 makes four times the volume, 0.5 a quarter. Neither heavier nor stiffer per "
           "volume. Excitation and strength play no part. Those of several fibres multiply.",
};
const Input<bool> use_loa_for_muscle_growth{
    .name = "useLoaForMuscleGrowth",
    .def = false,
    .doc = "Raises muscleGrowthScale to the power of the line of action's loaValue: the muscle grows as its path "
           "shortens, and without a line of action not at all.",
};
const Output<Fiber> out_fiber{.name = "outFiber", .doc = "The fibres; connect to zTissue.fibers."};

/// The directions as given, 3 numbers for all tets or 3 a tet; none if they follow from the end points.
NumberList given_directions(const Reads& in) {
    const bool has_vector = in[direction] != Vec3{}, has_list = !in[directions].empty(),
               has_file = !in[directions_file].path.empty();
    if (has_vector + has_list + has_file + !in[end_points].empty() > 1)
        in.fail(has_vector ? direction.name
                : has_list ? directions.name
                           : directions_file.name,
                "DG110", "the direction of the fibres is given more than once",
                "Keep one of endPoints, direction, directions and directionsFile.");
    if (!in[directions_key].empty() && !has_file)
        in.fail(directions_key.name, "DG110", "a directionsKey is given but no directionsFile",
                "Give the file that it points into, or leave it out.");
    if (has_vector) return {in[direction].begin(), in[direction].end()};
    if (!has_list && !has_file) return {};
    const std::string_view from = has_list ? directions.name : directions_file.name;
    NumberList list = has_list ? in[directions] : guarded(in, from, [&] {
        const std::string& path = in[directions_file].path;
        return numbers_of(part_of(read_json(in.files(), path), in[directions_key], path), "the list of directions",
                          path);
    });
    if (list.empty())
        in.fail(from, "FE227", "the list of directions is empty", "Give 3 numbers for each tet, or 3 for all.");
    if (list.size() % 3 != 0)
        in.fail(from, "FE227", std::to_string(list.size()) + " numbers cannot be directions of three",
                "Give 3 numbers for each tet.");
    for (std::size_t i = 0; i < list.size(); ++i)
        if (!std::isfinite(list[i]))
            in.fail(from, "FE202", "the direction of tet " + std::to_string(i / 3) + " is not a finite number",
                    "Repair it; 0 0 0 stands for no fibre.");
    if (std::all_of(list.begin(), list.end(), [](double c) { return c == 0; }))
        in.fail(from, "FE212", "all directions are 0 0 0, so there is no fibre", "Give some tets a direction.");
    return list;
}

/// What zFiber.muscleGrowthScale comes to, where it follows the line of action at a loaValue of 1; 1: none.
double growth(const Reads& in) {
    if (!in[enable_muscle_growth]) return 1;
    if (!in[use_loa_for_muscle_growth] || in.find(line_of_action)) return in[muscle_growth_scale];
    // To the power of a loaValue of 0.
    if (in[muscle_growth_scale] != 1)
        in.warn(use_loa_for_muscle_growth.name, "FE248",
                "growth follows a line of action, but the fibre has none, so it does not grow",
                "Connect a zLineOfAction to lineOfAction, or switch useLoaForMuscleGrowth off and key "
                "muscleGrowthScale where it shall change.");
    return 1;
}

void compute(const Reads& in, Writes& out) {
    Fiber f;
    f.values = {in[strength], in[contraction_limit], in[excitation], in[envelope], growth(in)};
    f.weights = in[weights];
    f.end_points = in[end_points];
    f.directions = given_directions(in);
    if (const LineOfAction* line = in.find(line_of_action)) {
        f.line = std::make_shared<const LineOfAction>(*line);
        f.growth_follows_line = in[enable_muscle_growth] && in[use_loa_for_muscle_growth];
    }
    out.set(out_fiber, std::move(f));
}

} // namespace

void add_z_fiber(Registry& registry) {
    NodeType type;
    type.name = "zFiber";
    type.doc = "Fibres of a muscle that contract by excitation, and across which it may grow.";
    type.inputs = {describe(envelope),
                   describe(weights),
                   describe(end_points),
                   describe(direction),
                   describe(directions),
                   describe(directions_file),
                   describe(directions_key),
                   describe(strength),
                   describe(contraction_limit),
                   describe(excitation),
                   describe(line_of_action),
                   describe(enable_muscle_growth),
                   describe(muscle_growth_scale),
                   describe(use_loa_for_muscle_growth)};
    type.outputs = {describe(out_fiber)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
