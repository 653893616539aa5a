// SPDX-License-Identifier: MIT
// Hulls, contact points and their normals, and the eye's cell, as lines.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "overlay.hpp"

namespace crofton::viewer {
namespace {

constexpr std::uint32_t kHull = rgba(255, 165, 40), kManifold = rgba(255, 70, 230), kNormal = rgba(255, 255, 255),
                        kCell = rgba(80, 255, 255);
// The nearest so many: more lines say nothing more.
constexpr std::size_t kMaxHulls = 400;

std::vector<scene::InstanceId> nearest_to(const glm::dvec3& eye, std::span<const scene::InstanceId> ids,
                                          std::span<const Obb> boxes) {
    std::vector<scene::InstanceId> nearest(ids.begin(), ids.end());
    if (nearest.size() <= kMaxHulls) return nearest;
    const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(kMaxHulls);
    std::nth_element(nearest.begin(), middle, nearest.end(), [&](scene::InstanceId a, scene::InstanceId b) {
        const double d = glm::distance(boxes[a].center, eye), e = glm::distance(boxes[b].center, eye);
        return d < e || (d == e && a < b);
    });
    nearest.erase(middle, nearest.end());
    return nearest;
}

// The points as a polygon around their middle, across the normal.
void outline_patch(LineList& lines, std::span<const convex::TrackedPoint> points) {
    if (points.size() < 2) return;
    glm::dvec3 middle(0.0);
    for (const convex::TrackedPoint& point : points) middle += point.contact.position / double(points.size());
    const glm::dvec3 normal = points[0].normal;
    const glm::dvec3 side = std::fabs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(normal, side)), v = glm::cross(normal, u);
    std::vector<std::pair<double, glm::dvec3>> ring;
    for (const convex::TrackedPoint& point : points) {
        const glm::dvec3 arm = point.contact.position - middle;
        ring.emplace_back(std::atan2(glm::dot(arm, v), glm::dot(arm, u)), point.contact.position);
    }
    std::sort(ring.begin(), ring.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t edges = ring.size() > 2 ? ring.size() : 1;
    for (std::size_t i = 0; i < edges; ++i)
        lines.segment(ring[i].second, ring[(i + 1) % ring.size()].second, kManifold);
}

// An arrow from the manifold's deepest point, towards the second shape.
void draw_normal(LineList& lines, std::span<const convex::TrackedPoint> points, double length) {
    const auto deepest = std::max_element(
        points.begin(), points.end(), [](const auto& a, const auto& b) { return a.contact.depth < b.contact.depth; });
    const glm::dvec3 from = deepest->contact.position, to = from + length * deepest->normal;
    lines.segment(from, to, kNormal);
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 arm(0.0);
        arm[k] = 0.15 * length;
        const glm::dvec3 across = arm - glm::dot(arm, deepest->normal) * deepest->normal;
        lines.segment(to, to - 0.3 * length * deepest->normal + across, kNormal);
        lines.segment(to, to - 0.3 * length * deepest->normal - across, kNormal);
    }
}

}  // namespace

void Overlay::draw_hulls(LineList& lines, InstanceShapes& shapes, const scene::Scene& scene,
                         const pipeline::FrameStatistics& frame, std::span<const HullContacts> contacts) {
    const auto boxes = scene.world_boxes();
    hulls_ = manifold_points_ = 0;
    for (const scene::InstanceId i : nearest_to(frame.camera.position, frame.visible_ids, boxes))
        hulls_ +=
            shapes.outline(i, [&](const glm::dvec3& from, const glm::dvec3& to) { lines.segment(from, to, kHull); });
    for (const HullContacts& contact : contacts) {
        manifold_points_ += contact.points.size();
        const double size = std::min(glm::length(glm::dvec3(boxes[contact.first].half_extents)),
                                     glm::length(glm::dvec3(boxes[contact.second].half_extents)));
        convex::outline(contact.points, 0.05 * size,
                        [&](const glm::dvec3& from, const glm::dvec3& to) { lines.segment(from, to, kManifold); });
        outline_patch(lines, contact.points);
        draw_normal(lines, contact.points, 0.8 * size);
    }
    legend_.push_back({"convex hulls", kHull, hulls_});
    legend_.push_back({"points of their manifolds", kManifold, manifold_points_});
    legend_.push_back({"contact normals", kNormal, contacts.size()});
}

void Overlay::draw_cell(LineList& lines, const CellSight& sight) {
    constexpr const char* kKinds[] = {"the eye's cell, of no known kind", "the eye's cell, solid", "the eye's cell",
                                      "the eye's cell, which sees out"};
    legend_.push_back({kKinds[static_cast<std::size_t>(sight.kind)], kCell, sight.cell});
    lines.box(obb_of(sight.box), kCell);
}

}  // namespace crofton::viewer
