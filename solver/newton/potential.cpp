// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/potential.h"

#include "solver/integrate/standing_form.h"
#include "solver/parallel.h"
#include "solver/terms/all_terms.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::solver {

namespace {

/// Of the energy of springs, what contacts may have where bones have just moved away from flesh.
constexpr double early_share = 2e-2;

/// Zero for the unknowns, 3 numbers each, of deformables with a flag; without flags none has one.
void clear(const Numbering& numbering, const std::vector<char>& flags, std::vector<double>& of_unknowns) {
    for (std::size_t d = 0; d < flags.size(); ++d) {
        const Deformable& body = numbering.deformables[d];
        const auto first = of_unknowns.begin() + static_cast<std::ptrdiff_t>(3 * body.first_unknown);
        if (flags[d]) std::fill_n(first, 3 * body.unknown_count, 0.0);
    }
}

} // namespace

Potential::Potential(const Scene& scene)
    : scene_(scene)
    , numbering_(scene.numbering())
    , dynamics_(numbering_) {
    for (const TermType* type : all_terms())
        if (auto term = type->make(scene)) {
            terms_.push_back(std::move(term));
            types_.push_back(type);
        }
}

Potential::~Potential() = default;

bool Potential::take(const State& before, const StepInputs& inputs, bool within_step) {
    coupled_.resize(terms_.size());
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        Term& term = *changing_terms()[t];
        term.keep_couplings(within_step);
        const Changes changes = term.take(inputs, before);
        if (changes.couplings) coupled_[t] = {};
        masses_due_ = masses_due_ || changes.masses;
    }
    const auto is_known = [](const CoupledRows& rows) { return !rows.start.empty(); };
    const bool is_new = !pattern_ || !std::all_of(coupled_.begin(), coupled_.end(), is_known);
    if (is_new) {
        for (std::size_t t = 0; t < terms_.size(); ++t)
            if (!is_known(coupled_[t])) coupled_[t] = coupled_by(*terms_[t]);
        pattern_ = std::make_unique<BlockPattern>(make_pattern(static_cast<int>(unknown_count()), coupled_));
        for (const auto& term : terms_) term->bind(*pattern_);
    }
    if (is_new || masses_due_) {
        dynamics_.set_masses(*pattern_, terms_);
        vertex_stiffness_.assign(numbering_.vertex_count(), 0.0);
        for (const auto& term : terms_) term->add_vertex_stiffness(vertex_stiffness_);
        masses_due_ = false;
    }
    return is_new;
}

CoupledRows Potential::coupled_by(const Term& term) const {
    Couplings couplings; // of vertices, then of unknowns
    term.add_couplings(couplings);
    for (auto& [v, w] : couplings)
        v = numbering_.unknown[static_cast<std::size_t>(v)], w = numbering_.unknown[static_cast<std::size_t>(w)];
    std::erase_if(couplings, [](const auto& c) { return c.first < 0 || c.second < 0; });
    return coupled_rows(static_cast<int>(unknown_count()), couplings);
}

UnknownPlaces Potential::places() const {
    UnknownPlaces out;
    for (std::size_t d = 0; d < numbering_.deformables.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        out.spacing.push_back(body.spacing);
        out.any_sheet = out.any_sheet || body.is_sheet;
        for (std::size_t u = body.first_unknown; u < body.first_unknown + body.unknown_count; ++u) {
            const double* x = numbering_.rest.data() + 3 * static_cast<std::size_t>(numbering_.vertex_of_unknown[u]);
            out.points.emplace_back(x[0], x[1], x[2]);
            out.body.push_back(static_cast<int>(d));
        }
    }
    return out;
}

void Potential::add_up_springs(std::vector<double>& springs, std::vector<double>& elastic) const {
    springs.assign(pattern_->block_count(), 0.0);
    for (const auto& term : terms_) term->add_springs(springs);
    elastic.resize(unknown_count());
    for (const Deformable& body : numbering_.deformables)
        for (std::size_t u = body.first_unknown; u < body.first_unknown + body.unknown_count; ++u)
            elastic[u] = vertex_stiffness_[static_cast<std::size_t>(numbering_.vertex_of_unknown[u])] /
                         (body.spacing * body.spacing);
}

void Potential::begin_step(const State& before, const StepInputs& inputs) {
    dynamics_.begin_step(before.x, inputs);
    frozen_.clear();
    for (std::size_t d = 0; d < numbering_.deformables.size(); ++d) {
        const auto body = static_cast<std::size_t>(numbering_.deformables[d].body);
        if (!is_frozen(inputs.bodies[body])) continue;
        frozen_.resize(numbering_.deformables.size(), 0);
        frozen_[d] = 1;
    }
    frozen_unknowns_.assign(frozen_.empty() ? 0 : unknown_count(), 0);
    for (std::size_t d = 0; d < frozen_.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const auto first = frozen_unknowns_.begin() + static_cast<std::ptrdiff_t>(body.first_unknown);
        if (frozen_[d]) std::fill_n(first, body.unknown_count, char{1});
    }
}

bool Potential::lets_go(const std::vector<char>& frozen_before) const {
    for (std::size_t d = 0; d < frozen_before.size(); ++d)
        if (frozen_before[d] && (frozen_.empty() || !frozen_[d])) return true;
    return false;
}

void Potential::stop_frozen(Positions& v) const {
    if (v.size() != 3 * numbering_.vertex_count()) return; // there is none
    for (std::size_t d = 0; d < frozen_.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const auto first = v.begin() + static_cast<std::ptrdiff_t>(3 * body.first_vertex);
        if (frozen_[d]) std::fill_n(first, 3 * body.vertex_count, 0.0);
    }
}

void Potential::stop_frozen_unknowns(std::vector<double>& direction) const { clear(numbering_, frozen_, direction); }

void Potential::put_frozen_back(const Positions& from, Positions& x) const {
    for (std::size_t d = 0; d < frozen_.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const auto first = static_cast<std::ptrdiff_t>(3 * body.first_vertex);
        if (frozen_[d]) std::copy_n(from.begin() + first, 3 * body.vertex_count, x.begin() + first);
    }
}

/// Their rows become those of the identity: no force moves them, and nothing of theirs can make the matrix indefinite.
void Potential::freeze_rows(BlockMatrix& a) const {
    for (std::size_t i = 0; i < frozen_unknowns_.size(); ++i)
        for (auto k = static_cast<std::size_t>(a.pattern->row_start[i]);
             k < static_cast<std::size_t>(a.pattern->row_start[i + 1]); ++k) {
            const auto j = static_cast<std::size_t>(a.pattern->column[k]);
            if (!frozen_unknowns_[i] && !frozen_unknowns_[j]) continue;
            double* block = a.block(k);
            std::fill_n(block, 9, 0.0);
            if (i == j) block[0] = block[4] = block[8] = 1;
        }
}

bool Potential::free_flight(const Positions& x, std::vector<double>& direction, std::vector<double>& gain) const {
    if (!dynamics_.free_flight(x, direction, gain)) return false;
    for (std::size_t d = 0; d < frozen_.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const auto first = direction.begin() + static_cast<std::ptrdiff_t>(3 * body.first_unknown);
        if (frozen_[d]) std::fill_n(first, 3 * body.unknown_count, 0.0), gain[d] = 0;
    }
    return true;
}

void Potential::set_values(const State& before, const StepInputs& inputs) {
    if (take(before, inputs, true)) throw std::logic_error("values within a step may not change what is coupled");
    dynamics_.take(inputs);
}

void Potential::begin_stage(const State& before, const ImplicitForm& form, const std::vector<Points>& bones_after) {
    dynamics_.begin_stage(form);
    stage_.emplace(Stage{dynamics_.inputs(), before, form, bones_after});
    for (const auto& term : changing_terms()) term->begin_stage(*stage_);
}

void Potential::place_held(Positions& x) {
    const auto holds = [](const TermType* type) { return type->hold != nullptr; };
    if (std::none_of(types_.begin(), types_.end(), holds)) return;
    before_held_ = x;
    for (const auto& term : terms_) term->place_held(*stage_, x);
    put_frozen_back(before_held_, x);
}

bool Potential::carry(const Positions& x, Positions& out, std::vector<char>& bodies) const {
    if (before_held_.empty() || before_held_ == x) return false;
    out = x;
    bodies.assign(numbering_.deformables.size(), 0);
    bool any = false;
    for (const auto& term : terms_) any = term->carry(before_held_, out, bodies) || any;
    put_frozen_back(before_held_, out);
    for (std::size_t d = 0; d < frozen_.size(); ++d)
        if (frozen_[d]) bodies[d] = 0;
    return any;
}

void Potential::accelerations(const State& before, std::vector<double>& out) {
    ImplicitForm now;
    standing_form(before, now);
    now.press = 0;
    begin_stage(before, now, before.bones);
    std::vector<double> gradient, solved;
    begin_iteration(before.x);
    evaluate(before.x, &gradient, nullptr);
    for (double& g : gradient) g = -g;
    dynamics_.masses().solve(gradient, solved);
    out.assign(before.x.size(), 0.0);
    for (std::size_t u = 0; u < unknown_count(); ++u)
        for (std::size_t c = 0; c < 3; ++c)
            out[3 * static_cast<std::size_t>(numbering_.vertex_of_unknown[u]) + c] = solved[3 * u + c];
}

void Potential::leave_out_presses(const Positions& x, std::vector<double>& accelerations) {
    std::vector<double>&gradient = pressing_, &solved = pressed_;
    gradient.assign(3 * unknown_count(), 0.0);
    bool any = false;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (!types_[t]->presses || terms_[t]->energy(x, true) == 0) continue;
        terms_[t]->add_gradient(gradient);
        any = true;
    }
    if (!any) return;
    forces_hold_ = false; // those of other terms may be of another place
    clear(numbering_, frozen_, gradient);
    dynamics_.masses().solve(gradient, solved);
    for (std::size_t u = 0; u < unknown_count(); ++u)
        for (std::size_t c = 0; c < 3; ++c)
            accelerations[3 * static_cast<std::size_t>(numbering_.vertex_of_unknown[u]) + c] += solved[3 * u + c];
}

double Potential::begin_iteration(const Positions& x) {
    double change = 0;
    for (const auto& term : changing_terms()) change += term->begin_iteration(x);
    return change;
}

bool Potential::settle(const Positions& x, bool stuck) {
    return take_anew([&](Term& term) { return term.settle(x, stuck); });
}

bool Potential::renew(const Positions& x) {
    return take_anew([&](Term& term) { return term.renew(x); });
}

template <class Take>
bool Potential::take_anew(const Take& take) {
    bool changed = false;
    taken_anew_.resize(terms_.size(), 0);
    for (std::size_t t = 0; t < terms_.size(); ++t)
        if (take(*terms_[t])) taken_anew_[t] = changed = true;
    return changed;
}

bool Potential::widen(const Positions& x) {
    bool more = false;
    for (const auto& term : changing_terms()) more = term->widen(x) || more;
    return more;
}

double Potential::evaluate(const Positions& x, std::vector<double>* gradient, std::vector<BodyForces>* forces) {
    double total = 0;
    energy_scale_ = 0;
    const bool again = forces_hold_ && gradient && x == evaluated_at_;
    forces_hold_ = false; // until all of them are found
    energies_.resize(terms_.size(), 0.0);
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (!again || taken_anew_[t]) energies_[t] = terms_[t]->energy(x, gradient != nullptr);
        total += energies_[t];
        energy_scale_ += std::abs(energies_[t]);
    }
    total += dynamics_.energy(x, energy_scale_);
    forces_hold_ = gradient != nullptr;
    if (!gradient) return total;
    if (!again) evaluated_at_ = x;
    taken_anew_.assign(terms_.size(), 0);
    gradient->assign(3 * unknown_count(), 0.0);
    for (const auto& term : terms_) term->add_gradient(*gradient);
    dynamics_.add_gradient(*gradient);
    clear(numbering_, frozen_, *gradient);
    if (forces) set_forces(x, *gradient, *forces);
    clear(numbering_, resting_, *gradient); // they are judged by the forces all the same
    return total;
}

void Potential::rest(const std::vector<char>& deformables) {
    resting_ = deformables;
    for (const auto& term : changing_terms()) term->rest(resting_);
}

/// An island's rows have no columns of others.
void Potential::rest_rows(BlockMatrix& a) const {
    for (std::size_t d = 0; d < resting_.size(); ++d) {
        if (!resting_[d]) continue;
        const Deformable& body = numbering_.deformables[d];
        parallel_for(body.unknown_count, 512, [&](std::size_t k) {
            const std::size_t i = body.first_unknown + k;
            const auto first = static_cast<std::size_t>(a.pattern->row_start[i]),
                       end = static_cast<std::size_t>(a.pattern->row_start[i + 1]);
            std::fill_n(a.block(first), 9 * (end - first), 0.0);
            double* diagonal = a.block(first);
            diagonal[0] = diagonal[4] = diagonal[8] = 1;
        });
    }
}

void Potential::set_forces(const Positions& x, const std::vector<double>& gradient, std::vector<BodyForces>& forces) {
    of_body_.assign(numbering_.deformables.size(), 0.0);
    for (const auto& term : terms_) term->raise_forces_at_work(x, of_body_);
    dynamics_.raise_forces_at_work(of_body_);
    forces.resize(of_body_.size());
    for (std::size_t d = 0; d < forces.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const double* g = gradient.data() + 3 * body.first_unknown;
        forces[d] = {std::sqrt(ordered_sum(3 * body.unknown_count, [&](std::size_t i) { return g[i] * g[i]; })),
                     of_body_[d]};
    }
    for (std::size_t d = 0; d < frozen_.size(); ++d)
        if (frozen_[d]) forces[d] = {0, 1};
}

Balance Potential::balance(const Positions& x, const std::vector<BodyForces>& forces, double tolerance) {
    double largest = 0;
    for (const double c : x) largest = std::max(largest, std::abs(c));
    of_body_.assign(forces.size(), 0.0);
    for (const auto& term : terms_) term->add_squared_stiffnesses(of_body_);
    in_balance_.resize(forces.size());
    Balance out{0, true};
    for (std::size_t d = 0; d < forces.size(); ++d) {
        const double residual = forces[d].sum / forces[d].at_work;
        // What rounding of positions does to the forces [N]: no gradient can be made smaller. It excuses a small
        // residual, never one of the size of the forces themselves.
        const double rounding = 2.3e-16 * largest * std::sqrt(of_body_[d]);
        const bool reached = residual <= tolerance || (residual <= 1e-3 && forces[d].sum <= rounding);
        in_balance_[d] = reached;
        out.reached = out.reached && reached;
        // Written so that a residual that is no number is kept.
        if (!(residual <= out.residual)) out.residual = residual;
    }
    return out;
}

void Potential::work(const std::vector<double>& force, const std::vector<double>& direction,
                     std::vector<double>& out) const {
    out.resize(numbering_.deformables.size());
    for (std::size_t d = 0; d < out.size(); ++d) {
        const std::size_t first = 3 * numbering_.deformables[d].first_unknown;
        out[d] = ordered_sum(3 * numbering_.deformables[d].unknown_count,
                             [&](std::size_t i) { return -force[first + i] * direction[first + i]; });
    }
}

void Potential::assemble(const Positions& x, bool project, BlockMatrix& a) {
    if (terms_.empty() || !terms_.front()->writes_all_blocks()) std::fill(a.values.begin(), a.values.end(), 0.0);
    a.overlay.clear();
    for (const auto& term : changing_terms()) term->add_hessian(x, project, a);
    // Nothing moves them here either, see freeze_rows: else others would press on what gives way.
    if (!frozen_.empty()) a.overlay.hold(frozen_unknowns_);
    a.overlay.finish(a.pattern->rows);
    dynamics_.add_hessian(a);
    if (!frozen_.empty()) freeze_rows(a);
    if (!resting_.empty()) rest_rows(a);
}

double Potential::longest_move(const Positions& x, const std::vector<double>& direction) const {
    double longest = 1;
    for (const auto& term : terms_) longest = std::min(longest, term->longest_move(x, direction));
    return longest;
}

bool Potential::contacts_press() const {
    for (std::size_t t = 0; t < terms_.size(); ++t)
        if (types_[t]->presses && energies_[t] > 0) return true;
    return false;
}

bool Potential::contacts_are_early() const {
    double pressing = 0, pulling = 0;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (types_[t]->presses) pressing += energies_[t];
        if (types_[t]->pulls) pulling += energies_[t];
    }
    return pressing > 0 && pressing < early_share * pulling && stage_->bones_after != stage_->before.bones;
}

double Potential::energy_rounding() const {
    double scale = 0;
    for (const auto& term : terms_) scale += term->energy_scale();
    return 1e-14 * energy_scale_ + 4e-16 * scale;
}

int Potential::levels() const {
    int levels = 0;
    for (const auto& term : terms_) levels = std::max(levels, term->levels());
    return levels;
}

void Potential::relax(int level) {
    for (const auto& term : changing_terms()) term->relax(level);
}

void Potential::remember(const Positions& x, bool keeps_history, std::vector<TermMemory>& memories) const {
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (!types_[t]->has_memory) continue;
        auto at = std::find_if(memories.begin(), memories.end(),
                               [&](const TermMemory& m) { return m.term == types_[t]->name; });
        if (at == memories.end())
            at = memories.insert(at, {std::string(types_[t]->name), types_[t]->memory_version, {}});
        terms_[t]->remember(x, keeps_history, *at);
    }
}

void Potential::measure(const Positions& x, std::vector<Measured>& out) {
    out.clear();
    reactions_.clear();
    const auto wants = [](const auto& term) { return term->wants_reactions(); };
    if (std::any_of(terms_.begin(), terms_.end(), wants)) {
        evaluate(x, &reaction_gradient_, nullptr);
        reactions_.assign(x.size(), 0.0);
        for (const auto& term : terms_) term->add_held_gradient(reactions_);
        dynamics_.add_held_gradient(x, reactions_);
        stop_frozen(reactions_);
    }
    for (const auto& term : terms_) term->measure(x, reactions_, out);
}

void Potential::describe(const Positions& x, StepRecord& record) {
    record.energy = 0;
    for (const auto& term : changing_terms()) record.energy += term->stored_energy(x);
    ShapeQuality quality;
    for (const auto& term : terms_) term->add_quality(&x, quality);
    record.min_j = quality.least_j == std::numeric_limits<double>::infinity() ? 1 : quality.least_j;
    record.inverted = quality.inverted;
}

double Potential::least_j(const Positions& x) {
    ShapeQuality quality;
    for (const auto& term : changing_terms()) {
        term->energy(x, true);
        term->add_quality(nullptr, quality);
    }
    return quality.least_j;
}

void Potential::marks(const Positions& x, Marks& out) const {
    for (const auto& term : terms_) term->marks(x, out);
}

const Term* Potential::find(const TermType& type) const {
    const auto at = std::find(types_.begin(), types_.end(), &type);
    return at == types_.end() ? nullptr : terms_[static_cast<std::size_t>(at - types_.begin())].get();
}

} // namespace sinew::solver
