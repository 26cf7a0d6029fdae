// Wavefront OBJ: positions and faces; everything else is passed over.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <algorithm>
#include <array>

namespace sinew::solver {
namespace {

/// Statements of the format that hold nothing for us. Anything else is an error: junk must not pass as an
/// empty mesh.
constexpr std::array<std::string_view, 42> passed_over = {
    "vt",   "vn",       "vp",       "g",          "o",         "s",     "mg",    "usemtl", "mtllib", "usemap", "maplib",
    "l",    "p",        "curv",     "curv2",      "surf",      "deg",   "bmat",  "step",   "cstype", "parm",   "trim",
    "hole", "scrv",     "sp",       "end",        "con",       "lod",   "bevel", "bsp",    "bzp",    "cdc",    "cdp",
    "res",  "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech", "call",   "csh"};

/// A line may go on behind a backslash at its end.
class Statement {
  public:
    explicit Statement(TextScanner& text)
        : text_(text) {}
    std::string_view word() {
        std::string_view w = text_.word_on_line();
        while (!w.empty() && w.back() == '\\') {
            w.remove_suffix(1);
            text_.rest_of_line();
            if (!w.empty()) return w;
            w = text_.word_on_line();
        }
        return w;
    }
    void skip_rest() {
        for (std::string_view rest = text_.rest_of_line(); !rest.empty() && rest.back() == '\\';)
            rest = text_.rest_of_line();
    }

  private:
    TextScanner& text_;
};

/// Vertex number of a face corner such as 7, 7/1, 7//3, 7/1/3 or -1; 0-based.
int corner(TextScanner& text, std::string_view word, std::size_t vertex_count) {
    const std::string_view index = word.substr(0, word.find('/'));
    if (index.empty()) text.fail("face corner '" + printable(word) + "' has no vertex number");
    const long long number = text.to_integer(index, "a vertex number");
    const long long count = static_cast<long long>(vertex_count);
    const long long at = number > 0 ? number - 1 : count + number;
    if (number == 0 || at < 0)
        text.fail("vertex " + printable(index) + " does not exist; " + std::to_string(count) + " are defined so far");
    if (at > 2147483646) text.fail("vertex " + printable(index) + " does not exist");
    return static_cast<int>(at);
}

} // namespace

SurfaceMesh read_obj(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file);
    Points points;
    std::vector<int> sizes, corners;
    int highest = -1, highest_line = 0;
    while (!text.at_end()) {
        const std::string_view keyword = text.word();
        Statement statement(text);
        if (keyword == "v") {
            Vec3 p;
            for (int d = 0; d < 3; ++d) {
                const std::string_view w = statement.word();
                if (w.empty())
                    text.fail("vertex " + std::to_string(points.size() + 1) + " has fewer than three coordinates");
                p[d] = text.to_number(w, "a coordinate of vertex " + std::to_string(points.size() + 1)); // as f counts
            }
            points.push_back(p);
            statement.skip_rest(); // a weight or a colour
        } else if (keyword == "f" || keyword == "fo") {
            int size = 0;
            for (std::string_view w = statement.word(); !w.empty(); w = statement.word(), ++size) {
                corners.push_back(corner(text, w, points.size()));
                if (corners.back() > highest) highest = corners.back(), highest_line = text.line();
            }
            if (size < 3) text.fail("a face has " + std::to_string(size) + " corners; it needs at least three");
            sizes.push_back(size);
        } else if (std::find(passed_over.begin(), passed_over.end(), keyword) != passed_over.end()) {
            statement.skip_rest();
        } else {
            text.fail("'" + printable(keyword) + "' is not an OBJ statement");
        }
    }
    // Faces may stand before their vertices, so the upper end is only known now.
    if (highest >= static_cast<int>(points.size()))
        throw Error("FE203", file + ":" + std::to_string(highest_line) + ": a face uses vertex " +
                                 std::to_string(highest + 1) + " of " + std::to_string(points.size()));
    return finish_surface(file, std::move(points), std::move(sizes), std::move(corners));
}

} // namespace sinew::solver
