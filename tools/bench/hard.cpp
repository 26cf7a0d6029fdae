// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hard.h"

#include "solver/error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

namespace sinew::bench {

namespace {

constexpr std::array outcomes{Outcome::recovered, Outcome::elsewhere, Outcome::stopped, Outcome::wrong};

std::string full_name(const HardCase& c) {
    return std::string(c.name) + (c.variant.empty() ? "" : ", " + std::string(c.variant));
}

} // namespace

HardResult run_case(const HardCase& c, const HardSetting& setting, const std::stop_token& stop) {
    HardResult out;
    out.of = &c, out.setting = setting;
    const auto start = std::chrono::steady_clock::now();
    HardTrial trial(setting, stop);
    try {
        c.run(trial);
        out.outcome = trial.outcome, out.why = trial.why;
    } catch (const WrongAnswer& e) {
        out.outcome = Outcome::wrong, out.why = e.why;
    } catch (const solver::Error& e) {
        out.outcome = Outcome::stopped, out.why = e.code;
    } catch (const solver::Stopped&) {
        throw;
    } catch (const std::exception& e) {
        out.outcome = Outcome::wrong, out.why = std::string("an exception without a code: ") + e.what();
    }
    out.steps = trial.steps, out.unconverged = trial.unconverged;
    out.halvings = trial.halvings, out.newton = trial.newton;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

std::vector<HardResult> run_hard(const RunOptions& options) {
    std::vector<HardResult> out;
    for (const HardCase& c : hard_cases()) {
        if (!options.wants(full_name(c)) || (options.quick && !c.quick)) continue;
        options.tell(full_name(c));
        std::vector<HardSetting> settings;
        for (const ElementName& element : elements)
            for (const LawName& law : all_laws)
                for (const IntegratorName& integrator : all_integrators) {
                    // In a quick run one law of each kind of strain.
                    const bool is_quick =
                        element.kind == solver::ElementKind::linear &&
                        (law.law == solver::ElasticLaw::stvk || law.law == solver::ElasticLaw::neo_hookean);
                    const bool is_first = &element == &elements[0] && &law == &all_laws[0];
                    if (c.cloth ? is_first : is_quick || !options.quick) settings.push_back({law, element, integrator});
                }
        const std::size_t first = out.size();
        out.resize(first + settings.size());
        tbb::parallel_for(std::size_t{0}, settings.size(), [&](std::size_t i) {
            if (options.stop.stop_requested()) throw solver::Stopped();
            out[first + i] = run_case(c, settings[i], options.stop);
        });
    }
    return out;
}

Table hard_overview(const std::vector<HardResult>& results) {
    Table t{{"case", "must end", "runs"}, {}};
    for (const Outcome o : outcomes) t.columns.emplace_back(name_of(o));
    t.columns.insert(t.columns.end(), {"frames not converged", "Newton a frame"});
    for (auto first = results.begin(); first != results.end();) {
        const auto last = std::find_if(first, results.end(), [&](const HardResult& r) { return r.of != first->of; });
        std::vector<std::string> row = {full_name(*first->of), std::string(first->of->must),
                                        std::to_string(last - first)};
        for (const Outcome o : outcomes)
            row.push_back(
                std::to_string(std::count_if(first, last, [&](const HardResult& r) { return r.outcome == o; })));
        int steps = 0, unconverged = 0, newton = 0;
        std::for_each(first, last,
                      [&](const HardResult& r) { steps += r.steps, unconverged += r.unconverged, newton += r.newton; });
        row.push_back(std::to_string(unconverged) + " of " + std::to_string(steps));
        row.push_back(number(static_cast<double>(newton) / std::max(1, steps), 3));
        t.rows.push_back(std::move(row));
        first = last;
    }
    return t;
}

Table hard_table(const std::vector<HardResult>& results) {
    Table t{{"case", "element", "law"}, {}};
    for (const IntegratorName& i : all_integrators) t.columns.emplace_back(i.word);
    for (const HardResult& r : results) {
        const std::vector<std::string> key = {full_name(*r.of), std::string(r.setting.element.word),
                                              std::string(r.setting.law.word)};
        if (t.rows.empty() || !std::equal(key.begin(), key.end(), t.rows.back().begin())) {
            t.rows.push_back(key);
            t.rows.back().resize(t.columns.size(), "-");
        }
        const auto column = std::find(t.columns.begin(), t.columns.end(), r.setting.integrator.word);
        t.rows.back()[static_cast<std::size_t>(column - t.columns.begin())] =
            name_of(r.outcome) + (r.outcome == Outcome::stopped ? " " + r.why : "");
    }
    return t;
}

Table hard_faults(const std::vector<HardResult>& results) {
    Table t{{"case", "element", "law", "integrator", "what is wrong"}, {}};
    for (const HardResult& r : results)
        if (r.outcome == Outcome::wrong)
            t.rows.push_back({full_name(*r.of), std::string(r.setting.element.word), std::string(r.setting.law.word),
                              std::string(r.setting.integrator.word), r.why});
    return t;
}

std::string hard_summary(const std::vector<HardResult>& results) {
    std::string out = std::to_string(results.size()) + " runs";
    for (const Outcome o : outcomes)
        out += std::string(o == outcomes.front() ? ": " : ", ") +
               std::to_string(
                   std::count_if(results.begin(), results.end(), [&](const HardResult& r) { return r.outcome == o; })) +
               " " + name_of(o);
    return out;
}

nlohmann::ordered_json hard_json(const std::vector<HardResult>& results) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const HardResult& r : results)
        out.push_back({{"case", r.of->name},
                       {"variant", r.of->variant},
                       {"element", r.setting.element.word},
                       {"law", r.setting.law.word},
                       {"integrator", r.setting.integrator.word},
                       {"outcome", name_of(r.outcome)},
                       {"why", r.why},
                       {"steps", r.steps},
                       {"unconverged", r.unconverged},
                       {"halvings", r.halvings},
                       {"newton", r.newton},
                       {"seconds", r.seconds}});
    return out;
}

} // namespace sinew::bench
