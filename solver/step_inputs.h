// What may change from step to step: bone positions, material values, excitation, solver settings.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fields.h"
#include "solver/linear/linear_method.h"
#include "solver/term/part.h"
#include "solver/types.h"

#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

namespace sinew::solver {

enum class Integrator { backward_euler, bdf2, tr_bdf2, quasi_static };

/// Values of one material layer of a tissue; composited bottom to top with envelope x painted weight.
struct MaterialValues {
    double youngs_modulus = 12e3; ///< [Pa]
    double poissons_ratio = 0.4;
    double mass_density = 1060; ///< [kg/m^3]
    double envelope = 1;
    double volume_conservation = 0; ///< [Pa], independent of Young's modulus
    double rest_scale = 1;          ///< of lengths at rest, > 0; to the power of TissueInputs::rest_scale_envelope
    static constexpr auto fields() {
        using T = MaterialValues;
        return std::to_array<Field<T>>({{"youngsModulus", "Pa", &T::youngs_modulus},
                                        {"poissonsRatio", "1", &T::poissons_ratio},
                                        {"massDensity", "kg/m^3", &T::mass_density},
                                        {"envelope", "1", &T::envelope},
                                        {"volumeConservation", "Pa", &T::volume_conservation},
                                        {"restScale", "1", &T::rest_scale}});
    }
};

struct FiberValues {
    double strength = 12e3;       ///< [Pa]
    double contraction_limit = 0; ///< fibre stretch at which the pull ends
    double excitation = 0, envelope = 1;
    double growth = 1; ///< of lengths at rest across the fibre, > 0; to the power of envelope x weight
    static constexpr auto fields() {
        using T = FiberValues;
        return std::to_array<Field<T>>({{"strength", "Pa", &T::strength},
                                        {"contractionLimit", "1", &T::contraction_limit},
                                        {"excitation", "1", &T::excitation},
                                        {"envelope", "1", &T::envelope},
                                        {"muscleGrowthScale", "1", &T::growth}});
    }
};

/// Of a part of a tissue with materials of its own.
struct SubtissueInputs {
    double rest_scale_envelope = 1; ///< as the tissue's
    std::vector<MaterialValues> layers;
    static constexpr auto fields() {
        using T = SubtissueInputs;
        return std::to_array<Field<T>>({{"restScaleEnvelope", "1", &T::rest_scale_envelope}});
    }
};

struct TissueInputs {
    double compression_resistance = 20000; ///< relative to Young's modulus
    double transverse_anisotropy = 1;      ///< law anisotropic: stiffness across the fibre / along it
    double rest_scale_envelope = 1;        ///< exponent of the layers' rest_scale; 0 = off
    /// Share of the momentum of translation, rotation, shear and scaling that is gone after affine_damping_time, 0…1.
    double inertial_damping = 0;
    double enable = 1; ///< switch, read once a step: 0 = nothing moves the body, and no force of its own counts
    std::vector<MaterialValues> layers;
    std::vector<FiberValues> fibers;
    std::vector<SubtissueInputs> subtissues = {};
    Points forces; ///< dead loads, one per vertex of the tissue in the state [N]; empty = none
    static constexpr auto fields() {
        using T = TissueInputs;
        return std::to_array<Field<T>>({{"compressionResistance", "1", &T::compression_resistance},
                                        {"transverseAnisotropy", "1", &T::transverse_anisotropy},
                                        {"restScaleEnvelope", "1", &T::rest_scale_envelope},
                                        {"inertialDamping", "1", &T::inertial_damping},
                                        {"enable", "1", &T::enable}});
    }
};

/// The time that inertial_damping is meant for [s]: a frame of film.
inline constexpr double affine_damping_time = 1.0 / 24;

/// Whether some layer does; on linear tets it couples more vertices.
inline bool conserves_volume(const TissueInputs& in) {
    const auto some = [](const std::vector<MaterialValues>& layers) {
        return std::any_of(layers.begin(), layers.end(),
                           [](const MaterialValues& m) { return m.volume_conservation > 0; });
    };
    return some(in.layers) || std::any_of(in.subtissues.begin(), in.subtissues.end(),
                                          [&](const SubtissueInputs& part) { return some(part.layers); });
}

/// Values of one material layer of a cloth; composited like a tissue's.
struct ClothMaterial {
    double tensile_stiffness = 5e3; ///< along warp and weft: force per width and stretch [N/m]
    double shear_stiffness = 5e2;   ///< [N/m]
    double bend_stiffness = 1e-5;   ///< moment per width and curvature [N m]
    double mass_density = 0.1;      ///< [kg/m^2]
    double envelope = 1;
    double rest_scale = 1; ///< of lengths at rest, > 0; to the power of ClothInputs::rest_scale_envelope
    static constexpr auto fields() {
        using T = ClothMaterial;
        return std::to_array<Field<T>>({{"tensileStiffness", "N/m", &T::tensile_stiffness},
                                        {"shearStiffness", "N/m", &T::shear_stiffness},
                                        {"bendStiffness", "N*m", &T::bend_stiffness},
                                        {"clothMassDensity", "kg/m^2", &T::mass_density},
                                        {"envelope", "1", &T::envelope},
                                        {"restScale", "1", &T::rest_scale}});
    }
};

struct ClothInputs {
    double rest_scale_envelope = 1; ///< exponent of the layers' rest_scale; 0 = off
    double inertial_damping = 0;    ///< as of tissues
    double enable = 1;              ///< as of tissues
    std::vector<ClothMaterial> layers;
    Points forces; ///< dead loads, one per vertex [N]; empty = none
    static constexpr auto fields() {
        using T = ClothInputs;
        return std::to_array<Field<T>>({{"restScaleEnvelope", "1", &T::rest_scale_envelope},
                                        {"inertialDamping", "1", &T::inertial_damping},
                                        {"enable", "1", &T::enable}});
    }
};

struct BoneInputs {
    Points positions; ///< of every surface vertex at the end of the step [m]
};

using BodyInputs = std::variant<TissueInputs, BoneInputs, ClothInputs>;

/// Whether it is switched off, so that it stands where it is; bones move as they are told.
inline bool is_frozen(const BodyInputs& body) {
    return std::visit(
        [](const auto& b) {
            if constexpr (requires { b.enable; }) return b.enable < 0.5;
            return false;
        },
        body);
}

/// What damps its motion as a whole: 0 of bones and of what is switched off.
inline double inertial_damping(const BodyInputs& body) {
    if (is_frozen(body)) return 0;
    return std::visit(
        [](const auto& b) {
            if constexpr (requires { b.inertial_damping; }) return b.inertial_damping;
            return 0.0;
        },
        body);
}

enum class AttachmentMode { none, fixed, sliding };

struct AttachmentInputs {
    double stiffness = 1e8; ///< [N/m^3]
    double envelope = 1;
    double damping = 0; ///< [N s/m^3]
    double holds = 1;   ///< switch: 1 = at the places found at the start frame
    double slides = 0;  ///< switch: 1 = along the target's surface
    void set_mode(AttachmentMode mode) {
        holds = mode == AttachmentMode::fixed ? 1 : 0, slides = mode == AttachmentMode::sliding ? 1 : 0;
    }
    AttachmentMode mode() const {
        return holds > 0 ? AttachmentMode::fixed : slides > 0 ? AttachmentMode::sliding : AttachmentMode::none;
    }
    static constexpr auto fields() {
        using T = AttachmentInputs;
        return std::to_array<Field<T>>({{"stiffness", "N/m^3", &T::stiffness},
                                        {"envelope", "1", &T::envelope},
                                        {"damping", "N*s/m^3", &T::damping},
                                        {"holds", "1", &T::holds},
                                        {"slides", "1", &T::slides}});
    }
};

struct StepInputs {
    double step_size = 1.0 / 24; ///< [s]
    Integrator integrator = Integrator::backward_euler;
    Vec3 gravity{0, -9.8, 0};     ///< [m/s^2]
    double mass_damping = 0;      ///< Rayleigh [1/s]
    double stiffness_damping = 0; ///< Rayleigh [s]
    LinearMethod linear_method = LinearMethod::automatic;
    int max_newton_iterations = 10;
    double tolerance_factor = 1;
    int max_halvings = 0;           ///< how often a step that fails is taken again in two halves, and those again
    std::vector<BodyInputs> bodies; ///< one per body, same order as the scene's
    std::vector<AttachmentInputs> attachments; ///< one per attachment
    std::vector<PartValues> parts;             ///< one per part, in the order of the scene's
    /// The same at tr_bdf2_gamma of this step, for TR-BDF2: of it are read bones and whatever may be keyed, no settings
    /// of the solver. Where it is missing, values are taken on a line and bones on a parabola through those that are
    /// known.
    std::shared_ptr<const StepInputs> at_gamma = {};
};

} // namespace sinew::solver
