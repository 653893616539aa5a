// SPDX-License-Identifier: MIT
// A part of the bake that no answer shows: lines through the voxels of a grid, eight at a time.
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <oracle/plain_pvs.hpp>
#include <vector>
#include <walk_kernels.hpp>

using namespace crofton;
using pvs::kernels::kWalkLanes;

namespace {

struct Grid {
    Aabb bounds;
    glm::uvec3 counts{1};
    pvs::kernels::VoxelGrid voxels;

    // Sizes and borders are without rounding.
    explicit Grid(sampling::Random& random) {
        double stride = 1.0;
        for (int k = 0; k < 3; ++k) {
            counts[k] = 1 + static_cast<std::uint32_t>(random.uniform(0.0, 6.0));
            voxels.min[k] = std::floor(random.uniform(-9.0, 9.0));
            voxels.width[k] = std::exp2(std::floor(random.uniform(-2.0, 2.0)));
            voxels.per_length[k] = 1.0 / voxels.width[k];
            voxels.max[k] = voxels.min[k] + counts[k] * voxels.width[k];
            voxels.counts[k] = counts[k];
            voxels.strides[k] = stride;
            stride *= counts[k];
            bounds.min[k] = voxels.min[k], bounds.max[k] = voxels.max[k];
        }
    }

    [[nodiscard]] std::uint32_t count() const { return counts.x * counts.y * counts.z; }
    [[nodiscard]] Aabb box(std::uint32_t voxel, double room) const {
        const glm::dvec3 at(voxel % counts.x, voxel / counts.x % counts.y, voxel / counts.x / counts.y);
        const glm::dvec3 width(voxels.width[0], voxels.width[1], voxels.width[2]);
        return {bounds.min + at * width - room, bounds.min + (at + 1.0) * width + room};
    }
};

// Some directions are 0 along one axis or two, then the point is inside, on the border, a rounding outside, or beyond.
Line random_line(sampling::Random& random, const Grid& grid) {
    const glm::dvec3 extent = grid.bounds.max - grid.bounds.min;
    Line line{grid.bounds.center(), sampling::direction(random.point<2>())};
    for (int k = 0; k < 3; ++k) line.point[k] += random.uniform(-0.8, 0.8) * extent[k];
    const int free = static_cast<int>(random.uniform(0.0, 3.0));
    for (int k = 0; k < 3; ++k) {
        if (k == free || random.uniform() < 0.5) continue;
        line.direction[k] = random.uniform() < 0.5 ? 0.0 : -0.0;
        const bool upper = random.uniform() < 0.5;
        const double border = upper ? grid.bounds.max[k] : grid.bounds.min[k], place = random.uniform();
        if (place < 0.2) line.point[k] = border;
        if (place > 0.8) line.point[k] = std::nextafter(border, upper ? HUGE_VAL : -HUGE_VAL);
    }
    if (glm::length(line.direction) < 0.1) line.direction[free] = 1.0;
    return line;
}

}  // namespace

TEST_SUITE("pvs/walk kernels") {
    TEST_CASE("lines pass the voxels that they meet, in order, and none outside the grid, on every instruction set") {
        constexpr double kRoom = 1e-9;
        int inside = 0, beside = 0, still_beside = 0;
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            sampling::Random random(53);
            for (int trial = 0; trial < 300; ++trial) {
                const Grid grid(random);
                std::vector<Line> lines;
                for (std::size_t i = 0; i < kWalkLanes; ++i) lines.push_back(random_line(random, grid));
                pvs::kernels::WalkStart start;
                std::vector<pvs::kernels::WalkStep> steps(64);
                REQUIRE(pvs::kernels::walk(grid.voxels, &lines[0].point.x, start, steps.data(), steps.size()));
                for (std::size_t i = 0; i < kWalkLanes; ++i) {
                    const Line& line = lines[i];
                    double begin = 0.0, end = 0.0;
                    const bool meets = oracle::span_in(grid.bounds, line, begin, end);
                    // Through an edge of the grid, within rounding.
                    if (begin != -HUGE_VAL && std::abs(end - begin) < kRoom) continue;
                    ++(meets ? inside : beside);
                    REQUIRE((start.steps[i] > 0.0) == meets);
                    if (!meets) {
                        still_beside += line.direction.x * line.direction.y * line.direction.z == 0.0;
                        continue;
                    }
                    CHECK(start.begin[i] == doctest::Approx(begin).epsilon(kRoom));
                    std::vector<int> passed(grid.count(), 0);
                    double at = start.begin[i];
                    for (std::size_t n = 0; n < static_cast<std::size_t>(start.steps[i]); ++n) {
                        const std::uint32_t voxel = steps[n].voxel[i];
                        const double to = steps[n].end[i];
                        REQUIRE(voxel < grid.count());
                        REQUIRE(to >= at);
                        ++passed[voxel];
                        double first = 0.0, last = 0.0;
                        REQUIRE(oracle::span_in(grid.box(voxel, kRoom), line, first, last));
                        CHECK(first <= at + kRoom);
                        CHECK(to <= last + kRoom);
                        at = to;
                    }
                    CHECK(at == doctest::Approx(end).epsilon(kRoom));
                    for (std::uint32_t v = 0; v < grid.count(); ++v) {
                        double first = 0.0, last = 0.0;
                        const bool deep = oracle::span_in(grid.box(v, -kRoom), line, first, last);
                        CHECK(passed[v] <= 1);
                        if (deep && last - first > kRoom) CHECK(passed[v] == 1);
                    }
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
        CHECK(inside > 1000);
        CHECK(beside > still_beside);
        CHECK(still_beside > 500);
    }
}
