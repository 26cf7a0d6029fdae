// What a body brings to contact: its part of the scene, and its values at one time.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/embedded_point.h"
#include "solver/fields.h"
#include "solver/term/part.h"
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// A surface that collides in place of a tissue's own and rides on its tets.
struct CollisionShape {
    Points surface; ///< where the tissue is at rest [m]
    std::vector<Triangle> triangles;
    std::vector<PointWeights> carriers; ///< of each vertex, by the tissue's own vertex numbers
};

/// One part a body.
struct ContactRest final : PartRest {
    bool is_volume = true; ///< its surface bounds a solid, out of which others are pushed
    /// Of a cloth [m]: half of it lies on either side of the faces, and others are pushed out of that. 0, and for all
    /// that are no cloth: nothing meets the faces but what they press into.
    double thickness = 0;
    std::vector<int> sets; ///< bodies that share a number collide; none = with all
    double spacing = 0;    ///< no two points that are tested along an edge are farther apart [m]; 0 = vertices alone
    std::shared_ptr<const CollisionShape> shape; ///< null: the body's own surface
};

/// Whether their sets let two bodies collide.
bool share_a_set(const ContactRest& a, const ContactRest& b);

struct ContactValues;
/// Whether one body's points may press into the other's surface, or the other way round: by their sets, switches and
/// stiffnesses. Which of them has a surface that pushes is not asked.
bool may_meet(const ContactRest& a, const ContactValues& of_a, const ContactRest& b, const ContactValues& of_b);
/// Whether its surface pushes others.
inline bool has_faces(const ContactRest& rest) { return rest.is_volume || rest.thickness > 0; }

struct ContactValues {
    double collides = 1, collides_with_itself = 0, slides = 1; ///< switches: 1 = on
    double stiffness = 1e6;                                    ///< [N/m^3]
    double friction = 0;                                       ///< Coulomb's coefficient
    double damping = 0;                                        ///< [N s/m^3]
    double longest = 0;                                        ///< a contact that is deeper is dropped [m]; 0 = none
    static constexpr auto fields() {
        using T = ContactValues;
        return std::to_array<Field<T>>({{"collisions", "1", &T::collides},
                                        {"selfCollisions", "1", &T::collides_with_itself},
                                        {"contactSliding", "1", &T::slides},
                                        {"contactStiffness", "N/m^3", &T::stiffness},
                                        {"contactFriction", "1", &T::friction},
                                        {"contactDamping", "N*s/m^3", &T::damping},
                                        {"maxContactLength", "m", &T::longest}});
    }
};

} // namespace sinew::solver
