// Pictures: the scene is in them, whole, in its colours, and the same for every number of threads.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "tools/render/font.h"
#include "tools/render/picture.h"
#include "tools/render/shading_mesh.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <png.h>
#include <set>
#include <tbb/task_arena.h>

using namespace sinew;
using namespace sinew::render;

namespace {

Surface surface_of(const solver::SurfaceMesh& mesh, const Look& look, const Vec3& shift = Vec3::Zero()) {
    const ShadingMesh shading = split_creases(mesh.points, mesh.triangles);
    Surface out;
    out.points = shading.gather(mesh.points);
    for (Vec3& p : out.points) p += shift;
    out.triangles = shading.triangles;
    out.normals = solver::vertex_normals(out.points, out.triangles);
    out.look = look;
    return out;
}

Image decode(const std::string& bytes) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()));
    header.format = PNG_FORMAT_RGB;
    Image image(static_cast<int>(header.width), static_cast<int>(header.height));
    REQUIRE(png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr));
    return image;
}

Image ball_picture(const Look& look, int width = 160, int height = 120) {
    const Surface ball = surface_of(solver::make_sphere(1, 24, 16), look);
    return draw_picture({ball}, frame_points({&ball.points}, {0, 0}, static_cast<double>(width) / height), width,
                        height, 2);
}

bool is_background(const Pixel& p) { return std::abs(p[0] - p[2]) < 40 && p[0] < 110; }

} // namespace

TEST_CASE("a PNG gives back the pixels that went in", "[tools]") {
    Image image(7, 3);
    for (int i = 0; i < 21; ++i)
        image.pixels[static_cast<std::size_t>(i)] = {static_cast<std::uint8_t>(12 * i), 7,
                                                     static_cast<std::uint8_t>(255 - i)};
    const Image back = decode(encode_png(image));
    CHECK(back.width == 7);
    CHECK(back.height == 3);
    CHECK(back.pixels == image.pixels);
}

TEST_CASE("a red ball is red in the middle of its picture and absent from the corners", "[tools]") {
    const Image image = ball_picture({Eigen::Vector3f(0.6f, 0.03f, 0.03f), 0, 0.2f});
    const Pixel middle = image.at(80, 60);
    CHECK(middle[0] > 100);
    CHECK(middle[0] > 2 * middle[1]);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(159, 0), std::pair(0, 119), std::pair(159, 119)})
        CHECK(is_background(image.at(x, y)));
}

TEST_CASE("the key light comes from the upper left", "[tools]") {
    const Image image = ball_picture({Eigen::Vector3f(0.5f, 0.5f, 0.5f), 0, 0});
    CHECK(image.at(65, 42)[1] > image.at(95, 80)[1] + 25);
}

TEST_CASE("a camera frames every point, touching the border that is nearest", "[tools]") {
    const auto modelled = solver::make_cube(3, 1, 2, 4, 4, 4).points;
    auto points = modelled;
    for (const double azimuth : {0.0, 40.0, 135.0, -120.0})
        for (const double elevation : {-90.0, -20.0, 0.0, 55.0, 90.0})
            for (const double aspect : {0.4, 1.0, 2.5})
                for (const char up : {'y', 'z'}) {
                    // Wherever they are: a million times their size from the origin, too.
                    const Vec3 away(up == 'y' ? 0 : 1e6, 0, aspect > 2 ? -1e6 : 0);
                    for (std::size_t i = 0; i < points.size(); ++i) points[i] = modelled[i] + away;
                    const Camera camera = frame_points({&points}, {azimuth, elevation, up}, aspect, 0.05);
                    double widest = 0;
                    for (const Vec3& p : points) {
                        const Vec3 c = camera.to_camera(p);
                        REQUIRE(c[2] > 0);
                        widest = std::max(
                            {widest, std::abs(c[0] / c[2]) / camera.tan_x, std::abs(c[1] / c[2]) / camera.tan_y});
                    }
                    CHECK(widest == Approx(0.9).epsilon(1e-6));
                }
}

TEST_CASE("views look at the side that they name, and the axis that is up stays up", "[tools]") {
    const auto camera = [](const char* name, char up) {
        View view = parse_view(name).value();
        view.up = up;
        return frame_points({}, view, 1);
    };
    CHECK(camera("front", 'y').backward.isApprox(Vec3(0, 0, 1), 1e-12));
    CHECK(camera("left", 'y').backward.isApprox(Vec3(1, 0, 0), 1e-12));
    CHECK(camera("top", 'y').backward.isApprox(Vec3(0, 1, 0), 1e-12));
    CHECK(camera("front", 'z').backward.isApprox(Vec3(0, -1, 0), 1e-12));
    CHECK(camera("left", 'z').backward.isApprox(Vec3(1, 0, 0), 1e-12));
    CHECK(camera("front", 'z').up.isApprox(Vec3(0, 0, 1), 1e-12));
    CHECK(parse_view("-45,10")->azimuth == -45);
    for (const char* wrong : {"", "behind", "1", "1,", "x,2", "0,91", "1,2,3"}) CHECK_FALSE(parse_view(wrong));
}

TEST_CASE("what is nearer hides what is behind it", "[tools]") {
    const solver::SurfaceMesh plate = solver::make_cube(2, 2, 0.1, 1, 1, 1);
    const Surface red = surface_of(plate, {Eigen::Vector3f(0.7f, 0.02f, 0.02f), 0, 0}, Vec3(0, 0, 1)),
                  blue = surface_of(plate, {Eigen::Vector3f(0.02f, 0.02f, 0.7f), 0, 0}, Vec3(0, 0, -1));
    for (const auto& order : {std::vector{red, blue}, std::vector{blue, red}}) {
        const Camera camera = frame_points({&red.points, &blue.points}, {0, 0}, 1);
        const Pixel middle = draw_picture(order, camera, 40, 40, 1).at(20, 20);
        CHECK(middle[0] > 2 * middle[2]);
        const Camera back = frame_points({&red.points, &blue.points}, {180, 0}, 1);
        const Pixel behind = draw_picture(order, back, 40, 40, 1).at(20, 20);
        CHECK(behind[2] > 2 * behind[0]);
    }
}

TEST_CASE("a contact sheet holds every shot with its label, all seen by one camera", "[tools]") {
    const Look look{Eigen::Vector3f(0.6f, 0.5f, 0.4f), 0, 0.1f};
    const solver::SurfaceMesh ball = solver::make_sphere(1, 16, 10);
    const std::vector<Shot> shots{{"frame 1", {surface_of(ball, look, Vec3(-3, 0, 0))}},
                                  {"frame 2", {surface_of(ball, look, Vec3(3, 0, 0))}}};
    const Image sheet = contact_sheet(shots, {0, 0}, 400, 300, 1);
    CHECK(sheet.width == 400);
    CHECK(sheet.height == 300);
    // A wide scene goes one above the other: the ball is on the left in the first and on the right in the
    // second.
    CHECK_FALSE(is_background(sheet.at(80, 74)));
    CHECK(is_background(sheet.at(320, 74)));
    CHECK(is_background(sheet.at(80, 225)));
    CHECK_FALSE(is_background(sheet.at(320, 225)));
    int label_pixels = 0;
    for (int y = 135; y < 149; ++y)
        for (int x = 0; x < 60; ++x) label_pixels += sheet.at(x, y)[0] > 120;
    CHECK(label_pixels > 40);
}

TEST_CASE("a contact sheet of three or five pictures has no hole", "[tools]") {
    const Look look{Eigen::Vector3f(0.6f, 0.5f, 0.4f), 0, 0.1f};
    const Shot shot{"", {surface_of(solver::make_sphere(1, 16, 10), look, Vec3(0, 0, 0))}};
    const auto in_gaps = [&](std::size_t count) {
        const Image sheet = contact_sheet(std::vector<Shot>(count, shot), {0, 0}, 400, 300, 1);
        int out = 0;
        for (int y = 0; y < 300; ++y)
            for (int x = 0; x < 400; ++x) out += sheet.at(x, y) == Pixel{8, 9, 11};
        return out;
    };
    CHECK(in_gaps(3) == 2 * 2 * 300);               // three beside each other: two gaps of two pixels
    CHECK(in_gaps(5) == 2 * 400 + 2 * 2 * 300 - 8); // two rows of three cells, one of them empty
    CHECK(in_gaps(4) == 2 * 400 + 2 * 300 - 4);
}

TEST_CASE("a picture does not depend on the number of threads", "[tools]") {
    const Look look{Eigen::Vector3f(0.5f, 0.2f, 0.2f), 0, 0.4f};
    Image one(1, 1), two(1, 1);
    tbb::task_arena(1).execute([&] { one = ball_picture(look); });
    tbb::task_arena(2).execute([&] { two = ball_picture(look); });
    CHECK(one.pixels == two.pixels);
}

TEST_CASE("sharp edges are split and smooth ones are not", "[tools]") {
    const auto cube = solver::make_cube(1, 1, 1, 1, 1, 1);
    CHECK(split_creases(cube.points, cube.triangles).source.size() == 24);
    const auto ball = solver::make_sphere(1, 20, 20);
    const ShadingMesh smooth = split_creases(ball.points, ball.triangles);
    CHECK(smooth.triangles == ball.triangles);
    CHECK(smooth.source.size() == ball.points.size());
    // A triangle without area between two in one plane is no crease: a square, cut from corner to corner through 4.
    const Points square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
    CHECK(split_creases(square, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}}).source.size() == 5);
}

TEST_CASE("sRGB and linear light are each other's inverse, by the standard's two pieces", "[tools]") {
    // IEC 61966-2-1.
    for (const auto& [srgb, linear] : {std::pair{0.0f, 0.0f},
                                       {0.02f, 0.00154799f},
                                       {0.04f, 0.00309598f},
                                       {0.1f, 0.01002283f},
                                       {0.2f, 0.03310477f},
                                       {0.5f, 0.21404114f},
                                       {1.0f, 1.0f}}) {
        CHECK(to_linear(srgb) == Approx(linear).epsilon(1e-5));
        CHECK(to_srgb(linear) == Approx(srgb).epsilon(1e-5));
    }
}

TEST_CASE("letters are drawn where they should be, with smooth edges, at any size", "[tools]") {
    const Pixel white{255, 255, 255}, black{0, 0, 0};
    Image image(60, 44);
    draw_text(image, 4, 4, "Hi", white, 28);
    CHECK(image.at(5, 20) == white);  // the left stem of the H
    CHECK(image.at(14, 18) == white); // its bar
    CHECK(image.at(14, 10) == black); // above the bar
    CHECK(image.at(14, 26) == black);
    CHECK(image.at(5, 34) == black); // below the line
    CHECK(std::count_if(image.pixels.begin(), image.pixels.end(),
                        [](const Pixel& p) { return p[0] > 0 && p[0] < 255; }) > 20);
    // As wide as is said: nothing beyond, something just before.
    const double width = text_width("Hi", 28);
    const auto lit = [&](int x) {
        for (int y = 0; y < image.height; ++y)
            if (image.at(x, y)[0] > 60) return true;
        return false;
    };
    CHECK(lit(static_cast<int>(4 + width - 1.5)));
    CHECK_FALSE(lit(static_cast<int>(4 + width + 1)));
    CHECK(text_width("", 28) == 0);
    CHECK(text_width("Hi", 56) == Approx(2 * width));
    draw_text(image, 50, 38, "Mg", {1, 1, 1}, 40); // over the edge: cut off, not a crash
    draw_text(image, -30, -30, "Mg", {1, 1, 1}, 40);
}

TEST_CASE("every letter of ASCII has a picture of its own and others are one box each", "[tools]") {
    const auto picture = [](const std::string& text) {
        Image image(60, 60);
        draw_text(image, 10, 10, text, {255, 255, 255}, 30);
        return image.pixels;
    };
    std::map<std::vector<Pixel>, std::string> seen{{picture("\u00e9"), "the box"}};
    for (char c = '!'; c <= '~'; ++c) {
        const auto [at, is_new] = seen.emplace(picture({c}), std::string{c});
        INFO(c << " looks as " << at->second);
        CHECK(is_new);
    }
    CHECK(picture("\u00e9") == picture("\u4e2d"));
    CHECK(text_width("\u00e9", 30) == text_width("\u4e2d", 30));
}

TEST_CASE("segments are seen in their colour, hide behind surfaces and shine through veils", "[tools]") {
    Surface wall;
    wall.points = {{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    wall.normals.assign(4, {0, 0, 1});
    wall.look.colour = {0.5f, 0.5f, 0.5f};
    const Camera camera = frame_points({&wall.points}, {0, 0}, 1);
    const Segment before{{-4, 0, 1}, {4, 0, 1}, {0, 1, 0}, 6}, behind{{-4, 0, -1}, {4, 0, -1}, {0, 1, 0}, 6},
        dot{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, 6};
    const auto middle = [&](const Segment& s) { return draw_picture({wall}, camera, 60, 60, 2, {s}).at(30, 30); };
    const Pixel bare = draw_picture({wall}, camera, 60, 60, 2).at(30, 30);
    CHECK(middle(before) == Pixel{0, 255, 0});
    CHECK(middle(dot) == Pixel{0, 255, 0});
    CHECK(middle(behind) == bare);
    wall.opacity = 0.3f;
    const Pixel through = middle(behind);
    CHECK(through[1] > 200);
    CHECK(through[0] > 40); // some of the wall
    CHECK(draw_picture({wall}, camera, 60, 60, 2, {before}).at(30, 50) != Pixel{0, 255, 0});
}
