// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/font.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace sinew::render {

namespace {

constexpr double capital = 14;           // height of a capital in the units of the table; the line lies at 0, y goes up
constexpr double thick = 1.75;           // of strokes
constexpr double between = 3, blank = 5; // letters, words

/// Strokes of a letter: "L x y x y …" a line through points, "A x y rx ry from to" an arc about (x, y), degrees
/// counter-clockwise from the right; strokes end with ';'.
struct Glyph {
    char letter;
    double width;
    std::string_view strokes;
};

constexpr Glyph glyphs[] = {
    {'A', 11, "L0 0 5.5 14 11 0;L1.9 4.8 9.1 4.8"},
    {'B', 9.2, "L5 7.2 0 7.2;L0 0 0 14 5 14;A5 10.6 3.5 3.4 90 -90;A5 3.6 4.2 3.6 90 -90;L5 0 0 0"},
    {'C', 10.4, "A6 7 6 7 47 313"},
    {'D', 10.5, "L4.5 0 0 0 0 14 4.5 14;A4.5 7 6 7 90 -90"},
    {'E', 8, "L8 0 0 0 0 14 8 14;L0 7.2 7 7.2"},
    {'F', 8, "L0 0 0 14 8 14;L0 7.2 7 7.2"},
    {'G', 11.2, "A6 7 6 7 47 330;L11.2 3.4 11.2 6.6 7 6.6"},
    {'H', 9.5, "L0 0 0 14;L9.5 0 9.5 14;L0 7.2 9.5 7.2"},
    {'I', 1, "L0.5 0 0.5 14"},
    {'J', 6, "L6 14 6 4.2;A2.9 4.2 3.1 4.2 0 -165"},
    {'K', 9.5, "L0 0 0 14;L9 14 0 5;L3.4 8.4 9.5 0"},
    {'L', 7.5, "L0 14 0 0 7.5 0"},
    {'M', 12, "L0 0 0 14 6 4 12 14 12 0"},
    {'N', 9.5, "L0 0 0 14 9.5 0 9.5 14"},
    {'O', 12, "A6 7 6 7 0 360"},
    {'P', 9, "L0 0 0 14 5 14;A5 10.2 4 3.8 90 -90;L5 6.4 0 6.4"},
    {'Q', 12, "A6 7 6 7 0 360;L7.5 3.5 11.5 -0.8"},
    {'R', 9.4, "L0 0 0 14 5 14;A5 10.2 4 3.8 90 -90;L5 6.4 0 6.4;L5 6.4 9.4 0"},
    {'S', 9, "A4.6 10.4 4 3.6 40 270;A4.6 3.4 4.4 3.4 90 -145"},
    {'T', 10, "L0 14 10 14;L5 14 5 0"},
    {'U', 9.5, "L0 14 0 4.75;A4.75 4.75 4.75 4.75 180 360;L9.5 4.75 9.5 14"},
    {'V', 11, "L0 14 5.5 0 11 14"},
    {'W', 15.6, "L0 14 3.8 0 7.8 14 11.8 0 15.6 14"},
    {'X', 9.5, "L0 0 9.5 14;L0 14 9.5 0"},
    {'Y', 10, "L0 14 5 6.8 10 14;L5 6.8 5 0"},
    {'Z', 9, "L0 14 9 14 0 0 9 0"},
    {'a', 8.8, "A4.4 5 4.4 5 0 360;L8.8 10 8.8 0"},
    {'b', 8.8, "L0 14 0 0;A4.4 5 4.4 5 0 360"},
    {'c', 7.8, "A4.6 5 4.6 5 46 314"},
    {'d', 8.8, "A4.4 5 4.4 5 0 360;L8.8 14 8.8 0"},
    {'e', 9, "L0.1 5.2 9 5.2;A4.5 5 4.5 5 2 314"},
    {'f', 5, "L2 0 2 10.8;A4.6 10.8 2.6 3.2 180 75;L0 10 4.8 10"},
    {'g', 8.8, "A4.4 5 4.4 5 0 360;L8.8 10 8.8 0;A4.6 0 4.2 4.2 0 -150"},
    {'h', 8, "L0 0 0 14;A4 6 4 4 180 0;L8 6 8 0"},
    {'i', 1.2, "L0.6 0 0.6 10;L0.6 13.5 0.6 13.7"},
    {'j', 3.2, "L2.6 10 2.6 -1.2;A0 -1.2 2.6 2.8 0 -80;L2.6 13.5 2.6 13.7"},
    {'k', 7.4, "L0 0 0 14;L7 10 0 3.6;L2.7 6 7.4 0"},
    {'l', 1.2, "L0.6 0 0.6 14"},
    {'m', 12.8, "L0 0 0 10;A3.2 6.6 3.2 3.4 180 0;L6.4 6.6 6.4 0;A9.6 6.6 3.2 3.4 180 0;L12.8 6.6 12.8 0"},
    {'n', 8, "L0 0 0 10;A4 6 4 4 180 0;L8 6 8 0"},
    {'o', 9.4, "A4.7 5 4.7 5 0 360"},
    {'p', 8.8, "L0 10 0 -4;A4.4 5 4.4 5 0 360"},
    {'q', 8.8, "A4.4 5 4.4 5 0 360;L8.8 10 8.8 -4"},
    {'r', 5, "L0 0 0 10;A4.2 5.8 4.2 4.2 180 75"},
    {'s', 7.2, "A3.6 7.4 3.2 2.6 40 270;A3.6 2.4 3.4 2.4 90 -145"},
    {'t', 5.2, "L2 13 2 2.8;A4.8 2.8 2.8 2.8 180 280;L0 10 5 10"},
    {'u', 8, "L0 10 0 4;A4 4 4 4 180 360;L8 10 8 0"},
    {'v', 8.4, "L0 10 4.2 0 8.4 10"},
    {'w', 12.4, "L0 10 3 0 6.2 10 9.4 0 12.4 10"},
    {'x', 7.6, "L0 0 7.6 10;L0 10 7.6 0"},
    {'y', 8.6, "L0 10 4.3 0;L8.6 10 2.8 -4 0.6 -4"},
    {'z', 7.4, "L0 10 7.4 10 0 0 7.4 0"},
    {'0', 9, "A4.5 7 4.5 7 0 360"},
    {'1', 9, "L1.6 11.2 5 14 5 0"},
    {'2', 9, "A4.5 9.8 4.2 4.2 165 -25;L8.3 8 0.4 0 9 0"},
    {'3', 9, "A4.4 10.6 3.7 3.4 150 -90;A4.4 3.6 4.3 3.6 90 -150"},
    {'4', 9, "L6.6 0 6.6 14 0 4.4 9 4.4"},
    {'5', 9, "L8.2 14 1.4 14 1 7.8;A4.4 4.7 4.4 4.7 140 -150"},
    {'6', 9, "A4.5 4.6 4.3 4.6 0 360;A8.2 4.6 8 9.4 180 100"},
    {'7', 9, "L0.2 14 9 14 3.2 0"},
    {'8', 9, "A4.5 10.6 3.6 3.4 0 360;A4.5 3.6 4.3 3.6 0 360"},
    {'9', 9, "A4.5 9.4 4.3 4.6 0 360;A0.8 9.4 8 9.4 0 -80"},
    {'.', 1.2, "L0.6 0 0.6 0.2"},
    {',', 1.4, "L1 0.4 0.2 -2.2"},
    {':', 1.2, "L0.6 0 0.6 0.2;L0.6 8 0.6 8.2"},
    {';', 1.4, "L1 0.4 0.2 -2.2;L0.8 8 0.8 8.2"},
    {'-', 5, "L0 6 5 6"},
    {'_', 9, "L0 -2.5 9 -2.5"},
    {'/', 6, "L0 -2 6 15"},
    {'\\', 6, "L0 15 6 -2"},
    {'|', 1, "L0.5 -3 0.5 15"},
    {'(', 3, "A5.5 5.5 5.3 10 125 235"},
    {')', 3, "A-2.5 5.5 5.3 10 55 -55"},
    {'[', 3, "L3 15.5 0 15.5 0 -3.5 3 -3.5"},
    {']', 3, "L0 15.5 3 15.5 3 -3.5 0 -3.5"},
    {'{', 4, "L4 15.5 2 14.5 2 7 0 6 2 5 2 -2.5 4 -3.5"},
    {'}', 4, "L0 15.5 2 14.5 2 7 4 6 2 5 2 -2.5 0 -3.5"},
    {'<', 8, "L8 11 0 6 8 1"},
    {'>', 8, "L0 11 8 6 0 1"},
    {'+', 8, "L0 6 8 6;L4 2 4 10"},
    {'=', 8, "L0 8 8 8;L0 4 8 4"},
    {'*', 6, "L3 14 3 7;L0 12.3 6 8.7;L0 8.7 6 12.3"},
    {'%', 12.6, "A2.4 11 2.4 3 0 360;A10.2 3 2.4 3 0 360;L2.4 0 10.2 14"},
    {'#', 9.5, "L2 0 4 14;L5.8 0 7.8 14;L0.4 9.6 9.5 9.6;L0 4.6 9 4.6"},
    {'\'', 1, "L0.5 14 0.5 10"},
    {'"', 4, "L0.5 14 0.5 10;L3.5 14 3.5 10"},
    {'`', 3, "L0 14 2.4 11.4"},
    {'!', 1.2, "L0.6 14 0.6 4.4;L0.6 0 0.6 0.2"},
    {'?', 7.6, "A3.8 10.4 3.6 3.6 160 -65;L5.3 7.1 3.8 5.8 3.8 4.2;L3.8 0 3.8 0.2"},
    {'~', 8, "A2 6 2 1.6 180 0;A6 6 2 1.6 180 360"},
    {'^', 7, "L0 9 3.5 14 7 9"},
    {'$', 9, "A4.6 10.2 4 3 40 270;A4.6 3.8 4.4 3.4 90 -145;L4.6 16 4.6 -2"},
    {'&', 10.5, "L10.5 0 2.6 9.2;A4.6 11 2.6 3 220 -60;L5.9 8.4 2 6.6;A4.2 3.5 4.2 3.5 120 325;L7.6 1.5 10 6"},
    {'@', 13, "A6.5 6 6.5 8 -50 300;A6.5 6 2.9 3.4 0 360;L9.4 9.4 9.4 4;A11.2 4 1.8 1.6 180 360;L13 4 13 6"},
};
constexpr Glyph unknown{'\0', 8, "L0 0 0 14 8 14 8 0 0 0"};

struct Point {
    double x = 0, y = 0;
};
using Segment = std::pair<Point, Point>;

std::vector<double> numbers_of(std::string_view text) {
    std::vector<double> out;
    const char *at = text.data(), *end = at + text.size();
    while (at < end) {
        if (*at == ' ') {
            ++at;
            continue;
        }
        out.push_back(0);
        at = std::from_chars(at, end, out.back()).ptr;
    }
    return out;
}

/// The segments of a letter, arcs as short ones.
std::vector<Segment> segments_of(const Glyph& glyph) {
    std::vector<Segment> out;
    for (std::string_view rest = glyph.strokes; !rest.empty();) {
        const std::size_t end = std::min(rest.find(';'), rest.size());
        const std::vector<double> n = numbers_of(rest.substr(1, end - 1));
        std::vector<Point> path;
        if (rest.front() == 'L')
            for (std::size_t i = 0; i + 1 < n.size(); i += 2) path.push_back({n[i], n[i + 1]});
        else
            for (int i = 0; i <= 24; ++i) {
                const double a = (n[4] + (n[5] - n[4]) * i / 24) * std::numbers::pi / 180;
                path.push_back({n[0] + n[2] * std::cos(a), n[1] + n[3] * std::sin(a)});
            }
        for (std::size_t i = 1; i < path.size(); ++i) out.emplace_back(path[i - 1], path[i]);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return out;
}

double distance(const Point& p, const Segment& s) {
    const double dx = s.second.x - s.first.x, dy = s.second.y - s.first.y, squared = dx * dx + dy * dy;
    const double along = (p.x - s.first.x) * dx + (p.y - s.first.y) * dy;
    const double t = squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0;
    return std::hypot(p.x - s.first.x - t * dx, p.y - s.first.y - t * dy);
}

/// Calls `take(glyph, x)` for every letter; bytes that continue one of UTF-8 belong to it. Gives the width of all.
template <class Take>
double lay_out(std::string_view text, const Take& take) {
    double x = 0;
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;
        if (c == ' ') {
            x += blank;
            continue;
        }
        const auto* found =
            std::find_if(std::begin(glyphs), std::end(glyphs), [&](const Glyph& g) { return g.letter == c; });
        const Glyph& glyph = found == std::end(glyphs) ? unknown : *found;
        take(glyph, x);
        x += glyph.width + between;
    }
    return std::max(0.0, x - between);
}

void draw_glyph(Image& image, const Glyph& glyph, double left, double line, const Pixel& colour, double unit) {
    const std::vector<Segment> segments = segments_of(glyph);
    const double radius = 0.5 * std::max(thick * unit, 1.0); // never fainter than a pixel
    const int x0 = std::max(0, static_cast<int>(left - radius - unit)),
              y0 = std::max(0, static_cast<int>(line - 17 * unit));
    const int x1 = std::min(image.width - 1, static_cast<int>(left + (glyph.width + 1) * unit + radius));
    const int y1 = std::min(image.height - 1, static_cast<int>(line + 6 * unit));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const Point p{(x + 0.5 - left) / unit, (line - y - 0.5) / unit};
            double nearest = 1e30;
            for (const Segment& s : segments) nearest = std::min(nearest, distance(p, s));
            const double share = std::clamp(radius + 0.5 - nearest * unit, 0.0, 1.0);
            if (share == 0) continue;
            Pixel& under = image.at(x, y);
            for (std::size_t c = 0; c < 3; ++c)
                under[c] = static_cast<std::uint8_t>(std::lround(under[c] + share * (colour[c] - under[c])));
        }
}

} // namespace

double text_width(std::string_view text, double size) {
    const double width = lay_out(text, [](const Glyph&, double) {});
    return text.empty() ? 0 : (width + thick) * size / (capital + thick);
}

void draw_text(Image& image, double x, double y, std::string_view text, Pixel colour, double size) {
    const double unit = size / (capital + thick), inset = 0.5 * thick * unit;
    lay_out(text, [&](const Glyph& glyph, double at) {
        draw_glyph(image, glyph, x + inset + at * unit, y + size - inset, colour, unit);
    });
}

} // namespace sinew::render
