// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/look.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace sinew::render {

namespace {

constexpr std::array<std::pair<BodyKind, std::string_view>, 4> words{
    {{BodyKind::plain, "plain"}, {BodyKind::bone, "bone"}, {BodyKind::tissue, "tissue"}, {BodyKind::cloth, "cloth"}}};

Eigen::Vector3f srgb(float r, float g, float b) { return {to_linear(r), to_linear(g), to_linear(b)}; }

/// -1…1, spread evenly over consecutive indices (golden ratio).
float spread(int index) {
    const float x = 0.618034f * static_cast<float>(index);
    return 2 * (x - std::floor(x)) - 1;
}

Look usual_look(BodyKind kind, nodes::Matter matter, int index) {
    const float shift = spread(index);
    using enum nodes::Matter;
    switch (matter) {
    case bone:
        return {srgb(0.93f, 0.885f, 0.79f) * (1 + 0.04f * shift), 0, 0.15f};
    case muscle:
        return {srgb(0.68f + 0.03f * shift, 0.235f - 0.02f * shift, 0.2f + 0.005f * shift), 1, 0.4f};
    case tendon:
    case ligament:
        return {srgb(0.87f, 0.80f, 0.72f), 0.35f, 0.35f};
    case fascia:
        return {srgb(0.88f, 0.82f, 0.80f), 0.2f, 0.45f};
    case cartilage:
        return {srgb(0.80f, 0.86f, 0.89f) * (1 + 0.03f * shift), 0, 0.5f};
    case fat:
        return {srgb(0.95f, 0.80f, 0.46f) * (1 + 0.03f * shift), 0, 0.3f};
    case skin:
        return {srgb(0.90f, 0.70f, 0.58f), 0, 0.25f};
    case organ:
        return {srgb(0.60f, 0.30f, 0.30f) * (1 + 0.1f * shift), 0, 0.6f};
    case plain:
        break;
    }
    if (kind == BodyKind::cloth) return {srgb(0.36f, 0.50f, 0.70f) * (1 + 0.1f * shift), 0, 0.1f};
    constexpr std::array<std::array<float, 3>, 6> palette{{{0.55f, 0.67f, 0.79f},
                                                           {0.86f, 0.65f, 0.45f},
                                                           {0.60f, 0.73f, 0.53f},
                                                           {0.76f, 0.56f, 0.67f},
                                                           {0.83f, 0.76f, 0.50f},
                                                           {0.52f, 0.71f, 0.70f}}};
    const auto& c = palette[static_cast<std::size_t>(index) % palette.size()];
    return {srgb(c[0], c[1], c[2]), 0, 0.25f};
}

} // namespace

std::string_view word_of(BodyKind kind) {
    for (const auto& [k, word] : words)
        if (k == kind) return word;
    return "plain";
}

BodyKind kind_of(std::string_view word) {
    for (const auto& [kind, w] : words)
        if (w == word) return kind;
    return BodyKind::plain;
}

nodes::Matter matter_of(BodyKind kind, const Appearance& appearance) {
    if (appearance.matter) return *appearance.matter;
    return kind == BodyKind::bone     ? nodes::Matter::bone
           : kind == BodyKind::tissue ? nodes::Matter::muscle
                                      : nodes::Matter::plain;
}

std::optional<nodes::Matter> matter_of(std::string_view word) {
    for (const auto& option : nodes::matters)
        if (option.word == word) return option.meaning;
    return {};
}

Look look_of(BodyKind kind, const Appearance& appearance, int index) {
    Look look = usual_look(kind, matter_of(kind, appearance), index);
    if (const auto& c = appearance.colour) look.colour = srgb((*c)[0], (*c)[1], (*c)[2]);
    return look;
}

std::string hex_of(const Eigen::Vector3f& srgb) {
    char out[8];
    const auto part = [&](int c) { return static_cast<unsigned>(std::lround(255 * std::clamp(srgb[c], 0.0f, 1.0f))); };
    std::snprintf(out, sizeof out, "#%02x%02x%02x", part(0), part(1), part(2));
    return out;
}

std::optional<Eigen::Vector3f> colour_of(std::string_view hex) {
    if (hex.size() != 7 || hex.front() != '#') return {};
    Eigen::Vector3f out;
    for (int c = 0; c < 3; ++c) {
        const char* begin = hex.data() + 1 + 2 * c;
        unsigned value = 0;
        if (std::from_chars(begin, begin + 2, value, 16).ptr != begin + 2) return {};
        out[c] = static_cast<float>(value) / 255;
    }
    return out;
}

float to_linear(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

float to_srgb(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

} // namespace sinew::render
