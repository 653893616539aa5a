// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/pvs/line_plan.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <oracle/plain_pvs.hpp>

using namespace crofton;
using namespace crofton::pvs;

namespace {

struct Planned {
    Cells cells;
    LinePlan plan;

    Planned(const Aabb& bounds, const glm::uvec3& counts, double epsilon)
        : cells(Cells::grid(bounds, counts).value()),
          plan(plan_lines(cells, 1000, {.epsilon = epsilon, .confidence = 0.9, .seed = 3}).value()) {}

    [[nodiscard]] Vector<Line> block(std::uint64_t i, const glm::dvec3& origin = glm::dvec3(0.0)) const {
        Vector<Line> lines;
        plan.draw(i, cells, origin, lines);
        return lines;
    }
};

double surface_of(const Aabb& box) {
    const glm::dvec3 e = box.max - box.min;
    return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

// Where a line enters, as a point of [0, 1)^4 of equal measure: place on the face, and the direction's shadow on it.
std::array<double, 4> coordinates(const Line& line, const Aabb& box, int axis) {
    const int s = (axis + 1) % 3, t = (axis + 2) % 3;
    const glm::dvec3 at = (line.point - box.min) / (box.max - box.min);
    const double x = line.direction[s], y = line.direction[t];
    const double turn = std::atan2(y, x) / (2.0 * std::numbers::pi);
    return {at[s], at[t], x * x + y * y, turn < 0.0 ? turn + 1.0 : turn};
}

}  // namespace

TEST_SUITE("pvs/line_plan") {
    TEST_CASE("rounds count for as many lines as the theory requires, and each face gets its share of each round") {
        for (const double epsilon : {1e-2, 1e-3, 1e-4, 2e-5}) {
            const Aabb bounds{{-3.0, 1.0, 2.0}, {9.0, 3.5, 11.0}};
            const Planned job(bounds, {6, 1, 5}, epsilon);
            REQUIRE(job.plan.whole);
            const double expected = job.plan.for_a_cell / job.plan.least_share;
            double sum = 0.0;
            std::uint64_t next = 0;
            REQUIRE(job.plan.parts.size() == 6 * job.plan.rounds.size());
            const glm::dvec3 e = bounds.max - bounds.min;
            for (std::size_t r = 0; r < job.plan.rounds.size(); ++r) {
                sum += job.plan.rounds[r];
                for (std::size_t f = 0; f < 6; ++f) {
                    const LinePlan::Part& part = job.plan.parts[6 * r + f];
                    CHECK(part.first == next);
                    next += part.blocks;
                    const double share = e[(part.axis + 1) % 3] * e[(part.axis + 2) % 3] / surface_of(bounds);
                    const auto lines = static_cast<double>(part.blocks * LinePlan::kBlock);
                    CHECK(lines >= share * job.plan.rounds[r]);
                    CHECK(lines <= share * job.plan.rounds[r] + 4097.0);
                }
            }
            CHECK(next == job.plan.blocks);
            CHECK(sum >= expected);
            CHECK(sum <= expected + 1.0);
        }
    }

    TEST_CASE("strata of one face and round have equal measures, and one of them holds each set of lines") {
        const Aabb bounds{{-3.0, 1.0, 2.0}, {9.0, 3.5, 11.0}};
        const Planned job(bounds, {6, 1, 5}, 1e-3);
        for (const LinePlan::Part& part : job.plan.parts) {
            // The boxes around strata do not meet but for rounding, and fill the cube in the mean.
            double volume = 0.0;
            for (std::uint64_t b = 0; b < part.blocks; ++b) {
                const Vector<Line> lines = job.block(part.first + b);
                REQUIRE(lines.size() == LinePlan::kBlock);
                for (std::size_t first = 0; first < lines.size(); first += LinePlan::kStratum) {
                    std::array<double, 4> low{1, 1, 1, 1}, high{0, 0, 0, 0};
                    for (std::size_t i = first; i < first + LinePlan::kStratum; ++i) {
                        const auto u = coordinates(lines[i], bounds, part.axis);
                        for (std::size_t k = 0; k < 4; ++k) {
                            low[k] = std::min(low[k], u[k]);
                            high[k] = std::max(high[k], u[k]);
                        }
                    }
                    // Of 64 uniform numbers the extremes are 63/65 of the interval apart.
                    double stratum = 1.0;
                    for (std::size_t k = 0; k < 4; ++k) stratum *= (high[k] - low[k]) * 65.0 / 63.0;
                    volume += stratum;
                }
            }
            CHECK(volume == doctest::Approx(1.0).epsilon(0.02));
        }
    }

    TEST_CASE("lines start on the box, enter it, and are uniform: crossings of plates are their areas'") {
        const Aabb bounds{{-3.0, 1.0, 2.0}, {9.0, 3.5, 11.0}};
        const glm::dvec3 origin(2.0, 1.0, 5.0);
        const Planned job(bounds, {6, 1, 5}, 1e-4);
        // Disjoint plates across each axis: the mean number of crossings of each is 2·area/surface.
        const Aabb plates[] = {{{0.0, 1.5, 4.0}, {0.0, 3.0, 9.0}},
                               {{1.0, 2.0, 4.0}, {7.0, 2.0, 8.0}},
                               {{-2.0, 1.2, 6.0}, {6.0, 3.2, 6.0}}};
        double met[3] = {}, lines_drawn = 0.0;
        for (std::uint64_t b = 0; b < job.plan.blocks; ++b)
            for (const Line& line : job.block(b, origin)) {
                ++lines_drawn;
                REQUIRE(std::abs(glm::length(line.direction) - 1.0) < 1e-12);
                double begin = 0.0, end = 0.0;
                REQUIRE(oracle::span_in({bounds.min - origin - 1e-9, bounds.max - origin + 1e-9}, line, begin, end));
                REQUIRE(std::abs(begin) < 1e-6);
                for (int k = 0; k < 3; ++k) {
                    const double t = (plates[k].min[k] - origin[k] - line.point[k]) / line.direction[k];
                    const glm::dvec3 p = line.point + t * line.direction + origin;
                    const int i = (k + 1) % 3, j = (k + 2) % 3;
                    met[k] += p[i] >= plates[k].min[i] && p[i] <= plates[k].max[i] && p[j] >= plates[k].min[j] &&
                              p[j] <= plates[k].max[j];
                }
            }
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 e = plates[k].max - plates[k].min;
            const double expected = 2.0 * e[(k + 1) % 3] * e[(k + 2) % 3] / surface_of(bounds) * lines_drawn;
            CAPTURE(k);
            // Strata spread evenly: closer than independent lines would be; faces round up to whole blocks.
            CHECK(std::abs(met[k] - expected) < 4.0 * std::sqrt(expected) + 0.002 * expected);
        }
    }
}
