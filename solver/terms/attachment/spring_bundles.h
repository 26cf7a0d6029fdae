// The springs of attachments in bundles: those of one attachment whose ends ride on the same vertices, which are about
// five where both sides' tets are as large as each other. What they have in common is kept once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/scene.h"
#include "solver/terms/attachment/anchors.h"

#include <cstddef>
#include <span>
#include <vector>

namespace sinew::solver {

/// Springs go from 0, those of one bundle after the other; bundles by rising attachments, and in each by the anchors
/// that they begin with.
class SpringBundles {
  public:
    /// Two ends on quadratic tets.
    static constexpr std::size_t most_vertices = 20;
    /// A spring as a bundle has it: |sum_i c_i x_i - place| is its stretch.
    struct Spring {
        std::size_t number;
        int anchor;                           ///< of its attachment
        double area_weight;                   ///< [m^2]
        std::span<const double> coefficients; ///< c, one a vertex of the bundle, with the ends' signs
    };

    /// Of all anchors but those between bones, which have no effect.
    SpringBundles(const Scene& scene, std::span<const std::span<const Anchor>> anchors);

    std::size_t count() const { return bundles_.size(); }
    std::size_t spring_count() const { return anchor_.size(); }
    double area_weight(std::size_t spring) const { return area_[spring]; } ///< [m^2]
    int attachment(std::size_t bundle) const { return bundles_[bundle].attachment; }
    std::span<const int> vertices(std::size_t bundle) const {
        const auto [first, end] = range(bundle, &Bundle::first_vertex, vertex_.size());
        return std::span(vertex_).subspan(first, end - first);
    }
    /// visit(Spring) for those of a bundle, in order.
    template <class Visit>
    void for_each_spring(std::size_t bundle, const Visit& visit) const {
        const std::size_t vertices = this->vertices(bundle).size();
        const auto [first, end] = range(bundle, &Bundle::first_spring, anchor_.size());
        const double* c = coefficient_.data() + bundles_[bundle].first_coefficient;
        for (std::size_t s = first; s < end; ++s, c += vertices) visit(Spring{s, anchor_[s], area_[s], {c, vertices}});
    }

  private:
    struct Bundle {
        int attachment;
        std::size_t first_spring, first_vertex, first_coefficient;
    };
    std::pair<std::size_t, std::size_t> range(std::size_t bundle, std::size_t Bundle::*first, std::size_t all) const {
        return {bundles_[bundle].*first, bundle + 1 < bundles_.size() ? bundles_[bundle + 1].*first : all};
    }
    void add(int attachment, std::span<const Anchor> anchors, const Scene& scene);

    std::vector<Bundle> bundles_;
    std::vector<int> vertex_; ///< of bundles
    // Of springs, of which there are more than tets where muscles lie side by side:
    std::vector<int> anchor_;
    std::vector<double> area_, coefficient_;
};

} // namespace sinew::solver
