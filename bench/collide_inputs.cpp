// SPDX-License-Identifier: MIT
#include "collide_inputs.hpp"

#include <cmath>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <sstream>

namespace crofton::bench {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

glm::dvec3 uniform_vector(Random& random, double low, double high) {
    return {uniform(random, low, high), uniform(random, low, high), uniform(random, low, high)};
}

glm::dquat rotation(Random& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

Obb box_at(Random& random, const glm::dvec3& center) {
    return {center, glm::mat3(glm::mat3_cast(rotation(random))), glm::vec3(uniform_vector(random, 0.2, 1.0))};
}

}  // namespace

BoxPairs random_pairs(std::size_t count) {
    Random random(42);
    BoxPairs pairs;
    for (std::size_t i = 0; i < count; ++i) {
        pairs.a.push_back(box_at(random, uniform_vector(random, -10.0, 10.0)));
        pairs.b.push_back(box_at(random, pairs.a.back().center + uniform_vector(random, -1.93, 1.93)));
    }
    return pairs;
}

BoxPairs stacked_pairs(std::size_t count) {
    Random random(5);
    BoxPairs pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dquat q = rotation(random);
        const glm::dmat3 frame = glm::mat3_cast(q);
        Obb a = box_at(random, uniform_vector(random, -10.0, 10.0)), b = a;
        a.axes = glm::mat3(frame);
        b.axes = glm::mat3(glm::mat3_cast(glm::normalize(q + 1e-7 * rotation(random))));
        b.half_extents = glm::vec3(uniform_vector(random, 0.2, 1.0));
        glm::dvec3 offset = uniform_vector(random, -0.3, 0.3);
        const int up = static_cast<int>(i % 3);
        offset[up] = static_cast<double>(a.half_extents[up]) + static_cast<double>(b.half_extents[up]);
        b.center = a.center + frame * offset;
        pairs.a.push_back(a);
        pairs.b.push_back(b);
    }
    return pairs;
}

BoxPairs grid_pairs(std::size_t count) {
    Random random(6);
    const auto on_grid = [&](double low, double high) {
        return glm::round(uniform_vector(random, low, high) * 16.0) / 16.0;
    };
    BoxPairs pairs;
    for (std::size_t i = 0; i < count; ++i) {
        Obb a{on_grid(-10.0, 10.0), glm::mat3(1.0f), glm::vec3(on_grid(0.25, 1.0))}, b = a;
        b.half_extents = glm::vec3(on_grid(0.25, 1.0));
        glm::dvec3 offset = on_grid(-0.25, 0.25);
        const int up = static_cast<int>(i % 3);
        offset[up] = static_cast<double>(a.half_extents[up]) + static_cast<double>(b.half_extents[up]);
        b.center = a.center + offset;
        pairs.a.push_back(a);
        pairs.b.push_back(b);
    }
    return pairs;
}

std::vector<Obb> crowd(std::size_t count) {
    Random random(7);
    const double side = 2.71 * std::cbrt(static_cast<double>(count));
    std::vector<Obb> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(box_at(random, uniform_vector(random, 0.0, side)));
    return boxes;
}

void move(std::vector<Obb>& boxes, int frame) {
    Random random(static_cast<std::uint64_t>(frame));
    for (Obb& box : boxes) {
        const auto bits = random();
        const auto component = [&](int shift) { return static_cast<double>(bits >> shift & 1023u) / 511.5 - 1.0; };
        box.center += 0.05 * glm::dvec3(component(0), component(10), component(20));
        const float c = 0.9998000066f, s = 0.0199986667f;  // of 0.02 rad
        const glm::vec3 x = box.axes[0], y = box.axes[1];
        box.axes[0] = glm::normalize(c * x + s * y);
        box.axes[1] = glm::normalize(glm::cross(box.axes[2], box.axes[0]));
        box.axes[2] = glm::cross(box.axes[0], box.axes[1]);
    }
}

TriangleMesh shared_mesh(const std::string& name) {
    TriangleMesh mesh;
    std::ifstream file(std::string(CROFTON_SHARED_DATA) + "/meshes/" + name + ".obj");
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            glm::vec3 p;
            words >> p.x >> p.y >> p.z;
            mesh.positions.push_back(p);
        } else if (word == "f") {
            std::vector<std::uint32_t> corner;
            while (words >> word) corner.push_back(static_cast<std::uint32_t>(std::stoul(word) - 1));
            for (std::size_t i = 2; i < corner.size(); ++i)
                for (const std::uint32_t index : {corner[0], corner[i - 1], corner[i]}) mesh.indices.push_back(index);
        }
    }
    return mesh;
}

std::vector<Ray> random_rays(const TriangleMesh& mesh, std::size_t count) {
    Random random(11);
    Aabb bound;
    for (const glm::vec3& p : mesh.positions) bound.include(glm::dvec3(p));
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const glm::dvec3 way = glm::normalize(glm::dvec3(0.001) + uniform_vector(random, -1.0, 1.0));
        const glm::dvec3 target = bound.center() + bound.half_extents() * uniform_vector(random, -1.0, 1.0);
        const glm::dvec3 from = bound.center() + 2.0 * glm::length(bound.half_extents()) * way;
        rays.push_back({from, glm::normalize(target - from)});
    }
    return rays;
}

std::vector<RigidTransform> close_poses(const mesh::MeshTree& tree, std::size_t count) {
    Random random(3);
    const mesh::MeshBox& box = tree.parts().root_box;
    double size = 0.0;
    for (const float half : box.half) size += 4.0 * static_cast<double>(half) * static_cast<double>(half);
    size = std::sqrt(size);
    const glm::dvec3 center(static_cast<double>(box.center[0]), static_cast<double>(box.center[1]),
                            static_cast<double>(box.center[2]));
    std::vector<RigidTransform> poses;
    while (poses.size() < count) {
        RigidTransform pose{glm::mat3_cast(rotation(random)), {}};
        const glm::dvec3 direction = glm::normalize(glm::dvec3(0.001) + uniform_vector(random, -1.0, 1.0));
        const auto at = [&](double t) { return center - pose.rotation * center + t * direction; };
        // Conservative advancement: a step as long as the distance cannot pass through.
        double t = 1.5 * size;
        for (int step = 0; step < 200; ++step) {
            pose.translation = at(t);
            const double gap = mesh::distance(tree, tree, pose).distance;
            if (gap < 1e-5 * size) break;
            t -= gap;
        }
        pose.translation = at(t + uniform(random, -0.05, 0.02) * size);
        poses.push_back(pose);
    }
    return poses;
}

}  // namespace crofton::bench
