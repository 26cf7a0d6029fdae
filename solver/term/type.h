// A kind of force, as data: one constant a kind, listed in terms/all_terms.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fields.h"
#include "solver/scene.h"
#include "solver/term/term.h"

#include <memory>
#include <span>
#include <string_view>

namespace sinew::solver {

struct TermType {
    std::string_view name; ///< in the report, in saved states
    int numerics = 1;      ///< raised when its bits change
    std::span<const FieldName> values = {};
    std::span<const Measure> measures = {};
    /// The term of a scene; null: the scene does not use it, and it costs nothing.
    std::unique_ptr<Term> (*make)(const Scene&) = nullptr;
    /// What it keeps at the start frame, from the inputs and the surfaces of all bodies then [m]; null: nothing.
    void (*start)(const Scene&, const StepInputs&, const std::vector<Points>& surfaces, TermMemory&) = nullptr;
    /// The same for types whose parts may come in and go over a run: what it keeps where the first of them comes in, at
    /// a state that does not know of it. Null: they take part from the start frame on, or never.
    void (*begin)(const Scene&, const StepInputs&, const State&, TermMemory&) = nullptr;
    int memory_version = 0;
    bool has_memory = false;
    /// Flags vertices of a deformable body that a part holds (they are no unknowns); null: none. `body`: in
    /// part.bodies.
    void (*hold)(const Part&, const BodyRest& body, std::vector<char>& held) = nullptr;
    /// Of parts whose values follow from where bodies are, puts them in; null: none do. `bones`: at the values' time,
    /// per body [m]. Throws Error (body set).
    void (*follow)(const Scene&, std::size_t part, const TermMemory&, const std::vector<Points>& bones,
                   std::span<double> values) = nullptr;
    /// Turns `to` into a part's values at `share` of the way to it from `from`; null: each number on a line. Types that
    /// have this say where something is: their values are kept in the state, and a step that is taken in parts goes
    /// there in parts.
    void (*mix)(std::span<const double> from, std::span<double> to, double share) = nullptr;
    /// Whether a part's values may be mixed between two times; null: always.
    bool (*may_mix)(std::span<const double> before, std::span<const double> after) = nullptr;
    /// Whether a part with these values pulls a deformable body towards what is prescribed: ties it in QuasiStatic.
    bool ties = false;
    /// Whether its springs take flesh along with bones that move.
    bool pulls = false;
    /// Whether bodies that touch press on each other by it (Term::press_as_before).
    bool presses = false;
};

} // namespace sinew::solver
