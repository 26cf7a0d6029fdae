// Node types are data plus free functions. compute() reaches inputs only through Reads, so the reads are the
// dependency declaration; there is no per-node object in which state could hide.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"
#include "engine/diagnostics.h"
#include "engine/file_access.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sinew::engine {

/// The evaluator's side of Reads; nodes never see it.
class ReadSource {
  public:
    virtual ~ReadSource() = default;
    /// The value of a literal or wire attribute; an empty Value for an unconnected optional wire.
    virtual Value get(std::string_view attribute) = 0;
    virtual std::vector<Value> get_list(std::string_view attribute) = 0;
    /// Throws std::logic_error unless the type says uses_time, and its time_input is set (or it is a simulation).
    virtual double frame() = 0;
    virtual double fps() = 0;
    virtual void checkpoint() = 0;
    virtual void progress(double done, std::string_view what) = 0;
    virtual void report(Diagnostic) = 0;
    [[noreturn]] virtual void fail(Diagnostic) = 0;
    virtual std::shared_ptr<void> take_scratch(const Digest& key) = 0;
    virtual void give_scratch(const Digest& key, std::shared_ptr<void> scratch) = 0;
    /// "biceps" for entry 2 of attribute "bodies": the node at the other end; for messages only.
    virtual std::string source_name(std::string_view attribute, std::size_t index) = 0;
    /// "biceps" for entry 2 of attribute "attachments" and its input "source": a node further; empty: none there.
    virtual std::string source_behind(std::string_view attribute, std::size_t index, std::string_view input,
                                      std::size_t entry) = 0;
    virtual bool stop_requested() = 0;
    /// Of a wire that is read at whole frames: its values at those before and after.
    virtual std::pair<Value, Value> around(std::string_view attribute) = 0;
    virtual bool is_ever_on(std::string_view attribute) = 0;
    virtual std::vector<Value> list_at_start(std::string_view attribute) = 0;
    virtual std::vector<std::string> entry_names(std::string_view attribute) = 0;
    /// The content digest of a literal, a wire or a whole list of wires.
    virtual Digest digest(std::string_view attribute) { return get(attribute).digest(); }
    virtual const FileAccess& files() = 0;
};

/// A scratch object (symbolic analysis, buffers) on loan to one compute at a time. Dropping it at any moment
/// must not change a bit of any result; it only saves work.
template <class T>
class Lease {
  public:
    Lease(ReadSource& source, Digest key, std::shared_ptr<T> p)
        : source_(&source)
        , key_(key)
        , p_(std::move(p)) {}
    Lease(Lease&&) = default;
    ~Lease() {
        if (p_) source_->give_scratch(key_, std::move(p_));
    }
    T& operator*() { return *p_; }
    T* operator->() { return p_.get(); }

  private:
    ReadSource* source_;
    Digest key_;
    std::shared_ptr<T> p_;
};

/// The only door to inputs. Reading an attribute that was not declared, or one that affects nothing, throws
/// std::logic_error in every build. References stay valid while the Reads lives.
class Reads {
  public:
    explicit Reads(ReadSource& source)
        : source_(&source) {}
    template <class T>
    const T& operator[](const Input<T>& a) const {
        return keep(source_->get(a.name)).template as<T>();
    }
    template <class T>
    const T& operator[](const Wire<T>& a) const {
        return keep(source_->get(a.name)).template as<T>();
    }
    /// nullptr if an optional wire is not connected.
    template <class T>
    const T* find(const Wire<T>& a) const {
        const Value& v = keep(source_->get(a.name));
        return v ? &v.template as<T>() : nullptr;
    }
    /// The values of a wire that is read at whole frames at the last one up to now and the first from now on.
    template <class T>
    std::pair<const T*, const T*> around(const Wire<T>& a) const {
        auto [before, after] = source_->around(a.name);
        return {&keep(std::move(before)).template as<T>(), &keep(std::move(after)).template as<T>()};
    }
    /// The values of a list that is read with_start, at the graph's first frame.
    template <class T>
    std::vector<std::reference_wrapper<const T>> at_start(const WireList<T>& a) const {
        std::vector<std::reference_wrapper<const T>> out;
        for (Value& v : source_->list_at_start(a.name)) out.emplace_back(keep(std::move(v)).template as<T>());
        return out;
    }
    /// The names that an input with names_entry_of can hold, by place; for messages only, never for results.
    std::vector<std::string> entry_names(const Input<std::string>& a) const { return source_->entry_names(a.name); }
    /// Whether a switch that looks ahead is on at some time: now, at a key, or connected, whatever that brings.
    bool is_ever_on(const Input<bool>& a) const { return source_->is_ever_on(a.name); }
    /// The place that a name stands for (Input::names_entry_of); -1: none is named.
    int entry(const Input<std::string>& a) const {
        return static_cast<int>(keep(source_->get(a.name)).template as<std::int64_t>());
    }
    template <class T>
    std::vector<std::reference_wrapper<const T>> operator[](const WireList<T>& a) const {
        std::vector<std::reference_wrapper<const T>> out;
        for (Value& v : source_->get_list(a.name)) out.emplace_back(keep(std::move(v)).template as<T>());
        return out;
    }
    /// The content digest of a literal, a wire or a whole list of wires, for scratch keys.
    Digest digest_of(std::string_view attribute) const { return source_->digest(attribute); }
    double frame() const { return source_->frame(); }
    double fps() const { return source_->fps(); }
    /// The only door to files: nodes open what their inputs of type File name, and nothing else.
    const FileAccess& files() const { return source_->files(); }
    /// Throws Cancelled if the host asked to stop.
    void checkpoint() const { source_->checkpoint(); }
    bool stop_requested() const { return source_->stop_requested(); }
    void progress(double done_0_to_1, std::string_view what = {}) const { source_->progress(done_0_to_1, what); }
    void warn(std::string_view attribute, std::string_view code, std::string message, std::string hint = {}) const;
    /// Throws Failure with node and place filled in; codes FE3xx throw SolveFailure.
    [[noreturn]] void fail(std::string_view attribute, std::string_view code, std::string message,
                           std::string hint = {}) const;
    /// The name of the node connected at `attribute[index]`; for messages only, never for results.
    std::string source_name(std::string_view attribute, std::size_t index = 0) const {
        return source_->source_name(attribute, index);
    }
    /// What is connected to an input of the node at the other end, of a list its entry; empty if nothing is. For
    /// messages only.
    std::string source_behind(std::string_view attribute, std::size_t index, std::string_view input,
                              std::size_t entry = 0) const {
        return source_->source_behind(attribute, index, input, entry);
    }
    template <class T, class Make>
    Lease<T> lease(const Digest& key, Make make) const {
        auto p = std::static_pointer_cast<T>(source_->take_scratch(key));
        if (!p) p = make();
        return Lease<T>(*source_, key, std::move(p));
    }

  private:
    const Value& keep(Value v) const;
    ReadSource* source_;
    mutable std::vector<std::unique_ptr<Value>> kept_;
};

class Writes {
  public:
    template <class T>
    void set(const Output<T>& o, T v) {
        put(o.name, Value::of<T>(std::move(v)));
    }
    void put(std::string_view output, Value v);
    const std::vector<std::pair<std::string, Value>>& values() const { return values_; }

  private:
    std::vector<std::pair<std::string, Value>> values_;
};

/// What one sub-step of a simulation reads.
struct SubstepReads {
    Reads end; ///< every input at the end of the sub-step
    /// Every input at the stage times within it, in their order. Empty where there are none, and where an input depends
    /// on another simulation, which has whole frames only.
    std::vector<Reads> within = {};
};

/// Type-erased simulation: see SimulationType.
struct SimulationFunctions {
    std::function<Value(const Reads&)> initial;
    std::function<Value(const Value& before, std::span<const SubstepReads> substeps)> advance;
    std::function<Value(const Value& before, std::span<const SubstepReads> substeps)> rehearse; ///< or none
    std::function<void(const Value& state, const Reads&, Writes&)> publish;
    std::function<std::vector<std::byte>(const Value&)> save;
    std::function<Value(std::span<const std::byte>)> load;
    std::string_view start_frame_input, substeps_input, stages_input;
    std::function<std::vector<double>(const Value&)> stages;
};

struct NodeType {
    std::string_view name;
    int version = 1;  ///< raised when meaning or defaults change; older files migrate
    int numerics = 1; ///< raised when the same inputs give other bits; old keys die
    /// What else bits hang on, on this machine: the kernels of a library that it works with. Other words, other keys.
    std::string machine = {};
    /// Of types that a host brings: says which code computes them, for example a version. Other words, other keys.
    std::string revision = {};
    std::string_view doc;
    std::vector<AttributeInfo> inputs = {}, outputs = {};
    bool uses_time = false; ///< only then does the frame enter the key and may compute ask for it
    /// With uses_time: the input that brings time in. Where it is left alone (a literal that is its default; for a File
    /// one that names none) the node does not change over time and compute must not ask for the frame. Empty: always.
    std::string_view time_input = {};
    /// An Input<bool> with Affects::nothing: where it is on, the outputs are kept on disk under the node's key, and a
    /// later process reads them instead of computing. Every output's type needs a codec. Empty: never.
    std::string_view kept_when = {};
    std::function<void(const Reads&, Writes&)> compute = {};    ///< stateless
    std::shared_ptr<const SimulationFunctions> simulation = {}; ///< set for simulations, then compute is empty

    const AttributeInfo* find_input(std::string_view attribute) const;
    const AttributeInfo* find_output(std::string_view attribute) const;
};

/// A node whose frame n needs its own frame n-1. State is a complete plain value: advance is pure in
/// (state, inputs), and load(save(s)) continues bit for bit. Needs ValueTraits<State>.
template <class State>
struct SimulationType {
    NodeType base;
    std::function<State(const Reads& at_start)> initial;
    /// From frame n-1 to n. `substeps[k].end` reads every input at time n-1 + (k+1)/N; the last one is frame n
    /// itself.
    std::function<State(const State& before, std::span<const SubstepReads> substeps)> advance;
    /// Optional: fails where `advance` would refuse what it reads, without solving anything. A graph is checked ahead
    /// by it. `before` is the state at the start frame, or what the rehearsal of an earlier frame returned: the same
    /// state with what later frames are compared with.
    std::function<State(const State& before, std::span<const SubstepReads> substeps)> rehearse = {};
    /// Outputs of the current frame.
    std::function<void(const State&, const Reads& at_frame, Writes&)> publish;
    std::function<std::vector<std::byte>(const State&)> save;
    std::function<State(std::span<const std::byte>)> load;
    std::string_view start_frame_input = "startFrame"; ///< Input<double>, not keyable
    std::string_view substeps_input = "substeps";      ///< Input<std::int64_t>, read at frame n
    /// Schemes that look within a sub-step: from the value of the input `stages_input` at the end of a sub-step, the
    /// fractions of it (above 0, below 1, rising) at which inputs are read too. They enter the frame's key where they
    /// are read and nowhere else. Both empty: a simulation reads at the ends of its sub-steps only.
    std::string_view stages_input = {}; ///< a literal; cannot be connected
    std::function<std::vector<double>(const Value&)> stages = {};
};

/// Gives the type-erased node type that the registry keeps.
template <class State>
NodeType erase(SimulationType<State> t) {
    auto f = std::make_shared<SimulationFunctions>();
    f->initial = [g = t.initial](const Reads& r) { return Value::of<State>(g(r)); };
    f->advance = [g = t.advance](const Value& s, std::span<const SubstepReads> in) {
        return Value::of<State>(g(s.as<State>(), in));
    };
    if (t.rehearse)
        f->rehearse = [g = t.rehearse](const Value& s, std::span<const SubstepReads> in) {
            return Value::of<State>(g(s.as<State>(), in));
        };
    f->publish = [g = t.publish](const Value& s, const Reads& r, Writes& w) { g(s.as<State>(), r, w); };
    f->save = [g = t.save](const Value& s) { return g(s.as<State>()); };
    f->load = [g = t.load](std::span<const std::byte> b) { return Value::of<State>(g(b)); };
    f->start_frame_input = t.start_frame_input;
    f->substeps_input = t.substeps_input;
    f->stages_input = t.stages_input;
    f->stages = t.stages;
    NodeType out = std::move(t.base);
    out.simulation = std::move(f);
    return out;
}

} // namespace sinew::engine
