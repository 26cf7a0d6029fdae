// Runs the built program as a user would, and keeps what it said.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/tools/temporary_folder.h"

#include <nlohmann/json.hpp>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sinew::test {

/// A running program; its output goes into files of a folder of its own.
class Program {
  public:
    explicit Program(const std::vector<std::string>& words);
    ~Program();
    Program(const Program&) = delete;
    void signal(int number) const;
    /// Waits for the end; -1 - signal if one ended it.
    int exit_code();
    std::string out() const { return read_text(folder_ / "out"); }
    std::string err() const { return read_text(folder_ / "err"); }

  private:
    TemporaryFolder folder_;
    pid_t pid_ = 0;
    int code_ = 0;
};

struct Said {
    int code = 0;
    std::string out, err;
    /// One JSON object for each line of `out`.
    std::vector<nlohmann::json> lines() const;
    /// What `err` says besides what takes longer than a second, which hangs on the machine.
    std::string beside_work() const;
};

Said run_program(const std::vector<std::string>& words);

/// A soft block between two plates, one of which moves: 3 bodies, frames 1 to 6, boxes of quads.
nlohmann::json small_graph();
/// Writes it into the folder and returns the path.
std::string write_graph(const TemporaryFolder& folder, const nlohmann::json& graph,
                        const std::string& name = "small.json");

} // namespace sinew::test
