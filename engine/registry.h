// Node types by name. Filled by explicit calls (nodes/register_all.cpp), never by static initialisers.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/codec.h"
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
    /// Throws std::logic_error on a second codec of the same type. Codecs come before the node types that need them.
    void add(Codec codec);
    const Codec* find_codec(std::type_index type) const; ///< nullptr if there is none
    const NodeType* find(std::string_view name) const;
    std::vector<std::string> names() const;

  private:
    std::map<std::string, NodeType, std::less<>> types_;
    std::map<std::type_index, Codec> codecs_;
};

} // namespace sinew::engine
