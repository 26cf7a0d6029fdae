// Surface tension g [N/m] on four flat triangles: energy g times the area |N|, N = 1/2 (x1 - x0) x (x2 - x0). At zero
// area that has an edge like |x| at 0, which is rounded: a = sqrt(N N + d^2), d a 1e-7 of the triangles' size, so that
// no other area is changed by more than rounding does.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/stencils.h"

namespace sinew::solver {

struct TensionTriangle {
    PackVector edges[3]; ///< across from each corner
    Pack area;           ///< a
    PackVector m;        ///< N / a: the normal, and 0 at zero area

    TensionTriangle(const StencilVectors<3>& x, Pack rounding)
        : edges{x[2] - x[1], x[0] - x[2], x[1] - x[0]} {
        const PackVector n = Pack(0.5) * cross(edges[2], x[2] - x[0]);
        area = sqrt(dot(n, n) + rounding * rounding);
        m = (Pack(1.0) / area) * n;
    }
    /// By corner a: 1/2 m x e_a.
    void gradient(Pack tension, StencilVectors<3>& g) const {
        for (std::size_t a = 0; a < 3; ++a) g[a] = (Pack(0.5) * tension) * cross(m, edges[a]);
    }
    /// Two parts. Where the corners move along the normal the area grows with the square of their slope:
    ///   1/(4 a) [(e_a e_b) I - e_b e_a^T - c_a c_b^T],  c_a = m x e_a,
    /// positive semi-definite. Where they move in the plane it is m times the area of the triangle of their
    /// displacements: blocks -+1/2 [m x] off the diagonal, with eigenvalues +-(sqrt 3 / 2) |m| and 0. So the sum is
    /// clamped by putting 1/2 (s S + |S|) in place of s S, where s is the tension's sign and
    ///   |S|_ab = sqrt(3)/2 |m| (1_ab - 1/3) (I - n n^T),
    /// and, for a negative tension, by leaving the first part out.
    void hessian(Pack tension, bool project, StencilBlocks<3>& h) const {
        const Pack zero(0.0), size = abs(tension), length = sqrt(dot(m, m));
        const Pack along = project ? max(tension, zero) : tension;
        const Pack factor = Pack(0.25) * along / area;
        const PackVector n = (Pack(1.0) / max(length, Pack(1e-300))) * m;
        const PackMatrix turn = cross_matrix((Pack(project ? -0.25 : -0.5) * tension) * m);
        std::size_t pair = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = a; b < 3; ++b) {
                PackMatrix& block = h[pair++];
                block.fill(zero);
                const PackVector c = cross(m, edges[a]), d = cross(m, edges[b]);
                add_outer(block, (-factor) * edges[b], edges[a]);
                add_outer(block, (-factor) * c, d);
                Pack diagonal = factor * dot(edges[a], edges[b]);
                if (project) {
                    const Pack in_plane =
                        Pack(0.25 * 1.7320508075688772 * ((a == b ? 1.0 : 0.0) - 1.0 / 3)) * size * length;
                    diagonal += in_plane;
                    add_outer(block, (-in_plane) * n, n);
                }
                for (std::size_t k = 0; k < 9; k += 4) block[k] += diagonal;
                const double sign = a == b ? 0 : b == a + 1 ? 1 : -1;
                for (std::size_t k = 0; k < 9; ++k) block[k] += Pack(sign) * turn[k];
            }
    }
};

} // namespace sinew::solver
