// What happens between an interrupt and the end: a word where nothing looks for it, and the way out.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/interrupts.h"

#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace sinew::test;

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
