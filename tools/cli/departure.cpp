// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/departure.h"

#include <chrono>
#include <iostream>
#include <poll.h>
#include <thread>
#include <unistd.h>

namespace sinew::cli {

namespace {

/// So long a command has to come to a safe place by itself.
constexpr std::chrono::milliseconds patience{100};
/// So long the output may be full, as a pipe is that nobody reads, before it is given up.
constexpr std::chrono::milliseconds longest_full{2000};

bool output_is_full() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    return poll(&output, 1, 0) == 0;
}

/// Ends the process where all that it waits for is somebody who reads what it has written: whoever writes may hold the
/// lock that the way out needs.
void give_up_full_output(ExitCode code) {
    auto full_for = std::chrono::milliseconds(0);
    while (full_for < longest_full) {
        std::this_thread::sleep_for(patience);
        full_for = output_is_full() ? full_for + patience : std::chrono::milliseconds(0);
    }
    _exit(code);
}

} // namespace

Departure::Departure(std::stop_token stop, std::string command, bool json, ExitCode code)
    : command_(std::move(command))
    , json_(json)
    , code_(code)
    , on_stop_(std::move(stop), [this] { leave(); }) {}

Departure::~Departure() { forbid(); }

void Departure::closes_by(std::function<void()> close) {
    const std::lock_guard lock(mutex_);
    close_ = std::move(close);
}

void Departure::forbid() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    over_.notify_all();
}

void Departure::leave() {
    std::thread(give_up_full_output, code_).detach(); // the process is about to end, one way or another
    std::unique_lock lock(mutex_);
    if (over_.wait_for(lock, patience, [this] { return is_over_; })) return;
    try {
        if (close_) close_();
    } catch (const std::exception& why) {
        std::cerr << command_ << ": " << why.what() << "\n";
    }
    if (code_ == cancelled) tell_cancelled(command_, json_);
    std::cout.flush();
    std::cerr.flush();
    _exit(code_); // with the lock held: nobody changes anything any more
}

void tell_cancelled(const std::string& command, bool json) {
    if (json) std::cout << "{\"event\":\"cancelled\"}\n";
    std::cerr << command << ": cancelled\n";
}

} // namespace sinew::cli
