// Holds: painted parts of a tissue's surface that stay where they are, or move as a rigid body, exactly. What carries
// them is no unknown; the term has no energy, puts it where it belongs in every stage, and reports what it pulls with.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/rigid_motion.h"
#include "solver/term/type.h"
#include "solver/terms/hold/held_vertices.h"

namespace sinew::solver {

extern const TermType hold_type;

/// A part acts on the tissue that it holds and, with `follows_bone`, on the bone that it moves with; without one of
/// them it holds nothing.
struct HoldRest : PartRest {
    PaintedPart part; ///< of the tissue's surface
    bool follows_bone = false;
};

/// Where what is held is: at start it is where the tissue is modelled, and moves from there as this motion does from
/// its own value at the start frame. With a bone the motion is the bone's.
struct HoldValues {
    double x = 0, y = 0, z = 0;                   ///< translation [m]
    double qx = 0, qy = 0, qz = 0, qw = 1;        ///< rotation, a unit quaternion
    double about_x = 0, about_y = 0, about_z = 0; ///< the point that the reported moment is about [m]
    static constexpr auto fields() {
        using T = HoldValues;
        return std::to_array<Field<T>>({{"x of the matrix", "m", &T::x},
                                        {"y of the matrix", "m", &T::y},
                                        {"z of the matrix", "m", &T::z},
                                        {"rotation (x)", "1", &T::qx},
                                        {"rotation (y)", "1", &T::qy},
                                        {"rotation (z)", "1", &T::qz},
                                        {"rotation (w)", "1", &T::qw},
                                        {"x of momentPoint", "m", &T::about_x},
                                        {"y of momentPoint", "m", &T::about_y},
                                        {"z of momentPoint", "m", &T::about_z}});
    }
    RigidMotion motion() const { return {{qw, qx, qy, qz}, {x, y, z}}; }
    void set_motion(const RigidMotion& m);
};

class Holds final : public Term {
  public:
    /// Throws Error FE251 (body set) where two parts hold the same vertices.
    explicit Holds(const Scene& scene);

    /// Throws Error FE304 (body set) for a rotation that is none.
    Changes take(const StepInputs& inputs, const State& before) override;
    void begin_stage(const Stage& stage) override { inputs_ = &stage.inputs; }
    void place_held(const Stage& stage, Positions& x) const override;
    bool carry(const Positions& before, Positions& x, std::vector<char>& bodies) const override;
    double energy(const Positions&, bool) override { return 0; }
    void add_gradient(std::span<double>) const override {}
    void add_hessian(const Positions&, bool, BlockMatrix&) override {}
    void raise_forces_at_work(const Positions&, std::span<double>) const override {}
    void add_squared_stiffnesses(std::span<double>) const override {}
    double stored_energy(const Positions&) override { return 0; }
    bool wants_reactions() const override { return true; }
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;

  private:
    struct Hold {
        std::size_t part = 0;         ///< in the scene
        std::vector<int> vertices;    ///< of the scene
        std::vector<double> nearness; ///< per unknown of the body: 1/distance at rest [1/m]; empty for a single hold
        mutable Points from, to;      ///< of the vertices, and how the body's centre moves and turns with them
        mutable Vec3 shift, turn;
    };
    /// The holds of one body.
    struct Held {
        std::size_t deformable = 0;
        std::vector<Hold> holds;
    };
    void set_nearness();
    const Scene& scene_;
    std::vector<Held> bodies_;
    const StepInputs* inputs_ = nullptr;
};

} // namespace sinew::solver
