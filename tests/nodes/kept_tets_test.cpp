// zTet.cacheTetMesh: a later session reads what an earlier one made, whatever has happened to the files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;
namespace fs = std::filesystem;

namespace {

std::string tets(const std::string& more = "") {
    return R"("ball": {"type": "polySphere"},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "ball.outMesh"}, "tetSize": 0.5, "cacheTetMesh": true)" +
           more + "}}";
}

/// One process' worth of work: an evaluator that knows only the folder.
struct Visit {
    Counter counter;
    nodes::TetMeshValue tets;
    engine::Digest tets_digest, mesh_digest;
    Visit(const std::string& nodes, const fs::path& folder) {
        engine::StorePolicy policy;
        policy.disk_folder = folder.string();
        engine::Evaluator evaluator(policy, 1, &counter);
        const auto graph = bench::graph(nodes);
        const engine::Value value = evaluator.pull({graph, {"tets", "outTets"}, 1});
        tets = value.as<nodes::TetMeshValue>();
        tets_digest = value.digest();
        mesh_digest = evaluator.pull({graph, {"tets", "outMesh"}, 1}).digest();
    }
    int made() const { return counter.computes.contains("tets") ? counter.computes.at("tets") : 0; }
};

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> out;
    if (fs::exists(folder))
        for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path());
    return out;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST_CASE("a second session meshes nothing and has the same bits", "[nodes][kept]") {
    const Folder folder;
    const fs::path cache = folder.path("cache");
    for (const std::string more : {"", R"(, "element": "quadratic")"}) {
        const Visit first(tets(more), cache), second(tets(more), cache);
        CHECK(first.made() == 1);
        CHECK(second.made() == 0);
        CHECK(second.tets_digest == first.tets_digest);
        CHECK(second.mesh_digest == first.mesh_digest);
        CHECK(second.tets.element == first.tets.element);
        CHECK(second.tets.mesh->vertices == first.tets.mesh->vertices);
        CHECK(second.tets.mesh->tets == first.tets.mesh->tets);
        CHECK(second.tets.mesh->coverage == first.tets.mesh->coverage);
        CHECK(second.tets.mesh->cut == first.tets.mesh->cut);
        CHECK(second.tets.mesh->cut.degree == (more.empty() ? 1 : 4));
        const auto& share = second.tets.mesh->coverage;
        const auto cut = std::count_if(share.begin(), share.end(), [](double c) { return c < 1; });
        CHECK(cut == 408); // of 432 that the surface touches
        CHECK(second.tets.mesh->cut.tets.size() == static_cast<std::size_t>(cut));
        CHECK((first.counter.warnings.empty() && second.counter.warnings.empty()));
    }
    CHECK(files_in(cache).size() == 2);
    CHECK(Visit(tets(R"(, "fillInterior": "SurfaceOnly")"), cache).made() == 1); // other inputs, other tets
}

TEST_CASE("the switch itself changes no key, and off keeps nothing", "[nodes][kept]") {
    const Folder folder;
    const fs::path cache = folder.path("cache");
    std::string off = tets();
    off.replace(off.find("true"), 4, "false");
    const Visit without(off, cache);
    CHECK_FALSE(fs::exists(cache));
    CHECK(Visit(tets(), cache).tets_digest == without.tets_digest);
    Session s(off);
    s.pull("tets", "outTets");
    s.set("tets", "cacheTetMesh", "true");
    s.pull("tets", "outTets");
    CHECK(s.counter.computes["tets"] == 1);
}

TEST_CASE("damaged, cut and foreign files are told and remade", "[nodes][kept]") {
    const Folder folder;
    const fs::path cache = folder.path("cache");
    const Visit first(tets(), cache);
    REQUIRE(files_in(cache).size() == 1);
    const fs::path file = files_in(cache)[0];
    const std::string whole = bytes_of(file);
    std::vector<std::string> wrong{"", "hello", whole.substr(0, 30), whole.substr(0, whole.size() / 2), whole + "x"};
    for (const std::size_t at :
         {std::size_t{3}, std::size_t{20}, std::size_t{40}, std::size_t{50}, whole.size() / 3, whole.size() - 1}) {
        wrong.push_back(whole);
        wrong.back()[at] = static_cast<char>(wrong.back()[at] ^ 1);
    }
    for (std::size_t i = 0; i < wrong.size(); ++i) {
        CAPTURE(i);
        std::ofstream(file, std::ios::binary | std::ios::trunc) << wrong[i];
        const Visit again(tets(), cache);
        CHECK(again.made() == 1);
        CHECK(again.tets_digest == first.tets_digest);
        REQUIRE(again.counter.warnings.size() == 1);
        CHECK(again.counter.warnings[0].code == "IO406");
        CHECK(again.counter.warnings[0].node == "tets");
        CHECK(bytes_of(file) == whole);
    }
}

TEST_CASE("a folder that cannot be written is warned about once, and all goes on", "[nodes][kept]") {
    const Folder folder;
    const std::string in_the_way = folder.write("file", "not a folder"); // holds for root too, unlike permissions
    const Visit visit(
        tets() + R"(, "more": {"type": "zTet", "inputs": {"mesh": {"from": "ball.outMesh"}, "cacheTetMesh": true}})",
        in_the_way);
    CHECK(visit.made() == 1);
    REQUIRE(visit.counter.warnings.size() == 1);
    CHECK(visit.counter.warnings[0].code == "IO407");
    CHECK(visit.counter.warnings[0].message ==
          "nothing is kept on disk: '" + in_the_way + "' is a file, but a folder is needed");
    CHECK(bytes_of(in_the_way) == "not a folder");
}
