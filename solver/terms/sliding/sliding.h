// Sliding attachments: points of one body's surface keep their distance from the surface of another, and move along it
// freely, but only over the part that is painted. The points are those of attachments (attachment/anchors.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"
#include "solver/term/vertex_gradient.h"
#include "solver/terms/attachment/attachment.h"
#include "solver/terms/sliding/sliding_memory.h"
#include "solver/terms/sliding/sliding_target.h"

#include <memory>

namespace sinew::solver {

extern const TermType sliding_type;

/// Energy 1/2 k A w (d^2 - h^2 + (h - g)^2) a point: d its distance to the part of the target that it may lie on, h its
/// signed height over the target, g the height that it keeps. Over the part where it may be d^2 = h^2, and it is held
/// along the normal alone; beyond its rim d^2 - h^2 draws it back. Damping opposes the relative velocity along the
/// normal.
/// Which face, edge or vertex is nearest is looked for before the first Newton iterations of a step, and again where a
/// solution has moved points elsewhere. Within an iteration it is fixed: points see a face's plane, which goes on
/// beyond it, or the faces about an edge or vertex; once an iteration could hardly move that edge or vertex alone, as
/// where faces turn inwards the height over them is not smooth. Of the samples that one tet carries few slide, with
/// weights of their own (lump_samples.h). The nearest place is followed from where it was at the end of the step
/// before, so a point stays on its side of a thin target. It begins, at the height kept from then on (0 without
/// maintainOffset), at the nearest place of the step at which an attachment comes to slide.
class Slides final : public Term {
  public:
    explicit Slides(const Scene& scene)
        : scene_(scene) {}

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void begin_stage(const Stage& stage) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override {
        if (!slides_.empty()) gradient_.add_to_unknowns(scene_.numbering(), gradient);
    }
    void add_held_gradient(std::span<double> by_vertices) const override {
        if (!slides_.empty()) gradient_.add_held(scene_.numbering(), by_vertices);
    }
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions&, std::span<double> largest) const override {
        if (!slides_.empty()) gradient_.raise(scene_.numbering(), largest);
    }
    void add_squared_stiffnesses(std::span<double> squares) const override;
    void remember(const Positions& x, bool keeps_history, TermMemory& memory) const override;
    bool settle(const Positions& x, bool stuck) override;
    bool widen(const Positions& x) override;
    double stored_energy(const Positions& x) override;
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    /// Lines from the points to where they may be nearest, with how far they are off their height.
    void marks(const Positions& x, Marks& out) const override;

  private:
    /// A point that slides.
    struct Slide {
        int attachment;
        std::size_t target;     ///< of targets_
        std::size_t first_term; ///< of rides_
        int terms;              ///< none: a bone carries it
        double area_weight;     ///< [m^2]
        AnchorEnd source;
    };
    /// What is nearest, as settled.
    struct Nearest {
        Feature allowed, any; ///< of where it may lie, of the whole target
        bool apart = false;   ///< they are not the same
        friend bool operator==(const Nearest&, const Nearest&) = default;
    };
    struct Now {
        ClosestFeature allowed; ///< where it may lie
        Height height;          ///< unused where none is kept
    };
    /// Damping along the normal against a place of the target, by a spring between velocities.
    struct Brake {
        int triangle = -1;
        Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
        Vec3 drift = Vec3::Zero(); ///< relative velocity minus velocity factor x the way [m/s]
    };

    void make_slides(const AttachmentView& attachments);
    void add_slides(int attachment, std::span<const Anchor> anchors);
    std::vector<Vec3> modelled_normals(std::span<const Anchor> anchors, const AttachmentRest& rest) const;
    void begin_sliding(std::size_t attachment, const State& before);
    std::span<const RideTerm> ride(const Slide& s) const { return {rides_.data() + s.first_term, at(s.terms)}; }
    const std::vector<char>* allowed(const Slide& s) const {
        return allowed_[at(s.attachment)].empty() ? nullptr : &allowed_[at(s.attachment)];
    }
    double stiffness(const Slide& s) const { return pulls_[at(s.attachment)].stiffness * s.area_weight; }
    Vec3 point_of(const Slide& s, const Positions& x, const std::vector<Points>& bones) const;
    void make_brakes();
    bool find_all_nearest(const Positions& x, bool stuck);
    void look_at(const Positions& x) const;
    Nearest find_nearest(std::size_t slide, const Vec3& p) const;
    /// How far it is off where it may be, squared [m^2]; less than 0 where places beyond the borders of what is
    /// nearest say so.
    double squared_way(std::size_t slide) const;
    void press(const Slide& s, int triangle, const Vec3& place, const Vec3& by_point);
    Vec3 way_of_brake(std::size_t slide) const;
    double evaluate(const Positions& x, bool with_damping) const;
    // Of the Hessian, in sliding_hessian.cpp:
    struct Addition;
    struct Share;
    void find_shares();
    void make_blocks(std::size_t slide, bool project, PointTriangleBlocks& blocks) const;
    void make_additions(std::size_t slide, bool project);
    template <class Visit>
    void for_each_addition(const std::vector<std::size_t>& attachments, const Visit& visit) const;
    void add_share(Share& share, BlockMatrix& a);
    void add_outside(const Share& share, BlockMatrix& a);
    bool is_near_home(const SlidingTarget& target, const SlidingMemory::Place& place) const;
    void find_ties(std::size_t slide, int triangle);

    struct Pull {
        double stiffness = 0, viscous = 0; ///< [N/m^3], of damping x velocity factor likewise
    };

    const Scene& scene_;
    TermMemory anchors_;            ///< that the slides are made of
    std::vector<char> on_, wanted_; ///< per attachment: it slides, or shall
    std::vector<Slide> slides_;
    std::vector<std::size_t> first_slide_; ///< per attachment and one past the end
    std::vector<RideTerm> rides_;
    std::vector<std::unique_ptr<SlidingTarget>> targets_;
    std::vector<std::vector<char>> allowed_; ///< per attachment, of the target's triangles; empty: all
    SlidingMemory kept_;                     ///< at the start of the step
    std::vector<int> homes_, newly_home_;    ///< of all slides, as the pattern was made; scratch

    // Of the stage:
    const Stage* stage_ = nullptr;
    std::vector<Pull> pulls_;     ///< per attachment
    std::vector<Points> bones_;   ///< per body, where they are in the stage
    std::vector<double> heights_; ///< per slide: that it keeps [m]
    std::vector<FeatureStart> starts_;
    std::vector<Nearest> nearest_;
    bool alone_ = false; ///< heights are over edges and vertices alone: over all faces about them it was stuck
    int settled_ = 0, widened_ = 0; ///< how often what is nearest was looked for anew
    std::vector<Brake> brakes_;     ///< empty: none is damped
    mutable Positions looked_at_;
    mutable std::vector<Vec3> points_;
    mutable std::vector<Now> now_;
    VertexGradient gradient_;
    /// Of the pattern, for what carries a point: a block of its upper triangle.
    struct Entry {
        int block;
        double weight;
    };
    std::vector<std::size_t> first_entry_; ///< per slide and one past the end
    std::vector<Entry> entries_;
    /// Blocks of a slide's point and a triangle, times a factor.
    struct Addition {
        int triangle = -1;
        double factor = 0;
        PointTriangleBlocks blocks;
    };
    static constexpr std::size_t most_additions = 3; ///< of a slide: where it may be, the bend of its height, its brake
    std::vector<Addition> additions_;                ///< so many places a slide
    std::vector<int> addition_count_;                ///< per slide
    /// Attachments whose slides write to the same numbers.
    struct Share {
        enum Kind { source, target, pair } kind;
        std::size_t one, other; ///< bodies: carriers, of target itself
        std::vector<std::size_t> attachments;
        std::vector<std::pair<std::size_t, const Addition*>> outside; ///< slides; scratch: what the pattern leaves out
    };
    std::vector<Share> shares_;
    bool between_carriers_ = true; ///< none ties what one tissue carries to itself: shares may be written side by side
    std::vector<std::vector<std::size_t>> targets_of_carriers_; ///< those that deform
    /// Of the pattern, for what carries a point and what carries a triangle of its target.
    struct Tie {
        int block;
        int corner; ///< of the triangle
        double weight;
        bool turned; ///< the target's row comes first
    };
    struct Ties {
        int triangle = -1;
        bool all = false; ///< the pattern has them all
        std::vector<Tie> ties;
    };
    std::vector<Ties> ties_; ///< per slide, of the triangle that was last asked for
    const BlockPattern* pattern_ = nullptr;
    std::vector<Overlay::Carrier> carriers_; ///< scratch
    std::vector<Points> pressed_;            ///< per target: forces at its points [N]
    /// How what is nearest to a point has changed in this stage. One that goes to and fro, as where faces turn inwards,
    /// stays where it is after a while: it would keep Newton's method from coming to rest.
    struct Changing {
        Nearest former;
        int returns = 0, changes = 0;
    };
    std::vector<Changing> changing_;   ///< per slide
    std::vector<Nearest> newly_;       ///< scratch
    mutable SlidingMemory remembered_; ///< scratch
};

} // namespace sinew::solver
