// SPDX-License-Identifier: MIT
#include "geometry.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace crofton::cli {
namespace {

constexpr std::uint64_t kBatches = 128;

template <std::size_t D, class Value>
Mean batched(std::uint64_t seed, std::uint64_t points, Value value) {
    Mean mean;
    for (std::uint64_t batch = 0; batch < kBatches; ++batch) {
        const sampling::UnitPoints numbers(seed * kBatches + batch, sampling::Sequence::quasi_random);
        double sum = 0.0;
        for (std::uint64_t i = 0; i < points; ++i) sum += value(numbers.at<D>(i));
        mean.add(sum / static_cast<double>(points));
    }
    return mean;
}

}  // namespace

double hull_volume(const Corners3& corners) {
    const auto hull = convex_hull(std::span<const glm::dvec3>(corners));
    if (!hull) return std::nan("");
    double six = 0.0;
    const glm::dvec3 a = corners[hull->vertices[0]];
    for (std::size_t i = 0; i < hull->triangles.size(); i += 3)
        six += glm::dot(corners[hull->triangles[i]] - a,
                        glm::cross(corners[hull->triangles[i + 1]] - a, corners[hull->triangles[i + 2]] - a));
    return six / 6.0;
}

double hull_area(const Figure& points) {
    const auto hull = measure::convex_hull(points);
    if (!hull) return std::nan("");
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < hull->size(); ++i)
        twice += cross((*hull)[i] - (*hull)[0], (*hull)[i + 1] - (*hull)[0]);
    return 0.5 * twice;
}

double shadow_area(const Corners3& corners, const glm::dvec3& direction) {
    const auto [x, y] = sampling::orthonormal_frame(direction);
    Figure shadow;
    for (const glm::dvec3& p : corners) shadow.emplace_back(glm::dot(p, x), glm::dot(p, y));
    return hull_area(shadow);
}

double breadth(const Corners3& corners, const glm::dvec3& direction) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const glm::dvec3& p : corners) {
        low = std::min(low, glm::dot(p, direction));
        high = std::max(high, glm::dot(p, direction));
    }
    return high - low;
}

Faceted faceted(const Corners3& points) {
    Faceted result;
    const auto hull = convex_hull(std::span<const glm::dvec3>(points));
    if (!hull) return result;
    for (const std::uint32_t v : hull->vertices) result.corners.push_back(points[v]);
    const auto add = [&](const glm::dvec3& twice_area) {
        const double length = glm::length(twice_area);
        if (length > 0.0) result.faces.push_back({twice_area / length, 0.5 * length});
    };
    for (std::size_t i = 0; i < hull->triangles.size(); i += 3) {
        const glm::dvec3 &a = points[hull->triangles[i]], &b = points[hull->triangles[i + 1]],
                         &c = points[hull->triangles[i + 2]];
        add(glm::cross(b - a, c - a));
        result.volume += glm::dot(a - result.corners[0], glm::cross(b - a, c - a)) / 6.0;
    }
    if (hull->rank == 2) {
        glm::dvec3 twice_area(0.0);
        for (std::size_t i = 1; i + 1 < result.corners.size(); ++i)
            twice_area += glm::cross(result.corners[i] - result.corners[0], result.corners[i + 1] - result.corners[0]);
        add(twice_area), add(-twice_area);
    }
    return result;
}

double meeting_volume(const Faceted& b, const Faceted& k, const glm::dmat3& rotation) {
    const auto support = [](const Corners3& corners, const glm::dvec3& n) {
        double h = -HUGE_VAL;
        for (const glm::dvec3& p : corners) h = std::max(h, glm::dot(p, n));
        return h;
    };
    double volume = b.volume + k.volume;
    for (const Faceted::Face& f : k.faces) volume += f.area * support(b.corners, -(f.normal * rotation));
    for (const Faceted::Face& f : b.faces) volume += f.area * support(k.corners, -(rotation * f.normal));
    return volume;
}

double meeting_volume_by_hull(const Corners3& b, const Corners3& k, const glm::dmat3& rotation) {
    Corners3 sum;
    for (const glm::dvec3& p : b) {
        const glm::dvec3 turned = rotation * p;
        for (const glm::dvec3& q : k) sum.push_back(q - turned);
    }
    return hull_volume(sum);
}

double containing_volume(const Body& b, const Corners3& k, const glm::dmat3& rotation) {
    std::vector<double> offsets;
    for (std::size_t f = 0; f < b.faces.size(); ++f) {
        double support = -HUGE_VAL;  // of K, turned the other way
        for (const glm::dvec3& p : k) support = std::max(support, glm::dot(rotation * p, b.normals[f]));
        offsets.push_back(glm::dot(b.normals[f], b.corners[b.faces[f][0]]) - support);
    }
    Corners3 corners;
    for (std::uint32_t c = 0; c < b.corners.size(); ++c) {
        std::vector<std::size_t> faces;
        for (std::size_t f = 0; f < b.faces.size(); ++f)
            if (std::find(b.faces[f].begin(), b.faces[f].end(), c) != b.faces[f].end()) faces.push_back(f);
        const glm::dmat3 rows(b.normals[faces[0]], b.normals[faces[1]], b.normals[faces[2]]);
        corners.push_back(glm::inverse(glm::transpose(rows)) *
                          glm::dvec3(offsets[faces[0]], offsets[faces[1]], offsets[faces[2]]));
    }
    return hull_volume(corners);
}

std::uint64_t effort(const VerifyOptions& options, std::uint64_t points) {
    return options.trials >= VerifyOptions{}.trials ? points : points / 16;
}

Mean mean_over_rotations(std::uint64_t seed, std::uint64_t points,
                         const std::function<double(const glm::dmat3&)>& value) {
    return batched<3>(seed, points, [&](const std::array<double, 3>& u) { return value(sampling::rotation(u)); });
}

// The height and the longitude, by the library's sine: the densities under test are not used to test themselves.
Mean mean_over_directions(std::uint64_t seed, std::uint64_t points,
                          const std::function<double(const glm::dvec3&)>& value) {
    return batched<2>(seed, points, [&](const std::array<double, 2>& u) {
        const double z = 2.0 * u[0] - 1.0, r = std::sqrt(1.0 - z * z), turn = 2.0 * std::numbers::pi * u[1];
        return value({r * std::cos(turn), r * std::sin(turn), z});
    });
}

double mean_over_angles(const std::function<double(double)>& value) {
    constexpr int kSteps = 1 << 14;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) sum += value(2.0 * std::numbers::pi * (i + 0.5) / kSteps);
    return sum / kSteps;
}

Figure clipped(const Figure& figure, const Figure& by) {
    Figure result = figure;
    for (std::size_t i = 0; i < by.size() && !result.empty(); ++i) {
        const glm::dvec2 &a = by[i], side = by[(i + 1) % by.size()] - a;
        Figure left;
        for (std::size_t k = 0; k < result.size(); ++k) {
            const glm::dvec2 &p = result[k], &q = result[(k + 1) % result.size()];
            const double at_p = cross(side, p - a), at_q = cross(side, q - a);
            if (at_p >= 0.0) left.push_back(p);
            if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0))
                left.push_back(p + at_p / (at_p - at_q) * (q - p));
        }
        result = std::move(left);
    }
    return result;
}

}  // namespace crofton::cli
