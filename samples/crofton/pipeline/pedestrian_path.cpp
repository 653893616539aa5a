// SPDX-License-Identifier: MIT
#include "pedestrian_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace crofton::pipeline {
namespace {

constexpr std::size_t kPoints = 64;

struct VerticalLine {
    double x, z;
    std::vector<double> floors;  // heights at which the vertical line through (x, z) meets a surface
};

void add_crossings(std::array<glm::dvec3, 3> t, std::vector<VerticalLine>& columns) {
    const double area = (t[1].x - t[0].x) * (t[2].z - t[0].z) - (t[2].x - t[0].x) * (t[1].z - t[0].z);
    if (area == 0.0) return;
    const auto [low_x, high_x] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [low_z, high_z] = std::minmax({t[0].z, t[1].z, t[2].z});
    for (VerticalLine& column : columns) {
        if (column.x < low_x || column.x > high_x || column.z < low_z || column.z > high_z) continue;
        const auto share = [&](const glm::dvec3& p, const glm::dvec3& q) {
            return ((p.x - column.x) * (q.z - column.z) - (q.x - column.x) * (p.z - column.z)) / area;
        };
        const double a = share(t[1], t[2]), b = share(t[2], t[0]), c = share(t[0], t[1]);
        if (a >= 0.0 && b >= 0.0 && c >= 0.0) column.floors.push_back(a * t[0].y + b * t[1].y + c * t[2].y);
    }
}

}  // namespace

std::vector<glm::dvec3> find_pedestrian_path(const scene::Scene& scene, const Aabb& focus) {
    if (focus.is_empty()) return {};
    const glm::dvec3 size = focus.max - focus.min, center = focus.center();
    const bool along_x = size.x >= size.z;
    const double eye = std::min(0.2 * std::max(size.y, 1e-3 * size.x), 0.01 * std::hypot(size.x, size.z));
    std::vector<VerticalLine> columns;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double t = (static_cast<double>(i) + 0.5) / kPoints;
        columns.push_back(
            {along_x ? focus.min.x + t * size.x : center.x, along_x ? center.z : focus.min.z + t * size.z, {}});
    }
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        const TriangleMesh& mesh = scene.mesh(scene.mesh_of(i));
        const scene::Transform& world = scene.world(scene.node_of(i));
        const auto at = [&](std::size_t k) {
            return world.linear * glm::dvec3(mesh.positions[mesh.indices[k]]) + world.translation;
        };
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3)
            add_crossings({at(k), at(k + 1), at(k + 2)}, columns);
    }
    std::vector<glm::dvec3> walk;
    for (VerticalLine& column : columns) {
        std::sort(column.floors.begin(), column.floors.end());
        for (std::size_t f = 0; f < column.floors.size(); ++f) {
            const bool room = f + 1 == column.floors.size() || column.floors[f + 1] - column.floors[f] > 1.5 * eye;
            if (!room) continue;
            walk.emplace_back(column.x, column.floors[f] + eye, column.z);
            break;
        }
    }
    return walk;
}

}  // namespace crofton::pipeline
