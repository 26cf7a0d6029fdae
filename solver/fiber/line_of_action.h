// Lines of action: how far a muscle's path has shortened says how strongly its fibres are excited. Of a path of the
// length L, which at the start frame was L0, with l = L0 (1 + stretchBias):
//   loaValue = clamp(posSensitivity (1 - L/l) - velSensitivity L'/l - accSensitivity L''/l, 0, maxExcitation)
// and the fibres take clamp(their own excitation + loaValue, 0, 1). L' and L'' are differences over the last steps in
// seconds, so that all is relative: no unit of the scene enters.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fields.h"

#include <algorithm>

namespace sinew::solver {

struct LineOfActionValues {
    double max_excitation = 1;
    double stretch_bias = 0; ///< above -1
    double pos_sensitivity = 1;
    double vel_sensitivity = 0; ///< [s]
    double acc_sensitivity = 0; ///< [s^2]
    static constexpr auto fields() {
        using T = LineOfActionValues;
        return std::to_array<Field<T>>({{"maxExcitation", "1", &T::max_excitation},
                                        {"stretchBias", "1", &T::stretch_bias},
                                        {"posSensitivity", "1", &T::pos_sensitivity},
                                        {"velSensitivity", "s", &T::vel_sensitivity},
                                        {"accSensitivity", "s^2", &T::acc_sensitivity}});
    }
};

/// What a line of action keeps from step to step.
struct LineMemory {
    double rest_length = 0; ///< at the start frame [m]
    double length = 0;      ///< at the end of the last step [m]
    double rate = 0;        ///< of the length, over the last step [m/s]
    double step = 0;        ///< the last step [s]; 0 at the start frame
    double value = 0;       ///< loaValue at the end of the last step
    friend bool operator==(const LineMemory&, const LineMemory&) = default;
};

/// At the start frame, where the line has this length, above 0. Nothing moves there.
LineMemory start_line(const LineOfActionValues& values, double length);
/// After a step [s] that ended at this length. There is no L'' before two steps are known.
LineMemory follow_line(const LineOfActionValues& values, const LineMemory& before, double length, double step);
/// What fibres take.
inline double excitation_with(double own, const LineMemory& line) { return std::clamp(own + line.value, 0.0, 1.0); }

} // namespace sinew::solver
