// Deferred shading: first which triangle each sample sees (raster.h), then light, shadow and cavities from
// the seen points alone. Everything below is in camera coordinates: x right, y up, z = distance in front of
// the eye.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/picture.h"

#include "tools/render/raster.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tbb/parallel_for.h>

namespace sinew::render {

namespace {

using Vec3f = Eigen::Vector3f;

struct Light {
    Vec3f towards, colour;
};

// A warm key light from the upper left, a cool fill from the right, a rim from behind; fixed to the camera,
// so that every view is lit alike. Only the key light throws a shadow.
const Light key{Vec3f(-0.55f, 0.75f, -0.60f).normalized(), Vec3f(1.00f, 0.95f, 0.88f) * 2.1f};
const Light fill{Vec3f(0.85f, 0.10f, -0.50f).normalized(), Vec3f(0.62f, 0.74f, 0.95f) * 0.55f};
const Light rim{Vec3f(0.25f, 0.55f, 0.80f).normalized(), Vec3f(0.85f, 0.92f, 1.00f) * 0.8f};
const Vec3f sky = Vec3f(0.52f, 0.57f, 0.66f), ground = Vec3f(0.25f, 0.21f, 0.19f);
const Vec3f background_top{0.105f, 0.120f, 0.145f}, background_bottom{0.020f, 0.023f, 0.030f};

constexpr int cavity_samples = 10, shadow_samples = 8, shadow_size = 2048;
constexpr float cavity_radius = 0.035f; // of the scene's diagonal

/// The scene in camera coordinates.
struct Posed {
    std::vector<Vec3f> points, normals;
};

/// Parallel projection along the key light: grid coordinates and nearness.
struct ShadowFrame {
    Vec3f x, y, towards;
    float left = 0, top = 0, scale = 1;
    ScreenVertex operator()(const Vec3f& p) const {
        return {(x.dot(p) - left) * scale, (top - y.dot(p)) * scale, towards.dot(p)};
    }
};

/// Evenly spread angles that differ from sample to sample without a pattern; a function of the place alone.
float turn(int x, int y) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1u ^ static_cast<std::uint32_t>(y) * 0x85ebca77u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return static_cast<float>(h >> 8) * (2 * std::numbers::pi_v<float> / 16777216.0f);
}

/// Point k of n of a spiral that fills the unit disc.
Eigen::Vector2f spiral(int k, int n, float start) {
    const float r = std::sqrt((static_cast<float>(k) + 0.5f) / static_cast<float>(n)),
                a = start + 2.399963f * static_cast<float>(k);
    return {r * std::cos(a), r * std::sin(a)};
}

class Painter {
  public:
    /// \param smoothing samples to a pixel, for the width of segments
    Painter(const std::vector<Surface>& surfaces, const std::vector<Segment>& segments, const Camera& camera, int width,
            int height, int smoothing)
        : surfaces_(surfaces)
        , segments_(segments)
        , width_(width)
        , height_(height)
        , tan_x_(static_cast<float>(camera.tan_x))
        , tan_y_(static_cast<float>(camera.tan_y)) {
        pose(camera);
        std::vector<ScreenSurface> seen(surfaces.size()), lit(surfaces.size());
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            seen[s].triangles = lit[s].triangles = &surfaces[s].triangles;
            for (const Vec3f& p : posed_[s].points) {
                seen[s].vertices.push_back(project(p));
                lit[s].vertices.push_back(shadow_frame_(p));
            }
        }
        std::vector<solver::Triangle> ribbon_triangles;
        if (!segments.empty()) seen.push_back(ribbons(camera, smoothing, ribbon_triangles));
        seen_ = rasterise(width, height, seen);
        lit_ = rasterise(shadow_size, shadow_size, lit);
    }

    /// Linear light of one sample.
    Vec3f paint(int x, int y) const {
        const std::size_t cell = seen_.index(x, y);
        if (seen_.surface[cell] < 0) return background(x, y);
        const auto s = static_cast<std::size_t>(seen_.surface[cell]);
        if (s == surfaces_.size()) return segments_[static_cast<std::size_t>(seen_.triangle[cell]) / 2].colour;
        const Surface& surface = surfaces_[s];
        const solver::Triangle& t = surface.triangles[static_cast<std::size_t>(seen_.triangle[cell])];
        const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]),
                   c = static_cast<std::size_t>(t[2]);

        const Vec3f point =
            unproject(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 1 / seen_.nearness[cell]);
        const Vec3f w = barycentric(point, posed_[s].points[a], posed_[s].points[b], posed_[s].points[c]);
        const auto& n = posed_[s].normals;
        const Vec3f eye = -point.normalized();
        Vec3f normal = (w[0] * n[a] + w[1] * n[b] + w[2] * n[c]).stableNormalized();
        if (normal.dot(eye) < 0) normal = -normal;

        Vec3f colour = surface.look.colour;
        if (surface.look.stripes > 0 && !surface.grain.empty()) {
            const solver::Vec3 g = static_cast<double>(w[0]) * surface.grain[a] +
                                   static_cast<double>(w[1]) * surface.grain[b] +
                                   static_cast<double>(w[2]) * surface.grain[c];
            colour *= 1 - surface.look.stripes * stripe(g.cast<float>());
        }
        return light(colour, surface.look.gloss, point, normal, eye, x, y);
    }

    /// 1 / distance of what is seen there; -infinity for the background.
    float nearness(int x, int y) const { return seen_.nearness[seen_.index(x, y)]; }
    float opacity(int x, int y) const {
        return surfaces_[static_cast<std::size_t>(seen_.surface[seen_.index(x, y)])].opacity;
    }

  private:
    /// Two triangles a segment that face the eye, a little nearer than it, so that lines on a surface are
    /// seen.
    ScreenSurface ribbons(const Camera& camera, int smoothing, std::vector<solver::Triangle>& triangles) const {
        ScreenSurface out;
        for (const Segment& segment : segments_) {
            const Vec3f from = camera.to_camera(segment.from).cast<float>(),
                        to = camera.to_camera(segment.to).cast<float>();
            const float half = 0.5f * segment.width * static_cast<float>(smoothing);
            ScreenVertex a, b; // behind the eye: nothing, but the count must stay
            if (from[2] > 0 && to[2] > 0) a = project(from), b = project(to);
            Eigen::Vector2f along(b.x - a.x, b.y - a.y);
            const bool is_dot = along.norm() < 1e-3f;
            along = is_dot ? Eigen::Vector2f(1, 0) : Eigen::Vector2f(along.normalized());
            const Eigen::Vector2f across = half * Eigen::Vector2f(-along[1], along[0]);
            const Eigen::Vector2f before = is_dot ? Eigen::Vector2f(half * along) : Eigen::Vector2f::Zero();
            const auto first = static_cast<int>(out.vertices.size());
            for (const ScreenVertex* end : {&a, &b})
                for (const float side : {-1.0f, 1.0f}) {
                    const Eigen::Vector2f shift = side * across + (end == &a ? -1.0f : 1.0f) * before;
                    out.vertices.push_back({end->x + shift[0], end->y + shift[1], end->nearness * 1.0005f});
                }
            triangles.push_back({first, first + 1, first + 2});
            triangles.push_back({first + 1, first + 3, first + 2});
        }
        out.triangles = &triangles;
        return out;
    }

    void pose(const Camera& camera) {
        const float infinity = std::numeric_limits<float>::infinity();
        shadow_frame_.towards = key.towards;
        shadow_frame_.x = Vec3f(0, 1, 0).cross(key.towards).normalized();
        shadow_frame_.y = key.towards.cross(shadow_frame_.x);
        Eigen::AlignedBox3f box;
        float left = infinity, right = -infinity, bottom = infinity, top = -infinity;
        for (const Surface& surface : surfaces_) {
            Posed posed;
            for (const Vec3& p : surface.points) {
                const Vec3f q = camera.to_camera(p).cast<float>();
                posed.points.push_back(q);
                box.extend(q);
                left = std::min(left, shadow_frame_.x.dot(q)), right = std::max(right, shadow_frame_.x.dot(q));
                bottom = std::min(bottom, shadow_frame_.y.dot(q)), top = std::max(top, shadow_frame_.y.dot(q));
            }
            for (const Vec3& n : surface.normals)
                posed.normals.push_back(
                    Vec3(camera.right.dot(n), camera.up.dot(n), -camera.backward.dot(n)).cast<float>());
            posed_.push_back(std::move(posed));
        }
        const float side = std::max({right - left, top - bottom, std::numeric_limits<float>::min()});
        shadow_frame_.left = left - 0.01f * side, shadow_frame_.top = top + 0.01f * side;
        shadow_frame_.scale = static_cast<float>(shadow_size) / (1.02f * side);
        diagonal_ = box.isEmpty() ? 1 : box.diagonal().norm();
    }

    ScreenVertex project(const Vec3f& p) const {
        return {0.5f * static_cast<float>(width_) * (1 + p[0] / (p[2] * tan_x_)),
                0.5f * static_cast<float>(height_) * (1 - p[1] / (p[2] * tan_y_)), 1 / p[2]};
    }

    Vec3f unproject(float x, float y, float distance) const {
        return {(2 * x / static_cast<float>(width_) - 1) * tan_x_ * distance,
                (1 - 2 * y / static_cast<float>(height_)) * tan_y_ * distance, distance};
    }

    static Vec3f barycentric(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
        const Vec3f n = (b - a).cross(c - a);
        const float area = n.squaredNorm();
        if (area == 0) return {1, 0, 0};
        const float v = (p - a).cross(c - a).dot(n) / area, w = (b - a).cross(p - a).dot(n) / area;
        return Vec3f(1 - v - w, v, w).cwiseMax(0).cwiseMin(1);
    }

    /// 0…0.3: bundles that run along the long axis and meet at both ends, with a slow wave so that they look
    /// grown.
    static float stripe(const Vec3f& g) {
        const float angle = std::atan2(g[2], g[1]), along = g[0], radius = std::hypot(g[1], g[2]);
        const float wave = 0.55f * std::sin(19 * angle + 1.5f * std::sin(2.3f * along + 1)) +
                           0.45f * std::sin(34 * angle - 2.1f * std::sin(1.7f * along));
        const float fade =
            std::clamp(radius / 0.05f, 0.0f, 1.0f); // at the axis the bundles would be finer than a pixel
        return 0.15f * fade * (1 + wave);
    }

    Vec3f background(int x, int y) const {
        const float v = static_cast<float>(y) / static_cast<float>(height_),
                    u = static_cast<float>(x) / static_cast<float>(width_) - 0.5f;
        return (background_top + v * (background_bottom - background_top)) * (1 - 0.7f * u * u);
    }

    /// 1 in the open, towards 0 in grooves: how much of the hemisphere nearby points cover.
    float openness(const Vec3f& point, const Vec3f& normal, int x, int y) const {
        const float radius = cavity_radius * diagonal_;
        const float cells = radius / (point[2] * tan_x_) * 0.5f * static_cast<float>(width_);
        const float start = turn(x, y);
        float covered = 0;
        for (int k = 0; k < cavity_samples; ++k) {
            const Eigen::Vector2f d = cells * spiral(k, cavity_samples, start);
            const int sx = x + static_cast<int>(std::lround(d[0])), sy = y + static_cast<int>(std::lround(d[1]));
            if (sx < 0 || sy < 0 || sx >= width_ || sy >= height_) continue;
            const std::size_t cell = seen_.index(sx, sy);
            if (seen_.surface[cell] < 0) continue;
            const Vec3f to =
                unproject(static_cast<float>(sx) + 0.5f, static_cast<float>(sy) + 0.5f, 1 / seen_.nearness[cell]) -
                point;
            const float distance = to.norm();
            if (distance < 1e-6f * diagonal_) continue;
            const float ratio = distance / radius;
            covered += std::max(0.0f, normal.dot(to) / distance - 0.12f) / (1 + ratio * ratio);
        }
        return std::clamp(1 - 2.4f * covered / cavity_samples, 0.0f, 1.0f);
    }

    /// Share of the key light that arrives.
    float lit_share(const Vec3f& point, const Vec3f& normal, int x, int y) const {
        const float cell_size = 1 / shadow_frame_.scale;
        const ScreenVertex at = shadow_frame_(point + 2.5f * cell_size * normal);
        const float bias = 2.5f * cell_size, blur = 0.004f * diagonal_ * shadow_frame_.scale, start = turn(y, x);
        int open = 0;
        for (int k = 0; k < shadow_samples; ++k) {
            const Eigen::Vector2f d = blur * spiral(k, shadow_samples, start);
            const int sx = std::clamp(static_cast<int>(at.x + d[0]), 0, shadow_size - 1);
            const int sy = std::clamp(static_cast<int>(at.y + d[1]), 0, shadow_size - 1);
            open += lit_.nearness[lit_.index(sx, sy)] < at.nearness + bias + 0.5f * d.norm() * cell_size;
        }
        return static_cast<float>(open) / shadow_samples;
    }

    Vec3f light(const Vec3f& colour, float gloss, const Vec3f& point, const Vec3f& normal, const Vec3f& eye, int x,
                int y) const {
        const float open = openness(point, normal, x, y);
        const float up = 0.5f + 0.5f * normal[1];
        Vec3f arriving = 0.55f * open * (up * sky + (1 - up) * ground);
        const float key_cosine = normal.dot(key.towards);
        const float share = key_cosine > -0.2f ? lit_share(point, normal, x, y) : 0.0f;
        // The key light wraps a little around the edge of the shadow, as it does in soft tissue.
        arriving += key.colour * (share * std::max(0.0f, (key_cosine + 0.2f) / 1.2f) * (0.4f + 0.6f * open) * 0.5f);
        arriving += fill.colour * (std::max(0.0f, normal.dot(fill.towards)) * open * 0.5f);
        arriving += rim.colour * (std::max(0.0f, normal.dot(rim.towards)) * open * 0.5f);
        const float highlight = std::pow(std::max(0.0f, normal.dot((key.towards + eye).normalized())), 38.0f);
        const float edge = std::pow(1 - std::max(0.0f, normal.dot(eye)), 4.0f);
        return colour.cwiseProduct(arriving) +
               Vec3f::Constant(gloss * (0.35f * highlight * share + 0.06f * edge * open));
    }

    const std::vector<Surface>& surfaces_;
    const std::vector<Segment>& segments_;
    int width_, height_;
    float tan_x_, tan_y_, diagonal_ = 1;
    ShadowFrame shadow_frame_;
    std::vector<Posed> posed_;
    Visibility seen_, lit_;
};

} // namespace

Points grain_of(const Points& rest) {
    Points out(rest.size(), Vec3::Zero());
    if (rest.empty()) return out;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : rest) mean += p;
    mean /= static_cast<double>(rest.size());
    solver::Mat3 spread = solver::Mat3::Zero();
    for (const Vec3& p : rest) spread += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<solver::Mat3> axes(spread); // ascending: the long axis is the last
    const solver::Mat3 to_axes = axes.eigenvectors().transpose().colwise().reverse();
    double half = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        out[i] = to_axes * (rest[i] - mean);
        half = std::max(half, std::abs(out[i][0]));
    }
    if (half > 0)
        for (Vec3& p : out) p /= half;
    return out;
}

Image draw_picture(const std::vector<Surface>& surfaces, const Camera& camera, int width, int height, int smoothing,
                   const std::vector<Segment>& segments) {
    const auto is_solid = [](const Surface& s) { return s.opacity >= 1; };
    std::vector<Surface> solids = surfaces, veils;
    const auto first_veil = std::stable_partition(solids.begin(), solids.end(), is_solid);
    veils.assign(std::make_move_iterator(first_veil), std::make_move_iterator(solids.end()));
    solids.erase(first_veil, solids.end());
    const int across = width * smoothing, down = height * smoothing;
    const Painter painter(solids, segments, camera, across, down, smoothing);
    const std::vector<Segment> none;
    std::optional<Painter> veil;
    if (!veils.empty()) veil.emplace(veils, none, camera, across, down, smoothing);
    const auto sample = [&](int x, int y) -> Vec3f {
        const Vec3f behind = painter.paint(x, y);
        if (!veil || !(veil->nearness(x, y) > painter.nearness(x, y))) return behind;
        return behind + veil->opacity(x, y) * (veil->paint(x, y) - behind);
    };
    Image out(width, height);
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            Vec3f sum = Vec3f::Zero();
            for (int j = 0; j < smoothing; ++j)
                for (int i = 0; i < smoothing; ++i) sum += sample(x * smoothing + i, y * smoothing + j).cwiseMin(1.0f);
            sum /= static_cast<float>(smoothing * smoothing);
            for (int k = 0; k < 3; ++k)
                out.at(x, y)[static_cast<std::size_t>(k)] =
                    static_cast<std::uint8_t>(std::lround(255 * std::clamp(to_srgb(sum[k]), 0.0f, 1.0f)));
        }
    });
    return out;
}

} // namespace sinew::render
