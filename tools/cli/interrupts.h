// Ctrl-C and SIGTERM: the first one asks the running command to stop at the next safe place, the second one
// ends the program at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <semaphore.h>
#include <signal.h>
#include <stop_token>
#include <thread>

namespace sinew::cli {

/// One at a time: it owns the process's handlers for the two signals while it lives.
class Interrupts {
  public:
    Interrupts();
    ~Interrupts();
    Interrupts(const Interrupts&) = delete;
    std::stop_token token() const { return stop_.get_token(); }

  private:
    std::stop_source stop_;
    std::atomic<bool> over_ = false;
    sem_t wake_{};
    struct sigaction interrupt_before_ {
    }, terminate_before_{};
    std::thread waiter_;
};

} // namespace sinew::cli
