// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hard_cases.h"

#include "solver/mesh/tet_mesh.h"
#include "solver/terms/elastic/rest_shape.h"
#include "tools/bench/table.h"

#include <algorithm>
#include <random>

namespace sinew::bench {

using namespace solver;

namespace {

// ---- what cases share

bool nowhere(const Vec3&) { return false; }
bool everywhere(const Vec3&) { return true; }
bool at_root(const Vec3& p) { return p.x() < 1e-9; }
bool loose(const Vec3& p) { return !at_root(p); }
Vec3 in_place(const Vec3& p) { return p; }

TissueInputs flesh(double youngs_modulus, double poissons_ratio) {
    TissueInputs t = material(youngs_modulus, poissons_ratio);
    t.compression_resistance = TissueInputs().compression_resistance;
    return t;
}

TetMesh box(const Vec3& size, int nx, int ny, int nz) { return box_mesh(Vec3::Zero(), size, nx, ny, nz); }

using enum HardTrial::Equilibria;

std::string off_by(double distance) { return "off by " + number(distance, 3) + " m"; }

/// A cube of one metre.
void cube(HardTrial& t, const Where& held) {
    t.make(box({1, 1, 1}, 2, 2, 2), flesh(1e4, 0.4), held);
    t.start();
}

/// A bar along x whose ends are held.
constexpr double bar_length = 0.3;
bool at_ends(const Vec3& p) { return at_root(p) || p.x() > bar_length - 1e-9; }
bool far_end(const Vec3& p) { return p.x() > bar_length - 1e-9; }
void bar(HardTrial& t, double nu, int cells = 4) {
    t.make(box({bar_length, 0.1, 0.1}, cells, 2, 2), flesh(1e4, nu), at_ends);
    t.start();
}

/// Corners of a bone in the plane x = 0, and a beam whose root hangs on it.
const Points root_plate = {{0, -0.1, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}};
void hang_on_bone(HardTrial& t, const TissueInputs& values) {
    t.make(box({bar_length, 0.1, 0.1}, 5, 2, 2), values, nowhere);
    t.add_bone(root_plate);
    t.attach_root(0, 1, 1e8);
}

/// The same law and element without inertia, to a hundredth of the tolerance: for equilibria that are taken in small
/// parts.
HardTrial quiet(const HardTrial& t) {
    HardTrial out({t.setting.law, t.setting.element, all_integrators.back()}, {});
    out.in.tolerance_factor = 1e-2;
    return out;
}

// ---- collapsed and scrambled

Vec3 plane(const Vec3& p) { return {0.5, p.y(), p.z()}; }
Vec3 slanted_plane(const Vec3& p) { return {0, p.y(), 0.5 * p.z() + 0.3 * p.y()}; }
Vec3 point(const Vec3&) { return {0.5, 0.5, 0.5}; }

template <Vec3 (*squeeze)(const Vec3&)>
void free_squeezed(HardTrial& t) {
    cube(t, nowhere);
    t.place(everywhere, squeeze);
    const Vec3 centre = t.centre();
    t.leave_alone();
    t.run(1, 3);
    t.come_to_rest();
    if (t.unconverged == 0 && (t.centre() - centre).norm() > 1e-6)
        throw WrongAnswer{"no force acts on it and its centre has moved by " + number((t.centre() - centre).norm())};
    t.must(t.distortion() < 1e-3, "distorted by " + number(t.distortion(), 3) + " m");
}

template <Vec3 (*squeeze)(const Vec3&)>
void held_squeezed(HardTrial& t) {
    cube(t, at_root);
    t.place(loose, squeeze);
    t.leave_alone();
    t.run(8, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)), several);
}

template <bool held>
void random_vertices(HardTrial& t) {
    cube(t, held ? at_root : nowhere);
    std::mt19937 random(5);
    const auto anywhere = [&] { return static_cast<double>(random()) / 4294967296.0; };
    t.place(held ? loose : everywhere, [&](const Vec3&) {
        const double x = anywhere(), y = anywhere(), z = anywhere();
        return Vec3(x, y, z);
    });
    t.leave_alone();
    t.run(8, 4);
    t.come_to_rest();
    const double off = held ? t.distance_from(in_place) : t.distortion();
    t.must(off < 1e-3, off_by(off), several);
}

void scrambled(HardTrial& t) {
    cube(t, at_root);
    std::mt19937 random(1);
    const auto jitter = [&] { return 0.12 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
    t.place(loose, [&](const Vec3& p) {
        const double x = jitter(), y = jitter(), z = jitter();
        return Vec3(p + Vec3(x, y, z));
    });
    t.leave_alone();
    t.run(8, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)));
}

// ---- driven by what holds them

void stretched_straight(HardTrial& t) {
    bar(t, 0);
    const Map long_one = [](const Vec3& p) { return Vec3(20 * p.x(), p.y(), p.z()); };
    t.place(far_end, long_one);
    t.run(2, 3);
    t.come_to_rest();
    // Without Poisson's ratio a bar stays as wide as it is, but the neo-Hookean one, which wrinkles.
    const bool known = t.setting.law.law != ElasticLaw::neo_hookean;
    t.must(!known || t.distance_from(long_one) < 1e-2, off_by(t.distance_from(long_one)));
}

void stretched_and_back(HardTrial& t) {
    bar(t, 0.4);
    t.place(far_end, [](const Vec3& p) { return Vec3(20 * p.x(), p.y(), p.z()); });
    t.run(2, 0.5);
    t.place(far_end, in_place);
    t.run(4, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)), several);
}

void twisted_and_back(HardTrial& t) {
    bar(t, 0.4, 6);
    const Vec3 axis(0, 0.05, 0.05);
    for (int frame = 1; frame <= 32; ++frame) {
        const double angle = M_PI / 4 * (frame <= 16 ? frame : 32 - frame);
        const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
        t.place(far_end, [&](const Vec3& p) { return frame == 32 ? p : Vec3(axis + turn * (p - axis)); });
        t.step();
    }
    t.run(4, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)), several);
}

void squashed_by_plates(HardTrial& t) {
    const Where plates = [](const Vec3& p) { return p.x() < 1e-9 || p.x() > 0.1 - 1e-9; };
    t.make(box({0.1, 0.1, 0.1}, 3, 3, 3), flesh(1e4, 0.4), plates);
    t.start();
    t.place(plates, [](const Vec3& p) { return Vec3(0.05 * p.x(), p.y(), p.z()); });
    t.run(2, 0.5);
    t.place(plates, in_place);
    t.run(8, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-4, off_by(t.distance_from(in_place)), several);
}

void squashed_with_border(HardTrial& t) {
    const Where border = [](const Vec3& p) { return p.minCoeff() < 1e-9 || p.maxCoeff() > 0.1 - 1e-9; };
    t.make(box({0.1, 0.1, 0.1}, 3, 3, 3), flesh(1e4, 0.4), border);
    t.start();
    t.place(border, [](const Vec3& p) { return Vec3(0.05 * p.x(), p.y(), p.z()); });
    t.run(2, 0.5);
    t.place(border, in_place);
    t.run(8, 2);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-4, off_by(t.distance_from(in_place)), several);
}

// ---- materials

void sag_incompressible(HardTrial& t, double nu, double conservation) {
    const auto make = [&](HardTrial& of) {
        TissueInputs values = flesh(1e5, nu);
        values.layers[0].volume_conservation = conservation;
        of.make(box({bar_length, 0.1, 0.1}, 6, 2, 2), values, at_root);
        of.start();
    };
    HardTrial slow = quiet(t);
    make(slow), make(t);
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
        slow.in.gravity = Vec3(0, 0, -9.8 * part);
        slow.step();
    }
    t.in.gravity = Vec3(0, 0, -9.8);
    t.run(2, 3);
    t.come_to_rest();
    t.must(t.distance_from(slow) < 1e-4, off_by(t.distance_from(slow)) + " from where small loads lead");
}
void nearly_incompressible(HardTrial& t) { sag_incompressible(t, 0.4999, 0); }
void volume_conserving(HardTrial& t) { sag_incompressible(t, 0.3, 1e8); }

void bodies_far_apart(HardTrial& t) {
    const double moduli[] = {1, 1e3, 1e6, 1e9, 1e12};
    const auto make = [&](HardTrial& of, std::span<const double> some) {
        of.make(box({0.2, 0.05, 0.05}, 5, 1, 1), flesh(some[0], 0.4), nowhere);
        for (std::size_t i = 1; i < some.size(); ++i) of.add_twin(flesh(some[i], 0.4)); // bodies do not meet
        of.add_bone(root_plate);
        for (std::size_t i = 0; i < some.size(); ++i)
            of.attach_root(static_cast<int>(i), static_cast<int>(some.size()), 1e6);
        of.in.gravity = Vec3(0, -9.8, 0);
        of.start();
        of.run(1, 0.25);
    };
    make(t, moduli);
    double apart = 0;
    for (std::size_t i = 0; i < std::size(moduli); ++i) {
        HardTrial alone(t.setting, {});
        make(alone, std::span(&moduli[i], 1));
        if (alone.unconverged > 0) continue;
        const int count = static_cast<int>(t.nodes.size());
        for (int v = 0; v < count; ++v)
            apart = std::max(
                apart, (position(alone.state.x, v) - position(t.state.x, static_cast<int>(i) * count + v)).norm());
    }
    t.must(apart < 1e-3, "up to " + number(apart, 3) + " m from where each is alone");
}

void stiff_half(HardTrial& t) {
    TetMesh mesh = box({0.2, 0.1, 0.1}, 4, 2, 2);
    std::vector<double> share;
    for (const Tet& tet : mesh.tets) {
        double x = 0;
        for (const int v : tet) x += 0.25 * mesh.vertices[static_cast<std::size_t>(v)].x();
        share.push_back(x > 0.1 ? 1 : 0);
    }
    TissueInputs values = flesh(1e3, 0);
    values.layers.push_back({1e11, 0, 1000, 1});
    t.make(std::move(mesh), values, at_root);
    t.rest->layer_weights.push_back(share);
    t.start();
    t.values().forces = traction_loads(
        *t.rest, [](const Vec3& p) { return p.x() > 0.2 - 1e-9; }, Vec3(100, 0, 0));
    t.run(2, 4);
    t.come_to_rest();
    // P(stretch) = 100 Pa along the soft half: of the laws in the Green strain E s (s^2 - 1)/2, of the corotational one
    // E (s - 1), of the logarithmic one E (s - 1/s)/2.
    const ElasticLaw law = t.setting.law.law;
    double low = 1, high = 2;
    for (int i = 0; i < 60; ++i) {
        const double s = 0.5 * (low + high), stress = law == ElasticLaw::corotational      ? s - 1
                                                      : law == ElasticLaw::log_neo_hookean ? 0.5 * (s - 1 / s)
                                                                                           : 0.5 * s * (s * s - 1);
        (1e3 * stress < 100 ? low : high) = s;
    }
    const Map pulled = [&](const Vec3& p) {
        return Vec3(p.x() < 0.1 ? low * p.x() : p.x() + 0.1 * (low - 1), p.y(), p.z());
    };
    const bool known = law != ElasticLaw::neo_hookean; // that one gets thinner under its own bulk term
    t.must(!known || t.distance_from(pulled) < 1e-4, off_by(t.distance_from(pulled)));
}

/// Inner vertices next to a face of their tet, and flat tets over squares of the border whose four corners lie almost
/// in a plane.
TetMesh with_slivers(TetMesh mesh, double flatness) {
    const std::size_t plain = mesh.tets.size();
    for (std::size_t t = 3; t < plain; t += 20) {
        const Tet tet = mesh.tets[t];
        Vec3 p = flatness * mesh.vertices[static_cast<std::size_t>(tet[0])];
        for (std::size_t i = 1; i < 4; ++i) p += (1 - flatness) / 3 * mesh.vertices[static_cast<std::size_t>(tet[i])];
        const int added = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(p);
        for (std::size_t i = 0; i < 4; ++i) {
            Tet part = tet;
            part[i] = added;
            if (i == 0)
                mesh.tets[t] = part;
            else
                mesh.tets.push_back(part);
        }
    }
    for (const double x : {0.1, 0.2}) {
        const auto corner = [&](double px, double py) {
            return vertices_where(mesh.vertices, [&](const Vec3& p) { return (p - Vec3(px, py, 0.1)).norm() < 1e-6; })
                .at(0);
        };
        const Tet square{corner(x, 0), corner(x + 0.05, 0), corner(x + 0.05, 0.05), corner(x, 0.05)};
        mesh.vertices[static_cast<std::size_t>(square[2])].z() += 0.05 * flatness;
        mesh.tets.push_back(square);
    }
    mesh.coverage.assign(mesh.tets.size(), 1);
    check_and_orient(mesh);
    return mesh;
}

void slivers(HardTrial& t) {
    const TetMesh plain = box({bar_length, 0.1, 0.1}, 6, 2, 2);
    HardTrial good = quiet(t);
    good.make(plain, flesh(1e5, 0.4), at_root);
    t.make(with_slivers(plain, 1e-9), flesh(1e5, 0.4), at_root);
    for (HardTrial* of : {&good, &t}) {
        of->in.gravity = Vec3(0, 0, -9.8);
        of->start();
        of->run(2, 3);
        of->come_to_rest();
    }
    const int tip = vertex_at(plain.vertices, {bar_length, 0.1, 0.1});
    const double sag = 0.1 - position(good.state.x, tip).z(), bad = 0.1 - position(t.state.x, tip).z();
    t.must(std::abs(bad / sag - 1) < 0.01, "sags by " + number(bad) + " m, without slivers by " + number(sag));
}

// ---- time

void steps_of_a_second(HardTrial& t) {
    const TissueInputs values = flesh(3e4, 0.4);
    HardTrial slow = quiet(t);
    hang_on_bone(slow, values);
    slow.start();
    for (int part = 1; part <= 8; ++part) {
        slow.in.gravity = Vec3(0, -9.8 * part / 8, 0);
        slow.step();
    }
    hang_on_bone(t, values);
    t.in.gravity = Vec3(0, -9.8, 0);
    t.in.step_size = 1, t.in.mass_damping = 0;
    t.start();
    t.run(2, 30);
    t.must(t.distance_from(slow) < 1e-3, off_by(t.distance_from(slow)) + " from where small loads lead");
}

const Mat3 quarter = Eigen::AngleAxisd(M_PI / 2, Vec3(0, 0, 1)).toRotationMatrix();
Vec3 turned(const Vec3& p) { return quarter * p; }
Vec3 jumped(const Vec3& p) { return p + Vec3(1, 2, -2); }
Vec3 turned_and_jumped(const Vec3& p) { return jumped(turned(p)); }

template <Vec3 (*move)(const Vec3&)>
void bone_moves(HardTrial& t) {
    hang_on_bone(t, flesh(1e4, 0.4));
    t.start();
    t.move_bone(1, move);
    t.run(2, 4);
    t.come_to_rest();
    t.must(t.distance_from(move) < 1e-3, off_by(t.distance_from(move)));
}

void full_excitation(HardTrial& t) {
    TissueInputs values = flesh(1.2e4, 0.4);
    values.fibers = {{2e6, 0.5, 0, 1}};
    HardTrial slow = quiet(t);
    for (HardTrial* of : {&slow, &t}) {
        of->make(box({bar_length, 0.1, 0.1}, 5, 2, 2), values, at_root);
        of->start();
    }
    for (int frame = 1; frame <= 10; ++frame) {
        slow.values().fibers[0].excitation = 0.1 * frame;
        slow.step();
    }
    t.values().fibers[0].excitation = 1;
    t.run(2, 3);
    t.come_to_rest();
    t.must(t.distance_from(slow) < 1e-3, off_by(t.distance_from(slow)) + " from where a slow rise leads");
}

// ---- rest shapes that change

/// restScale and its envelope, or muscleGrowthScale, and what they make of lengths across and along the fibres, which
/// run along x.
struct Change {
    double scale = 1, envelope = 1, growth = 1;
    double along() const { return std::pow(scale, envelope); }
    double across() const { return along() * growth; }
    Mat3 matrix() const { return Vec3(along(), across(), across()).asDiagonal(); }
    void put(HardTrial& t) const {
        t.values().layers[0].rest_scale = scale;
        t.values().rest_scale_envelope = envelope;
        t.values().fibers[0].growth = growth;
        t.volume_at_rest = along() * across() * across();
    }
};
/// From one change to another, both within the range that a painted layer is likely to ask for.
constexpr Change changes[][2] = {{{1, 1}, {2, 2}},      {{1, 1}, {0.5, 2}},       {{2, -1}, {2, 2}},
                                 {{0.5, -1}, {0.5, 2}}, {{1, 1, 0.5}, {1, 1, 2}}, {{1, 1, 2}, {1, 1, 0.5}}};

TissueInputs muscle() {
    TissueInputs values = flesh(1.2e4, 0.4);
    values.fibers = {{1e4, 1, 0, 1}};
    return values;
}

template <int which>
void free_rest_changes(HardTrial& t) {
    t.make(box({bar_length, 0.1, 0.1}, 3, 1, 1), muscle(), nowhere);
    t.start();
    for (const Change& change : changes[which]) {
        change.put(t);
        t.run(2, 1);
        t.come_to_rest();
    }
    const double off = t.distortion(changes[which][1].matrix());
    t.must(off < 1e-3 * changes[which][1].along(), "distorted by " + number(off, 3) + " m", several);
}

/// A little weight to one side [m/s^2]. Where a clamp has become twice as wide as what it holds, the flesh beside it
/// buckles; in perfect symmetry the ridge between two ways to buckle is an equilibrium too, and slow changes end on it.
Vec3 aside() { return {0, -0.1, 0.04}; }
/// What has buckled creeps for long before it is at rest.
void creep_to_rest(HardTrial& t) {
    for (int i = 0; i < 4; ++i) t.come_to_rest();
}

template <int which>
void held_rest_changes(HardTrial& t) {
    HardTrial slow = quiet(t);
    for (HardTrial* of : {&slow, &t}) {
        of->make(box({bar_length, 0.1, 0.1}, 4, 2, 2), muscle(), at_root);
        of->in.gravity = aside();
        of->start();
    }
    const auto [from, to] = changes[which];
    constexpr int parts = 24; // from the model to where it must end
    for (int i = 1; i <= parts; ++i) {
        const double share = double(i) / parts;
        Change part{to.scale, share * to.envelope, std::lerp(1, to.growth, share)};
        part.put(slow);
        slow.step();
    }
    from.put(t);
    t.run(2, 0.5);
    to.put(t);
    t.run(2, 3);
    creep_to_rest(t);
    t.must(t.distance_from(slow) < 1e-3, off_by(t.distance_from(slow)) + " from where a slow change leads", several);
}

/// A target that stretches, squeezes and shears, put in all at once, turned to its reciprocal, and put in again.
Mat3 far_target() {
    Mat3 to = Vec3(1.8, 0.6, 1).asDiagonal();
    to(0, 1) = 0.5;
    return to;
}

void make_with_target(HardTrial& t, TetMesh mesh, const Where& held) {
    Points moved;
    for (const Vec3& p : mesh.vertices) moved.push_back(far_target() * p);
    auto shape = std::make_shared<RestShape>(make_rest_shape(mesh, moved, std::vector<double>(mesh.tets.size(), 1.0)));
    t.make(std::move(mesh), muscle(), held);
    t.description.parts = {{&rest_shape_type, {0}, shape}};
    t.in.parts = {{0}};
    t.start();
}

void set_target_weight(HardTrial& t, double weight) {
    t.in.parts[0] = {weight};
    t.volume_at_rest = std::pow(far_target().determinant(), weight);
}

void free_target(HardTrial& t) {
    make_with_target(t, box({bar_length, 0.1, 0.1}, 3, 1, 1), nowhere);
    for (const double weight : {1.0, -1.0, 1.0}) {
        set_target_weight(t, weight);
        t.run(2, 1);
        t.come_to_rest();
    }
    const double off = t.distortion(far_target());
    t.must(off < 1e-3, "distorted by " + number(off, 3) + " m", several);
}

void held_target(HardTrial& t) {
    HardTrial slow = quiet(t);
    for (HardTrial* of : {&slow, &t}) {
        of->in.gravity = aside();
        make_with_target(*of, box({bar_length, 0.1, 0.1}, 4, 2, 2), at_root);
    }
    constexpr int parts = 24;
    for (int i = 1; i <= parts; ++i) {
        set_target_weight(slow, static_cast<double>(i) / parts);
        slow.step();
    }
    set_target_weight(t, 1);
    t.run(2, 3);
    creep_to_rest(t);
    t.must(t.distance_from(slow) < 1e-3, off_by(t.distance_from(slow)) + " from where a slow change leads", several);
}

// ---- no numbers

enum class Spoilt { bone, modulus, gravity };
template <Spoilt what>
void not_a_number_comes_in(HardTrial& t) {
    hang_on_bone(t, flesh(1e5, 0.4));
    t.in.gravity = Vec3(0, -9.8, 0);
    t.start();
    t.run(1, 0.125);
    if (what == Spoilt::bone) t.move_bone(1, [](const Vec3& p) { return Vec3(p.x(), NAN, p.z()); });
    if (what == Spoilt::modulus) t.values().layers[0].youngs_modulus = NAN;
    if (what == Spoilt::gravity) t.in.gravity.y() = NAN;
    t.run(1, 0.125);
    throw WrongAnswer{"a step was taken with a value that is no number"};
}

constexpr HardCase cases[] = {
    {"free body squeezed", "into a plane", "rest shape, centre in place", free_squeezed<plane>},
    {"free body squeezed", "into a slanted plane", "rest shape, centre in place", free_squeezed<slanted_plane>, false},
    {"free body squeezed", "into a point", "rest shape, centre in place", free_squeezed<point>, false},
    {"held body squeezed", "into its held plane", "in place", held_squeezed<slanted_plane>},
    {"held body squeezed", "into a point", "in place", held_squeezed<point>, false},
    {"random vertices", "held at a face", "in place", random_vertices<true>},
    {"random vertices", "free", "rest shape", random_vertices<false>, false},
    {"scrambled by a quarter of the spacing", "", "in place", scrambled},
    {"stretched x 20 in a frame", "nu 0", "closed form", stretched_straight},
    {"stretched x 20 in a frame", "and back", "in place", stretched_and_back, false},
    {"two turns of twist", "and back", "in place", twisted_and_back},
    {"squashed to 1/20 by held plates", "and back", "in place", squashed_by_plates},
    {"squashed to 1/20 with its border", "and back", "in place", squashed_with_border},
    {"nearly incompressible", "nu 0.4999", "as under small loads", nearly_incompressible},
    {"nearly incompressible", "volumeConservation 1000 E", "as under small loads", volume_conserving, false},
    {"1 Pa to 1e12 Pa in one scene", "", "each as alone", bodies_far_apart},
    {"halves 1e8 apart in one body", "", "closed form", stiff_half},
    {"slivers of 1e-9", "", "sag of a good mesh", slivers},
    {"steps of a second", "", "as under small loads", steps_of_a_second},
    {"bone in one frame", "turns by 90 degrees", "carried along rigidly", bone_moves<turned>},
    {"bone in one frame", "jumps ten lengths", "carried along rigidly", bone_moves<jumped>, false},
    {"bone in one frame", "turns and jumps", "carried along rigidly", bone_moves<turned_and_jumped>, false},
    {"full excitation in one frame", "", "as after a slow rise", full_excitation},
    {"rest shape in one frame", "free, lengths x 4", "exactly scaled", free_rest_changes<0>},
    {"rest shape in one frame", "free, lengths / 4", "exactly scaled", free_rest_changes<1>, false},
    {"rest shape in one frame", "free, lengths / 2, then x 4", "exactly scaled", free_rest_changes<2>, false},
    {"rest shape in one frame", "free, lengths x 2, then / 4", "exactly scaled", free_rest_changes<3>, false},
    {"rest shape in one frame", "free, growth 0.5, then 2", "exactly grown", free_rest_changes<4>},
    {"rest shape in one frame", "free, growth 2, then 0.5", "exactly grown", free_rest_changes<5>, false},
    {"rest shape in one frame", "held, lengths x 4", "as after a slow change", held_rest_changes<0>, false},
    {"rest shape in one frame", "held, lengths / 4", "as after a slow change", held_rest_changes<1>, false},
    {"rest shape in one frame", "held, growth 0.5, then 2", "as after a slow change", held_rest_changes<4>, false},
    {"rest shape in one frame", "held, growth 2, then 0.5", "as after a slow change", held_rest_changes<5>},
    {"rest shape in one frame", "free, into a target, its reciprocal and back", "shaped as the target", free_target,
     false},
    {"rest shape in one frame", "held, into a target", "as after a slow change", held_target, false},
    {"not a number comes in", "of a bone", "an error", not_a_number_comes_in<Spoilt::bone>},
    {"not a number comes in", "of a material", "an error", not_a_number_comes_in<Spoilt::modulus>, false},
    {"not a number comes in", "of gravity", "an error", not_a_number_comes_in<Spoilt::gravity>, false},
};

} // namespace

std::span<const HardCase> hard_cases() {
    static const std::vector<HardCase> all = [] {
        std::vector<HardCase> out(std::begin(cases), std::end(cases));
        out.insert(out.end(), hard_contact_cases().begin(), hard_contact_cases().end());
        out.insert(out.end(), hard_cloth_cases().begin(), hard_cloth_cases().end());
        return out;
    }();
    return all;
}

} // namespace sinew::bench
