// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/look.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

namespace sinew::render {

namespace {

constexpr std::array<std::pair<BodyKind, std::string_view>, 4> words{
    {{BodyKind::plain, "plain"}, {BodyKind::bone, "bone"}, {BodyKind::tissue, "tissue"}, {BodyKind::cloth, "cloth"}}};

Eigen::Vector3f srgb(float r, float g, float b) { return {to_linear(r), to_linear(g), to_linear(b)}; }

bool mentions(std::string_view name, std::initializer_list<std::string_view> parts) {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::any_of(parts.begin(), parts.end(),
                       [&](std::string_view p) { return lower.find(p) != std::string::npos; });
}

/// -1…1, spread evenly over consecutive indices (golden ratio).
float spread(int index) {
    const float x = 0.618034f * static_cast<float>(index);
    return 2 * (x - std::floor(x)) - 1;
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

Look look_of(BodyKind kind, std::string_view name, int index) {
    const float shift = spread(index);
    switch (kind) {
    case BodyKind::bone:
        return {srgb(0.93f, 0.885f, 0.79f) * (1 + 0.04f * shift), 0, 0.15f};
    case BodyKind::tissue:
        if (mentions(name, {"tendon", "ligament", "fascia"})) return {srgb(0.87f, 0.80f, 0.72f), 0.35f, 0.35f};
        if (mentions(name, {"fat", "skin"})) return {srgb(0.93f, 0.75f, 0.58f), 0, 0.25f};
        return {srgb(0.68f + 0.03f * shift, 0.235f - 0.02f * shift, 0.2f + 0.005f * shift), 1, 0.4f};
    case BodyKind::cloth:
        return {srgb(0.36f, 0.50f, 0.70f) * (1 + 0.1f * shift), 0, 0.1f};
    case BodyKind::plain:
        break;
    }
    constexpr std::array<std::array<float, 3>, 6> palette{{{0.55f, 0.67f, 0.79f},
                                                           {0.86f, 0.65f, 0.45f},
                                                           {0.60f, 0.73f, 0.53f},
                                                           {0.76f, 0.56f, 0.67f},
                                                           {0.83f, 0.76f, 0.50f},
                                                           {0.52f, 0.71f, 0.70f}}};
    const auto& c = palette[static_cast<std::size_t>(index) % palette.size()];
    return {srgb(c[0], c[1], c[2]), 0, 0.25f};
}

float to_linear(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

float to_srgb(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

} // namespace sinew::render
