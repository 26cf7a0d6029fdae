// A stop token runs callbacks, which a signal handler must not do. So the handler only wakes a thread that
// does it. Waiting for blocked signals would need no handler, but libraries start threads before main() that
// do not block them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/interrupts.h"

#include "tools/cli/exit_code.h"

#include <cerrno>
#include <ctime>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

// METIS, which orders matrices for CHOLMOD, sets a handler for SIGTERM in each call (by this function of the C
// library), which jumps to where the call began: from another thread into a stack that is not its own. So SIGTERM stays
// with us; what METIS wants of other signals it gets. The program must export this (tools/CMakeLists.txt).
extern "C" __sighandler_t __sysv_signal(int number, __sighandler_t handler) noexcept {
    struct sigaction before {
    }, action{};
    action.sa_handler = handler;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    if (sigaction(number, number == SIGTERM ? nullptr : &action, &before) != 0) return SIG_ERR;
    return before.sa_handler;
}

namespace sinew::cli {

namespace {

// A handler gets nothing but the number of its signal; this is its only way to the object.
std::atomic<sem_t*> wake_waiter{nullptr};
std::atomic<bool> has_asked{false};
static_assert(std::atomic<sem_t*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// What may pass between a first interrupt and its effect without a word [s].
constexpr int patience_seconds = 2;

void on_signal(int) {
    if (has_asked.exchange(true)) _exit(cancelled); // files that are being written have no name yet
    if (sem_t* wake = wake_waiter.load()) sem_post(wake);
}

} // namespace

Interrupts::Interrupts() {
    if (wake_waiter.load()) throw std::logic_error("two Interrupts at once");
    sem_init(&wake_, 0, 0);
    wake_waiter = &wake_;
    waiter_ = std::thread([this] {
        while (sem_wait(&wake_) != 0) {
        } // EINTR
        if (over_) return;
        stop_.request_stop();
        // Where nothing looks at the token for a while (a large factor, a library's call) people shall know what to do.
        timespec until{};
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_sec += patience_seconds;
        while (sem_timedwait(&wake_, &until) != 0 && errno == EINTR) {
        }
        constexpr std::string_view text = "sinew: stopping as soon as what is being computed allows; "
                                          "interrupt once more to end at once\n";
        if (!over_ && write(STDERR_FILENO, text.data(), text.size()) < 0) {
        } // nobody reads
    });
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &interrupt_before_);
    sigaction(SIGTERM, &action, &terminate_before_);
}

Interrupts::~Interrupts() {
    sigaction(SIGINT, &interrupt_before_, nullptr);
    sigaction(SIGTERM, &terminate_before_, nullptr);
    over_ = true;
    wake_waiter = nullptr;
    sem_post(&wake_);
    waiter_.join();
    sem_destroy(&wake_);
    has_asked = false;
}

} // namespace sinew::cli
