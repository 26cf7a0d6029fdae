// Reads motion files and interpolates between their frames.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/motion_track.h"

#include "engine/diagnostics.h"
#include "engine/text.h"
#include "nodes/json_file.h"
#include "nodes/matrices.h"
#include "solver/error.h"
#include "solver/types.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using engine::Matrix4;
using Json = nlohmann::json;
using solver::Error;
using solver::Mat3;
using solver::Vec3;

namespace {

/// Where `frame` lies: between samples i and i + 1, at share u in [0, 1); the last sample has u = 0.
struct Place {
    std::size_t i;
    double u;
};

Place locate(const std::vector<double>& frames, double frame) {
    const auto after = std::upper_bound(frames.begin(), frames.end(), frame);
    if (after == frames.begin()) return {0, 0};
    const auto i = static_cast<std::size_t>(after - frames.begin() - 1);
    if (after == frames.end()) return {i, 0};
    return {i, (frame - frames[i]) / (frames[i + 1] - frames[i])};
}

/// x -> R S x + t with R a rotation and S symmetric (polar decomposition); S is negative for mirrored bones.
struct Parts {
    Mat3 R, S;
    Vec3 t;
};

Parts split(const Matrix4& matrix) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(matrix.data());
    const Mat3 A = m.topLeftCorner<3, 3>();
    const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 R = svd.matrixU() * svd.matrixV().transpose();
    if (R.determinant() < 0) R = -R; // a mirror's sign goes into S, which keeps R unique
    return {R, R.transpose() * A, m.topRightCorner<3, 1>()};
}

Mat3 cross_matrix(const Vec3& w) {
    Mat3 K;
    K << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return K;
}

/// The left Jacobian of SO(3): maps the linear part of a twist to the translation of its exponential
/// (e.g. Lynch & Park, Modern Robotics, 2017, section 3.3.3).
Mat3 left_jacobian(const Vec3& w) {
    const double angle = w.norm();
    const Mat3 K = cross_matrix(w);
    const bool small = angle < 1e-4; // the series is exact to rounding there, the closed form is not
    const double a = small ? 0.5 - angle * angle / 24 : (1 - std::cos(angle)) / (angle * angle);
    const double b = small ? 1.0 / 6 - angle * angle / 120 : (angle - std::sin(angle)) / (angle * angle * angle);
    return Mat3::Identity() + a * K + b * (K * K);
}

Matrix4 between(const Matrix4& from, const Matrix4& to, double u) {
    const Parts a = split(from), b = split(to);
    // The rigid motion D that carries a's frame to b's is a screw; u of it is exp(u log D).
    const Mat3 D = b.R * a.R.transpose();
    const Eigen::AngleAxisd turn{Eigen::Quaterniond(D).normalized()};
    const Vec3 w = turn.angle() * turn.axis();
    const Vec3 v = left_jacobian(w).partialPivLu().solve(b.t - D * a.t);
    const Mat3 part = Eigen::AngleAxisd(u * turn.angle(), turn.axis()).toRotationMatrix();
    const Mat3 A = part * a.R * ((1 - u) * a.S + u * b.S);
    const Vec3 t = part * a.t + left_jacobian(u * w) * (u * v);
    return {A(0, 0), A(0, 1), A(0, 2), t(0), A(1, 0), A(1, 1), A(1, 2), t(1),
            A(2, 0), A(2, 1), A(2, 2), t(2), 0,       0,       0,       1};
}

/// Calls take(frame number, frame object) for every frame, in rising order of frame.
template <class Take>
void for_frames(const Json& file, const std::string& path, Take take) {
    const auto found = file.is_object() ? file.find("frames") : file.end();
    if (found == file.end() || !found->is_array() || found->empty())
        throw Error("IO403", "'" + path + "' is no motion: it has no list of frames", motion_form);
    const Json& frames = *found;
    double last = -std::numeric_limits<double>::infinity();
    for (const Json& f : frames) {
        if (!f.is_object() || !f.contains("frame") || !f["frame"].is_number())
            throw Error("IO403", "'" + path + "' has a frame without a number \"frame\"");
        const double number = f["frame"].get<double>();
        if (!(number > last))
            throw Error("IO403", "'" + path + "': frame " + engine::number_text(number) +
                                     " does not come after frame " + engine::number_text(last));
        last = number;
        take(number, f);
    }
}

[[noreturn]] void throw_unknown(const std::string& path, double frame, const std::string& what, const std::string& name,
                                const Json& object) {
    std::vector<std::string> names;
    for (const auto& [key, value] : object.items()) names.push_back(key);
    const std::string near = engine::nearest_name(name, names);
    throw Error("IO403", "'" + path + "' has no " + what + " '" + name + "' at frame " + engine::number_text(frame),
                near.empty() ? std::string() : "Did you mean '" + near + "'?");
}

std::optional<double> fps_of(const Json& file) {
    const auto it = file.is_object() ? file.find("fps") : file.end();
    if (it == file.end() || !it->is_number() || !(it->get<double>() > 0)) return {};
    return it->get<double>();
}

} // namespace

Matrix4 MatrixTrack::at(double frame) const {
    const Place p = locate(frames, frame);
    if (p.u == 0 || matrices[p.i] == matrices[p.i + 1]) return matrices[p.i];
    return between(matrices[p.i], matrices[p.i + 1], p.u);
}

double NumberTrack::at(double frame) const {
    const Place p = locate(frames, frame);
    return p.u == 0 ? values[p.i] : std::lerp(values[p.i], values[p.i + 1], p.u);
}

MatrixTrack read_matrix_track(const engine::FileAccess& files, const std::string& path, const std::string& bone) {
    return parse_matrix_track(read_text(files, path, most_json_bytes), path, bone);
}

MatrixTrack parse_matrix_track(std::string_view text, const std::string& path, const std::string& bone) {
    const Json file = parse_json(text, path);
    MatrixTrack track;
    track.fps = fps_of(file);
    for_frames(file, path, [&](double number, const Json& frame) {
        const Json bones = frame.value("bones", Json::object());
        if (!bones.is_object() || !bones.contains(bone)) throw_unknown(path, number, "bone", bone, bones);
        const std::string matrix = "the matrix of '" + bone + "' at frame " + engine::number_text(number);
        const engine::NumberList m = numbers_of(bones[bone], matrix, path);
        if (m.size() != 16)
            throw Error("IO403", "'" + path + "': " + matrix + " has " + std::to_string(m.size()) + " numbers",
                        "Give 16, row by row.");
        track.frames.push_back(number);
        std::copy(m.begin(), m.end(), track.matrices.emplace_back().begin());
        if (!is_affine(track.matrices.back()))
            throw Error("IO403", "'" + path + "': the last row of " + matrix + " is not 0 0 0 1",
                        "Write matrices row by row, with the translation in the last column.");
    });
    return track;
}

NumberTrack read_number_track(const engine::FileAccess& files, const std::string& path, const std::string& channel) {
    return parse_number_track(read_text(files, path, most_json_bytes), path, channel);
}

NumberTrack parse_number_track(std::string_view text, const std::string& path, const std::string& channel) {
    const Json file = parse_json(text, path);
    NumberTrack track;
    track.fps = fps_of(file);
    for_frames(file, path, [&](double number, const Json& frame) {
        if (!frame.contains(channel) || !frame[channel].is_number())
            throw_unknown(path, number, "channel", channel, frame);
        track.frames.push_back(number);
        track.values.push_back(frame[channel].get<double>());
    });
    return track;
}

double track_frame(double graph_frame, double offset, double rate) { return (graph_frame - 1) * rate + 1 + offset; }

} // namespace sinew::nodes
