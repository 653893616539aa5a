// SPDX-License-Identifier: MIT
// Minimum weight where sums of lengths differ by less than doubles tell.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <algorithm>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <random>
#include <span>
#include <vector>

using namespace crofton;

namespace {

// How much heavier than the least the triangles of a convex ring are, by lengths of 256 bits.
mpf_class excess_of(std::span<const glm::dvec2> ring, const triangulate::Triangulation& result) {
    const std::size_t n = ring.size();
    const mpf_class none(0, 256);
    std::vector<std::vector<mpf_class>> length(n, std::vector<mpf_class>(n, none)), least = length;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 2; j < n - (i == 0); ++j) {  // sides weigh the same in all
            const mpf_class x = mpf_class(ring[i].x, 256) - mpf_class(ring[j].x, 256),
                            y = mpf_class(ring[i].y, 256) - mpf_class(ring[j].y, 256);
            length[i][j] = sqrt(mpf_class(x * x + y * y, 256));
        }
    for (std::size_t width = 2; width < n; ++width)
        for (std::size_t i = 0; i + width < n; ++i) {
            mpf_class best(1e300, 256);
            for (std::size_t k = i + 1; k < i + width; ++k)
                if (const mpf_class sum = least[i][k] + least[k][i + width]; sum < best) best = sum;
            least[i][i + width] = best + length[i][i + width];
        }
    mpf_class twice(0, 256);
    for (const auto& t : result.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            twice += length[std::min(t[k], t[(k + 1) % 3])][std::max(t[k], t[(k + 1) % 3])];
    return twice / 2 - least[0][n - 1];
}

}  // namespace

TEST_SUITE("triangulate/near_ties") {
    TEST_CASE("the lesser of two sums that differ by less than their rounding is found") {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        triangulate::Triangulator triangulator;
        int valid = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            // Alike on both sides, but for its last bits.
            std::vector<glm::dvec2> ring;
            std::vector<double> angles(5);
            for (double& angle : angles) angle = 3.0 * (unit(random) - 0.5);
            std::sort(angles.begin(), angles.end());
            const double wide = 1.0 + 0.3 * unit(random), high = 1.0 + 0.3 * unit(random);
            for (const double angle : angles) ring.emplace_back(wide * std::cos(angle), high * std::sin(angle));
            for (std::size_t i = 5; i-- > 0;) ring.emplace_back(-ring[i].x, ring[i].y);
            for (glm::dvec2& p : ring)
                for (int k = 0; k < 2; ++k) p[k] += (static_cast<double>(random() % 5) - 2.0) * 0x1p-53;
            std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(random() % 10), ring.end());
            Polygon polygon;
            polygon.points.assign(ring.begin(), ring.end());
            polygon.ring_ends = {10};
            triangulate::Triangulation result;
            if (!triangulator.triangulate(polygon, {.work = triangulate::TriangulateOptions::kUnlimitedWork}, result))
                continue;
            ++valid;
            CAPTURE(trial);
            REQUIRE(result.optimal);
            REQUIRE(excess_of(ring, result) < 1e-40);
        }
        CHECK(valid > 2900);
    }
}
