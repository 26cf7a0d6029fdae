// Node types by name. Filled by explicit calls (nodes/register_all.cpp), never by static initialisers.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"

#include <map>
#include <string>

namespace sinew::engine {

class Registry {
  public:
    /// Throws std::logic_error on a second type of the same name or a declaration that contradicts itself
    /// (default outside the limits, duplicate attribute, missing doc).
    void add(NodeType type);
    template <class State>
    void add(SimulationType<State> type) {
        add(erase(std::move(type)));
    }
    const NodeType* find(std::string_view name) const;
    std::vector<std::string> names() const;

  private:
    std::map<std::string, NodeType, std::less<>> types_;
};

} // namespace sinew::engine
