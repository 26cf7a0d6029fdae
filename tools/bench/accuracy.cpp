// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/accuracy.h"

#include "solver/error.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

/// Sections of the catalogue that need terms which the engine does not have.
constexpr std::array<std::array<const char*, 3>, 2> missing{{
    {"8", "free bar under a constant tension", "a fibre whose pull does not depend on its length"},
    {"13", "released bar with consistent mass", "a consistent mass matrix on linear tets, which lump"},
}};

} // namespace

bool in_locking_range(solver::ElementKind element, double poissons_ratio) {
    return element == solver::ElementKind::linear && poissons_ratio >= 0.49;
}

CaseResult& Book::add(CaseKind kind, std::string setting, std::string quantity, const Work& work) {
    CaseResult r;
    r.section = section_, r.name = name_, r.setting = std::move(setting), r.quantity = std::move(quantity);
    r.kind = kind, r.work = work;
    results.push_back(std::move(r));
    return results.back();
}

void Book::judge(CaseKind kind, std::string setting, std::string quantity, double value, double reference, double error,
                 double tolerance, const Work& work) {
    CaseResult& r = add(kind, std::move(setting), std::move(quantity), work);
    r.value = value, r.reference = reference, r.error = error, r.tolerance = tolerance;
    r.status = error <= tolerance && work.unconverged == 0 ? CaseStatus::pass : CaseStatus::fail;
    if (work.unconverged) r.note = std::to_string(work.unconverged) + " steps did not converge";
}

void Book::compare(CaseKind kind, std::string setting, std::string quantity, double value, double reference,
                   double tolerance, const Work& work, double scale) {
    const double size = scale > 0 ? scale : std::abs(reference);
    judge(kind, std::move(setting), std::move(quantity), value, reference, std::abs(value - reference) / size,
          tolerance, work);
}

void Book::converge(std::string setting, std::string quantity, const std::vector<double>& h,
                    const std::vector<double>& values, double reference, double least_order, const Work& work,
                    bool may_lock) {
    CaseResult& r = add(CaseKind::continuum, std::move(setting), std::move(quantity), work);
    r.value = values.back(), r.reference = reference, r.tolerance = least_order;
    r.error = std::abs(r.value - reference) / std::abs(reference);
    bool falls = values.size() >= 2;
    for (std::size_t i = 0; i + 1 < values.size(); ++i)
        falls = falls && std::abs(r.value - reference) < std::abs(values[i] - reference);
    if (values.size() >= 2) {
        const std::size_t n = values.size();
        r.order =
            observed_order(h[n - 2], std::abs(values[n - 2] - reference), h[n - 1], std::abs(r.value - reference));
    }
    const bool nearer = falls && work.unconverged == 0;
    r.status = nearer && r.order >= least_order ? CaseStatus::pass
               : nearer && may_lock             ? CaseStatus::locks
                                                : CaseStatus::fail;
    if (work.unconverged)
        r.note = std::to_string(work.unconverged) + " steps did not converge";
    else if (!falls)
        r.note = "a coarser mesh is nearer";
    else if (r.status != CaseStatus::pass)
        r.note = "the order is below " + number(least_order, 2) + ": the element locks";
}

void Book::slope(std::string setting, std::string quantity, double error, double order, double least_order,
                 const Work& work) {
    judge(CaseKind::same_mesh, std::move(setting), std::move(quantity), error, 0, error, least_order, work);
    CaseResult& r = results.back();
    r.order = order;
    if (r.note.empty()) r.status = order >= least_order ? CaseStatus::pass : CaseStatus::fail;
}

void Book::not_modelled(std::string section, std::string name, std::string needs) {
    CaseResult r;
    r.section = std::move(section), r.name = std::move(name), r.status = CaseStatus::not_modelled;
    r.note = "needs " + std::move(needs);
    results.push_back(std::move(r));
}

void Book::failed(std::string setting, std::string why) {
    CaseResult& r = add(CaseKind::exact, std::move(setting), "", {});
    r.error = std::numeric_limits<double>::quiet_NaN();
    r.note = std::move(why);
}

std::vector<CaseResult> run_accuracy(const RunOptions& options) {
    Book book;
    for (const auto& cases : {material_cases(), static_cases(), surface_cases(), rest_cases(), dynamic_cases(),
                              contact_cases(), cloth_cases()})
        for (const AccuracyCase& c : cases) {
            if (!options.wants(c.name)) continue;
            options.tell(c.name);
            book.open("", c.name);
            try {
                c.run(book, options);
            } catch (const solver::Error& e) {
                book.failed("", e.code + ": " + e.what());
            }
        }
    for (const auto& [section, name, needs] : missing)
        if (options.wants(name)) book.not_modelled(section, name, needs);
    std::stable_sort(book.results.begin(), book.results.end(), [](const CaseResult& a, const CaseResult& b) {
        return std::atof(a.section.c_str()) < std::atof(b.section.c_str());
    });
    return std::move(book.results);
}

Table accuracy_table(const std::vector<CaseResult>& results) {
    Table t;
    t.columns = {"verdict", "section",   "case",  "setting", "quantity", "kind",
                 "value",   "reference", "error", "allowed", "order",    "note"};
    for (const CaseResult& r : results) {
        std::vector<std::string> row{std::string(name_of(r.status)), r.section, r.name, r.setting, r.quantity};
        if (r.status == CaseStatus::not_modelled) {
            row.resize(11, "");
        } else {
            const bool by_order = std::isfinite(r.order);
            row.insert(row.end(),
                       {std::string(name_of(r.kind)), number(r.value, 8), number(r.reference, 8), number(r.error, 2),
                        by_order ? "order " + number(r.tolerance, 2) : number(r.tolerance, 2),
                        by_order ? number(r.order, 3) : ""});
        }
        row.push_back(r.note);
        t.rows.push_back(std::move(row));
    }
    return t;
}

nlohmann::ordered_json accuracy_json(const std::vector<CaseResult>& results) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const CaseResult& r : results) {
        nlohmann::ordered_json row{{"section", r.section}, {"case", r.name}, {"verdict", name_of(r.status)}};
        if (r.status != CaseStatus::not_modelled) {
            row.update({{"setting", r.setting},
                        {"quantity", r.quantity},
                        {"kind", name_of(r.kind)},
                        {"value", r.value},
                        {"reference", r.reference},
                        {"error", r.error},
                        {"allowed", r.tolerance},
                        {"order", r.order},
                        {"seconds", r.work.seconds},
                        {"steps", r.work.steps},
                        {"newton", r.work.newton},
                        {"linear_iterations", r.work.linear_iterations}});
        }
        if (!r.note.empty()) row["note"] = r.note;
        rows.push_back(std::move(row));
    }
    return rows;
}

std::string accuracy_summary(const std::vector<CaseResult>& results) {
    const auto count = [&](CaseStatus status) {
        return std::to_string(
            std::count_if(results.begin(), results.end(), [&](const CaseResult& r) { return r.status == status; }));
    };
    return count(CaseStatus::pass) + " passed, " + count(CaseStatus::fail) + " failed, " + count(CaseStatus::locks) +
           " lock, " + count(CaseStatus::not_modelled) + " not yet modelled";
}

std::string_view name_of(CaseKind kind) {
    constexpr std::string_view names[] = {"exact", "same mesh", "continuum"};
    return names[static_cast<int>(kind)];
}

std::string_view name_of(CaseStatus status) {
    constexpr std::string_view names[] = {"pass", "FAIL", "locks", "not yet modelled"};
    return names[static_cast<int>(status)];
}

double observed_order(double h1, double error1, double h2, double error2) {
    return std::log(error1 / error2) / std::log(h1 / h2);
}

} // namespace sinew::bench
