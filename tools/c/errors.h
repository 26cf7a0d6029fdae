// The errors of a thread's last call of the C interface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "tools/c/sinew.h"

#include <span>

namespace sinew::c {

/// Of this thread; forgets those of the call before.
void forget_errors();
void keep_errors(std::span<const engine::Diagnostic> diagnostics);
/// Of the exception that is being handled.
sinew_status keep_current_exception() noexcept;

/// The texts are those of `d`.
sinew_diagnostic describe(const engine::Diagnostic& d);

} // namespace sinew::c
