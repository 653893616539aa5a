// SPDX-License-Identifier: MIT
// Groups small triangles into patches.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/radiosity/patches.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

namespace crofton::radiosity {
namespace {

// The key that small triangles of one patch share: place, side of the cube that they face, label.
using Key = std::array<std::int64_t, 5>;

Key key_of(const TriangleMesh& mesh, std::uint32_t t, std::uint32_t label, double size) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
    const glm::dvec3 center = (at(0) + at(1) + at(2)) / 3.0, normal = glm::cross(at(1) - at(0), at(2) - at(0));
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    const auto cell = [&](double x) {
        return static_cast<std::int64_t>(std::floor(std::clamp(x / size, -9e15, 9e15)));
    };
    return {cell(center.x), cell(center.y), cell(center.z), 2 * axis + (normal[axis] < 0.0 ? 1 : 0), label};
}

double area_of(const TriangleMesh& mesh, std::uint32_t t) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]); };
    return 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
}

}  // namespace

Vector<std::uint32_t> group_small_triangles(const TriangleMesh& mesh, std::span<const std::uint32_t> labels,
                                            double size) {
    const std::size_t count = mesh.triangle_count();
    Vector<std::uint32_t> patches(count), small;
    Vector<Key> keys;
    std::uint32_t next = 0;
    for (std::uint32_t t = 0; t < count; ++t) {
        if (area_of(mesh, t) >= 0.25 * size * size) {
            patches[t] = next++;
        } else {
            small.push_back(t);
            keys.push_back(key_of(mesh, t, labels.empty() ? 0 : labels[t], size));
        }
    }
    Vector<std::uint32_t> order(small.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && keys[order[i]] != keys[order[i - 1]]) ++next;
        patches[small[order[i]]] = next;
    }
    return patches;
}

}  // namespace crofton::radiosity
