// SPDX-License-Identifier: MIT
// The examples of docs/cull.md and docs/lights.md, compiled and run.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <cstdio>
#include <limits>
#include <vector>

#include "../../ranges.hpp"

namespace {

struct Drawn {
    std::vector<std::uint32_t> houses, left, right;
    std::size_t sparks = 0;
};

// A row of houses and one of sparks along x, a metre apart; the camera looks along −z at its middle.
constexpr std::uint32_t kCount = 200;
double place(std::uint32_t i) {
    return static_cast<double>(i) - 99.25;
}

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

int draw_row(std::vector<crofton::Obb> house_boxes, const crofton::Camera& camera, Drawn& drawn) {
    std::vector<crofton::Sphere> spark_bounds(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) spark_bounds[i] = {{place(i), 0.0, -20.0}, 0.1};
    crofton::Camera beside = camera;
    beside.position.x += 10.0;
    const crofton::cull::View right_eye{.frustum = crofton::frustum_of(beside).value()};
    crofton::cull::VisibleSet visible;
    crofton::cull::VerdictBits visible_sparks;
    crofton::cull::MaskedVisibleSet seen_by;
    const auto draw_house = [&](std::uint32_t id) { drawn.houses.push_back(id); };
    const auto draw_stereo = [&](std::uint32_t id, std::uint32_t mask) {
        if (mask & 1) drawn.left.push_back(id);
        if (mask & 2) drawn.right.push_back(id);
    };
    // clang-format off
    using namespace crofton;

    // Static boxes in a tree, boxes that move every frame in a list.
    Result<boxtree::BoxTree> houses = boxtree::BoxTree::build(house_boxes);
    if (!houses) return report(houses.error());  // which box is bad, and why
    cull::SphereSet sparks;
    sparks.assign(spark_bounds);

    // Each frame: one frustum, two queries.
    const Result<Frustum> frustum = frustum_of(camera);
    if (!frustum) return report(frustum.error());
    const cull::View view{.frustum = *frustum};
    cull::find_visible(*houses, view, visible);                      // visible.ids(), visible.verdicts()
    cull::find_visible(sparks, spark_bounds, view, visible_sparks);  // a bit per spark
    for (const boxtree::ItemId id : visible.ids()) draw_house(id);

    // Two eyes in one pass: bit v of a mask is set if views[v] sees the item.
    const cull::View eyes[] = {view, right_eye};
    cull::find_visible(*houses, eyes, seen_by).value();
    for (std::size_t i = 0; i < seen_by.size(); ++i) draw_stereo(seen_by.ids()[i], seen_by.view_mask(i));
    // clang-format on
    std::sort(drawn.left.begin(), drawn.left.end());
    std::sort(drawn.right.begin(), drawn.right.end());
    for (const std::uint64_t word : visible_sparks.visible)
        drawn.sparks += static_cast<std::size_t>(std::popcount(word));
    return 0;
}

std::vector<crofton::Obb> row_of_houses() {
    std::vector<crofton::Obb> boxes(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i)
        boxes[i] = {.center = {place(i), 0.0, -20.0}, .half_extents = glm::vec3(0.25f)};
    return boxes;
}

// The examples of docs/lights.md.
struct LitRow {
    std::size_t pairs = 0;
    std::vector<std::uint32_t> shadows, drawn;
};

int light_row(const std::vector<crofton::Obb>& house_boxes, const crofton::Camera& camera,
              const std::vector<crofton::Sphere>& lamps, const glm::dvec3& toward_sun, LitRow& row) {
    using namespace crofton;
    const std::vector<cull::SpotLight> spots;
    cull::FroxelLights lit;
    cull::VisibleSet visible, candidates;
    cull::CasterFilter receivers;
    Vector<std::uint64_t> drawn;
    const Result<boxtree::BoxTree> houses = boxtree::BoxTree::build(house_boxes);
    if (!houses) return report(houses.error());
    const Result<Frustum> frustum = frustum_of(camera);
    if (!frustum) return report(frustum.error());
    const cull::View view{.frustum = *frustum};
    cull::find_visible(*houses, view, visible);
    std::vector<Obb> seen_boxes;
    for (const boxtree::ItemId id : visible.ids()) seen_boxes.push_back(house_boxes[id]);
    const auto upload = [&](std::span<const std::uint32_t> offsets, std::span<const std::uint32_t> lights) {
        row.pairs = offsets.back() == lights.size() ? lights.size() : 0;
    };
    const auto draw_shadow = [&](std::uint32_t id) { row.shadows.push_back(id); };
    // clang-format off
    // Once per camera: a grid of 16 × 9 × 24, slices in equal ratios from near to far.
    const Result<cull::FroxelGrid> grid = cull::FroxelGrid::build(camera, {16, 9, 24});
    if (!grid) return report(grid.error());

    // Each frame: spheres and cones. A spot's number follows those of the points.
    if (auto found = cull::find_lights(*grid, lamps, spots, lit); !found) return report(found.error());
    upload(lit.offsets(), lit.lights());  // froxel f: lights()[offsets()[f]] to before lights()[offsets()[f + 1]]

    // Find the objects that may cast a shadow onto something visible.
    const Result<Frustum> volume = cull::shadow_volume(view.frustum, toward_sun);
    if (!volume) return report(volume.error());
    cull::find_visible(*houses, {.frustum = *volume}, candidates);
    if (auto set = receivers.set_sun(view.frustum, seen_boxes, toward_sun); !set) return report(set.error());
    for (const boxtree::ItemId id : candidates.ids())
        if (receivers.wants(house_boxes[id])) draw_shadow(id);

    // Nothing below 2 pixels, nothing of layer 3 beyond 50 metres; drawn objects stay a tenth longer.
    Result<cull::DrawLimits> limits = cull::limits_of(camera, 1080.0, 2.0);
    if (!limits) return report(limits.error());
    std::vector<float> distances(32, std::numeric_limits<float>::infinity());
    distances[3] = 50.0f;
    limits->layer_distances = distances;
    limits->drawn_before = drawn;
    limits->hysteresis = 1.1;
    cull::find_visible(*houses, view, visible, {.limits = &*limits});
    cull::to_bits(visible.ids(), house_boxes.size(), drawn);  // for the next frame
    // clang-format on
    row.drawn.assign(visible.ids().begin(), visible.ids().end());
    return 0;
}

}  // namespace

TEST_SUITE("cull/guide") {
    TEST_CASE("the examples of lights, shadows and limits, on a row of houses") {
        crofton::Camera camera;
        camera.fov_y = 1.5707963267948966;
        camera.aspect = 1.0;
        std::vector<crofton::Obb> boxes = row_of_houses();
        // Above the row, one house whose shadow falls on it from along +y, and one whose shadow falls behind it.
        boxes.push_back({.center = {0.0, 40.0, -20.0}, .half_extents = glm::vec3(0.25f)});
        boxes.push_back({.center = {0.0, 40.0, -30.0}, .half_extents = glm::vec3(0.25f)});
        LitRow row;
        REQUIRE(light_row(boxes, camera, {{{0.01, 0.01, -20.0}, 1e-3}}, {0.0, 1.0, 0.0}, row) == 0);
        CHECK(row.pairs == 1);
        CHECK(crofton::test::ranges::count(row.shadows, 200u) == 1);
        CHECK(crofton::test::ranges::count(row.shadows, 201u) == 0);
        CHECK(row.drawn.size() > 30);                                         // 0.43 · 540 / 20 pixels and more
        for (crofton::Obb& box : boxes) box.half_extents = glm::vec3(0.01f);  // 0.03 m at 20 m: 0.9 of a pixel
        REQUIRE(light_row(boxes, camera, {}, {0.0, 1.0, 0.0}, row) == 0);
        CHECK(row.drawn.empty());
    }

    TEST_CASE("the example of the guide draws what a square view of 90 degrees sees of a row") {
        // At distance 20 the view is 40 wide; a house's far face, at 20.25, and its half width make it 20.5 to each
        // side: |x| ≤ 20.5 meets. A spark is seen to |x| ≤ 20 + √2/10.
        crofton::Camera camera;
        camera.fov_y = 1.5707963267948966;
        camera.aspect = 1.0;
        Drawn drawn;
        REQUIRE(draw_row(row_of_houses(), camera, drawn) == 0);
        std::vector<std::uint32_t> expected, expected_right;
        std::size_t sparks = 0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            if (std::abs(place(i)) < 20.5) expected.push_back(i);
            if (std::abs(place(i) - 10.0) < 20.5) expected_right.push_back(i);
            if (std::abs(place(i)) < 20.0 + std::sqrt(0.02)) ++sparks;
        }
        CHECK(drawn.houses == expected);
        CHECK(drawn.left == expected);
        CHECK(drawn.right == expected_right);
        CHECK(drawn.sparks == sparks);
        CHECK(expected.size() > 30);
    }

    TEST_CASE("the example of the guide reports a bad box") {
        std::vector<crofton::Obb> boxes = row_of_houses();
        boxes[7].center.x = std::numeric_limits<double>::quiet_NaN();
        Drawn drawn;
        CHECK(draw_row(boxes, crofton::Camera{}, drawn) == 1);
    }
}
