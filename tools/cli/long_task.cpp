// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/long_task.h"

#include <chrono>
#include <ostream>
#include <system_error>

namespace sinew::cli {

LongTask::LongTask(std::ostream& err, std::string what, bool is_quiet) {
    if (is_quiet) return;
    try {
        watcher_ = std::jthread([this, &err, what = std::move(what)](const std::stop_token& stop) {
            std::unique_lock lock(mutex_);
            over_.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
            if (!stop.stop_requested()) err << what + "\n" << std::flush;
        });
    } catch (const std::system_error&) { // no more threads: then nothing is said
    }
}

} // namespace sinew::cli
