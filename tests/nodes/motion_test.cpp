// Transforms and tracks: Maya's conventions, exact samples, screw motion in between, mapping of time and
// range.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "engine/matrix_between.h"
#include "nodes/matrices.h"
#include "nodes/motion_track.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <numbers>

using namespace bench;
using engine::Matrix4;

namespace {

Eigen::Matrix4d eigen(const Matrix4& m) {
    return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
}

Matrix4 plain(const Eigen::Matrix4d& m) {
    Matrix4 out;
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(out.data()) = m;
    return out;
}

/// Rotation about a hinge: an axis through a point.
Eigen::Matrix4d hinge(const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double degrees) {
    Eigen::Affine3d a = Eigen::Translation3d(point) *
                        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()) *
                        Eigen::Translation3d(-point);
    return a.matrix();
}

double distance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) { return (a - b).cwiseAbs().maxCoeff(); }

std::string one_number_a_frame(const std::vector<double>& values) {
    nlohmann::json frames = nlohmann::json::array();
    for (std::size_t i = 0; i < values.size(); ++i)
        frames.push_back({{"frame", i + 1}, {"angle", values[i]}, {"bones", nlohmann::json::object()}});
    return nlohmann::json{{"frames", frames}}.dump();
}

} // namespace

TEST_CASE("a transform scales, then turns in the named order, then translates", "[nodes]") {
    Session s(
        R"("t": {"type": "transform", "inputs": {"translate": [1, 2, 3], "rotate": [90, 0, 90], "scale": [2, 3, 4]}},
                 "u": {"type": "transform", "inputs": {"translate": [1, 2, 3], "rotate": [90, 0, 90], "scale": [2, 3, 4], "rotateOrder": "zyx"}})");
    // xyz: x first. e_y: scaled to 3, turned about x to z, about z stays z.
    CHECK(s.get<Matrix4>("t", "outMatrix") == Matrix4{0, 0, 4, 1, 2, 0, 0, 2, 0, 3, 0, 3, 0, 0, 0, 1});
    // zyx: z first. e_x: scaled to 2, turned about z to y, about x to z.
    CHECK(s.get<Matrix4>("u", "outMatrix") == Matrix4{0, -3, 0, 1, 0, 0, -4, 2, 2, 0, 0, 3, 0, 0, 0, 1});
}

TEST_CASE("quarter turns leave no dust, whichever way round they are written", "[nodes]") {
    const auto turned = [](double x, double y, double z) {
        return nodes::compose({0, 0, 0}, {x, y, z}, {1, 1, 1}, "xyz", {0, 0, 0});
    };
    const Matrix4 z_90{0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        z_270{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, z_180{-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        x_90{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}, y_90{0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1};
    for (const double degrees : {90.0, 450.0, -270.0}) CHECK(turned(0, 0, degrees) == z_90);
    for (const double degrees : {-90.0, 270.0, 630.0}) CHECK(turned(0, 0, degrees) == z_270);
    for (const double degrees : {180.0, -180.0, 540.0}) CHECK(turned(0, 0, degrees) == z_180);
    for (const double degrees : {360.0, -720.0}) CHECK(turned(degrees, degrees, degrees) == nodes::identity_matrix);
    CHECK(turned(90, 0, 0) == x_90);
    CHECK(turned(0, 90, 0) == y_90);
}

TEST_CASE("a rotation leaves its pivot in place and parents apply last", "[nodes]") {
    Session s(R"("up": {"type": "transform", "inputs": {"translate": [0, 10, 0]}},
                 "t": {"type": "transform", "inputs": {"rotate": [0, 0, 37], "rotatePivot": [4, 5, 6],
                       "offsetParentMatrix": {"from": "up.outMatrix"}}})");
    const Eigen::Vector4d pivot(4, 5, 6, 1);
    CHECK((eigen(s.get<Matrix4>("t", "outMatrix")) * pivot - Eigen::Vector4d(4, 15, 6, 1)).norm() < 1e-14);
}

TEST_CASE("a matrix for row vectors is refused where it is given", "[nodes]") {
    // As Maya writes it: moved by (1, 2, 3).
    const std::string rows = R"([1,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1])";
    std::string text;
    const auto refused = [&](const std::string& nodes, const std::string& node, const std::string& output) {
        return codes(R"("cube": {"type": "polyCube"}, "flesh": {"type": "zMaterial"},
            "t": {"type": "zTissue", "inputs": {"mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}}, )" +
                         nodes,
                     node, output, &text);
    };
    CHECK(refused(R"("m": {"type": "transform", "inputs": {"offsetParentMatrix": )" + rows + "}}", "m", "outMatrix") ==
          Codes{"FE252"});
    CHECK_THAT(text, Catch::Contains("m.offsetParentMatrix") && Catch::Contains("1 2 3 1, not 0 0 0 1"));
    CHECK(refused(R"("b": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}, "matrix": )" + rows + "}}",
                  "b", "outBody") == Codes{"FE252"});
    CHECK_THAT(text, Catch::Contains("b.matrix"));
    CHECK(refused(R"("h": {"type": "zHold", "inputs": {"tissue": {"from": "t.outBody"}, "matrix": )" + rows + "}}", "h",
                  "outForce") == Codes{"FE252"});
    CHECK_THAT(text, Catch::Contains("h.matrix"));
    // What rounding leaves there is none.
    CHECK(
        refused(
            R"("m": {"type": "transform", "inputs": {"offsetParentMatrix": [1,0,0,1, 0,1,0,0, 0,0,1,0, 1e-9,0,0,1]}})",
            "m", "outMatrix")
            .empty());
}

TEST_CASE("an identity transform hands on the very same mesh", "[nodes]") {
    Session s(
        R"("cube": {"type": "polyCube"}, "t": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}}})");
    CHECK(s.pull("cube", "outMesh").digest() == s.pull("t", "outMesh").digest());
}

TEST_CASE("a track gives its samples bit for bit at its frames and stands still beyond them", "[nodes]") {
    nodes::MatrixTrack track;
    for (int f = 1; f <= 5; ++f) {
        track.frames.push_back(f);
        track.matrices.push_back(plain(hinge({1, 2, 3}, {40, 130, 2}, f < 4 ? 7.3 * f : 21.9)));
    }
    for (std::size_t i = 0; i < 5; ++i) CHECK(track.at(track.frames[i]) == track.matrices[i]);
    CHECK(track.at(-3) == track.matrices.front());
    CHECK(track.at(77) == track.matrices.back());
    SECTION("and bit for bit between two equal samples") {
        REQUIRE(track.matrices[3] == track.matrices[4]);
        for (double f : {4.1, 4.5, 4.999}) CHECK(track.at(f) == track.matrices[3]);
    }
}

TEST_CASE("between samples a hinge stays a hinge, however far from the origin", "[nodes]") {
    const Eigen::Vector3d axis(0.3, -0.5, 0.8), point(-44, 139, 0.6);
    nodes::MatrixTrack track{{1, 2}, {plain(hinge(axis, point, 10)), plain(hinge(axis, point, 50))}};
    for (double u : {0.1, 0.25, 0.5, 0.9})
        CHECK(distance(eigen(track.at(1 + u)), hinge(axis, point, 10 + 40 * u)) < 1e-12);
}

TEST_CASE("between samples translation and stretch are linear where nothing turns", "[nodes]") {
    Eigen::Matrix4d a = Eigen::Matrix4d::Identity(), b = a;
    a.col(3).head<3>() = Eigen::Vector3d(1, 2, 3);
    b.col(3).head<3>() = Eigen::Vector3d(5, 2, -3);
    b(0, 0) = 3;
    b(1, 1) = 0.5;
    const nodes::MatrixTrack track{{10, 20}, {plain(a), plain(b)}};
    CHECK(distance(eigen(track.at(12.5)), 0.75 * a + 0.25 * b) < 1e-14);
}

TEST_CASE("between samples half a turn, mirrors and tiny turns are met", "[nodes]") {
    SECTION("half a turn") {
        const nodes::MatrixTrack track{
            {0, 1}, {plain(hinge({0, 0, 1}, {1, 0, 0}, 0)), plain(hinge({0, 0, 1}, {1, 0, 0}, 180))}};
        const Eigen::Matrix4d m = eigen(track.at(0.5));
        CHECK((m * Eigen::Vector4d(1, 0, 0, 1) - Eigen::Vector4d(1, 0, 0, 1)).norm() < 1e-12);
        CHECK(std::abs(m.topLeftCorner<3, 3>().determinant() - 1) < 1e-12);
    }
    SECTION("a mirrored bone stays mirrored") {
        Eigen::Matrix4d mirror = Eigen::Matrix4d::Identity();
        mirror(0, 0) = -1;
        const nodes::MatrixTrack track{{0, 1}, {plain(mirror), plain(hinge({0, 1, 0}, {0, 0, 0}, 40) * mirror)}};
        CHECK(distance(eigen(track.at(0.25)), hinge({0, 1, 0}, {0, 0, 0}, 10) * mirror) < 1e-12);
    }
    SECTION("a turn of a millionth of a degree") {
        const nodes::MatrixTrack track{
            {0, 1}, {plain(hinge({0, 1, 0}, {100, 0, 0}, 0)), plain(hinge({0, 1, 0}, {100, 0, 0}, 1e-6))}};
        CHECK(distance(eigen(track.at(0.5)), hinge({0, 1, 0}, {100, 0, 0}, 5e-7)) < 1e-13);
    }
}

TEST_CASE("keyed matrices move between keys as recorded ones do", "[nodes]") {
    Eigen::Matrix4d mirror = Eigen::Matrix4d::Identity(), stretch = mirror, flat = mirror;
    mirror(0, 0) = -1;
    stretch(0, 0) = 3, stretch(1, 1) = 0.5, stretch(0, 1) = 0.25;
    flat(2, 2) = 0;
    const Eigen::Matrix4d pairs[][2] = {
        {hinge({0.3, -0.5, 0.8}, {-44, 139, 0.6}, 10), hinge({0.3, -0.5, 0.8}, {-44, 139, 0.6}, 50)},
        {hinge({0, 0, 1}, {1, 0, 0}, 0), hinge({0, 0, 1}, {1, 0, 0}, 170)},
        {hinge({1, 2, 3}, {5, 0, 0}, -100), hinge({-1, 0, 2}, {0, 7, 0}, 30)},
        {mirror, hinge({0, 1, 0}, {0, 0, 0}, 40) * mirror},
        {stretch, hinge({0, 1, 1}, {3, 0, 0}, 70) * stretch * stretch},
        {hinge({0, 1, 0}, {100, 0, 0}, 0), hinge({0, 1, 0}, {100, 0, 0}, 1e-6)}};
    for (const auto& pair : pairs)
        for (const double u : {0.1, 0.5, 0.8}) {
            const nodes::MatrixTrack track{{0, 1}, {plain(pair[0]), plain(pair[1])}};
            const Matrix4 keyed = engine::matrix_between(plain(pair[0]), plain(pair[1]), u);
            CHECK(distance(eigen(track.at(u)), eigen(keyed)) < 1e-11);
        }
    // Half a turn may go either way; a bone without thickness has no rotation to find.
    const Matrix4 half =
        engine::matrix_between(plain(hinge({0, 0, 1}, {1, 0, 0}, 0)), plain(hinge({0, 0, 1}, {1, 0, 0}, 180)), 0.5);
    CHECK((eigen(half) * Eigen::Vector4d(1, 0, 0, 1) - Eigen::Vector4d(1, 0, 0, 1)).norm() < 1e-12);
    CHECK(distance(eigen(engine::matrix_between(plain(flat), plain(mirror), 0.25)), 0.75 * flat + 0.25 * mirror) <
          1e-15);
}

TEST_CASE("a track runs at its own rate and offset", "[nodes]") {
    CHECK(nodes::track_frame(1, 0, 5) == 1);
    CHECK(nodes::track_frame(2, 0, 5) == 6);
    CHECK(nodes::track_frame(24.5, -3, 1) == 21.5);
    const Folder folder;
    std::string frames;
    for (int f = 1; f <= 11; ++f)
        frames += (f > 1 ? "," : "") + std::string(R"({"frame": )") + std::to_string(f) +
                  R"(, "bones": {"ulna": [1,0,0,)" + std::to_string(f * f) + ", 0,1,0,0, 0,0,1,0, 0,0,0,1]}}";
    const std::string path = folder.write("track.json", R"({"frames": [)" + frames + "]}");
    Session s(R"("t": {"type": "transform", "inputs": {"track": ")" + path +
              R"(", "trackName": "ulna", "trackRate": 5}},
                 "u": {"type": "transform", "inputs": {"track": ")" +
              path + R"(", "trackName": "ulna", "trackRate": 5, "trackOffset": -5}},
                 "v": {"type": "transform", "inputs": {"track": ")" +
              path + R"(", "trackName": "ulnar"}},
                 "w": {"type": "transform", "inputs": {"track": ")" +
              path + R"("}})");
    CHECK(s.get<Matrix4>("t", "outMatrix", 1)[3] == 1);
    CHECK(s.get<Matrix4>("t", "outMatrix", 2)[3] == 36);
    CHECK(s.get<Matrix4>("t", "outMatrix", 3)[3] == 121);
    CHECK(s.get<Matrix4>("t", "outMatrix", 9)[3] == 121);
    CHECK(s.get<Matrix4>("u", "outMatrix", 2)[3] == 1);
    std::string text;
    CHECK(codes([&] { s.pull("v", "outMatrix"); }, &text) == Codes{"IO403"});
    CHECK(text.find("'ulna'") != std::string::npos);
    CHECK(codes([&] { s.pull("w", "outMatrix"); }) == Codes{"DG110"});
}

TEST_CASE("a motion file that cannot be used says why", "[nodes]") {
    const Folder folder;
    const auto pulled = [&](const std::string& text) {
        const std::string path = folder.write("m.json", text);
        return codes(R"("t": {"type": "transform", "inputs": {"track": ")" + path + R"(", "trackName": "b"}})", "t",
                     "outMatrix");
    };
    std::string said;
    Session other(R"("t": {"type": "transform", "inputs": {"track": ")" +
                  folder.write("other.json", R"({"bones": {}})") + R"(", "trackName": "b"}})");
    CHECK(codes([&] { other.pull("t", "outMatrix"); }, &said) == Codes{"IO403"});
    CHECK(said.find("is no motion: it has no list of frames") != std::string::npos);
    CHECK(pulled("{") == Codes{"IO403"});
    CHECK(pulled("{}") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": []})") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": [{"bones": {}}]})") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": [{"frame": 1, "bones": {"b": [1, 2]}}]})") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": [{"frame": 1, "bones": {"b": "x"}}]})") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": [{"frame": 1}]})") == Codes{"IO403"});
    CHECK(pulled(R"({"frames": [{"frame": 1, "bones": {"b": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}}]})") ==
          Codes{"IO403"});
    const std::string m = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
    CHECK(pulled(R"({"frames": [{"frame": 2, "bones": {"b": )" + m + R"(}}, {"frame": 2, "bones": {"b": )" + m +
                 "}}]}") == Codes{"IO403"});
    // What is missing in one frame only is looked for there.
    const std::string path = folder.write("gap.json", R"({"frames": [{"frame": 2, "bones": {"b": )" + m +
                                                          R"(}}, {"frame": 3.5, "bones": {"c": )" + m + "}}]}");
    Session gap(R"("t": {"type": "transform", "inputs": {"track": ")" + path + R"(", "trackName": "b"}})");
    std::string text;
    CHECK(codes([&] { gap.pull("t", "outMatrix"); }, &text) == Codes{"IO403"});
    CHECK(text.find("has no bone 'b' at frame 3.5") != std::string::npos);
    CHECK(codes(R"("t": {"type": "transform", "inputs": {"track": ")" + folder.path("none.json") +
                    R"(", "trackName": "b"}})",
                "t", "outMatrix") == Codes{"IO401"});
}

TEST_CASE("a channel maps recorded numbers to the range of an attribute", "[nodes]") {
    const Folder folder;
    const std::string path = folder.write("c.json", one_number_a_frame({0, 67.5, 135, 200, 200}));
    const std::string head =
        R"({"type": "trackChannel", "inputs": {"channel": "angle", "inMax": 135, "file": ")" + path + "\"";
    Session s(R"("flex": )" + head + R"(, "outMin": 0.2, "outMax": 1}},
                 "extend": )" +
              head + R"(, "outMin": 0.8, "outMax": 0}},
                 "raw": {"type": "trackChannel", "inputs": {"channel": "angle", "clamp": false, "file": ")" +
              path + R"("}},
                 "same": )" +
              head + R"(, "inMin": 135}},
                 "none": {"type": "trackChannel", "inputs": {"channel": "angel", "file": ")" +
              path + R"("}},
                 "fiber": {"type": "zFiber", "inputs": {"excitation": {"from": "flex.outValue"}}})");
    CHECK(s.get<double>("flex", "outValue", 1) == 0.2);
    CHECK(s.get<double>("flex", "outValue", 2) == Approx(0.6));
    CHECK(s.get<double>("flex", "outValue", 3) == 1);
    CHECK(s.get<double>("flex", "outValue", 4) == 1);
    CHECK(s.get<double>("extend", "outValue", 3) == 0);
    s.set("flex", "inMin", "67.5"); // what lies below counts as this
    CHECK(s.get<double>("flex", "outValue", 1) == 0.2);
    CHECK(s.get<double>("flex", "outValue", 3) == 1);
    s.set("flex", "inMin", "0");
    CHECK(s.get<double>("raw", "outValue", 1.5) == 33.75);
    CHECK(s.get<double>("raw", "outValue", 4.3) == 200);
    CHECK(s.get<nodes::Fiber>("fiber", "outFiber", 2).values.excitation == s.get<double>("flex", "outValue", 2));
    CHECK(codes([&] { s.pull("same", "outValue"); }) == Codes{"DG110"});
    CHECK(codes([&] { s.pull("none", "outValue"); }) == Codes{"IO403"});
}
