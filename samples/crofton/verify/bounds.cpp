// SPDX-License-Identifier: MIT
// The sharp rows on bounds: what fit finds against plain searches, and each criterion's box against the others' boxes.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "geometry.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using std::numbers::pi;

// Five points whose best boxes by V, by F and by M are three: each exceeds the others' optimum by 2.5 % at least.
const Corners3 kPoints = {{1.1, -0.5, -0.1}, {1.3, 0.8, 0.5}, {0.4, 0.2, -0.4}, {1.1, 0.5, -0.2}, {-0.8, -0.2, -0.3}};
constexpr std::array<const char*, 3> kLeastOf = {"volume", "area", "edge sum"};

double size_of(int which, const glm::dvec3& edge) {
    if (which == 0) return edge.x * edge.y * edge.z;
    if (which == 1) return 2.0 * (edge.x * edge.y + edge.y * edge.z + edge.z * edge.x);
    return edge.x + edge.y + edge.z;
}

struct Turned {
    glm::dmat3 axes{1.0};
    double size = HUGE_VAL;
};

// The least over many rotations, then downhill by ever smaller random turns; from eight starts, the same for every seed
// of the command line, since a landscape with several valleys is no place for chance.
Turned search(int which) {
    Turned least;
    for (std::uint64_t start = 0; start < 8; ++start) {
        sampling::Random random(33, start);
        Turned best;
        const auto consider = [&](const glm::dmat3& axes) {
            glm::dvec3 edge;
            for (int k = 0; k < 3; ++k) edge[k] = breadth(kPoints, axes[k]);
            if (const double size = size_of(which, edge); size < best.size) best = {axes, size};
        };
        for (int i = 0; i < 3'000; ++i) consider(sampling::rotation(random.point<3>()));
        for (double step = 0.1; step > 1e-8; step *= 0.96)
            for (int i = 0; i < 16; ++i) {
                glm::dmat3 axes = best.axes;
                for (int k = 0; k < 3; ++k)
                    axes[k] += step * (glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - 0.5);
                axes[0] = glm::normalize(axes[0]);
                axes[1] = glm::normalize(axes[1] - glm::dot(axes[0], axes[1]) * axes[0]);
                axes[2] = glm::cross(axes[0], axes[1]);
                consider(axes);
            }
        if (best.size < least.size) least = best;
    }
    return least;
}

// The measure of the motions under which a query meets a box: the mean volume of sums. Difference of the V's alone for
// points.
void box_optima(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const measure::Criterion criteria[] = {measure::minimal_volume(), measure::minimal_area(),
                                           measure::minimal_perimeter()};
    std::array<Faceted, 3> boxes;
    for (int which = 0; which < 3; ++which) {
        const auto box = fit::fit_obb(std::span<const glm::dvec3>(kPoints),
                                      {.criterion = criteria[which], .quality = fit::Quality::exact});
        if (!box)
            return rows.push_back(
                untried_row(std::string("the box of least ") + kLeastOf[std::size_t(which)], "theory.md section 3"));
        const auto c = corners(*box);
        boxes[std::size_t(which)] = faceted(Corners3(c.begin(), c.end()));
        rows.push_back(computed_row(
            std::string("the box of least ") + kLeastOf[std::size_t(which)] + ", against a search over rotations",
            "theory.md section 3", size_of(which, 2.0 * glm::dvec3(box->half_extents)), search(which).size,
            1e-4 * size_of(which, glm::dvec3(box->half_extents))));
    }
    // Each kind of query, in the limit that its criterion is for, by sums of bodies.
    const Faceted queries[] = {faceted({glm::dvec3(0.0)}), faceted(segment_body(300.0).corners),
                               faceted(frustum_body(1.0, 0.6, 1.0, 3000.0, true).corners)};
    const char* claims[] = {"random points: the box of least volume is hit less than that of least ",
                            "long rays: the box of least area is hit less than that of least ",
                            "large frusta: the box of least edge sum is hit less than that of least "};
    std::uint64_t seed = options.seed * 1000 + 440;
    for (std::size_t q = 0; q < 3; ++q) {
        // The frustum's own volume does not count.
        std::array<Mean, 3> measured;
        for (std::size_t b = 0; b < 3; ++b)
            measured[b] = mean_over_rotations(seed, effort(options, 256), [&](const glm::dmat3& turn) {
                return meeting_volume(queries[q], boxes[b], turn) - queries[q].volume;
            });
        ++seed;
        for (std::size_t b = 0; b < 3; ++b) {
            if (b == q) continue;
            const double ratio = measured[q].value() / measured[b].value();
            const double error = ratio * std::hypot(measured[q].standard_error() / measured[q].value(),
                                                    measured[b].standard_error() / measured[b].value());
            rows.push_back(at_most_row(claims[q] + std::string(kLeastOf[b]) + " (ratio)",
                                       "paper, section 3; theory.md section 2", 0.985, ratio, error));
        }
    }
}

// Given its ancestor, a pentagon, this triangle's best rectangle has no side along one of its own.
void bounds_given_ancestor(std::vector<VerifyRow>& rows) {
    // Turned, so that the axes, where a search would begin, are no help.
    Figure around = {{-0.4, -0.3}, {-0.2, -0.8}, {0.3, 0.0}, {0.1, 0.0}, {0.5, 0.2}};
    for (glm::dvec2& p : around)
        p = {std::cos(0.5) * p.x - std::sin(0.5) * p.y, std::sin(0.5) * p.x + std::cos(0.5) * p.y};
    const Figure triangle(around.begin(), around.begin() + 3);
    // ∫ min(h_ancestor, h_rectangle) by plain quadrature.
    const auto measured = [&](double angle) {
        const glm::dvec2 axes[2] = {{std::cos(angle), std::sin(angle)}, {-std::sin(angle), std::cos(angle)}};
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 2; ++k)
            for (const glm::dvec2& p : triangle) {
                low[k] = std::min(low[k], glm::dot(p, axes[k]));
                high[k] = std::max(high[k], glm::dot(p, axes[k]));
            }
        return 2.0 * pi * mean_over_angles([&](double phi) {
                   const glm::dvec2 n(std::cos(phi), std::sin(phi));
                   double h = 0.0;
                   for (int k = 0; k < 2; ++k) {
                       const double along = glm::dot(axes[k], n);
                       h += along > 0.0 ? high[k] * along : low[k] * along;
                   }
                   double ancestor = -HUGE_VAL;
                   for (const glm::dvec2& p : around) ancestor = std::max(ancestor, glm::dot(p, n));
                   return std::min(h, ancestor);
               });
    };
    double least = HUGE_VAL, at = 0.0, flush = HUGE_VAL;
    for (int i = 0; i < 180; ++i)
        if (const double m = measured(0.5 * pi * i / 180); m < least) least = m, at = 0.5 * pi * i / 180;
    for (double step = 0.25 * pi / 180; step > 1e-6; step *= 0.5)
        for (const double angle : {at - step, at + step})
            if (const double m = measured(angle); m < least) least = m, at = angle;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 side = triangle[(i + 1) % 3] - triangle[i];
        flush = std::min(flush, measured(std::atan2(side.y, side.x)));
    }
    const auto best = study::optimal_rectangle(triangle, *study::PlanarSupport::of_hull(around));
    if (!best) return rows.push_back(untried_row("the best rectangle given a pentagon", "theory.md section 4"));
    rows.push_back(computed_row("the best rectangle given a pentagon, against a search over angles",
                                "theory.md section 4", best->measure, least, 1e-5 * least));
    rows.push_back(wrong_row("the best rectangle given a pentagon has a flush side", "theory.md section 4",
                             best->measure, flush, 1e-5 * flush));
    const Figure object = {{-1.0, -0.2}, {0.3, -0.5}, {1.1, 0.1}, {0.2, 0.7}};
    const auto disc = study::optimal_disc(object, study::PlanarSupport(Disc{{0.1, 0.2}, 1.3}));
    double smallest = HUGE_VAL;
    glm::dvec2 middle(0.0);
    const auto of_center = [&](const glm::dvec2& c) {
        double r = 0.0;
        for (const glm::dvec2& p : object) r = std::max(r, glm::distance(p, c));
        return 2.0 * pi * mean_over_angles([&](double phi) {
                   const glm::dvec2 n(std::cos(phi), std::sin(phi));
                   return std::min(glm::dot(c, n) + r, glm::dot(glm::dvec2(0.1, 0.2), n) + 1.3);
               });
    };
    for (double step = 1.0; step > 1e-5; step *= 0.7)
        for (int i = 0; i < 12; ++i) {
            const glm::dvec2 c = middle + step * glm::dvec2(std::cos(pi * i / 6), std::sin(pi * i / 6));
            if (const double m = of_center(c); m < smallest) smallest = m, middle = c;
        }
    if (disc)
        rows.push_back(computed_row("the best disc given a disc, against a search downhill", "theory.md section 4",
                                    disc->measure, smallest, 1e-5 * smallest));
}

// Around one polygon of the plane, against searches over directions.
void planar_optima(std::vector<VerifyRow>& rows) {
    const Figure object = {{0.0, 0.0}, {2.0, -0.3}, {2.6, 0.9}, {1.2, 1.7}, {-0.2, 1.0}};
    const auto support = [&](double angle) {
        double h = -HUGE_VAL;
        for (const glm::dvec2& p : object) h = std::max(h, p.x * std::cos(angle) + p.y * std::sin(angle));
        return h;
    };
    // A triangle by its sides' directions: perimeter and area from the support values and the angles between.
    const auto triangle = [&](const std::array<double, 3>& a, bool area) {
        double sine[3], sum = 0.0, half = 1.0;
        for (std::size_t k = 0; k < 3; ++k) {
            sine[k] = std::sin(a[(k + 2) % 3] - a[(k + 1) % 3]);
            if (sine[k] <= 1e-9) return HUGE_VAL;
            half *= sine[k];
            sum += sine[k] * support(a[k]);
        }
        return area ? sum * sum / (2.0 * half) : sum * (sine[0] + sine[1] + sine[2]) / half;
    };
    for (const bool area : {true, false}) {
        // The best of a grid for every direction of one side, and from each of them downhill.
        double least = HUGE_VAL;
        sampling::Random random(1, 35);
        for (int i = 0; i < 24; ++i) {
            std::array<double, 3> best{};
            double value = HUGE_VAL;
            const auto consider = [&](const std::array<double, 3>& a) {
                if (const double here = triangle(a, area); here < value) value = here, best = a;
            };
            for (int j = i + 1; j < i + 24; ++j)
                for (int k = j + 1; k < j + 24; ++k) consider({pi * i / 24, pi * j / 24, pi * k / 24});
            for (double step = 0.1; step > 1e-9; step *= 0.96)
                for (int n = 0; n < 10; ++n)
                    consider({best[0] + step * (random.uniform() - 0.5), best[1] + step * (random.uniform() - 0.5),
                              best[2] + step * (random.uniform() - 0.5)});
            least = std::min(least, value);
        }
        const auto found =
            fit::minimal_triangle(object, area ? fit::PlanarCriterion::area : fit::PlanarCriterion::perimeter);
        if (!found) {
            rows.push_back(untried_row("the least triangle around a polygon", "theory.md section 3"));
            continue;
        }
        const auto measures = measure::planar_measures_of_convex_polygon(*found);
        const double value = area ? measures.area : measures.perimeter;
        rows.push_back(computed_row(std::string("the triangle of least ") + (area ? "area" : "perimeter") +
                                        " around a polygon, against a search over directions",
                                    "paper, section 3.8", value, least, 1e-5 * value));
    }
}

}  // namespace

std::vector<VerifyRow> bound_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    box_optima(options, rows);
    bounds_given_ancestor(rows);
    planar_optima(rows);
    return rows;
}

}  // namespace crofton::cli
