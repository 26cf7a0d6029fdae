// Where nodes and inputs stood in the file that they were read from. Kept as byte offsets; lines and columns
// are counted only when somebody asks, which is when something is wrong.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"

#include <map>
#include <memory>
#include <string>

namespace sinew::engine {

struct SourceText {
    SourceText(std::string file_name, std::string_view content)
        : file(std::move(file_name))
        , text(content)
        , lines(text) {}
    SourceText(const SourceText&) = delete;
    std::string file, text;
    LineIndex lines; ///< views `text`
};

struct NodeOrigin {
    std::shared_ptr<const SourceText> source;
    std::string name;                                       ///< the node's name in the file, whatever it is called now
    std::size_t at = 0;                                     ///< of the node's key
    std::map<std::string, std::size_t, std::less<>> inputs; ///< of each input's value, where the file set one
};

} // namespace sinew::engine
