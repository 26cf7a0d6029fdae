// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/start_warnings.h"

#include "nodes/z_solver_attributes.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"

namespace sinew::nodes {

using engine::Reads;
using namespace z_solver;

void warn_of_lone_bodies(const Reads& in, const Setup& setup) {
    struct Member {
        std::size_t body;
        const solver::ContactRest* rest;
        solver::ContactValues values;
    };
    std::vector<Member> members;
    for (std::size_t i = setup.forces.size() - setup.contacts.size(); i < setup.forces.size(); ++i) {
        const Force& f = setup.forces[i];
        members.push_back({static_cast<std::size_t>(setup.key.reach[i].front()),
                           static_cast<const solver::ContactRest*>(f.rest.get()),
                           solver::get_fields<solver::ContactValues>(f.values)});
    }
    for (const Member& m : members) {
        if (m.values.collides < 0.5 || m.values.collides_with_itself >= 0.5) continue;
        bool others = false, shares = false, meets = false;
        for (const Member& o : members) {
            if (o.body == m.body || (setup.body(o.body).is_bone() && setup.body(m.body).is_bone())) continue;
            others = true;
            if (!solver::share_a_set(*m.rest, *o.rest)) continue;
            shares = true;
            meets = meets || o.values.collides < 0.5 || solver::has_faces(*m.rest) || solver::has_faces(*o.rest);
        }
        if (!others || meets) continue;
        if (shares) {
            in.warn(
                bodies.name, "FE256",
                body_name(in, setup, m.body) +
                    " touches nothing: neither it nor any body that it could meet bounds a volume or has a thickness",
                "Leave collisionVolume at auto and close the surface of one of them, or switch collisions of the "
                "body off.");
            continue;
        }
        std::string sets;
        for (const int s : m.rest->sets) {
            if (!sets.empty()) sets += ' ';
            sets += std::to_string(s);
        }
        in.warn(bodies.name, "FE256",
                body_name(in, setup, m.body) + ".collisionSets is \"" + sets +
                    "\", which no other body that could touch it shares, so it touches nothing",
                "Give both bodies of a pair a number in common, or switch collisions of the body off.");
    }
}

void warn_of_lost_velocities(const Reads& in, const Setup& setup, bool without_inertia) {
    for (std::size_t i = 0; i < setup.simulated.size(); ++i) {
        const solver::InitialMotion& start = setup.body(i).start;
        const bool moves = !start.velocity.isZero(0), turns = !start.angular_velocity.isZero(0);
        if (!moves && !turns) continue;
        const std::string what = body_name(in, setup, i) + (moves ? ".initialVelocity" : "") +
                                 (moves && turns ? " and " : "") + (turns ? ".initialAngularVelocity" : "") +
                                 (moves && turns ? " are" : " is");
        if (without_inertia)
            in.warn(integrator.name, "FE339", what + " lost: QuasiStatic, in the first step, knows no velocities",
                    "Choose another integrator, or take the velocity out.");
        else if (!setup.acts(i))
            in.warn(bodies.name, "FE339", what + " lost: the body is off in the first step, and comes on at rest",
                    "Let it be on from the start frame on, or take the velocity out.");
    }
}

} // namespace sinew::nodes
