// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/triangle_rule.h"

#include "solver/index.h"

#include <array>

namespace sinew::solver {
namespace {

/// Appends the points (1 - 2 a, a, a) in all orders.
template <std::size_t N>
void add_orbit(double a, double share, std::array<RulePoint, N>& rule, std::size_t& count) {
    for (int i = 0; i < 3; ++i) {
        Vec3 place = Vec3::Constant(a);
        place[i] = 1 - 2 * a;
        rule[count++] = {place, share};
    }
}

/// Roots of the moment equations in closed form.
std::array<RulePoint, 6> degree_4() {
    std::array<RulePoint, 6> out;
    std::size_t count = 0;
    add_orbit(0.445948490915964886318329253883, 0.223381589678011465944973466630, out, count);
    add_orbit(0.091576213509770743459571463402, 0.109951743655321867388359866704, out, count);
    return out;
}

std::array<RulePoint, 7> degree_5() {
    constexpr double root = 3.87298334620741688517926539978; // of 15
    std::array<RulePoint, 7> out;
    std::size_t count = 0;
    add_orbit((6 + root) / 21, (155 + root) / 1200, out, count);
    add_orbit((6 - root) / 21, (155 - root) / 1200, out, count);
    out[count] = {Vec3::Constant(1.0 / 3), 0.225};
    return out;
}

} // namespace

std::span<const RulePoint> triangle_rule(int degree) {
    static const RulePoint one[] = {{Vec3::Constant(1.0 / 3), 1}};
    static const RulePoint two[] = {{Vec3(2.0 / 3, 1.0 / 6, 1.0 / 6), 1.0 / 3},
                                    {Vec3(1.0 / 6, 2.0 / 3, 1.0 / 6), 1.0 / 3},
                                    {Vec3(1.0 / 6, 1.0 / 6, 2.0 / 3), 1.0 / 3}};
    static const std::array<RulePoint, 6> four = degree_4();
    static const std::array<RulePoint, 7> five = degree_5();
    if (degree <= 1) return one;
    if (degree == 2) return two;
    if (degree <= 4) return four;
    return five;
}

} // namespace sinew::solver
