// The assembler takes the files in as they are, so that an installed program needs no source tree.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/reference.h"

#define SINEW_REFERENCE_FILE(NAME, FILE)                                                                               \
    asm(".pushsection .rodata\n.global " #NAME "_begin\n.global " #NAME "_end\n" #NAME "_begin:\n.incbin \"" FILE      \
        "\"\n" #NAME "_end:\n.popsection\n");                                                                          \
    extern "C" const char NAME##_begin[];                                                                              \
    extern "C" const char NAME##_end[]

SINEW_REFERENCE_FILE(sinew_accuracy, SINEW_REFERENCE_DATA "/accuracy.json");
SINEW_REFERENCE_FILE(sinew_bar_release, SINEW_REFERENCE_DATA "/bar_release.json");

namespace sinew::bench {

const nlohmann::json& reference_values() {
    static const nlohmann::json values = nlohmann::json::parse(sinew_accuracy_begin, sinew_accuracy_end);
    return values;
}

const nlohmann::json& bar_release_values() {
    static const nlohmann::json values = nlohmann::json::parse(sinew_bar_release_begin, sinew_bar_release_end);
    return values;
}

} // namespace sinew::bench
