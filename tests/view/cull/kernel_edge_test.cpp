// SPDX-License-Identifier: MIT
// Clusters of boxes of which each lies within a filter's rounding of a plane: what the kernels decide in floats and
// small integers must be classify's verdict, which edge_test.cpp compares with exact arithmetic.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <limits>
#include <oracle/edges.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

#include "classified.hpp"

using namespace crofton;
using cull::CullMode;
using cull::Verdict;
using testing::Classified;
using testing::TargetInTurn;

namespace {

// A cluster: as long as `size` along each of its own axes, boxes of half extents about `half`.
struct Shape {
    glm::dvec3 size;
    double half;
};

// A box whose corner nearest to the plane or farthest from it lies `depth` inside of it, near a point of the plane.
Obb box_at(oracle::NearMisses& random, const glm::dvec3& target, const glm::dvec3& normal, double half, double depth) {
    Obb box;
    const glm::dvec3 axis = random.direction();
    const double angle = random.index(2) ? random.number(0.0, 6.2) : 0.0;
    box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis)));
    box.center = target + depth * normal;
    const double side = random.index(2) ? 1.0 : -1.0;
    for (int k = 0; k < 3; ++k) {
        box.half_extents[k] = random.index(4) ? float(half * random.number(0.1, 1.0)) : 0.0f;
        const glm::dvec3 edge = double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
        box.center += (glm::dot(edge, normal) > 0.0 ? side : -side) * edge;
    }
    return box;
}

// Boxes at one point of the frustum's surface, all about one of its planes or, at an edge, about both.
std::vector<Obb> cluster_at(oracle::NearMisses& random, const Frustum& frustum, const Shape& shape, std::size_t count) {
    const auto corners = *frustum_corners(frustum);
    const glm::dvec3 target = random.surface_point(frustum, corners);
    std::vector<std::pair<double, unsigned>> nearest;
    for (unsigned i = 0; i < 6; ++i) {
        const Plane& plane = frustum.planes[i];
        nearest.emplace_back(std::fabs(glm::dot(plane.normal, target - frustum.origin) + plane.offset), i);
    }
    test::ranges::sort(nearest);
    const double largest = std::max({shape.size.x, shape.size.y, shape.size.z});
    // What small integers are rounded to, or floats.
    const double quantum = std::ldexp(std::max(largest, shape.half), random.index(2) ? -14 : -23);
    std::vector<Obb> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const unsigned p = nearest[random.index(8) ? 0 : 1].second;
        const Plane& plane = frustum.planes[p];
        glm::dvec3 at = target;
        for (int j = 0; j < 3; ++j) at[j] += shape.size[j] * random.number(-1, 1);
        // Back into the plane, as far as doubles go.
        for (int pass = 0; pass < 2; ++pass)
            at -= (glm::dot(plane.normal, at - frustum.origin) + plane.offset) * plane.normal;
        double depth = quantum * random.number(-1.5, 1.5);
        if (random.index(3) == 0) depth *= std::exp(random.number(-12.0, 3.0));
        boxes.push_back(box_at(random, at, plane.normal, shape.half, depth));
    }
    return boxes;
}

// Boxes across an edge of the frustum, each moved outward to where it begins to be outside, within a part of a quantum.
// No plane alone rejects them.
std::vector<Obb> cluster_across_edge(oracle::NearMisses& random, const Frustum& frustum, double size,
                                     std::size_t count) {
    const auto corners = *frustum_corners(frustum);
    const unsigned corner = random.index(8), other = corner ^ (1u << random.index(3));
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& c : corners) middle += 0.125 * c;
    const glm::dvec3 target = glm::mix(corners[corner], corners[other], random.number(0.2, 0.8));
    const glm::dvec3 along = glm::normalize(corners[other] - corners[corner]);
    const glm::dvec3 straight = target - middle - glm::dot(target - middle, along) * along;
    const glm::dvec3 outward = glm::normalize(straight);
    std::vector<Obb> boxes;
    for (int trial = 0; trial < 1000 && boxes.size() < count; ++trial) {
        const glm::dvec3 place = frustum.origin + target + 3.0 * size * random.number(-1, 1) * along;
        Obb box = box_at(random, place, random.direction(), size, 0.0);
        const glm::dvec3 from = box.center;
        const auto at = [&](double s) {
            box.center = from + s * outward;
            return box;
        };
        const auto meets = [&](double s) { return cull::classify(frustum, at(s)) != Verdict::outside; };
        if (!meets(-0.5 * size) || meets(4.0 * size)) continue;
        const double edge = oracle::edge_between(-0.5 * size, 4.0 * size, meets).first, share = random.number(-1, 1);
        const Obb there = at(edge + share * share * share * std::ldexp(size, -14));
        if (cull::classify(frustum, there, CullMode::conservative) == Verdict::straddling) boxes.push_back(there);
    }
    return boxes;
}

template <class Bound>
void check_set(const std::vector<Bound>& bounds, const cull::View& view, CullMode mode) {
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits bits;
    cull::find_visible(set, bounds, view, bits, mode);
    for (std::size_t i = 0; i < bounds.size(); ++i)
        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, bounds[i], mode));
}

void check_lists(const std::vector<Obb>& boxes, const cull::View& view) {
    std::vector<Aabb> bounds;
    for (const Obb& box : boxes) bounds.push_back(aabb_of(box));
    std::vector<Sphere> spheres;
    for (const Obb& box : boxes) spheres.push_back({box.center, double{box.half_extents.x}});
    cull::VisibleSet visible;
    for (const CullMode mode : {CullMode::exact, CullMode::conservative}) {
        cull::find_visible(boxes, {}, view, visible, {mode});
        REQUIRE(Classified(boxes, {}, view, mode).is_answer(visible));
        check_set(boxes, view, mode);
        check_set(bounds, view, mode);
        check_set(spheres, view, mode);
    }
}

// Returns how many boxes went through the second stage.
std::uint64_t check_tree(const std::vector<Obb>& boxes, const cull::View& view) {
    std::uint64_t exact_tests = 0;
    const auto tree = boxtree::BoxTree::build(boxes);
    REQUIRE(tree.has_value());
    const std::vector<cull::View> views(2, view);
    cull::VisibleSet visible;
    cull::MaskedVisibleSet many;
    for (const CullMode mode : {CullMode::exact, CullMode::conservative}) {
        const Classified expected(boxes, {}, view, mode);
        cull::find_visible(*tree, view, visible, {mode});
        REQUIRE(expected.is_answer(visible));
        exact_tests += visible.statistics().exact_tests;
        (void)cull::find_visible(*tree, views, many, mode);
        REQUIRE(expected.are_ids(many.ids()));
    }
    return exact_tests;
}

std::uint64_t check_all(const std::vector<Obb>& boxes, const cull::View& view) {
    check_lists(boxes, view);
    return check_tree(boxes, view);
}

}  // namespace

TEST_SUITE("cull/kernel edges") {
    TEST_CASE("clusters within rounding of a frustum's planes get classify's verdicts from every structure") {
        // The camera near the world's origin, or far from it.
        oracle::NearMisses near(23), away(26, 1e8);
        std::uint64_t exact_tests = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const TargetInTurn target(trial / 7);
            oracle::NearMisses& random = trial % 4 == 3 ? away : near;
            Camera camera = random.camera();
            // Far off the surface lies far from the view's origin: then the planes' own rounding counts.
            const double distance = trial % 3 == 0 ? 1e9 : trial % 3 == 1 ? 1e4 : 1.0;
            camera.far_distance = camera.near_distance + distance * random.number(1.0, 30.0);
            if (camera.projection == Projection::orthographic) camera.height *= distance;
            const double size = std::exp(random.number(distance > 1e6 || trial % 4 == 3 ? -14.0 : -7.0, 3.0));
            Shape shape{glm::dvec3(size), size * std::exp(random.number(-12.0, 1.0))};
            // Lines and sheets: the block's L1 radius, and with it the share of the normals' rounding, is small.
            for (int j = 0; j < 3; ++j)
                if (random.index(2)) shape.size[j] *= 0.01;
            const std::size_t counts[] = {1, 2, 16, 16, 40, 300};
            const std::size_t count = counts[random.index(trial % 10 ? 5 : 6)];
            const Frustum frustum = *frustum_of(camera);
            exact_tests += check_all(cluster_at(random, frustum, shape, count), {frustum});
        }
        // Half of all boxes lie within what small integers can tell.
        if (cull::kCountStatistics) CHECK(exact_tests > 10000);
    }

    TEST_CASE("boxes that two planes part from the frustum, or nearly, get classify's verdicts from every structure") {
        oracle::NearMisses random(28);
        std::size_t count = 0;
        for (int trial = 0; trial < 120; ++trial) {
            const TargetInTurn target(trial / 7);
            Camera camera = random.camera();
            camera.far_distance = camera.near_distance + random.number(1.0, 30.0);
            const Frustum frustum = *frustum_of(camera);
            const auto corners = *frustum_corners(frustum);
            const double size = glm::length(corners[0] - corners[7]) * std::exp(random.number(-7.0, -3.0));
            const auto boxes = cluster_across_edge(random, frustum, size, 16);
            (void)check_all(boxes, {frustum});
            count += boxes.size();
        }
        CHECK(count > 1200);
    }

    TEST_CASE("planes whose normals are not unit vectors get classify's verdicts from every structure") {
        oracle::NearMisses random(24);
        for (int trial = 0; trial < 600; ++trial) {
            Camera camera = random.camera();
            if (trial % 2) camera.far_distance = 1e4;
            const Frustum frustum = *frustum_of(camera);
            const double size = std::exp(random.number(-7.0, 5.0));
            const Shape shape{glm::dvec3(size), size * std::exp(random.number(-12.0, 1.0))};
            const auto boxes = cluster_at(random, frustum, shape, trial % 10 ? 16 : 300);
            // The same volume, to rounding; its planes measured otherwise.
            Frustum scaled = frustum;
            for (Plane& plane : scaled.planes) {
                const double factor = trial % 3 == 0 ? 1.9 : trial % 3 == 1 ? 1.2 : random.number(0.1, 1.99);
                plane.normal *= factor;
                plane.offset *= factor;
                for (int k = 0; k < 3; ++k) plane.normal[k] = std::clamp(plane.normal[k], -2.0, 2.0);
            }
            (void)check_all(boxes, {scaled});
        }
    }

    TEST_CASE("few boxes all about a frustum, and one that is none, get classify's verdicts") {
        oracle::NearMisses random(27);
        for (int trial = 0; trial < 2000; ++trial) {
            const TargetInTurn target(trial);
            Camera camera = random.camera();
            camera.far_distance = camera.near_distance + random.number(1.0, 30.0);
            const Frustum frustum = *frustum_of(camera);
            const auto corners = *frustum_corners(frustum);
            const double size = glm::length(corners[0] - corners[7]);
            const std::size_t counts[] = {1, 7, 20, 63, 64, 65, 130};
            std::vector<Obb> boxes(counts[random.index(7)]);
            for (Obb& box : boxes) {
                // Most near a corner or an edge, where several planes cut them.
                const glm::dvec3 at = glm::mix(corners[random.index(8)], corners[random.index(8)], random.number(0, 1));
                box = box_at(random, at, random.direction(), size * std::exp(random.number(-6.0, -0.5)), 0.0);
                box.center += 0.02 * size * random.number(0, 1) * random.direction();
            }
            check_lists(boxes, {frustum});
            boxes[random.index(static_cast<unsigned>(boxes.size()))].center.y =
                std::numeric_limits<double>::quiet_NaN();
            check_set(boxes, {frustum}, CullMode::exact);
        }
    }

    TEST_CASE("boxes that only lists take, of axes that are far from unit vectors, get classify's verdicts") {
        oracle::NearMisses random(25);
        for (int trial = 0; trial < 1500; ++trial) {
            const TargetInTurn target(trial);
            const Frustum frustum = *frustum_of(random.camera());
            const double size = std::exp(random.number(-5.0, 3.0));
            // Many boxes are tested by spheres first, few are not.
            auto boxes = cluster_at(random, frustum, {glm::dvec3(size), size}, trial % 10 ? 16 : 260);
            for (Obb& box : boxes) {
                const Plane& plane = frustum.planes[random.index(6)];
                const glm::dvec3 n = plane.normal;
                // Needles for the most part, one end of which is brought to a plane again.
                const int k = static_cast<int>(random.index(3));
                box.axes[k] *= float(random.number(0.3, 1.9)) / std::max(1.0f, glm::length(box.axes[k]));
                // Sheared ones, of axes that are nearly parallel.
                const bool sheared = random.index(3) == 0;
                if (sheared) box.axes[(k + 1) % 3] = 0.9f * box.axes[k] + 0.2f * box.axes[(k + 1) % 3];
                if (!sheared && random.index(3)) box.half_extents[(k + 1) % 3] = box.half_extents[(k + 2) % 3] = 0.0f;
                double projected_radius = 0.0;
                for (int j = 0; j < 3; ++j)
                    projected_radius += double{box.half_extents[j]} * std::fabs(glm::dot(n, glm::dvec3(box.axes[j])));
                const double value = glm::dot(n, box.center - frustum.origin) + plane.offset;
                const double share = random.number(-1.0, 1.0);
                box.center += ((random.index(2) ? projected_radius : -projected_radius) +
                               share * share * share * 0.01 * projected_radius - value) *
                              n;
            }
            check_lists(boxes, {frustum});
        }
    }
}
