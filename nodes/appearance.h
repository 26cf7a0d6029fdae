// What a body is made of, for pictures alone: no result depends on it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"
#include "nodes/options.h"

namespace sinew::nodes {

/// What a body looks like.
enum class Matter { muscle, tendon, ligament, fascia, cartilage, fat, skin, organ, bone, plain };

inline constexpr std::array<Option<Matter>, 10> matters{{{"muscle", Matter::muscle},
                                                         {"tendon", Matter::tendon},
                                                         {"ligament", Matter::ligament},
                                                         {"fascia", Matter::fascia},
                                                         {"cartilage", Matter::cartilage},
                                                         {"fat", Matter::fat},
                                                         {"skin", Matter::skin},
                                                         {"organ", Matter::organ},
                                                         {"bone", Matter::bone},
                                                         {"plain", Matter::plain}}};

constexpr std::string_view word_of(Matter matter) {
    for (const auto& option : matters)
        if (option.meaning == matter) return option.word;
    return "";
}

/// A body node's attribute `appearance`.
inline engine::Input<std::string> appearance_input(Matter usual) {
    return {
        .name = "appearance",
        .def = std::string(word_of(usual)),
        .doc = "What the body looks like in the viewer, in pictures and in GLB files: colour, grain and gloss. To "
               "change it computes nothing again.",
        .keyable = false,
        .affects = engine::Affects::nothing,
        .options = words(matters),
    };
}

/// A body node's attribute `colour`; three numbers 0…1, sRGB.
inline engine::Input<engine::Vec3> colour_input(const engine::Vec3& usual) {
    return {
        .name = "colour",
        .def = usual,
        .unit = "1",
        .limits = {.min = 0, .max = 1},
        .doc = "Red, green and blue (sRGB, 0 to 1) in place of the appearance's own colour, which is taken where this "
               "one is not written. To change it computes nothing again.",
        .keyable = false,
        .affects = engine::Affects::nothing,
    };
}

} // namespace sinew::nodes
