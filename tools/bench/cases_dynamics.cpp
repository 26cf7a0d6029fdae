// Accuracy in time: one degree of freedom digit by digit, amplification, free fall, and a released bar.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/accuracy.h"
#include "tools/bench/bar_release.h"
#include "tools/bench/oscillator.h"
#include "tools/bench/reference.h"

#include <cmath>
#include <complex>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

/// Steps of "dt=1/48".
int steps_of(const std::string& title) { return std::stoi(title.substr(title.find('/') + 1)); }

void one_dof(Book& book, const RunOptions&) {
    book.open("5", "oscillator, exact sequence");
    const json& reference = reference_values()["integrators"]["one_dof"];
    const auto check = [&](const json& runs, double damping, const std::string& name) {
        for (const auto& [title, schemes] : runs.items())
            for (const IntegratorName& scheme : integrators) {
                if (!schemes.contains(std::string(scheme.catalogue))) continue;
                const json& expected = schemes[std::string(scheme.catalogue)];
                const json& first = expected["z_first_steps"];
                const int steps = steps_of(title);
                Oscillator o(scheme.integrator, 1.0 / steps, damping);
                double worst = 0;
                for (int i = 1; i <= steps; ++i) {
                    o.sim.step();
                    if (i < static_cast<int>(first.size()))
                        worst =
                            std::max(worst, std::abs(o.height() - first[static_cast<std::size_t>(i)].get<double>()));
                }
                const double end = expected["z_end"];
                worst = std::max(worst, std::abs(o.height() - end));
                book.judge(CaseKind::exact, std::string(scheme.word) + ", " + title + name,
                           "height at 1 s, worst of 13 [m]", o.height(), end, worst / o.sag, 1e-8, o.sim.work);
            }
    };
    check(reference["runs"], 0, "");
    const json& damped = reference["with_viscous_damping"];
    check(damped["runs"], damped["c_per_mass"], ", damped 5 %");
}

void amplification(Book& book, const RunOptions&) {
    book.open("5", "amplification of a step");
    using Complex = std::complex<double>;
    const json& table = reference_values()["integrators"]["table"];
    for (const IntegratorName& scheme : integrators)
        for (const auto& [title, row] : table[std::string(scheme.catalogue)].items()) {
            const Complex expected =
                std::polar(row["spectral_radius"].get<double>(), row["phase_per_step"].get<double>());
            const double omega = Oscillator(scheme.integrator, 1).omega, speed = 0.1;
            Oscillator o(scheme.integrator, std::stod(title) * 2 * M_PI / omega, 0, speed);
            // Without gravity, y = z + v / (i omega) is multiplied by the same complex number in every step. BDF2 has
            // two such numbers; a history on its principal root keeps the other one out.
            const Complex start(0, -speed / omega);
            if (scheme.integrator == Integrator::bdf2) o.set_history(start / expected);
            o.sim.step();
            // The table gives phases without their sign.
            const Complex y = Complex(o.height(), -o.speed() / omega) / start, r(y.real(), std::abs(y.imag()));
            const std::string setting = std::string(scheme.word) + ", dt/T " + title;
            book.judge(CaseKind::exact, setting, "spectral radius and phase", std::abs(r), std::abs(expected),
                       std::abs(r - expected), 1e-8, o.sim.work);
        }
}

/// A box that nothing holds; its fall in one second [m] and its greatest deformation [m].
struct Fall {
    double height, deformation;
    Work work;
    Fall(const IntegratorName& scheme, int steps, double start_speed, double mass_damping,
         const std::stop_token& stop) {
        const TetMesh mesh = box_mesh({0, 0, 0}, {0.3, 0.2, 0.2}, 3, 2, 2);
        StepInputs in = tight_inputs();
        in.integrator = scheme.integrator;
        in.gravity = Vec3(0, 0, -9.81);
        in.mass_damping = mass_damping;
        in.step_size = 1.0 / steps;
        in.bodies = {material(1e4, 0.45)};
        const InitialMotion start{Vec3(0, 0, start_speed), Vec3::Zero()};
        Simulation sim({{make_tissue(mesh, ElasticLaw::stvk)}, {}, {}}, in, stop, {&start, 1});
        for (int i = 0; i < steps; ++i) sim.step();
        height = position(sim.state.x, 0).z() - mesh.vertices[0].z();
        deformation = 0;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            deformation =
                std::max(deformation,
                         (position(sim.state.x, static_cast<int>(v)) - mesh.vertices[v] - Vec3(0, 0, height)).norm());
        work = sim.work;
    }
};

void free_fall(Book& book, const RunOptions& options) {
    const json& reference = reference_values()["integrators"]["free_fall"];
    for (const bool damped : {false, true}) {
        book.open("6", damped ? "free fall with mass damping" : "free fall");
        const json& of = damped ? reference["mass_damping"] : reference;
        const double alpha = damped ? of["alpha"].get<double>() : 0;
        for (const auto& [title, schemes] : of["discrete"].items())
            for (const IntegratorName& scheme : integrators) {
                const Fall fall(scheme, steps_of(title), damped ? 0 : 2, alpha, options.stop);
                const double expected = schemes[std::string(scheme.catalogue)]["x"];
                const std::string setting = std::string(scheme.word) + ", " + title;
                book.compare(CaseKind::exact, setting, "height at 1 s [m]", fall.height, expected, 1e-8, fall.work);
                book.judge(CaseKind::exact, setting, "deformation [L]", fall.deformation / 0.3, 0,
                           fall.deformation / 0.3, 1e-9, fall.work);
            }
    }
}

/// Euler and Bernoulli's first mode of a bar that is held at 0 and free at 1.
double first_mode(double x) {
    const double b = 1.8751040687, s = 0.7340955138;
    return std::cosh(b * x) - std::cos(b * x) - s * (std::sinh(b * x) - std::sin(b * x));
}

/// A bar that is held at one end and set in motion, so slowly that it stays a linear system; its frequency by the times
/// at which it passes through rest. The tets' diagonals make it stiffer along y + z than along y - z.
void vibration_in_time(Book& book, const RunOptions& options) {
    book.open("4", "free vibration, counted in time");
    const json& r = reference_values()["free_vibration"]["P1 Kuhn (16, 2, 2) lumped"];
    const double length = 0.8;
    for (const int mode : {0, 1}) {
        const double expected = r[static_cast<std::size_t>(mode)], h = 1 / (200 * expected);
        const Vec3 along = Vec3(0, 1, mode == 0 ? -1 : 1).normalized();
        const auto rest = make_tissue(box_mesh({0, 0, 0}, {length, 0.1, 0.1}, 16, 2, 2), ElasticLaw::corotational);
        StepInputs in = tight_inputs();
        in.integrator = Integrator::tr_bdf2, in.step_size = h;
        in.tolerance_factor = 1e-2;
        // Calms the higher modes, which the start sets in motion too; by how much it slows the first one is known.
        in.stiffness_damping = 4e-3;
        in.bodies = {material(1e6, 0.4)};
        in.parts = {hold_values()};
        const InitialMotion start{1e-3 * along, Vec3::Zero()};
        Simulation sim({{rest}, {}, {hold_where(*rest, 0, [](const Vec3& p) { return p.x() < 1e-9; })}}, in,
                       options.stop, {&start, 1});
        // How far the bar is out in the shape of its first mode, which sees nothing of the higher ones.
        const auto out = [&] {
            double sum = 0;
            for (std::size_t v = 0; v < rest->tets.vertices.size(); ++v) {
                const Vec3& p = rest->tets.vertices[v];
                sum += first_mode(p.x() / length) * along.dot(position(sim.state.x, static_cast<int>(v)) - p);
            }
            return sum;
        };
        double before = 0, first = 0, last = 0;
        constexpr int calm = 4;
        int passes = 0;
        for (int i = 1; i <= (options.quick ? 1020 : 2020); ++i) {
            sim.step();
            const double now = out();
            if (before * now < 0) {
                last = h * (i - 1 + before / (before - now));
                if (++passes == calm) first = last;
            }
            before = now;
        }
        const double counted = 0.5 * (passes - calm) / (last - first), ratio = M_PI * in.stiffness_damping * counted;
        book.compare(CaseKind::same_mesh, mode == 0 ? "16x2x2, linear, y - z" : "16x2x2, linear, y + z",
                     "frequency [Hz], TR-BDF2, dt = T/200", counted / std::sqrt(1 - ratio * ratio), expected, 1e-4,
                     sim.work);
    }
}

/// Sub-steps of a frame at which the bar's fastest modes are resolved well enough for the order to show.
int most_substeps(const IntegratorName& scheme) {
    switch (scheme.integrator) {
    case Integrator::backward_euler:
        return 128;
    case Integrator::bdf2:
        return 256;
    default:
        return 64;
    }
}

void bar(Book& book, const RunOptions& options) {
    book.open("13", "released bar");
    const double length = 0.4;
    for (const LawName& law : laws) {
        if (!bar_is_known(law)) continue;
        for (const IntegratorName& scheme : integrators) {
            std::vector<double> h, errors;
            Work total;
            const std::string setting = std::string(law.catalogue) + ", " + std::string(scheme.word);
            for (int substeps = 1; substeps <= (options.quick ? 4 : most_substeps(scheme)); substeps *= 2) {
                // Rounding of the inertia, which grows with the square of the rate, leaves no more than this at small
                // steps.
                const double tolerance = substeps > 16 ? 1e-3 : 1e-4;
                const BarTrajectory run = run_bar({law, scheme, 8, substeps, tolerance}, options.stop);
                total += run.work;
                h.push_back(1.0 / (24 * substeps));
                errors.push_back(rms_distance(run.tip, bar_on_mesh(law, 8)));
                const Points expected = bar_scheme(law, scheme, substeps);
                if (expected.empty()) continue;
                const double worst = largest_distance(run.tip, expected);
                book.judge(CaseKind::exact, setting + ", dt=1/" + std::to_string(24 * substeps),
                           "tip over 1 s, farthest [m]", run.tip.back().z(), expected.back().z(), worst / length, 1e-7,
                           run.work);
            }
            if (options.quick) continue; // the order shows only at small steps
            // Fitted over the last three step sizes, a factor of 4; the catalogue accepts 0.85 for 1 and 1.8 for 2.
            const std::size_t n = errors.size();
            book.slope(setting + ", dt to 1/" + std::to_string(24 << (n - 1)),
                       "rms distance to the run exact in time [m]", errors.back(),
                       observed_order(h[n - 3], errors[n - 3], h[n - 1], errors[n - 1]), scheme.order == 1 ? 0.85 : 1.8,
                       total);
        }
    }
}

} // namespace

std::vector<AccuracyCase> dynamic_cases() {
    return {{"oscillator, exact sequence", one_dof},
            {"amplification of a step", amplification},
            {"free fall", free_fall},
            {"free vibration, counted in time", vibration_in_time},
            {"released bar", bar}};
}

} // namespace sinew::bench
