// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/study/sphere_given_ancestors.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "ancestor_directions.hpp"
#include "direction_cells.hpp"

namespace crofton::study {
namespace {

using std::numbers::pi;

struct SphereCell {
    glm::dvec3 center;
    double half;
    double bound;
    std::uint64_t age;
};

class SphereSearch {
  public:
    // All relative to `origin`, amid the points: the directions' sum is not quite zero, which far away would count.
    SphereSearch(std::span<const glm::dvec3> points, const glm::dvec3& origin, const AncestorDirections& directions)
        : normals_(directions.normals), ancestors_(directions.limits) {
        for (const glm::dvec3& p : points) points_.push_back(p - origin);
        for (std::size_t i = 0; i < normals_.size(); ++i) ancestors_[i] -= glm::dot(normals_[i], origin);
    }

    [[nodiscard]] double radius_at(const glm::dvec3& center) const {
        double r = 0.0;
        for (const glm::dvec3& p : points_) r = std::max(r, glm::distance(p, center));
        return r;
    }

    [[nodiscard]] double measure_of(const glm::dvec3& center) const {
        const double r = radius_at(center);
        double sum = 0.0;
        for (std::size_t i = 0; i < normals_.size(); ++i)
            sum += std::min(ancestors_[i], glm::dot(center, normals_[i]) + r);
        return 4.0 * pi * sum / static_cast<double>(normals_.size());
    }

    // Below the measure of every sphere whose centre lies in the cube; infinite where all are larger than `largest`.
    [[nodiscard]] double bound(const glm::dvec3& center, double half, double largest) const {
        glm::dvec3 farthest = points_[0];
        for (const glm::dvec3& p : points_)
            if (glm::distance(p, center) > glm::distance(farthest, center)) farthest = p;
        const double r = glm::distance(farthest, center);
        if (r - std::sqrt(3.0) * half > largest) return std::numeric_limits<double>::infinity();
        const glm::dvec3 e = r > 0.0 ? (center - farthest) / r : glm::dvec3(0.0);
        std::array<double, 8> sums{};
        for (std::size_t i = 0; i < normals_.size(); ++i) {
            const double base = glm::dot(center, normals_[i]) + r;
            const glm::dvec3 slope = half * (normals_[i] + e);
            for (unsigned corner = 0; corner < 8; ++corner)
                sums[corner] +=
                    std::min(ancestors_[i], base + (corner & 1 ? slope.x : -slope.x) +
                                                (corner & 2 ? slope.y : -slope.y) + (corner & 4 ? slope.z : -slope.z));
        }
        return 4.0 * pi * *std::min_element(sums.begin(), sums.end()) / static_cast<double>(normals_.size());
    }

    // `least` is the radius of the smallest sphere, whose centre is the origin.
    void run(double least, const SphereOptions& options, SphereGivenAncestors& result) {
        const double largest = options.largest * least;
        const auto lower = [](const SphereCell& a, const SphereCell& b) {
            return a.bound != b.bound ? a.bound > b.bound : a.age > b.age;
        };
        Vector<SphereCell> heap;
        const auto consider = [&](const glm::dvec3& center) {
            if (radius_at(center) > largest) return;
            if (const double value = measure_of(center); value < result.value)
                result.value = value, result.sphere = {center, radius_at(center)};
        };
        // Every centre within `largest` of the object's points lies in this cube.
        heap.push_back({glm::dvec3(0.0), largest, bound(glm::dvec3(0.0), largest, largest), 0});
        consider(glm::dvec3(0.0));
        result.cells = 1;
        while (!heap.empty() && result.cells < options.max_cells &&
               heap.front().bound < result.value * (1.0 - options.tolerance)) {
            std::pop_heap(heap.begin(), heap.end(), lower);
            const SphereCell cell = heap.back();
            heap.pop_back();
            const double half = 0.5 * cell.half;
            for (unsigned corner = 0; corner < 8; ++corner) {
                const glm::dvec3 center =
                    cell.center +
                    half * glm::dvec3(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
                consider(center);
                ++result.cells;
                const double below = std::max(cell.bound, bound(center, half, largest));
                if (below >= result.value) {
                    dropped_ = std::min(dropped_, below);
                    continue;
                }
                heap.push_back({center, half, below, result.cells});
                std::push_heap(heap.begin(), heap.end(), lower);
            }
        }
        result.lower_bound = std::min({result.value, dropped_, heap.empty() ? result.value : heap.front().bound});
    }

  private:
    Vector<glm::dvec3> points_;
    const Vector<glm::dvec3>& normals_;
    Vector<double> ancestors_;
    double dropped_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Result<SphereGivenAncestors> sphere_given_ancestors(std::span<const glm::dvec3> points,
                                                    std::span<const ConvexBody> ancestors,
                                                    const SphereOptions& options) {
    if (!(options.largest >= 1.0 && options.largest <= 1e6) || !(options.tolerance > 0.0 && options.tolerance < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "sphere given ancestors: `largest` must lie in [1, 1e6], `tolerance` in (0, 1)");
    if (auto valid = validate_bodies(ancestors); !valid) return valid.error();
    const auto least = fit::minimal_sphere(points);
    if (!least) return least.error();
    const AncestorDirections directions(ancestors);
    if (!directions.contain(points))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "sphere given ancestors: the object is not inside its ancestors' bounds");
    SphereSearch search(points, least->center, directions);
    SphereGivenAncestors result;
    result.sphere = {glm::dvec3(0.0), least->radius};
    result.value = result.plain_value = search.measure_of(glm::dvec3(0.0));
    if (least->radius > 0.0)
        search.run(least->radius, options, result);
    else
        result.lower_bound = result.value;
    result.sphere.center += least->center;
    for (const glm::dvec3& p : points)
        result.sphere.radius = std::max(result.sphere.radius, glm::distance(p, result.sphere.center));
    return result;
}

}  // namespace crofton::study
