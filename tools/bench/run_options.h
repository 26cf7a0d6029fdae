// What every benchmark is told.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

namespace sinew::bench {

struct StudyMemory;

struct RunOptions {
    bool quick = false; ///< small sizes and few levels: seconds instead of minutes
    std::string filter; ///< run only what has these letters in its name; empty = all
    std::stop_token stop;
    std::shared_ptr<StudyMemory> memory;         ///< mesh studies that need not run twice; may be empty
    std::function<void(const std::string&)> say; ///< what is being measured now, for people; may be empty

    void tell(const std::string& text) const {
        if (say) say(text);
    }
    bool wants(const std::string& name) const { return filter.empty() || name.find(filter) != std::string::npos; }
};

} // namespace sinew::bench
