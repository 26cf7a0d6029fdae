// The machine that a measurement was made on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

namespace sinew::cli {

/// "AMD EPYC 9B14, 2 cores, 24 GB"
std::string machine_name();
/// The most memory that this process has had at once.
std::int64_t peak_bytes();

} // namespace sinew::cli
