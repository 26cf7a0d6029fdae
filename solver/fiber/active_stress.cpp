// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/fiber/active_stress.h"

namespace sinew::solver {

namespace {

/// Stretch, deformed unit direction and shape gradients along the fibre, of one batch.
struct FiberKinematics {
    Pack stretch, n[3], along[4]; ///< along[a] = grad N_a . a
};

FiberKinematics kinematics(const TetBatch& batch, const FiberBatch& fiber, const Pack* f) {
    Pack a[3];
    for (int i = 0; i < 3; ++i) a[i] = Pack::load(fiber.direction[i]);
    FiberKinematics k;
    Pack w[3];
    for (int i = 0; i < 3; ++i) w[i] = f[3 * i] * a[0] + f[3 * i + 1] * a[1] + f[3 * i + 2] * a[2];
    k.stretch = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const Pack inverse = Pack(1.0) / max(k.stretch, Pack(1e-300));
    for (int i = 0; i < 3; ++i) k.n[i] = w[i] * inverse;
    k.along[0] = Pack(0.0);
    for (int v = 1; v < 4; ++v) {
        k.along[v] = Pack::load(batch.shape[3 * (v - 1)]) * a[0] + Pack::load(batch.shape[3 * (v - 1) + 1]) * a[1] +
                     Pack::load(batch.shape[3 * (v - 1) + 2]) * a[2];
        k.along[0] -= k.along[v];
    }
    return k;
}

} // namespace

std::vector<FiberBatch> make_fiber_batches(const FiberRest& fiber, std::size_t batch_count) {
    std::vector<FiberBatch> batches(batch_count);
    for (std::size_t slot = 0; slot < batch_count * lanes; ++slot) {
        const bool padding = slot >= fiber.directions.size();
        const Vec3 d = padding ? Vec3(1, 0, 0) : fiber.directions[slot];
        FiberBatch& b = batches[slot / lanes];
        for (int i = 0; i < 3; ++i) b.direction[i][slot % lanes] = d[i];
        b.weight[slot % lanes] = padding || d.squaredNorm() == 0 ? 0.0 : fiber.weights[slot];
    }
    return batches;
}

void add_fiber_gradient(const TetBatch& batch, const ActiveFiber& fiber, const Pack* f, Pack volume, Pack g[4][3],
                        Pack& energy, Pack& squares) {
    const FiberKinematics k = kinematics(batch, *fiber.batch, f);
    const Pack pull = max(k.stretch - Pack(fiber.contraction_limit), Pack(0.0));
    const Pack stiffness = volume * Pack(fiber.stiffness) * Pack::load(fiber.batch->weight);
    energy += Pack(0.5) * stiffness * pull * pull;
    const Pack tension = stiffness * pull;
    for (int v = 0; v < 4; ++v) {
        squares += tension * tension * k.along[v] * k.along[v];
        for (int c = 0; c < 3; ++c) g[v][c] += tension * k.along[v] * k.n[c];
    }
}

void add_fiber_hessian(const TetBatch& batch, const ActiveFiber& fiber, const Pack* f, Pack volume, Pack blocks[6][9]) {
    const FiberKinematics k = kinematics(batch, *fiber.batch, f);
    const Pack pull = max(k.stretch - Pack(fiber.contraction_limit), Pack(0.0));
    const Pack stiffness = volume * Pack(fiber.stiffness) * Pack::load(fiber.batch->weight);
    // d2psi = k n n^T + (tension / stretch)(I - n n^T) where it pulls.
    const Pack along = select(pull > Pack(0.0), stiffness, Pack(0.0));
    const Pack across = stiffness * pull / max(k.stretch, Pack(1e-300));
    Pack m[9];
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const Pack nn = k.n[r] * k.n[c];
            m[3 * r + c] = along * nn + across * (Pack(r == c ? 1.0 : 0.0) - nn);
        }
    int index = 0;
    for (int a = 1; a < 4; ++a)
        for (int b = a; b < 4; ++b, ++index) {
            const Pack weight = k.along[a] * k.along[b];
            for (int e = 0; e < 9; ++e) blocks[index][e] += weight * m[e];
        }
}

} // namespace sinew::solver
