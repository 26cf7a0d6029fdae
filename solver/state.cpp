// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/state.h"

#include "solver/error.h"
#include "solver/state_bytes.h"
#include "solver/terms/all_terms.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace sinew::solver {

namespace {

constexpr std::string_view magic = "sinew state 13\n";

/// Hands on plain values, vectors with their length first: large ones as they lie in memory, small ones gathered.
class Writer {
  public:
    explicit Writer(const ByteSink& to)
        : to_(to) {}
    template <class T>
    void put(const T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        put_bytes({reinterpret_cast<const std::byte*>(&v), sizeof(T)});
    }
    template <class T>
    void put_all(const std::vector<T>& v) {
        put_all(std::span<const T>(v));
    }
    template <class T>
    void put_all(std::span<const T> v) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(static_cast<std::uint64_t>(v.size()));
        put_bytes(std::as_bytes(v));
    }
    void put_bytes(std::span<const std::byte> bytes) {
        constexpr std::size_t large = 4096;
        if (bytes.size() < large) {
            gathered_.insert(gathered_.end(), bytes.begin(), bytes.end());
            if (gathered_.size() >= large) flush();
            return;
        }
        flush();
        to_(bytes);
    }
    void flush() {
        if (!gathered_.empty()) to_(gathered_);
        gathered_.clear();
    }

  private:
    const ByteSink& to_;
    std::vector<std::byte> gathered_;
};

class Reader {
  public:
    explicit Reader(std::span<const std::byte> in)
        : in_(in) {}
    template <class T>
    void get(T& v) {
        if (in_.size() < sizeof(T)) throw Error("IO403", "a saved simulation state ends too early");
        if (std::is_same_v<T, bool> && in_.front() > std::byte{1}) // which is no bool
            throw Error("IO403", "a saved simulation state has a switch that is neither on nor off");
        std::memcpy(&v, in_.data(), sizeof(T));
        in_ = in_.subspan(sizeof(T));
    }
    std::size_t get_count(std::size_t item_size) {
        std::uint64_t n = 0;
        get(n);
        if (n > in_.size() / item_size) throw Error("IO403", "a saved simulation state ends too early");
        return static_cast<std::size_t>(n);
    }
    template <class T>
    void get_all(std::vector<T>& v) {
        v.resize(get_count(sizeof(T)));
        get_to(std::as_writable_bytes(std::span(v)));
    }
    void get_to(std::span<std::byte> out) {
        if (in_.size() < out.size()) throw Error("IO403", "a saved simulation state ends too early");
        if (!out.empty()) std::memcpy(out.data(), in_.data(), out.size());
        in_ = in_.subspan(out.size());
    }
    bool at_end() const { return in_.empty(); }

  private:
    std::span<const std::byte> in_;
};

void put_points(Writer& w, const Points& points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    w.put(static_cast<std::uint64_t>(points.size()));
    w.put_bytes(std::as_bytes(std::span(points)));
}

void get_points(Reader& r, Points& points) {
    points.resize(r.get_count(3 * sizeof(double)));
    r.get_to({reinterpret_cast<std::byte*>(points.data()), points.size() * sizeof(Vec3)});
}

void put_bones(Writer& w, const std::vector<Points>& bones) {
    w.put(static_cast<std::uint64_t>(bones.size()));
    for (const Points& points : bones) put_points(w, points);
}

void get_bones(Reader& r, std::vector<Points>& bones) {
    bones.resize(r.get_count(sizeof(std::uint64_t)));
    for (Points& points : bones) get_points(r, points);
}

void put_text(Writer& w, std::string_view text) {
    w.put(static_cast<std::uint64_t>(text.size()));
    w.put_bytes(std::as_bytes(std::span(text)));
}

std::string get_text(Reader& r) {
    std::string text(r.get_count(1), ' ');
    r.get_to(std::as_writable_bytes(std::span(text)));
    return text;
}

void put_memories(Writer& w, const std::vector<TermMemory>& memories) {
    w.put(static_cast<std::uint64_t>(memories.size()));
    for (const TermMemory& m : memories) {
        put_text(w, m.term);
        w.put(m.version);
        w.put_all(std::span<const std::byte>(m.bytes));
    }
}

void get_memories(Reader& r, std::vector<TermMemory>& memories) {
    memories.resize(r.get_count(sizeof(std::uint64_t)));
    for (TermMemory& m : memories) {
        m.term = get_text(r);
        r.get(m.version);
        r.get_to(m.bytes.rewrite(r.get_count(1)));
        const auto types = all_terms();
        const auto type =
            std::find_if(types.begin(), types.end(), [&](const TermType* t) { return t->name == m.term; });
        if (type == types.end() || !(*type)->has_memory)
            throw Error("IO403",
                        "a saved simulation state holds the memory of \"" + m.term + "\", which is not known here");
        if ((*type)->memory_version != m.version)
            throw Error("IO403", "a saved simulation state holds version " + std::to_string(m.version) +
                                     " of the memory of \"" + m.term + "\"; version " +
                                     std::to_string((*type)->memory_version) + " can be read");
    }
}

void put_measured(Writer& w, const std::vector<Measured>& measured) {
    w.put(static_cast<std::uint64_t>(measured.size()));
    for (const Measured& m : measured) {
        put_text(w, m.what->term), put_text(w, m.what->name);
        w.put(m.value), w.put(m.part);
    }
}

void get_measured(Reader& r, std::vector<Measured>& measured) {
    measured.resize(r.get_count(sizeof(std::uint64_t)));
    for (Measured& m : measured) {
        const std::string term = get_text(r), name = get_text(r);
        m.what = find_measure(term, name);
        if (!m.what)
            throw Error("IO403",
                        "a saved simulation state holds \"" + term + "." + name + "\", which is not known here");
        r.get(m.value), r.get(m.part);
    }
}

void put_parts(Writer& w, const std::vector<PartValues>& parts) {
    w.put(static_cast<std::uint64_t>(parts.size()));
    for (const PartValues& part : parts) w.put_all(part);
}

void get_parts(Reader& r, std::vector<PartValues>& parts) {
    parts.resize(r.get_count(sizeof(std::uint64_t)));
    for (PartValues& part : parts) r.get_all(part);
}

void put_linear(Writer& w, const LinearMemory& m) {
    w.put(m.factor_steps_left), w.put(m.late_iterations), w.put(m.fresh_iterations);
    w.put(m.factor != nullptr);
    if (!m.factor) return;
    w.put(m.factor->pattern);
    w.put_all(m.factor->values), w.put_all(m.factor->without);
}

void get_linear(Reader& r, LinearMemory& m) {
    r.get(m.factor_steps_left), r.get(m.late_iterations), r.get(m.fresh_iterations);
    bool given = false;
    r.get(given);
    if (!given) return;
    FactorSource source;
    r.get(source.pattern);
    r.get_all(source.values), r.get_all(source.without);
    m.factor = std::make_shared<const FactorSource>(std::move(source));
}

enum class SavedKind : std::uint8_t { bone, tissue, cloth };

void put_values(Writer& w, const std::optional<StepInputs>& values) {
    w.put(values.has_value());
    if (!values) return;
    for (int c = 0; c < 3; ++c) w.put(values->gravity[c]);
    w.put(values->step_size), w.put(values->integrator), w.put(values->mass_damping), w.put(values->stiffness_damping);
    w.put(static_cast<std::uint64_t>(values->bodies.size()));
    for (const BodyInputs& body : values->bodies) {
        const auto* t = std::get_if<TissueInputs>(&body);
        const auto* cloth = std::get_if<ClothInputs>(&body);
        w.put(t ? SavedKind::tissue : cloth ? SavedKind::cloth : SavedKind::bone);
        if (cloth) {
            for (const auto& f : ClothInputs::fields()) w.put(cloth->*f.at);
            w.put_all(cloth->layers);
            put_points(w, cloth->forces);
        }
        if (!t) continue;
        for (const auto& f : TissueInputs::fields()) w.put(t->*f.at);
        w.put_all(t->layers), w.put_all(t->fibers);
        w.put(static_cast<std::uint64_t>(t->subtissues.size()));
        for (const SubtissueInputs& part : t->subtissues) w.put(part.rest_scale_envelope), w.put_all(part.layers);
        put_points(w, t->forces);
    }
    w.put_all(values->attachments);
    put_parts(w, values->parts);
}

void get_values(Reader& r, std::optional<StepInputs>& values) {
    bool given = false;
    r.get(given);
    if (!given) return;
    values.emplace();
    for (int c = 0; c < 3; ++c) r.get(values->gravity[c]);
    r.get(values->step_size), r.get(values->integrator), r.get(values->mass_damping), r.get(values->stiffness_damping);
    values->bodies.resize(r.get_count(sizeof(bool)));
    for (BodyInputs& body : values->bodies) {
        SavedKind kind{};
        r.get(kind);
        if (kind == SavedKind::bone) {
            body.emplace<BoneInputs>();
            continue;
        }
        if (kind == SavedKind::cloth) {
            ClothInputs cloth;
            for (const auto& f : ClothInputs::fields()) r.get(cloth.*f.at);
            r.get_all(cloth.layers);
            get_points(r, cloth.forces);
            body = std::move(cloth);
            continue;
        }
        if (kind != SavedKind::tissue) throw Error("IO403", "a saved simulation state holds a body of no known kind");
        TissueInputs t;
        for (const auto& f : TissueInputs::fields()) r.get(t.*f.at);
        r.get_all(t.layers), r.get_all(t.fibers);
        t.subtissues.resize(r.get_count(sizeof(double) + sizeof(std::uint64_t)));
        for (SubtissueInputs& part : t.subtissues) r.get(part.rest_scale_envelope), r.get_all(part.layers);
        get_points(r, t.forces);
        body = std::move(t);
    }
    r.get_all(values->attachments);
    get_parts(r, values->parts);
}

/// Every field but the seconds; one list for both directions, so that none can be forgotten on one side.
template <class Record, class Visit>
void visit_record(Record& r, const Visit& visit) {
    visit(r.residual), visit(r.converged), visit(r.newton_iterations), visit(r.substeps), visit(r.halvings),
        visit(r.linear_iterations), visit(r.factorizations), visit(r.energy);
    visit(r.min_j), visit(r.inverted);
}

} // namespace

void write(const State& s, const ByteSink& to) {
    Writer w(to);
    for (const char c : magic) w.put(c);
    w.put_all(s.x);
    w.put_all(s.v);
    w.put(s.history.step_size);
    w.put_all(s.history.x), w.put_all(s.history.v), w.put_all(s.history.acceleration);
    put_bones(w, s.history.bones);
    put_values(w, s.history.values);
    w.put_all(s.history.frozen);
    put_memories(w, s.memories);
    put_parts(w, s.parts);
    put_bones(w, s.bones);
    w.put(s.steps);
    visit_record(s.record, [&](const auto& field) { w.put(field); });
    put_measured(w, s.record.measured);
    put_linear(w, s.linear); // the largest and not in all frames: at the end it moves nothing else
    w.flush();
}

std::vector<std::byte> save(const State& s) {
    std::vector<std::byte> out;
    write(s, [&](std::span<const std::byte> bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); });
    return out;
}

State load(std::span<const std::byte> bytes) {
    Reader r(bytes);
    for (const char c : magic) {
        char got = 0;
        r.get(got);
        if (got != c) throw Error("IO403", "these bytes are not a simulation state of this version");
    }
    State s;
    r.get_all(s.x);
    r.get_all(s.v);
    r.get(s.history.step_size);
    r.get_all(s.history.x), r.get_all(s.history.v), r.get_all(s.history.acceleration);
    get_bones(r, s.history.bones);
    get_values(r, s.history.values);
    r.get_all(s.history.frozen);
    get_memories(r, s.memories);
    get_parts(r, s.parts);
    get_bones(r, s.bones);
    r.get(s.steps);
    visit_record(s.record, [&](auto& field) { r.get(field); });
    get_measured(r, s.record.measured);
    get_linear(r, s.linear);
    if (!r.at_end()) throw Error("IO403", "a saved simulation state has bytes left over");
    return s;
}

} // namespace sinew::solver
