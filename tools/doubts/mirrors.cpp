// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "nodes/matrices.h"
#include "tools/doubts/kinds.h"

#include <map>

namespace sinew::doubts {

namespace {

bool has_track(const Doubting& d, const std::string& name) {
    const auto file = d.number<engine::File>(name, "track");
    return file && !file->path.empty();
}

bool is_negative(const std::optional<engine::Vec3>& v) { return v && (*v)[0] * (*v)[1] * (*v)[2] < 0; }
bool is_negative(const std::optional<engine::Matrix4>& m) { return m && nodes::volume_factor(*m) < 0; }

void mirrored(Doubting& d, const std::string& name, std::string_view attribute, const std::string& what) {
    d.doubt("FE265", name, attribute, what + " mirrors, which turns what is moved inside out: its faces look inwards",
            "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers and rotate");
}

class Mirrors {
  public:
    explicit Mirrors(Doubting& d)
        : d_(d) {}

    /// Told where the mirroring comes in, not of all that goes along.
    void look_at(const std::string& name) {
        if (const auto frame = turns_over_at(name))
            return mirrored(d_, name, "scale", "the scale at frame " + engine::number_text(*frame));
        if (!mirrors(name)) return;
        if (const std::string next = above(name); !next.empty() && mirrors(next)) return;
        if (is_negative(d_.at_start<engine::Vec3>(name, "scale")))
            mirrored(d_, name, "scale", "the scale");
        else if (is_negative(d_.at_start<engine::Matrix4>(name, "offsetParentMatrix")))
            mirrored(d_, name, "offsetParentMatrix", "the matrix");
        else
            mirrored(d_, name, "track", "the recorded motion");
    }

  private:
    /// The first key of a scale that mirrors where the start does not.
    std::optional<double> turns_over_at(const std::string& name) const {
        const engine::Curve* keys = d_.keys(name, "scale");
        if (!keys || keys->width() != 3 || is_negative(d_.at_start<engine::Vec3>(name, "scale"))) return {};
        for (const engine::Key& key : keys->keys)
            if (key.value[0] * key.value[1] * key.value[2] < 0) return key.frame;
        return {};
    }

    /// The transform whose outMatrix is applied after this one; empty if there is none.
    std::string above(const std::string& name) const {
        for (const engine::Plug& plug : d_.plugs(name, "offsetParentMatrix"))
            if (const engine::Node* node = d_.graph().find(plug.node); node->type && node->type->name == "transform")
                return plug.node;
        return {};
    }

    /// Whether all that a transform does, those above it included, mirrors. Chains are walked once and not evaluated:
    /// that would take the square of their length. What a recorded motion does only evaluation tells.
    bool mirrors(const std::string& name) {
        std::vector<std::string> way;
        for (std::string at = name; !at.empty() && !mirrors_.contains(at); at = above(at)) way.push_back(at);
        for (; !way.empty(); way.pop_back()) {
            const std::string& at = way.back();
            if (has_track(d_, at)) {
                mirrors_[at] = is_negative(d_.value<engine::Matrix4>({at, "outMatrix"}));
                continue;
            }
            const bool itself = is_negative(d_.at_start<engine::Vec3>(at, "scale")) !=
                                is_negative(d_.at_start<engine::Matrix4>(at, "offsetParentMatrix"));
            const std::string next = above(at);
            mirrors_[at] = itself != (!next.empty() && mirrors_[next]);
        }
        return mirrors_[name];
    }

    Doubting& d_;
    std::map<std::string, bool> mirrors_; ///< by transform
};

} // namespace

void doubt_transforms(Doubting& d, const std::vector<std::string>& transforms) {
    Mirrors mirrors(d);
    for (const std::string& name : transforms) mirrors.look_at(name);
}

void doubt_matrix(Doubting& d, const std::string& bone) {
    if (is_negative(d.at_start<engine::Matrix4>(bone, "matrix"))) mirrored(d, bone, "matrix", "the matrix");
}

} // namespace sinew::doubts
