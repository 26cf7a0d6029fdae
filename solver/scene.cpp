// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/scene.h"

#include "solver/error.h"
#include "solver/system.h"

#include <algorithm>
#include <string>

namespace sinew::solver {

namespace {

[[noreturn]] void refuse(int body, const std::string& code, const std::string& message, const std::string& hint) {
    Error e(code, message, hint);
    e.body = body;
    throw e;
}

void check_tissue(const TissueRest& t, int body) {
    const std::size_t n = t.tets.tets.size();
    if (n == 0) refuse(body, "FE201", "the tissue has no tets", "its mesh or lattice must not be empty");
    for (const Tet& tet : t.tets.tets)
        for (const int v : tet)
            if (v < 0 || static_cast<std::size_t>(v) >= t.tets.vertices.size())
                refuse(body, "FE203", "a tet names vertex " + std::to_string(v) + " of " +
                                          std::to_string(t.tets.vertices.size()), "vertex numbers count from 0");
    for (const auto& w : t.layer_weights)
        if (w.size() != n)
            refuse(body, "FE204", "a material layer has " + std::to_string(w.size()) + " weights for " +
                                      std::to_string(n) + " tets", "one weight per tet");
    if (t.layer_weights.empty())
        refuse(body, "FE206", "the tissue has no material", "connect at least one zMaterial");
    for (const auto& f : t.fibers)
        if (f.directions.size() != n || f.weights.size() != n)
            refuse(body, "FE204", "a fibre field has " + std::to_string(f.directions.size()) + " directions and " +
                                      std::to_string(f.weights.size()) + " weights for " + std::to_string(n) + " tets",
                   "one of each per tet");
}

} // namespace

Scene::Scene(SceneDescription description) : description_(std::move(description)) {
    auto system = std::make_unique<System>();
    for (int body = 0; body < body_count(); ++body) {
        first_vertex_.push_back(vertex_count_);
        const TissueRest* t = tissue(body);
        if (!t) continue;
        check_tissue(*t, body);
        TissueElements elements;
        elements.body = body;
        elements.law = t->law;
        elements.first_batch = system->batches.size();
        elements.tet_count = t->tets.tets.size();
        const std::vector<TetBatch> batches = make_batches(t->tets, vertex_count_);
        elements.batch_count = batches.size();
        system->batches.insert(system->batches.end(), batches.begin(), batches.end());
        for (const FiberRest& f : t->fibers) elements.fibers.push_back(make_fiber_batches(f, batches.size()));
        system->tissues.push_back(std::move(elements));
        for (const Vec3& p : t->tets.vertices)
            for (int c = 0; c < 3; ++c) system->rest.push_back(p[c]);
        std::vector<char> held(t->tets.vertices.size(), 0);
        for (const int v : t->fixed_vertices) held.at(static_cast<std::size_t>(v)) = 1;
        for (std::size_t v = 0; v < held.size(); ++v) {
            system->unknown.push_back(held[v] ? -1 : static_cast<int>(system->vertex_of_unknown.size()));
            if (!held[v]) system->vertex_of_unknown.push_back(vertex_count_ + static_cast<int>(v));
        }
        vertex_count_ += static_cast<int>(t->tets.vertices.size());
    }
    for (const AttachmentRest& a : description_.attachments)
        if (a.source < 0 || a.target < 0 || a.source >= body_count() || a.target >= body_count())
            throw Error("FE209", "an attachment names a body that is not in the scene",
                        "both of its bodies must be among zSolver.bodies");

    // Corners by unknown: count, then fill in batch order, which fixes the order of every sum.
    const auto for_each_corner = [&](const auto& visit) {
        for (std::size_t b = 0; b < system->batches.size(); ++b)
            for (std::size_t corner = 0; corner < 4; ++corner)
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const TetBatch& batch = system->batches[b];
                    const int u = system->unknown[static_cast<std::size_t>(batch.vertex[corner][lane])];
                    if (u >= 0 && batch.volume[lane] > 0) visit(u, static_cast<int>((b * 4 + corner) * lanes + lane));
                }
    };
    system->corner_start.assign(system->vertex_of_unknown.size() + 1, 0);
    for_each_corner([&](int u, int) { ++system->corner_start[static_cast<std::size_t>(u) + 1]; });
    for (std::size_t u = 0; u + 1 < system->corner_start.size(); ++u) {
        if (system->corner_start[u + 1] == 0) {
            const int vertex = system->vertex_of_unknown[u];
            int body = 0;
            while (body + 1 < body_count() && first_vertex_[static_cast<std::size_t>(body) + 1] <= vertex) ++body;
            refuse(body, "FE208", "vertex " + std::to_string(vertex - first_vertex(body)) + " of the tet mesh belongs to no tet",
                   "remove unused vertices from the tet mesh");
        }
        system->corner_start[u + 1] += system->corner_start[u];
    }
    system->corners.resize(static_cast<std::size_t>(system->corner_start.back()));
    std::vector<int> next(system->corner_start.begin(), system->corner_start.end() - 1);
    for_each_corner([&](int u, int slot) {
        system->corners[static_cast<std::size_t>(next[static_cast<std::size_t>(u)]++)] = slot;
    });
    system_ = std::move(system);
}

Scene::~Scene() = default;

const TissueRest* Scene::tissue(int body) const {
    const auto* p = std::get_if<std::shared_ptr<const TissueRest>>(&description_.bodies[static_cast<std::size_t>(body)]);
    return p ? p->get() : nullptr;
}

const BoneRest* Scene::bone(int body) const {
    const auto* p = std::get_if<std::shared_ptr<const BoneRest>>(&description_.bodies[static_cast<std::size_t>(body)]);
    return p ? p->get() : nullptr;
}

} // namespace sinew::solver
