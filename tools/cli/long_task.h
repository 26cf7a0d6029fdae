// Says what a command is at that takes longer than a second and is no node: a file that is read, a page that is
// written.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <iosfwd>
#include <mutex>
#include <string>
#include <thread>

namespace sinew::cli {

class LongTask {
  public:
    /// \param what is said after a second, for example "reading arm.json"
    /// \param is_quiet say nothing
    LongTask(std::ostream& err, std::string what, bool is_quiet);
    LongTask(const LongTask&) = delete;

  private:
    std::mutex mutex_;
    std::condition_variable_any over_;
    std::jthread watcher_; ///< last: it ends before what it reads
};

} // namespace sinew::cli
