// SPDX-License-Identifier: MIT
// Random frusta, and boxes that barely meet them or barely do not.
#pragma once
#include <array>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

namespace crofton::oracle {

class NearMisses {
  public:
    explicit NearMisses(std::uint64_t seed, double offset = 0.0) : random_(seed), offset_(offset) {}

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    // One after the other: in which order arguments are computed is left to the compiler.
    glm::dvec3 vector(double low, double high) {
        const double z = number(low, high), y = number(low, high), x = number(low, high);
        return {x, y, z};
    }
    unsigned index(unsigned count) { return std::uniform_int_distribution<unsigned>(0, count - 1)(random_); }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 v = vector(-1, 1);
            if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
        }
    }

    Camera camera() {
        Camera camera;
        camera.position = offset_ * glm::dvec3(1.0, -0.7, 0.3) + vector(-5, 5);
        camera.forward = direction();
        camera.up = direction();
        camera.projection = index(3) ? Projection::perspective : Projection::orthographic;
        camera.fov_y = number(0.2, 2.2);
        camera.height = number(1.0, 20.0);
        camera.aspect = number(0.5, 2.0);
        camera.near_distance = number(0.05, 1.0);
        camera.far_distance = camera.near_distance + number(1.0, 30.0);
        return camera;
    }

    // A point of the frustum's surface: on a corner, an edge or a face.
    glm::dvec3 surface_point(const Frustum& frustum, const std::array<glm::dvec3, 8>& corners) {
        const unsigned corner = index(8), free_axis = index(3), kind = index(3);
        glm::dvec3 p = corners[corner];
        if (kind > 0) p = glm::mix(p, corners[corner ^ (1u << free_axis)], number(0, 1));
        if (kind > 1) {
            const unsigned other = corner ^ (1u << ((free_axis + 1) % 3));
            p = glm::mix(p, glm::mix(corners[other], corners[other ^ (1u << free_axis)], number(0, 1)), number(0, 1));
        }
        return frustum.origin + p;
    }

    // A box one of whose surface points lies a depth of ±[shallowest, deepest] from the frustum's surface, most often
    // outside.
    Obb box(const Frustum& frustum, double shallowest = 1e-16, double deepest = 1e-1) {
        const glm::dvec3 axis = direction();
        const double angle = number(0.0, 6.2);
        const glm::mat3 axes(glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)));
        return box_along(index(8) == 0 ? glm::mat3(1.0f) : axes, frustum, shallowest, deepest);
    }
    Obb box_along(const glm::mat3& axes, const Frustum& frustum, double shallowest, double deepest) {
        const auto corners = *frustum_corners(frustum);
        Obb box;
        box.axes = axes;
        for (int k = 0; k < 3; ++k) box.half_extents[k] = index(10) ? float(std::exp(number(-4.0, 2.0))) : 0.0f;
        const glm::dvec3 target = surface_point(frustum, corners);
        const glm::dvec3 away = outward(frustum, corners, target);
        glm::dvec3 t;
        for (int k = 0; k < 3; ++k) t[k] = glm::dot(away, glm::dvec3(box.axes[k])) > 0.0 ? -1.0 : 1.0;
        if (index(2)) t[int(index(3))] = number(-1, 1);
        glm::dvec3 center = target;
        for (int k = 0; k < 3; ++k) center -= t[k] * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        const double depth = std::exp(number(std::log(shallowest), std::log(deepest)));
        box.center = center + (index(2) ? depth : -depth) * away;
        return box;
    }

    // Beyond the target as seen from the frustum's middle, or to its side.
    glm::dvec3 outward(const Frustum& frustum, const std::array<glm::dvec3, 8>& corners, const glm::dvec3& target) {
        glm::dvec3 middle(0.0);
        for (const glm::dvec3& corner : corners) middle += 0.125 * corner;
        return glm::normalize(glm::normalize(target - frustum.origin - middle) + number(0.0, 1.0) * direction());
    }

  private:
    std::mt19937_64 random_;
    double offset_;
};

}  // namespace crofton::oracle
