// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/comments.h"

#include <algorithm>

namespace sinew::engine {

namespace {

/// For each anchor the one around it, -1 for none.
std::vector<int> parents(const std::vector<Anchor>& anchors) {
    std::vector<int> out, open;
    for (const Anchor& a : anchors) {
        while (!open.empty() && anchors[static_cast<std::size_t>(open.back())].end <= a.begin) open.pop_back();
        out.push_back(open.empty() ? -1 : open.back());
        open.push_back(static_cast<int>(out.size()) - 1);
    }
    return out;
}

} // namespace

std::vector<CommentOwner> comment_owners(std::string_view text, const std::vector<JsonComment>& comments,
                                         const std::vector<Anchor>& anchors) {
    const std::vector<int> parent = parents(anchors);
    const auto at = [&](int i) -> const Anchor& { return anchors[static_cast<std::size_t>(i)]; };
    std::vector<CommentOwner> out;
    int line_of = -1; // the anchor whose line's end is known
    std::size_t line_end = 0;
    for (const JsonComment& c : comments) {
        const auto next = std::upper_bound(anchors.begin(), anchors.end(), c.begin,
                                           [](std::size_t place, const Anchor& a) { return place < a.begin; });
        int before = -1, around = static_cast<int>(next - anchors.begin()) - 1;
        for (; around >= 0 && at(around).end <= c.begin; around = parent[static_cast<std::size_t>(around)])
            before = around;
        if (around >= 0 && c.begin >= at(around).kept_from) {
            out.push_back({CommentOwner::kept});
            continue;
        }
        if (before >= 0 && before != line_of)
            line_of = before, line_end = std::min(text.find('\n', at(before).end), text.size());
        if (before >= 0 && c.begin < line_end)
            out.push_back({before});
        else if (next != anchors.end() && (around < 0 || next->begin < at(around).end))
            out.push_back({static_cast<int>(next - anchors.begin())});
        else
            out.push_back({around, true});
    }
    return out;
}

bool is_nothing_but_comments(std::string text, const std::vector<JsonComment>& comments) {
    for (const JsonComment& c : comments)
        std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(c.begin), c.end - c.begin, ' ');
    return !comments.empty() && text.find_first_not_of("\xEF\xBB\xBF \t\r\n") == std::string::npos;
}

} // namespace sinew::engine
