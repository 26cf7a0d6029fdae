// Contact: a point inside of another body's surface, or of another part of its own, is pulled out with a force per area
// that grows with its depth. Both sides feel it through what carries them, and the sums vanish.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/point_triangle_element.h"
#include "solver/term/type.h"
#include "solver/term/vertex_gradient.h"
#include "solver/terms/contact/cloth_contact.h"
#include "solver/terms/contact/contact_list.h"
#include "solver/terms/contact/held_points.h"
#include "solver/terms/contact/slipping_spring.h"
#include "solver/terms/contact/touches.h"

namespace sinew::solver {

extern const TermType contact_type;

/// A sliding contact has the energy 1/2 k A d^2, d the distance to the nearest place of the surface, followed from
/// where the point came in; a fixed one 1/2 k A |p - q|^2, q where it touched. k is the series stiffness of the two
/// bodies, A the area that the point stands for. Friction is Coulomb's, by a spring of the same stiffness along the
/// surface whose end slips where it would pull with more than mu times the force that the contact presses with: it
/// neither creeps nor drags below that. A stage begins with the forces of the end of the step before, and without
/// friction of what comes in; where that turns out to be wrong by much, while the stage is being solved roughly, the
/// solve goes on with those that it found.
///
/// Which points may come in is settled at the start of a step: those whose way comes near to what the other body's
/// triangles sweep. Where a solution has moved bodies elsewhere, the set is made larger, and the solve goes on.
class Contacts final : public Term {
  public:
    explicit Contacts(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void begin_stage(const Stage& stage) override;
    double begin_iteration(const Positions& x) override;
    bool renew(const Positions& x) override;
    bool widen(const Positions& x) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override {
        gradient_.add_to_unknowns(scene_.numbering(), gradient);
    }
    void add_held_gradient(std::span<double> by_vertices) const override {
        gradient_.add_held(scene_.numbering(), by_vertices);
    }
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions&, std::span<double> largest) const override {
        gradient_.raise(scene_.numbering(), largest);
    }
    void press_as_before(bool on) override { as_before_ = on, looked_at_.clear(); }
    bool keep_to_edges(bool on) override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    void remember(const Positions& x, bool keeps_history, TermMemory& memory) const override;
    double stored_energy(const Positions& x) override;
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    void marks(const Positions& x, Marks& out) const override;
    /// All contacts of the state that the stage ends at, after marks; by source, target and point. Bodies are the
    /// scene's.
    void list(std::vector<ContactPoint>& out) const;

  private:
    /// What holds a touching point to a place of the triangle that moves with it: a fixed contact, friction, damping.
    struct Tether {
        std::size_t touch = 0;
        int triangle = -1;
        Vec3 place = Vec3::Zero();
        Vec3 offset = Vec3::Zero(); ///< where the point is at rest, from there [m]
        Mat3 holds = Mat3::Zero();  ///< projects on the directions that the spring sees
        SlippingSpring spring;
        FollowedForce followed;     ///< of it
        Mat3 brakes = Mat3::Zero(); ///< damping by directions [N s/m]
        Vec3 drift = Vec3::Zero();  ///< relative velocity minus velocity factor x the way [m/s]
    };
    /// Of a pair, sums of forces [N].
    struct Rubbing {
        double could = 0, change = 0; ///< at most; of friction by what has been found out about it
    };
    struct Force {
        double energy = 0;
        Vec3 by_point = Vec3::Zero(); ///< derivative by the point's place [N]
    };

    /// What holds the sides of a press between layers as they were at the start of the step: friction and damping.
    struct Drag {
        ClothContact::Press press; ///< then
        Vec3 way = Vec3::Zero();   ///< between the sides, then [m]
        Mat3 holds = Mat3::Zero(); ///< as of tethers
        SlippingSpring spring;
        FollowedForce followed;     ///< of it
        Mat3 brakes = Mat3::Zero(); ///< likewise
        Vec3 drift = Vec3::Zero();  ///< likewise
    };

    const double* carriers(int body, const Positions& x) const {
        return bodies_[body].deforms() ? x.data() : bones_[at(body)].data()->data();
    }
    const double* carriers_before(int body) const;
    /// Where nothing but momentum leads, and bones are.
    const double* carriers_expected(int body) const;
    const ContactPair& pair_of(std::size_t touch) const { return pairs_[pair_of_touch_[touch]]; }
    /// Whether a body is switched off. What presses on it is not laid out in the pattern: its rows are the identity's.
    bool stands(int body) const;
    bool neither_stands(std::size_t touch) const {
        return !stands(touches_[touch].source) && !stands(touches_[touch].target);
    }
    bool neither_stands(const ClothContact::Press& press) const {
        return !stands(cloth_.body_of(press.corners[0])) && !stands(cloth_.body_of(press.corners[3]));
    }
    Vec3 point_at(const Touch& t) const { return places_[at(t.source)][at(t.point)]; }
    Vec3 place_at(int target, int triangle, const Vec3& place) const;
    void place_points(int body, const double* carriers) const;
    /// Places all points, and measures how far bodies have moved since the step began.
    void look_at(const Positions& x) const;
    void find_features(const Positions& x) const;
    /// After look_at: it has not moved as far against its target as it was off at the start of the step.
    bool surely_outside(std::size_t touch) const {
        const Touch& t = touches_[touch];
        return clearance_[touch] > 0 && clearance_[touch] > search_.way(t, point_at(t)) + moves_[at(t.target)];
    }
    /// Stiffness of a touch [N/m], its area found out when first asked for.
    double stiffness(std::size_t touch) const {
        double& area = areas_[touch];
        if (area < 0) area = search_.area(pair_of(touch), touches_[touch]);
        return pair_of(touch).stiffness * area;
    }
    ClosestFeature feature_at(std::size_t touch) const;
    Press press(std::size_t touch, const ClosestFeature& f) const {
        const Touch& t = touches_[touch];
        return press_of(bodies_[t.target], pair_of(touch), t.side, f);
    }
    /// Whether a touch of that depth has the energy of a sliding contact.
    bool presses(std::size_t touch, double depth) const {
        return depth > 0 && (touches_[touch].kept < 0 || pair_of(touch).slides);
    }
    /// From where a held point would be on the surface to where it is: half of a cloth's thickness is between.
    Vec3 offset_of(const ContactPair& pair, int side, const ClosestFeature& f) const;
    void count_presses(std::vector<ContactPair>& pairs) const;
    void begin_pairs(const StepInputs& inputs, const State& before);
    bool is_left_to_attachments(const KeptContact& contact) const;
    void find_all_touches();
    void sweep(const std::vector<const double*>& later);
    void find_touches(std::size_t pair, std::size_t first_touch);
    void make_tethers();
    Vec3 held_before(const Tether& tether) const;
    bool look_farther(const Positions& x);
    // Of friction within the step, in contact_friction.cpp:
    ClosestFeature first_place(std::size_t i, const Vec3& out) const;
    void follow_friction();
    bool renew_friction(const Positions& x);
    void place_flown();
    const Tether* first_tie(std::size_t touch) const;
    ClosestFeature way_in(std::size_t touch, const Points& places, const Vec3& p) const;
    Vec3 drift_of(int body, int point) const;
    Vec3 reach(const Tether& tether) const;
    Force tether_force(const Tether& tether, double* stored) const;
    double evaluate(const Positions& x, bool with_damping);
    void remember_couplings() const;
    // Of points near edges, in contact_edges.cpp:
    ClosestFeature unfolded(std::size_t touch, const ClosestFeature& f) const;
    void watch_features();
    std::array<int, 2> edge_passed(std::size_t touch) const;
    bool has_room(std::size_t touch, const std::array<int, 2>& edge) const;
    ClosestFeature on_edge(std::size_t touch) const;
    // Of contact as it was at the start of the step, in contact_carried.cpp:
    bool pressed_before(std::size_t touch) const;
    Press carried_press(std::size_t touch) const;
    double carried_energy(const Positions& x, bool with_forces);
    void add_carried_hessian(const Positions& x, BlockMatrix& a);
    // Of tethers, in contact_forces.cpp:
    void add_tether_forces();
    void add_tether_hessian(BlockMatrix& a);
    // Of layers of cloth, in contact_layers.cpp:
    void begin_cloth();
    void begin_cloth_search();
    std::vector<ClothContact::Lost> lost_points() const;
    void remember_lost() const;
    void make_drags();
    bool widen_cloth(const Positions& x);
    Vec3 way_between(const ClothContact::Press& press) const;
    Force drag_force(const Drag& drag, double* stored) const;
    double evaluate_cloth(bool with_damping);
    void add_cloth_forces();
    void add_cloth_hessian(bool project, BlockMatrix& a);
    void couple_cloth(const ClothContact::Press& press) const;
    void show_cloth(const Positions& x) const;
    void mark_cloth(const Positions& x, MarkGroup& group) const;
    void list_cloth(std::vector<ContactPoint>& out) const;
    KeptContact kept_contact(std::size_t touch, const ClosestFeature& f) const;

    const Scene& scene_;
    CollisionBodies bodies_;
    TouchSearch search_;
    HeldPoints attached_;
    const BlockPattern* pattern_ = nullptr;
    ContactMemory kept_; ///< of the state that a step starts from
    std::vector<CoupledCarriers> couplings_;
    mutable ContactMemory next_; ///< scratch of remember

    // Of the stage:
    const Stage* stage_ = nullptr;
    mutable std::vector<Points> places_; ///< per body of contact: of its points, where they were looked at last
    std::vector<Points> bones_;          ///< per body of contact: where a bone's vertices are
    std::vector<ContactPair> pairs_;
    std::vector<ContactPair> begun_;         ///< scratch of begin_pairs
    std::vector<std::vector<char>> held_;    ///< per pair: flags of points that are left to attachments; empty: none
    std::vector<const double*> before_;      ///< per body: what carries it, at the start of the step
    std::vector<const double*> expected_;    ///< per body: what carries it where it is looked for
    std::vector<std::vector<double>> swept_; ///< per body: the same as it was when it was looked for last
    std::vector<double> off_;                ///< per body: how far it is from where it was looked for [m]
    std::vector<char> strong_;               ///< per pair: it ties more firmly than what the pattern leaves out may
    std::vector<Touch> touches_;
    std::vector<std::size_t> pair_of_touch_;
    std::uint64_t dropped_ = 0;         ///< contacts of the state that are too deep as the step begins
    mutable std::vector<double> areas_; ///< per touch [m^2]; -1: not asked for yet
    std::vector<FeatureStart> starts_;  ///< per touch
    std::vector<double>
        clearance_;      ///< per touch: how far it was outside at the start of the step [m]; -1: unknown, or it pressed
    bool found_ = false; ///< whether the touches of this stage are
    bool as_before_ = false;            ///< press_as_before
    mutable std::vector<double> moves_; ///< per body: how far any point is from where it began, as search_ sees it [m]
    mutable std::vector<ClosestFeature> now_; ///< per touch, at looked_at_; triangle = -1: surely outside
    mutable Positions looked_at_;
    /// Per touch: nearest places at this iteration and the one before, and at the first trial after this one; fewer
    /// where touches are new.
    std::vector<ClosestFeature> one_ago_, two_ago_;
    mutable std::vector<ClosestFeature> tried_;
    mutable bool tries_ = false;            ///< the next places looked at are that trial's
    std::vector<std::array<int, 2>> edges_; ///< per touch: that it is to be kept to, or {-1, -1}; empty: none is
    bool by_edges_ = false;                 ///< the direction of this iteration was
    bool on_edges_ = false;                 ///< keep_to_edges
    std::vector<Force> forces_, tether_forces_;
    std::vector<PointTriangleElement> elements_, tether_elements_; ///< kept for their room
    std::vector<std::size_t> pressing_;       ///< scratch of energy and add_hessian: touches that press
    std::vector<PointTriangleBlocks> blocks_; ///< likewise: of each of them
    std::vector<Tether> tethers_; ///< of contacts of the state, then of touches that came in within the step, in order
    std::size_t first_ties_ = 0;  ///< where the latter begin
    std::vector<Tether> ties_before_; ///< scratch: the ties of the renewal before
    std::vector<double> limits_;      ///< scratch: per tether the renewed force at which it slips [N]
    std::vector<Rubbing> rubbing_;    ///< likewise, per pair
    std::vector<Points> flown_;       ///< per body: where its points would be without forces
    VertexGradient gradient_;

    // Of layers of cloth:
    mutable ClothContact cloth_;
    std::vector<ContactPair> cloth_pairs_;
    std::vector<std::array<std::vector<char>, 2>> cloth_held_;
    mutable std::vector<Points> cloth_places_;         ///< per body of contact; empty for what is no cloth
    mutable std::vector<ClothContact::Press> presses_; ///< at looked_at_
    mutable std::vector<ClothContact::Press> shown_;   ///< of the state shown last
    std::vector<Drag> drags_;
    std::vector<Force> drag_forces_;
    PointTriangleElement cloth_element_; ///< kept for its room
    std::vector<char> cloth_strong_;     ///< per press at looked_at_: the pattern leaves out what it ties
};

} // namespace sinew::solver
