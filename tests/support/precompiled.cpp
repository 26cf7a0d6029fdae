// Reads the headers that are precompiled for all tests: CMake precompiles them for a target whose files use them, which
// main.cpp, with what Catch makes of its header there, cannot.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/precompiled.h"
