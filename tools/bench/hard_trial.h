// One body, or a few, through hard times, and a judge who believes nothing that the solver says about itself.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/beams.h"
#include "tools/bench/models.h"

#include <cmath>
#include <stop_token>
#include <string>

namespace sinew::bench {

using Map = std::function<solver::Vec3(const solver::Vec3&)>;
using Where = std::function<bool(const solver::Vec3&)>;

/// What every hard case is run with.
struct HardSetting {
    LawName law = laws[0];
    ElementName element = elements[0];
    IntegratorName integrator = integrators[0];
};

enum class Outcome {
    recovered, ///< ends where it must, and every step that was called converged was
    elsewhere, ///< ends in another stable equilibrium, of a body that has several
    stopped,   ///< an error with a code, or the last step or many in a row are called not converged
    wrong      ///< anything else: a number that is none, a claim that is not true, the wrong place without a word
};
const char* name_of(Outcome outcome);

/// What a judge throws: the solver said something that is not so.
struct WrongAnswer {
    std::string why;
};

/// A scene under one setting. A case makes it, does something to it, lets it run, and says where it must end.
class HardTrial {
  public:
    HardTrial(const HardSetting& setting, std::stop_token stop);

    const HardSetting setting;
    std::shared_ptr<solver::TissueRest> rest; ///< the first body; null if it is a cloth
    solver::SceneDescription description;
    solver::StepInputs in;
    solver::Points nodes; ///< rest positions of the first body's vertices, those on edges too
    solver::State state;
    int newton = 0, halvings = 0, unconverged = 0, steps = 0;
    double volume_at_rest = 1; ///< of every tet, over that of the model: where the case changes the rest shape
    bool is_static() const { return in.integrator == solver::Integrator::quasi_static; }
    bool is_linear() const { return rest->element == solver::ElementKind::linear; } ///< of a tissue
    /// The first body, its vertices `held` fixed. Fibres and the law's stiff direction are along x.
    void make(solver::TetMesh mesh, const solver::TissueInputs& values, const Where& held);
    /// A cloth as the first body. It is no matter of laws and elements, and leave_alone is not for it.
    void make_cloth(const solver::Points& points, const std::vector<solver::Triangle>& triangles,
                    const solver::ClothInputs& values, const Where& held);
    solver::ClothInputs& cloth_values() { return std::get<solver::ClothInputs>(in.bodies[0]); }
    /// The same body once more, tied to nothing, with values of its own.
    void add_twin(const solver::TissueInputs& values);
    void add_bone(const solver::Points& corners);
    /// Springs from what has x = 0 of a tissue to a bone [N/m^3].
    void attach_root(int tissue, int bone, double stiffness);
    solver::TissueInputs& values() { return std::get<solver::TissueInputs>(in.bodies[0]); }
    void start();

    /// Moves vertices of the first body, held ones too, without a step.
    void place(const Where& which, const Map& to);
    void move_bone(int body, const Map& to);
    /// From here on nothing works on the first body from outside: a step that adds to its energy is wrong. Placing
    /// vertices and moving bones end this.
    void leave_alone();
    /// Steps, as many as the scheme needs to come to rest: without inertia, or in `seconds` with it.
    void run(int static_steps, double seconds);
    /// One judged step. Throws solver::Error FE301 at the `most_in_a_row`th that does not converge.
    void step();
    static constexpr int most_in_a_row = 12;

    /// Greatest distance of a vertex of the first body from where `to` takes its rest position [m].
    double distance_from(const Map& to) const;
    double distance_from(const HardTrial& other) const;
    /// Greatest difference of a distance between two vertices of the first body from that after `to` [m]: without it 0
    /// for rigid motions.
    double distortion(const solver::Mat3& to = solver::Mat3::Identity()) const;
    solver::Vec3 centre() const; ///< of the first body, if it is of one density

    /// A few long steps: what still moves after `run` is to be gone.
    void come_to_rest();

    /// The verdict on the end: whether it is `there`, where the last step is called converged. Where the body has more
    /// than one equilibrium at rest it may be elsewhere.
    enum class Equilibria { one, several };
    void must(bool there, const std::string& what, Equilibria equilibria = Equilibria::one);
    Outcome outcome = Outcome::recovered;
    std::string why;

  private:
    void judge(const solver::State& before);
    std::shared_ptr<const solver::Scene> scene_;
    std::unique_ptr<solver::Workspace> workspace_;
    solver::StepControl control_;
    solver::Vec3 mean_of(const solver::Tet& tet, const std::vector<double>& values) const; ///< over the tet's volume
    double volume_of(const solver::Tet& tet) const;                                        ///< at rest [m^3]
    double kinetic_energy() const; ///< of the first body, at most what it is [J]
    double most_energy_ = INFINITY;
    int in_a_row_ = 0;     ///< steps that have not converged, up to now
    double moved_ = 0;     ///< the longest way of a vertex in the last step [m]
    bool definite_ = true; ///< at the last step whose equations could be made again
    std::vector<std::array<int, 2>> edges_;
};

} // namespace sinew::bench
