// Every code that the program can emit, what it means and what to do. Codes are stable and never
// reused; FE214 is retired.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"

namespace sinew::engine {

namespace {

constexpr CodeInfo table[] = {
    // ---- DG0xx: the document ----
    {"DG001", "not valid JSON", "Repair the text at the line and column named."},
    {"DG002", "key written twice", "Keep one of the two; a reader could otherwise silently take the other."},
    {"DG003", "nested too deeply", "Graph files need a handful of levels; remove the extra brackets."},
    {"DG004", "no format, or not a Sinew graph", "Write \"format\": \"sinew 1\" at the top of the file."},
    {"DG005", "written by a newer Sinew", "Use a newer program, or write the file again with this one."},
    {"DG006", "format number without a migration", "Check the number; formats start at 1."},
    {"DG007", "unknown key", "Remove the key or correct its spelling."},
    {"DG008", "a part of the document has the wrong kind", "Write the kind of value that the message names."},
    {"DG009", "timing cannot be used", "fps is above 0; start and end are whole frames, end not before start."},
    {"DG010", "node type that this program does not know", "Correct the type, or use a program that has it."},
    {"DG011", "no such input", "Correct the name; `sinew nodes TYPE` lists the inputs."},
    {"DG012", "value of the wrong type", "Write a value of the type that the message names."},
    {"DG013", "value outside the limits", "Choose a value inside the limits in the message."},
    {"DG014", "word that is not an option", "Choose one of the words in the hint."},
    {"DG015", "unit unknown or of another dimension", "Use a unit of the same dimension as the attribute's."},
    {"DG016", "unknown preset", "Choose one of the presets in the hint."},
    {"DG017", "keyframes cannot be used", "Keys are [frame, value], frames rising, all values of one width."},
    {"DG018", "attribute cannot carry keyframes", "Write a plain value."},
    {"DG019", "required input missing", "Connect the input or give it a value."},
    {"DG020", "list and single value mixed up", "Lists of connections are written [ {\"from\": …}, … ]."},
    {"DG021", "too few connections", "Connect at least as many as the message names."},
    {"DG022", "connection from a node that does not exist", "Correct the node's name or add the node."},
    {"DG023", "connection from an output that does not exist", "Correct the output's name."},
    {"DG024", "connection between different types", "Connect an output of the type that the input takes."},
    {"DG025", "connection written wrongly", "Write {\"from\": \"node.output\"}."},
    {"DG026", "plain value where only a connection fits", "Write {\"from\": \"node.output\"}."},
    {"DG027", "number that is not finite", "Write a finite number."},
    {"DG028", "node name that cannot be used", "Names are not empty and hold no dot and no control characters."},
    {"DG029", "input that cannot be connected", "Write a plain value: the engine reads it before anything runs."},
    {"DG030", "connections form a cycle", "Break the cycle at one of the nodes on the path."},
    {"DG040", "edit of a node that does not exist", "Correct the name."},
    {"DG041", "name already in use", "Choose another name."},
    {"DG042", "key on a connected input", "Disconnect the input first."},
    // ---- DG1xx: evaluation ----
    {"DG101", "node of an unknown type was needed", "Use a program that knows the type, or bypass the node."},
    {"DG102", "no such plug", "Ask for an output as node.output."},
    {"DG103", "simulation asked for a fraction of a frame", "Simulations have whole frames; use sub-steps."},
    {"DG104", "frame cannot be used", "Ask for a finite frame, not millions of frames from the start."},
    {"DG105", "saved state does not fit", "Load a state that this graph saved at this frame."},
    {"DG106", "sub-steps cannot be used", "Use a whole number of sub-steps, at least 1."},
    {"DG107", "start frame is not a whole number", "Write a whole frame number."},
    {"DG110", "inputs of a node that do not fit together", "Change one of the inputs that the message names."},
    // ---- FE2xx: meshes and set-up ----
    {"FE201", "mesh is empty", "Give a mesh with points and faces."},
    {"FE202", "number of a mesh or map is not finite",
     "Repair the coordinate or weight that is named: it is NaN or infinite."},
    {"FE203", "index out of range", "Repair the mesh: a face or element names a point that does not exist."},
    {"FE204", "list that does not fit the mesh", "Give one number for each point, or a single one for all."},
    {"FE205", "fibre end points missing", "Paint where the fibres start and end (weights 0 and 1)."},
    {"FE206", "tissue without a material", "Connect at least one zMaterial."},
    {"FE207", "attachment between two bones", "It does nothing: bones follow their animation."},
    {"FE208", "mesh is degenerate or invalid", "Repair the mesh; the message says where."},
    {"FE209", "body that the solver does not have", "Connect that body to the solver too."},
    {"FE210", "tet size that does not suit the mesh", "Choose a larger one, or a smaller one, as the message says."},
    {"FE211", "change over time of what must stay",
     "Bodies, faces, rest shapes and painted maps keep to what they were at the start frame."},
    {"FE212", "nothing is painted", "Paint at least one weight above 0."},
    {"FE213", "bodies that cannot be told apart", "Two bodies are identical; remove one or make them differ."},
    {"FE215", "tet without volume or inside out", "Remove flat tets; swap two indices of those inside out."},
    {"FE216", "curve cannot be used", "Give x, y and z of two points or more."},
    {"FE217", "meshes with different vertices",
     "vertexID needs a target with the source's vertices; or use worldSpace."},
    {"FE218", "bone where a tissue is needed", "Connect a tissue; what rides on a bone is moved by a transform."},
    {"FE219", "attachment from a body to itself", "Choose two bodies."},
    {"FE220", "mesh is not watertight", "Close the holes at the vertices that are named, or choose FilledCavities."},
    {"FE221", "tets repeated", "Remove the repeated tets; they would count twice in mass and stiffness."},
    {"FE222", "setting that a mesh cannot be made with", "Choose a value in the range that the message names."},
    {"FE223", "surface without an inside", "Give a surface that encloses a volume, all of it facing one way."},
    {"FE224", "mesh beyond what numbers can hold", "Bring it nearer to the origin, or to a usual size."},
    {"FE225", "law without directions", "Connect a fibre to the tissue: it gives the law its direction."},
    {"FE226", "lattice made for another element",
     "Set zTet.element to quadratic where the lattice is made; it then knows more about the tets that it cuts."},
    {"FE230", "open mesh where a closed one is needed", "Close the mesh, or remesh it by zIsoMesh with isoValue > 0."},
    {"FE231", "level set is empty or a sheet too thin to follow",
     "Below 0, choose an isoValue of smaller size; above 0, one of half a grid cell or more; or a higher resolution."},
    {"FE232", "mesh would be too large", "Choose larger triangles or a smaller resolution."},
    {"FE233", "meshing took too long", "Raise maxTime, or ask for a coarser mesh."},
    {"FE234", "level set could not be meshed as a manifold",
     "Choose a higher resolution or, where triangles are finer than half a grid cell, larger ones; else a slightly "
     "different isoValue."},
    {"FE235", "pieces too small to be meshed", "Choose smaller triangles to keep them."},
    {"FE236", "mesh cannot be the boundary of tets", "Repair the edges that are named, or remesh by zIsoMesh."},
    {"FE237", "triangles that cross, or that tets cannot keep", "Remesh the surface by zIsoMesh."},
    {"FE238", "mesh switches a feature off", "Repair the edges that are named, or remesh by zIsoMesh."},
    {"FE239", "mesh far from the tets that shall carry it", "Model it where the tissue is at rest, in the same units."},
    // ---- FE3xx: the solve ----
    {"FE301", "step did not converge", "Raise maxNewtonIterations or substeps, or soften the contrast."},
    {"FE302", "step failed", "Raise substeps; look for bones that jump between frames."},
    {"FE303", "free body without inertia", "QuasiStatic needs every body held; attach it or use BackwardEuler."},
    {"FE304", "value that a step cannot take", "Give a finite number in the range that the message names."},
    {"FE305", "not enough memory", "Choose fewer tets, or the iterative linear solver."},
    // ---- IO4xx: files ----
    {"IO401", "file is missing", "Correct the path; relative paths start at the graph's folder."},
    {"IO402", "file cannot be read", "Check permissions, and that it is a file and not a folder."},
    {"IO403", "file has an error in it", "Repair the line that is named."},
    {"IO404", "file format is not supported", "Convert the file to a supported format."},
    {"IO405", "file cannot be written", "Check the folder, permissions and free space."},
    {"IO406", "kept result cannot be used", "Nothing to do: it is made anew and replaced."},
    {"IO407", "results cannot be kept on disk",
     "Check the folder, permissions and free space, or choose another by --cache."},
};

} // namespace

std::span<const CodeInfo> all_codes() { return table; }

} // namespace sinew::engine
