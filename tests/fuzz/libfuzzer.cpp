// libFuzzer's side of the targets: one program for all; SINEW_FUZZ_TARGET says which it is.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets/targets.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

const sinew::fuzz::Target* target = nullptr;

}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* name = std::getenv("SINEW_FUZZ_TARGET");
    target = sinew::fuzz::find_target(name ? name : "");
    if (target) return 0;
    std::fprintf(stderr, "SINEW_FUZZ_TARGET is none of:");
    for (const auto& t : sinew::fuzz::all_targets()) std::fprintf(stderr, " %s", std::string(t.name).c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    target->run({reinterpret_cast<const char*>(bytes), count});
    return 0;
}
