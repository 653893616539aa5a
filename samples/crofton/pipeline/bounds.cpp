// SPDX-License-Identifier: MIT
#include "bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace crofton::pipeline {
namespace {

constexpr std::array<std::pair<const char*, BoundsKind>, 6> kNames = {{{"sphere", BoundsKind::sphere},
                                                                       {"aabb", BoundsKind::aabb},
                                                                       {"obb-volume", BoundsKind::obb_volume},
                                                                       {"obb-area", BoundsKind::obb_area},
                                                                       {"obb-perimeter", BoundsKind::obb_perimeter},
                                                                       {"obb-frustum", BoundsKind::obb_frustum}}};

// Roundings of an affine map in double, relative to the sizes involved; grown by it, a bound holds the exact points.
constexpr double kRounding = 1e-15;

Sphere sphere_around(const TriangleMesh& mesh) {
    Aabb box;
    for (const glm::vec3& p : mesh.positions) box.include(glm::dvec3(p));
    if (box.is_empty()) return {};
    Sphere sphere{box.center(), 0.0};
    for (const glm::vec3& p : mesh.positions)
        sphere.radius = std::max(sphere.radius, glm::distance(glm::dvec3(p), sphere.center));
    sphere.radius *= 1.0 + 4.0 * kRounding;
    return sphere;
}

// The largest factor by which `linear` stretches, from above: the Frobenius norm of an orthogonal map would be √3 too
// large, so the square root of the largest row sum of |LᵀL| is used.
double largest_stretch(const glm::dmat3& linear) {
    const glm::dmat3 gram = glm::transpose(linear) * linear;
    double largest = 0.0;
    for (int i = 0; i < 3; ++i)
        largest = std::max(largest, std::abs(gram[i][0]) + std::abs(gram[i][1]) + std::abs(gram[i][2]));
    return std::sqrt(largest) * (1.0 + 16.0 * kRounding);
}

// Returns the sums of the magnitudes of a point's terms along each axis. The terms cancel if the mesh lies far from its
// own origin.
glm::dvec3 size_of_image(const Transform& world, const glm::dvec3& p) {
    return glm::abs(world.linear[0]) * std::abs(p.x) + glm::abs(world.linear[1]) * std::abs(p.y) +
           glm::abs(world.linear[2]) * std::abs(p.z) + glm::abs(world.translation);
}

Aabb world_aabb(const TriangleMesh& mesh, const Transform& world) {
    Aabb box;
    glm::dvec3 largest(0.0);
    for (const glm::vec3& p : mesh.positions) {
        box.include(world.linear * glm::dvec3(p) + world.translation);
        largest = glm::max(largest, glm::abs(glm::dvec3(p)));
    }
    const glm::dvec3 rounding = 4.0 * kRounding * size_of_image(world, largest);
    box.min -= rounding;
    box.max += rounding;
    return box;
}

}  // namespace

Result<BoundsKind> bounds_kind_from(const std::string& name) {
    for (const auto& [known, kind] : kNames)
        if (name == known) return kind;
    return fail(ErrorCode::invalid_argument, kNoItem,
                "bounds: '" + name + "' is not one of sphere, aabb, obb-volume, obb-area, obb-perimeter, obb-frustum");
}

const char* to_string(BoundsKind kind) {
    for (const auto& [name, known] : kNames)
        if (kind == known) return name;
    return "unknown";
}

Result<measure::Criterion> criterion_for(BoundsKind kind, const Camera& camera) {
    switch (kind) {
        case BoundsKind::obb_volume:
            return measure::minimal_volume();
        case BoundsKind::obb_area:
            return measure::minimal_area();
        case BoundsKind::obb_frustum:
            return measure::for_frustum(camera);
        default:
            return measure::minimal_perimeter();
    }
}

Bounds::Bounds(const scene::Scene& scene, BoundsKind kind) : scene_(scene), kind_(kind) {
    if (kind != BoundsKind::sphere && kind != BoundsKind::aabb) return;
    if (kind == BoundsKind::sphere) {
        for (scene::MeshId mesh = 0; mesh < scene.mesh_count(); ++mesh)
            mesh_spheres_.push_back(sphere_around(scene.mesh(mesh)));
        spheres_.resize(scene.instance_count());
    }
    boxes_.resize(scene.instance_count());
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) recompute(i);
}

std::span<const Obb> Bounds::boxes() const {
    return boxes_.empty() ? scene_.world_boxes() : std::span<const Obb>(boxes_);
}

void Bounds::update() {
    if (boxes_.empty()) return;
    for (const scene::InstanceId i : scene_.moved_instances()) recompute(i);
}

void Bounds::recompute(scene::InstanceId i) {
    const Transform& world = scene_.world(scene_.node_of(i));
    if (kind_ == BoundsKind::aabb) {
        boxes_[i] = obb_of(world_aabb(scene_.mesh(scene_.mesh_of(i)), world));
        if (!validate(boxes_[i])) boxes_[i] = scene_.world_boxes()[i];
        return;
    }
    const Sphere& local = mesh_spheres_[scene_.mesh_of(i)];
    Sphere& sphere = spheres_[i];
    sphere.center = world.linear * local.center + world.translation;
    sphere.radius = local.radius * largest_stretch(world.linear) +
                    8.0 * kRounding * glm::length(size_of_image(world, local.center));
    boxes_[i] = obb_of(Aabb{sphere.center - sphere.radius, sphere.center + sphere.radius});
    if (validate(boxes_[i])) return;
    boxes_[i] = scene_.world_boxes()[i];
    sphere = {boxes_[i].center, glm::length(glm::dvec3(boxes_[i].half_extents))};
}

}  // namespace crofton::pipeline
