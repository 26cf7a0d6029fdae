// The machine that a measurement was made on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

namespace sinew::cli {

/// "AMD EPYC 9B14, 2 cores, 24 GB"
std::string machine_name();
/// The day as 2026-11-21, UTC.
std::string today();
/// Processes that ran or waited over the last minute; negative if the system does not say.
double load_average();
/// Changes with every build of this program: its file's size and time.
std::string build_mark();
/// The most memory that this process has had at once.
std::int64_t peak_bytes();

} // namespace sinew::cli
