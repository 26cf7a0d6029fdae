// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/page.h"

#include "tools/viewer/asset.h"
#include "tools/viewer/page_data.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace sinew::viewer {

namespace {

/// Floats that the page must hold for one frame.
std::size_t numbers_per_frame(const ViewScene& scene) {
    std::size_t count = 0;
    for (const ViewBody& body : scene.bodies) {
        const bool rides = body.lattice && !body.lattice->surface.tet.empty();
        if (std::holds_alternative<DeformingMotion>(body.motion) && !rides) count += body.rest.size();
        if (body.lattice) count += body.lattice->rest.size();
    }
    return count;
}

template <class T>
void keep_every(std::vector<T>& frames, std::size_t step) {
    if (frames.empty()) return;
    std::vector<T> kept;
    for (std::size_t f = 0; f < frames.size(); f += step) kept.push_back(std::move(frames[f]));
    frames = std::move(kept);
}

void keep_every(ViewScene& scene, std::size_t step) {
    keep_every(scene.frames, step);
    for (ViewBody& body : scene.bodies) {
        if (auto* rigid = std::get_if<RigidMotion>(&body.motion)) keep_every(rigid->poses, step);
        if (auto* moving = std::get_if<DeformingMotion>(&body.motion)) keep_every(moving->points, step);
        if (body.lattice) keep_every(body.lattice->frames, step);
        for (ViewFibres& fibres : body.fibres) keep_every(fibres.excitation, step);
        keep_every(body.present, step);
        keep_every(body.volume, step);
    }
}

std::string ordinal(std::size_t n) {
    const std::size_t last = n % 10;
    const bool is_teen = n / 10 % 10 == 1;
    return std::to_string(n) + (is_teen || last > 3 || last == 0 ? "th" : last == 1 ? "st" : last == 2 ? "nd" : "rd");
}

/// A browser cannot hold a run of any size; what does not fit is thinned out in time, not in space.
void fit(ViewScene& scene, const PageOptions& options) {
    const std::size_t a_frame = 2 * numbers_per_frame(scene), all = a_frame * scene.frames.size();
    if (all <= options.most_motion_bytes || scene.frames.size() < 2) return;
    const std::size_t fits = std::max<std::size_t>(1, options.most_motion_bytes / a_frame);
    const std::size_t step = (scene.frames.size() + fits - 1) / fits;
    const std::size_t before = scene.frames.size();
    keep_every(scene, step);
    scene.notes.push_back({true, "This run has " + size_text(all) + " of positions, and a page holds " +
                                     size_text(options.most_motion_bytes) + ": of " + std::to_string(before) +
                                     " frames every " + ordinal(step) +
                                     " is shown. Choose fewer frames with --frames, or raise --most-mb."});
}

/// Notes of the run that is compared with, and of what the two do not have in common.
void add_notes_of(const ViewScene& other, ViewScene& scene) {
    for (const ViewNote& n : other.notes) scene.notes.push_back({n.is_warning, "In " + other.title + ": " + n.text});
    std::size_t alike = 0, frames = 0;
    for (const ViewBody& a : scene.bodies)
        for (const ViewBody& b : other.bodies) {
            if (a.name != b.name) continue;
            alike += a.vertex_count() == b.vertex_count();
            if (a.vertex_count() != b.vertex_count())
                scene.notes.push_back({true, a.name + " has " + std::to_string(a.vertex_count()) +
                                                 " vertices here and " + std::to_string(b.vertex_count()) + " in " +
                                                 other.title + ": there is no difference to show."});
        }
    for (const ViewFrame& f : scene.frames)
        frames += std::any_of(other.frames.begin(), other.frames.end(),
                              [&](const ViewFrame& g) { return g.frame == f.frame; });
    if (alike == 0 || frames == 0)
        scene.notes.push_back({true, other.title + " has no " + (alike == 0 ? "body" : "frame") +
                                         " in common with this run: there is no difference to show."});
}

std::string html_escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

/// Nothing but what stands in the file may load or run: a promise that the browser keeps.
constexpr const char* policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                               "img-src data: blob:";

} // namespace

Page write_page(ViewScene scene, const PageOptions& options, std::optional<ViewScene> other) {
    fit(scene, options);
    if (other) {
        fit(*other, options);
        add_notes_of(*other, scene);
        other->graph = {};
    }
    Page page;
    page.notes = scene.notes;
    for (const ViewScene* s : {&scene, other ? &*other : nullptr})
        if (s) page.motion_bytes += 2 * numbers_per_frame(*s) * s->frames.size();
    page.asset_bytes = page_script().size() + page_style().size();
    const PageData data = page_data(scene, other ? &*other : nullptr);
    std::string& html = page.html;
    html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
           std::string(policy) + "\">\n<meta name=\"generator\" content=\"sinew" +
           std::string(scene.is_evaluated ? " evaluated" : "") + "\">\n<title>" + html_escaped(scene.title) +
           " · Sinew</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>" + std::string(page_style()) +
           "</style>\n</head>\n<body>\n<div id=\"app\"></div>\n" +
           "<noscript>This page shows a simulation and needs JavaScript.</noscript>\n"
           "<script type=\"application/json\" id=\"sinew-scene\">" +
           data.header + "</script>\n";
    for (std::size_t i = 0; i < data.blocks.size(); ++i) {
        const std::string text = base64(data.blocks[i].deflated);
        page.packed_bytes += text.size();
        html += "<script type=\"application/octet-stream\" id=\"b" + std::to_string(i) + "\">" + text + "</script>\n";
    }
    page.packed_bytes += data.header.size();
    html += "<script>" + std::string(page_script()) + "</script>\n</body>\n</html>\n";
    return page;
}

bool holds_evaluated_page(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false; // a pipe would be waited for
    std::ifstream in(file, std::ios::binary);
    std::string head(1000, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    return head.find("content=\"sinew evaluated\"") != std::string::npos;
}

std::string size_text(std::size_t bytes) {
    char out[32];
    const double mb = static_cast<double>(bytes) / 1e6;
    std::snprintf(out, sizeof out, mb < 0.1 ? "%.2f MB" : mb < 100 ? "%.1f MB" : "%.0f MB", mb);
    return out;
}

} // namespace sinew::viewer
