// One instance of a force: an attachment, a field, a hold. What does not change over time stands in its PartRest, what
// may in numbers that the term's type names (fields.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

namespace sinew::solver {

struct TermType;

/// Base of what a kind of force keeps of one part: painted samples, shapes, switches that are not keyable.
struct PartRest {
    virtual ~PartRest() = default;
};

struct Part {
    const TermType* type = nullptr;
    std::vector<int> bodies; ///< that it acts on, positions in the scene; what each means is the type's
    std::shared_ptr<const PartRest> rest;
};

/// A part's numbers at one time, in the order of TermType::values.
using PartValues = std::vector<double>;

} // namespace sinew::solver
