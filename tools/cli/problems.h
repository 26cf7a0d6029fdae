// All that can be found wrong with a graph without simulating a step.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/cli/progress.h"

#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace sinew::cli {

/// Keeps the warnings that nodes give, and says on `err` what is being computed where that takes longer than a second,
/// as `sinew run` does in a log.
class WarningCollector : public engine::Observer {
  public:
    /// \param frame that the command is after
    /// \param is_quiet say nothing of that
    WarningCollector(std::shared_ptr<const engine::Graph> graph, double frame, bool is_quiet, std::ostream& err);
    void warning(const engine::Diagnostic& d) override;
    void begins(const std::string& node, double frame) override { progress_.begins(node, frame); }
    void ends(const std::string& node, double frame) override { progress_.ends(node, frame); }
    void progress(const std::string& node, double done, std::string_view what) override {
        progress_.progress(node, done, what);
    }
    void stepped(const std::string& node, double frame, double seconds) override {
        progress_.stepped(node, frame, seconds);
    }
    std::vector<engine::Diagnostic> take();

  private:
    std::mutex mutex_;
    std::vector<engine::Diagnostic> warnings_;
    std::set<std::string> texts_; ///< of warnings_
    Progress progress_;
};

/// Evaluates `nodes` at a frame at which their simulations start, and returns every error once, in the order
/// of the file. Throws Cancelled. A node that fails runs once, here and in later pulls with the same `failures`.
std::vector<engine::Diagnostic>
find_problems(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
              const std::vector<std::string>& nodes, std::stop_token stop,
              const std::shared_ptr<engine::Failures>& failures = engine::remember_failures());

/// What the solvers of a graph would be refused for after their start, up to the frame `last`, as far as that can be
/// told without a step: the first for each. Of solvers that read other simulations nothing is told, since those would
/// have to be simulated. No solver looks at more than about `most` sub-steps: at frames of keys, and at others spread
/// evenly.
std::vector<engine::Diagnostic> find_later_problems(const std::shared_ptr<const engine::Graph>& graph,
                                                    engine::Evaluator& evaluator, int last, int most,
                                                    std::stop_token stop,
                                                    const std::shared_ptr<engine::Failures>& failures);

/// Makes errors of what the reader notes of nodes of unknown types: the rest may run without them, but nobody writes
/// one on purpose. What says again that such a node was needed is left out.
void refuse_unknown_types(std::vector<engine::Diagnostic>& diagnostics);

/// By place in the file; what has no place comes last, in the order given. Says each thing once.
void sort_by_place(std::vector<engine::Diagnostic>& diagnostics);

bool has_error(const std::vector<engine::Diagnostic>& diagnostics);

} // namespace sinew::cli
