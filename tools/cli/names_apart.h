// What bodies of several nodes are called where each needs a name of its own: files of a run, and bodies of a page.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace sinew::cli {

/// Names of one node's bodies, apart from those of other nodes: one that is taken is preceded by the node's own, and
/// numbered where that is taken, too. Names that are free come first, so that no other is called like one of them.
/// \param takes(name, i): whether it is body i's from now on, or was already
template <class Takes>
void tell_apart(std::vector<std::string>& names, const std::string& node, const Takes& takes) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (!takes(names[i], i)) others.push_back(i);
    for (const std::size_t i : others) {
        const std::string base = names[i] = node + "_" + names[i];
        for (int number = 2; !takes(names[i], i); ++number) names[i] = base + "_" + std::to_string(number);
    }
}

} // namespace sinew::cli
