// Fields as a term: forces per volume or mass that depend on place, velocity and time (force.h), taken at the points
// of points.h. Those with a potential are energies; air and drag are dissipation potentials, whose coefficient is that
// of the last iteration where it depends on the place; what has neither does work with the force of the last iteration.
// The Hessian is the exact tangent's symmetric part. In steps without inertia (QuasiStatic) velocities are zero: drag
// does nothing, and air pushes as on matter at rest.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"
#include "solver/terms/field/force.h"
#include "solver/terms/field/points.h"

namespace sinew::solver {

extern const TermType field_type;

class BodyFields final : public Term {
  public:
    explicit BodyFields(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override { points_.add_couplings(couplings); }
    void bind(const BlockPattern& pattern) override;
    void begin_stage(const Stage& stage) override;
    double begin_iteration(const Positions& x) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double energy_scale() const override { return energy_scale_; }
    /// Fields keep no energy in a body.
    double stored_energy(const Positions&) override { return 0; }
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    void marks(const Positions& x, Marks& out) const override;

  private:
    /// One field on one body.
    struct Action {
        int part;          ///< of the scene's
        std::size_t field; ///< in fields_
        std::size_t body;  ///< in points_.bodies()
        std::size_t first; ///< of its kept numbers
    };
    /// What an action keeps at a point.
    struct Kept {
        Vec3 force = Vec3::Zero(); ///< that does work: at the place of the last iteration
        double resistance = 0;     ///< likewise
    };
    /// Of fields whose magnitude is not zero.
    template <class Visit>
    void for_each_action(const Visit& visit) const;
    const std::vector<double>& weights(const FieldAt& f) const { return f.by_mass() ? masses_ : volumes_; }
    /// Whether the work is that of a kept force.
    bool keeps_force(const FieldAt& f) const { return !f.is_conservative() && !(f.resists() && velocity_factor_ > 0); }
    bool keeps_resistance(const FieldAt& f) const { return f.resists() && velocity_factor_ > 0; }
    bool has_tangent(const FieldAt& f) const { return !f.is_constant() && !(f.resists() && !varies_or_moves(f)); }
    bool varies_or_moves(const FieldAt& f) const { return f.varies() || velocity_factor_ > 0; }
    Vec3 velocity(std::size_t point, const Vec3& place) const { return velocity_factor_ * place + offset_[point]; }
    void take_materials(const StepInputs& inputs);
    void bind_masses();
    /// Takes the forces and resistances at these places for what `work` compares from here on.
    void keep(const std::vector<Vec3>& places);
    /// Energy [J] of one action at a point, where the points are now.
    double work(const FieldAt& f, const Kept& kept, std::size_t point) const;
    double total_work();
    void set_places(const Positions& x, std::vector<Vec3>& places) const;

    const Scene& scene_;
    VolumePoints points_;
    std::vector<FieldAt> fields_;              ///< per part that is a field
    std::vector<int> parts_;                   ///< their places in the scene
    std::vector<std::vector<Action>> actions_; ///< per body of points_
    std::vector<char> is_off_;                 ///< per body of points_: nothing moves it, as the step sees it
    bool by_mass_ = false, acts_ = false;      ///< some field is by mass; some magnitude is not zero
    std::vector<TissueInputs> materials_;      ///< per body of points_: what masses_ was made from
    std::vector<ClothInputs> sheets_;          ///< the same of cloth
    std::vector<double> of_tet_, volumes_, masses_;
    double velocity_factor_ = 0;
    std::vector<Vec3> offset_;               ///< velocity at the points less velocity factor times place
    std::vector<Vec3> start_, at_, kept_at_; ///< places: at the start of the step, now, at the last iteration
    std::vector<Kept> kept_;
    std::vector<Vec3> loads_; ///< at the points [N]
    std::vector<Mat3> tangents_;
    std::vector<double> works_; ///< at the points [J]
    double energy_scale_ = 0;
    std::vector<double> at_vertices_; ///< forces, 3 a vertex
};

} // namespace sinew::solver
