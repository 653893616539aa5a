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

// The ring with the inside on its left, from its first point on.
std::vector<std::uint32_t> ring_of(const Polygon& polygon) {
    const auto n = static_cast<std::uint32_t>(polygon.points.size());
    double area = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const glm::dvec2 a = polygon.points[i], b = polygon.points[(i + 1) % n];
        area += a.x * b.y - a.y * b.x;
    }
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < n; ++i) ring.push_back(area > 0.0 ? i : (n - i) % n);
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
            const auto ring = ring_of(p);
            const Triangles plain = clip_plainly(p, ring);
            REQUIRE(plain.size() == result->triangles.size());
            CHECK(std::equal(plain.begin(), plain.end(), result->triangles.begin()));
        }
        CHECK(compared > 400);
    }

    // Coordinates beyond 1e60 are scaled, which only the way through a domain does; by a power of two nothing changes.
    TEST_CASE("short simple rings need no domain: the same triangles, or the same refusal, as with one") {
        std::mt19937_64 random(52);
        int done = 0, refused = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            CAPTURE(trial);
            Polygon p;
            if (trial % 4 == 0) {
                add_star(p, random, {0, 0}, 1.0 + trial % 9, 10.0, 4 + trial % 150, trial % 3 == 0 ? 8.0 : 0.0);
            } else {
                // Few points of a small grid touch, cross, repeat and fold back.
                const std::size_t count = 3 + random() % 7, side = 2 + random() % 6;
                for (std::size_t i = 0; i < count; ++i) {
                    const double x = static_cast<double>(random() % side), y = static_cast<double>(random() % side);
                    p.points.emplace_back(x + (trial % 4 == 2 ? 0x1p-52 * static_cast<double>(random() % 3) : 0.0), y);
                }
                p.ring_ends.push_back(static_cast<std::uint32_t>(count));
            }
            Polygon large = p;
            for (glm::dvec2& point : large.points) point *= 0x1p210;
            const auto alone = triangulate::triangulate(p, {.method = Method::ear});
            const auto through = triangulate::triangulate(large, {.method = Method::ear});
            REQUIRE(alone.has_value() == through.has_value());
            ++(alone ? done : refused);
            if (!alone) continue;
            REQUIRE(alone->triangles.size() == through->triangles.size());
            CHECK(std::equal(alone->triangles.begin(), alone->triangles.end(), through->triangles.begin()));
            CHECK(alone->weight * 0x1p210 == doctest::Approx(through->weight).epsilon(1e-12));
            if (trial % 4 == 0 && trial % 3 != 0) CHECK(oracle::check_triangulation(p, alone->triangles) == "");
        }
        CHECK(done > 8000);
        CHECK(refused > 5000);
    }

    TEST_CASE("rings that touch or cross only far apart in their order are refused or cut as always") {
        for (int count = 40; count < 1500; count += 97) {
            Polygon p = band(count, 0.0);
            Polygon crossed = p;
            crossed.points[static_cast<std::size_t>(count) - 3].y = -1.0;  // through the other side
            CHECK(triangulate::triangulate(p, {.method = Method::ear}).has_value());
            CHECK_FALSE(triangulate::triangulate(crossed, {.method = Method::ear}).has_value());
            p.points[static_cast<std::size_t>(count) - 3].y = 0.0;  // onto it
            const auto touching = triangulate::triangulate(p, {.method = Method::ear}).value();
            CHECK(oracle::check_triangulation(p, touching.triangles) == "");
        }
    }

    TEST_CASE("bands of 50,000 vertices, straight and wavy: no quadratic time") {
        for (const double wave : {0.0, 5.0}) {
            const Polygon p = band(50'000, wave);
            const std::clock_t start = std::clock();
            const auto result = triangulate::triangulate(p, {.method = Method::ear}).value();
            CHECK(result.triangles.size() == p.points.size() - 2);
            // 0.02 to 0.1 s; where the time grows as the square, many seconds.
            CHECK(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC < 2.0);
        }
    }
}
