// What the solver throws. It knows no graph, so the node adapters add node and attribute.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <stdexcept>
#include <string>

namespace sinew::solver {

/// Input that cannot be used, or a step that failed. `code` is one of the stable codes FE2xx, FE3xx, IO4xx.
class Error : public std::runtime_error {
  public:
    Error(std::string code, std::string message, std::string hint = {})
        : std::runtime_error(message)
        , code(std::move(code))
        , hint(std::move(hint)) {}
    std::string code, hint;
    int body = -1;       ///< index of the body in the scene, if one is to blame
    int attachment = -1; ///< likewise of the attachment
    int part = -1;       ///< likewise of the part
};

/// The host asked to stop.
class Stopped : public std::runtime_error {
  public:
    Stopped()
        : std::runtime_error("stopped") {}
};

} // namespace sinew::solver
