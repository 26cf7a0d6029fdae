// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/movie.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sinew::render {

namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

/// Runs a program whose words for people go into `log`. Its wait status, or nothing if `stop` ended it.
std::optional<int> run(std::vector<std::string> words, const fs::path& log, const std::stop_token& stop) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, log.c_str(), O_CREAT | O_WRONLY, 0600);
    pid_t pid = 0;
    const int error = posix_spawn(&pid, argv[0], &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw MovieError(words[0] + " does not start: " + std::strerror(error));
    bool stopped = false;
    for (int status = 0;;) {
        if (waitpid(pid, &status, WNOHANG) == pid)
            return stopped || stop.stop_requested() ? std::nullopt : std::optional(status);
        if (stop.stop_requested() && !stopped) stopped = kill(pid, SIGKILL) == 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

} // namespace

std::optional<fs::path> find_ffmpeg() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path program = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
        std::error_code ignored;
        if (fs::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0) return program;
    }
    return {};
}

Movie::Movie() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "sinew-movie-XXXXXX").string();
    if (error || !mkdtemp(name.data()))
        throw MovieError("there is no folder for temporary files; set TMPDIR to one that can be written.");
    folder_ = name;
}

Movie::~Movie() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void Movie::add(const Image& picture) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%04d.png", ++count_);
    std::ofstream out(folder_ / name, std::ios::binary);
    out << encode_png(picture);
    out.close();
    if (!out) throw MovieError("cannot write to " + folder_.string() + "; is the disk full?");
}

std::string Movie::encode(const fs::path& ffmpeg, double fps, std::stop_token stop) const {
    std::ostringstream rate;
    rate << fps;
    const fs::path file = folder_ / "movie.mp4", log = folder_ / "log";
    const auto status = run({ffmpeg.string(), "-nostdin", "-loglevel", "error", "-framerate", rate.str(), "-i",
                             (folder_ / "frame_%04d.png").string(), "-c:v", "libx264", "-pix_fmt", "yuv420p",
                             "-movflags", "+faststart", file.string()},
                            log, stop);
    if (!status) return {};
    std::string bytes = text_of(file);
    if (*status != 0 || bytes.empty()) throw MovieError(ffmpeg.string() + " made no movie. It said:\n" + text_of(log));
    return bytes;
}

} // namespace sinew::render
