// The program where its address space is limited (`ulimit -v`).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <sys/wait.h>

using namespace sinew::test;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // which take terabytes of it

namespace {

/// The program within so many MB; ended by force after 30 s of the processor.
Said within(int megabytes, const std::string& words, const TemporaryFolder& folder) {
    const std::string out = (folder / "out").string(), err = (folder / "err").string();
    const int status = std::system(("ulimit -t 30; ulimit -v " + std::to_string(1024 * megabytes) + "; exec " +
                                    SINEW_PROGRAM + " " + words + " >'" + out + "' 2>'" + err + "'")
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_text(out), read_text(err)};
}

} // namespace

TEST_CASE("where memory is tight the program says so and does not wait for it", "[tools]") {
    const TemporaryFolder folder;
    const std::string run = "run '" + write_graph(folder, small_graph()) + "' --no-cache --frames 1-2 --threads ";
    for (const int megabytes : {130, 180}) {
        CAPTURE(megabytes);
        const Said said = within(megabytes, run + "1", folder);
        CHECK(said.code == 1);
        CHECK(said.err.find("not enough memory") != std::string::npos);
        CHECK(said.err.find("bug") == std::string::npos);
    }
    // Between too little and enough: whatever it is that cannot be had.
    for (int megabytes = 190; megabytes <= 260; megabytes += 5) {
        CAPTURE(megabytes);
        const Said said = within(megabytes, run + "1", folder);
        CHECK((said.code == 0 || said.code == 1 || said.code == 3));
        CHECK((said.code == 0 || said.err.find("memory") != std::string::npos));
    }
    // A long list in the file: it is read and let go of in whatever room there is.
    nlohmann::json long_list = small_graph();
    long_list["nodes"]["flesh"]["inputs"]["weights"] = std::vector<double>(1000000, 0.5);
    const std::string check = "check '" + write_graph(folder, long_list, "long.json") + "' --threads 1";
    for (int megabytes = 200; megabytes <= 440; megabytes += 16) {
        CAPTURE(megabytes);
        const Said said = within(megabytes, check, folder);
        CHECK(said.code == 1); // either there is no room for it, or it is of another mesh
        CHECK((said.err.find("not enough memory") != std::string::npos || said.err.find("FE204") != std::string::npos));
    }
    // Room for one thread's buffer and not for eight; and what solves nothing needs none.
    CHECK(within(700, run + "1", folder).code == 0);
    const Said eight = within(700, run + "8", folder);
    CHECK(eight.code == 1);
    // It says how many there is room for.
    const std::size_t at = eight.err.find("or take --threads ");
    REQUIRE(at != std::string::npos);
    const std::string fewer = eight.err.substr(at + 18, eight.err.find('.', at) - at - 18);
    CHECK((std::stoi(fewer) >= 1 && std::stoi(fewer) < 8));
    CHECK(within(130, run + "1", folder).err.find("--threads") == std::string::npos);
    CHECK(within(130, "nodes zBone", folder).code == 0);
}

#endif
