// Node types whose compute is a Python function.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"

#include "tools/python/python_session.h"

#include <pybind11/pybind11.h>

namespace sinew::python {

/// Adds a type as sinew/node_types.py describes it. Throws Misuse DG128 for a description that cannot be.
/// Gives the function that the type calls, which lives as long as the registry.
/// \param ending is given what the function raises to end the program
Kept add_python_type(engine::Registry& registry, const pybind11::object& description,
                     const std::shared_ptr<Ending>& ending);

} // namespace sinew::python
