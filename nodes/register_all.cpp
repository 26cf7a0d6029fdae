// The list of all node types.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/register_all.h"

#include "nodes/codecs.h"
#include "solver/error.h"
#include "solver/meshing/meshing_control.h"

#include <new>
#include <stdexcept>

namespace sinew::nodes {

// geometry
void add_mesh_file(engine::Registry&);
void add_mesh_sequence(engine::Registry&);
void add_host_mesh(engine::Registry&);
void add_tet_mesh_file(engine::Registry&);
void add_poly_sphere(engine::Registry&);
void add_poly_cube(engine::Registry&);
void add_poly_plane(engine::Registry&);
void add_poly_cylinder(engine::Registry&);
void add_poly_helix(engine::Registry&);
void add_curve(engine::Registry&);
// meshing
void add_z_iso_mesh(engine::Registry&);
void add_z_delaunay_tet_mesh(engine::Registry&);
// motion
void add_transform(engine::Registry&);
void add_aim(engine::Registry&);
void add_skin_cluster(engine::Registry&);
void add_pick_mesh(engine::Registry&);
void add_track_channel(engine::Registry&);
// painting
void add_weights(engine::Registry&);
void add_transfer_weights(engine::Registry&);
void add_combine_weights(engine::Registry&);
void add_end_points(engine::Registry&);
// simulation
void add_z_bone(engine::Registry&);
void add_z_tet(engine::Registry&);
void add_z_material(engine::Registry&);
void add_muscle_curve(engine::Registry&);
void add_z_line_of_action(engine::Registry&);
void add_z_rivet_to_bone(engine::Registry&);
void add_z_fiber(engine::Registry&);
void add_z_subtissue(engine::Registry&);
void add_z_rest_shape(engine::Registry&);
void add_z_tissue(engine::Registry&);
void add_z_cloth(engine::Registry&);
void add_z_attachment(engine::Registry&);
void add_z_goal_attachment(engine::Registry&);
void add_z_hold(engine::Registry&);
void add_air_field(engine::Registry&);
void add_drag_field(engine::Registry&);
void add_gravity_field(engine::Registry&);
void add_newton_field(engine::Registry&);
void add_radial_field(engine::Registry&);
void add_turbulence_field(engine::Registry&);
void add_uniform_field(engine::Registry&);
void add_volume_axis_field(engine::Registry&);
void add_vortex_field(engine::Registry&);
void add_z_solver(engine::Registry&);
void add_z_embedder(engine::Registry&);
// output
void add_mesh_writer(engine::Registry&);
void add_tet_writer(engine::Registry&);
void add_contact_writer(engine::Registry&);

namespace {

/// Runs a call of a node; what no adapter foresaw becomes a diagnostic about the node instead of a bug.
template <class Call>
auto told(const engine::Reads& in, Call&& call) {
    try {
        return call();
    } catch (const solver::Stopped&) {
        throw engine::Cancelled();
    } catch (const solver::Error& e) {
        in.fail({}, e.code, e.what(), e.hint);
    } catch (const std::bad_alloc&) {
        in.fail({}, "FE305", "there is not enough memory for it", "Choose fewer tets, faces or frames at once.");
    } catch (const std::length_error&) {
        in.fail({}, "FE305", "it would be larger than any memory", "Choose fewer tets or faces.");
    }
}

engine::NodeType with_errors_told(engine::NodeType type) {
    if (type.compute)
        type.compute = [compute = type.compute](const engine::Reads& in, engine::Writes& out) {
            told(in, [&] { compute(in, out); });
        };
    if (!type.simulation) return type;
    const engine::SimulationFunctions plain = *type.simulation;
    auto wrapped = std::make_shared<engine::SimulationFunctions>(plain);
    wrapped->initial = [plain](const engine::Reads& in) { return told(in, [&] { return plain.initial(in); }); };
    wrapped->advance = [plain](const engine::Value& before, std::span<const engine::SubstepReads> substeps) {
        return told(substeps.back().end, [&] { return plain.advance(before, substeps); });
    };
    wrapped->publish = [plain](const engine::Value& state, const engine::Reads& in, engine::Writes& out) {
        told(in, [&] { plain.publish(state, in, out); });
    };
    type.simulation = std::move(wrapped);
    return type;
}

} // namespace

void register_all(engine::Registry& registry) {
    add_codecs(registry);
    engine::Registry plain;
    add_codecs(plain);
    for (auto* add : {add_mesh_file,
                      add_tet_mesh_file,
                      add_poly_sphere,
                      add_poly_cube,
                      add_poly_plane,
                      add_poly_cylinder,
                      add_poly_helix,
                      add_curve,
                      add_transform,
                      add_track_channel,
                      add_weights,
                      add_end_points,
                      add_z_bone,
                      add_z_tet,
                      add_z_material,
                      add_muscle_curve,
                      add_z_line_of_action,
                      add_z_rivet_to_bone,
                      add_z_fiber,
                      add_z_subtissue,
                      add_z_rest_shape,
                      add_z_tissue,
                      add_z_cloth,
                      add_z_attachment,
                      add_z_goal_attachment,
                      add_z_hold,
                      add_air_field,
                      add_drag_field,
                      add_gravity_field,
                      add_newton_field,
                      add_radial_field,
                      add_turbulence_field,
                      add_uniform_field,
                      add_volume_axis_field,
                      add_vortex_field,
                      add_z_solver,
                      add_z_embedder,
                      add_mesh_writer,
                      add_z_iso_mesh,
                      add_z_delaunay_tet_mesh,
                      add_tet_writer,
                      add_contact_writer,
                      add_transfer_weights,
                      add_combine_weights,
                      add_aim,
                      add_pick_mesh,
                      add_mesh_sequence,
                      add_host_mesh,
                      add_skin_cluster})
        add(plain);
    for (const std::string& name : plain.names()) registry.add(with_errors_told(*plain.find(name)));
}

std::shared_ptr<const engine::Registry> make_registry() {
    auto registry = std::make_shared<engine::Registry>();
    register_all(*registry);
    return registry;
}

} // namespace sinew::nodes
