// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/loose_pieces.h"

#include "solver/index.h"
#include "solver/mesh/surface_pieces.h"
#include "tools/rig/graph_text.h"

#include <algorithm>

namespace sinew::rig {

using engine::Severity;
using solver::at;
using solver::SurfacePieces;

namespace {

/// Each piece with its own vertices.
std::vector<Part> cut_apart(const Part& part, const SurfacePieces& pieces) {
    std::vector<Part> out(pieces.count());
    std::vector<int> own(part.points.size(), -1);
    for (solver::Triangle t : part.triangles) {
        Part& piece = out[at(pieces.of_point[at(t[0])])];
        for (int& v : t) {
            if (own[at(v)] < 0) {
                own[at(v)] = static_cast<int>(piece.points.size());
                piece.points.push_back(part.points[at(v)]);
            }
            v = own[at(v)];
        }
        piece.triangles.push_back(t);
    }
    for (Part& piece : out) piece.box = solver::bounding_box(piece.points);
    return out;
}

bool are_near(const Part& a, const Part& b, double most) {
    const solver::Vec3 gap = (a.box.min - b.box.max).cwiseMax(b.box.min - a.box.max);
    if (gap.maxCoeff() > most) return false;
    const auto reaches = [&](const Part& from, const Part& to) {
        const std::vector<double> all = distances(from, Surface(to), most);
        return *std::min_element(all.begin(), all.end()) <= most;
    };
    return reaches(a, b) || reaches(b, a);
}

/// Of each piece: whether an attachment of the muscle begins at it.
std::vector<char> tied(const Rig& rig, const Muscle& m, const SurfacePieces& pieces,
                       const std::vector<std::vector<double>>& to) {
    std::vector<char> out(pieces.count(), 0);
    const auto tie = [&](std::size_t v) {
        if (const int piece = pieces.of_point[v]; piece >= 0) out[at(piece)] = 1;
    };
    for (std::size_t e = 0; e < 2; ++e)
        for (const Hold& hold : m.ends[e].holds)
            for (const std::size_t v : painted(m, e, hold, rig.parts[m.part], to[hold.target])) tie(v);
    for (const Touch& touch : rig.touches) {
        if (touch.source != m.part && touch.target != m.part) continue;
        const std::vector<double>& distance = to[touch.source == m.part ? touch.target : touch.source];
        for (std::size_t v = 0; v < distance.size(); ++v)
            if (distance[v] <= touch.outer) tie(v);
    }
    return out;
}

} // namespace

void doubt_loose_pieces(Rig& rig, const AllDistances& all) {
    for (std::size_t i = 0; i < rig.muscles.size(); ++i) {
        const Muscle& m = rig.muscles[i];
        const Part& part = rig.parts[m.part];
        const SurfacePieces pieces = solver::find_pieces_by_place(part.points, part.triangles);
        if (!m.is_held() || pieces.count() < 2) continue;
        std::vector<char> is_held = tied(rig, m, pieces, all[i]);
        const std::vector<Part> cut = cut_apart(part, pieces);
        // Tets that reach across to another piece tie the two.
        std::vector<std::size_t> open;
        for (std::size_t p = 0; p < pieces.count(); ++p)
            if (is_held[p]) open.push_back(p);
        if (open.empty()) continue;
        while (!open.empty()) {
            const std::size_t from = open.back();
            open.pop_back();
            for (std::size_t p = 0; p < pieces.count(); ++p)
                if (!is_held[p] && are_near(cut[from], cut[p], m.tet_size)) is_held[p] = 1, open.push_back(p);
        }
        const auto loose = std::count(is_held.begin(), is_held.end(), 0);
        if (loose == 0) continue;
        solver::Box box{solver::Vec3::Zero(), solver::Vec3::Zero()};
        for (std::size_t p = 0; p < pieces.count(); ++p)
            if (!is_held[p] && cut[p].box.size().maxCoeff() > box.size().maxCoeff()) box = cut[p].box;
        const solver::Vec3 middle = box.centre();
        const std::string place = rough(box.size().maxCoeff()) + " long, around (" + rough(middle.x()) + ", " +
                                  rough(middle.y()) + ", " + rough(middle.z()) + ")";
        rig.notes.push_back(
            say(Severity::warning, "DG158", part.name,
                "'" + part.file + "' is " + std::to_string(pieces.count()) + " pieces, and nothing holds " +
                    (loose == 1 ? "the one that is " + place + ", so it would fall"
                                : std::to_string(loose) + " of them, so they would fall; the largest is " + place),
                "Give each piece that is a muscle of its own a file of its own, and take the others away."));
    }
}

} // namespace sinew::rig
