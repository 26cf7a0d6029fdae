// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/kinds.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

namespace sinew::rig {

using engine::Severity;

namespace {

constexpr const char* bones[] = {"bone",      "skeleton", "femur",    "tibia",      "fibula",  "humerus",  "ulna",
                                 "radius",    "scapula",  "clavicle", "skull",      "cranium", "mandible", "pelvis",
                                 "sacrum",    "sternum",  "ribcage",  "rib",        "spine",   "vertebra", "patella",
                                 "calcaneus", "talus",    "carpal",   "metacarpal", "tarsal",  "phalanx"};
constexpr const char* muscles[] = {
    "muscle",           "biceps",          "triceps",       "quadriceps",    "brachialis",    "brachii",
    "coracobrachialis", "brachioradialis", "deltoid",       "pectoralis",    "latissimus",    "trapezius",
    "rhomboid",         "serratus",        "teres",         "supraspinatus", "infraspinatus", "subscapularis",
    "extensor",         "flexor",          "pronator",      "supinator",     "anconeus",      "gluteus",
    "vastus",           "rectus",          "sartorius",     "gracilis",      "adductor",      "hamstring",
    "semitendinosus",   "semimembranosus", "gastrocnemius", "soleus",        "tibialis",      "peroneus",
    "fibularis",        "psoas",           "iliacus",       "masseter",      "temporalis",    "sternocleidomastoid",
    "palmaris",         "plantaris",       "popliteus",     "tendon"};

/// The word, or its plural, as a word of its own: what follows must be no letter of the same word.
bool has_word(const std::string& name, const std::string& lower, const std::string& word) {
    for (std::size_t at = lower.find(word); at != lower.npos; at = lower.find(word, at + 1)) {
        std::size_t end = at + word.size();
        if (end < lower.size() && lower[end] == 's') ++end;
        if (end >= name.size() || !std::islower(static_cast<unsigned char>(name[end]))) return true;
    }
    return false;
}

} // namespace

std::optional<Kind> kind_told_by(const std::string& name) {
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto one_of = [&](const auto& words) {
        return std::any_of(std::begin(words), std::end(words),
                           [&](const char* word) { return has_word(name, lower, word); });
    };
    const bool bone = one_of(bones), muscle = one_of(muscles);
    if (bone == muscle) return {};
    return bone ? Kind::bone : Kind::muscle;
}

std::optional<engine::Diagnostic> doubt_of_kinds(const std::vector<Part>& parts, bool is_one_muscle) {
    const Part *told_muscle = nullptr, *told_bone = nullptr; // that were given as the other
    for (const Part& part : parts) {
        auto told = kind_told_by(part.stem);
        if (!told) told = kind_told_by(std::filesystem::path(part.file).parent_path().filename().string());
        if (!told) continue;
        if (*told == part.kind) {
            if (is_one_muscle && part.kind == Kind::bone) continue; // the muscle may be among the right bones
            return {};
        }
        (*told == Kind::muscle ? told_muscle : told_bone) = &part;
    }
    if (!told_muscle || !told_bone) return {};
    if (is_one_muscle)
        return say(Severity::warning, "DG177", "",
                   "'" + told_bone->file + "' was given as the muscle and '" + told_muscle->file +
                       "' as a bone, but their names tell otherwise: the order seems to be mixed up",
                   "Name the bones first and the muscle last: sinew new muscle " +
                       std::string(parts.size() > 2 ? "… " : "") + told_bone->file + " " + told_muscle->file + ".");
    return say(Severity::warning, "DG177", "",
               "'" + told_muscle->file + "' was given as a bone and '" + told_bone->file +
                   "' as a muscle, but their names tell otherwise: the two folders seem to be swapped",
               "Name the bones' folder first: sinew new rig BONES MUSCLES.");
}

} // namespace sinew::rig
