// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/check.h"

#include "engine/connection_meant.h"
#include "engine/format/typed_text.h"
#include "engine/format/value_meant.h"
#include "engine/limits.h"
#include "engine/text.h"

#include <cmath>

namespace sinew::engine {

namespace {

// Collects the problems of one input.
class Checker {
  public:
    Checker(const Graph& graph, std::string_view node, const NodeType& type, const AttributeInfo& input)
        : graph_(graph)
        , node_(node)
        , type_(type)
        , input_(input) {}

    std::vector<Problem> run(const Binding& b) {
        if (const Value* v = std::get_if<Value>(&b))
            literal(*v);
        else if (const Curve* c = std::get_if<Curve>(&b))
            curve(*c);
        else if (const Plug* p = std::get_if<Plug>(&b))
            single(*p);
        else
            list(std::get<std::vector<Plug>>(b));
        return std::move(out_);
    }

  private:
    void problem(std::string_view code, std::string message, std::string hint = {}, std::string below = {}) {
        Problem p;
        p.diagnostic.code = code;
        p.diagnostic.node = node_;
        p.diagnostic.attribute = input_.name;
        p.diagnostic.message = std::move(message);
        p.diagnostic.hint = std::move(hint);
        p.below = std::move(below);
        out_.push_back(std::move(p));
    }

    bool takes_literal() {
        if (input_.kind == AttributeKind::literal) return true;
        const bool list = input_.kind == AttributeKind::wire_list;
        problem("DG026", "a " + std::string(input_.type_name) + " can only be connected",
                list ? "write [ { \"from\": \"node.output\" } ]" : "write { \"from\": \"node.output\" }");
        return false;
    }

    void number(const std::optional<Outside>& wrong, const std::string& below) {
        if (!wrong) return;
        if (!wrong->finite) return problem("DG027", "not a finite number", {}, below);
        problem("DG013", number_text(wrong->value) + " is outside " + limits_text(input_.limits, input_.unit),
                meaning_of(input_), below);
    }

    void literal(const Value& v) {
        if (!takes_literal()) return;
        if (v.type() != input_.type)
            return problem("DG012",
                           "expected " + std::string(input_.type_name) + ", found " + std::string(v.type_name()));
        const auto wrong = outside(input_.limits, v);
        const auto bytes = wrong && v.is<Vec3>() && input_.limits.min == 0 && input_.limits.max == 1
                               ? colour_of_bytes(v.as<Vec3>())
                               : std::nullopt;
        number(wrong, wrong && wrong->index >= 0 ? "/" + std::to_string(wrong->index) : "");
        if (bytes) out_.back().diagnostic.hint = "write " + list_text(*bytes);
        if (input_.options.empty() || !v.is<std::string>()) return;
        if (std::find(input_.options.begin(), input_.options.end(), v.as<std::string>()) == input_.options.end())
            not_an_option(v.as<std::string>());
    }

    void not_an_option(const std::string& found, const std::string& below = {}) {
        const std::vector<std::string> words(input_.options.begin(), input_.options.end());
        const std::string near = nearest_name(found, words);
        problem("DG014", json_quoted(found) + " is not an option",
                (near.empty() ? "" : "did you mean \"" + near + "\"? ") + "options: " + listed(words), below);
    }

    void curve(const Curve& c) {
        if (!takes_literal()) return;
        if (!input_.keyable)
            return problem("DG018", "this " + std::string(input_.type_name) + " cannot carry keyframes",
                           "write a plain value");
        if (c.keys.empty()) return problem("DG017", "no keyframes", "write [frame, value] pairs", "/keys");
        const bool whole = input_.is_stepped();
        if (whole && c.interpolation != Interpolation::step)
            problem("DG017", "keys of " + std::string(input_.type_name) + " are stepped", "write \"interp\": \"step\"",
                    "/interp");
        if (input_.def.is<Matrix4>() && c.interpolation == Interpolation::smooth)
            problem("DG017", "keys of a matrix are linear or stepped", "write \"interp\": \"linear\"", "/interp");
        for (std::size_t i = 0; i < c.keys.size(); ++i) key(c, i, whole);
    }

    void key(const Curve& c, std::size_t i, bool whole) {
        const Key& k = c.keys[i];
        const std::string place = "/keys/" + std::to_string(i);
        const std::size_t width = input_.def.is<Vec3>()         ? 3
                                  : input_.def.is<Matrix4>()    ? 16
                                  : input_.def.is<NumberList>() ? c.width()
                                                                : 1;
        if (!std::isfinite(k.frame)) problem("DG027", "the frame of a key is not finite", {}, place + "/0");
        if (i > 0 && k.frame == c.keys[i - 1].frame)
            problem("DG017", "two keys at frame " + number_text(k.frame), "keep one of them", place);
        else if (i > 0 && !(k.frame > c.keys[i - 1].frame))
            problem("DG017", "frame " + number_text(k.frame) + " comes after frame " + number_text(c.keys[i - 1].frame),
                    "sort the keys by frame", place);
        if (k.value.size() != width)
            problem("DG017",
                    "a key has " + std::to_string(k.value.size()) + " numbers where " + std::to_string(width) + " fit",
                    {}, place);
        for (const auto* tangent : {&k.tangent_in, &k.tangent_out})
            if (!tangent->empty() && tangent->size() != width)
                problem("DG017", "a tangent is as wide as the value", {}, place + "/2");
        for (double v : k.value) {
            if (!std::isfinite(v)) return problem("DG027", "not a finite number", {}, place + "/1"); // once a key
            if (whole && v != std::floor(v))
                problem("DG012", number_text(v) + " is not a whole number", {}, place + "/1");
            else if (!input_.options.empty() && !(v >= 0 && v < static_cast<double>(input_.options.size())))
                not_an_option(number_text(v), place + "/1");
            else if (!inside(input_.limits, v))
                number(Outside{v, -1, std::isfinite(v)}, place + "/1");
        }
        for (const auto* tangent : {&k.tangent_in, &k.tangent_out})
            for (double v : *tangent)
                if (!std::isfinite(v)) problem("DG027", "a tangent is not finite", {}, place + "/2");
    }

    void single(const Plug& p) {
        if (input_.kind == AttributeKind::wire_list)
            return problem("DG020", "takes a list of connections, not a single one",
                           "write [ { \"from\": \"" + p.text() + "\" } ]");
        const SimulationFunctions* s = type_.simulation.get();
        if (s && (input_.name == s->start_frame_input || input_.name == s->substeps_input))
            return problem("DG029", "cannot be connected", "write a plain value: it decides which frames there are");
        if (s && !input_.name.empty() && input_.name == s->stages_input)
            return problem("DG029", "cannot be connected",
                           "write a plain value or keys: it decides at which times inputs are read");
        if (!input_.name.empty() && input_.name == type_.kept_when)
            return problem("DG029", "cannot be connected",
                           "write a plain value: it decides where results are looked for before anything runs");
        if (!input_.names_entry_of.empty())
            return problem("DG029", "cannot be connected", "write the name: it is looked up before anything runs");
        source(p, "/from");
    }

    void list(const std::vector<Plug>& all) {
        if (input_.kind != AttributeKind::wire_list)
            return problem("DG020", "takes one value, not a list of connections",
                           "write { \"from\": \"node.output\" }");
        for (std::size_t i = 0; i < all.size(); ++i) source(all[i], "/" + std::to_string(i) + "/from");
    }

    void source(const Plug& p, const std::string& below) {
        const Node* n = graph_.find(p.node);
        if (!n) {
            const std::string file = out_.size() < 20 ? file_node_form(graph_, input_, p.text()) : "";
            return problem("DG022", "there is no node \"" + p.node + "\"",
                           file.empty() ? node_hint(graph_, p.node, node_) : file, below);
        }
        if (!n->type) return; // a type that this program does not know: nothing to compare with
        const AttributeInfo* out = n->type->find_output(p.attribute);
        if (!out)
            return problem("DG023", std::string(n->type->name) + " has no output \"" + p.attribute + "\"",
                           name_hint(p.attribute, output_names(*n->type), "outputs"), below);
        if (out->type != input_.type)
            problem("DG024",
                    "takes " + std::string(input_.type_name) + ", but " + p.text() + " is " +
                        std::string(out->type_name),
                    fitting_place(*n, *out, p, type_, input_), below);
    }

    const Graph& graph_;
    std::string node_;
    const NodeType& type_;
    const AttributeInfo& input_;
    std::vector<Problem> out_;
};

std::vector<std::string> names_of(const std::vector<AttributeInfo>& all) {
    std::vector<std::string> out;
    for (const AttributeInfo& a : all) out.emplace_back(a.name);
    return out;
}

} // namespace

std::vector<std::string> input_names(const NodeType& type) { return names_of(type.inputs); }
std::vector<std::string> output_names(const NodeType& type) { return names_of(type.outputs); }

std::string meaning_of(const AttributeInfo& input) {
    const std::string_view doc = input.doc.substr(0, input.doc.find(". "));
    return std::string(doc.ends_with('.') ? doc.substr(0, doc.size() - 1) : doc);
}

std::string name_hint(std::string_view word, std::span<const std::string> candidates, std::string_view known) {
    const std::string near = nearest_name(word, candidates);
    if (!near.empty()) return "did you mean \"" + near + "\"?";
    if (known.empty() || candidates.empty() || candidates.size() > 12) return {};
    return std::string(known) + ": " + listed(candidates);
}

std::string node_hint(const Graph& graph, std::string_view name, std::string_view beside) {
    const std::string ending = "." + std::string(name);
    // Of several includes that have such a node, the one whose input it is is meant.
    for (std::string_view within = beside; within.find('.') != within.npos;) {
        within = within.substr(0, within.rfind('.'));
        const std::string here = std::string(within) + ending;
        if (here != beside && graph.find(here)) return "did you mean " + json_quoted(here) + "?";
    }
    constexpr std::size_t most_named = 6;
    const std::vector<std::string> all = graph.node_names();
    std::vector<std::string> included;
    for (const std::string& one : all)
        if (one.ends_with(ending) && one != beside && included.size() <= most_named)
            included.push_back(included.size() < most_named ? json_quoted(one) : "another include's");
    return included.empty() ? name_hint(name, all, {}) : "did you mean " + listed(included) + "?";
}

std::string input_hint(const Graph& graph, const NodeType& type, std::string_view input) {
    const std::vector<std::string> names = input_names(type);
    if (const std::string near = name_hint(input, names, {}); !near.empty()) return near;
    if (input == "comment") return "write it beside \"type\" and \"inputs\", or as // …";
    constexpr std::size_t few = 3; // what half of all types have tells nothing
    std::vector<std::string> owners;
    for (const std::string& name : graph.registry().names())
        if (graph.registry().find(name)->find_input(input)) owners.push_back(name);
    if (!owners.empty() && owners.size() <= few) return listed(owners) + (owners.size() == 1 ? " has it" : " have it");
    const std::string known = name_hint(input, names, "inputs");
    return known.empty() ? "`sinew nodes " + std::string(type.name) + "` lists its inputs" : known;
}

std::vector<Problem> check_binding(const Graph& graph, std::string_view node, const NodeType& type,
                                   const AttributeInfo& input, const Binding& binding) {
    return Checker(graph, node, type, input).run(binding);
}

std::vector<std::string> entry_names(const Graph& graph, const Node& n, const AttributeInfo& input) {
    const auto bound = n.inputs.find(input.names_entry_of);
    const auto* plug = bound == n.inputs.end() ? nullptr : std::get_if<Plug>(&bound->second);
    const Node* source = plug ? graph.find(plug->node) : nullptr;
    const AttributeInfo* output = source && source->type ? source->type->find_output(plug->attribute) : nullptr;
    if (!output || output->entries_of.empty()) return {};
    const auto list = source->inputs.find(output->entries_of);
    const auto* plugs = list == source->inputs.end() ? nullptr : std::get_if<std::vector<Plug>>(&list->second);
    std::vector<std::string> out;
    if (plugs)
        for (const Plug& p : *plugs) out.push_back(p.node);
    return out;
}

namespace {

void check_entry(const Graph& graph, std::string_view node, const Node& n, const AttributeInfo& a,
                 std::vector<Problem>& out) {
    const auto it = n.inputs.find(a.name);
    const auto* value = it == n.inputs.end() ? nullptr : std::get_if<Value>(&it->second);
    if (!value || !value->is<std::string>() || value->as<std::string>().empty()) return;
    const std::string& wanted = value->as<std::string>();
    const std::vector<std::string> names = entry_names(graph, n, a);
    const auto times = std::count(names.begin(), names.end(), wanted);
    if (times == 1) return;
    Problem p;
    p.diagnostic.node = node;
    p.diagnostic.attribute = a.name;
    p.diagnostic.code = "FE290";
    if (names.empty()) {
        p.diagnostic.message = "what is connected to " + std::string(a.names_entry_of) + " has no entries with names";
        p.diagnostic.hint = "name an entry by its number, or connect a zSolver's outMeshes";
    } else {
        p.diagnostic.message = json_quoted(wanted) +
                               (times == 0 ? " is none of the " : " stands more than once among the ") +
                               std::to_string(names.size()) + " entries: " + listed(names);
        p.diagnostic.hint = times == 0 ? name_hint(wanted, names, {}) : "name it by its number";
        if (p.diagnostic.hint.empty()) p.diagnostic.hint = "name one of them";
    }
    out.push_back(std::move(p));
}

/// How an input is written that is missing, with what there is in the graph to connect it to.
std::string missing_form(const Graph& graph, std::string_view node, const AttributeInfo& a,
                         std::span<const std::string> names) {
    constexpr std::size_t most_named = 6;
    if (a.def.is<File>()) return "write the path of a file, relative to the graph's folder";
    const bool list = a.kind == AttributeKind::wire_list;
    std::vector<std::string> fitting = fitting_outputs(graph, node, a, names, most_named);
    for (std::string& plug : fitting) plug = json_quoted(plug);
    const bool are_named = !fitting.empty() && fitting.size() <= most_named;
    if (a.kind == AttributeKind::literal && !are_named) return "give it a value";
    std::string form;
    const auto add = [&](const std::string& plug) {
        form.append(form.empty() ? "{ \"from\": " : ", { \"from\": ").append(plug).append(" }");
    };
    if (are_named && (list || fitting.size() == 1))
        for (const std::string& one : fitting) add(one);
    else
        add("\"node.output\"");
    if (list) form = "[ " + form + " ]";
    return "connect it: " + form + (!list && are_named && fitting.size() > 1 ? " with " + listed(fitting) : "");
}

} // namespace

std::vector<Problem> check_required(const Graph& graph, std::string_view node, const Node& n,
                                    std::span<const std::string> names) {
    std::vector<Problem> out;
    for (const AttributeInfo& a : n.type->inputs) {
        if (!a.names_entry_of.empty()) check_entry(graph, node, n, a, out);
        if (!a.required) continue;
        const auto it = n.inputs.find(a.name);
        const auto* plugs = it == n.inputs.end() ? nullptr : std::get_if<std::vector<Plug>>(&it->second);
        const auto* value = it == n.inputs.end() ? nullptr : std::get_if<Value>(&it->second);
        const bool list = a.kind == AttributeKind::wire_list;
        bool missing = it == n.inputs.end();
        if (list) missing = missing || (plugs && plugs->size() < a.min_count);
        if (value && value->is<File>()) missing = missing || value->as<File>().path.empty();
        if (!missing) continue;
        Problem p;
        p.diagnostic.node = node;
        p.diagnostic.attribute = a.name;
        if (list && plugs) {
            p.diagnostic.code = "DG021";
            p.diagnostic.message = "has " + std::to_string(plugs->size()) + " connections and needs at least " +
                                   std::to_string(a.min_count);
        } else {
            p.diagnostic.code = "DG019";
            const bool several = a.type_name == "numbers";
            p.diagnostic.message =
                std::string(n.type->name) + " needs " + (several ? "these " : "this ") + std::string(a.type_name);
        }
        p.diagnostic.hint = missing_form(graph, node, a, names);
        out.push_back(std::move(p));
    }
    return out;
}

std::string frame_fault(double frame) {
    if (frame != std::floor(frame)) return number_text(frame) + " is not a whole frame";
    if (std::abs(frame) < 1e9) return {};
    return "frame " + number_text(frame) + " is too far from 0; frames lie within a billion";
}

std::vector<TimingFault> timing_faults(const Timing& timing) {
    // A step of a billion seconds or of a billionth is a typing error, and so is a film of eleven hours.
    constexpr double least_fps = 0.001, most_fps = 1e6;
    constexpr std::int64_t most_frames = 1'000'000;
    std::vector<TimingFault> out;
    if (!(timing.fps > 0))
        out.push_back({"fps", number_text(timing.fps) + " frames a second do not exist", "fps is above 0, usually 24"});
    else if (!(timing.fps >= least_fps && timing.fps <= most_fps))
        out.push_back(
            {"fps", number_text(timing.fps) + " frames a second are too " + (timing.fps < least_fps ? "few" : "many"),
             "fps lies between 0.001 and a million, usually at 24"});
    const std::int64_t frames = std::int64_t{timing.end} - timing.start + 1;
    if (frames < 1)
        out.push_back(
            {"end", "the end " + std::to_string(timing.end) + " comes before the start " + std::to_string(timing.start),
             "write \"start\": " + std::to_string(timing.end) + ", \"end\": " + std::to_string(timing.start) +
                 " if they are the wrong way round"});
    else if (frames > most_frames)
        out.push_back({"end",
                       std::to_string(frames) + " frames from " + std::to_string(timing.start) + " to " +
                           std::to_string(timing.end) + "; a million are possible",
                       "write the last frame that is wanted"});
    return out;
}

namespace {

/// A whole number in all its digits, where number_text may write 9e+08.
std::string frame_text(double v) {
    return v == std::floor(v) && std::abs(v) < 1e15 ? std::to_string(static_cast<std::int64_t>(v)) : number_text(v);
}

/// A simulation that cannot reach the graph's last frame from where it starts.
std::optional<Diagnostic> too_far(const Graph& graph, const std::string& name, const Node& n, const AttributeInfo& a,
                                  double start) {
    if (!n.type->simulation || a.name != n.type->simulation->start_frame_input) return {};
    const double last = graph.timing().end;
    if (!(last - start > farthest_frame)) return {};
    Diagnostic d;
    d.code = "DG104";
    d.node = name, d.attribute = a.name;
    d.spot = graph.spot(name, a.name);
    d.message = "frame " + frame_text(start) + " is too far before the graph's last, " + number_text(last);
    d.hint = "leave it out to take the graph's, or start at " + frame_text(last - farthest_frame) + " or later";
    return d;
}

} // namespace

std::vector<Diagnostic> check_timing(const Graph& graph) {
    std::vector<Diagnostic> out;
    for (const std::string& name : graph.node_names()) {
        const Node& n = *graph.find(name);
        if (!n.type) continue;
        for (const AttributeInfo& a : n.type->inputs) {
            if (a.from_timing == FromTiming::nothing) continue;
            const auto it = n.inputs.find(a.name);
            const auto* given = it == n.inputs.end() ? nullptr : std::get_if<Value>(&it->second);
            const Value expected = default_value(a, graph.timing());
            if (!given || !given->is<double>() || given->digest() == expected.digest()) continue;
            const bool start = a.from_timing == FromTiming::start;
            if (auto far = too_far(graph, name, n, a, given->as<double>())) {
                out.push_back(std::move(*far));
                continue;
            }
            Diagnostic d;
            d.severity = Severity::warning;
            d.code = "DG031";
            d.node = name, d.attribute = a.name;
            d.spot = graph.spot(name, a.name);
            d.message = frame_text(given->as<double>()) + " differs from the graph's timing." +
                        (start ? "start, " : "fps, ") + frame_text(expected.as<double>());
            const double ahead = expected.as<double>() - given->as<double>();
            if (start && ahead > 0)
                d.message += ": " + frame_text(ahead) + " frame" + (ahead == 1 ? "" : "s") +
                             " before the graph's first are simulated too";
            if (start && ahead < 0) {
                const double still = std::min(-ahead, double(graph.timing().end) - graph.timing().start + 1);
                d.message += ": " +
                             std::string(still == 1 ? "the graph's first frame shows"
                                                    : "the graph's first " + frame_text(still) + " frames show") +
                             " everything as modelled";
            }
            d.hint = std::string("leave it out to take the graph's") +
                     (start && ahead > 0 ? ", unless they are meant as a run-up to it" : "");
            out.push_back(std::move(d));
        }
    }
    return out;
}

std::string name_fault(std::string_view name) {
    if (name.empty()) return "a node needs a name";
    for (char c : name) {
        if (c == '.') return "the name holds a dot, which separates node and attribute";
        if (static_cast<unsigned char>(c) < 0x20) return "the name holds a control character";
    }
    return {};
}

} // namespace sinew::engine
