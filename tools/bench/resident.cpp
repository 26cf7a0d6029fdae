// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/resident.h"

#include "tools/cli/heap.h"

#include <fstream>
#include <unistd.h>

namespace sinew::bench {

double resident_bytes() {
    cli::renew_heap();
    std::ifstream in("/proc/self/statm");
    double total = 0, resident = 0;
    in >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

} // namespace sinew::bench
