// SPDX-License-Identifier: MIT
#include "fit_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#if defined(CROFTON_HAVE_CGAL)
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/optimal_bounding_box.h>
#endif

namespace crofton::bench {
namespace {

struct Mesh {
    Points positions;
    std::vector<std::uint32_t> triangles;
};

Mesh make_scan() {
    constexpr std::uint32_t kRows = 600, kColumns = 730;
    Mesh mesh;
    for (std::uint32_t i = 0; i < kRows; ++i)
        for (std::uint32_t j = 0; j < kColumns; ++j) {
            const double u = std::numbers::pi * (i + 0.5) / kRows, v = 2.0 * std::numbers::pi * j / kColumns;
            const double bump = 1.0 + 0.25 * std::sin(3.0 * u + 1.0) * std::cos(2.0 * v) +
                                0.06 * std::sin(11.0 * u) * std::sin(9.0 * v + u) +
                                0.004 * std::sin(90.0 * u + 70.0 * v);
            const glm::dvec3 p(1.7 * std::sin(u) * std::cos(v), 1.1 * std::sin(u) * std::sin(v) + 0.4 * std::cos(u),
                               std::cos(u));
            mesh.positions.emplace_back(p * bump);
            if (i + 1 == kRows) continue;
            const std::uint32_t a = i * kColumns + j, b = i * kColumns + (j + 1) % kColumns;
            mesh.triangles.insert(mesh.triangles.end(), {a, b, a + kColumns, b, b + kColumns, a + kColumns});
        }
    return mesh;
}

std::optional<Mesh> load(const std::string& name) {
    if (name == kScan) return make_scan();
    std::ifstream file(std::string(CROFTON_SHARED_DATA) + "/meshes/" + name + ".obj");
    if (!file) return std::nullopt;
    Mesh mesh;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("v ")) {
            glm::vec3 p;
            if (std::sscanf(line.c_str(), "v %f %f %f", &p.x, &p.y, &p.z) == 3) mesh.positions.push_back(p);
        } else if (line.starts_with("f ")) {
            std::vector<std::uint32_t> corner;
            for (const char* at = line.c_str() + 1; at != nullptr && *at != '\0';) {
                char* end = nullptr;
                const long index = std::strtol(at, &end, 10);
                if (end == at) break;
                corner.push_back(static_cast<std::uint32_t>(
                    index > 0 ? index - 1 : static_cast<long>(mesh.positions.size()) + index));
                at = std::find_if(static_cast<const char*>(end), line.c_str() + line.size(),
                                  [](char c) { return c == ' '; });
            }
            for (std::size_t i = 2; i < corner.size(); ++i)
                mesh.triangles.insert(mesh.triangles.end(), {corner[0], corner[i - 1], corner[i]});
        }
    }
    return mesh;
}

}  // namespace

std::optional<Points> load_points(const std::string& mesh) {
    std::optional<Mesh> loaded = load(mesh);
    if (!loaded) return std::nullopt;
    return std::move(loaded->positions);
}

Points turned(const Points& points, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
    const glm::dvec3 a = direction(), b = glm::normalize(glm::cross(a, direction()));
    const glm::dmat3 turn(a, b, glm::cross(a, b));
    Points result;
    for (const glm::vec3& p : points) result.emplace_back(turn * glm::dvec3(p));
    return result;
}

namespace {

// Splits `order` at multiples of `grain` near the middle, across the longest side of the places' bounds, until a part
// has at most `most`; hands each part to `take`.
template <class Place, class Take>
void split(std::vector<std::uint32_t>& order, std::size_t most, std::size_t grain, const Place& place,
           const Take& take) {
    std::vector<std::pair<std::size_t, std::size_t>> open = {{0, order.size()}};
    while (!open.empty()) {
        const auto [begin, end] = open.back();
        open.pop_back();
        if (end - begin <= most) {
            take(std::span<const std::uint32_t>(order).subspan(begin, end - begin));
            continue;
        }
        glm::vec3 low(1e30f), high(-1e30f);
        for (std::size_t i = begin; i < end; ++i) {
            low = glm::min(low, place(order[i]));
            high = glm::max(high, place(order[i]));
        }
        const glm::vec3 size = high - low;
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const std::size_t middle = begin + std::max<std::size_t>(1, (end - begin) / 2 / grain) * grain;
        const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [&](std::uint32_t a, std::uint32_t b) { return place(a)[axis] < place(b)[axis]; });
        open.insert(open.end(), {{begin, middle}, {middle, end}});
    }
}

}  // namespace

std::optional<ClusteredMesh> load_clusters(const std::string& name, std::size_t triangles) {
    std::optional<Mesh> mesh = load(name);
    if (!mesh) return std::nullopt;
    std::vector<std::uint32_t> order(mesh->triangles.size() / 3);
    std::iota(order.begin(), order.end(), 0u);
    const auto center = [&](std::uint32_t t) {
        return mesh->positions[mesh->triangles[3 * t]] + mesh->positions[mesh->triangles[3 * t + 1]] +
               mesh->positions[mesh->triangles[3 * t + 2]];
    };
    ClusteredMesh result;
    split(order, triangles, 1, center, [&](std::span<const std::uint32_t> part) {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t t : part)
            for (std::uint32_t k = 0; k < 3; ++k) corners.push_back(mesh->triangles[3 * t + k]);
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        result.indices.insert(result.indices.end(), corners.begin(), corners.end());
        result.ends.push_back(static_cast<std::uint32_t>(result.indices.size()));
    });
    result.positions = std::move(mesh->positions);
    return result;
}

std::optional<ClusteredMesh> load_vertex_clusters(const std::string& name, std::size_t size) {
    std::optional<Mesh> mesh = load(name);
    if (!mesh) return std::nullopt;
    std::vector<std::uint32_t> order(mesh->positions.size());
    std::iota(order.begin(), order.end(), 0u);
    ClusteredMesh result;
    split(
        order, size, size, [&](std::uint32_t i) { return mesh->positions[i]; },
        [&](std::span<const std::uint32_t> part) {
            result.indices.insert(result.indices.end(), part.begin(), part.end());
            result.ends.push_back(static_cast<std::uint32_t>(result.indices.size()));
        });
    result.positions = std::move(mesh->positions);
    return result;
}

std::array<std::uint32_t, 14> dito14_pass(const Points& points) {
    constexpr glm::vec3 kDirections[7] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                          {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    std::array<float, 7> low, high;
    low.fill(1e30f);
    high.fill(-1e30f);
    std::array<std::uint32_t, 14> result{};
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < 7; ++k) {
            const float t = glm::dot(points[i], kDirections[k]);
            if (t < low[k]) {
                low[k] = t;
                result[2 * k] = static_cast<std::uint32_t>(i);
            }
            if (t > high[k]) {
                high[k] = t;
                result[2 * k + 1] = static_cast<std::uint32_t>(i);
            }
        }
    return result;
}

std::optional<double> cgal_milliseconds([[maybe_unused]] const Points& points, [[maybe_unused]] int repetitions) {
#if defined(CROFTON_HAVE_CGAL)
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    std::vector<Kernel::Point_3> input;
    for (const glm::vec3& p : points) input.emplace_back(p.x, p.y, p.z);
    return best_milliseconds(repetitions, [&] {
        std::array<Kernel::Point_3, 8> corners;
        CGAL::oriented_bounding_box(input, corners, CGAL::parameters::use_convex_hull(true));
    });
#else
    return std::nullopt;
#endif
}

}  // namespace crofton::bench
