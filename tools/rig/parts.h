// The meshes that a new graph is made around: found, read and named.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "engine/file_access.h"
#include "solver/mesh/surface_mesh.h"
#include "tools/rig/lids.h"

#include <functional>
#include <string>
#include <vector>

namespace sinew::rig {

enum class Kind { bone, muscle };

/// One mesh file as a body of the rig.
struct Part {
    std::string name; ///< of its node: camelCase, unique
    std::string stem; ///< of its file: "biceps_long_head"
    std::string file;
    Kind kind = Kind::bone;
    /// As they are simulated, in scene units: the file's, or those of the surface that wraps it.
    solver::Points points;
    std::vector<solver::Triangle> triangles;
    bool is_wrapped = false;
    double wrap = 0;         ///< how far from the file's polygons the wrapping surface is, in scene units
    std::string why_wrapped; ///< what is wrong with the file's mesh
    Lids lids;               ///< over wide holes; wrapped together with the file's polygons
    bool is_hollow = false;  ///< what wraps it is a shell, since nothing closes it or it has no inside
    bool keeps_file = false; ///< a sheet or shell, which is used as it is
    solver::Box box;
};

/// The mesh files that `paths` stand for: those in a folder, by name, or the path itself. Throws engine::Failure:
/// IO401, IO410, DG150 for a folder without meshes. Notes: DG180 for folders within, which are passed over.
std::vector<std::string> mesh_files(const engine::FileAccess& access, const std::vector<std::string>& paths,
                                    std::vector<engine::Diagnostic>& notes);
/// The same of two lists, what is wrong with either told at once.
std::pair<std::vector<std::string>, std::vector<std::string>> mesh_files(const engine::FileAccess& access,
                                                                         const std::vector<std::string>& some,
                                                                         const std::vector<std::string>& others,
                                                                         std::vector<engine::Diagnostic>& notes);

/// Reads and names them; does not wrap. Throws engine::Failure with all files that cannot be used: IO4xx, FE2xx, DG153
/// for a bone and a muscle that are the same mesh. What two files of one kind have in common is left out of the second
/// with a warning (DG153); a name that two files share is made two (note DG154).
/// \param soft what one of `muscles` is called there: "muscle", "cloth"
std::vector<Part> read_parts(const engine::FileAccess& access, const std::vector<std::string>& bones,
                             const std::vector<std::string>& muscles, std::vector<engine::Diagnostic>& notes,
                             const std::string& soft = "muscle");

/// "biceps_long_head" → "bicepsLongHead"; what no name may begin with gets "mesh" before it.
std::string camel_case(const std::string& stem);

/// A diagnostic of this room: `node` is a part's name or empty.
engine::Diagnostic say(engine::Severity severity, std::string code, std::string node, std::string message,
                       std::string hint);

} // namespace sinew::rig
