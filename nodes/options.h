// What the words of an attribute stand for, each said once: the attribute's options, its default and what the solver is
// told come from the same table.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fiber/curve.h"
#include "solver/material/law.h"
#include "solver/meshing/shells.h"
#include "solver/scene.h"
#include "solver/step_inputs.h"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::nodes {

template <class T>
struct Option {
    std::string_view word;
    T meaning;
};

/// The words of a table of Options, for Input::options.
template <class Table>
std::vector<std::string_view> words(const Table& table) {
    std::vector<std::string_view> out;
    for (const auto& option : table) out.push_back(option.word);
    return out;
}

/// What a word stands for. The engine lets no word through that is not an option: another one is a mistake of the
/// program, std::logic_error.
template <class Table>
const auto& meaning(const Table& table, std::string_view word) {
    for (const auto& option : table)
        if (option.word == word) return option.meaning;
    throw std::logic_error("'" + std::string(word) + "' is not an option");
}

// ---- the solver's choices; a value without a word does not compile ----
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"

constexpr std::string_view word_of(solver::ElasticLaw law) {
    return static_cast<std::size_t>(law) < std::size(solver::elastic_laws) ? solver::law_facts(law).name : "";
}

constexpr std::string_view word_of(solver::ElementKind kind) {
    switch (kind) {
    case solver::ElementKind::linear:
        return "linear";
    case solver::ElementKind::quadratic:
        return "quadratic";
    }
    return "";
}

constexpr std::string_view word_of(solver::Fill fill) {
    switch (fill) {
    case solver::Fill::surface_only:
        return "SurfaceOnly";
    case solver::Fill::filled_cavities:
        return "FilledCavities";
    case solver::Fill::empty_cavities:
        return "EmptyCavities";
    }
    return "";
}

constexpr std::string_view word_of(solver::BendRestAngle angle) {
    switch (angle) {
    case solver::BendRestAngle::mesh:
        return "mesh";
    case solver::BendRestAngle::flat:
        return "flat";
    }
    return "";
}

constexpr std::string_view word_of(solver::AttachmentMode mode) {
    switch (mode) {
    case solver::AttachmentMode::none:
        return "none";
    case solver::AttachmentMode::fixed:
        return "fixed";
    case solver::AttachmentMode::sliding:
        return "sliding";
    }
    return "";
}

constexpr std::string_view word_of(solver::Correspondence correspondence) {
    switch (correspondence) {
    case solver::Correspondence::closest_point:
        return "worldSpace";
    case solver::Correspondence::vertex_id:
        return "vertexID";
    }
    return "";
}

constexpr std::string_view word_of(solver::PaintedOn on) {
    switch (on) {
    case solver::PaintedOn::vertices:
        return "vertices";
    case solver::PaintedOn::faces:
        return "faces";
    }
    return "";
}

constexpr std::string_view word_of(solver::Integrator integrator) {
    switch (integrator) {
    case solver::Integrator::backward_euler:
        return "BackwardEuler";
    case solver::Integrator::bdf2:
        return "BDF2";
    case solver::Integrator::tr_bdf2:
        return "TR-BDF2";
    case solver::Integrator::quasi_static:
        return "QuasiStatic";
    }
    return "";
}

constexpr std::string_view word_of(solver::CurveForm form) {
    switch (form) {
    case solver::CurveForm::polyline:
        return "polyline";
    case solver::CurveForm::cubic:
        return "cubic";
    }
    return "";
}

constexpr std::string_view word_of(solver::LinearMethod method) {
    switch (method) {
    case solver::LinearMethod::automatic:
        return "Auto";
    case solver::LinearMethod::direct:
        return "Direct";
    case solver::LinearMethod::iterative:
        return "Iterative";
    case solver::LinearMethod::plain:
        return "Plain";
    }
    return "";
}

#pragma GCC diagnostic pop

/// The options of an enum, in its order: its values count from 0, and the first without a word is past the last.
template <class E>
inline constexpr auto options_of = [] {
    constexpr std::size_t count = [] {
        std::size_t n = 0;
        while (!word_of(static_cast<E>(n)).empty()) ++n;
        return n;
    }();
    std::array<Option<E>, count> out{};
    for (std::size_t i = 0; i < count; ++i) out[i] = {word_of(static_cast<E>(i)), static_cast<E>(i)};
    return out;
}();

} // namespace sinew::nodes
