// The evaluator's side of Reads: hands out the values that were gathered for one node at one time, and
// refuses what was not declared.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/core.h"

#include <stop_token>

namespace sinew::engine {

/// Values of all slots of a node at one time, in the order of its slots; lists hold several.
using SlotValues = std::vector<std::vector<Value>>;

enum class Phase { compute, initial, advance, publish };

/// What the reads of one call have in common.
struct CallContext {
    Core* core = nullptr;
    const Program* program = nullptr;
    const Place* place = nullptr;
    std::stop_token stop;
    double frame = 0; ///< for messages; also for nodes that do not change over time
    Phase phase = Phase::compute;
    std::mutex mutex;
    std::vector<Diagnostic> warnings; ///< kept with the result, so that a later reuse can repeat them
};

class NodeReads : public ReadSource {
  public:
    NodeReads(CallContext& context, SlotValues values, double time)
        : context_(context)
        , values_(std::move(values))
        , time_(time) {}
    Value get(std::string_view attribute) override;
    std::vector<Value> get_list(std::string_view attribute) override;
    Digest digest(std::string_view attribute) override;
    std::pair<Value, Value> around(std::string_view attribute) override;
    bool is_ever_on(std::string_view attribute) override;
    std::vector<Value> list_at_start(std::string_view attribute) override;
    std::vector<std::string> entry_names(std::string_view attribute) override;
    double frame() override;
    double fps() override;
    const FileAccess& files() override { return context_.program->graph()->files(); }
    void checkpoint() override;
    void progress(double done, std::string_view what) override;
    void report(Diagnostic d) override;
    [[noreturn]] void fail(Diagnostic d) override;
    std::shared_ptr<void> take_scratch(const Digest& key) override;
    void give_scratch(const Digest& key, std::shared_ptr<void> scratch) override;
    std::string source_name(std::string_view attribute, std::size_t index) override;
    std::string source_behind(std::string_view attribute, std::size_t index, std::string_view input,
                              std::size_t entry) override;
    bool stop_requested() override { return context_.stop.stop_requested(); }

  private:
    std::size_t slot(std::string_view attribute) const;
    void refuse_outside(const Slot& s, const Value& v);
    void place(Diagnostic& d) const;
    void needs_time(std::string_view what) const;
    Digest scratch_key(const Digest& key) const;
    CallContext& context_;
    SlotValues values_;
    double time_;
};

} // namespace sinew::engine
