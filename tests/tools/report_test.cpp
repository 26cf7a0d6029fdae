// What the report and its summary say of known numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/report.h"

#include <catch2/catch.hpp>
