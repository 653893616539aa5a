// SPDX-License-Identifier: MIT
// Two meshes as shapes: overlap and distance, against all pairs of their triangles.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/gtc/quaternion.hpp>
#include <oracle/near_misses.hpp>
#include <oracle/triangle_distance.hpp>
#include <shape/mesh/meshes.hpp>
#include <vector>

using namespace crofton;
using oracle::NearMisses;

namespace {

// `place()` is called for each vertex.
template <class Place>
TriangleMesh soup(std::uint32_t triangles, const Place& place) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
        mesh.positions.push_back(place());
        mesh.indices.push_back(i);
    }
    return mesh;
}

std::vector<Triangle> placed(const TriangleMesh& mesh, const RigidTransform& pose) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        triangles.push_back({transform(pose, glm::dvec3(mesh.positions[mesh.indices[i]])),
                             transform(pose, glm::dvec3(mesh.positions[mesh.indices[i + 1]])),
                             transform(pose, glm::dvec3(mesh.positions[mesh.indices[i + 2]]))});
    return triangles;
}

// A quarter turn about each axis any number of times: exact, as translations by whole numbers are.
RigidTransform exact_pose(NearMisses& random) {
    glm::dmat3 rotation(1.0);
    for (int k = 0; k < 3; ++k) {
        glm::dmat3 quarter(0.0);
        quarter[k][k] = 1.0;
        quarter[(k + 1) % 3][(k + 2) % 3] = 1.0;
        quarter[(k + 2) % 3][(k + 1) % 3] = -1.0;
        for (unsigned turn = random.index(4); turn > 0; --turn) rotation = quarter * rotation;
    }
    return {rotation, glm::round(random.vector(-3.0, 3.0))};
}

void check_distance(const convex::Distance& d, const std::vector<Triangle>& a, const std::vector<Triangle>& b,
                    double least, double size) {
    CAPTURE(least);
    CHECK(d.distance == doctest::Approx(least).epsilon(1e-9));
    CHECK(d.lower <= least + 1e-13 * size);
    CHECK(d.upper >= least - 1e-13 * size);
    CHECK(d.upper - d.lower <= 1e-9 * size);
    REQUIRE(d.part_a.triangle < a.size());
    REQUIRE(d.part_b.triangle < b.size());
    const Triangle &t = a[d.part_a.triangle], &u = b[d.part_b.triangle];
    CHECK(oracle::distance_of_triangles(t, u) <= least + 1e-9 * size);
    CHECK(oracle::distance_to_triangle(d.on_a, t[0], t[1], t[2]) <= 1e-9 * size);
    CHECK(oracle::distance_to_triangle(d.on_b, u[0], u[1], u[2]) <= 1e-9 * size);
    CHECK(std::abs(glm::distance(d.on_a, d.on_b) - d.distance) <= 1e-9 * size);
    if (d.distance > 1e-6 * size) CHECK(glm::length(d.normal - (d.on_b - d.on_a) / d.distance) <= 1e-3);
}

}  // namespace

TEST_SUITE("convex/mesh pairs") {
    TEST_CASE("two meshes overlap if two of their triangles do, however barely, in either order") {
        NearMisses random(611);
        int meet = 0, apart = 0;
        for (int i = 0; i < 3000; ++i) {
            const auto on_grid = [&] { return 0.25f * glm::vec3(glm::round(random.vector(-6.0, 6.0))); };
            const TriangleMesh mesh_a = soup(1 + random.index(12), on_grid),
                               mesh_b = soup(1 + random.index(12), on_grid);
            const mesh::MeshTree tree_a = testing::tree_of(mesh_a), tree_b = testing::tree_of(mesh_b);
            const RigidTransform pose_a = exact_pose(random), pose_b = exact_pose(random);
            const auto a = placed(mesh_a, pose_a), b = placed(mesh_b, pose_b);
            bool expected = false;
            double least = HUGE_VAL;
            for (const Triangle& t : a)
                for (const Triangle& u : b) {
                    expected = expected || mesh::intersects(t, u);
                    least = std::min(least, oracle::distance_of_triangles(t, u));
                }
            if (expected) least = 0.0;
            const convex::Shape shape_a = *convex::Shape::mesh(tree_a), shape_b = *convex::Shape::mesh(tree_b);
            CAPTURE(i);
            REQUIRE(convex::intersects({shape_a, pose_a}, {shape_b, pose_b}) == expected);
            REQUIRE(convex::intersects({shape_b, pose_b}, {shape_a, pose_a}) == expected);
            const convex::Distance d = convex::distance({shape_a, pose_a}, {shape_b, pose_b});
            CHECK((d.distance == 0.0) == expected);
            check_distance(d, a, b, least, 10.0);
            check_distance(convex::distance({shape_b, pose_b}, {shape_a, pose_a}), b, a, least, 10.0);
            (expected ? meet : apart) += 1;
        }
        CHECK(meet > 300);
        CHECK(apart > 500);
    }

    TEST_CASE("the distance of two meshes has its proved bounds also where poses are rotations up to floats only") {
        NearMisses random(612);
        int apart = 0;
        for (int i = 0; i < 400; ++i) {
            const TriangleMesh mesh_a = testing::wavy_torus(1.0, 0.3, 0.1, 8, 6),
                               mesh_b = soup(20, [&] { return glm::vec3(random.vector(-1.0, 1.0)); });
            const mesh::MeshTree tree_a = testing::tree_of(mesh_a), tree_b = testing::tree_of(mesh_b);
            const auto pose = [&] {
                const glm::dvec3 axis = random.direction();
                const double angle = random.number(0.0, 6.0);
                RigidTransform result{glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)),
                                      (i % 4 == 0 ? 1e6 : 1.0) * glm::dvec3(1.0, 2.0, -1.0) + random.vector(-3.0, 3.0)};
                if (i % 2) result.rotation = glm::dmat3(glm::mat3(result.rotation));
                return result;
            };
            const RigidTransform pose_a = pose(), pose_b = pose();
            const auto a = placed(mesh_a, pose_a), b = placed(mesh_b, pose_b);
            double least = HUGE_VAL;
            for (const Triangle& t : a)
                for (const Triangle& u : b) least = std::min(least, oracle::distance_of_triangles(t, u));
            const convex::Shape shape_a = *convex::Shape::mesh(tree_a), shape_b = *convex::Shape::mesh(tree_b);
            CAPTURE(i);
            const double size = i % 4 == 0 ? 1e4 : 10.0;  // the oracle's own rounding, far out
            if (least > 1e-6) CHECK_FALSE(convex::intersects({shape_a, pose_a}, {shape_b, pose_b}));
            if (least == 0.0) CHECK(convex::intersects({shape_a, pose_a}, {shape_b, pose_b}));
            const convex::Distance d = convex::distance({shape_a, pose_a}, {shape_b, pose_b});
            if (least == 0.0 || least > 1e-6) check_distance(d, a, b, least, size);
            apart += least > 0.0;
        }
        CHECK(apart > 100);
    }
}
