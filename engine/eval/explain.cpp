// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/explain.h"

#include "engine/byte_stream.h"
#include "engine/eval/kept_entry.h"
#include "engine/eval/session.h"
#include "engine/text.h"

#include <algorithm>
#include <map>
#include <set>

namespace sinew::engine {

namespace {

ContentOf table_only(Core& core) {
    return [&core](const Digest& plug, const Digest&, int, DigestPart part) {
        return core.contents.find(part == DigestPart::aside ? aside_key(plug) : plug);
    };
}

std::string joined(const std::vector<std::string>& words) {
    constexpr std::size_t most = 6;
    std::string out;
    for (std::size_t i = 0; i < words.size() && i < most; ++i) out += (i ? ", " : "") + words[i];
    if (words.size() > most) out += " and " + std::to_string(words.size() - most) + " more";
    return out;
}

// Names all that differs between what something kept was made from and what it would be made from now.
std::vector<std::string> differing(const KeptInputs& kept, const std::vector<std::pair<std::string, Digest>>& now) {
    std::vector<std::string> out;
    std::map<std::string, Digest> before(kept.contents.begin(), kept.contents.end());
    for (const auto& [plug, content] : now) {
        const auto it = before.find(plug);
        if (it == before.end() || it->second != content) out.push_back(plug);
        if (it != before.end()) before.erase(it);
    }
    for (const auto& [plug, content] : before) out.push_back(plug);
    return out;
}

} // namespace

Explainer::Explainer(Core& core, std::shared_ptr<Program> program)
    : core_(core)
    , program_(std::move(program))
    , keys_(*program_, table_only(core)) {}

bool Explainer::is_stored(const Site& site, const Digest& key) {
    if (core_.values.contains(key)) return true;
    const Place& p = program_->place(site.node);
    if (core_.frames && p.is_simulation() && core_.frames->contains(key)) return true;
    if (core_.disk && p.is_kept() && core_.disk->read(key).payload) return true;
    if (p.is_simulation()) return false;
    std::vector<Site> missing;
    const auto stored = [&](const Site& up) -> EntryPtr {
        Needs none;
        const auto up_key = keys_.of(up, none);
        return up_key ? core_.values.find(*up_key) : nullptr;
    };
    const SlotValues values = gather(*program_, p, site.frame, Phase::compute, stored, missing);
    return missing.empty() && core_.values.contains(content_key(*program_, p, site.frame, values));
}

// The first node upstream of what is missing that nothing is stored of; what it needs is all there.
Site Explainer::first_missing(Site site) {
    while (true) {
        const Place& p = program_->place(site.node);
        std::optional<Site> missing;
        for (const Slot& s : p.slots) {
            if (!s.read_by_compute()) continue;
            for (const Source& source : s.sources) {
                const Site up = program_->site(source, site.frame);
                Needs none;
                const auto up_key = keys_.of(up, none);
                if (!missing && !(up_key && is_stored(up, *up_key))) missing = up;
            }
        }
        if (!missing) return site;
        site = *missing;
    }
}

// Compares with what a kept file of this node was made from: names all that differs.
std::vector<std::string> Explainer::differs_from_kept(const Site& site, bool& found) const {
    const Place& p = program_->place(site.node);
    found = false;
    if (!core_.disk || !p.is_kept()) return {};
    for (const Digest& key : core_.disk->newest_first()) {
        const auto read = core_.disk->read(key);
        if (!read.payload) continue;
        KeptInputs kept;
        try {
            kept = decode_inputs(*read.payload);
        } catch (const BadBytes&) {
            continue;
        }
        if (kept.node != p.name) continue;
        found = true;
        return differing(kept, program_->recipe(site.node, site.frame));
    }
    return {};
}

Explainer::FromFrames Explainer::differs_from_frames(int simulation, int frame) const {
    FromFrames out;
    if (!core_.frames) return out;
    const Place& p = program_->place(simulation);
    const auto recipe = program_->recipe(simulation, frame);
    const Digest self = identity(*p.type).finish();
    for (const FrameStore::Listed& kept : core_.frames->frames_of(p.name)) {
        if (kept.frame != frame) continue;
        auto differs = differing(kept.made_from, recipe);
        if (kept.made_by != self || differs.empty())
            out.is_of_others = true;
        else if (out.plugs.empty() || differs.size() < out.plugs.size())
            out.plugs = std::move(differs);
    }
    if (!out.plugs.empty()) out.is_of_others = false;
    return out;
}

std::string Explainer::FromFrames::text(int frame) const {
    const std::string kept = "what is kept of frame " + std::to_string(frame);
    if (!plugs.empty()) return kept + " differs in " + joined(plugs);
    return is_of_others
               ? kept +
                     " is of another build of Sinew, of another processor's kernels, or of a run that differs before it"
               : "";
}

// Names the plug at which work begins and why it is not there already, and how what is kept on disk differs.
void Explainer::name_first(Verdict& out, const Site& from) {
    const Site first = first_missing(from);
    const Place& p = program_->place(first.node);
    out.first_plug = p.name + "." + std::string(p.type->outputs.front().name);
    const std::string at = p.dynamic && !p.is_simulation() ? " at frame " + number_text(first.frame) : "";
    std::string why =
        "nothing is known of it: its values are not kept on disk, and here it is evaluated for the first time";
    if (const auto before = earlier(p.name, p.type)) {
        const int there = before->find(p.name);
        Keys old_keys(*before, table_only(core_));
        const auto plugs = changed_plugs(*before, old_keys, first, before->site(there, first.frame), first.frame);
        why = plugs.empty() ? "it was not evaluated at this frame before, or the store has dropped it"
                            : "its inputs differ from those before the edit in " + joined(plugs);
        if (out.changed_plugs.empty()) out.changed_plugs = plugs;
    } else if (program_->pulled) {
        why = "it was not evaluated at this frame before, or the store has dropped it";
    }
    out.because += "; first " + out.first_plug + at + " (" + std::string(p.type->name) + ") must be evaluated: " + why;
    const std::vector<int> cone = program_->cone(from.node); // sources first
    for (const int node : cone) {
        const Place& kept = program_->place(node);
        if (!core_.disk || !kept.is_kept()) continue;
        const Site site = program_->site(node, from.frame);
        Needs none;
        const auto key = keys_.of(site, none);
        if (!key || is_stored(site, *key)) continue;
        bool found = false;
        const auto plugs = differs_from_kept(site, found);
        if (!found)
            out.because += "; nothing is kept on disk of " + kept.name;
        else if (plugs.empty())
            out.because += "; what is kept on disk of " + kept.name + " was made by another version of the program";
        else
            out.because += "; what is kept on disk of " + kept.name + " differs in " + joined(plugs);
        if (out.changed_plugs.empty()) out.changed_plugs = plugs;
    }
}

Verdict Explainer::undecided(const Needs& needs, int simulation, double frame) {
    Verdict out;
    const Site s = needs.values.empty() ? Site{} : needs.values.front();
    const std::string node = needs.values.empty() ? "the sources" : program_->place(s.node).name;
    const bool dynamic = s.node >= 0 && program_->place(s.node).dynamic;
    if (core_.states.bytes() == 0 && simulation >= 0) {
        // Nothing was simulated yet, so whatever the inputs are, there is no frame that could be the one.
        const Place& p = program_->place(simulation);
        out.readiness = Readiness::would_run;
        out.first_frame = p.start_frame;
        out.last_frame = program_->site(simulation, frame).frame;
        out.because = "no frame of " + p.name + " is there; frames " + number_text(out.first_frame) + " to " +
                      number_text(out.last_frame) + " would be simulated";
        // As far as the chain is known, frames may be kept on disk; where it ends, something has changed.
        const int kept = static_cast<int>(p.chain.size());
        const int next = p.start_frame + kept;
        if (core_.frames && next <= out.last_frame) {
            if (kept > 0 && core_.frames->contains(p.chain.back())) {
                out.first_frame = next;
                out.because = "frames " + std::to_string(p.start_frame) + " to " + std::to_string(next - 1) + " of " +
                              p.name + " are kept on disk; frames " + std::to_string(next) + " to " +
                              number_text(out.last_frame) + " would be simulated";
            }
            const FromFrames from = differs_from_frames(simulation, next);
            out.changed_plugs = from.plugs;
            if (!from.plugs.empty()) out.because += ", unless what differs comes to the same for " + p.name;
            if (const std::string text = from.text(next); !text.empty()) out.because += "; " + text;
        }
    } else {
        out.readiness = Readiness::undecided;
        out.because = node + (dynamic ? " at frame " + number_text(s.frame) : "") +
                      " must be evaluated before it is known whether frame " + number_text(frame) + " is there";
    }
    if (s.node >= 0) name_first(out, s);
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
    const auto has_state = [&](const Digest& key) {
        return core_.states.contains(key) || (core_.frames && core_.frames->contains(key));
    };
    while (nearest >= p.start_frame && !has_state(keys_.frame_key(simulation, nearest))) --nearest;
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
    if (out.changed_plugs.empty() && nearest < frame) { // or from what an earlier process left
        const FromFrames from = differs_from_frames(simulation, out.first_frame);
        out.changed_plugs = from.plugs;
        if (const std::string text = from.text(out.first_frame); !text.empty()) change = text + "; ";
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
        for (const auto& chain : wanted.chains) {
            const auto simulation = chain.first;
            const auto last = chain.second;
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
    core_.recall();
    Needs missing;
    const auto found = key(program_->site(node, frame), missing);
    if (!found) return Readiness::undecided;
    return is_stored(program_->site(node, frame), *found) ? Readiness::ready : Readiness::would_run;
}

Verdict Explainer::explain(int node, double frame) {
    const std::lock_guard lock(core_.mutex);
    core_.recall();
    const Site site = program_->site(node, frame);
    Needs missing, none;
    const auto found = key(site, missing);
    Place& p = program_->place(node);
    if (!found) {
        // The simulation that decides: this one, or the one nearest upstream.
        int simulation = p.is_simulation() ? node : -1;
        const std::vector<int> cone = program_->cone(node);
        for (auto it = cone.rbegin(); it != cone.rend() && simulation < 0; ++it)
            if (program_->place(*it).is_simulation()) simulation = *it;
        return undecided(missing, simulation, frame);
    }
    const Digest key = *found;
    Verdict out;
    if (is_stored(site, key)) {
        out.readiness = Readiness::ready;
        const bool in_memory = core_.values.contains(key);
        const bool on_disk =
            (core_.disk && p.is_kept()) || (core_.frames && p.is_simulation() && core_.frames->contains(key));
        out.because = !in_memory && on_disk ? "the value is kept on disk" : "the value is stored";
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
    name_first(out, site);
    return out;
}

} // namespace sinew::engine
