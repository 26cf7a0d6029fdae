// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/field/force.h"

#include "solver/error.h"
#include "solver/terms/field/dual.h"
#include "solver/terms/field/noise.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Where the fade at a border begins, as a share of the way there.
constexpr double fade_start = 0.8;
/// Share of a volume's radius within which directions away from its centre and axis go down to zero.
constexpr double core = 0.1;

/// 1 inside, 0 from `share` = 1 on.
template <class T>
T fade(const T& share) {
    if (value_of(share) <= fade_start) return T(1);
    if (value_of(share) >= 1) return T(0);
    const T u = (T(1) - share) / T(1 - fade_start);
    return u * u * (T(3) - T(2) * u);
}

template <class T>
T weight(const FieldAt& f, const T& distance) {
    const FieldValues& v = f.values;
    T w(1);
    if (v.attenuation != 0 && value_of(distance) > v.reference_distance)
        w = power(T(v.reference_distance) / distance, v.attenuation);
    if (f.rest->use_max_distance) w = w * fade(distance / T(v.max_distance));
    return w;
}

/// The vector, of length 1 where it is longer than `least`, linear within.
template <class T>
Triple<T> softened(const Triple<T>& a, const T& length, double least) {
    return (value_of(length) > least ? T(1) / length : T(1 / least)) * a;
}

template <class T>
Triple<T> triple(const Vec3& a) {
    return {T(a[0]), T(a[1]), T(a[2])};
}
template <class T>
Triple<T> cross(const Vec3& a, const Triple<T>& b) {
    return {T(a[1]) * b[2] - T(a[2]) * b[1], T(a[2]) * b[0] - T(a[0]) * b[2], T(a[0]) * b[1] - T(a[1]) * b[0]};
}

template <class T>
Triple<T> air(const FieldAt& f, const T& strength, const Triple<T>& v) {
    // A negative magnitude blows the other way.
    const Vec3 e = std::copysign(1.0, f.values.magnitude) * f.direction;
    const T c = T(std::abs(f.values.magnitude) / f.values.air_speed) * strength;
    if (!f.rest->component_only) return c * (T(f.values.air_speed) * triple<T>(e) - v);
    const T lag = T(f.values.air_speed) - dot(v, e);
    return value_of(lag) > 0 ? c * lag * triple<T>(e) : Triple<T>{};
}

/// The velocity that a drag brakes.
template <class T>
Triple<T> braked(const FieldAt& f, const Triple<T>& v) {
    return f.rest->use_direction ? dot(v, f.direction) * triple<T>(f.direction) : v;
}

template <class T>
Triple<T> drag(const FieldAt& f, const T& strength, const Triple<T>& v) {
    const Triple<T> u = braked(f, v);
    T factor = T(-f.values.magnitude) * strength;
    if (f.values.speed_attenuation > 0) {
        const T speed = norm(u);
        if (value_of(speed) < f.values.speed_attenuation) factor = factor * speed / T(f.values.speed_attenuation);
    }
    return factor * u;
}

template <class T>
Triple<T> turbulence(const FieldAt& f, const Triple<T>& from_place) {
    const FieldValues& v = f.values;
    Triple<T> sum{};
    double share = 1, squares = 0, scale = 1 / v.wavelength, pace = 1;
    for (int layer = 0; layer <= f.rest->noise_level; ++layer) {
        const Triple<T> place = T(scale) * from_place + triple<T>(pace * Vec3(v.phase_x, v.phase_y, v.phase_z));
        sum = sum + T(share) * noise(place, pace * v.evolution, layer);
        squares += share * share;
        share *= v.noise_ratio, scale *= 2, pace *= 2;
    }
    return T(1 / std::sqrt(squares)) * sum;
}

template <class T>
Triple<T> volume_axis(const FieldAt& f, const Triple<T>& r, const Triple<T>& off_axis) {
    const FieldValues& v = f.values;
    const T d = norm(r), rho = norm(off_axis);
    const bool sphere = f.rest->volume == FieldVolume::sphere;
    const T q = (sphere ? d : rho) / T(v.radius);
    T strength = fade(q);
    if (!sphere) {
        const T along = dot(r, f.axis);
        strength = strength * fade((value_of(along) < 0 ? -along : along) / T(0.5 * v.height));
    }
    if (!(value_of(strength) > 0)) return {};
    if (v.attenuation != 0) {
        const T left = f.rest->invert_attenuation ? q : T(1) - q;
        // Powers below 1 have no slope at zero: within the core a line takes their place.
        strength = strength *
                   (value_of(left) > core ? power(left, v.attenuation) : T(std::pow(core, v.attenuation - 1)) * left);
    }
    const Triple<T> outwards = softened(off_axis, rho, core * v.radius);
    return strength * (T(v.away_from_center) * softened(r, d, core * v.radius) + T(v.away_from_axis) * outwards +
                       T(v.around_axis) * cross(f.axis, outwards) + triple<T>(v.along_axis * f.axis) +
                       triple<T>(v.directional_speed * f.direction));
}

template <class T>
Triple<T> force(const FieldAt& f, const Triple<T>& x, const Triple<T>& v) {
    const FieldKind kind = f.rest->kind;
    const T m(f.values.magnitude);
    const Triple<T> r = x - triple<T>(f.place);
    if (kind == FieldKind::vortex || kind == FieldKind::volume_axis) {
        const Triple<T> off_axis = r - dot(r, f.axis) * triple<T>(f.axis);
        if (kind == FieldKind::volume_axis) return m * volume_axis(f, r, off_axis);
        const T rho = norm(off_axis);
        return m * weight(f, rho) * cross(f.axis, softened(off_axis, rho, f.values.reference_distance));
    }
    const T d = f.varies() || f.is_central() ? norm(r) : T(0);
    const T w = f.varies() ? weight(f, d) : T(1);
    switch (kind) {
    case FieldKind::air:
        return air(f, w, v);
    case FieldKind::drag:
        return drag(f, w, v);
    case FieldKind::newton:
        return -m * w * softened(r, d, f.values.reference_distance);
    case FieldKind::radial:
        return m * w * softened(r, d, f.values.reference_distance);
    case FieldKind::turbulence:
        return m * w * turbulence(f, r);
    default:
        return m * w * triple<T>(f.direction);
    }
}

/// Ten-point Gauss rule: exact to rounding for powers over an interval whose ends differ by less than a factor of two.
template <class Of>
double integral(double from, double to, const Of& of) {
    static constexpr double place[] = {0.14887433898163121, 0.43339539412924719, 0.67940956829902441,
                                       0.86506336668898451, 0.97390652851717172};
    static constexpr double share[] = {0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
                                       0.14945134915058059, 0.06667134430868814};
    if (!(to > from)) return 0;
    const double half = 0.5 * (to - from), middle = from + half;
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += share[i] * (of(middle - half * place[i]) + of(middle + half * place[i]));
    return half * sum;
}

/// Integral from 0 to d of w(s) min(s/r, 1): the work of a central field of magnitude 1.
double central_work(const FieldAt& f, double d) {
    const double r = f.values.reference_distance, m = f.values.max_distance, n = f.values.attenuation;
    const double fading = f.rest->use_max_distance ? fade_start * m : d;
    const double to = std::min(d, fading), near = std::min(to, r);
    double work = 0.5 * near * near / r;
    if (to > r) {
        const double l = std::log(to / r), k = (n - 1) * l;
        work += r * l * (std::abs(k) < 1e-8 ? 1 - 0.5 * k : -std::expm1(-k) / k);
    }
    if (d <= fading) return work;
    const auto strength = [&](double s) { return weight(f, s) * std::min(s / r, 1.0); };
    const double end = std::min(d, m), border = std::clamp(r, to, end);
    return work + integral(to, border, strength) + integral(border, end, strength);
}

Vec3 unit_vector(double x, double y, double z, const char* what) {
    const Vec3 a(x, y, z);
    if (a.isZero(0))
        throw Error("FE304", std::string("the ") + what + " of a field is zero", "give it a length above zero");
    return a.stableNormalized(); // squares of what is very long or short are none
}

void check(double number, bool fits, const char* what, const char* range) {
    if (!fits)
        throw Error("FE304", std::string("the ") + what + " of a field is " + std::to_string(number),
                    std::string("it must be ") + range);
}

} // namespace

bool FieldAt::is_conservative() const {
    return is_central() || ((rest->kind == FieldKind::uniform || rest->kind == FieldKind::gravity) && !varies());
}

FieldAt field_at(const FieldRest& rest, std::span<const double> numbers) {
    FieldAt f;
    f.rest = &rest;
    f.values = get_fields<FieldValues>(numbers);
    const FieldValues& v = f.values;
    f.place = Vec3(v.x, v.y, v.z);
    const FieldKind kind = rest.kind;
    if (kind == FieldKind::uniform || kind == FieldKind::gravity || kind == FieldKind::air ||
        (kind == FieldKind::drag && rest.use_direction) || (kind == FieldKind::volume_axis && v.directional_speed != 0))
        f.direction = unit_vector(v.direction_x, v.direction_y, v.direction_z, "direction");
    if (kind == FieldKind::vortex || kind == FieldKind::volume_axis)
        f.axis = unit_vector(v.axis_x, v.axis_y, v.axis_z, "axis");
    check(v.attenuation, v.attenuation >= 0, "attenuation", "0 or more");
    check(v.reference_distance, v.reference_distance > 0, "referenceDistance", "above 0");
    check(v.max_distance, !rest.use_max_distance || v.max_distance > 0, "maxDistance", "above 0");
    check(v.air_speed, kind != FieldKind::air || v.air_speed > 0, "airSpeed", "above 0");
    check(v.magnitude, kind != FieldKind::drag || v.magnitude >= 0, "magnitude", "0 or more, or drag would drive");
    check(v.speed_attenuation, v.speed_attenuation >= 0, "speedAttenuation", "0 or more");
    check(v.wavelength, kind != FieldKind::turbulence || v.wavelength > 0, "wavelength", "above 0");
    if (kind == FieldKind::volume_axis) {
        check(v.radius, v.radius > 0, "radius", "above 0");
        check(v.height, rest.volume == FieldVolume::sphere || v.height > 0, "height", "above 0");
    }
    return f;
}

Vec3 field_force(const FieldAt& f, const Vec3& x, const Vec3& v) {
    const Triple<double> out = force<double>(f, {x[0], x[1], x[2]}, {v[0], v[1], v[2]});
    return {out[0], out[1], out[2]};
}

Mat3 field_tangent(const FieldAt& f, const Vec3& x, const Vec3& v, double velocity_factor) {
    Triple<Dual> place, velocity;
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Index k = static_cast<Eigen::Index>(c);
        place[c].value = x[k], place[c].slope[c] = 1;
        velocity[c].value = v[k], velocity[c].slope[c] = velocity_factor;
    }
    const Triple<Dual> out = force(f, place, velocity);
    Mat3 tangent;
    for (Eigen::Index i = 0; i < 3; ++i)
        for (Eigen::Index j = 0; j < 3; ++j)
            tangent(i, j) = out[static_cast<std::size_t>(i)].slope[static_cast<std::size_t>(j)];
    return tangent;
}

double field_potential(const FieldAt& f, const Vec3& x, const Vec3& from) {
    if (!f.is_central()) return -f.values.magnitude * f.direction.dot(x - from);
    const double work = central_work(f, (x - f.place).norm()) - central_work(f, (from - f.place).norm());
    return (f.rest->kind == FieldKind::newton ? 1 : -1) * f.values.magnitude * work;
}

double field_potential_scale(const FieldAt& f, const Vec3& x) {
    return f.is_central() ? std::abs(f.values.magnitude) * central_work(f, (x - f.place).norm()) : 0;
}

double field_resistance(const FieldAt& f, const Vec3& x) {
    const double w = f.varies() ? weight(f, (x - f.place).norm()) : 1;
    return w *
           (f.rest->kind == FieldKind::air ? std::abs(f.values.magnitude) / f.values.air_speed : f.values.magnitude);
}

double field_dissipation(const FieldAt& f, const Vec3& v) {
    const double top = f.values.air_speed, slow = f.values.speed_attenuation;
    if (f.rest->kind == FieldKind::air) {
        const double along = std::copysign(1.0, f.values.magnitude) * f.direction.dot(v);
        if (!f.rest->component_only) return 0.5 * v.squaredNorm() - top * along;
        const double lag = std::max(0.0, top - along);
        return 0.5 * (lag - top) * (lag + top); // zero at rest
    }
    const double squares = f.rest->use_direction ? std::pow(f.direction.dot(v), 2) : v.squaredNorm();
    if (squares >= slow * slow) return 0.5 * squares - slow * slow / 6;
    return squares * std::sqrt(squares) / (3 * slow);
}

} // namespace sinew::solver
