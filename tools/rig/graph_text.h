// Text of a graph file as people write it: comments, blank lines, a node on one line where it fits.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sinew::rig {

/// JSON texts of values.
std::string number(double value);     ///< 6 digits
std::string coordinate(double value); ///< 9 digits, for points that others lie beside
std::string text_of(std::string_view text);
std::string wire(const std::string& node, const std::string& output); ///< {"from": "node.output"}
std::string list(const std::vector<std::string>& items);
std::string vector(const solver::Vec3& v);
/// A smooth curve from `value` 0 at `start` to `value` at `end`.
std::string rise(int start, int end, double value);
/// "12 cm", "0.34", …: three digits, for comments.
std::string rough(double value);

using Inputs = std::vector<std::pair<std::string, std::string>>; ///< names and JSON texts

class GraphText {
  public:
    /// In the order in which they shall stand. Comments are wrapped at the width of the page.
    void comment(const std::string& text);
    void blank();
    void node(const std::string& name, const std::string& type, const Inputs& inputs);
    /// The whole file. `head` is the comment that it begins with; its lines stay lines.
    std::string file(const std::string& head, int start, int end, int fps) const;

  private:
    struct Item {
        std::string text;
        bool is_node = false;
    };
    std::vector<Item> items_;
};

/// The path of `file` as a graph file in `folder` names it.
std::string path_from(const std::string& folder, const std::string& file);

} // namespace sinew::rig
