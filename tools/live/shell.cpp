// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/shell.h"

// Taken in by the assembler, as the viewer's script is (viewer/asset.cpp).
asm(".pushsection .rodata\n"
    ".global sinew_live_shell_begin\n.global sinew_live_shell_end\nsinew_live_shell_begin:\n"
    ".incbin \"" SINEW_LIVE_SHELL "\"\nsinew_live_shell_end:\n"
    ".popsection\n");
extern "C" const char sinew_live_shell_begin[];
extern "C" const char sinew_live_shell_end[];

namespace sinew::live {

std::string_view shell_page() { return {sinew_live_shell_begin, sinew_live_shell_end}; }

} // namespace sinew::live
