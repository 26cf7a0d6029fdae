// From zSolver's inputs at one time to what the solver reads: which bodies and attachments take part, the
// scene in metres, and the values of a step. The one place where scene units become metres and back.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/solver_space.h"
#include "nodes/values.h"
#include "solver/step.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace sinew::nodes {

/// A line of action of a body that takes part.
struct SetupLine {
    std::size_t body = 0; ///< position in Setup::simulated
    const FiberLine* line = nullptr;
};

/// The bodies and attachments of one time. Valid while the Reads lives.
struct Setup {
    std::vector<std::reference_wrapper<const Body>> bodies; ///< all of zSolver.bodies
    std::vector<int> simulated;                             ///< positions in `bodies` of those that take part
    std::vector<BodyId> ids;                                ///< of those that take part
    /// Of those that take part: their rest data, and whose tets carry them, a position among them. Those of a
    /// subtissue are found here: it knows nothing of the tissue that it is a part of.
    std::vector<std::shared_ptr<const BodyRest>> rests;
    std::vector<int> carriers;
    std::vector<std::reference_wrapper<const Attachment>> attachments; ///< those that act
    std::vector<int> attachment_entries;                               ///< their positions in zSolver.attachments
    std::vector<std::reference_wrapper<const Force>> forces; ///< zSolver.forces, then those that bodies bring along
    std::vector<std::shared_ptr<const Force>> contacts;      ///< of them, those that are made of bodies' contacts
    std::vector<int> force_entries; ///< place of each in zSolver.forces; -1: a body brings it along
    std::vector<SetupLine> lines;   ///< by bodies and their fibres
    /// Values of tissues whose fibres follow lines of action, with what those come to (nodes/lines_of_action.h).
    std::map<std::size_t, solver::TissueInputs> followed = {};
    SceneKey key;
    SolverSpace space;
    /// Of a tissue.
    const solver::TissueInputs& tissue_values(std::size_t simulated_index) const {
        const auto found = followed.find(simulated_index);
        return found != followed.end() ? found->second : std::get<solver::TissueInputs>(body(simulated_index).values);
    }
    const Body& body(std::size_t simulated_index) const {
        return bodies[static_cast<std::size_t>(simulated[simulated_index])];
    }
    /// Whether it is enabled now; a subtissue is where the tissue is that it is a part of.
    bool acts(std::size_t simulated_index) const {
        return body(static_cast<std::size_t>(carriers[simulated_index])).enable;
    }
};

/// The node of a body that takes part.
std::string body_name(const engine::Reads& in, const Setup& setup, std::size_t simulated_index);
/// The node of an attachment that acts, by its position in `setup.attachments`.
std::string attachment_name(const engine::Reads& in, const Setup& setup, int attachment);

/// Reads bodies and attachments. `known`: the key at the start frame, or nullptr at the start frame itself. `contact`:
/// what says how bodies collide in the frame where `in` does not, its collisionDetection being off; null where the
/// frame has no contact.
/// Fails with FE209 (an attachment's body is not connected), FE219 (it ties a body to its own part), FE211 (static data
/// changed since the start frame), FE213 (one body or attachment twice), FE282 (a line of action is bound to what has
/// moved).
Setup read_setup(const engine::Reads& in, const SceneKey* known, const engine::Reads* contact);
/// The frame's collisionDetection: `frame`, if it is on.
const engine::Reads* contact_of(const engine::Reads& frame);
/// The scene in metres.
solver::SceneDescription describe_scene(const Setup& setup);
/// Values of one step out of `steps_per_frame`; metres.
solver::StepInputs step_inputs(const engine::Reads& in, const Setup& setup, std::size_t steps_per_frame);
/// What runupWeight leaves of excitations.
double run_up_of_excitation(const engine::Reads& in);
/// Fails with FE303 if a tissue is neither held nor tied to a bone or to what is held by any chain of attachments.
void check_all_tied(const engine::Reads& in, const Setup& setup);
/// Points in metres, from points in scene units, and back.
solver::Points to_metres(const solver::Points& points, double scale);
solver::Points to_scene_units(solver::Points points, double scale);
/// Counts and the energy terms in use; the record is left for the caller.
SolveReport describe_size(const engine::Reads& in, const Setup& setup, const solver::Scene& scene);

} // namespace sinew::nodes
