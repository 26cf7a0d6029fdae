// How a command that was asked to stop ends while something long is computed that looks at no token (a factor, the
// reading of a large file): another thread puts away what is finished, and the process ends without waiting for the
// rest.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/exit_code.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>

namespace sinew::cli {

/// While it lives, the process ends soon after the token was asked to stop, on the thread that asked. For commands that
/// leave nothing half written: what they write has no name until it is whole (AtomicFile), or they close it.
class Departure {
  public:
    /// \param command what is said to have been cancelled, for example "sinew run"; with `json` also as an event
    /// \param code `cancelled` says so; with another one nothing is said
    Departure(std::stop_token stop, std::string command, bool json, ExitCode code = cancelled);
    /// Does not return once the process is about to end.
    ~Departure();
    Departure(const Departure&) = delete;

    /// `close` puts away what is finished. It is called at most once, by another thread, while nobody has what `hold`
    /// gives.
    void closes_by(std::function<void()> close);
    /// For whoever changes what `close` reads.
    [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }
    /// Everything is put away, or soon will be: the command ends by itself.
    void forbid();

  private:
    void leave();

    std::mutex mutex_;
    std::condition_variable over_;
    bool is_over_ = false;
    const std::string command_;
    const bool json_;
    const ExitCode code_;
    std::function<void()> close_;
    std::stop_callback<std::function<void()>> on_stop_; ///< last: it may be called as soon as it is there
};

/// The last words of a command that was cancelled.
void tell_cancelled(const std::string& command, bool json);

} // namespace sinew::cli
