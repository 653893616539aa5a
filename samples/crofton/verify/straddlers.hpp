// SPDX-License-Identifier: MIT
// Cameras, and bounds that reach a little across the surface of what they see or stop a little short of it.
#pragma once
#include <array>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>
#include <random>

namespace crofton::cli {

class Straddlers {
  public:
    // Cameras stand about `offset` from the world's origin.
    Straddlers(std::uint64_t seed, double offset) : random_(seed), offset_(offset) {}

    [[nodiscard]] Camera camera();

    // A bound that reaches 1 µm to 1 m across a point of the frustum's surface, inward or (one in two) short of it.
    // `corners` are the frustum's.
    using Corners = std::array<glm::dvec3, 8>;
    void make(const Frustum& frustum, const Corners& corners, Obb& box);
    void make(const Frustum& frustum, const Corners& corners, Aabb& box);
    void make(const Frustum& frustum, const Corners& corners, Sphere& sphere);

  private:
    [[nodiscard]] double number(double low, double high);
    [[nodiscard]] glm::dvec3 direction();
    [[nodiscard]] glm::dvec3 surface_point(const Corners& corners);
    [[nodiscard]] glm::dvec3 outward(const glm::dvec3& target, const Corners& corners);
    [[nodiscard]] glm::dvec3 normal_at(const Frustum& frustum, const glm::dvec3& target, const Corners& corners);
    [[nodiscard]] double depth();
    void place(Obb& box, const Frustum& frustum, const Corners& corners);

    std::mt19937_64 random_;
    double offset_;
};

}  // namespace crofton::cli
