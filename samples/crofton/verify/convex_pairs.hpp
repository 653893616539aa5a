// SPDX-License-Identifier: MIT
// Random polytopes, and pairs of them that nearly touch.
#pragma once
#include <crofton/convex/query.hpp>
#include <memory>
#include <random>

namespace crofton::cli {

// Boxes, triangles and hulls of up to `corners` points: spheres, boxes, plates and rods. Alive until the next.
class ConvexPairs {
  public:
    explicit ConvexPairs(std::uint64_t seed) : random_(seed) {}

    struct Pair {
        convex::Shape a, b;
        RigidTransform pose_a, pose_b;
        glm::dvec3 normal;  // from a to b, about where they touch
        [[nodiscard]] convex::ShapeAtPose placed_a() const { return {a, pose_a}; }
        [[nodiscard]] convex::ShapeAtPose placed_b() const { return {b, pose_b}; }
    };
    // Along a direction, of which half are normals of faces, b is `gap` beyond a; both are about `offset` from the
    // origin. A third of the pairs is parallel.
    [[nodiscard]] Pair next(int corners, double gap, double offset);
    // The same of shapes whose sizes are 1e-6 to 1e6, one independent of the other's; the gap is times the larger size.
    [[nodiscard]] Pair next_of_sizes(int corners, double gap, double offset);
    // The same of two shapes that are given. b touches a, but for the gap, at a's farthest point along the direction.
    [[nodiscard]] Pair touching(const convex::Shape& a, const convex::Shape& b, double gap, double offset);

    [[nodiscard]] std::uint64_t bits() { return random_(); }
    [[nodiscard]] double number(double low, double high);
    [[nodiscard]] glm::dvec3 direction();

  private:
    [[nodiscard]] int index(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
    [[nodiscard]] glm::dmat3 rotation();
    [[nodiscard]] convex::Shape polytope(int corners, double size, std::unique_ptr<convex::Hull>& hull);

    std::mt19937_64 random_;
    std::unique_ptr<convex::Hull> hulls_[2];
};

}  // namespace crofton::cli
