// The bytes of a GLB file from bodies whose poses wait on disk, in one pass: text and binary part are never in memory.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/atomic_file.h"
#include "tools/cli/glb.h"

#include <deque>
#include <vector>

namespace sinew::cli {

/// Throws engine::Failure IO405 above 4 GB, before anything is written.
void write_glb(const GlbScene& scene, const std::vector<int>& frames, const std::deque<GlbBody>& bodies,
               const SpillFile& spill, engine::AtomicFile& out);

} // namespace sinew::cli
