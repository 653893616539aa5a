// SPDX-License-Identifier: MIT
// Hulls, distances, depths, manifolds and casts, in the same bits everywhere.
#include <crofton/convex/query.hpp>
#include <oracle/exact_convex.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

struct ConvexScene {
    std::vector<convex::Hull> hulls;
    std::vector<convex::Shape> shapes;
    std::vector<RigidTransform> poses;
};

// Neighbours in the list overlap or nearly touch.
ConvexScene convex_scene(std::uint64_t seed) {
    ConvexScene scene;
    Random random(seed);
    for (int i = 0; i < 40; ++i) {
        std::vector<glm::vec3> points;
        const std::uint32_t count = 6 + index(random, 40);
        for (std::uint32_t k = 0; k < count; ++k) points.emplace_back(sampling::direction(random.point<2>()));
        scene.hulls.push_back(convex::Hull::build(points, {.max_vertices = 32}).value());
    }
    for (int i = 0; i < 80; ++i) {
        const float size = static_cast<float>(0.5 + random.uniform());
        scene.shapes.push_back(i % 2 == 0   ? convex::Shape::hull(scene.hulls[static_cast<std::size_t>(i / 2)])
                               : i % 8 == 1 ? convex::Shape::box({size, 0.5f, 1.0f}).value()
                               : i % 8 == 3 ? convex::Shape::capsule(size, 0.25f).value()
                               : i % 8 == 5 ? convex::Shape::cylinder(size, 0.5f).value()
                                            : convex::Shape::cone(size, 0.5f).value());
        // One draw a statement: compilers order the operands of an expression as they like.
        const glm::dmat3 turn = sampling::rotation(random.point<3>());
        const double way = random.uniform(0.5, 1.2);
        scene.poses.push_back({turn, glm::dvec3(1e5, 0, 0) + way * sampling::direction(random.point<2>())});
    }
    return scene;
}

std::uint64_t convex_pairs() {
    Digest digest;
    const ConvexScene scene = convex_scene(51);
    for (const convex::Hull& hull : scene.hulls) {
        for (const glm::vec3& v : hull.vertices()) digest.add(glm::dvec3(v));
        for (const std::uint16_t i : hull.triangles()) digest.add(std::uint32_t{i});
        digest.add(hull.mass().volume).add(hull.mass().center);
    }
    for (std::size_t i = 1; i < scene.shapes.size(); ++i) {
        const convex::ShapeAtPose a{scene.shapes[i - 1], scene.poses[i - 1]}, b{scene.shapes[i], scene.poses[i]};
        convex::PairCache cache;
        const auto apart = convex::distance(a, b, &cache);
        const auto depth = convex::penetration(a, b, &cache);
        digest.add(apart.distance).add(apart.on_a).add(apart.on_b).add(depth.depth).add(depth.normal);
        const auto manifold = convex::contact_manifold(a, b, {.margin = 0.05}, &cache);
        for (int k = 0; k < manifold.count; ++k) digest.add(manifold.points[k].position).add(manifold.points[k].depth);
        const convex::Motion motion{{-3, 0.5, 0.25}, {0.5, 2.0, -1.0}, {}};
        RigidTransform away = scene.poses[i];
        away.translation.x += 4.0;
        digest.add(convex::cast(a, {}, {b.shape, away}, motion)->time);
    }
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/convex") {
    TEST_CASE("hulls, distances, depths, manifolds and casts are the same bits everywhere") {
        check_everywhere(0x815302869e8a5b27, [](Executor&) { return convex_pairs(); });
    }

    TEST_CASE("the published answer is that of exact integers") {
        const ConvexScene scene = convex_scene(51);
        for (std::size_t i = 2; i < 14; i += 2) {
            const convex::ShapeAtPose a{scene.shapes[i - 2], scene.poses[i - 2]}, b{scene.shapes[i], scene.poses[i]};
            const auto exact_a = oracle::exact_polytope(a), exact_b = oracle::exact_polytope(b);
            CHECK(convex::intersects(a, b) == oracle::meet_by_axes(exact_a, exact_b));
        }
    }
}
