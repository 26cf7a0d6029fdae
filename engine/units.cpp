// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/units.h"

#include "engine/text.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace sinew::engine {

namespace {

/// A unit with its powers of ten apart, so that they cancel without rounding: 0.92 g/cm^3 is 920 kg/m^3.
struct Decimal {
    double factor = 1; ///< to SI, times 10^tens
    int tens = 0;
    std::array<int, 5> dimension{};
};

struct Named {
    std::string_view name;
    Decimal unit;
};

constexpr double pi = std::numbers::pi;

// Factor to SI, tens, dimension: m, kg, s, rad, frame.
constexpr Named named_units[] = {
    {"1", {1, 0, {}}},
    {"%", {1, -2, {}}},
    {"m", {1, 0, {1}}},
    {"dm", {1, -1, {1}}},
    {"cm", {1, -2, {1}}},
    {"mm", {1, -3, {1}}},
    {"um", {1, -6, {1}}},
    {"µm", {1, -6, {1}}},
    {"km", {1, 3, {1}}},
    {"in", {254, -4, {1}}},
    {"ft", {3048, -4, {1}}},
    {"L", {1, -3, {3}}},
    {"mL", {1, -6, {3}}},
    {"kg", {1, 0, {0, 1}}},
    {"g", {1, -3, {0, 1}}},
    {"mg", {1, -6, {0, 1}}},
    {"t", {1, 3, {0, 1}}},
    {"s", {1, 0, {0, 0, 1}}},
    {"ms", {1, -3, {0, 0, 1}}},
    {"us", {1, -6, {0, 0, 1}}},
    {"min", {6, 1, {0, 0, 1}}},
    {"Hz", {1, 0, {0, 0, -1}}},
    {"kHz", {1, 3, {0, 0, -1}}},
    {"N", {1, 0, {1, 1, -2}}},
    {"mN", {1, -3, {1, 1, -2}}},
    {"kN", {1, 3, {1, 1, -2}}},
    {"J", {1, 0, {2, 1, -2}}},
    {"mJ", {1, -3, {2, 1, -2}}},
    {"kJ", {1, 3, {2, 1, -2}}},
    {"W", {1, 0, {2, 1, -3}}},
    {"Pa", {1, 0, {-1, 1, -2}}},
    {"hPa", {1, 2, {-1, 1, -2}}},
    {"kPa", {1, 3, {-1, 1, -2}}},
    {"MPa", {1, 6, {-1, 1, -2}}},
    {"GPa", {1, 9, {-1, 1, -2}}},
    {"bar", {1, 5, {-1, 1, -2}}},
    {"rad", {1, 0, {0, 0, 0, 1}}},
    {"deg", {pi / 180, 0, {0, 0, 0, 1}}},
    {"°", {pi / 180, 0, {0, 0, 0, 1}}},
    {"turn", {2 * pi, 0, {0, 0, 0, 1}}},
    {"frame", {1, 0, {0, 0, 0, 0, 1}}},
    {"frames", {1, 0, {0, 0, 0, 0, 1}}},
};

Decimal power(const Decimal& u, int exponent) {
    Decimal out;
    for (int i = 0; i < std::abs(exponent); ++i) out.factor *= u.factor;
    if (exponent < 0) out.factor = 1 / out.factor;
    out.tens = exponent * u.tens;
    for (std::size_t i = 0; i < 5; ++i) out.dimension[i] = u.dimension[i] * exponent;
    return out;
}

Decimal product(const Decimal& a, const Decimal& b, bool divide) {
    Decimal out;
    out.factor = divide ? a.factor / b.factor : a.factor * b.factor;
    out.tens = divide ? a.tens - b.tens : a.tens + b.tens;
    for (std::size_t i = 0; i < 5; ++i) out.dimension[i] = a.dimension[i] + (divide ? -b.dimension[i] : b.dimension[i]);
    return out;
}

/// Rounded once where the power of ten is exact, up to 10^22.
double times_ten_to(double value, int tens) {
    return tens < 0 ? value / std::pow(10.0, -tens) : value * std::pow(10.0, tens);
}

class UnitParser {
  public:
    explicit UnitParser(std::string_view text)
        : text_(text) {}

    std::optional<Decimal> whole() {
        if (text_.size() > 64) return {};
        auto u = terms(0);
        return at_ == text_.size() ? u : std::nullopt;
    }

  private:
    std::optional<Decimal> terms(int depth) {
        auto left = factor(depth);
        while (left && at_ < text_.size()) {
            const bool dot = text_.substr(at_, 2) == "·";
            const char c = text_[at_];
            if (c != '*' && c != '/' && !dot) break;
            at_ += dot ? 2 : 1;
            auto right = factor(depth);
            if (!right) return {};
            left = product(*left, *right, c == '/');
        }
        return left;
    }

    std::optional<Decimal> factor(int depth) {
        std::optional<Decimal> base;
        if (at_ < text_.size() && text_[at_] == '(' && depth < 4) {
            ++at_;
            base = terms(depth + 1);
            if (!base || at_ >= text_.size() || text_[at_] != ')') return {};
            ++at_;
        } else {
            const std::size_t end = std::min(text_.find_first_of("*/^()", at_), text_.size());
            const std::size_t dot = std::min(text_.find("·", at_), text_.size());
            const std::string_view name = text_.substr(at_, std::min(end, dot) - at_);
            for (const Named& n : named_units)
                if (n.name == name) base = n.unit;
            at_ += name.size();
        }
        if (!base || at_ >= text_.size() || text_[at_] != '^') return base;
        ++at_;
        const bool negative = at_ < text_.size() && text_[at_] == '-';
        if (negative) ++at_;
        if (at_ >= text_.size() || text_[at_] < '1' || text_[at_] > '9') return {};
        const int exponent = text_[at_++] - '0';
        return power(*base, negative ? -exponent : exponent);
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

/// Written out, as people say them; several with an s.
constexpr std::pair<std::string_view, std::string_view> long_names[] = {
    {"percent", "%"},     {"meter", "m"},       {"metre", "m"},        {"centimeter", "cm"},  {"centimetre", "cm"},
    {"millimeter", "mm"}, {"millimetre", "mm"}, {"inch", "in"},        {"feet", "ft"},        {"kilogram", "kg"},
    {"gram", "g"},        {"second", "s"},      {"sec", "s"},          {"millisecond", "ms"}, {"newton", "N"},
    {"joule", "J"},       {"pascal", "Pa"},     {"kilopascal", "kPa"}, {"megapascal", "MPa"}, {"degree", "deg"},
    {"radian", "rad"},    {"hertz", "Hz"},      {"turns", "turn"},
};

/// The unit's name in its own letters; as it came if there is none.
std::string name_meant(std::string_view name) {
    for (const Named& n : named_units)
        if (n.name == name) return std::string(name);
    const std::string small = lower_case(name);
    for (const Named& n : named_units)
        if (lower_case(n.name) == small) return std::string(n.name);
    const std::string_view one = small.ends_with('s') ? std::string_view(small).substr(0, small.size() - 1) : small;
    for (const auto& [written, meant] : long_names)
        if (written == small || written == one) return std::string(meant);
    return std::string(name);
}

} // namespace

std::optional<Unit> parse_unit(std::string_view text) {
    const std::optional<Decimal> u = UnitParser(text).whole();
    if (!u) return {};
    return Unit{times_ten_to(u->factor, u->tens), u->dimension};
}

std::optional<double> unit_factor(std::string_view from, std::string_view to) {
    const auto a = UnitParser(from).whole(), b = UnitParser(to).whole();
    if (!a || !b || a->dimension != b->dimension) return {};
    return times_ten_to(a->factor / b->factor, a->tens - b->tens);
}

std::string unit_meant(std::string_view text, std::string_view unit) {
    if (text.size() > 64) return {};
    constexpr std::pair<std::string_view, std::string_view> raised[] = {{"²", "^2"}, {"³", "^3"}, {"**", "^"}};
    std::string out, name;
    const auto take = [&] { out += name_meant(name), name.clear(); };
    for (std::size_t i = 0; i < text.size();) {
        const std::string_view rest = text.substr(i);
        const auto* r = std::find_if(std::begin(raised), std::end(raised),
                                     [&](const auto& pair) { return rest.starts_with(pair.first); });
        const char c = text[i];
        if (r != std::end(raised)) {
            take(), out += r->second;
            i += r->first.size();
            continue;
        }
        ++i;
        if (c == ' ') continue;
        const bool is_digit = c >= '0' && c <= '9',
                   is_sign = std::string_view("*/^()-").find(c) != std::string_view::npos;
        if (is_digit && !name.empty()) // the 3 of m3
            take(), out += '^';
        if (is_digit || is_sign)
            take(), out += c;
        else
            name += c;
    }
    take();
    return out != text && unit_factor(out, unit) ? out : std::string();
}

std::string usual_units(std::string_view unit) {
    static constexpr std::string_view usual[] = {
        "Pa",  "kPa", "MPa",   "m",     "cm",     "mm",     "kg",    "g",      "s",   "ms",    "1/s", "Hz", "N", "kN",
        "deg", "rad", "rad/s", "deg/s", "kg/m^3", "g/cm^3", "N/m^3", "N/cm^3", "m/s", "m/s^2", "N/m", "J",  "1", "%"};
    std::vector<std::string> words;
    for (std::string_view u : usual)
        if (unit_factor(u, unit)) words.emplace_back(u);
    if (words.empty() && parse_unit(unit)) words.emplace_back(unit);
    return listed(words);
}

} // namespace sinew::engine
