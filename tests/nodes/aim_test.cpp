// aim: bones between two joints.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <Eigen/Geometry>

using namespace bench;

namespace {

Eigen::Matrix4d matrix(const std::string& inputs, double frame = 1) {
    Session s(R"("a": {"type": "aim", "inputs": {)" + inputs + "}}");
    const auto m = s.get<engine::Matrix4>("a", "outMatrix", frame);
    return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
}

Eigen::Vector3d moved(const Eigen::Matrix4d& m, double x, double y, double z) {
    return (m * Eigen::Vector4d(x, y, z, 1)).head<3>();
}

using V = Eigen::Vector3d;

} // namespace

TEST_CASE("aim brings the rest joints and the side of up to where they are now", "[nodes]") {
    CHECK(matrix("").isIdentity(0));
    // A bone modelled along y with its joints at (1, 2, 3) and (1, 7, 3), whose front is z; then it points along -x
    // from (10, 0, 0) and its front looks to y.
    const std::string rest = R"("restStart": [1, 2, 3], "restEnd": [1, 7, 3], "restUp": [0, 0, 2])";
    const auto m = matrix(rest + R"(, "start": [10, 0, 0], "end": [5, 0, 0], "up": [0.3, 4, 0])");
    CHECK((moved(m, 1, 2, 3) - V(10, 0, 0)).norm() < 1e-14);
    CHECK((moved(m, 1, 7, 3) - V(5, 0, 0)).norm() < 1e-14);
    CHECK((moved(m, 1, 2, 4) - V(10, 1, 0)).norm() < 1e-14);
    CHECK(m.topLeftCorner<3, 3>().determinant() == Approx(1));
    // Joints farther apart than modelled stretch nothing.
    const auto longer = matrix(rest + R"(, "start": [0, 0, 0], "end": [0, 50, 0], "up": [0, 0, 1])");
    CHECK((moved(longer, 1, 7, 3) - V(0, 5, 0)).norm() < 1e-14);
}

TEST_CASE("aim follows keyed joints by the direction between them", "[nodes]") {
    const std::string keys = R"("end": {"keys": [[1, [1, 0, 0]], [3, [0, 0, 1]]]}, "up": [0, 1, 0])";
    // Halfway the joint is at (1/2, 0, 1/2): an eighth of a turn about y.
    const V half = moved(matrix(keys, 2), 1, 0, 0);
    CHECK((half - V(std::sqrt(0.5), 0, std::sqrt(0.5))).norm() < 1e-14);
    CHECK((moved(matrix(keys, 3), 0, 0, 1) - V(-1, 0, 0)).norm() < 1e-14);
}

TEST_CASE("joints at one place and an up along the bone are refused", "[nodes]") {
    const auto said = [](const std::string& inputs) {
        std::string text;
        CHECK(codes(R"("a": {"type": "aim", "inputs": {)" + inputs + "}}", "a", "outMatrix", &text) == Codes{"DG110"});
        return text;
    };
    CHECK(said(R"("end": [0, 0, 0])").find("start and end are the same point") != std::string::npos);
    CHECK(said(R"("end": [0, 3, 0])").find("up points along the line of the joints") != std::string::npos);
    CHECK(said(R"("up": [0, 0, 0])").find("up has no length") != std::string::npos);
    CHECK(said(R"("restUp": [-2, 0, 0])").find("restUp points along") != std::string::npos);
    // Neither tiny nor huge numbers are taken for nothing.
    CHECK(matrix(R"("end": [1e-200, 0, 0], "up": [0, 1e-300, 0])").isIdentity(0));
    CHECK(matrix(R"("end": [1e60, 0, 0], "up": [0, 1e50, 0])").isIdentity(0));
}
