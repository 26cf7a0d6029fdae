// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/departure.h"

#include <chrono>
#include <iostream>
#include <unistd.h>

namespace sinew::cli {

namespace {

/// So long a command has to come to a safe place by itself.
constexpr std::chrono::milliseconds patience{100};

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
