// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/page_data.h"

#include "solver/terms/all_terms.h"
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace sinew::viewer {

using Json = nlohmann::ordered_json;

namespace {

/// One array of a browser holds this many numbers at most; longer runs are cut into several blocks.
constexpr std::size_t most_in_block = std::size_t{1} << 24;

class Writer {
  public:
    PageData data;

    int add(Block block) {
        data.blocks.push_back(std::move(block));
        return static_cast<int>(data.blocks.size()) - 1;
    }
    int floats(const std::vector<float>& values) { return add(pack(std::span<const float>(values))); }
    int indices(const std::vector<std::uint32_t>& values, int order = 0, std::size_t stride = 1) {
        return add(pack(std::span<const std::uint32_t>(values), order, stride));
    }
    int bytes(const std::vector<std::uint8_t>& values) { return add(pack(std::span<const std::uint8_t>(values))); }
    int text(const std::string& value) { return bytes({value.begin(), value.end()}); }
    /// Shares of 1 as bytes.
    int shares(const std::vector<float>& values) {
        std::vector<std::uint8_t> out;
        for (const float v : values)
            out.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f))));
        return bytes(out);
    }
    template <std::size_t N>
    int tuples(const std::vector<std::array<int, N>>& values) {
        std::vector<std::uint32_t> out;
        out.reserve(N * values.size());
        for (const auto& t : values)
            for (const int i : t) out.push_back(static_cast<std::uint32_t>(i));
        return indices(out, 1, N);
    }

    /// Positions of all frames on grids, as differences in time. Missing frames repeat the one before.
    Json motion(const std::vector<Coordinates>& frames, std::size_t numbers) {
        Json out = {{"chunks", Json::array()}};
        const std::vector<GridSpan> spans = grids_along(frames, numbers);
        for (std::size_t s = 0; s < spans.size(); ++s)
            add_chunks(out["chunks"], frames, numbers, spans[s],
                       s + 1 < spans.size() ? spans[s + 1].first : frames.size());
        return out;
    }

  private:
    void add_chunks(Json& chunks, const std::vector<Coordinates>& frames, std::size_t numbers, const GridSpan& span,
                    std::size_t last_end) {
        const Grid& grid = span.grid;
        const std::size_t per_block = std::max<std::size_t>(1, most_in_block / std::max<std::size_t>(1, numbers));
        std::vector<std::uint16_t> last(numbers, 0);
        for (std::size_t first = span.first; first < last_end; first += per_block) {
            const std::size_t end = std::min(last_end, first + per_block);
            std::vector<std::uint16_t> values;
            values.reserve((end - first) * numbers);
            for (std::size_t f = first; f < end; ++f) {
                if (frames[f].size() == numbers)
                    for (std::size_t i = 0; i < numbers; ++i) last[i] = grid.to_grid(frames[f][i], i % 3);
                values.insert(values.end(), last.begin(), last.end());
            }
            chunks.push_back({{"first", first},
                              {"count", end - first},
                              {"origin", grid.origin},
                              {"step", grid.step},
                              {"block", add(smallest(values, numbers))}});
        }
    }

    /// Slow motion is best told by its speed, even motion by its change of speed.
    static Block smallest(const std::vector<std::uint16_t>& values, std::size_t stride) {
        const std::span<const std::uint16_t> all(values);
        // A trial on a part is enough to choose, and saves the time of a second whole compression.
        const auto part = all.first(std::min(all.size(), std::max<std::size_t>(12 * stride, 1)));
        const std::size_t once = pack(part, 1, std::max<std::size_t>(1, stride)).deflated.size();
        const std::size_t twice = pack(part, 2, std::max<std::size_t>(1, stride)).deflated.size();
        return pack(all, twice < once ? 2 : 1, std::max<std::size_t>(1, stride));
    }
};

std::string hex_colour(const Eigen::Vector3f& linear) {
    return render::hex_of({render::to_srgb(linear[0]), render::to_srgb(linear[1]), render::to_srgb(linear[2])});
}

Json motion_json(Writer& w, const ViewBody& body) {
    if (body.lattice && !body.lattice->surface.tet.empty()) {
        const ViewEmbedding& e = body.lattice->surface;
        return {{"kind", "embedded"},
                {"tet", w.indices({e.tet.begin(), e.tet.end()}, 1)},
                {"weights", w.floats(e.weights)}};
    }
    if (const auto* rigid = std::get_if<RigidMotion>(&body.motion)) {
        std::vector<float> poses;
        for (const RigidPose& p : rigid->poses) {
            poses.insert(poses.end(), p.rotation.begin(), p.rotation.end());
            poses.insert(poses.end(), p.translation.begin(), p.translation.end());
        }
        return {{"kind", "rigid"}, {"pivot", rigid->pivot}, {"poses", w.floats(poses)}};
    }
    Json out = {{"kind", "points"}};
    out.update(w.motion(std::get<DeformingMotion>(body.motion).points, body.rest.size()));
    return out;
}

Json skin_json(Writer& w, const std::vector<ViewSkinPoint>& skin) {
    std::vector<std::array<int, 4>> places;
    std::vector<float> weights;
    for (const ViewSkinPoint& s : skin) {
        places.push_back({s.vertex, s.host[0], s.host[1], s.host[2]});
        weights.insert(weights.end(), s.weights.begin(), s.weights.end());
    }
    return {{"places", w.tuples(places)}, {"weights", w.shares(weights)}};
}

Json lattice_json(Writer& w, const ViewLattice& lattice) {
    Json out = {{"count", lattice.tets.size()},
                {"vertices", lattice.rest.size() / 3},
                {"tets", w.tuples(lattice.tets)},
                {"rest", w.floats(lattice.rest)},
                {"skin", skin_json(w, lattice.skin)}};
    out.update(w.motion(lattice.frames, lattice.rest.size()));
    return out;
}

Json fibres_json(Writer& w, const ViewFibres& f) {
    const float longest = f.reach.empty() ? 0 : *std::max_element(f.reach.begin(), f.reach.end());
    std::vector<float> reach;
    for (const float r : f.reach) reach.push_back(longest > 0 ? r / longest : 0);
    return {{"node", f.node},
            {"count", f.tets.size()},
            {"tets", w.indices({f.tets.begin(), f.tets.end()}, 1)},
            {"directions", w.floats(f.directions)},
            {"centre", w.shares(f.centre)},
            {"longest", longest},
            {"reach", w.shares(reach)},
            {"excitation", w.floats(f.excitation)}};
}

Json body_json(Writer& w, const ViewBody& body) {
    Json out = {{"name", body.name},
                {"node", body.node},
                {"kind", render::word_of(body.kind)},
                {"matter", nodes::word_of(body.matter)},
                {"colour", hex_colour(body.look.colour)},
                {"stripes", body.look.stripes},
                {"gloss", body.look.gloss},
                {"vertices", body.vertex_count()},
                {"rest", w.floats(body.rest)},
                {"triangles", w.tuples(body.triangles)},
                {"edges", w.tuples(body.edges)},
                {"shading", nullptr},
                {"present", nullptr},
                {"lattice", nullptr},
                {"fibres", Json::array()},
                {"maps", Json::array()},
                {"volume", nullptr}};
    if (!body.shading.empty()) out["shading"] = w.indices({body.shading.begin(), body.shading.end()}, 1);
    if (!body.present.empty()) out["present"] = w.bytes({body.present.begin(), body.present.end()});
    if (body.lattice) out["lattice"] = lattice_json(w, *body.lattice);
    out["motion"] = motion_json(w, body);
    for (const ViewFibres& f : body.fibres) out["fibres"].push_back(fibres_json(w, f));
    for (const ViewMap& m : body.maps)
        out["maps"].push_back({{"node", m.node}, {"name", m.name}, {"values", w.shares(m.values)}});
    if (!body.volume.empty()) out["volume"] = w.floats(body.volume);
    return out;
}

Json attachment_json(Writer& w, const ViewAttachment& a) {
    const auto carried_json = [&](ViewCarried ViewAnchor::*end) -> Json {
        std::vector<std::uint32_t> hosts;
        std::vector<float> weights;
        for (const ViewAnchor& anchor : a.anchors) {
            for (const int h : (anchor.*end).host) hosts.push_back(static_cast<std::uint32_t>(std::max(0, h)));
            weights.insert(weights.end(), (anchor.*end).weights.begin(), (anchor.*end).weights.end());
        }
        return {{"hosts", w.indices(hosts, 1, 4)}, {"weights", w.floats(weights)}};
    };
    std::vector<float> offsets;
    for (const ViewAnchor& anchor : a.anchors)
        offsets.insert(offsets.end(), anchor.offset.begin(), anchor.offset.end());
    return {{"node", a.node},
            {"mode", a.mode},
            {"source", a.source},
            {"target", a.target},
            {"count", a.anchors.size()},
            {"from", carried_json(&ViewAnchor::source)},
            {"to", carried_json(&ViewAnchor::target)},
            {"offsets", w.floats(offsets)}};
}

/// "force_x_N", and of the second part "force_x_N 2".
std::string name_of(const solver::Measure& m, int part) {
    return std::string(m.name) + (part < 0 ? "" : " " + std::to_string(part + 1));
}

/// What the frames report, each once, in the order of the terms.
Json measures_json(const ViewScene& scene) {
    Json out = Json::array();
    for (const solver::TermType* type : solver::all_terms())
        for (const solver::Measure& m : type->measures) {
            std::set<int> parts;
            for (const ViewFrame& f : scene.frames)
                if (f.step)
                    for (const solver::Measured& measured : f.step->measured)
                        if (measured.what == &m) parts.insert(measured.part);
            for (const int part : parts)
                out.push_back({{"term", m.term},
                               {"name", name_of(m, part)},
                               {"unit", m.unit},
                               {"title", part < 0 ? std::string(m.title)
                                                  : std::string(m.term) + " " + std::to_string(part + 1) + ": " +
                                                        std::string(m.title)}});
        }
    return out;
}

Json frame_json(Writer& w, const ViewFrame& f) {
    Json out = {{"frame", f.frame}, {"reused", f.reused}, {"wall_s", f.wall_s}};
    if (f.step) {
        const solver::StepRecord& s = *f.step;
        out["phases"] = {{"assembly", s.seconds_assembly},
                         {"factor", s.seconds_factor},
                         {"solve", s.seconds_solve},
                         {"other", s.seconds_other}};
        out["substeps"] = s.substeps, out["newton"] = s.newton_iterations;
        out["residual"] = s.residual, out["converged"] = s.converged, out["energy"] = s.energy;
        out["minJ"] = s.min_j, out["inverted"] = s.inverted;
        for (const solver::Measured& m : s.measured)
            out["terms"][std::string(m.what->term)][name_of(*m.what, m.part)] = m.value;
    }
    if (!f.faults.empty()) out["faults"] = f.faults;
    for (const ViewMarks& group : f.marks) {
        if (group.marks.empty()) continue;
        std::vector<float> numbers, bodies; // seven and two a mark
        bool has_bodies = false;
        for (const ViewMark& m : group.marks) {
            numbers.insert(numbers.end(), m.from.begin(), m.from.end());
            numbers.insert(numbers.end(), m.to.begin(), m.to.end());
            numbers.push_back(m.value);
            for (const int body : m.bodies) bodies.push_back(static_cast<float>(body)), has_bodies |= body >= 0;
        }
        Json json = {{"term", group.term}, {"what", group.what}, {"unit", group.unit}, {"numbers", w.floats(numbers)}};
        if (has_bodies) json["bodies"] = w.floats(bodies);
        out["marks"].push_back(std::move(json));
    }
    return out;
}

Json graph_json(Writer& w, const GraphDrawing& graph) {
    if (graph.boxes.empty()) return nullptr;
    Json nodes = Json::array(), wires = Json::array();
    for (const GraphBox& box : graph.boxes) {
        Json rows = Json::array();
        for (const GraphRow& row : box.rows)
            if (!row.is_output) rows.push_back({row.attribute, row.text});
        nodes.push_back({{"name", box.name},
                         {"type", box.type},
                         {"family", box.family},
                         {"rows", rows},
                         {"box", {box.x, box.y, box.width, box.height}}});
    }
    std::set<std::array<int, 2>> said;
    for (const GraphWire& wire : graph.wires)
        if (said.insert({wire.from, wire.to}).second) wires.push_back({wire.from, wire.to});
    return {{"width", graph.width},
            {"height", graph.height},
            {"nodes", nodes},
            {"wires", wires},
            {"svg", w.text(to_svg(graph, SvgFor::page))}};
}

/// '<' could end the script element that holds the text.
std::string without_less_than(const std::string& json) {
    std::string out;
    out.reserve(json.size());
    for (const char c : json)
        if (c == '<')
            out += "\\u003c";
        else
            out += c;
    return out;
}

Json scene_json(Writer& w, const ViewScene& scene) {
    Json out = {{"title", scene.title},
                {"source", scene.source},
                {"fps", scene.fps},
                {"unitsPerMetre", scene.units_per_metre},
                {"up", std::string(1, scene.up)},
                {"bounds", bounds(scene)},
                {"frames", Json::array()},
                {"measures", measures_json(scene)},
                {"bodies", Json::array()},
                {"attachments", Json::array()},
                {"notes", Json::array()}};
    for (const ViewFrame& f : scene.frames) out["frames"].push_back(frame_json(w, f));
    for (const ViewBody& b : scene.bodies) out["bodies"].push_back(body_json(w, b));
    for (const ViewAttachment& a : scene.attachments) out["attachments"].push_back(attachment_json(w, a));
    for (const ViewNote& n : scene.notes) out["notes"].push_back({{"warning", n.is_warning}, {"text", n.text}});
    out["graph"] = graph_json(w, scene.graph);
    return out;
}

} // namespace

PageData page_data(const ViewScene& scene, const ViewScene* other) {
    Writer w;
    Json header = scene_json(w, scene);
    header["format"] = 1;
    header["generator"] = "sinew " SINEW_VERSION;
    header["other"] = other ? scene_json(w, *other) : Json();
    header["blocks"] = Json::array();
    for (const Block& b : w.data.blocks) header["blocks"].push_back({b.element, b.length, b.order, b.stride});
    w.data.header = without_less_than(header.dump(-1, ' ', false, Json::error_handler_t::replace));
    return std::move(w.data);
}

} // namespace sinew::viewer
