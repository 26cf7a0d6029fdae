// Memory that the process has in use.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::bench {

/// Now [bytes], after giving free pages back.
double resident_bytes();

} // namespace sinew::bench
