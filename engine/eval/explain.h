// "Why would this run?", answered from keys alone. Never computes a node.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/core.h"
#include "engine/eval/keys.h"

namespace sinew::engine {

class Explainer {
  public:
    Explainer(Core& core, std::shared_ptr<Program> program);
    Verdict explain(int node, double frame);
    Readiness readiness(int node, double frame);

  private:
    struct Difference {
        std::vector<std::string> plugs;
        int frame = 0; ///< simulations: the first frame whose key differs
    };
    /// Extends chains as far as the known digests reach; empty if the key is still unknown, with the reason
    /// in needs.
    std::optional<Digest> key(const Site& site, Needs& needs);
    /// Needs the mutex. Stored under the key, or under what the inputs hold where those are stored.
    bool is_stored(const Site& site, const Digest& key);
    Site first_missing(Site site);
    std::vector<std::string> differs_from_kept(const Site& site, bool& found) const;
    struct FromFrames {
        std::vector<std::string>
            plugs;                 ///< in which it differs from the one that it differs from least, of such the newest
        bool is_of_others = false; ///< there are some, but none that differs in what it was made from
        std::string text(int frame) const; ///< empty where nothing is kept
    };
    /// How a frame differs from those of the same number that are kept on disk of this node.
    FromFrames differs_from_frames(int simulation, int frame) const;
    void name_first(Verdict& out, const Site& from);
    Verdict undecided(const Needs& needs, int simulation, double frame);
    Verdict of_frame(int simulation, int frame);
    std::shared_ptr<Program> earlier(const std::string& node, const NodeType* type) const;
    int first_difference(const Place& now, const Place& before) const;
    std::vector<std::string> changed_plugs(Program& before, Keys& old_keys, const Site& now, const Site& then,
                                           double time);

    Core& core_;
    std::shared_ptr<Program> program_;
    Keys keys_;
};

} // namespace sinew::engine
