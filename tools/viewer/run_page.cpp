// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/run_page.h"

#include "tools/cli/atomic_file.h"
#include "tools/viewer/page.h"
#include "tools/viewer/read_report.h"

namespace sinew::viewer {

std::filesystem::path write_run_page(const std::filesystem::path& folder, ViewScene scene, const cli::RunReport& report,
                                     const engine::FileAccess& files) {
    // Times are those of the run, not of looking up what it has just computed.
    if (report.error) scene.notes.insert(scene.notes.begin(), {true, ended_early(*report.error)});
    for (std::size_t i = 0; i < scene.frames.size(); ++i) {
        scene.frames[i].wall_s = report.frames[i].wall_s;
        scene.frames[i].reused = report.frames[i].reused;
    }
    const std::filesystem::path file = std::filesystem::absolute(folder / "view.html");
    cli::write_file(file, write_page(std::move(scene)).html, files);
    return file;
}

} // namespace sinew::viewer
