// The program's heap: how large its pages are, and what of it goes back to the system.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::cli {

/// Whether memory is refused before it is used (`ulimit -v`).
bool has_limited_space();

/// To be called before anything large is allocated and while there is one thread. Without glibc it does nothing.
void set_up_heap();
/// The same for what follows, after all that is free went back to the system.
void renew_heap();

} // namespace sinew::cli
