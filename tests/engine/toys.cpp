// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <cmath>
#include <cstring>
#include <filesystem>

namespace toys {

namespace {

const Output<double> out{.name = "out", .doc = "The number."};

void add_number(Registry& r, std::shared_ptr<Counts> counts) {
    static const Input<double> value{.name = "value",
                                     .def = 1,
                                     .unit = "Pa",
                                     .limits = {.min = 0, .max = 1e9},
                                     .doc = "A number.",
                                     .presets = {{"fat", 500.0}, {"muscle", 12000.0}}};
    static const Input<bool> show{.name = "show", .def = true, .doc = "Viewport only.", .affects = Affects::nothing};
    static const Input<std::string> mode{.name = "mode", .def = "plain", .doc = "How.", .options = {"plain", "double"}};
    static const Input<Vec3> axis{.name = "axis", .def = {0, 1, 0}, .unit = "m", .doc = "A vector."};
    static const Input<std::int64_t> times{.name = "times", .def = 1, .limits = {.min = 1}, .doc = "A factor."};
    static const Input<bool> negate{.name = "negate", .def = false, .doc = "The other sign."};
    static const Input<NumberList> weights{
        .name = "weights", .def = {}, .limits = {.min = 0, .max = 1}, .doc = "A list."};
    static const Input<Matrix4> matrix{
        .name = "matrix", .def = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, .doc = "A matrix."};
    r.add({.name = "number",
           .doc = "A number.",
           .inputs = {describe(value), describe(show), describe(mode), describe(axis), describe(times),
                      describe(negate), describe(weights), describe(matrix)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               if (counts->on_compute) counts->on_compute();
               const double factor = (in[mode] == "double" ? 2.0 : 1.0) * static_cast<double>(in[times]);
               w.set(out, in[value] * (in[negate] ? -factor : factor));
           }});
}

void add_arithmetic(Registry& r, std::shared_ptr<Counts> counts) {
    static const Wire<double> in_wire{.name = "in", .doc = "What to pass on."};
    static const WireList<double> terms{.name = "terms", .doc = "What to add.", .min_count = 1};
    static const Output<std::string> text{.name = "text", .doc = "In words."};
    r.add({.name = "relay",
           .doc = "Adds 1.",
           .inputs = {describe(in_wire)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes& w) { ++counts->computes, w.set(out, in[in_wire] + 1); }});
    r.add({.name = "sum",
           .doc = "Adds.",
           .inputs = {describe(terms)},
           .outputs = {describe(out), describe(text)},
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               double sum = 0;
               for (double t : in[terms]) sum += t;
               w.set(out, sum);
               w.set<std::string>(text, std::to_string(sum));
           }});
    r.add({.name = "clock",
           .doc = "The time.",
           .outputs = {describe(out)},
           .uses_time = true,
           .compute = [counts](const Reads& in, Writes& w) { ++counts->computes, w.set(out, in.frame() / in.fps()); }});
    static const Input<double> rate{.name = "rate", .doc = "A frame."};
    r.add({.name = "drift",
           .doc = "Grows with the frame where it has a rate.",
           .inputs = {describe(rate)},
           .outputs = {describe(out)},
           .uses_time = true,
           .time_input = "rate",
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               w.set(out, in[rate] == 0 ? 5 : in[rate] * in.frame());
           }});
    r.add({.name = "decade",
           .doc = "Tens of frames.",
           .outputs = {describe(out)},
           .uses_time = true,
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               w.set(out, std::floor(in.frame() / 10));
           }});
    static const Input<Matrix4> matrix{
        .name = "matrix", .def = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, .doc = "A matrix."};
    static const Input<Vec3> translate{.name = "translate", .doc = "Moves it further."};
    r.add({.name = "place",
           .doc = "Where a matrix and a shift take the origin, as one number.",
           .inputs = {describe(matrix), describe(translate)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               const Matrix4& m = in[matrix];
               const Vec3& t = in[translate];
               w.set(out, (m[3] + t[0]) + 10 * (m[7] + t[1]) + 100 * (m[11] + t[2]));
           }});
}

void add_troublemakers(Registry& r, std::shared_ptr<Counts> counts) {
    static const Input<double> value{.name = "value", .def = 1, .doc = "A number."};
    static const Input<double> other{.name = "other", .def = 1, .doc = "Declared elsewhere."};
    static const Input<bool> show{.name = "show", .def = true, .doc = "Viewport only.", .affects = Affects::nothing};
    static const Input<File> file{.name = "file", .def = {}, .doc = "A file.", .required = true};
    r.add({.name = "warner",
           .doc = "Warns.",
           .inputs = {describe(value)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               in.warn("value", "FE207", "mind the gap", "step over it");
               w.set(out, in[value]);
           }});
    r.add({.name = "failer",
           .doc = "Fails.",
           .inputs = {describe(value)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes&) {
               ++counts->computes;
               in.fail("value", "FE201", "nothing to work on");
           }});
    r.add({.name = "crasher", .doc = "Has a bug.", .outputs = {describe(out)}, .compute = [](const Reads&, Writes&) {
               throw std::out_of_range("a bug");
           }});
    r.add({.name = "undeclared",
           .doc = "Reads what it did not declare.",
           .inputs = {describe(value)},
           .outputs = {describe(out)},
           .compute = [](const Reads& in, Writes& w) { w.set(out, in[other]); }});
    r.add({.name = "peek",
           .doc = "Reads what affects nothing.",
           .inputs = {describe(show)},
           .outputs = {describe(out)},
           .compute = [](const Reads& in, Writes& w) { w.set(out, in[show] ? 1.0 : 0.0); }});
    r.add({.name = "timeThief",
           .doc = "Asks for the time without saying so.",
           .outputs = {describe(out)},
           .compute = [](const Reads& in, Writes& w) { w.set(out, in.frame()); }});
    r.add({.name = "forgetful",
           .doc = "Writes nothing.",
           .outputs = {describe(out)},
           .compute = [](const Reads&, Writes&) {}});
    r.add({.name = "fileSize",
           .doc = "The size of a file.",
           .inputs = {describe(file)},
           .outputs = {describe(out)},
           .compute = [counts](const Reads& in, Writes& w) {
               ++counts->computes;
               w.set(out, static_cast<double>(std::filesystem::file_size(in[file].path)));
           }});
}

void add_simulation(Registry& r, std::shared_ptr<Counts> counts) {
    static const Input<double> start{
        .name = "startFrame", .def = 1, .doc = "First frame.", .keyable = false, .from_timing = FromTiming::start};
    static const Input<std::int64_t> substeps{
        .name = "substeps", .def = 1, .limits = {.min = 1}, .doc = "Steps a frame."};
    static const Input<double> stiffness{.name = "stiffness", .def = 1, .limits = {.min = 0}, .doc = "Of the spring."};
    static const Input<double> height{
        .name = "height", .def = 2, .doc = "Where it starts.", .affects = Affects::initial_state};
    static const Input<std::string> color{
        .name = "color", .def = "red", .doc = "Viewport only.", .affects = Affects::nothing};
    static const Input<double> fail_at{
        .name = "failAt", .def = 1e6, .doc = "Frame that does not work.", .keyable = false};
    static const Input<bool> nosy{.name = "nosy", .def = false, .doc = "Reads the initial state while stepping."};
    static const Input<double> gain{.name = "gain", .def = 0, .doc = "Of the output.", .keyable = true};
    static const Input<std::string> scheme{
        .name = "scheme", .def = "plain", .doc = "How time is stepped.", .options = {"plain", "staged"}};
    static const Wire<double> target{.name = "target", .doc = "What it is pulled to.", .required = false};
    struct Buffer {
        std::vector<double> memory;
    };
    SimulationType<ToyState> t;
    t.base = {.name = "sim",
              .doc = "A damped spring with history.",
              .inputs = {describe(start), describe(substeps), describe(stiffness), describe(height), describe(color),
                         describe(fail_at), describe(nosy), describe(gain), describe(scheme), describe(target)},
              .outputs = {describe(out)}};
    t.initial = [counts](const Reads& in) {
        ++counts->initials;
        return ToyState{in[height], in[height], 0, 0};
    };
    t.advance = [counts](const ToyState& before, std::span<const SubstepReads> substeps_in) {
        ++counts->advances;
        const Reads& now = substeps_in.back().end;
        const double frame = now.frame();
        if (counts->on_advance) counts->on_advance(frame);
        if (frame == now[fail_at]) now.fail("failAt", "FE302", "it flew apart");
        if (now[nosy]) (void)now[height];
        ToyState s = before;
        auto buffer = now.lease<Buffer>(Hasher().add("buffer").finish(), [] { return std::make_shared<Buffer>(); });
        buffer->memory.assign(16, frame); // what an earlier step left in it must not matter
        for (const SubstepReads& step : substeps_in) {
            const Reads& in = step.end;
            for (const Reads& stage : step.within) {
                counts->stages.push_back(stage.frame());
                const double* pulled = stage.find(target);
                s.v -= 0.001 * stage[stiffness] * (s.x - (pulled ? *pulled : 0));
            }
            in.checkpoint();
            in.progress(0.5, "step");
            const double h = 1.0 / static_cast<double>(substeps_in.size());
            const double* pulled = in.find(target);
            const double force = -in[stiffness] * (s.x - (pulled ? *pulled : 0)) - 0.1 * s.v;
            s.v += 0.01 * h * force;
            const double x = s.x + h * s.v + 0.05 * (s.x - s.x_before);
            s.x_before = s.x, s.x = x, ++s.steps;
        }
        return s;
    };
    t.rehearse = [counts](const ToyState& before, std::span<const SubstepReads> substeps_in) {
        ++counts->rehearsals;
        ToyState s = before;
        for (const SubstepReads& step : substeps_in) {
            for (const Reads& stage : step.within) counts->stages.push_back(stage.frame());
            if (step.end[stiffness] > 1000) step.end.fail("stiffness", "FE304", "too stiff");
            ++s.steps;
        }
        counts->rehearsed_steps.push_back(s.steps);
        const Reads& now = substeps_in.back().end;
        if (now.frame() == now[fail_at]) now.warn("failAt", "FE301", std::to_string(s.steps));
        return s;
    };
    t.publish = [counts](const ToyState& s, const Reads& in, Writes& w) {
        ++counts->publishes;
        w.set(out, s.x * (1 + in[gain]));
    };
    t.save = [](const ToyState& s) {
        std::vector<std::byte> bytes(sizeof s);
        std::memcpy(bytes.data(), &s, sizeof s);
        return bytes;
    };
    t.load = [](std::span<const std::byte> bytes) {
        ToyState s;
        std::memcpy(&s, bytes.data(), sizeof s);
        return s;
    };
    t.stages_input = scheme.name;
    t.stages = [](const Value& v) {
        return v.as<std::string>() == "staged" ? std::vector<double>{0.25, 0.5} : std::vector<double>{};
    };
    r.add(std::move(t));
}

} // namespace

std::shared_ptr<const Registry> registry(std::shared_ptr<Counts> counts) {
    auto r = std::make_shared<Registry>();
    add_number(*r, counts);
    add_arithmetic(*r, counts);
    add_troublemakers(*r, counts);
    add_simulation(*r, counts);
    return r;
}

std::shared_ptr<const Graph> graph(const std::shared_ptr<const Registry>& r, const std::string& nodes) {
    return read_graph(
               r, R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 100}, "nodes": {)" + nodes + "}}",
               "toy.json")
        .graph;
}

} // namespace toys
