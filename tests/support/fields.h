// Fields in solver tests.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/field/field.h"
#include "tests/support/solver_scenes.h"

namespace sinew::test {

/// A field's switches and numbers.
struct TestField {
    solver::FieldRest rest;
    solver::FieldValues values;
    explicit TestField(solver::FieldKind kind, double magnitude = 0) {
        rest.kind = kind;
        values.magnitude = magnitude;
    }
    TestField& at(const solver::Vec3& p) {
        values.x = p.x(), values.y = p.y(), values.z = p.z();
        return *this;
    }
    TestField& towards(const solver::Vec3& d) {
        values.direction_x = d.x(), values.direction_y = d.y(), values.direction_z = d.z();
        return *this;
    }
    TestField& around(const solver::Vec3& d) {
        values.axis_x = d.x(), values.axis_y = d.y(), values.axis_z = d.z();
        return *this;
    }
    TestField& falling(double attenuation, double reference_distance) {
        values.attenuation = attenuation, values.reference_distance = reference_distance;
        return *this;
    }
    TestField& ending(double max_distance) {
        values.max_distance = max_distance;
        rest.use_max_distance = true;
        return *this;
    }
    solver::PartValues numbers() const {
        solver::PartValues out(solver::FieldValues::fields().size());
        solver::put_fields(values, out);
        return out;
    }
    solver::Part part(std::vector<int> bodies = {0}) const {
        return {&solver::field_type, std::move(bodies), std::make_shared<const solver::FieldRest>(rest)};
    }
    solver::FieldAt now() const { return solver::field_at(rest, numbers()); }
};

} // namespace sinew::test
