// skinCluster: a mesh that follows joints by painted weights.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/json_file.h"
#include "nodes/matrices.h"
#include "nodes/options.h"
#include "solver/mesh/coordinates.h"
#include "solver/mesh/skinning.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;

namespace {

enum class Method { linear, dual_quaternion };
constexpr Option<Method> methods[] = {{"linear", Method::linear}, {"dualQuaternion", Method::dual_quaternion}};

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The mesh as it is bound: with the joints where they are at the graph's first frame, or at bindMatrices.",
};
const WireList<Matrix4> joints{
    .name = "joints",
    .doc = "The matrices that move it, for example transform.outMatrix of each bone.",
    .min_count = 1,
    .with_start = true,
};
const WireList<Matrix4> bind_matrices{
    .name = "bindMatrices",
    .doc = "Where the joints are while the mesh is bound, one each in the order of joints. None: where they are at the "
           "graph's first frame.",
};
const WireList<NumberList> weights{
    .name = "weights",
    .doc = "A painted map for each joint, in the order of joints: the share of each vertex that follows it.",
};
const Input<File> weights_file{
    .name = "weightsFile",
    .doc = "A JSON file with a row of numbers for each vertex, one for each joint, instead of weights.",
};
const Input<std::string> weights_pointer{
    .name = "weightsPointer",
    .doc = "The part of the file, as a JSON pointer (\"/skin/weights\"); empty is all of it.",
    .keyable = false,
};
const Input<std::string> sums{
    .name = "sums",
    .def = "normalise",
    .doc = "What happens where the weights of a vertex do not sum to 1: normalise divides them by their sum and warns, "
           "refuse fails.",
    .keyable = false,
    .options = {"normalise", "refuse"},
};
const Input<std::string> method{
    .name = "skinningMethod",
    .def = "linear",
    .doc = "linear takes the weighted mean of where the joints would bring a vertex; dualQuaternion blends turns and "
           "translations, which keeps the volume where joints twist, and knows no scale.",
    .keyable = false,
    .options = words(methods),
};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The mesh at this frame, in scene units."};

/// How far sums may be off 1 without a word: files round.
constexpr double rounded = 1e-4;

using Maps = std::vector<NumberList>; // one a joint

Maps painted_maps(const Reads& in, std::size_t joint_count, std::size_t vertices) {
    const auto given = in[weights];
    if (given.size() != joint_count)
        in.fail(weights.name, "FE295",
                std::to_string(given.size()) + " maps for " + std::to_string(joint_count) + " joints",
                "Connect a map for each joint, in the same order.");
    Maps out;
    for (std::size_t j = 0; j < given.size(); ++j) {
        check_map(in, weights.name, given[j], vertices, in.source_name(weights.name, j));
        out.push_back(per_vertex(given[j], vertices));
    }
    return out;
}

Maps maps_of_file(const Reads& in, std::size_t joint_count, std::size_t vertices) {
    return guarded(in, weights_file.name, [&] {
        const std::string& path = in[weights_file].path;
        const nlohmann::json whole = read_json(in.files(), path);
        const NumberList all = numbers_of(part_of(whole, in[weights_pointer], path), "weights", path);
        if (all.size() != joint_count * vertices)
            throw solver::Error("FE295",
                                path + " holds " + std::to_string(all.size()) + " weights; " +
                                    std::to_string(vertices) + " vertices and " + std::to_string(joint_count) +
                                    " joints take " + std::to_string(joint_count * vertices),
                                "Write one row for each vertex, with a number for each joint.");
        Maps out(joint_count, NumberList(vertices));
        for (std::size_t v = 0; v < vertices; ++v)
            for (std::size_t j = 0; j < joint_count; ++j) out[j][v] = all[v * joint_count + j];
        return out;
    });
}

/// Makes the weights of each vertex sum to 1.
void normalise(const Reads& in, std::string_view attribute, Maps& maps, std::size_t vertices) {
    std::size_t off = 0, first = 0, none = 0, first_none = 0;
    double worst = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
        double sum = 0;
        for (const NumberList& map : maps) {
            if (!(map[v] >= 0) || !std::isfinite(map[v]))
                in.fail(attribute, "FE295", "a weight of vertex " + std::to_string(v) + " is " + std::to_string(map[v]),
                        "Give shares, 0 to 1.");
            sum += map[v];
        }
        if (sum == 0) {
            if (none++ == 0) first_none = v;
            continue;
        }
        if (std::abs(sum - 1) > rounded) {
            if (off++ == 0) first = v;
            if (std::abs(sum - 1) > std::abs(worst)) worst = sum - 1;
        }
        for (NumberList& map : maps) map[v] /= sum;
    }
    if (none > 0)
        in.fail(attribute, "FE295",
                std::to_string(none) + " of " + std::to_string(vertices) + " vertices follow no joint, the first is " +
                    std::to_string(first_none),
                "Paint them for the joint that they shall follow.");
    if (off == 0) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "the weights of %zu of %zu vertices do not sum to 1, by up to %.3g; the first is %zu", off, vertices,
                  worst, first);
    if (in[sums] == "refuse")
        in.fail(attribute, "FE296", text, "Normalise them where they are painted, or set sums to normalise.");
    in.warn(attribute, "FE296", std::string(text) + ", and they are divided by their sum",
            "Normalise them where they are painted.");
}

Maps read_weights(const Reads& in, std::size_t joint_count, std::size_t vertices) {
    const bool from_file = !in[weights_file].path.empty(), painted = !in[weights].empty();
    if (from_file && painted)
        in.fail(weights.name, "DG110", "both weights and weightsFile are given", "Give one of the two.");
    if (!from_file && !painted && joint_count > 1)
        in.fail(weights.name, "DG110", "neither weights nor weightsFile is given",
                "Connect a map for each joint, or name a file.");
    if (!from_file && !painted) return {NumberList(vertices, 1.0)}; // all of it follows the only one
    Maps out = from_file ? maps_of_file(in, joint_count, vertices) : painted_maps(in, joint_count, vertices);
    normalise(in, from_file ? weights_file.name : weights.name, out, vertices);
    return out;
}

std::vector<solver::JointMotion> motions(const Reads& in) {
    const auto now = in[joints], given = in[bind_matrices];
    const auto bound = given.empty() ? in.at_start(joints) : given;
    if (bound.size() != now.size())
        in.fail(bind_matrices.name, "FE295",
                std::to_string(bound.size()) + " bind matrices for " + std::to_string(now.size()) + " joints",
                "Connect one for each joint, in the same order.");
    using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    std::vector<solver::JointMotion> out;
    for (std::size_t j = 0; j < now.size(); ++j) {
        check_affine(in, joints.name, now[j]);
        check_affine(in, given.empty() ? joints.name : bind_matrices.name, bound[j]);
        const Eigen::Map<const RowMajor> to(now[j].get().data()), from(bound[j].get().data());
        const solver::Mat3 linear = from.topLeftCorner<3, 3>();
        const double size = linear.cwiseAbs().maxCoeff();
        if (!(std::abs(linear.determinant()) > 1e-12 * size * size * size))
            in.fail(given.empty() ? joints.name : bind_matrices.name, "FE297",
                    in.source_name(given.empty() ? joints.name : bind_matrices.name, j) +
                        " makes everything flat where the mesh is bound",
                    "Bind with joints whose scale is not zero.");
        solver::JointMotion& motion = out.emplace_back();
        if (now[j].get() == bound[j].get()) continue; // just where it was, without rounding
        motion.linear = to.topLeftCorner<3, 3>() * linear.inverse();
        motion.shift = to.topRightCorner<3, 1>() - motion.linear * from.topRightCorner<3, 1>();
    }
    return out;
}

void compute(const Reads& in, Writes& out) {
    const Mesh& bound = in[mesh];
    const std::vector<solver::JointMotion> moving = motions(in);
    const Maps maps = read_weights(in, moving.size(), bound.points->size());
    const bool rigid = meaning(methods, in[method]) == Method::dual_quaternion;
    for (std::size_t j = 0; rigid && j < moving.size(); ++j)
        if (const double off = unlike_rigid(moving[j]); !(off <= 1e-5))
            in.fail(joints.name, "FE297",
                    in.source_name(joints.name, j) + " scales or shears, by " + std::to_string(0.5 * off) +
                        ", which dual quaternions do not know",
                    "Connect joints that translate and turn only, or take skinningMethod linear.");
    out.set(out_mesh, guarded(in, joints.name, [&] {
                solver::Points points = rigid ? solver::skin_by_dual_quaternions(*bound.points, moving, maps)
                                              : solver::skin_linearly(*bound.points, moving, maps);
                solver::check_coordinates(points);
                return bound.with_points(std::move(points));
            }));
}

} // namespace

void add_skin_cluster(Registry& registry) {
    NodeType type;
    type.name = "skinCluster";
    type.doc = "A mesh that follows joints, each vertex by its painted shares: a deforming bone, or a goal.";
    type.inputs = {describe(mesh),         describe(joints),          describe(bind_matrices), describe(weights),
                   describe(weights_file), describe(weights_pointer), describe(sums),          describe(method)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
