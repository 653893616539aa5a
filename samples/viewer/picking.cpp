#include "picking.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace crofton::viewer {
namespace {

struct Ray {
    glm::dvec3 origin, direction;
};

Ray ray_through(const Camera& camera, const glm::dvec2& cursor) {
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    if (camera.projection == Projection::orthographic) {
        const double half = 0.5 * camera.height;
        return {camera.position + to_world * glm::dvec3(cursor.x * half * camera.aspect, cursor.y * half, 0.0),
                -to_world[2]};
    }
    const double half = std::tan(0.5 * camera.fov_y);
    return {camera.position,
            glm::normalize(to_world * glm::dvec3(cursor.x * half * camera.aspect, cursor.y * half, -1.0))};
}

// Slabs in the box's own frame, a little widened: the triangles decide.
bool may_hit(const Ray& ray, const Obb& box, double nearest) {
    double enter = 0.0, leave = nearest;
    const glm::dvec3 to_center = box.center - ray.origin;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k]);
        const double middle = glm::dot(axis, to_center), speed = glm::dot(axis, ray.direction);
        const double half = static_cast<double>(box.half_extents[k]) * 1.0001 + 1e-9;
        if (std::fabs(speed) < 1e-12) {
            if (std::fabs(middle) > half) return false;
            continue;
        }
        const double a = (middle - half) / speed, b = (middle + half) / speed;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

// Distance along the ray (Möller and Trumbore 1997), or infinity.
double hit_distance(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    constexpr double kMiss = std::numeric_limits<double>::infinity();
    const glm::dvec3 ab = b - a, ac = c - a, normal = glm::cross(ray.direction, ac);
    const double determinant = glm::dot(ab, normal);
    if (determinant == 0.0) return kMiss;
    const glm::dvec3 to_origin = ray.origin - a, across = glm::cross(to_origin, ab);
    const double u = glm::dot(to_origin, normal) / determinant, v = glm::dot(ray.direction, across) / determinant;
    const double t = glm::dot(ac, across) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 ? t : kMiss;
}

}  // namespace

std::optional<Pick> pick(const scene::Scene& scene, std::span<const scene::InstanceId> candidates, const Camera& camera,
                         const glm::dvec2& cursor) {
    const Ray ray = ray_through(camera, cursor);
    Pick best;
    best.distance = std::numeric_limits<double>::infinity();
    for (const scene::InstanceId instance : candidates) {
        if (!may_hit(ray, scene.world_boxes()[instance], best.distance)) continue;
        const TriangleMesh& mesh = scene.mesh(scene.mesh_of(instance));
        const scene::Transform& world = scene.world(scene.node_of(instance));
        const auto point = [&](std::size_t i) {
            return world.linear * glm::dvec3(mesh.positions[mesh.indices[i]]) + world.translation;
        };
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
            const double distance = hit_distance(ray, point(t), point(t + 1), point(t + 2));
            if (distance < best.distance)
                best = {instance, static_cast<std::uint32_t>(t / 3), distance, ray.origin + distance * ray.direction};
        }
    }
    if (!std::isfinite(best.distance)) return std::nullopt;
    return best;
}

}  // namespace crofton::viewer
