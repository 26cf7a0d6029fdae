// Writes and reads zSolver's state as bytes, little-endian as the machine is.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/simulation_state.h"

#include "engine/byte_stream.h"
#include "engine/diagnostics.h"
#include "solver/error.h"

namespace sinew::nodes {

namespace {

constexpr std::uint64_t format_mark = 0x36307a5f77656e69; // "inew_z06"

[[noreturn]] void refuse(const std::string& what) {
    engine::Diagnostic d;
    d.code = "IO403";
    d.message = "the saved state cannot be read: " + what;
    d.hint = "Simulate again from the start frame.";
    throw engine::Failure(d);
}

} // namespace

void write(const SimulationState& state, const solver::ByteSink& to) {
    engine::ByteWriter w;
    w.put(format_mark);
    w.put(state.scene.scale);
    w.put(state.scene.frame);
    w.put_list(state.scene.bodies);
    for (std::size_t b = 0; b < state.scene.bodies.size(); ++b) {
        const ModelledBone bone = b < state.scene.modelled.size() ? state.scene.modelled[b] : ModelledBone{};
        w.put<std::uint8_t>(bone.points ? 1 : 0);
        if (!bone.points) continue;
        w.put(bone.digest);
        w.put_list(std::span<const double>(bone.points->empty() ? nullptr : bone.points->front().data(),
                                           3 * bone.points->size()));
    }
    w.put_list(state.scene.attachments);
    w.put_list(state.scene.links);
    w.put_list(state.scene.forces);
    for (const std::vector<int>& bodies : state.scene.reach) w.put_list(bodies);
    w.put(state.scene.contacts);
    w.put(state.residual_body);
    w.put_list(state.scene.lines);
    w.put_list(state.lines);
    to(w.bytes);
    solver::write(state.state, to);
}

std::vector<std::byte> save(const SimulationState& state) {
    std::size_t size = 0; // told before, for to grow costs several times as much
    write(state, [&](std::span<const std::byte> bytes) { size += bytes.size(); });
    std::vector<std::byte> out;
    out.reserve(size);
    write(state, [&](std::span<const std::byte> bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); });
    return out;
}

SimulationState load_simulation(std::span<const std::byte> bytes) {
    SimulationState out;
    try {
        engine::ByteReader r(bytes);
        if (r.get<std::uint64_t>() != format_mark) refuse("it is not a state of this version");
        out.scene.scale = r.get<double>();
        out.scene.frame = r.get<engine::Matrix4>();
        out.scene.bodies = r.get_list<engine::Digest>();
        for (std::size_t b = 0; b < out.scene.bodies.size(); ++b) {
            ModelledBone& bone = out.scene.modelled.emplace_back();
            if (!r.get<bool>()) continue;
            bone.digest = r.get<engine::Digest>();
            const std::vector<double> places = r.get_list<double>();
            if (places.size() % 3 != 0) refuse("a bone's vertices are not three numbers each");
            solver::Points points(places.size() / 3);
            for (std::size_t i = 0; i < points.size(); ++i)
                points[i] = solver::Vec3(places[3 * i], places[3 * i + 1], places[3 * i + 2]);
            bone.points = std::make_shared<const solver::Points>(std::move(points));
        }
        out.scene.attachments = r.get_list<engine::Digest>();
        out.scene.links = r.get_list<std::array<int, 2>>();
        out.scene.forces = r.get_list<engine::Digest>();
        for (std::size_t i = 0; i < out.scene.forces.size(); ++i) out.scene.reach.push_back(r.get_list<int>());
        out.scene.contacts = r.get<std::uint64_t>();
        if (out.scene.contacts > out.scene.forces.size()) refuse("it has more contacts than forces");
        out.residual_body = r.get<int>();
        out.scene.lines = r.get_list<engine::Digest>();
        out.lines = r.get_list<solver::LineMemory>();
        if (out.lines.size() != out.scene.lines.size()) refuse("it has other lines of action than its scene");
        out.state = solver::load(r.rest);
    } catch (const engine::BadBytes& e) {
        refuse(e.what());
    } catch (const solver::Error& e) {
        refuse(e.what());
    }
    return out;
}

} // namespace sinew::nodes
