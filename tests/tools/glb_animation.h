// An animation in memory, and the file that the program would write of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/tools/temporary_folder.h"
#include "tools/cli/glb.h"

#include <string>
#include <vector>

namespace sinew::test {

struct AnimatedBody {
    std::string name;
    render::BodyKind kind = render::BodyKind::plain;
    std::vector<solver::Triangle> triangles;
    std::vector<cli::GlbBody::Pose> poses; ///< one a frame, scene units
};

struct Animation {
    double fps = 24;
    std::vector<int> frames;
    double units_per_metre = 1;
    char up = 'y';
    std::vector<AnimatedBody> bodies;
};

/// The bytes of the file, written frame by frame.
inline std::string encode_glb(const Animation& a) {
    const TemporaryFolder folder;
    cli::GlbFile glb(folder / "run.glb", {a.fps, a.units_per_metre, a.up});
    for (std::size_t f = 0; f < a.frames.size(); ++f)
        for (std::size_t b = 0; b < a.bodies.size(); ++b) {
            const AnimatedBody& body = a.bodies[b];
            if (f == 0) glb.add_body(body.name, body.kind, body.triangles, body.poses[0]);
            glb.add_pose(b, a.frames[f], body.poses[f]);
        }
    return glb.finish() ? read_text(folder / "run.glb") : std::string();
}

} // namespace sinew::test
