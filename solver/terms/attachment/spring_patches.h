// Stiff springs by lattice vertices. Springs at all samples would hold every tet that they pass through like a rigid
// piece, as they are more than its corners are free to move. A clamp would so reach up to a tet's thickness into the
// flesh, which makes thin muscles millimetres too stiff. Where springs are stiffer than flesh is across a tet, those
// nearest to one vertex make up a patch: their mean stretch meets the whole stiffness, what single ones are longer or
// shorter than that 125 times as much as flesh resists itself (E / h), and the mean itself at most 1,250 times:
// vertices outside of the solid are as many as those inside, so even means stiffer than that hold flesh like a piece.
// Smaller tets make that stiffer, so in the end all are the same. Where tets end at the surface each vertex there bears
// what pulls at it, and nothing is put together. Sources: Barbosa and Hughes 1991, Burman and Hansbo 2010, on how many
// constraints along a surface a mesh bears.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"
#include "solver/terms/attachment/spring_bundles.h"

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

/// Per body the edge of a regular tet of the mean volume of a tissue's tets at rest [m]; 0 for others.
std::vector<double> tet_edges(const Scene& scene);
/// Whose vertices make an attachment's patches: of two tissues the one with larger tets, of equal ones the source; a
/// subtissue's are those of what carries it. -1 where neither end rides in tets: each vertex then lies on the surface
/// and bears what pulls there.
int patch_side(const Scene& scene, const AttachmentRest& attachment, std::span<const double> edges);
/// The means of a patch are at most this many times as stiff as its single springs.
inline constexpr double mean_over_single = 10;

/// Where an attachment holds a tissue: its tets and how much of the springs' areas x weights each has [m^2].
struct HeldTets {
    int body = -1; ///< the one with those tets; -1: none
    std::vector<std::pair<int, double>> areas;
};
/// Of an attachment's two ends, of which bones and cloth have none.
std::array<HeldTets, 2> held_tets(const Scene& scene, const AttachmentRest& attachment,
                                  std::span<const Anchor> anchors);
/// How stiff single springs of a patch are at most [N/m^3]: 125 times what flesh is across a tet, E / h. E is the
/// mean over where the tissue is held, so a muscle's belly counts by itself and not by its tendon; of two tissues the
/// softer counts. Infinite where there is no tissue.
double single_stiffness(const Scene& scene, const std::array<HeldTets, 2>& held, std::span<const double> edges,
                        const StepInputs& inputs);

class SpringPatches {
  public:
    /// Patches of all springs of the attachments that have a side, one an attachment, -1 or a body as patch_side gives
    /// it; empty: of none. Attachments without a spring inside of a tet of that body have no patches. A spring that is
    /// not, as on a side of its tet, or held far outside of it, is a patch of its own; so are those of a patch that
    /// would couple more than most_vertices. `anchors`: those of the bundles.
    SpringPatches(const Scene& scene, const SpringBundles& bundles, std::span<const std::span<const Anchor>> anchors,
                  std::span<const int> sides);
    /// Fine tissue or cloth on coarse tets would couple all of its vertices there to each other.
    static constexpr std::size_t most_vertices = 128;

    /// One vertex's part in the sum of the springs' stretches times areas: area x position.
    struct Pull {
        int vertex;
        double area; ///< signed as the springs' coefficients are [m^2]
    };
    /// Patches go by rising attachments.
    std::size_t count() const { return patches_.size(); }
    int attachment(std::size_t patch) const { return patches_[patch].attachment; }
    double area(std::size_t patch) const { return patches_[patch].area; } ///< of its springs [m^2], > 0
    bool has(int attachment) const { return !patched_.empty() && patched_[static_cast<std::size_t>(attachment)] != 0; }
    /// The patch of a spring, or -1 without one, or without an area to pull with.
    int of_spring(std::size_t spring) const { return of_spring_.empty() ? -1 : of_spring_[spring]; }
    /// By rising numbers.
    std::span<const int> springs(std::size_t patch) const { return part(spring_, first_spring_, patch); }
    /// By rising vertices.
    std::span<const Pull> pulls(std::size_t patch) const { return part(pull_, first_pull_, patch); }

  private:
    struct Patch {
        int attachment;
        double area;
    };
    template <class T>
    static std::span<const T> part(const std::vector<T>& all, const std::vector<int>& first, std::size_t i) {
        const auto begin = static_cast<std::size_t>(first[i]);
        return std::span(all).subspan(begin, static_cast<std::size_t>(first[i + 1]) - begin);
    }

    std::vector<Patch> patches_;
    std::vector<char> patched_; ///< per attachment
    std::vector<int> of_spring_, first_spring_, spring_, first_pull_;
    std::vector<Pull> pull_;
};

} // namespace sinew::solver
