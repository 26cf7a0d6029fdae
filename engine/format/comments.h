// Whom a comment of a graph file belongs to. Graphs are written anew in their own order, so a comment goes with what
// it stands beside: behind a value on its line with that value, otherwise with what follows, or with what surrounds it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"

#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// Something that a comment can belong to: a key of the file, a node, an input. Anchors nest or are apart.
struct Anchor {
    std::size_t begin = 0, end = 0;                 ///< from its key to the end of its value
    std::size_t kept_from = std::string_view::npos; ///< from here on its text is kept as it is, comments too
    std::string node = {}, input = {};              ///< "" and a key of the file; a node and ""; a node and an input
    std::string include = {};                       ///< the prefix of an include; node and input are empty then
};

/// For each comment of the document the anchor that it belongs to: an index, `end_of_file` behind the document, or
/// `kept` where the text that holds it is kept anyway. `anchors` are in file order.
struct CommentOwner {
    static constexpr int end_of_file = -1, kept = -2;
    int anchor = end_of_file;
    bool at_end = false; ///< of the anchor, behind all that it holds
};
std::vector<CommentOwner> comment_owners(std::string_view text, const std::vector<JsonComment>& comments,
                                         const std::vector<Anchor>& anchors);

/// Whether a file holds comments and beside them blanks alone.
bool is_nothing_but_comments(std::string text, const std::vector<JsonComment>& comments);

} // namespace sinew::engine
