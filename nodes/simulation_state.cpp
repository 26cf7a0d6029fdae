// Writes and reads zSolver's state as bytes, little-endian as the machine is.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/simulation_state.h"

#include "engine/diagnostics.h"
#include "solver/error.h"

#include <cstring>
#include <type_traits>

namespace sinew::nodes {

namespace {

constexpr std::uint64_t format_mark = 0x31307a5f77656e69; // "inew_z01"

class Writer {
  public:
    template <class T>
    void put(const T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* p = reinterpret_cast<const std::byte*>(&v);
        bytes.insert(bytes.end(), p, p + sizeof(T));
    }
    template <class T>
    void put_list(const std::vector<T>& list) {
        put<std::uint64_t>(list.size());
        for (const T& v : list) put(v);
    }
    std::vector<std::byte> bytes;
};

[[noreturn]] void refuse(const std::string& what) {
    engine::Diagnostic d;
    d.code = "IO403";
    d.message = "the saved state cannot be read: " + what;
    d.hint = "Simulate again from the start frame.";
    throw engine::Failure(d);
}

class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes)
        : rest(bytes) {}
    template <class T>
    T get() {
        T v;
        if (rest.size() < sizeof(T)) refuse("it ends too early");
        std::memcpy(&v, rest.data(), sizeof(T));
        rest = rest.subspan(sizeof(T));
        return v;
    }
    template <class T>
    std::vector<T> get_list() {
        const auto n = get<std::uint64_t>();
        if (n > rest.size() / sizeof(T)) refuse("it ends too early");
        std::vector<T> out(n);
        for (T& v : out) v = get<T>();
        return out;
    }
    std::span<const std::byte> rest;
};

} // namespace

std::vector<std::byte> save(const SimulationState& state) {
    Writer w;
    w.put(format_mark);
    w.put(state.scene.scale);
    w.put_list(state.scene.bodies);
    w.put_list(state.scene.attachments);
    w.put_list(state.scene.links);
    const std::vector<std::byte> inner = solver::save(state.state);
    w.bytes.insert(w.bytes.end(), inner.begin(), inner.end());
    return std::move(w.bytes);
}

SimulationState load_simulation(std::span<const std::byte> bytes) {
    Reader r(bytes);
    if (r.get<std::uint64_t>() != format_mark) refuse("it is not a state of this version");
    SimulationState out;
    out.scene.scale = r.get<double>();
    out.scene.bodies = r.get_list<engine::Digest>();
    out.scene.attachments = r.get_list<engine::Digest>();
    out.scene.links = r.get_list<std::array<int, 2>>();
    try {
        out.state = solver::load(r.rest);
    } catch (const solver::Error& e) {
        refuse(e.what());
    }
    return out;
}

} // namespace sinew::nodes
