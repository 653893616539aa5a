// SPDX-License-Identifier: MIT
// Section 5 of theory.md: formula (6) on real triangulations, and the minimum weight itself.
#include <algorithm>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <functional>
#include <glm/geometric.hpp>

#include "geometry.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using triangulate::Method;

Polygon polygon_of(std::initializer_list<Figure> rings) {
    Polygon polygon;
    for (const Figure& ring : rings) {
        polygon.points.insert(polygon.points.end(), ring.begin(), ring.end());
        polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
    }
    return polygon;
}

// A wall with a door and two windows.
Polygon wall() {
    return polygon_of({{{0, 0}, {2, 0}, {2, 2.1}, {3, 2.1}, {3, 0}, {7, 0}, {7, 3}, {0, 3}},
                       {{0.5, 1}, {1.4, 1}, {1.4, 2}, {0.5, 2}},
                       {{4, 0.9}, {6, 1}, {6, 2.2}, {4, 2.1}}});
}

// Measures all rings: boundary and area (outer ring minus holes, in either orientation).
measure::TriangulationMeasures measures_of(const Polygon& polygon, const triangulate::Triangulation& result) {
    measure::TriangulationMeasures sums;
    sums.triangles = static_cast<double>(result.triangles.size());
    sums.weight = result.weight;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const auto ring = polygon.ring(r);
        double twice = 0.0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            twice += cross(ring[i], ring[(i + 1) % ring.size()]);
            sums.boundary += glm::distance(ring[i], ring[(i + 1) % ring.size()]);
        }
        sums.area += (r == 0 ? 0.5 : -0.5) * std::abs(twice);
    }
    return sums;
}

// For a given rotation a frustum meets a triangle in the places of their sum: no counting of frusta.
void passed_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const Polygon polygon = wall();
    struct Lens {
        const char* name;
        bool perspective;
        double tan_x, tan_y, near, far;
    };
    const Lens lenses[] = {{"perspective", true, 1.0, 0.6, 0.1, 3.0}, {"orthographic", false, 1.0, 0.6, 0.0, 3.0}};
    std::uint64_t seed = options.seed * 1000 + 420;
    for (const Lens& lens : lenses) {
        Camera camera;
        camera.projection = lens.perspective ? Projection::perspective : Projection::orthographic;
        camera.fov_y = 2.0 * std::atan(lens.tan_y), camera.height = 2.0 * lens.tan_y;
        camera.aspect = lens.tan_x / lens.tan_y;
        camera.near_distance = lens.near, camera.far_distance = lens.far;
        const measure::IntrinsicVolumes b = *measure::intrinsic_volumes_of_frustum(camera);
        const Faceted frustum =
            faceted(frustum_body(lens.tan_x, lens.tan_y, lens.near, lens.far, lens.perspective).corners);
        for (const auto& [name, method] :
             {std::pair("ear clipping", Method::ear), std::pair("the minimum weight", Method::minimum_weight)}) {
            const auto result = triangulate::triangulate(polygon, {.method = method});
            if (!result) {
                rows.push_back(untried_row(std::string("formula (6) on ") + name, "theory.md section 5"));
                continue;
            }
            std::vector<Faceted> triangles;
            for (const auto& t : result->triangles) {
                Corners3 corners;
                for (const std::uint32_t v : t) corners.emplace_back(polygon.points[v], 0.0);
                triangles.push_back(faceted(corners));
            }
            const Mean mean = mean_over_rotations(seed++, effort(options, 1024), [&](const glm::dmat3& turn) {
                double sum = 0.0;
                for (const Faceted& t : triangles) sum += meeting_volume(frustum, t, turn);
                return sum;
            });
            rows.push_back(measured_row(std::string(lens.name) + " frusta: triangles met, a wall cut by " + name,
                                        "theory.md (6)", measure::triangles_met(b, measures_of(polygon, *result)),
                                        mean.value(), mean.standard_error()));
        }
    }
}

// All triangulations of a polygon without holes, by the side from the last corner to the first: its triangle's tip cuts
// the rest in two.
double least_weight(const Figure& ring) {
    const std::size_t n = ring.size();
    const auto inside = [&](std::size_t i, std::size_t j) {  // is (i, j) a side or a diagonal?
        if (j == i + 1 || (i == 0 && j == n - 1)) return true;
        const glm::dvec2 &a = ring[i], &b = ring[j];
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t m = (k + 1) % n;
            if (k == i || k == j || m == i || m == j) continue;
            const glm::dvec2 &p = ring[k], &q = ring[m];
            if (cross(b - a, p - a) * cross(b - a, q - a) <= 0.0 && cross(q - p, a - p) * cross(q - p, b - p) <= 0.0)
                return false;
        }
        // Its middle is inside: crossings of a ray to the right.
        const glm::dvec2 c = 0.5 * (a + b);
        bool in = false;
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec2 &p = ring[k], &q = ring[(k + 1) % n];
            if ((p.y > c.y) != (q.y > c.y) && c.x < p.x + (c.y - p.y) / (q.y - p.y) * (q.x - p.x)) in = !in;
        }
        return in;
    };
    const std::function<double(std::size_t, std::size_t)> least = [&](std::size_t i, std::size_t j) {
        if (j == i + 1) return 0.0;
        double best = HUGE_VAL;
        for (std::size_t k = i + 1; k < j; ++k) {
            if (!inside(i, k) || !inside(k, j) || cross(ring[k] - ring[i], ring[j] - ring[i]) <= 0.0) continue;
            const double sides = (k > i + 1 ? glm::distance(ring[i], ring[k]) : 0.0) +
                                 (k + 1 < j ? glm::distance(ring[k], ring[j]) : 0.0);
            best = std::min(best, least(i, k) + least(k, j) + sides);
        }
        return best;
    };
    return least(0, n - 1);
}

void weight_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    double predicted = 0.0, by_ears = 0.0, enumerated = 0.0;
    std::uint64_t cases = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        sampling::Random random(options.seed * 1000 + 430, i);
        Figure star;  // a simple polygon: star-shaped around the origin
        const int n = 6 + static_cast<int>(i % 5);
        for (int k = 0; k < n; ++k)
            star.push_back(random.uniform(0.2, 1.0) * sampling::circle_point((k + 0.8 * random.uniform()) / n));
        const Polygon polygon = polygon_of({star});
        const auto best = triangulate::triangulate(polygon),
                   ears = triangulate::triangulate(polygon, {.method = Method::ear});
        if (!best || !ears) {
            rows.push_back(untried_row("least weights of small polygons", "theory.md section 5"));
            return;
        }
        predicted += best->weight;
        by_ears += ears->weight;
        enumerated += least_weight(star);
        ++cases;
    }
    rows.push_back(computed_row("minimum weight: the least of all triangulations of small polygons, enumerated",
                                "theory.md section 5", predicted, enumerated, 1e-9 * predicted));
    rows.back().cases = cases;
    rows.push_back(wrong_row("ear clipping has the least weight of all triangulations", "theory.md section 5", by_ears,
                             enumerated, 1e-9 * by_ears));
}

}  // namespace

std::vector<VerifyRow> triangulation_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    passed_rows(options, rows);
    weight_rows(options, rows);
    return rows;
}

}  // namespace crofton::cli
