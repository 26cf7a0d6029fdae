// Pictures and movies from the viewer's scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/render/movie.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/shot.h"

#include <catch2/catch.hpp>
#include <cstdlib>

using namespace sinew;
using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Another PATH for the programs that a test starts.
class Path {
  public:
    explicit Path(const std::string& path)
        : before_(std::getenv("PATH")) {
        setenv("PATH", path.c_str(), 1);
    }
    ~Path() { setenv("PATH", before_.c_str(), 1); }
    Path(const Path&) = delete;

  private:
    std::string before_;
};

void write_program(const fs::path& file, const std::string& text) {
    write_text(file, "#!/bin/sh\n" + text);
    fs::permissions(file, fs::perms::owner_all);
}

} // namespace

TEST_CASE("where nothing is, a picture and a page say that a folder or a graph is meant", "[tools]") {
    const TemporaryFolder folder;
    const std::string out = folder / "nothing", graph = write_graph(folder, small_graph());
    const std::string told = out +
                             ": error [IO401] there is neither a folder of a run nor a graph file of this name\n  "
                             "hint: ";
    for (const char* command : {"snapshot", "view"}) {
        const Said said = run_program({command, out, "-o", folder / "p"});
        CHECK(said.code == 1);
        CHECK(said.err == told + "`sinew run GRAPH.json --out " + out + "` makes such a folder\n");
    }
    CHECK(run_program({"view", graph, "--against", out, "-o", folder / "p"}).err ==
          told + "`sinew run GRAPH.json --out " + out + "` makes such a folder\n");
    write_text(out + "s.json", "{}");
    CHECK(run_program({"snapshot", out, "-o", folder / "p"}).err == told + "did you mean \"" + out + "s.json\"?\n");
    // Where files are confined, nothing is said of what is elsewhere.
    CHECK(has(run_program({"snapshot", "/nowhere", "--root", folder.path(), "-o", folder / "p"}).err, "IO410"));
}

TEST_CASE("a shot has the viewer's bodies where the viewer has them", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), out = (folder / "out").string();
    REQUIRE(run_program({"run", graph, "--out", out, "--format", "obj"}).code == 0);
    const viewer::ViewScene scene = viewer::collect_folder(out, {1, 6});
    CHECK(scene.frames.size() == 2);
    for (const viewer::ViewNote& note : scene.notes) CHECK_FALSE(note.is_warning);
    const render::Shot shot = viewer::shot_of(scene, 1);
    CHECK(shot.label == "frame 6");
    REQUIRE(shot.surfaces.size() == 3);
    for (std::size_t b = 0; b < 3; ++b) {
        const viewer::ViewBody& body = scene.bodies[b];
        const render::Surface& surface = shot.surfaces[b];
        CHECK(surface.look.colour == body.look.colour);
        CHECK(surface.triangles == body.triangles);
        CHECK(surface.normals.size() == surface.points.size());
        REQUIRE_FALSE(body.shading.empty()); // boxes have sharp edges
        for (std::size_t i = 0; i < surface.points.size(); ++i) {
            const auto p = viewer::vertex_position(body, 1, static_cast<std::size_t>(body.shading[i]));
            for (int c = 0; c < 3; ++c)
                CHECK(surface.points[i][c] == static_cast<double>(p[static_cast<std::size_t>(c)]));
        }
    }
}

TEST_CASE("a snapshot of a run that fails on the way fails as the run does, and leaves no file", "[tools]") {
    const TemporaryFolder folder;
    nlohmann::json graph = small_graph();
    // A tissue's mesh must not move; this one does at frame 3 (FE211).
    graph["nodes"]["drift"] = nlohmann::json::parse(
        R"({ "type": "transform", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "translate": { "keys": [[2, [0, 0, 0]], [3, [1, 0, 0]]] } } })");
    graph["nodes"]["block"]["inputs"]["mesh"]["from"] = "drift.outMesh";
    const std::string png = (folder / "p.png").string(), file = write_graph(folder, graph);
    const Said said = run_program({"snapshot", file, "--frames", "1,4", "-o", png});
    CHECK(said.code != 0);
    CHECK(has(said.err, "FE211"));
    CHECK_FALSE(fs::exists(png));
    // A body that there is not is told before anything is simulated.
    const Said nobody = run_program({"snapshot", file, "--frames", "1,4", "--bodies", "bloc", "-o", png});
    CHECK(nobody.code == 2);
    CHECK(has(nobody.err, "--bodies: there is no body 'bloc'. Did you mean 'block'?"));
    CHECK_FALSE(has(nobody.err, "FE211"));
}

TEST_CASE("a snapshot draws the bodies that are picked and fills the picture with those in focus", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), png = (folder / "p.png").string();
    const auto picture = [&](std::vector<std::string> words) {
        words.insert(words.begin(),
                     {"snapshot", graph, "--frames", "4", "--size", "96x64", "--smooth", "1", "-o", png});
        REQUIRE(run_program(words).code == 0);
        return read_text(png);
    };
    const std::string all = picture({}), block = picture({"--bodies", "block"}), focus = picture({"--focus", "block"});
    CHECK(picture({"--bodies", "lower,upper,block"}) == all);
    CHECK(picture({"--focus", "block,lower,upper"}) == all);
    CHECK(picture({"--bodies", "block", "--focus", "block"}) == block);
    CHECK(block != all);
    CHECK(focus != all);
    CHECK(focus != block); // the plates are still there
    CHECK(picture({"--bodies", "block", "--overlays", "attachments"}) ==
          picture({"--bodies", "block", "--overlays", "marks"}));
    const Said wrong = run_program({"snapshot", graph, "--frames", "1", "--bodies", "blok", "-o", png});
    CHECK(wrong.code == 2);
    CHECK(has(wrong.err, "--bodies: there is no body 'blok'. Did you mean 'block'?"));
    CHECK(has(run_program({"snapshot", graph, "--frames", "1", "--focus", "femur", "-o", png}).err,
              "Bodies: lower, upper or block."));
}

TEST_CASE("the camera makes room for what is framed alone", "[tools]") {
    const auto cube_at = [](double x) {
        render::Surface s;
        s.points = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}};
        s.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        s.normals.assign(4, solver::Vec3(0.6, 0, 0.8));
        return s;
    };
    // Pixels of the first one, which is red.
    const auto red = [](const std::vector<render::Surface>& surfaces) {
        int count = 0;
        for (const auto& [r, g, b] :
             render::contact_sheet({render::Shot{"frame 1", surfaces}}, render::View{}, 180, 120, 1).pixels)
            count += r > 60 && r > 2 * g && r > 2 * b;
        return count;
    };
    render::Surface one = cube_at(0), far = cube_at(30);
    one.look = {Eigen::Vector3f(0.7f, 0.02f, 0.02f), 0, 0};
    far.look = {Eigen::Vector3f(0.4f, 0.4f, 0.4f), 0, 0};
    const int alone = red({one}), both = red({one, far});
    REQUIRE(alone > 1000);
    CHECK(both < alone / 20);
    far.is_framed = false;
    CHECK(red({one, far}) == Approx(alone).epsilon(0.02));
    one.is_framed = false; // nothing is framed: all are
    CHECK(red({one, far}) == both);
}

TEST_CASE("what is wrong with a movie's words is said before anything is computed", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), mp4 = (folder / "m.mp4").string();
    const auto refused = [&](std::vector<std::string> words, const std::string& why) {
        words.insert(words.begin(), {"snapshot", graph});
        const Said said = run_program(words);
        CHECK(said.code == 2);
        CHECK(has(said.err, why));
    };
    refused({"--movie", mp4, "--size", "321x160"}, "322x160");
    refused({"--movie", (folder / "m.gif").string()}, "ends in .mp4");
    refused({"--movie", mp4, "-o", "p.png"}, "--output is for pictures");
    refused({"--fps", "12"}, "--fps is for --movie");
    const Path nothing(folder.path().string());
    refused({"--movie", mp4}, "apt install ffmpeg");
    CHECK_FALSE(fs::exists(mp4));
}

TEST_CASE("ffmpeg gets every frame in order, when it fails its words are shown and the old file stays", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), mp4 = (folder / "m.mp4").string();
    fs::create_directory(folder / "bin");
    const Path path((folder / "bin").string() + ":" + std::getenv("PATH"));
    const std::vector<std::string> words{"snapshot", graph,   "--movie",  mp4, "--frames", "3,1-2",
                                         "--size",   "64x32", "--smooth", "1", "--fps",    "12"};
    // In place of ffmpeg: the last word is the movie; it gets the words and the names of the pictures.
    write_program(folder / "bin/ffmpeg", "for last; do :; done\n"
                                         "echo \"$@\" > \"$last\"; ls \"$(dirname \"$last\")\" >> \"$last\"\n");
    REQUIRE(run_program(words).code == 0);
    const std::string got = read_text(mp4);
    CHECK(has(got, "-framerate 12 -i "));
    CHECK(has(got, "-c:v libx264 -pix_fmt yuv420p"));
    CHECK(has(got, "frame_0001.png\nframe_0002.png\nframe_0003.png\n"));
    CHECK_FALSE(has(got, "frame_0004.png"));

    write_program(folder / "bin/ffmpeg", "echo Unknown encoder >&2; exit 1\n");
    const Said failed = run_program(words);
    CHECK(failed.code == 5);
    CHECK(has(failed.err, "Unknown encoder"));
    CHECK(read_text(mp4) == got);
}

TEST_CASE("frames become a movie where ffmpeg exists", "[tools]") {
    if (!render::find_ffmpeg()) {
        WARN("skipped: ffmpeg is not installed (apt install ffmpeg), so no movie is made");
        return;
    }
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), mp4 = (folder / "m.mp4").string();
    const Said said = run_program({"snapshot", graph, "--movie", mp4, "--size", "64x48"});
    CHECK(said.err == "");
    REQUIRE(said.code == 0);
    CHECK(has(said.out, "6 frames at 24 a second"));
    const std::string bytes = read_text(mp4);
    CHECK(bytes.size() > 1000);
    CHECK(bytes.substr(4, 4) == "ftyp");
    CHECK(has(bytes, "avc1"));
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++files;
    CHECK(files == 2); // the graph and the movie
}
