// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/all_terms.h"

#include "solver/terms/attachment/attachment.h"
#include "solver/terms/cloth/cloth.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/elastic/elastic.h"
#include "solver/terms/field/field.h"
#include "solver/terms/hold/hold.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/sliding/sliding.h"
#include "solver/terms/surface_tension/surface_tension.h"

namespace sinew::solver {

std::span<const TermType* const> all_terms() {
    static constexpr const TermType* terms[] = {
        &elastic_type,         &attachment_type, &sliding_type, &field_type, &pressure_type,
        &surface_tension_type, &hold_type,       &contact_type, &cloth_type,
    };
    return terms;
}

const TermMemory* find_memory(const std::vector<TermMemory>& memories, std::string_view term) {
    for (const TermMemory& m : memories)
        if (m.term == term) return &m;
    return nullptr;
}

const Measure* find_measure(std::string_view term, std::string_view name) {
    for (const TermType* type : all_terms())
        for (const Measure& m : type->measures)
            if (m.term == term && m.name == name) return &m;
    return nullptr;
}

double value_of(const std::vector<Measured>& measured, std::string_view term, std::string_view name, int part) {
    for (const Measured& m : measured)
        if (m.what->term == term && m.what->name == name && m.part == part) return m.value;
    return 0;
}

} // namespace sinew::solver
