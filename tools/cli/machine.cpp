// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/machine.h"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace sinew::cli {

std::string machine_name() {
    std::string name = "unknown processor";
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name")) {
            name = line.substr(std::min(line.size(), line.find(':') + 2));
            break;
        }
    const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, " +
           std::to_string(static_cast<long long>(bytes / (1 << 30) + 0.5)) + " GB";
}

std::string build_mark() {
    struct stat file {};
    if (stat("/proc/self/exe", &file) != 0) return {};
    return std::to_string(file.st_size) + "." + std::to_string(file.st_mtim.tv_sec) + "." +
           std::to_string(file.st_mtim.tv_nsec);
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
    return text;
}

double load_average() {
    double load = -1;
    return getloadavg(&load, 1) == 1 ? load : -1;
}

std::int64_t peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{1024} * usage.ru_maxrss; // Linux counts in kilobytes
}

} // namespace sinew::cli
