// `sinew check --meshes`: what it says of good and bad meshes, in graphs and in files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace sinew::test;
using nlohmann::json;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string write(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
    const std::string path = (folder / name).string();
    std::ofstream(path) << text;
    return path;
}

/// A cube of quads, its last `left_out` faces missing.
std::string cube(int left_out, const std::string& more = "") {
    std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    const std::vector<std::string> faces{"1 4 3 2", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"};
    for (std::size_t f = 0; f + static_cast<std::size_t>(left_out) < faces.size(); ++f) text += "f " + faces[f] + "\n";
    return text + more;
}

json only(const Said& said) {
    const auto lines = said.lines();
    REQUIRE(lines.size() == 1);
    return lines.front();
}

} // namespace

TEST_CASE("check of a mesh file counts its flaws and names the first", "[tools]") {
    const TemporaryFolder folder;
    const json good = only(run_program({"check", write(folder, "good.obj", cube(0)), "--json"}));
    CHECK(good.at("closed") == true);
    CHECK(good.at("manifold") == true);
    CHECK(good.at("parts") == 1);
    CHECK(good.at("volume").get<double>() == Approx(1));
    CHECK(good.at("faces") == 6);
    CHECK(good.at("triangles") == 12);
    for (const auto& [name, flaw] : good.at("flaws").items()) {
        INFO(name);
        CHECK(flaw.at("count") == 0);
    }
    CHECK(good.at("flaws").size() == 11);

    const json open = only(run_program({"check", write(folder, "open.obj", cube(1)), "--json"}));
    CHECK(open.at("closed") == false);
    CHECK(open.at("manifold") == true);
    CHECK(open.at("flaws").at("openEdges").at("count") == 4);
    CHECK(open.at("flaws").at("openEdges").at("first") == json::parse("[[0,3],[0,4],[3,7],[4,7]]"));
    CHECK_FALSE(open.contains("volume"));

    // A fin on an edge, a spike through a side, a repeated triangle turned round, a loose vertex, one on
    // another.
    const std::string more =
        "v 3 0 0\nf 1 2 9\nv 0.3 0.4 -1\nv 0.4 0.3 -1\nv 0.3 0.3 0.5\nf 10 11 12\nf 1 3 4\nv 9 9 9\n"
        "v 9 9 9\n";
    const json bad = only(run_program({"check", write(folder, "bad.obj", cube(0, more)), "--json"})).at("flaws");
    CHECK(bad.at("nonManifoldEdges").at("count") == 4); // the fin's, and three of the repeated triangle
    CHECK(bad.at("openEdges").at("count") == 3 + 2);    // the spike's, and the fin's far ones
    CHECK(bad.at("degenerateTriangles").at("first") == json::parse("[12]"));
    CHECK(bad.at("unusedVertices").at("first") == json::parse("[12,13]"));
    CHECK(bad.at("coincidingVertices").at("first") == json::parse("[13]"));
    CHECK(bad.at("duplicateTriangles").at("count") == 1);
    CHECK(bad.at("crossingTriangles").at("count").get<int>() >= 1);
}

TEST_CASE("check of a mesh file as a table", "[tools]") {
    const TemporaryFolder folder;
    const Said open = run_program({"check", write(folder, "open.obj", cube(1))});
    CHECK(open.code == 0);
    CHECK(has(open.out, "4 open edges (0-3, 0-4, 3-7, 4-7)"));
    const Said tets = run_program({"check", write(folder, "one.mesh",
                                                  "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
                                                  "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n")});
    CHECK(has(tets.out, "none; dihedral angles 54.7 to 90.0"));
    const Said broken = run_program({"check", write(folder, "broken.obj", "v 0 0 nothing\n")});
    CHECK(broken.code == 1);
    CHECK(has(broken.err, "IO403"));
    CHECK(has(broken.err, "broken.obj:1"));
    CHECK(run_program({"check", "/nowhere/mesh.obj"}).code == 1);
}

TEST_CASE("check calls closed what the makers of tets and iso meshes take for closed", "[tools]") {
    const TemporaryFolder folder;
    // A tet whose faces have vertices of their own, as STL has them, and one with a face that looks inwards.
    const std::string loose = write(folder, "loose.obj",
                                    "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                    "v 0 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n"),
                      turned = write(folder, "turned.obj",
                                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 4 2\nf 2 3 4\nf 1 4 3\n"),
                      open = write(folder, "open.obj", cube(1));
    for (const auto& [file, closes] : {std::pair{loose, true}, {turned, true}, {open, false}}) {
        INFO(file);
        const json said = only(run_program({"check", file, "--json"}));
        CHECK(said.at("closed") == false);
        CHECK(said.at("closedOnceWelded") == closes);
        CHECK(has(run_program({"check", file}).out, closes ? " welded " : " no "));
        json graph = {{"format", "sinew 1"}};
        graph["nodes"]["file"] = {{"type", "meshFile"}, {"inputs", {{"file", file}}}};
        graph["nodes"]["skin"] = {
            {"type", "zIsoMesh"},
            {"inputs", {{"meshes", {{{"from", "file.outMesh"}}}}, {"resolution", 32}, {"triangleSize", 2}}}};
        graph["nodes"]["tets"] = {{"type", "zTet"}, {"inputs", {{"mesh", {{"from", "file.outMesh"}}}}}};
        const Said checked = run_program({"check", write_graph(folder, graph), "--meshes", "--no-cache"});
        CHECK((checked.code == 0) == closes);
        CHECK(has(checked.err, "FE230") == !closes);
        CHECK(has(checked.err, "FE238") == !closes);
    }
}

TEST_CASE("check --meshes lists the meshes of a graph and warns of features that are off", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    const Said good = run_program({"check", write_graph(folder, graph), "--meshes"});
    CHECK(good.code == 0);
    CHECK(has(good.out, "blockMesh.outMesh"));
    CHECK(has(good.out, "plateMesh.outMesh"));
    CHECK(good.beside_work().empty());
    CHECK_FALSE(has(run_program({"check", write_graph(folder, graph)}).out, "blockMesh.outMesh"));

    graph["nodes"]["blockMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", write(folder, "open.obj", cube(1))}}}};
    const Said warned = run_program({"check", write_graph(folder, graph), "--meshes", "--json"});
    int found = 0;
    for (const json& line : warned.lines())
        if (line.at("event") == "diagnostic" && line.at("code") == "FE238" && line.at("node") == "block") {
            ++found;
            CHECK(line.at("severity") == "warning");
            CHECK(line.at("attribute") == "mesh");
            CHECK(line.at("line").get<int>() > 0);
            CHECK(has(line.at("message"), "4 open edges"));
        }
    CHECK(found == 1);
    const Said both = run_program({"check", write_graph(folder, graph), "--meshes", "--fast"});
    CHECK(both.code == 2);
    CHECK(has(both.err, "--fast"));
}

TEST_CASE("check --meshes warns of each feature that a flaw switches off, and of nothing else", "[tools]") {
    const TemporaryFolder folder;
    const std::string open = write(folder, "open.obj", cube(1)),
                      // A second cube that reaches through a side of the first.
        crossing =
            write(folder, "crossing.obj",
                  cube(0) + "v 0.5 0.3 0.3\nv 1.5 0.3 0.3\nv 1.5 0.7 0.3\nv 0.5 0.7 0.3\nv 0.5 0.3 0.7\nv 1.5 0.3 0.7\n"
                            "v 1.5 0.7 0.7\nv 0.5 0.7 0.7\nf 9 12 11 10\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\n"
                            "f 11 12 16 15\nf 12 9 13 16\n"),
                      whole = write(folder, "whole.obj", cube(0));
    const auto warned = [&](const std::string& file, const std::string& type, const std::string& input, json more) {
        json graph = small_graph();
        graph["nodes"]["file"] = {{"type", "meshFile"}, {"inputs", {{"file", file}}}};
        if (type == "zTissue")
            graph["nodes"]["block"]["inputs"][input] = {{"from", "file.outMesh"}};
        else {
            more[input] = {{"from", "file.outMesh"}};
            graph["nodes"]["x"] = {{"type", type}, {"inputs", more}};
        }
        int found = 0;
        for (const json& line : run_program({"check", write_graph(folder, graph), "--meshes", "--json"}).lines())
            found += line.at("event") == "diagnostic" && line.at("code") == "FE238" && line.at("attribute") == input;
        return found;
    };
    const json cavities = {{"fillInterior", "EmptyCavities"}},
               near = {{"mode", "near"}, {"mesh", {{"from", "blockMesh.outMesh"}}}};
    CHECK(warned(crossing, "zTet", "mesh", cavities) == 1);
    CHECK(warned(crossing, "zTet", "mesh", json::object()) == 0); // parts that cross are one
    CHECK(warned(whole, "zTet", "mesh", cavities) == 0);
    CHECK(warned(open, "zTet", "mesh", json::object()) == 1);
    CHECK(warned(open, "zTissue", "mesh", {}) == 1);
    CHECK(warned(open, "zTissue", "collisionShape", {}) == 1);
    CHECK(warned(whole, "zTissue", "collisionShape", {}) == 0);
    CHECK(warned(open, "weights", "otherMesh", near) == 1);
    CHECK(warned(whole, "weights", "otherMesh", near) == 0);
}

TEST_CASE("check names parts that are inside out, tets that repeat and tets that are flat", "[tools]") {
    const TemporaryFolder folder;
    const auto flaws = [&](const std::string& name, const std::string& text) {
        return only(run_program({"check", write(folder, name, text), "--json"})).at("flaws");
    };
    // Every face the other way round.
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n",
                      turned = "f 2 3 4 1\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n";
    CHECK(flaws("turned.obj", vertices + turned).at("insideOutParts").at("first") == json::parse("[0]"));
    CHECK(
        has(run_program({"check", (folder / "turned.obj").string()}).out, "1 part turned inside out, at triangle (0)"));
    // A large tet beside the cube, and one around it: then the cube may be a cavity.
    const std::string beside = "v 5 0 0\nv 9 0 0\nv 5 4 0\nv 5 0 4\n",
                      tet = "f 9 11 10\nf 9 10 12\nf 9 12 11\nf 10 11 12\n",
                      around = "v -9 -9 -9\nv 90 -9 -9\nv -9 90 -9\nv -9 -9 90\n";
    CHECK(flaws("two.obj", vertices + beside + tet + turned).at("insideOutParts").at("first") == json::parse("[4]"));
    CHECK(flaws("cavity.obj", vertices + around + tet + turned).at("insideOutParts").at("count") == 0);

    const std::string head = "MeshVersionFormatted 1\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
    const std::string flat =
        write(folder, "flat.mesh", head + "0.5 0.5 -1e-3 0\nTetrahedra\n2\n1 2 3 4 0\n1 3 2 5 0\n");
    CHECK(only(run_program({"check", flat, "--json"})).at("flaws").at("flatTets").at("first") == json::parse("[1]"));
    const Said twice = run_program(
        {"check", write(folder, "twice.mesh", head + "1 1 1 0\nTetrahedra\n3\n1 2 3 4 0\n2 3 4 5 0\n4 2 1 3 0\n")});
    CHECK(twice.code == 1);
    CHECK(has(twice.err, "FE221"));
    CHECK(has(twice.err, "tet 2 has the corners of tet 0"));

    json graph = small_graph();
    graph["nodes"]["own"] = {{"type", "tetMeshFile"}, {"inputs", {{"file", flat}}}};
    graph["nodes"]["lattice"] = {{"type", "zTet"}, {"inputs", {{"tets", {{"from", "own.outTets"}}}}}};
    const Said checked = run_program({"check", write_graph(folder, graph), "--meshes"});
    CHECK(has(checked.err, "FE238"));
    CHECK(has(checked.err, "own.outTets has 1 nearly flat tet (1)"));
    CHECK_FALSE(has(checked.out, "unused")); // a border on its tets' vertices leaves out the inner ones
}

TEST_CASE("check takes several files and looks at all of them whatever the first is like", "[tools]") {
    const TemporaryFolder folder;
    const std::string good = write_graph(folder, small_graph());
    std::ofstream(folder / "bad.json") << "{";
    std::ofstream(folder / "a.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string bad = (folder / "bad.json").string(), mesh = (folder / "a.obj").string();
    const Said both = run_program({"check", bad, good, mesh, "--json", "--no-cache"});
    CHECK(both.code == 1);
    const auto lines = both.lines();
    REQUIRE(lines.size() == 3);
    CHECK(lines[0].at("code") == "DG001");
    CHECK(lines[1].at("event") == "checked");
    CHECK(lines[1].at("graph") == good);
    CHECK(lines[2].at("mesh") == mesh);
    CHECK(run_program({"check", good, mesh, "--no-cache"}).code == 0);
    CHECK(run_program({"check", good, good, "--set", "flesh.youngsModulus=1"}).code == 2);
}
