// sinew: parses the command line, runs one command, and turns what it throws into an exit code.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_kernel.h"
#include "solver/linear/blas_memory.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/heap.h"
#include "tools/cli/interrupts.h"
#include "tools/cli/print.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace {

using namespace sinew;
using namespace sinew::cli;

/// For the factors of as many threads as the command shall run on.
struct NoSpace {
    int threads; ///< for which there is room
};

/// OpenBLAS starts a thread for each core when it is loaded, which wait for ever for memory that they cannot have.
/// Nothing here needs them; that it shall not is read before `main`, so the program begins again.
void begin_without_blas_threads(char** words) {
    constexpr const char* name = "OPENBLAS_NUM_THREADS";
    if (!has_limited_space() || getenv(name)) return;
    setenv(name, "1", 1);
    execv("/proc/self/exe", words); // goes on where that cannot be
}

/// Where the library ends the program itself: memory that is refused while a JSON document is let go of, which takes
/// some. Only calls that need none.
[[noreturn]] void end_without_memory() {
    try {
        if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
    } catch (const std::bad_alloc&) {
        constexpr std::string_view text = "sinew: there is not enough memory for this\n";
        if (write(STDERR_FILENO, text.data(), text.size()) < 0) _exit(internal_error);
        _exit(graph_wrong);
    } catch (...) {
    }
    std::abort();
}

/// What oneTBB says where a thread cannot be started; it has no type of its own.
bool is_of_threads(const std::exception& e) { return std::string_view(e.what()).starts_with("pthread_create"); }

/// Where space is limited, room for what the command's threads factorise with, so that none waits for ever.
void check_space(const Command& command, const Arguments& arguments) {
    const bool solves =
        std::any_of(command.flags.begin(), command.flags.end(), [](const Flag& f) { return f.name == "--threads"; });
    if (!solves || !has_limited_space()) return;
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int wanted = arguments.whole_number("--threads", cores, 1, most_threads);
    if (const int had = solver::take_blas_buffers(wanted); had < wanted) throw NoSpace{had};
}

ExitCode tell_no_thread(const std::string& name) {
    std::cerr << name
              << ": a thread could not be started: there is not enough memory for it, or no more are allowed "
                 "(ulimit -u, -v)\n";
    return graph_wrong;
}

ExitCode tell_bug(const std::string& name, const std::exception& e) {
    std::cerr << name << ": internal error: " << e.what() << "\nThis is a bug in Sinew; please report it.\n";
    return internal_error;
}

ExitCode run(const Command& command, const std::vector<std::string>& words, std::stop_token stop) {
    const std::string name = "sinew " + std::string(command.name);
    bool json = false;
    try {
        const Arguments arguments(command, words);
        if (arguments.wants_help()) {
            std::cout << help_text(command);
            return done;
        }
        json = arguments.has("--json");
        check_space(command, arguments);
        return command.run({arguments, std::cout, std::cerr, stop});
    } catch (const UsageError& e) {
        // What is wrong comes last, where one looks.
        std::cerr << "Usage: " << usage_line(command) << name << ": " << e.what() << " `" << name
                  << " --help` says more.\n";
        return wrong_usage;
    } catch (const engine::SolveFailure& e) {
        print_diagnostics(e.diagnostics(), json, std::cout, std::cerr);
        return solve_failed;
    } catch (const engine::Failure& e) {
        print_diagnostics(e.diagnostics(), json, std::cout, std::cerr);
        return graph_wrong;
    } catch (const engine::Cancelled&) {
        tell_cancelled(name, json);
        return cancelled;
    } catch (const NoSpace& e) {
        std::cerr << name
                  << ": there is not enough memory: factors need 129 MB for each thread, and the limit of the "
                     "address space (ulimit -v) leaves no room for that. Raise it"
                  << (e.threads > 0 ? ", or take --threads " + std::to_string(e.threads) : std::string()) << ".\n";
        return graph_wrong;
    } catch (const std::bad_alloc&) {
        std::cerr << name << ": there is not enough memory for this\n";
        return graph_wrong;
    } catch (const std::length_error&) {
        std::cerr << name << ": a size in a file, or one that was asked for, is larger than any memory\n";
        return graph_wrong;
    } catch (const std::system_error& e) {
        if (e.code() != std::errc::resource_unavailable_try_again) return tell_bug(name, e);
        return tell_no_thread(name);
    } catch (const std::exception& e) {
        return is_of_threads(e) ? tell_no_thread(name) : tell_bug(name, e);
    }
}

ExitCode dispatch(std::vector<std::string> words, std::stop_token stop) {
    const std::vector<Command> commands = all_commands();
    if (words.empty()) {
        std::cerr << overview(commands);
        return wrong_usage;
    }
    if (words[0] == "--version") {
        std::cout << "sinew " SINEW_VERSION "\n";
        return done;
    }
    if (words[0] == "help" && words.size() == 2) words = {words[1], "--help"};
    if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
        std::cout << overview(commands);
        return done;
    }
    std::vector<std::string> names;
    for (const Command& c : commands) {
        if (c.name == words[0]) return run(c, {words.begin() + 1, words.end()}, stop);
        names.emplace_back(c.name);
    }
    std::cerr << "sinew: unknown command '" << words[0] << "'." << did_you_mean(words[0], names)
              << "\n`sinew --help` lists the commands.\n";
    return wrong_usage;
}

} // namespace

int main(int count, char** words) {
    std::set_terminate(end_without_memory);
    begin_without_blas_threads(words);
    set_up_heap();
    solver::choose_blas_kernel();
    const Interrupts interrupts;
    const ExitCode code = dispatch({words + 1, words + count}, interrupts.token());
    // A full disk behind a redirection must not pass for success, nor in silence.
    std::cout.flush();
    if (std::cout) return code;
    // The stream does not keep the reason; the next byte meets it again.
    const bool is_known = write(STDOUT_FILENO, "\n", 1) < 0;
    std::cerr << "sinew: the output could not be written" << (is_known ? std::string(": ") + std::strerror(errno) : "")
              << "\n";
    return code == done ? graph_wrong : code;
}
