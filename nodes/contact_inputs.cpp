// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/contact_inputs.h"

#include "nodes/adapters.h"
#include "nodes/solver_setup.h"
#include "nodes/z_solver_attributes.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/contact/contact.h"

#include <charconv>
#include <sstream>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<bool> collisions{
    .name = "collisions",
    .def = true,
    .doc = "Off takes the body out of all contacts. May be keyed; zSolver.collisionDetection is the master switch.",
};
const Input<bool> self_collisions{
    .name = "selfCollisions",
    .def = false,
    .doc = "On keeps the tissue from passing through itself. What is near at rest along the surface, within three mean "
           "edges or three of collisionPointSpacing, does not collide.",
};
const Input<bool> cloth_self_collisions{
    .name = "selfCollisions",
    .def = false,
    .doc = "On keeps the cloth from passing through itself: its layers and folds stay thickness apart.",
};
const Input<double> thickness{
    .name = "thickness",
    .def = 0.001,
    .unit = "m",
    .limits = {.min = 0, .max = 1e60},
    .doc =
        "What the cloth takes up in contacts, half of it on either side of its faces; always in metres, whatever the "
        "scale, and no more than half of the cloth's length. Layers of cloth lie so far apart, and solids half of it. "
        "0: only its points press into solids, and nothing into it.",
    .keyable = false,
};
const Input<std::string> collision_volume{
    .name = "collisionVolume",
    .def = "auto",
    .doc = "Whether the surface bounds a solid, out of which the points of other bodies are pushed: auto is on for "
           "closed meshes and off for open ones. Two bodies collide if at least one has a volume.",
    .keyable = false,
    .options = {"auto", "on", "off"},
};
const Input<bool> contact_sliding{
    .name = "contactSliding",
    .def = true,
    .doc = "On lets others slide along the surface, held back by contactFriction alone; off holds them where they "
           "touched. A pair slides if both bodies do.",
};
const Input<double> contact_stiffness{
    .name = "contactStiffness",
    .def = 1e6,
    .unit = "N/m^3",
    .limits = {.min = 0, .max = most_contact_stiffness},
    .doc = "How hard it pushes out, as pressure per depth. A pair takes 2 a b / (a + b) of the two; 0 lets others "
           "through.",
};
const Input<double> cloth_contact_stiffness{
    .name = "contactStiffness",
    .def = 1e5,
    .unit = "N/m^3",
    .limits = {.min = 0, .max = most_contact_stiffness},
    .doc = "How hard it pushes out, as pressure per depth. A pair takes 2 a b / (a + b) of the two; 0 lets others "
           "through.",
};
const Input<double> contact_friction{
    .name = "contactFriction",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1e6},
    .doc = "Coulomb's coefficient: a sliding contact holds up to this times the force that presses. A pair takes the "
           "geometric mean of the two.",
};
const Input<std::string> collision_sets{
    .name = "collisionSets",
    .def = "0",
    .doc = "Whole numbers, separated by spaces: bodies collide if they share one. Empty collides with all.",
    .keyable = false,
};

std::vector<int> sets_of(const Reads& in) {
    std::vector<int> out;
    std::istringstream words(in[collision_sets]);
    for (std::string word; words >> word;) {
        int set = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), set);
        if (error != std::errc() || end != word.data() + word.size())
            in.fail(collision_sets.name, "FE255", "'" + word + "' is not a whole number",
                    "Write the numbers of sets, separated by spaces: \"0 2\".");
        out.push_back(set);
    }
    return out;
}

/// Whether the surface bounds a solid. Fails where it shall and does not.
bool is_volume(const Reads& in, const Mesh& surface, const char* whose) {
    if (in[collision_volume] == "off") return false;
    // Found out once, however a bone deforms; which way it looks is seen fast.
    struct Kept {
        bool closed;
    };
    auto kept = in.lease<Kept>(Hasher().add("contact.closed").add(surface.topology->digest).finish(), [&] {
        return std::make_shared<Kept>(Kept{solver::is_closed(surface.topology->triangles)});
    });
    const std::vector<solver::Triangle>& triangles = surface.topology->triangles;
    const bool usable = kept->closed && solver::enclosed_volume(*surface.points, triangles) > 0;
    if (usable || in[collision_volume] == "auto") return usable;
    const solver::MeshCheck check = solver::check_mesh(*surface.points, triangles);
    std::string what;
    if (check.is_closed()) {
        what = "is inside out";
    } else {
        const solver::Flaw& flaw = check.open_edges           ? check.open_edges
                                   : check.non_manifold_edges ? check.non_manifold_edges
                                                              : check.badly_oriented_edges;
        const auto [a, b] = flaw.edges.front();
        const solver::Vec3& p = (*surface.points)[static_cast<std::size_t>(a)];
        std::ostringstream place;
        place << p.x() << ", " << p.y() << ", " << p.z();
        what = std::string(check.open_edges           ? "is open"
                           : check.non_manifold_edges ? "has edges with more than two faces"
                                                      : "has faces turned against each other") +
               " at " + std::to_string(flaw.count) + " edges, first between vertices " + std::to_string(a) + " and " +
               std::to_string(b) + " (near " + place.str() + ")";
    }
    in.fail(collision_volume.name, "FE254", std::string("the ") + whose + " " + what + ", so it bounds no solid",
            "Close the surface, for example by zIsoMesh, or leave collisionVolume at auto.");
}

} // namespace

std::vector<AttributeInfo> contact_attributes(Collider kind) {
    std::vector<AttributeInfo> out = {describe(collisions)};
    const bool cloth = kind == Collider::cloth;
    if (kind == Collider::tissue) out.push_back(describe(self_collisions));
    if (cloth) out.push_back(describe(cloth_self_collisions)), out.push_back(describe(thickness));
    if (!cloth) out.push_back(describe(collision_volume));
    for (AttributeInfo& a :
         std::vector{describe(contact_sliding), describe(cloth ? cloth_contact_stiffness : contact_stiffness),
                     describe(contact_friction), describe(collision_sets)})
        out.push_back(std::move(a));
    return out;
}

Force read_contact(const Reads& in, Collider kind, const Mesh& surface, const CollisionSurface* shape) {
    auto rest = std::make_shared<solver::ContactRest>();
    const bool cloth = kind == Collider::cloth;
    rest->is_volume = !cloth && is_volume(in, shape ? shape->mesh : surface, shape ? "collisionShape" : "mesh");
    rest->sets = sets_of(in);
    if (cloth) rest->thickness = in[thickness];
    Hasher h;
    h.add("contact").add(rest->is_volume).add(in[collision_sets]).add(shape != nullptr);
    if (cloth) h.add(rest->thickness);
    if (shape) {
        auto own = std::make_shared<solver::CollisionShape>();
        own->surface = *shape->mesh.points;
        own->triangles = shape->mesh.topology->triangles;
        own->carriers = shape->carriers;
        rest->shape = std::move(own);
        h.add(shape->mesh.topology->digest).add(shape->mesh.points_digest);
    }
    solver::ContactValues values;
    values.collides = in[collisions] ? 1 : 0;
    if (kind == Collider::tissue) values.collides_with_itself = in[self_collisions] ? 1 : 0;
    if (cloth) values.collides_with_itself = in[cloth_self_collisions] ? 1 : 0;
    values.slides = in[contact_sliding] ? 1 : 0;
    values.stiffness = in[cloth ? cloth_contact_stiffness : contact_stiffness], values.friction = in[contact_friction];
    Force f;
    f.type = &solver::contact_type;
    f.rest = std::move(rest);
    f.digest = h.finish();
    f.values.resize(f.type->values.size());
    put_fields(values, f.values);
    return f;
}

Force contact_in_solver(const Reads& solver, const Force& of_body, double units) {
    using namespace z_solver;
    Force f = of_body;
    auto rest = std::make_shared<solver::ContactRest>(static_cast<const solver::ContactRest&>(*of_body.rest));
    rest->spacing = solver[collision_subdivision] ? solver[collision_point_spacing] : 0;
    if (rest->shape && units != 1) {
        auto shape = std::make_shared<solver::CollisionShape>(*rest->shape);
        shape->surface = to_metres(shape->surface, units);
        rest->shape = std::move(shape);
    }
    f.digest = Hasher().add(of_body.digest).add(rest->spacing).finish();
    f.rest = std::move(rest);
    solver::ContactValues values = solver::get_fields<solver::ContactValues>(f.values);
    values.damping = solver[contact_damping];
    values.longest = solver[max_contact_length] * units; // lengths of forces are in scene units
    put_fields(values, f.values);
    return f;
}

} // namespace sinew::nodes
