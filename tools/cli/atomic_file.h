// Files that are there whole or not at all, as the engine writes them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/atomic_file.h"

namespace sinew::cli {

using engine::write_file;

} // namespace sinew::cli
