// SPDX-License-Identifier: MIT
// Random occluders, views and objects, and rays of the views.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oracle/box_rays.hpp>
#include <vector>

namespace crofton::test {

using sampling::Random;

struct OcclusionScene {
    Camera camera;
    std::vector<Obb> occluders, objects;
    occlude::BufferSize size{160, 96};
};

inline glm::dvec3 offset_of(double offset) {
    return offset * glm::dvec3(1.0, -0.75, 0.25);
}
inline std::size_t pick(Random& random, std::size_t count) {
    return static_cast<std::size_t>(random.bits() % count);
}

inline Camera camera_at(Random& random, double offset) {
    Camera camera;
    camera.position = offset_of(offset) + 3.0 * sampling::direction(random.point<2>());
    camera.forward = sampling::direction(random.point<2>());
    camera.up = sampling::direction(random.point<2>());
    if (pick(random, 4) == 0) camera.projection = Projection::orthographic;
    camera.fov_y = random.uniform(0.3, 2.0);
    camera.height = random.uniform(5.0, 40.0);
    camera.aspect = random.uniform(0.7, 2.0);
    camera.near_distance = random.uniform(0.05, 1.0);
    camera.far_distance = camera.near_distance + 200.0;
    return camera;
}

// A box at `center`, turned any way, of sizes over some octaves up to `largest`.
inline Obb box_at(Random& random, const glm::dvec3& center, double smallest, double largest) {
    Obb box;
    box.center = center;
    if (pick(random, 4) != 0) box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    for (int k = 0; k < 3; ++k)
        box.half_extents[k] = static_cast<float>(smallest * std::pow(largest / smallest, random.uniform()));
    return box;
}

// In front of the camera, at a distance; within the view more often than not.
inline glm::dvec3 point_in_view(Random& random, const Camera& camera, double distance) {
    const glm::dmat3 view_to_world = glm::transpose(world_to_view_rotation(camera));
    const double half =
        camera.projection == Projection::perspective ? distance * std::tan(0.5 * camera.fov_y) : 0.5 * camera.height;
    // One draw after the other: in which order arguments are computed is left to the compiler.
    const double y = random.uniform(-1, 1), x = random.uniform(-1, 1);
    return camera.position + view_to_world * glm::dvec3(1.1 * half * camera.aspect * x, 1.1 * half * y, -distance);
}

// Occluders of many kinds: large and small, slivers, around the eye, across the near plane; objects behind them and
// between them.
inline OcclusionScene random_scene(Random& random, double offset, std::size_t objects) {
    OcclusionScene scene;
    scene.camera = camera_at(random, offset);
    const std::size_t count = 1 + pick(random, 12);
    for (std::size_t i = 0; i < count; ++i) {
        const double distance = scene.camera.near_distance * 0.5 + 30.0 * std::pow(random.uniform(), 2.0);
        Obb box = box_at(random, point_in_view(random, scene.camera, distance), 0.2, 8.0);
        if (pick(random, 8) == 0) box.half_extents[static_cast<int>(pick(random, 3))] = 1e-4f;
        scene.occluders.push_back(box);
        if (pick(random, 6) == 0) {  // and one that touches it, along an axis
            const int k = static_cast<int>(pick(random, 3));
            box.center += 2.0 * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
            scene.occluders.push_back(box);
        }
    }
    for (std::size_t i = 0; i < objects; ++i) {
        const double distance = 1.0 + 60.0 * random.uniform();
        glm::dvec3 at = point_in_view(random, scene.camera, distance);
        if (pick(random, 2) == 0) {  // just behind an occluder, near its outline
            const Obb& box = scene.occluders[pick(random, scene.occluders.size())];
            at = box.center;
            for (int k = 0; k < 3; ++k)
                at += random.uniform(-1.1, 1.1) * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
            const glm::dvec3 away = scene.camera.projection == Projection::perspective
                                        ? at - scene.camera.position
                                        : glm::normalize(scene.camera.forward);
            at += random.uniform(0.0, 1.5) * away;
        }
        scene.objects.push_back(box_at(random, at, 0.01, i % 4 ? 0.3 : 3.0));
    }
    return scene;
}

inline occlude::OccluderSet set_of(const std::vector<Obb>& boxes) {
    occlude::OccluderSet set;
    for (const Obb& box : boxes) (void)set.place(box);
    return set;
}

// The ray of the view that ends at `point`.
inline oracle::WitnessRay ray_to(const Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const double depth = glm::dot(point - camera.position, forward);
    if (camera.projection == Projection::perspective) return {camera.position, point, camera.near_distance / depth};
    return {point - forward * depth, point, camera.near_distance / depth};
}

// Whether the view sees the point, nothing being before it.
inline bool is_in_view(const Frustum& frustum, const glm::dvec3& point) {
    for (const Plane& plane : frustum.view())
        if (!(glm::dot(plane.normal, point - frustum.origin) + plane.offset >= 0.0)) return false;
    return true;
}

// A point of a box: a corner, or on an edge, a face, or inside.
inline glm::dvec3 point_of(Random& random, const Obb& box) {
    glm::dvec3 point = box.center;
    const std::size_t kind = pick(random, 4);
    for (std::size_t k = 0; k < 3; ++k) {
        double t = random.uniform(-1, 1);
        if (k >= kind) t = t < 0.0 ? -1.0 : 1.0;
        point += t * double(box.half_extents[static_cast<int>(k)]) * glm::dvec3(box.axes[static_cast<int>(k)]);
    }
    return point;
}

// The ray through a point of the picture, in pixels from its lower left corner: from the near plane's side to a
// distance.
inline oracle::WitnessRay ray_through(const OcclusionScene& scene, double x, double y, double distance) {
    const Camera& camera = scene.camera;
    const glm::dmat3 view_to_world = glm::transpose(world_to_view_rotation(camera));
    const double guard = 0x1p-6, half_x = 0.5 * scene.size.width, half_y = 0.5 * scene.size.height;
    const double u = (x - half_x) / (half_x - guard), v = (y - half_y) / (half_y - guard);
    if (camera.projection == Projection::perspective) {
        const double t = std::tan(0.5 * camera.fov_y);
        const glm::dvec3 along = view_to_world * glm::dvec3(u * t * camera.aspect, v * t, -1.0);
        return {camera.position, camera.position + distance * along, camera.near_distance / distance};
    }
    const double half = 0.5 * camera.height;
    const glm::dvec3 from = camera.position + view_to_world * glm::dvec3(u * half * camera.aspect, v * half, 0.0);
    return {from, from + distance * glm::normalize(camera.forward), camera.near_distance / distance};
}

// What the picture's depth stands for: the distance along the view's axis.
inline double distance_of(const Camera& camera, float nearness) {
    return camera.projection == Projection::perspective ? 1.0 / double(nearness) : -double(nearness);
}

}  // namespace crofton::test
