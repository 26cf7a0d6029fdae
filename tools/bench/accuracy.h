// Accuracy: every case of the catalogue of reference values, with its value, reference, error and verdict.
// Three kinds of reference. exact: the engine's own discretisation has this value, so rounding alone may differ.
// same-mesh: linear tets on a given mesh have one discrete solution, computed by another code. continuum: the value
// that refinement must lead to; judged by the order at which meshes come nearer, or by distance where one mesh is fine
// enough.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/beams.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <limits>
#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

enum class CaseKind { exact, same_mesh, continuum };
/// locks: an element that is known to lock there comes nearer to the limit on every finer mesh, but slowly.
enum class CaseStatus { pass, fail, locks, not_modelled };

/// Whether plain linear tets lock at this Poisson's ratio: what is asked of them there is that errors fall.
bool in_locking_range(solver::ElementKind element, double poissons_ratio);

struct CaseResult {
    std::string section; ///< of the catalogue
    std::string name, setting, quantity;
    CaseKind kind = CaseKind::exact;
    CaseStatus status = CaseStatus::fail;
    double value = 0, reference = 0;
    double error = 0;                                        ///< relative; see `Book`
    double tolerance = 0;                                    ///< on the error; of a case with an order the least order
    double order = std::numeric_limits<double>::quiet_NaN(); ///< observed under refinement of mesh or step; NaN = not
                                                             ///< judged by order
    Work work;
    std::string note; ///< why it failed, what it needs
};

/// Where cases put their results.
class Book {
  public:
    std::vector<CaseResult> results;

    /// Names what the next results belong to.
    void open(std::string section, std::string name) { section_ = std::move(section), name_ = std::move(name); }
    /// |value - reference| / scale against the tolerance; scale 0 takes |reference|.
    void compare(CaseKind kind, std::string setting, std::string quantity, double value, double reference,
                 double tolerance, const Work& work = {}, double scale = 0);
    /// An error that the case has measured itself, already relative.
    void judge(CaseKind kind, std::string setting, std::string quantity, double value, double reference, double error,
               double tolerance, const Work& work = {});
    /// Values on finer and finer meshes of cell size h. Passes if the finest is nearer than every
    /// coarser one (some pass through the reference on their way) and the order between the two finest is at least
    /// `least_order`; one `may_lock` is said to if it is nearer, but at a lower order.
    void converge(std::string setting, std::string quantity, const std::vector<double>& h,
                  const std::vector<double>& values, double reference, double least_order, const Work& work = {},
                  bool may_lock = false);
    /// An error in time that must fall with the step size at `least_order`; `order` is the observed one.
    void slope(std::string setting, std::string quantity, double error, double order, double least_order,
               const Work& work = {});
    /// What the engine cannot do yet; never counted as passed.
    void not_modelled(std::string section, std::string name, std::string needs);
    /// What stopped a case.
    void failed(std::string setting, std::string why);

  private:
    CaseResult& add(CaseKind kind, std::string setting, std::string quantity, const Work& work);
    std::string section_, name_;
};

struct AccuracyCase {
    std::string name;
    std::function<void(Book&, const RunOptions&)> run;
};

/// Laws, muscle and the patch test (catalogue 1, 8).
std::vector<AccuracyCase> material_cases();
/// Beams, panels and attachments (2, 4, 11).
std::vector<AccuracyCase> static_cases();
/// Pressure and surface tension (3, 7).
std::vector<AccuracyCase> surface_cases();
/// Rest shapes that change (9).
std::vector<AccuracyCase> rest_cases();
/// Integrators and moving bodies (5, 6, 13).
std::vector<AccuracyCase> dynamic_cases();
/// Contact, sliding attachments and goals (11, 12).
std::vector<AccuracyCase> contact_cases();
/// Cloth (10).
std::vector<AccuracyCase> cloth_cases();

/// All cases that the options want, then what is not modelled. Throws solver::Stopped.
std::vector<CaseResult> run_accuracy(const RunOptions& options);

Table accuracy_table(const std::vector<CaseResult>& results);
nlohmann::ordered_json accuracy_json(const std::vector<CaseResult>& results);
/// "212 passed, 0 failed, 7 lock, 11 not yet modelled"
std::string accuracy_summary(const std::vector<CaseResult>& results);

std::string_view name_of(CaseKind kind);
std::string_view name_of(CaseStatus status);

/// Order of the error between two resolutions: log(e1/e2) / log(h1/h2).
double observed_order(double h1, double error1, double h2, double error2);

} // namespace sinew::bench
