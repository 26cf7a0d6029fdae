// What Sinew keeps on disk and reads again: values, frames, rows, states. Checksums are made right here, since whoever
// spoils a file on purpose makes them right, too.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/atomic_file.h"
#include "engine/eval/frame_store.h"
#include "engine/eval/keys.h"
#include "nodes/codecs.h"
#include "nodes/contacts.h"
#include "nodes/marks.h"
#include "nodes/register_all.h"
#include "nodes/simulation_state.h"
#include "nodes/values.h"
#include "solver/state.h"
#include "tests/fuzz/targets/refused.h"
#include "tests/fuzz/targets/targets.h"
#include "tests/tools/temporary_folder.h"

#include <filesystem>
#include <typeindex>

namespace sinew::fuzz {

namespace {

namespace fs = std::filesystem;

const engine::Registry& registry() {
    static const auto types = nodes::make_registry();
    return *types;
}

std::span<const std::byte> as_bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

void check(const nodes::Mesh& mesh) {
    const int count = static_cast<int>(mesh.points->size());
    for (const solver::Triangle& t : mesh.topology->triangles)
        for (const int v : t) promise(v >= 0 && v < count, "a kept triangle beyond the vertices");
    std::size_t corners = 0;
    for (const int size : mesh.topology->face_sizes) {
        promise(size >= 3, "a kept face of less than three corners");
        corners += static_cast<std::size_t>(size);
    }
    promise(corners == mesh.topology->face_vertices.size(), "kept corners that no face has");
    for (const int v : mesh.topology->face_vertices) promise(v >= 0 && v < count, "a kept corner beyond the vertices");
}

void check(const nodes::TetMeshValue& tets) {
    const int count = static_cast<int>(tets.mesh->vertices.size());
    for (const solver::Tet& t : tets.mesh->tets)
        for (const int v : t) promise(v >= 0 && v < count, "a kept tet beyond the vertices");
    promise(tets.mesh->coverage.empty() || tets.mesh->coverage.size() == tets.mesh->tets.size(),
            "another number of kept coverages than tets");
    for (const int t : tets.mesh->cut.tets)
        promise(t >= 0 && static_cast<std::size_t>(t) < tets.mesh->tets.size(), "a kept cut beyond the tets");
}

/// Of this process alone; gone at the end.
const fs::path& folder() {
    static const test::TemporaryFolder one;
    return one.path();
}

} // namespace

void read_kept_value(std::string_view bytes) {
    if (bytes.empty()) return;
    static const std::type_index types[] = {
        typeid(nodes::Mesh),        typeid(nodes::TetMeshValue), typeid(nodes::MeshList),   typeid(nodes::SolveReport),
        typeid(nodes::ContactList), typeid(nodes::MarkList),     typeid(engine::NumberList)};
    const std::type_index type = types[static_cast<unsigned char>(bytes.front()) % std::size(types)];
    refused_or_read([&] {
        engine::ByteReader in(as_bytes(bytes.substr(1)));
        const engine::Value value = registry().find_codec(type)->read(in, nullptr);
        if (value.is<nodes::Mesh>()) check(value.as<nodes::Mesh>());
        if (value.is<nodes::TetMeshValue>()) check(value.as<nodes::TetMeshValue>());
        if (value.is<nodes::MeshList>())
            for (const nodes::Mesh& mesh : value.as<nodes::MeshList>().meshes) check(mesh);
    });
}

/// Of four files the first is what the start frame tells, the second, if it is not empty, what another frame does; the
/// others are their states. What a frame says of its start and of its own version is made right where zeros stand: else
/// no bytes would come further.
void read_kept_frame(std::string_view bytes) {
    const auto files = files_in(bytes);
    const engine::NodeType& solver = *registry().find("zSolver");
    const engine::FrameStore store(folder(), std::uintmax_t{1} << 30, "fuzz");
    const engine::DiskStore disk(folder(), ".frame");
    std::vector<engine::Digest> keys;
    for (std::size_t i = 0; i < files.size() && i < 2; ++i)
        if (i == 0 || !files[i].empty()) keys.push_back({i + 1, 7});
    const auto name_of = [&](const engine::Digest& key) {
        const std::string hex = store.file_of(key).stem().string();
        return engine::Digest{std::stoull(hex.substr(0, 16), nullptr, 16), std::stoull(hex.substr(16), nullptr, 16)};
    };
    for (std::size_t i = 0; i < keys.size(); ++i) {
        std::vector<std::byte> payload(as_bytes(files[i]).begin(), as_bytes(files[i]).end());
        // 0 and 1 stand for the names of the two.
        const engine::Digest start = name_of(keys.front()), other = name_of(keys.back());
        if (payload.size() >= sizeof start && payload.front() <= std::byte{1})
            std::memcpy(payload.data(), payload.front() == std::byte{0} ? &start : &other, sizeof start);
        // Which version of the node made it stands behind the numbers of the sections, those of the blocks and the
        // length of the first section.
        constexpr std::size_t number = sizeof(std::uint64_t);
        std::size_t at = sizeof start + number;
        for (int list = 0; list < 2; ++list) {
            std::uint64_t count = 0;
            if (payload.size() >= at + number) std::memcpy(&count, payload.data() + at, number);
            at += number + (count & 0xffff) * sizeof(std::uint32_t);
        }
        at += number;
        const engine::Digest type = engine::identity(solver).finish();
        if (payload.size() > at + sizeof type && payload[at] == std::byte{0})
            std::memcpy(payload.data() + at, &type, sizeof type);
        disk.write(name_of(keys[i]), payload, false, as_bytes(i + 2 < files.size() ? files[i + 2] : ""));
    }
    refused_or_read([&] {
        const auto found = store.read(registry(), solver, keys.back(), true);
        promise(found.frame.has_value() != !found.fault.empty(), "a frame and a fault, or none of both");
        if (found.frame)
            for (const engine::Value& value : found.frame->entry->outputs)
                if (value.is<nodes::MeshList>())
                    for (const nodes::Mesh& mesh : value.as<nodes::MeshList>().meshes) check(mesh);
        const auto told = store.read(registry(), solver, keys.back(), false);
        promise(!found.frame || told.frame, "a frame that can only be read with its state");
        store.frames_of("solver");
    });
    for (const engine::Digest& key : keys) fs::remove(store.file_of(key));
}

void read_kept_rows(std::string_view bytes) {
    const engine::FrameStore store(folder(), std::uintmax_t{1} << 30, "fuzz");
    const std::string build = engine::Hasher().add("fuzz").finish().hex();
    const fs::path file = folder() / (build + "-1.rows");
    // A record whose checksum is 0 gets the right one.
    std::string text(bytes);
    constexpr std::size_t mark = 13, number = sizeof(std::uint64_t), digest = sizeof(engine::Digest);
    if (text.size() >= mark + number) {
        std::uint64_t count = 0;
        std::memcpy(&count, text.data() + mark, number);
        const std::size_t end = mark + number + (count & 0xff) * 2 * digest;
        if (end + digest <= text.size() && text[end] == 0) {
            const auto sum =
                engine::Hasher().add_bytes(as_bytes(std::string_view(text).substr(mark, end - mark))).finish();
            std::memcpy(text.data() + end, &sum, digest);
        }
    }
    engine::write_file_soon(file, text);
    std::size_t rows = 0;
    refused_or_read([&] { store.read_rows([&](const engine::PlugContent&) { ++rows; }); });
    promise(rows * 2 * digest <= text.size(), "more rows than there are bytes");
    fs::remove(file);
}

void read_saved_state(std::string_view bytes) {
    refused_or_read([&] {
        const nodes::SimulationState state = nodes::load_simulation(as_bytes(bytes));
        const std::vector<std::byte> again = nodes::save(state);
        promise(again.size() == bytes.size() && std::memcmp(again.data(), bytes.data(), bytes.size()) == 0,
                "a state that was saved again has other bytes");
    });
    refused_or_read([&] {
        const solver::State state = solver::load(as_bytes(bytes));
        promise(solver::save(state).size() == bytes.size(), "a state that was saved again has other bytes");
    });
}

} // namespace sinew::fuzz
