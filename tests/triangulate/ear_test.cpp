// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/geometry/predicates.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <ctime>
#include <oracle/triangulation_check.hpp>

#include "polygons.hpp"

using namespace crofton;
using namespace crofton::test;
using triangulate::Method;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Ear clipping as it is explained, in one loop over all corners: the first ear from `at` on is cut, then the search
// goes on at the neighbour but one. For simple rings.
Triangles clip_plainly(const Polygon& polygon, std::vector<std::uint32_t> ring) {
    const auto at_corner = [&](std::size_t i) { return polygon.points[ring[i % ring.size()]]; };
    Triangles triangles;
    std::size_t at = 0, failures = 0;
    while (ring.size() >= 3 && failures <= ring.size()) {
        const std::size_t n = ring.size(), before = (at + n - 1) % n, after = (at + 1) % n;
        const glm::dvec2 p = at_corner(before), q = at_corner(at), r = at_corner(after);
        bool ear = orientation(p, q, r) > 0;
        for (std::size_t k = 0; k < n && ear; ++k) {
            if (k == before || k == at || k == after) continue;
            const glm::dvec2 x = at_corner(k);
            ear = orientation(p, q, x) < 0 || orientation(q, r, x) < 0 || orientation(r, p, x) < 0;
        }
        if (!ear) {
            at = after;
            ++failures;
            continue;
        }
        triangles.push_back({ring[before], ring[at], ring[after]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
        // The corner after the cut one has moved to `at`; the search goes on behind it.
        at = (at % ring.size() + 1) % ring.size();
        failures = 0;
    }
    return triangles;
}

// The ring with the inside on its left, from the first triangle's middle corner on: nothing is cut before that one.
std::vector<std::uint32_t> ring_from(const Polygon& polygon, std::uint32_t start) {
    const auto n = static_cast<std::uint32_t>(polygon.points.size());
    double area = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const glm::dvec2 a = polygon.points[i], b = polygon.points[(i + 1) % n];
        area += a.x * b.y - a.y * b.x;
    }
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < n; ++i) ring.push_back(area > 0.0 ? (start + i) % n : (start + n - i) % n);
    return ring;
}

Polygon band(int count, double wave) {
    Polygon result;
    for (int i = 0; i < count / 2; ++i) result.points.emplace_back(i, wave * std::sin(0.05 * i));
    for (int i = count / 2; i-- > 0;) result.points.emplace_back(i, 1.0 + wave * std::sin(0.05 * i));
    result.ring_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
    return result;
}

}  // namespace

TEST_SUITE("triangulate/ear") {
    TEST_CASE("cuts the same ears in the same order as a plain loop over all corners") {
        std::mt19937_64 random(51);
        int compared = 0;
        for (int trial = 0; trial < 600; ++trial) {
            CAPTURE(trial);
            Polygon p;
            add_star(p, random, {0, 0}, 1.0 + trial % 9, 10.0, 4 + trial % 150, trial % 3 == 0 ? 8.0 : 0.0);
            if (trial % 2) std::reverse(p.points.begin(), p.points.end());
            const auto result = triangulate::triangulate(p, {.method = Method::ear});
            // On the grid a ring may touch itself.
            if (!result || oracle::check_triangulation(p, result->triangles) != "") continue;
            if (result->triangles.size() + 2 != p.points.size()) continue;
            ++compared;
            const auto ring = ring_from(p, result->triangles[0][1]);
            const Triangles plain = clip_plainly(p, ring);
            REQUIRE(plain.size() == result->triangles.size());
            CHECK(std::equal(plain.begin(), plain.end(), result->triangles.begin()));
        }
        CHECK(compared > 400);
    }

    TEST_CASE("bands of 50,000 vertices, straight and wavy: no quadratic time") {
        for (const double wave : {0.0, 5.0}) {
            const Polygon p = band(50'000, wave);
            const std::clock_t start = std::clock();
            const auto result = triangulate::triangulate(p, {.method = Method::ear});
            REQUIRE(result.has_value());
            CHECK(result->triangles.size() == p.points.size() - 2);
            // 0.02 to 0.1 s; where the time grows as the square, many seconds.
            CHECK(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC < 2.0);
        }
    }
}
