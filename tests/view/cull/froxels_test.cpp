// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/lights.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <oracle/exact_bounds.hpp>
#include <oracle/exact_spot.hpp>
#include <utility>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;

namespace {

// Looks along −z from the origin; 8 wide and high, 1 to 9 deep: boundaries at whole numbers.
cull::FroxelGrid unit_grid() {
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.height = 8.0;
    camera.aspect = 1.0;
    camera.near_distance = 1.0;
    camera.far_distance = 9.0;
    return *cull::FroxelGrid::build(camera, {8, 8, 8});
}

std::vector<std::uint32_t> froxels_of(const cull::FroxelLights& lights, const cull::FroxelGrid& grid,
                                      std::uint32_t light) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t f = 0; f < grid.size(); ++f)
        if (test::ranges::binary_search(lights.lights_of(f), light)) result.push_back(f);
    return result;
}

// A light that nearly touches the cell, or nearly does not: with its cap or with its side.
cull::SpotLight near_spot(oracle::NearMisses& random, const Frustum& cell) {
    const glm::dvec3 target = random.surface_point(cell, *frustum_corners(cell));
    const double distance = std::exp(random.number(-3.0, 2.0));
    const glm::dvec3 direction = random.direction();
    const double miss = std::exp(random.number(std::log(1e-7), std::log(0.3))) * (random.index(2) ? 1.0 : -1.0);
    cull::SpotLight spot;
    spot.apex = target - distance * direction;
    spot.axis = glm::vec3(random.direction());
    if (glm::dot(glm::dvec3(spot.axis), direction) < 0.0) spot.axis = -spot.axis;
    if (random.index(2)) {
        spot.cos_half_angle = float(glm::clamp(glm::dot(glm::dvec3(spot.axis), direction) + miss, 0.0, 1.0));
        spot.range = float(distance * random.number(1.0, 3.0));
    } else {
        spot.cos_half_angle = float(random.number(0.0, glm::dot(glm::dvec3(spot.axis), direction)));
        spot.range = float(std::max(0.0, distance * (1.0 + miss)));
    }
    return spot;
}

struct RandomLights {
    std::vector<Sphere> points;
    std::vector<cull::SpotLight> spots;

    RandomLights(std::uint64_t seed, const cull::FroxelGrid& grid, std::size_t count, double offset) {
        oracle::NearMisses random(seed, offset);
        for (std::size_t i = 0; i < count; ++i) {
            const Frustum cell = grid.froxel(random.index(std::uint32_t(grid.size())));
            points.push_back(oracle::near_sphere(random, cell));
            spots.push_back(near_spot(random, grid.froxel(random.index(std::uint32_t(grid.size())))));
        }
    }
};

}  // namespace

TEST_SUITE("cull/froxels") {
    TEST_CASE("grids that cannot be are refused with a reason") {
        const auto code = [](const Camera& camera, const cull::FroxelOptions& options) {
            return error_of(cull::FroxelGrid::build(camera, options)).code;
        };
        const Camera camera;
        CHECK(code(camera, {0, 9, 24}) == ErrorCode::out_of_range);
        CHECK(code(camera, {16, 9, 1025}) == ErrorCode::out_of_range);
        Camera endless = camera;
        endless.far_distance = std::numeric_limits<double>::infinity();
        CHECK(code(endless, {}) == ErrorCode::invalid_argument);
        for (int k = 0; k < 3; ++k) {
            Camera far_away = camera;
            far_away.position[k] = 1e13;
            CHECK(code(far_away, {}) == ErrorCode::out_of_range);
        }
        Camera wide = camera;
        wide.fov_y = 3.13;
        CHECK(code(wide, {}) == ErrorCode::out_of_range);
        const double same[] = {1.0, 2.0, 2.0}, behind[] = {-1.0, 2.0, 3.0}, unknown[] = {1.0, std::nan(""), 3.0};
        CHECK(code(camera, {4, 4, 2, same}) == ErrorCode::out_of_range);
        CHECK(code(camera, {4, 4, 2, behind}) == ErrorCode::out_of_range);
        CHECK(error_of(cull::FroxelGrid::build(camera, {4, 4, 2, unknown})).item == 1);
        CHECK(code(camera, {4, 4, 3, same}) == ErrorCode::invalid_argument);
        const double close[] = {1.0, 1.0 + 0x1p-21, 2.0}, apart[] = {1.0, 1.0 + 0x1p-19, 2.0};
        CHECK(code(camera, {4, 4, 2, close}) == ErrorCode::out_of_range);
        CHECK(cull::FroxelGrid::build(camera, {4, 4, 2, apart}).has_value());
        const double depths[] = {1.0, 2.0, 1e6};
        CHECK(cull::FroxelGrid::build(endless, {4, 4, 2, depths}).has_value());
    }

    TEST_CASE("components and cosines below 2^-30 are read as 0, larger ones are not") {
        const cull::FroxelGrid grid = unit_grid();
        const auto columns_of = [&](const cull::SpotLight& spot) {
            cull::FroxelLights lights;
            REQUIRE(cull::find_lights(grid, {}, std::array{spot}, lights).has_value());
            std::uint32_t lowest = 8, highest = 0;
            for (const std::uint32_t f : froxels_of(lights, grid, 0)) {
                lowest = std::min(lowest, f % 8);
                highest = std::max(highest, f % 8);
            }
            return std::pair(lowest, highest);
        };
        // A half sphere just left of the middle: columns 0 to 3. Its side leans across the middle only if it may lean.
        cull::SpotLight spot;
        spot.apex = {-0x1p-31, 0.5, -5.0};
        spot.range = 1000.0f;
        spot.cos_half_angle = 0.0f;
        spot.axis = {-1.0f, 0x1p-31f, 0.0f};
        CHECK(columns_of(spot) == std::pair(0u, 3u));
        spot.axis = {-1.0f, 0x1p-29f, 0.0f};
        CHECK(columns_of(spot) == std::pair(0u, 4u));
        // From far above: right of the middle but for a hair, unless the cone is narrower than a half sphere.
        spot.apex = {-0x1p-31, 100.0, -5.0};
        spot.axis = {1.0f, 0.0f, 0.0f};
        spot.cos_half_angle = 0x1p-31f;
        CHECK(columns_of(spot) == std::pair(3u, 7u));
        spot.cos_half_angle = 0x1p-29f;
        CHECK(columns_of(spot) == std::pair(4u, 7u));
    }

    TEST_CASE("lights that are not valid are named, and leave the lists as they were") {
        const cull::FroxelGrid grid = unit_grid();
        cull::FroxelLights lights;
        const std::vector<Sphere> one{{{0.5, 0.5, -1.5}, 0.1}};
        REQUIRE(cull::find_lights(grid, one, {}, lights).has_value());
        REQUIRE(lights.lights().size() == 1);
        const auto expect = [&](const Sphere& point, const cull::SpotLight& spot, std::uint64_t item) {
            const std::vector<Sphere> points{one[0], point};
            const std::vector<cull::SpotLight> spots{{}, spot};
            const auto result = cull::find_lights(grid, points, spots, lights);
            REQUIRE(!result.has_value());
            CHECK(error_of(result).item == item);
            CHECK(lights.lights().size() == 1);
        };
        expect({{std::nan(""), 0.0, 0.0}, 1.0}, {}, 1);
        expect({{0.0, 0.0, 0.0}, -1.0}, {}, 1);
        expect({{0.0, 2e12, 0.0}, 1.0}, {}, 1);
        expect({{0.0, 0.0, 0.0}, std::numeric_limits<double>::infinity()}, {}, 1);
        expect(one[0], {.axis = {0.0f, 0.0f, 0.0f}}, 3);
        expect(one[0], {.axis = {0.0f, std::nanf(""), 0.0f}}, 3);
        expect(one[0], {.cos_half_angle = -0.1f}, 3);
        expect(one[0], {.cos_half_angle = std::nanf("")}, 3);
        expect(one[0], {.range = -1.0f}, 3);
        expect(one[0], {.apex = {0.0, 0.0, -2e12}}, 3);
        CHECK(cull::find_lights(grid, {}, {}, lights).has_value());
        CHECK(lights.lights().empty());
        CHECK(lights.offsets().size() == grid.size() + 1);
    }

    TEST_CASE("touching counts, and one step of a float less does not touch") {
        const cull::FroxelGrid grid = unit_grid();
        cull::FroxelLights lights;
        const auto count = [&](const Sphere& point) {
            REQUIRE(cull::find_lights(grid, std::vector<Sphere>{point}, {}, lights).has_value());
            return lights.lights().size();
        };
        // In the middle of a froxel: its own, then 6 more by faces, 12 by edges, 8 by corners.
        const glm::dvec3 middle{0.5, 0.5, -4.5};
        CHECK(count({middle, 0.0}) == 1);
        CHECK(count({middle, std::nextafter(0.5, 0.0)}) == 1);
        CHECK(count({middle, 0.5}) == 7);
        // Beside a corner by (3, 4, 0) / 4 of the way, √(9 + 16) = 5.
        CHECK(count({{-4.75, -5.0, -1.5}, 1.25}) == 1);
        CHECK(count({{-4.75, -5.0, -1.5}, std::nextafter(1.25, 0.0)}) == 0);
        CHECK(count({{0.0, 0.0, -5.0}, 0.0}) == 8);

        const auto spots = [&](const cull::SpotLight& spot) {
            REQUIRE(cull::find_lights(grid, {}, std::vector<cull::SpotLight>{spot}, lights).has_value());
            return lights.lights().size();
        };
        // From the eye along the view: the cap touches the first slice at (0, 0, −1), a corner of four froxels.
        CHECK(spots({{0.0, 0.0, 0.0}, {0.0f, 0.0f, -1.0f}, 0.9f, 1.0f}) == 4);
        CHECK(spots({{0.0, 0.0, 0.0}, {0.0f, 0.0f, -1.0f}, 0.9f, std::nextafter(1.0f, 0.0f)}) == 0);
        CHECK(spots({{0.0, 0.0, 0.0}, {0.0f, 0.0f, 1.0f}, 0.9f, 100.0f}) == 0);
        // A half sphere whose flat side is the plane of the first slice.
        CHECK(spots({{0.5, 0.5, -1.0}, {0.0f, 0.0f, 1.0f}, 0.0f, 0.25f}) == 1);
        CHECK(spots({{0.5, 0.5, -1.0}, {0.0f, 0.0f, 1.0f}, 1e-3f, 0.25f}) == 1);
        CHECK(spots({{0.5, 0.5, std::nextafter(-1.0, 0.0)}, {0.0f, 0.0f, 1.0f}, 0.0f, 0.25f}) == 0);
        // A ray, of half angle 0, along an edge.
        CHECK(spots({{0.0, 0.0, 0.0}, {0.0f, 0.0f, -1.0f}, 1.0f, 100.0f}) == 32);
        // The cone's side passes exactly through the grid's last corner: (1, 1, 0) · (0, 1, 1) is half of √2 · √2.
        const glm::dvec3 apex = glm::dvec3(4.0, 4.0, -9.0) - glm::dvec3(0.0, 1.0, 1.0);
        CHECK(spots({apex, {1.0f, 1.0f, 0.0f}, 0.5f, 10.0f}) == 1);
        CHECK(froxels_of(lights, grid, 0) == std::vector<std::uint32_t>{grid.index(7, 7, 7)});
        CHECK(spots({apex, {1.0f, 1.0f, 0.0f}, std::nextafter(0.5f, 1.0f), 10.0f}) == 0);
    }

    TEST_CASE("a point of the view lies in the froxel that its picture and depth name") {
        oracle::NearMisses random(5);
        for (int trial = 0; trial < 20; ++trial) {
            const Camera camera = random.camera();
            const cull::FroxelGrid grid = *cull::FroxelGrid::build(camera, {16, 9, 24});
            const glm::dmat4 to_clip = view_to_clip(camera);
            const glm::dmat3 rotation = world_to_view_rotation(camera);
            const auto corners = *frustum_corners(*frustum_of(camera));
            for (int n = 0; n < 20; ++n) {
                glm::dvec3 at(0.0);
                double sum = 0.0;
                for (const glm::dvec3& corner : corners) {
                    const double share = random.number(0.0, 1.0);
                    at += share * corner;
                    sum += share;
                }
                at /= sum;
                const glm::dvec3 in_view = rotation * at;
                const glm::dvec4 clip = to_clip * glm::dvec4(in_view, 1.0);
                const auto column = std::uint32_t(8.0 * (clip.x / clip.w + 1.0)),
                           row = std::uint32_t(4.5 * (clip.y / clip.w + 1.0));
                const double depth = -in_view.z, near = camera.near_distance, far = camera.far_distance;
                const double slice = camera.projection == Projection::perspective
                                         ? 24.0 * std::log(depth / near) / std::log(far / near)
                                         : 24.0 * (depth - near) / (far - near);
                const Frustum cell = grid.froxel(grid.index(column, row, std::uint32_t(slice)));
                for (const Plane& plane : cell.view()) CHECK(glm::dot(plane.normal, at) + plane.offset >= -1e-9);
            }
        }
    }

    TEST_CASE("agrees with the exact oracles, froxel by froxel, on lights that nearly touch") {
        std::size_t pairs = 0, exact_tests = 0, asked = 0;
        for (std::uint64_t trial = 0; trial < 24; ++trial) {
            const double offset = trial % 3 == 2 ? 1e6 : 0.0;
            oracle::NearMisses random(trial, offset);
            const cull::FroxelGrid grid = *cull::FroxelGrid::build(
                random.camera(), {3 + random.index(18), 1 + random.index(5), 1 + random.index(6)});
            const RandomLights lights(trial, grid, 40, offset);
            cull::FroxelLights found;
            REQUIRE(cull::find_lights(grid, lights.points, lights.spots, found).has_value());
            exact_tests += found.exact_tests();
            for (std::uint32_t f = 0; f < grid.size(); ++f) {
                const Frustum cell = grid.froxel(f);
                const auto has = [&](std::size_t light) {
                    return test::ranges::binary_search(found.lights_of(f), std::uint32_t(light));
                };
                for (std::size_t i = 0; i < lights.points.size(); ++i) {
                    const bool meets = cull::classify(cell, lights.points[i]) != cull::Verdict::outside;
                    pairs += meets;
                    REQUIRE(has(i) == meets);
                    if (asked++ % 64 == 0)
                        REQUIRE((oracle::classify(cell, lights.points[i]) != cull::Verdict::outside) == meets);
                }
                for (std::size_t i = 0; i < lights.spots.size(); ++i) {
                    if (f % 8 != i % 8 && !has(lights.points.size() + i)) continue;
                    CAPTURE(trial);
                    CAPTURE(f);
                    CAPTURE(i);
                    REQUIRE(has(lights.points.size() + i) == oracle::meets(cell, lights.spots[i]));
                }
            }
        }
        CHECK(pairs > 1000);
        CHECK(exact_tests > 10);
    }

    TEST_CASE(
        "half spheres whose flat sides nearly touch agree with the exact oracle, however many froxels they reach") {
        std::size_t lit = 0, dark = 0;
        for (std::uint64_t trial = 0; trial < 24; ++trial) {
            oracle::NearMisses random(100 + trial);
            const cull::FroxelGrid grid =
                *cull::FroxelGrid::build(Camera{.far_distance = 40.0}, {16, 9, 6 + random.index(18)});
            std::vector<cull::SpotLight> spots;
            for (int n = 0; n < 12; ++n) {
                const Frustum cell = grid.froxel(random.index(std::uint32_t(grid.size())));
                cull::SpotLight spot = near_spot(random, cell);
                // Where the flat side passes a point of the cell; along an axis now and then.
                const glm::dvec3 normal = glm::normalize(glm::dvec3(spot.axis));
                spot.apex -= glm::dot(normal, spot.apex - random.surface_point(cell, *frustum_corners(cell))) * normal;
                if (n % 3 == 0) spot.axis = n % 2 ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 0.0f, -1.0f);
                spot.cos_half_angle = n % 4 == 3 ? 1e-7f : 0.0f;
                spots.push_back(spot);
            }
            cull::FroxelLights found;
            REQUIRE(cull::find_lights(grid, {}, spots, found).has_value());
            for (std::uint32_t f = std::uint32_t(trial % 3); f < grid.size(); f += 3)
                for (std::uint32_t i = 0; i < spots.size(); ++i) {
                    const bool has = test::ranges::binary_search(found.lights_of(f), i);
                    (has ? lit : dark) += 1;
                    if (!has && (f + i) % 16 != 0) continue;  // the oracle is slow
                    CAPTURE(trial);
                    CAPTURE(f);
                    CAPTURE(i);
                    REQUIRE(has == oracle::meets(grid.froxel(f), spots[i]));
                }
        }
        CHECK(lit > 1000);
        CHECK(dark > 1000);
    }

    TEST_CASE("a spot without a width that begins just beyond a froxel and leads away does not light it") {
        const cull::FroxelGrid grid = unit_grid();
        cull::FroxelLights lights;
        const auto count = [&](const glm::dvec3& apex, const glm::vec3& axis) {
            const cull::SpotLight spot{apex, axis, 1.0f, 2.25f};
            REQUIRE(cull::find_lights(grid, {}, std::vector<cull::SpotLight>{spot}, lights).has_value());
            return lights.lights().size();
        };
        // From a froxel's side across columns, rows and slices: three froxels. Without a gap a fourth ends there.
        for (int k = 0; k < 3; ++k)
            for (const double side : {1.0, -1.0})
                for (const double gap : {0.0, 0x1p-44, 0x1p-40, 0x1p-34, 0x1p-28, 0x1p-20, 0x1p-12}) {
                    glm::dvec3 apex(-0.75, 0.25, -4.5);
                    glm::vec3 axis(0.0f);
                    apex[k] = std::round(apex[k]) + side * gap;
                    axis[k] = float(side);
                    CAPTURE(k);
                    CAPTURE(side);
                    CAPTURE(gap);
                    CHECK(count(apex, axis) == (gap == 0.0 ? 4 : 3));
                }
    }

    TEST_CASE("half spheres tilted by less than a double can express reach as deep as their rims do") {
        const cull::FroxelGrid grid = unit_grid();
        oracle::NearMisses random(200);
        std::size_t deeper = 0;
        for (int trial = 0; trial < 80; ++trial) {
            // Towards the eye, so that only the rim comes beyond the slice's end, 3 from the eye.
            const double tilt = std::exp2(random.number(-27.0, -5.0)),
                         depth = 3.0 - 2.0 * tilt * random.number(0.1, 1.2);
            cull::SpotLight spot{.apex = {0.5, 0.5, -depth}, .cos_half_angle = 0.0f, .range = 2.0f};
            spot.axis = {float(random.index(2) ? tilt : -tilt), 0.0f, 1.0f};
            cull::FroxelLights found;
            REQUIRE(cull::find_lights(grid, {}, std::span(&spot, 1), found).has_value());
            for (std::uint32_t column = 2; column < 7; ++column) {
                const std::uint32_t f = grid.index(column, 4, 2);
                const bool has = !found.lights_of(f).empty();
                deeper += has;
                CAPTURE(tilt);
                CAPTURE(depth);
                REQUIRE(has == oracle::meets(grid.froxel(f), spot));
            }
        }
        CHECK(deeper > 20);
    }

    TEST_CASE(
        "any number of threads and every instruction set give the same lists, and nothing is allocated once warm") {
        const cull::FroxelGrid grid = *cull::FroxelGrid::build(Camera{.far_distance = 40.0}, {16, 9, 24});
        const RandomLights lights(9, grid, 1500, 0.0);
        const testing::CountingMemory counting;
        cull::FroxelLights one;
        REQUIRE(cull::find_lights(grid, lights.points, lights.spots, one).has_value());
        const std::size_t warm = counting.allocations();
        REQUIRE(cull::find_lights(grid, lights.points, lights.spots, one).has_value());
        CHECK(counting.allocations() == warm);
        CHECK(one.lights().size() > 1500);
        for (std::uint32_t f = 0; f < grid.size(); ++f) CHECK(test::ranges::is_sorted(one.lights_of(f)));
        const auto same = [&](const cull::FroxelLights& other) {
            return test::ranges::equal(one.offsets(), other.offsets()) &&
                   test::ranges::equal(one.lights(), other.lights());
        };
        ThreadPool three(3);
        cull::FroxelLights other;
        REQUIRE(cull::find_lights(grid, lights.points, lights.spots, other, three).has_value());
        CHECK(same(other));
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            REQUIRE(cull::find_lights(grid, lights.points, lights.spots, other).has_value());
            CHECK(same(other));
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
