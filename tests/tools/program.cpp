// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <csignal>
#include <fcntl.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace sinew::test {

using nlohmann::json;

Program::Program(const std::vector<std::string>& words) {
    std::vector<std::string> all{SINEW_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    std::vector<char*> argv;
    for (std::string& word : all) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork failed");
    if (pid_ > 0) return;
    dup2(open(out.c_str(), O_CREAT | O_WRONLY, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_CREAT | O_WRONLY, 0600), STDERR_FILENO);
    setenv("SINEW_KEEP_FRAMES", "off", 1); // tests that want them say --cache; no others leave files beside graphs
    execv(argv[0], argv.data());
    _exit(127);
}

Program::~Program() {
    if (pid_ == 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
}

void Program::signal(int number) const { kill(pid_, number); }

int Program::exit_code() {
    if (pid_ == 0) return code_;
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1 - WTERMSIG(status);
}

std::vector<json> Said::lines() const {
    std::vector<json> out_lines;
    std::istringstream in(out);
    for (std::string line; std::getline(in, line);) out_lines.push_back(json::parse(line));
    return out_lines;
}

std::string Said::beside_work() const {
    std::string beside;
    std::istringstream in(err);
    for (std::string line; std::getline(in, line);)
        if (!line.starts_with("computing ") && !line.starts_with("looking ") && !line.starts_with("reading "))
            beside += line + "\n";
    return beside;
}

Said run_program(const std::vector<std::string>& words) {
    Program program(words);
    const int code = program.exit_code();
    return {code, program.out(), program.err()};
}

json small_graph() {
    return json::parse(R"({
  "format": "sinew 1",
  "timing": { "fps": 24, "start": 1, "end": 6 },
  "nodes": {
    "blockMesh": { "type": "polyCube", "inputs": { "width": 4, "height": 8, "depth": 4, "subdivisionsWidth": 2, "subdivisionsHeight": 4, "subdivisionsDepth": 2 } },
    "top": { "type": "weights", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "mode": "ramp", "axis": "y", "start": 3, "end": 4 } },
    "bottom": { "type": "weights", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "mode": "ramp", "axis": "y", "start": -3, "end": -4 } },
    "flesh": { "type": "zMaterial", "inputs": { "youngsModulus": { "value": 20, "unit": "kPa" } } },
    "block": { "type": "zTissue", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "materials": [ { "from": "flesh.outMaterial" } ] } },
    "plateMesh": { "type": "polyCube", "inputs": { "width": 6, "height": 1, "depth": 6 } },
    "lowerMove": { "type": "transform", "inputs": { "translate": [0, -4.5, 0] } },
    "lower": { "type": "zBone", "inputs": { "mesh": { "from": "plateMesh.outMesh" }, "matrix": { "from": "lowerMove.outMatrix" } } },
    "upperMove": { "type": "transform", "inputs": { "translate": { "keys": [[1, [0, 4.5, 0]], [6, [0.5, 4.7, 0]]] }, "rotate": { "keys": [[1, [0, 0, 0]], [6, [0, 20, 0]]] } } },
    "upper": { "type": "zBone", "inputs": { "mesh": { "from": "plateMesh.outMesh" }, "matrix": { "from": "upperMove.outMatrix" } } },
    "holdTop": { "type": "zAttachment", "inputs": { "source": { "from": "block.outBody" }, "target": { "from": "upper.outBody" }, "weights": { "from": "top.outWeights" } } },
    "holdBottom": { "type": "zAttachment", "inputs": { "source": { "from": "block.outBody" }, "target": { "from": "lower.outBody" }, "weights": { "from": "bottom.outWeights" } } },
    "solver": { "type": "zSolver", "inputs": {
      "bodies": [ { "from": "lower.outBody" }, { "from": "upper.outBody" }, { "from": "block.outBody" } ],
      "attachments": [ { "from": "holdTop.outAttachment" }, { "from": "holdBottom.outAttachment" } ] } }
  }
})");
}

std::string write_graph(const TemporaryFolder& folder, const json& graph, const std::string& name) {
    write_text(folder / name, graph.dump(1));
    return (folder / name).string();
}

} // namespace sinew::test
