// The hard cases of contact: bones that cross or turn into bodies within a frame, plates that squash, masses and
// stiffnesses far apart, bodies that begin deep in each other, thin sheets that meet fast.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"
#include "tools/bench/hard_cases.h"
#include "tools/bench/table.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr double spring = 1e6; // [N/m^3]

bool nowhere(const Vec3&) { return false; }
Vec3 in_place(const Vec3& p) { return p; }

TissueInputs flesh(double youngs_modulus, double density = 1000) {
    TissueInputs t = material(youngs_modulus, 0.4, density);
    t.compression_resistance = TissueInputs().compression_resistance;
    return t;
}

/// Lets a body take part, with this stiffness [N/m^3].
void touches(HardTrial& t, int body, double stiffness = spring) {
    t.description.parts.push_back({&contact_type, {body}, std::make_shared<ContactRest>()});
    ContactValues values;
    values.stiffness = stiffness;
    PartValues& out = t.in.parts.emplace_back(contact_type.values.size());
    put_fields(values, out);
}

/// Another tissue of the same law and element, tied to nothing.
int add_body(HardTrial& t, TetMesh mesh, const TissueInputs& values) {
    const std::size_t tets = mesh.tets.size();
    auto rest = make_tissue(std::move(mesh), t.setting.law.law, t.setting.element.kind);
    if (t.setting.law.law == ElasticLaw::anisotropic) rest->stiff_directions.assign(tets, Vec3::UnitX());
    t.description.bodies.emplace_back(std::shared_ptr<const TissueRest>(std::move(rest)));
    t.in.bodies.emplace_back(values);
    std::get<TissueInputs>(t.in.bodies.back()).transverse_anisotropy = t.values().transverse_anisotropy;
    return static_cast<int>(t.description.bodies.size()) - 1;
}

/// A bone in the form of a box, in triangles as wide as `cell`.
int add_block(HardTrial& t, const Vec3& low, const Vec3& high, double cell) {
    const auto cells = [&](int c) { return static_cast<int>(std::lround((high[c] - low[c]) / cell)); };
    const TetMesh mesh = box_mesh(low, high, cells(0), cells(1), cells(2));
    auto bone = std::make_shared<BoneRest>();
    bone->surface = mesh.vertices, bone->triangles = boundary_triangles(mesh.tets);
    t.in.bodies.emplace_back(BoneInputs{bone->surface});
    t.description.bodies.emplace_back(std::shared_ptr<const BoneRest>(std::move(bone)));
    return static_cast<int>(t.description.bodies.size()) - 1;
}

double measured(const HardTrial& t, const char* name) { return value_of(t.state.record.measured, "contact", name); }

std::string off_by(double distance) { return "off by " + number(distance, 3) + " m"; }

/// What a bone has gone through by more than a tet's width may stay hooked on it by points near its edges: in balance,
/// and the report's depth tells of it.
using enum HardTrial::Equilibria;
std::string hooked(const HardTrial& t) {
    return number(measured(t, "contacts"), 3) + " contacts, " + number(measured(t, "max_depth_m"), 3) + " m deep";
}

/// A beam that is held at its root, and a block below its far end.
int beam_over_block(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {0.3, 0.1, 0.1}, 6, 2, 2), flesh(1e4), [](const Vec3& p) { return p.x() < 1e-9; });
    const int block = add_block(t, {0.16, -0.1, -0.08}, {0.36, -0.02, 0.2}, 0.02);
    touches(t, 0), touches(t, block);
    t.start();
    return block;
}

void bone_crosses(HardTrial& t) {
    const int block = beam_over_block(t);
    t.move_bone(block, [](const Vec3& p) { return Vec3(p.x(), p.y() + 0.24, p.z()); });
    t.step(); // from below the beam to above it
    if (t.state.record.converged && measured(t, "contacts") == 0)
        throw WrongAnswer{"the bone went through, and nothing touched it"};
    t.run(1, 1);
    t.move_bone(block, [](const Vec3& p) { return Vec3(p.x(), p.y() - 0.24, p.z()); });
    t.run(8, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)) + ", " + hooked(t), several);
}

void bone_turns_into(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {0.3, 0.1, 0.1}, 6, 2, 2), flesh(1e4), [](const Vec3& p) { return p.x() < 1e-9; });
    const Vec3 hinge(0.35, -0.2, 0);
    const int paddle = add_block(t, {0.35, -0.22, -0.06}, {0.75, -0.18, 0.16}, 0.02);
    touches(t, 0), touches(t, paddle);
    t.start();
    const auto turn = [&](double angle) {
        const Mat3 r = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
        t.move_bone(paddle, [&](const Vec3& p) { return Vec3(hinge + r * (p - hinge)); });
    };
    turn(M_PI / 2); // upright beside the beam's end
    t.step();
    turn(M_PI / 6); // into it
    t.run(1, 1);
    turn(-M_PI / 6 - M_PI / 2);
    t.run(8, 3);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, off_by(t.distance_from(in_place)) + ", " + hooked(t), several);
}

void squashed_between_plates(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {1, 1, 1}, 2, 2, 2), flesh(1e4), nowhere);
    const int low = add_block(t, {-1, -0.5, -1}, {2, 0, 2}, 0.25), high = add_block(t, {-1, 1, -1}, {2, 1.5, 2}, 0.25);
    for (const int body : {0, low, high}) touches(t, body);
    t.start();
    const auto close = [&](double way) {
        t.move_bone(high, [&](const Vec3& p) { return Vec3(p.x(), p.y() - way, p.z()); });
    };
    for (int frame = 0; frame < 10; ++frame) close(0.095), t.step();
    close(-0.95);
    t.run(2, 3);
    t.come_to_rest();
    t.must(t.distortion() < 1e-3, "distorted by " + number(t.distortion(), 3) + " m");
}

/// What stands on a body that is held below, or on bone, presses with its weight. Under a hard edge it is deeper than
/// in the mean, `uneven` times at most.
void must_carry(HardTrial& t, double weight, double depth, double uneven) {
    t.run(3, 3);
    t.come_to_rest();
    const double force = measured(t, "force_N"), deepest = measured(t, "max_depth_m");
    t.must(std::abs(force / weight - 1) < 0.01 && deepest > 0.9 * depth && deepest < uneven * depth,
           "presses with " + number(force, 4) + " N for " + number(weight, 4) + " N, " + number(deepest, 3) +
               " m deep for " + number(depth, 3) + " m");
}

void heavy_on_light(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {1, 1, 1}, 2, 2, 2), flesh(1e6, 1), [](const Vec3& p) { return p.y() < 1e-9; });
    const int heavy = add_body(t, box_mesh({0.25, 1, 0.25}, {0.75, 1.5, 0.75}, 2, 2, 2), flesh(1e6, 8e6));
    touches(t, 0, 1e7), touches(t, heavy, 1e7); // 1 kg and 1e6 kg
    t.in.gravity = Vec3(0, -0.01, 0);
    t.start();
    t.in.step_size = 0.25, t.in.mass_damping = 2; // it sways once in ten seconds
    t.run(1, 40);
    must_carry(t, 1e4, 1e4 / (1e7 * 0.25), 4);
}

/// Nothing holds the cube but what it stands on: no friction. Where the ground's points are the finer ones they carry
/// it, those that happen to be below it, and press along its bottom: it leans to where they are fewer, and glides there
/// until those beside it meet its sides. It may come to rest within a square of the ground, deeper on one side.
template <bool finer>
void stiffnesses_apart(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {1, 1, 1}, 2, 2, 2), flesh(1e6), nowhere);
    constexpr double square = finer ? 0.25 : 4, margin = finer ? 1.125 : 1.5;
    const int ground = add_block(t, {-margin, -square, -margin}, {1 + margin, 0, 1 + margin}, square);
    touches(t, 0, 1e5), touches(t, ground, 1e13); // 2e5 in all
    t.in.gravity = Vec3(0, -9.8, 0);
    t.start();
    if (!finer) return must_carry(t, 9800, 9800 / 2e5, 1.1);
    t.run(3, 3);
    t.come_to_rest();
    Vec3 drift = t.centre() - Vec3::Constant(0.5);
    drift.y() = 0;
    t.must(drift.norm() < square && measured(t, "max_depth_m") < square,
           "drifted by " + number(drift.norm(), 3) + " m, " + hooked(t));
}

void soft_under_rigid(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {1, 1, 1}, 2, 2, 2), flesh(1e4), [](const Vec3& p) { return p.y() < 1e-9; });
    const int rigid = add_body(t, box_mesh({0.25, 1, 0.25}, {0.75, 1.5, 0.75}, 2, 2, 2), flesh(1e12));
    touches(t, 0), touches(t, rigid);
    t.in.gravity = Vec3(0, -1, 0);
    t.start();
    must_carry(t, 125, 125 / (spring * 0.25), 4);
}

/// A little deep all nearest places lead apart; where it is deeper some lead against each other.
template <bool deeper>
void begins_deep_inside(HardTrial& t) {
    const Vec3 at = deeper ? Vec3(0.6, 0.1, 0.15) : Vec3(0.85, 0.25, 0.2);
    t.make(box_mesh(Vec3::Zero(), {1, 1, 1}, 2, 2, 2), flesh(1e5), nowhere);
    const int other = add_body(t, box_mesh(at, at + Vec3::Ones(), 2, 2, 2), flesh(1e5));
    touches(t, 0), touches(t, other);
    t.start();
    t.run(60, 4); // without inertia each step finds balance with what the last one touched
    t.come_to_rest();
    t.must(t.distortion() < 2e-3 && measured(t, "max_depth_m") < 1e-3,
           "distorted by " + number(t.distortion(), 3) + " m, " + hooked(t), deeper ? several : one);
}

/// Two sheets a centimetre thick; the upper one comes down by eighty times that in the first frame.
void sheet_on_sheet(HardTrial& t) {
    t.make(box_mesh(Vec3::Zero(), {1, 0.01, 1}, 6, 1, 6), flesh(1e6),
           [](const Vec3& p) { return p.x() < 1e-9 || p.x() > 1 - 1e-9 || p.z() < 1e-9 || p.z() > 1 - 1e-9; });
    const int upper = add_body(t, box_mesh({0.2, 0.4, 0.2}, {0.8, 0.41, 0.8}, 4, 1, 4), flesh(1e6));
    touches(t, 0), touches(t, upper);
    t.in.gravity = Vec3(0, -9.8, 0);
    t.start();
    const auto of_upper = static_cast<std::size_t>(t.nodes.size());
    if (!t.is_static())
        for (std::size_t i = 3 * of_upper + 1; i < t.state.v.size(); i += 3) t.state.v[i] = -20;
    t.run(3, 3);
    t.come_to_rest();
    double lowest = INFINITY, sag = INFINITY;
    for (std::size_t i = 3 * of_upper + 1; i < t.state.x.size(); i += 3) lowest = std::min(lowest, t.state.x[i]);
    for (std::size_t i = 1; i < 3 * of_upper; i += 3) sag = std::min(sag, t.state.x[i]);
    t.must(lowest > sag - 0.01,
           "the upper sheet is at " + number(lowest, 3) + " m, the lower one at " + number(sag, 3) + " m");
}

constexpr HardCase cases[] = {
    {"contact: bone in one frame", "crosses a body, and back", "in place", bone_crosses},
    {"contact: bone in one frame", "turns by 90 degrees, into a body, and back", "in place", bone_turns_into, false},
    {"contact: squashed to 1/20 by plates", "and back", "rest shape", squashed_between_plates},
    {"contact: masses 1e6 apart", "the heavy on the light", "weight over area", heavy_on_light},
    {"contact: stiffnesses 1e8 apart", "of contacts", "weight over area", stiffnesses_apart<false>, false},
    {"contact: stiffnesses 1e8 apart", "of contacts, on finer ground", "within one square of it",
     stiffnesses_apart<true>, false},
    {"contact: stiffnesses 1e8 apart", "of bodies", "weight over area", soft_under_rigid},
    {"contact: begins inside another body", "0.15 of its size deep", "apart, rest shape", begins_deep_inside<false>},
    {"contact: begins inside another body", "0.4 of its size deep", "apart, rest shape", begins_deep_inside<true>,
     false},
    {"contact: thin sheets", "at 20 m/s", "one upon the other", sheet_on_sheet, false},
};

} // namespace

std::span<const HardCase> hard_contact_cases() { return cases; }

} // namespace sinew::bench
