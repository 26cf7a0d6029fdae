// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/keys.h"

#include <algorithm>
#include <unordered_set>

namespace sinew::engine {

namespace {

constexpr int frames_a_call = 256;       // how long the mutex is held at most
constexpr std::size_t sites_a_call = 64; // how many nodes are evaluated together, ahead of the chain

bool is_new(std::vector<Site>& all, const Site& s) { return std::find(all.begin(), all.end(), s) == all.end(); }

} // namespace

Hasher identity(const NodeType& t) {
    Hasher h;
    h.add(t.name).add(t.version).add(t.numerics);
    if (!t.machine.empty()) h.add(t.machine);
    if (!t.revision.empty()) h.add("revision").add(t.revision);
    return h;
}

Digest content_key(const Program& program, const Place& p, double time, std::span<const std::vector<Value>> values) {
    Hasher h = identity(*p.type);
    h.add("content");
    if (p.uses_frame) h.add(time).add(program.graph()->timing().fps);
    for (std::size_t i = 0; i < p.slots.size(); ++i) {
        if (!p.slots[i].read_by_compute()) continue;
        h.add(p.slots[i].info->name).add(std::uint64_t{values[i].size()});
        for (const Value& v : values[i]) h.add(p.slots[i].ahead_digest(v));
    }
    return h.finish();
}

std::optional<Digest> Keys::known(const Site& site) const {
    const Place& p = program_.place(site.node);
    if (!p.dynamic) return p.static_key;
    if (p.is_simulation()) {
        const auto i = static_cast<std::size_t>(static_cast<int>(site.frame) - p.start_frame);
        return i < p.chain.size() ? std::optional(p.chain[i]) : std::nullopt;
    }
    const auto it = memo_.find(site);
    return it == memo_.end() ? std::nullopt : std::optional(it->second);
}

// K = H(type, frame if it reads time, for each input: name + digest of the literal sampled here | K of the
// sources). Names of nodes never take part.
Digest Keys::combine(const Site& site) const {
    const Place& p = program_.place(site.node);
    Hasher h = identity(*p.type);
    if (p.uses_frame) h.add(site.frame).add(program_.graph()->timing().fps);
    for (const Slot& s : p.slots) {
        if (!s.read_by_compute()) continue;
        h.add(s.info->name).add(static_cast<int>(s.kind == Slot::Kind::curve ? Slot::Kind::constant : s.kind));
        if (s.kind == Slot::Kind::constant || s.kind == Slot::Kind::curve) h.add(s.digest_at(site.frame));
        if (s.kind == Slot::Kind::list) h.add(std::uint64_t{s.sources.size()});
        for (const Source& source : s.sources) {
            const auto& output = program_.place(source.node).type->outputs[static_cast<std::size_t>(source.output)];
            h.add(plug_key(*known(program_.site(source, site.frame)), output.name));
        }
    }
    return h.finish();
}

std::optional<Digest> Keys::of(const Site& target, Needs& needs) {
    // Depth first with an explicit stack; a site that is met again on the way back is combined from its
    // sources.
    std::vector<Site> stack{target};
    std::unordered_set<Site, SiteHash> entered, blocked;
    while (!stack.empty()) {
        const Site site = stack.back();
        if (known(site) || blocked.contains(site)) {
            stack.pop_back();
            continue;
        }
        const Place& p = program_.place(site.node);
        if (p.is_simulation()) {
            int& frame = needs.chains.try_emplace(site.node, p.start_frame).first->second;
            frame = std::max(frame, static_cast<int>(site.frame));
            blocked.insert(site);
            stack.pop_back();
            continue;
        }
        const bool returning = !entered.insert(site).second;
        bool missing = false;
        for (const Slot& s : p.slots) {
            if (!s.read_by_compute()) continue;
            for (const Source& source : s.sources) {
                const Site up = program_.site(source, site.frame);
                if (known(up)) continue;
                missing = true;
                if (!returning) stack.push_back(up);
            }
        }
        if (!missing) {
            const Digest key = combine(site);
            if (p.dynamic)
                memo_.emplace(site, key);
            else
                program_.place(site.node).static_key = key;
        } else if (returning) {
            blocked.insert(site);
        }
        if (!missing || returning) stack.pop_back();
    }
    return known(target);
}

std::optional<Digest> Keys::of(const Source& source, double frame, Needs& needs) {
    return of(program_.site(source, frame), needs);
}

// Literals, keyed values and connections of equal content give equal digests, so that replacing one by
// another does not move the chain.
std::optional<Digest> Keys::content(const Slot& slot, double time, Needs& needs, bool with_aside) {
    if (slot.kind == Slot::Kind::constant || slot.kind == Slot::Kind::curve) return slot.digest_at(time);
    Hasher h;
    h.add(std::uint64_t{slot.sources.size()});
    bool complete = true;
    std::optional<Digest> single;
    for (const Source& source : slot.sources) {
        const Site site = program_.site(source, time);
        const auto key = of(site, needs);
        if (!key) {
            complete = false;
            continue;
        }
        const auto& output = program_.place(source.node).type->outputs[static_cast<std::size_t>(source.output)];
        const Digest plug = plug_key(*key, output.name);
        const auto content = content_(plug, *key, source.output, DigestPart::content);
        const auto aside = with_aside ? content_(plug, *key, source.output, DigestPart::aside) : Digest{};
        if (content && aside) {
            h.add(*content);
            if (with_aside) h.add(*aside);
            single = content;
        } else {
            complete = false;
            if (is_new(needs.values, site)) needs.values.push_back(site);
        }
    }
    if (!complete) return {};
    return slot.kind == Slot::Kind::wire ? single : h.finish();
}

// By content, so that it does not matter whether a literal, keys or a connection says so.
std::optional<bool> Keys::is_on(const Place& p, std::string_view input, double time, Needs& needs) {
    for (const Slot& s : p.slots)
        if (s.info->name == input) {
            const auto content = this->content(s, time, needs);
            return content ? std::optional(*content != Value::of<bool>(false).digest()) : std::nullopt;
        }
    return true;
}

std::optional<Digest> Keys::inputs_digest(const Place& p, double time, bool initial, Needs& needs) {
    Hasher h;
    bool complete = true;
    for (const Slot& s : p.slots) {
        if (!s.read_by_compute() || (s.info->affects == Affects::initial_state && !initial)) continue;
        const auto matters = s.info->when.empty() ? true : is_on(p, s.info->when, time, needs);
        const auto with_aside = s.info->aside_when.empty() ? false : is_on(p, s.info->aside_when, time, needs);
        complete = complete && matters && with_aside;
        if (matters && !*matters) continue;
        const auto content = this->content(s, time, needs, with_aside.value_or(false));
        complete = complete && content;
        if (content) h.add(s.info->name).add(*content);
    }
    return complete ? std::optional(h.finish()) : std::nullopt;
}

std::vector<SubstepTimes> Keys::read_times(int simulation, int frame) const {
    const Place& p = program_.place(simulation);
    if (frame <= p.start_frame) return {{{}, static_cast<double>(p.start_frame)}};
    const int n = program_.substeps(p, frame);
    std::vector<SubstepTimes> out;
    for (int k = 0; k < n; ++k) {
        SubstepTimes& times = out.emplace_back();
        times.end = k + 1 < n ? frame - 1 + static_cast<double>(k + 1) / n : frame;
        for (const double fraction : program_.stages(p, times.end))
            times.within.push_back(frame - 1 + (k + fraction) / n);
    }
    return out;
}

// S(start) = H(type, fps, start, D of every input at the start); S(n) = H(S(n-1), D of the inputs at the stages and the
// end of each sub-step).
std::optional<Digest> Keys::link(int simulation, int frame, Needs& needs) {
    const Place& p = program_.place(simulation);
    const bool initial = frame == p.start_frame;
    const auto i = static_cast<std::size_t>(frame - p.start_frame);
    const std::vector<SubstepTimes> times = read_times(simulation, frame);
    Hasher h = identity(*p.type);
    if (initial)
        h.add(program_.graph()->timing().fps).add(p.start_frame);
    else if (i <= p.chain.size())
        h.add(p.chain[i - 1]);
    h.add(std::uint64_t{times.size()});
    bool complete = i <= p.chain.size();
    const auto add = [&](double time) {
        const auto inputs = inputs_digest(p, time, initial, needs);
        complete = complete && inputs;
        if (inputs) h.add(*inputs);
    };
    for (const SubstepTimes& t : times) {
        for (const double within : t.within) h.add("stage"), add(within);
        add(t.end);
    }
    return complete ? std::optional(h.finish()) : std::nullopt;
}

bool Keys::extend(int simulation, int frame, Needs& needs) {
    Place& p = program_.place(simulation);
    const int first = p.start_frame + static_cast<int>(p.chain.size());
    const int last = std::min(frame, first + frames_a_call - 1);
    for (int f = first; f <= last; ++f) {
        const auto s = link(simulation, f, needs);
        if (s) p.chain.push_back(*s);
        // Something is missing: look ahead a little, so that the missing values can be computed side by side.
        else if (needs.values.size() >= sites_a_call || !needs.chains.empty())
            break;
    }
    return needs.empty() && p.start_frame + static_cast<int>(p.chain.size()) > frame;
}

const Digest& Keys::frame_key(int simulation, int frame) const {
    const Place& p = program_.place(simulation);
    return p.chain[static_cast<std::size_t>(std::max(0, frame - p.start_frame))];
}

} // namespace sinew::engine
