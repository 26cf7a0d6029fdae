// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/program.h"

#include "engine/eval/store.h"

#include "engine/check.h"
#include "engine/text.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::engine {

void locate(Diagnostic& d, const Graph& graph, const std::string& node) {
    d.node = node;
    if (d.spot) return;
    if (!d.attribute.empty()) d.spot = graph.spot(node, d.attribute);
    if (!d.spot) d.spot = graph.spot(node);
}

Value Slot::sample(double frame) const {
    if (kind == Kind::constant) return constant;
    const Value& as = info->def;
    if (as.is<Vec3>())
        return Value::of<Vec3>(
            {curve->component_at(frame, 0), curve->component_at(frame, 1), curve->component_at(frame, 2)});
    if (as.is<Matrix4>()) return Value::of<Matrix4>(curve->matrix_at(frame));
    if (as.is<NumberList>()) return Value::of<NumberList>(curve->at(frame));
    const double v = curve->component_at(frame, 0);
    if (as.is<bool>()) return Value::of<bool>(v != 0);
    if (as.is<std::int64_t>()) return Value::of<std::int64_t>(static_cast<std::int64_t>(v));
    if (as.is<std::string>()) return Value::of<std::string>(std::string(info->options[static_cast<std::size_t>(v)]));
    return Value::of<double>(v);
}

Digest Slot::digest_at(double frame) const {
    if (kind == Kind::constant) return constant.digest();
    return ahead_digest(sample(frame));
}

bool is_ever_on(const Curve& curve) {
    return std::any_of(curve.keys.begin(), curve.keys.end(), [](const Key& k) { return k.value.front() != 0; });
}

bool Slot::is_ever_on() const {
    if (kind == Kind::constant) return constant.as<bool>();
    if (kind != Kind::curve) return true; // whatever is connected may bring anything
    return engine::is_ever_on(*curve);
}

// A switch that is on is on at some time: only of one that is off there is more to say.
Digest Slot::ahead_digest(const Value& now) const {
    if (!info->looks_ahead || now.as<bool>() || !is_ever_on()) return now.whole_digest();
    return Hasher().add("on at another time").add(now.digest()).finish();
}

bool Place::is_kept() const {
    if (type->kept_when.empty()) return false;
    for (const Slot& s : slots)
        if (s.info->name == type->kept_when) return s.kind == Slot::Kind::constant && s.constant.as<bool>();
    return false;
}

bool Program::suffices(int node, int output, int simulation, const Entry& entry) {
    if (entry.is_whole()) return true;
    if (node == simulation && output >= 0 && !entry.has(output)) return false;
    for (const auto& [of, read] : known_cone(node).reads)
        if (of == simulation && !entry.has(read)) return false;
    return true;
}

std::vector<std::pair<std::string, Digest>> Program::recipe(int node, double frame) {
    std::vector<std::pair<std::string, Digest>> out;
    for (const int at : cone(node)) {
        const Place& p = place(at);
        if (p.uses_frame) out.emplace_back(p.name, Hasher().add(frame).add(graph_->timing().fps).finish());
        for (const Slot& s : p.slots) {
            if (!s.read_by_compute()) continue;
            Hasher h;
            if (s.kind == Slot::Kind::constant || s.kind == Slot::Kind::curve) h.add(s.digest_at(frame));
            for (const Source& source : s.sources)
                h.add(place(source.node).name)
                    .add(place(source.node).type->outputs[static_cast<std::size_t>(source.output)].name);
            out.emplace_back(p.name + "." + std::string(s.info->name), h.finish());
        }
    }
    return out;
}

Program::Program(std::shared_ptr<const Graph> graph)
    : graph_(std::move(graph)) {
    const std::vector<std::string> names = graph_->node_names();
    places_.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        places_[i].name = names[i];
        places_[i].node = graph_->find(names[i]);
        places_[i].type = places_[i].node->type;
        index_.emplace(names[i], static_cast<int>(i));
    }
    for (Place& p : places_)
        if (p.type) resolve(p);
}

int Program::find(std::string_view name) const {
    const auto it = index_.find(std::string(name));
    return it == index_.end() ? -1 : it->second;
}

Diagnostic Program::about(const Place& p, std::string_view attribute, std::string_view code, std::string message,
                          std::string hint) const {
    Diagnostic d;
    d.code = code;
    d.attribute = attribute;
    d.message = std::move(message), d.hint = std::move(hint);
    locate(d, *graph_, p.name);
    return d;
}

namespace {

/// Does anything but the default stand at this input?
bool is_set(const Place& p, std::string_view input) {
    for (const Slot& s : p.slots) {
        if (s.info->name != input) continue;
        if (s.kind != Slot::Kind::constant) return s.kind != Slot::Kind::none;
        if (s.constant.is<File>()) return !s.constant.as<File>().path.empty();
        return s.constant.digest() != s.info->def.digest();
    }
    return false;
}

} // namespace

void Program::resolve(Place& p) {
    const auto source = [&](const Plug& plug) {
        Source s;
        s.node = find(plug.node);
        const NodeType* type = s.node < 0 ? nullptr : place(s.node).type;
        for (std::size_t i = 0; type && i < type->outputs.size(); ++i)
            if (type->outputs[i].name == plug.attribute) s.output = static_cast<int>(i);
        return s;
    };
    for (const AttributeInfo& info : p.type->inputs) {
        Slot s;
        s.info = &info;
        const auto bound = p.node->inputs.find(info.name);
        if (bound == p.node->inputs.end()) {
            if (info.kind == AttributeKind::literal)
                s.kind = Slot::Kind::constant, s.constant = default_value(info, graph_->timing());
            if (info.kind == AttributeKind::wire_list) s.kind = Slot::Kind::list;
        } else if (const Value* v = std::get_if<Value>(&bound->second)) {
            s.kind = Slot::Kind::constant, s.constant = *v;
        } else if (const Curve* c = std::get_if<Curve>(&bound->second)) {
            s.kind = Slot::Kind::curve, s.curve = c;
        } else if (const Plug* w = std::get_if<Plug>(&bound->second)) {
            s.kind = Slot::Kind::wire, s.sources = {source(*w)};
            if (info.whole_frames) {
                s.sources = {s.sources.front(), s.sources.front()};
                s.sources[0].at = Source::At::frame_before, s.sources[1].at = Source::At::frame_after;
            }
        } else {
            s.kind = Slot::Kind::list;
            for (const Plug& w2 : std::get<std::vector<Plug>>(bound->second)) s.sources.push_back(source(w2));
            const std::size_t count = info.with_start ? s.sources.size() : 0;
            for (std::size_t i = 0; i < count; ++i) {
                s.sources.push_back(s.sources[i]);
                s.sources.back().at = Source::At::start;
            }
        }
        if (!info.names_entry_of.empty()) s.constant = Value::of<std::int64_t>(entry_place(p, info, s.constant));
        p.slots.push_back(std::move(s));
    }
    for (Problem& f : check_required(*graph_, p.name, *p.node)) {
        locate(f.diagnostic, *graph_, p.name);
        p.problems.push_back(std::move(f.diagnostic));
    }
    if (p.type->simulation) find_times(p);
    p.uses_frame = p.type->uses_time && (p.type->time_input.empty() || is_set(p, p.type->time_input));
}

/// Where a name stands among the entries that it can be one of; -1 where there is none, which is a problem unless the
/// name is empty.
std::int64_t Program::entry_place(const Place& p, const AttributeInfo& info, const Value& name) const {
    const std::vector<std::string> names = entry_names(*graph_, *p.node, info);
    const auto at = std::find(names.begin(), names.end(), name.as<std::string>());
    return at == names.end() ? -1 : at - names.begin();
}

void Program::find_times(Place& p) {
    const SimulationFunctions& f = *p.type->simulation;
    p.start_frame = graph_->timing().start;
    for (std::size_t i = 0; i < p.slots.size(); ++i) {
        const Slot& s = p.slots[i];
        if (s.info->name == f.substeps_input) p.substeps_slot = static_cast<int>(i);
        if (!f.stages_input.empty() && s.info->name == f.stages_input) p.stages_slot = static_cast<int>(i);
        if (s.info->name != f.start_frame_input || s.kind != Slot::Kind::constant) continue;
        const double start = s.constant.as<double>();
        if (const std::string fault = frame_fault(start); fault.empty())
            p.start_frame = static_cast<int>(start);
        else
            p.problems.push_back(about(p, s.info->name, "DG107", fault));
    }
}

Site Program::site(const Source& s, double frame) const {
    switch (s.at) {
    case Source::At::frame_before:
        return site(s.node, std::floor(frame));
    case Source::At::frame_after:
        return site(s.node, std::ceil(frame));
    case Source::At::start:
        return site(s.node, graph_->timing().start);
    case Source::At::time:
        break;
    }
    return site(s.node, frame);
}

Site Program::site(int node, double frame) const {
    const Place& p = place(node);
    if (!p.dynamic) return {node, 0};
    if (!p.is_simulation()) return {node, frame};
    if (frame <= p.start_frame) return {node, static_cast<double>(p.start_frame)}; // before the start: the start
    if (frame != std::floor(frame)) {
        Diagnostic d = about(p, {}, "DG103", "a simulation has whole frames only",
                             "ask for a whole frame, or set the sub-steps of the node that reads it to 1");
        d.frame = frame;
        throw Failure(std::move(d));
    }
    if (frame - p.start_frame > farthest_frame) {
        Diagnostic d = about(p, {}, "DG104", "too far from the start frame " + std::to_string(p.start_frame),
                             "start at most " + std::to_string(static_cast<int>(farthest_frame)) +
                                 " frames before the last one that is wanted");
        d.frame = frame;
        throw Failure(std::move(d));
    }
    return {node, frame};
}

int Program::substeps(const Place& p, int frame) const {
    if (p.substeps_slot < 0) return 1;
    const std::int64_t n = p.slots[static_cast<std::size_t>(p.substeps_slot)].sample(frame).as<std::int64_t>();
    if (n >= 1 && n <= 100000) return static_cast<int>(n);
    Diagnostic d =
        about(p, p.type->simulation->substeps_input, "DG106", std::to_string(n) + " sub-steps are not possible");
    d.frame = frame;
    throw Failure(std::move(d));
}

std::vector<double> Program::stages(const Place& p, double time) const {
    if (p.stages_slot < 0 || p.after_simulation) return {};
    std::vector<double> out = p.type->simulation->stages(p.slots[static_cast<std::size_t>(p.stages_slot)].sample(time));
    double last = 0;
    for (const double fraction : out) {
        if (!(fraction > last && fraction < 1))
            throw std::logic_error(std::string(p.type->name) + ": stage times must rise between 0 and 1");
        last = fraction;
    }
    return out;
}

const Program::Cone& Program::known_cone(int node) {
    const auto known = cones_.find(node);
    return known != cones_.end() ? known->second : cones_.emplace(node, make_cone(node)).first->second;
}

Program::Cone Program::make_cone(int node) {
    // Depth first with an explicit stack; `open` marks the path, so meeting it again is a cycle.
    enum : char { fresh, open, closed };
    std::vector<char> state(places_.size(), fresh);
    std::vector<int> stack{node};
    Cone out;
    std::vector<Diagnostic> problems;
    while (!stack.empty()) {
        const int at = stack.back();
        Place& p = place(at);
        char& mark = state[static_cast<std::size_t>(at)];
        if (mark != fresh) {
            stack.pop_back();
            if (mark == open) mark = closed, out.nodes.push_back(at);
            continue;
        }
        mark = open;
        if (!p.type)
            problems.push_back(about(p, {}, "DG101",
                                     "this program does not know the type " + json_quoted(p.node->type_name),
                                     name_hint(p.node->type_name, graph_->registry().names(), {})));
        problems.insert(problems.end(), p.problems.begin(), p.problems.end());
        for (const Slot& s : p.slots) {
            if (!s.read_by_compute()) continue;
            for (const Source& source : s.sources) {
                const char there = state[static_cast<std::size_t>(source.node)];
                if (there == open)
                    throw Failure(about(p, s.info->name, "DG030", "connections form a cycle: " + find_cycle(*graph_)));
                if (there == fresh) stack.push_back(source.node);
            }
        }
    }
    if (!problems.empty()) throw Failure(std::move(problems));
    for (int at : out.nodes) {
        Place& p = place(at);
        bool dynamic = p.uses_frame || p.is_simulation(), after_simulation = false;
        for (std::size_t i = 0; i < p.slots.size(); ++i) {
            const Slot& s = p.slots[i];
            if (!s.read_by_compute()) continue;
            dynamic = dynamic || s.kind == Slot::Kind::curve;
            for (const Source& source : s.sources) {
                const Place& up = place(source.node);
                dynamic = dynamic || up.dynamic;
                after_simulation = after_simulation || up.is_simulation() || up.after_simulation;
                if (up.is_simulation()) out.reads.emplace_back(source.node, source.output);
            }
            if (s.kind == Slot::Kind::constant && s.constant.is<File>() && !s.constant.as<File>().path.empty())
                out.files.emplace_back(at, static_cast<int>(i));
        }
        // Never written again: other threads may be reading them by then.
        if (p.dynamic != dynamic) p.dynamic = dynamic;
        if (p.after_simulation != after_simulation) p.after_simulation = after_simulation;
    }
    return out;
}

std::vector<Digest> Program::reached() const {
    std::vector<Digest> out;
    for (const Place& p : places_)
        if (p.reached) out.push_back(*p.reached);
    return out;
}

void Program::carry_reached(const Program& from) {
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (!places_[i].reached) places_[i].reached = from.places_[i].reached;
}

std::vector<std::string> Program::file_paths(int node) {
    std::vector<std::string> out;
    for (const auto& [at, slot] : known_cone(node).files)
        out.push_back(place(at).slots[static_cast<std::size_t>(slot)].constant.as<File>().path);
    return out;
}

bool Program::set_files(int node, const FileContents& contents) {
    std::vector<Diagnostic> problems;
    for (const auto& [at, slot] : known_cone(node).files) {
        Slot& s = place(at).slots[static_cast<std::size_t>(slot)];
        const File& named = s.constant.as<File>();
        const auto& found = contents.at(named.path);
        if (const FileFault* fault = std::get_if<FileFault>(&found)) {
            problems.push_back(about(place(at), s.info->name, fault->code, fault->message, fault->hint));
            continue;
        }
        const Digest content = std::get<Digest>(found);
        if (content == named.content) continue;
        if (named.content != Digest{}) return false;
        s.constant = Value::of<File>({named.path, content});
    }
    if (!problems.empty()) throw Failure(std::move(problems));
    return true;
}

} // namespace sinew::engine
