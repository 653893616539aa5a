// SPDX-License-Identifier: MIT
#include "straddlers.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace crofton::cli {

Camera Straddlers::camera() {
    Camera camera;
    camera.position = offset_ * glm::dvec3(1.0, -0.7, 0.3) + glm::dvec3(number(-5, 5), number(-5, 5), number(-5, 5));
    camera.forward = direction();
    camera.up = direction();
    camera.projection = number(0, 1) < 0.7 ? Projection::perspective : Projection::orthographic;
    camera.fov_y = number(0.2, 2.2);
    camera.height = number(1.0, 20.0);
    camera.aspect = number(0.5, 2.0);
    camera.near_distance = number(0.05, 1.0);
    camera.far_distance = camera.near_distance + number(1.0, 30.0);
    return camera;
}

void Straddlers::make(const Frustum& frustum, const Corners& corners, Obb& box) {
    const glm::dvec3 axis = direction();
    const double half_angle = number(0.0, 3.1);
    box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(half_angle), std::sin(half_angle) * axis)));
    place(box, frustum, corners);
}

void Straddlers::make(const Frustum& frustum, const Corners& corners, Aabb& box) {
    Obb placed;
    placed.axes = glm::mat3(1.0f);
    place(placed, frustum, corners);
    box.min = placed.center - glm::dvec3(placed.half_extents);
    box.max = placed.center + glm::dvec3(placed.half_extents);
}

void Straddlers::make(const Frustum& frustum, const Corners& corners, Sphere& sphere) {
    sphere.radius = std::exp(number(-4.0, 2.0));
    const glm::dvec3 target = surface_point(corners);
    const glm::dvec3 away = number(0, 1) < 0.8 ? normal_at(frustum, target, corners) : outward(target, corners);
    sphere.center = frustum.origin + target + (sphere.radius + depth()) * away;
}

// Turns and extents of `box` are given or chosen; then a corner, or (one in two) a point of an edge, comes to lie near
// the frustum's surface.
void Straddlers::place(Obb& box, const Frustum& frustum, const Corners& corners) {
    for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(std::exp(number(-4.0, 2.0)));
    const glm::dvec3 target = surface_point(corners), away = outward(target, corners);
    box.center = frustum.origin + target;
    const int free = number(0, 1) < 0.5 ? static_cast<int>(number(0, 3)) : 3;
    for (int k = 0; k < 3; ++k) {
        const double t = k == free ? number(-1, 1) : glm::dot(away, glm::dvec3(box.axes[k])) > 0.0 ? -1.0 : 1.0;
        box.center -= t * double{box.half_extents[k]} * glm::dvec3(box.axes[k]);
    }
    box.center += depth() * away;
}

double Straddlers::number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
}

glm::dvec3 Straddlers::direction() {
    for (;;) {
        const glm::dvec3 v(number(-1, 1), number(-1, 1), number(-1, 1));
        if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
    }
}

// Outward or inward.
double Straddlers::depth() {
    const double depth = std::exp(number(std::log(1e-6), 0.0));
    return number(0, 1) < 0.5 ? depth : -depth;
}

// A corner, or a point of an edge or a face.
glm::dvec3 Straddlers::surface_point(const Corners& corners) {
    const auto corner = static_cast<unsigned>(number(0, 8)), bit = static_cast<unsigned>(number(0, 3));
    glm::dvec3 target =
        glm::mix(corners[corner], corners[corner ^ (1u << bit)], number(0, 1) < 0.3 ? 0.0 : number(0, 1));
    if (number(0, 1) < 0.5) target = glm::mix(target, corners[corner ^ (1u << ((bit + 1) % 3))], number(0, 1));
    return target;
}

// Somewhere away from the frustum's middle.
glm::dvec3 Straddlers::outward(const glm::dvec3& target, const Corners& corners) {
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& c : corners) middle += 0.125 * c;
    return glm::normalize(glm::normalize(target - middle) + number(0.0, 1.0) * direction());
}

// In the cone of the outward normals there: what lies that way has `target` for its nearest point.
glm::dvec3 Straddlers::normal_at(const Frustum& frustum, const glm::dvec3& target, const Corners& corners) {
    glm::dvec3 sum(0.0);
    for (const Plane& plane : frustum.view())
        if (std::fabs(glm::dot(plane.normal, target) + plane.offset) < 1e-9) sum -= number(0.0, 1.0) * plane.normal;
    return glm::length(sum) > 1e-6 ? glm::normalize(sum) : outward(target, corners);
}

}  // namespace crofton::cli
