// SPDX-License-Identifier: MIT
// The crowd that culling is measured on: cubes of half-extent 0.1–0.5 of the mean spacing 1, turned at random, and
// cameras that see a given share of them.
#pragma once
#include <cmath>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/camera.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <vector>

namespace crofton::bench {

inline std::vector<Obb> crowd(std::size_t count) {
    std::mt19937_64 random(count);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    const double side = std::cbrt(static_cast<double>(count));
    std::vector<Obb> boxes(count);
    for (Obb& box : boxes) {
        box.center = side * glm::dvec3(unit(random), unit(random), unit(random));
        const glm::dquat turn =
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
        box.axes = glm::mat3(glm::mat3_cast(turn));
        for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(0.1 + 0.4 * unit(random));
    }
    return boxes;
}

// Looks in from the middle of one face of the domain, a little askew; the angle is chosen so that the frustum sees
// `share` of the boxes' centres.
inline cull::View view_of_share(const std::vector<Obb>& boxes, double share) {
    const double side = std::cbrt(static_cast<double>(boxes.size()));
    Camera camera;
    camera.position = side * glm::dvec3(0.47, 0.53, 1.0);
    camera.forward = {0.05, -0.04, -1.0};
    camera.aspect = 1.0;
    camera.far_distance = 2.0 * side;
    double low = 0.01, high = 3.0;
    for (int step = 0; step < 24; ++step) {
        camera.fov_y = 0.5 * (low + high);
        const Frustum frustum = *frustum_of(camera);
        std::size_t seen = 0, tested = 0;
        for (std::size_t i = 0; i < boxes.size(); i += 1 + boxes.size() / 50000, ++tested) {
            bool inside = true;
            for (const Plane& plane : frustum.view())
                inside = inside && glm::dot(plane.normal, boxes[i].center - frustum.origin) + plane.offset >= 0.0;
            seen += inside;
        }
        (static_cast<double>(seen) < share * static_cast<double>(tested) ? low : high) = camera.fov_y;
    }
    return {*frustum_of(camera)};
}

}  // namespace crofton::bench
