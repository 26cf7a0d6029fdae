// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/explain.h"

#include "engine/text.h"

#include <algorithm>
#include <set>

namespace sinew::engine {

namespace {

ContentOf table_only(Core& core) {
    return [&core](const Digest& plug, const Digest&, int) { return core.contents.find(plug); };
}

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
    return out;
}

} // namespace

Explainer::Explainer(Core& core, std::shared_ptr<Program> program)
    : core_(core)
    , program_(std::move(program))
    , keys_(*program_, table_only(core)) {}

Verdict Explainer::undecided(const Needs& needs, double frame) const {
    Verdict out;
    out.readiness = Readiness::undecided;
    const Site s = needs.values.empty() ? Site{} : needs.values.front();
    const std::string node = needs.values.empty() ? "the sources" : program_->place(s.node).name;
    const bool dynamic = s.node >= 0 && program_->place(s.node).dynamic;
    out.because = node + (dynamic ? " at frame " + number_text(s.frame) : "") +
                  " must be evaluated before it is known whether frame " + number_text(frame) + " is there";
    if (s.node >= 0) out.changed_plugs.push_back(node);
    return out;
}

// The snapshot pulled last, other than this one, in which a node of this name and type stood.
std::shared_ptr<Program> Explainer::earlier(const std::string& node, const NodeType* type) const {
    for (auto it = core_.programs.rbegin(); it != core_.programs.rend(); ++it) {
        if (*it == program_ || !(*it)->pulled) continue;
        const int there = (*it)->find(node);
        if (there >= 0 && (*it)->place(there).type == type) return *it;
    }
    return {};
}

int Explainer::first_difference(const Place& now, const Place& before) const {
    const std::size_t shared = std::min(now.chain.size(), before.chain.size());
    for (std::size_t i = 0; i < shared; ++i)
        if (now.chain[i] != before.chain[i]) return now.start_frame + static_cast<int>(i);
    return now.start_frame + static_cast<int>(shared);
}

// Walks both snapshots upstream side by side, into whatever differs, and names the inputs at which they part.
std::vector<std::string> Explainer::changed_plugs(Program& before, Keys& old_keys, const Site& now, const Site& then,
                                                  double time) {
    std::vector<std::string> out;
    std::set<std::pair<int, int>> seen;
    std::vector<std::pair<Site, Site>> stack{{now, then}};
    while (!stack.empty()) {
        const auto [a, b] = stack.back();
        stack.pop_back();
        if (!seen.emplace(a.node, b.node).second) continue;
        const Place &p = program_->place(a.node), &q = before.place(b.node);
        if (p.type != q.type) {
            out.push_back(p.name);
            continue;
        }
        for (std::size_t i = 0; i < p.slots.size(); ++i) {
            const Slot &s = p.slots[i], &t = q.slots[i];
            if (!s.read_by_compute()) continue;
            const std::string plug = p.name + "." + std::string(s.info->name);
            const bool wired = !s.sources.empty() || !t.sources.empty();
            if (!wired) {
                const bool literal = s.kind == Slot::Kind::constant || s.kind == Slot::Kind::curve;
                if (literal && s.digest_at(time) != t.digest_at(time)) out.push_back(plug);
            } else if (s.sources.size() != t.sources.size()) {
                out.push_back(plug);
            } else {
                for (std::size_t k = 0; k < s.sources.size(); ++k) {
                    const Site up = program_->site(s.sources[k], time), old_up = before.site(t.sources[k], time);
                    Needs needs;
                    const auto key = keys_.of(up, needs), old_key = old_keys.of(old_up, needs);
                    if (s.sources[k].output != t.sources[k].output)
                        out.push_back(plug);
                    else if (!key || !old_key || *key != *old_key)
                        stack.emplace_back(up, old_up);
                }
            }
        }
    }
    return out;
}

Verdict Explainer::of_frame(int simulation, int frame) {
    Place& p = program_->place(simulation);
    Verdict out;
    int nearest = frame;
    while (nearest >= p.start_frame && !core_.states.contains(keys_.frame_key(simulation, nearest))) --nearest;
    out.first_frame = std::min(nearest + 1, frame);
    out.last_frame = frame;
    const auto before = earlier(p.name, p.type);
    std::string change;
    if (before) {
        const int there = before->find(p.name);
        const Place& q = before->place(there);
        const int differs = first_difference(p, q);
        if (q.start_frame == p.start_frame && differs <= frame &&
            differs < q.start_frame + static_cast<int>(q.chain.size())) {
            Keys old_keys(*before, table_only(core_));
            std::vector<double> times;
            for (const SubstepTimes& t : keys_.read_times(simulation, differs)) {
                times.insert(times.end(), t.within.begin(), t.within.end());
                times.push_back(t.end);
            }
            for (double t : times) {
                const auto plugs = changed_plugs(*before, old_keys, {simulation, static_cast<double>(differs)},
                                                 {there, static_cast<double>(differs)}, t);
                for (const std::string& plug : plugs)
                    if (std::find(out.changed_plugs.begin(), out.changed_plugs.end(), plug) == out.changed_plugs.end())
                        out.changed_plugs.push_back(plug);
            }
            change =
                "its inputs differ from frame " + std::to_string(differs) + " on (" + joined(out.changed_plugs) + "); ";
        }
    }
    if (nearest == frame) {
        out.because = change + "the state is there, only the outputs have to be published";
    } else {
        out.because = change +
                      (nearest < p.start_frame ? "no state is there to go on from"
                                               : "the nearest state is that of frame " + std::to_string(nearest)) +
                      "; frames " + std::to_string(nearest + 1) + " to " + std::to_string(frame) +
                      " would be simulated";
    }
    return out;
}

std::optional<Digest> Explainer::key(const Site& site, Needs& missing) {
    Needs wanted;
    while (true) {
        if (const auto found = keys_.of(site, wanted)) return found;
        Needs deeper; // the simulations upstream of those that are wanted
        bool grew = false;
        for (const auto& [simulation, last] : wanted.chains) {
            const auto length = [&] { return program_->place(simulation).chain.size(); };
            const std::size_t before = length();
            while (!keys_.extend(simulation, last, deeper) && deeper.empty()) {
            }
            grew = grew || length() > before;
        }
        if (!deeper.values.empty() || (!grew && deeper.chains.empty())) {
            missing = deeper;
            return {};
        }
        wanted = deeper;
    }
}

Readiness Explainer::readiness(int node, double frame) {
    const std::lock_guard lock(core_.mutex);
    Needs missing;
    const auto found = key(program_->site(node, frame), missing);
    if (!found) return Readiness::undecided;
    return core_.values.contains(*found) ? Readiness::ready : Readiness::would_run;
}

Verdict Explainer::explain(int node, double frame) {
    const std::lock_guard lock(core_.mutex);
    const Site site = program_->site(node, frame);
    Needs missing, none;
    const auto found = key(site, missing);
    if (!found) return undecided(missing, frame);
    const Digest key = *found;
    Place& p = program_->place(node);
    Verdict out;
    if (core_.values.contains(key)) {
        out.readiness = Readiness::ready;
        out.because = "the value is stored";
        return out;
    }
    if (p.is_simulation()) return of_frame(node, static_cast<int>(site.frame));
    // Simulations upstream whose frames are missing decide how long it would take.
    const std::vector<int> cone = program_->cone(node);
    for (auto it = cone.rbegin(); it != cone.rend(); ++it) {
        const Place& up = program_->place(*it);
        if (!up.is_simulation()) continue;
        const Site there = program_->site(*it, frame);
        const auto up_key = keys_.of(there, none);
        if (!up_key || core_.values.contains(*up_key)) continue;
        out = of_frame(*it, static_cast<int>(there.frame));
        out.because = up.name + ": " + out.because;
        return out;
    }
    out.first_frame = out.last_frame = frame;
    if (const auto before = earlier(p.name, p.type)) {
        const int there = before->find(p.name);
        Keys old_keys(*before, table_only(core_));
        out.changed_plugs = changed_plugs(*before, old_keys, site, before->site(there, frame), frame);
    }
    out.because = out.changed_plugs.empty() ? "the value is not in the store"
                                            : "its inputs differ (" + joined(out.changed_plugs) + ")";
    return out;
}

} // namespace sinew::engine
