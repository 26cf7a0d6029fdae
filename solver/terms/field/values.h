// The fields: which there are, their switches, and the numbers that may be keyed. SI units.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fields.h"
#include "solver/term/part.h"

namespace sinew::solver {

enum class FieldKind { air, drag, gravity, newton, radial, turbulence, uniform, vortex, volume_axis };
enum class FieldVolume { sphere, cylinder };

/// What is not keyable.
struct FieldRest final : PartRest {
    FieldKind kind = FieldKind::uniform;
    bool use_max_distance = false;
    bool component_only = false;     ///< air: pushes along its direction alone, and never back
    bool use_direction = false;      ///< drag: brakes along its direction alone
    bool invert_attenuation = false; ///< volume axis: strongest at the edge
    FieldVolume volume = FieldVolume::sphere;
    int noise_level = 0; ///< turbulence: octaves beyond the first
};

/// All numbers of all fields; each kind reads its own. Directions need not be unit vectors.
struct FieldValues {
    /// Air, uniform, radial, turbulence, vortex, volume axis: force per volume [N/m^3]; gravity, newton: force per mass
    /// [m/s^2]; drag: force per volume and speed [N*s/m^4].
    double magnitude = 0;
    double attenuation = 0;
    double reference_distance = 1; ///< [m]; the magnitude holds up to there
    double max_distance = 1;       ///< [m]
    double x = 0, y = 0, z = 0;    ///< place [m]
    double direction_x = 0, direction_y = 1, direction_z = 0;
    double axis_x = 0, axis_y = 1, axis_z = 0;
    double air_speed = 1;         ///< [m/s]
    double speed_attenuation = 0; ///< [m/s]
    double wavelength = 1;        ///< [m]
    double phase_x = 0, phase_y = 0, phase_z = 0;
    double evolution = 0; ///< fourth coordinate of the noise
    double noise_ratio = 0.5;
    double radius = 1, height = 1; ///< [m]
    double away_from_center = 0, away_from_axis = 0, along_axis = 0, around_axis = 0, directional_speed = 0;

    static constexpr auto fields() {
        using T = FieldValues;
        return std::to_array<Field<T>>({{"magnitude", "SI", &T::magnitude},
                                        {"attenuation", "1", &T::attenuation},
                                        {"referenceDistance", "m", &T::reference_distance},
                                        {"maxDistance", "m", &T::max_distance},
                                        {"translate x", "m", &T::x},
                                        {"translate y", "m", &T::y},
                                        {"translate z", "m", &T::z},
                                        {"direction x", "1", &T::direction_x},
                                        {"direction y", "1", &T::direction_y},
                                        {"direction z", "1", &T::direction_z},
                                        {"axis x", "1", &T::axis_x},
                                        {"axis y", "1", &T::axis_y},
                                        {"axis z", "1", &T::axis_z},
                                        {"airSpeed", "m/s", &T::air_speed},
                                        {"speedAttenuation", "m/s", &T::speed_attenuation},
                                        {"wavelength", "m", &T::wavelength},
                                        {"phase x", "1", &T::phase_x},
                                        {"phase y", "1", &T::phase_y},
                                        {"phase z", "1", &T::phase_z},
                                        {"evolution", "1", &T::evolution},
                                        {"noiseRatio", "1", &T::noise_ratio},
                                        {"radius", "m", &T::radius},
                                        {"height", "m", &T::height},
                                        {"awayFromCenter", "1", &T::away_from_center},
                                        {"awayFromAxis", "1", &T::away_from_axis},
                                        {"alongAxis", "1", &T::along_axis},
                                        {"aroundAxis", "1", &T::around_axis},
                                        {"directionalSpeed", "1", &T::directional_speed}});
    }
};

} // namespace sinew::solver
