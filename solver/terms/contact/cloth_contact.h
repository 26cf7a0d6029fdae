// Cloth that has a thickness against all that it meets, itself too.
// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points are tested against faces, both ways, and edges against edges. A sheet may lie in many layers and folds, so
// there is no nearest place to follow. All that is near within a step is looked at instead, as long as it shares no
// vertex; nothing goes through anything at the start of a step, so what has gone through on the straight way from there
// is known, and is drawn back. What is on the wrong side at the start of a step in spite of that is left to Touch,
// which keeps sides.
//
// The energy of a point is 1/2 k A (r - g)^2 with the gap g to the faces, negative where it has gone through, and r
// half of the thicknesses; from half of that gap on it is `hardening` times as stiff on top. Over the faces about an
// edge or a vertex it is summed so that each place counts once (Li et al., "Convergent Incremental Potential Contact",
// 2023): faces less the edges between them plus the vertices. Edges that pass each other are held apart from half of
// the range on.
#pragma once
#include "solver/mesh/bvh.h"
#include "solver/mesh/triangle_math.h"
#include "solver/term/point_triangle.h"
#include "solver/term/point_triangle_element.h"
#include "solver/term/term.h"
#include "solver/terms/contact/collision_bodies.h"
#include "solver/terms/contact/passage.h"
#include "solver/terms/contact/standoff.h"

#include <algorithm>
#include <compare>
#include <optional>
#include <span>
#include <vector>

namespace sinew::solver {

class ClothContact {
  public:
    /// Both outlive it.
    ClothContact(const Scene& scene, const CollisionBodies& bodies);
    /// Whether the scene has any.
    bool any() const { return !members_.empty(); }

    static constexpr double hardening = 30, hard_share = 0.5;
    /// What presses two sides together at one time. Corners are points of all members; the first `split` are one side.
    struct Press {
        std::array<int, 4> corners{-1, -1, -1, -1};
        std::array<double, 4> weights{}; ///< the way between the sides is the sum of weight x corner
        int split = 1;
        int pair = -1;
        int face = -1, side = 0; ///< of a point: its face, and the side of that on which it was at the start
        bool through = false;
        bool bends = true;         ///< false: right above where faces meet, where the gap may bend or not
        double stiffness = 0;      ///< [N/m]; less than 0 where an edge takes back what its two faces both count
        double range = 0, gap = 0; ///< [m]
        Vec3 out = Vec3::Zero();   ///< how the gap grows with the first side
        Vec3 away = Vec3::Zero();  ///< from the second side's place to the first one's
        double depth() const { return range - gap; }
        /// How much deeper than where it gets harder.
        double deep() const { return std::max(0.0, hard_share * range - gap); }
        double energy() const { return 0.5 * stiffness * (depth() * depth() + hardening * deep() * deep()); }
        double force() const {
            return stiffness * (depth() + hardening * deep());
        } ///< along out, on the first side [N]
        double rise() const { return stiffness * (1 + (deep() > 0 ? hardening : 0)); } ///< of that with the depth [N/m]
    };
    /// A point of a body and another body, or the same one, that it has got through.
    struct Lost {
        int source, point, target;
        friend auto operator<=>(const Lost&, const Lost&) = default;
    };
    /// A step begins. `pairs`: those of find_thick_pairs; `held`: per pair, flags of the points of its first and second
    /// body that are left to attachments (none, or one a point). `places`: per body of contact, of its points; `lost`,
    /// sorted: what others look after.
    void begin(const std::vector<ContactPair>& pairs, const std::vector<std::array<std::vector<char>, 2>>& held,
               const std::vector<Points>& places, const std::vector<Lost>& lost);
    /// Looks for all that may meet on the way from the start of the step to there. Throws Error FE308 if that is more
    /// than ten million pairs.
    void search(const std::vector<Points>& later);
    /// How far a point may be from where it was looked for [m].
    double margin() const { return margin_; }
    /// Whether all points are within the margin of where they were looked for.
    bool covers(const std::vector<Points>& places) const;
    /// What presses where the points are now, in fixed order.
    void find_presses(const std::vector<Points>& places, std::vector<Press>& out);
    /// A solve goes on from where presses were found last.
    void accept();
    /// What presses at the start of the step.
    void find_presses_at_start(std::vector<Press>& out);

    std::span<const RideTerm> ride(int corner) const;
    int body_of(int corner) const { return members_[at(member_of_[at(corner)])].body; } ///< of contact
    int point_of(int corner) const { return corner - members_[at(member_of_[at(corner)])].first_point; }
    /// Of a press of a point, by the body's own triangles.
    int triangle_of(const Press& press) const {
        return press.face - members_[at(member_of_[at(press.corners[1])])].first_face;
    }
    const ContactPair& pair(int number) const { return pairs_[at(number)]; }
    std::size_t pair_count() const { return pairs_.size(); }
    /// Second derivatives of the energy of a press, by its corners. `project`: without what bends.
    PointTriangleBlocks hessian(const Press& press, const std::vector<Points>& places, bool project) const;
    Vec3 place(int corner, const std::vector<Points>& places) const {
        const Member& m = members_[at(member_of_[at(corner)])];
        return places[at(m.body)][at(corner - m.first_point)];
    }

  private:
    struct Member {
        int body, first_point, first_face;
        double usual_area = 0; ///< of its points [m^2]
    };
    struct PointFace {
        int point = -1, face = -1, pair = -1;
        int side = 0; ///< of the face's plane at the start: 1, -1, or 0 in it
        Standoff standoff{};
        Passage passage{};
        double area = 0; ///< that the point stands for against the face's body [m^2]
    };
    struct EdgePair {
        int one, other, pair, side;
        Standoff standoff{};
        Passage passage{};
    };
    /// A face that a point is near to.
    struct Near {
        int face, pair, side;
        bool through;
        Vec3 place, away;
        double distance, area;
    };
    /// Where a point is nearest to faces, edges and vertices, and how often that counts.
    struct Place {
        std::array<int, 3> vertices; ///< that carry it, in order, the others -1
        double count;
        const Near* face;
        Vec3 place, away;
        double distance;
    };
    struct Side {
        std::array<int, 2> edge;
        double count;
    };
    /// Room that a piece of work keeps.
    struct Scratch {
        std::vector<Press> presses;
        std::vector<Near> near;
        std::vector<Place> places;
        std::vector<Side> sides;
        std::vector<std::pair<int, double>> vertices;
    };
    int pair_of(int point, int other) const {
        return pair_of_members_[at(member_of_[at(point)]) * members_.size() + at(member_of_[at(other)])];
    }
    template <class Pair>
    bool is_through(const Pair& c, const std::array<Vec3, 4>& at_x, bool turned, double distance) const;
    /// No two points are nearer than they were there by more than that [m].
    double closed_in(const Points& from) const;
    bool holds() const;
    bool is_lost(int point, int target_member) const;
    void judge_by_nearest(int point, std::vector<PointFace>& found, std::size_t first);
    bool is_inside(int face, const TrianglePoint& there, const Vec3& p) const;
    bool is_held(int pair, int corner) const;
    double share(int point, const PointFace& nearest, double distance2) const;
    std::array<Vec3, 4> corners_of(const PointFace& c, const Points& x) const;
    std::array<Vec3, 4> corners_of(const EdgePair& c, const Points& x) const;
    void gather(const std::vector<Points>& places, Points& out) const;
    void find_point_faces(double reach);
    void find_edge_pairs(double reach);
    std::optional<EdgePair> pair_within(int edge, int other, double reach) const;
    Vec3 way_of(int corner) const { return later_[at(corner)] - start_[at(corner)]; } ///< within the step
    void watch_moves();
    double standoff_of(const PointFace& c, const std::array<Vec3, 4>& at_x, const Vec3& normal, double height,
                       double distance) const;
    double standoff_of(const EdgePair& c, const std::array<Vec3, 4>& at_x, const Vec3& normal, double height,
                       double distance) const;
    void presses_of_point(std::size_t first, std::size_t end, const Points& x, Scratch& s);
    Press press_of_point(int point, const Near& face, double count, const Vec3& place, const Vec3& away,
                         double distance) const;
    void count_once(int point, const Points& x, Scratch& s) const;
    void press_of_edges(EdgePair& c, const Points& x, std::vector<Press>& out) const;
    void find_presses(const Points& x, std::vector<Press>& out);

    const CollisionBodies& bodies_;
    std::vector<Member> members_; ///< all bodies, where there is thick cloth
    std::vector<int> member_of_;  ///< per point of all members
    std::vector<Triangle> faces_; ///< by points of all members
    std::vector<std::array<int, 2>> edges_;
    std::vector<double> areas_;       ///< per point [m^2]
    std::vector<double> face_points_; ///< per face: the mean of its points' areas [m^2]
    std::vector<double> edge_areas_;  ///< a third of the faces beside each [m^2]
    Points modelled_;
    Bvh face_tree_, edge_tree_;
    std::vector<int> last_edges_;        ///< per node of the edges' tree: the highest number in it
    std::vector<std::size_t> edge_fans_; ///< the first edge from each vertex that has any; one more
    double mean_edge_ = 0, margin_ = 0;

    // Of the step:
    std::vector<ContactPair> pairs_;
    std::vector<std::array<std::vector<char>, 2>> held_;
    std::vector<int> pair_of_members_;
    std::vector<Lost> lost_;
    std::vector<char> inside_; ///< per point: it is inside of some solid at the start
    std::vector<Points> start_places_;
    Points start_, later_;
    std::vector<PointFace> point_faces_;    ///< by points
    std::vector<std::size_t> point_starts_; ///< places of the first of each point that has any; one more
    std::vector<EdgePair> edge_pairs_;
    mutable Points now_;
    Points accepted_;                                     ///< from where the solve goes on; empty: not known
    double least_apart_ = 0;                              ///< of all pairs, there [m]
    bool holds_ = false;                                  ///< who is through is as it was there
    Points seen_;                                         ///< where standoffs were brought up to date
    std::vector<double> moves_, face_moves_, edge_moves_; ///< per point, face and edge, from there to now [m]
    std::vector<Scratch> scratch_;
    std::vector<std::vector<PointFace>> face_parts_;
    std::vector<std::vector<EdgePair>> edge_parts_;
    std::vector<std::vector<int>> near_edges_; ///< room for those that may be near to a fan
    std::vector<BvhNode> boxes_, ways_;
    /// A ball about a face or an edge, and one about the ways of its corners.
    struct Ball {
        Vec3 middle, way;
        double radius, spread;
    };
    std::vector<Ball> balls_;
};

} // namespace sinew::solver
