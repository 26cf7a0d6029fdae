// What happens between an interrupt and the end: a word where nothing looks for it, and the way out.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/departure.h"
#include "tools/cli/interrupts.h"

#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

using namespace sinew::test;

namespace {

/// Whether it is the program by now, and has a handler for interrupts; before, one would end it.
bool listens(pid_t process) {
    const std::string of_it = "/proc/" + std::to_string(process);
    std::error_code error; // at first it is a copy of the tests, with their handlers
    if (!std::filesystem::equivalent(of_it + "/exe", SINEW_PROGRAM, error)) return false;
    const std::string status = read_text(of_it + "/status");
    const std::size_t at = status.find("SigCgt:");
    return at != std::string::npos && (std::stoull(status.substr(at + 7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
}

} // namespace

TEST_CASE("an interrupt without effect says after two seconds how to end at once", "[tools]") {
    const TemporaryFolder folder;
    const std::string said = (folder / "said").string();
    const int terminal = dup(STDERR_FILENO), file = open(said.c_str(), O_CREAT | O_WRONLY, 0600);
    REQUIRE((terminal >= 0 && file >= 0));
    dup2(file, STDERR_FILENO);
    close(file);
    bool asked = false;
    {
        sinew::cli::Interrupts interrupts; // and nobody looks at its token
        std::raise(SIGINT);
        for (int i = 0; i < 1000 && read_text(said).empty(); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        asked = interrupts.token().stop_requested();
    }
    dup2(terminal, STDERR_FILENO);
    close(terminal);
    CHECK(asked);
    CHECK(read_text(said) ==
          "sinew: stopping as soon as what is being computed allows; interrupt once more to end at once\n");
}

TEST_CASE("where nothing looks for an interrupt, what is finished is closed, and the program ends", "[tools]") {
    const TemporaryFolder folder;
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        sinew::cli::Interrupts interrupts;
        int frames = 0;
        sinew::cli::Departure departure(interrupts.token(), "sinew run", false);
        departure.closes_by([&] { write_text(folder / "kept", std::to_string(frames)); });
        {
            const auto here = departure.hold();
            std::raise(SIGINT);
            for (; frames < 1000; ++frames) std::this_thread::sleep_for(std::chrono::microseconds(500));
        }
        for (;;) pause(); // what is computed comes to no safe place
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 4);
    CHECK(read_text(folder / "kept") == "1000"); // and not while somebody changed it
}

TEST_CASE("what has been closed is not closed again, and ends by itself", "[tools]") {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        sinew::cli::Interrupts interrupts;
        sinew::cli::Departure departure(interrupts.token(), "sinew run", false);
        departure.closes_by([] { _exit(77); });
        departure.forbid();
        std::raise(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        _exit(interrupts.token().stop_requested() ? 0 : 78);
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
}

TEST_CASE("a library that sets a handler for SIGTERM by the function that METIS takes does not get it", "[tools]") {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        sinew::cli::Interrupts interrupts;
        __sysv_signal(SIGTERM, [](int) { _exit(77); });
        __sysv_signal(SIGUSR1, [](int) { _exit(0); });
        std::raise(SIGTERM);
        for (int i = 0; i < 1000 && !interrupts.token().stop_requested(); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        if (interrupts.token().stop_requested()) std::raise(SIGUSR1); // which it does get
        _exit(78);
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
}

TEST_CASE("every command that reads a graph ends while a large one is read", "[tools]") {
    const TemporaryFolder folder;
    std::string text = R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 100000}, "nodes": {)";
    for (int i = 0; i < 150000; ++i)
        text += "\"m" + std::to_string(i) + R"(": {"type": "polyCube", "inputs": {"width": 2}},)";
    write_text(folder / "graph.json", text + R"("s": {"type": "zSolver"}}})");
    const std::string graph = (folder / "graph.json").string(), said = (folder / "said").string();
    const std::vector<std::vector<std::string>> commands = {{"run", graph},
                                                            {"live", graph},
                                                            {"check", graph},
                                                            {"diff", graph, graph},
                                                            {"fmt", graph},
                                                            {"graph", graph, "--svg", (folder / "graph.svg").string()},
                                                            {"view", graph, "-o", (folder / "v.html").string()},
                                                            {"snapshot", graph, "-o", (folder / "s.png").string()}};
    for (std::vector<std::string> command : commands) {
        CAPTURE(command);
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            dup2(open(said.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDERR_FILENO);
            std::vector<char*> words{const_cast<char*>(SINEW_PROGRAM)};
            for (std::string& word : command) words.push_back(word.data());
            words.push_back(nullptr);
            execv(SINEW_PROGRAM, words.data());
            _exit(127);
        }
        for (int i = 0; i < 5000 && !listens(child); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        kill(child, command.front() == "run" ? SIGTERM : SIGINT);
        int status = 0;
        waitpid(child, &status, 0);
        REQUIRE(WIFEXITED(status));
        CHECK(WEXITSTATUS(status) == 4);
        CHECK(read_text(said).ends_with("cancelled\n"));
    }
}

TEST_CASE("what waits for an output that nobody takes ends when it is told to", "[tools]") {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    REQUIRE(fcntl(ends[1], F_SETPIPE_SZ, 4096) > 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
        const std::string graph = SINEW_SOURCE_DIR "/graphs/learn/01_hanging_ball.json";
        execl(SINEW_PROGRAM, SINEW_PROGRAM, "run", graph.c_str(), "--frames", "1-100000", "--json", "--no-cache",
              static_cast<char*>(nullptr));
        _exit(127);
    }
    // Until the pipe is full.
    pollfd room{ends[1], POLLOUT, 0};
    for (int i = 0; i < 30000 && poll(&room, 1, 0) > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    REQUIRE(poll(&room, 1, 0) == 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(child, SIGTERM);
    int status = 0;
    pid_t ended = 0;
    for (int i = 0; i < 30000 && ended == 0; ++i) {
        ended = waitpid(child, &status, WNOHANG);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (ended == 0) kill(child, SIGKILL), waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 4);
    close(ends[0]), close(ends[1]);
}

TEST_CASE("a second interrupt ends at once", "[tools]") {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        sinew::cli::Interrupts interrupts;
        std::raise(SIGTERM);
        std::raise(SIGINT);
        _exit(77); // not reached
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 4);
}
