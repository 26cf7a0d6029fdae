// The assembler takes the files in as they are: no generated source, and no limit on the length of a string.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/asset.h"

#define SINEW_INCLUDE_BYTES(NAME, FILE)                                                                                \
    asm(".pushsection .rodata\n"                                                                                       \
        ".global " #NAME "_begin\n.global " #NAME "_end\n" #NAME "_begin:\n.incbin \"" FILE "\"\n" #NAME "_end:\n"     \
        ".popsection\n");                                                                                              \
    extern "C" const char NAME##_begin[];                                                                              \
    extern "C" const char NAME##_end[]

SINEW_INCLUDE_BYTES(sinew_viewer_script, SINEW_VIEWER_ASSET "/viewer.js");
SINEW_INCLUDE_BYTES(sinew_viewer_style, SINEW_VIEWER_ASSET "/viewer.css");

namespace sinew::viewer {

std::string_view page_script() { return {sinew_viewer_script_begin, sinew_viewer_script_end}; }
std::string_view page_style() { return {sinew_viewer_style_begin, sinew_viewer_style_end}; }

} // namespace sinew::viewer
