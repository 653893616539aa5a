// SPDX-License-Identifier: MIT
// Inputs that use up one error bound of culling each: normals that round as far as they can, centres half a quantum
// off, centres that rounding alone puts inside.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;

namespace {

template <class Bound>
void check_verdicts(const std::vector<Bound>& bounds, const Frustum& frustum) {
    cull::BoundSet<Bound> set;
    set.assign(bounds);
    cull::VerdictBits bits;
    cull::find_visible(set, bounds, {frustum}, bits);
    for (std::size_t i = 0; i < bounds.size(); ++i) REQUIRE(bits.verdict(i) == cull::classify(frustum, bounds[i]));
}

// About a unit vector; each component is a whole number and `fraction` more, up or down, in units of 2^-14.
glm::dvec3 quantised_direction(oracle::NearMisses& random, double fraction) {
    glm::dvec3 n = random.direction();
    for (int j = 0; j < 3; ++j) n[j] = (std::round(n[j] * 0x1p14) + (random.index(2) ? fraction : -fraction)) * 0x1p-14;
    return n;
}

Frustum half_space(const glm::dvec3& normal, const glm::dvec3& through) {
    Frustum frustum;
    frustum.plane_count = 1;
    frustum.planes[0].normal = normal;
    frustum.planes[0].offset = -glm::dot(normal, through);
    return frustum;
}

// Points around a place of a plane, up to three quanta off it, in a chunk that reaches to ±size. Lists of up to 64 are
// tested without rows, longer ones by their rows first.
std::vector<Sphere> points_near(oracle::NearMisses& random, const glm::dvec3& normal, const glm::dvec3& place,
                                double size, int count) {
    std::vector<Sphere> points;
    for (int i = 0; i < 8; ++i)
        points.push_back({size * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1), 0.0});
    for (int i = 8; i < count; ++i) {
        glm::dvec3 p = place;
        for (int j = 0; j < 3; ++j) p[j] *= random.number(0.97, 1.0);
        p += (random.number(-3.0, 3.0) * size * 0x1p-14 - glm::dot(normal, p - place)) * normal;
        points.push_back({p, 0.0});
    }
    return points;
}

void check_rows(oracle::NearMisses& random, double fraction) {
    for (int trial = 0; trial < 400; ++trial) {
        const glm::dvec3 n = quantised_direction(random, fraction);
        // Where the components' roundings add up.
        glm::dvec3 place;
        const double size = std::exp(random.number(-3.0, 5.0));
        for (int j = 0; j < 3; ++j) {
            const double scaled = n[j] * 0x1p14, rounding = scaled - std::round(scaled);
            place[j] = 0.98 * (rounding > 0.0 ? size : -size);
        }
        if (trial % 2) place = -place;
        check_verdicts(points_near(random, n, place, size, trial % 4 < 2 ? 60 : 100), half_space(n, place));
    }
}

}  // namespace

TEST_SUITE("cull/rounding edges") {
    TEST_CASE("normals that round to 14 bits as badly as can be, at the ends of a chunk") {
        oracle::NearMisses random(41);
        check_rows(random, 0.49);
    }

    TEST_CASE("normals of 14 bits exactly: what is left is the rounding of the centres") {
        oracle::NearMisses random(42);
        check_rows(random, 0.0);
    }

    TEST_CASE(
        "normals as long as kernels take them, before spheres of many quanta that just touch or are just inside") {
        oracle::NearMisses random(48);
        for (int trial = 0; trial < 40; ++trial) {
            const glm::dvec3 n = random.direction();
            Frustum frustum = half_space(1.00049 * n, 100.0 * random.direction());
            std::vector<Sphere> spheres;
            for (int i = 0; i < 120; ++i) {
                // Most are small: so the rows' units are.
                const double radius = random.number(4.0, 7.5) / (i % 6 == 0 ? 1.0 : 8.0);
                const double value = (i % 2 ? radius : -radius) * (1.0 + 1e-7 * random.number(-1, 1));
                const glm::dvec3 at = random.vector(-1, 1);
                const double there = glm::dot(n, at) + frustum.planes[0].offset / 1.00049;
                spheres.push_back({at + (value - there) * n, radius});
            }
            check_verdicts(spheres, frustum);
        }
    }

    TEST_CASE("aligned boxes of a few roundings, far from the world's origin and close to the view's") {
        oracle::NearMisses random(43);
        for (int trial = 0; trial < 400; ++trial) {
            const glm::dvec3 place = 1e9 * random.direction();
            Frustum frustum = half_space(random.direction(), {});
            frustum.origin = place;
            frustum.planes[0].offset = random.number(-2e-6, 2e-6);
            std::vector<Aabb> boxes(trial % 2 ? 60 : 100);  // without rows, and by rows
            for (Aabb& box : boxes)
                for (int j = 0; j < 3; ++j) {
                    const double step = std::ldexp(1.0, std::ilogb(place[j]) - 52);
                    box.min[j] = place[j] + step * random.number(-9.0, 9.0);
                    box.max[j] = box.min[j] + step * (1 + 2 * random.index(4));
                }
            check_verdicts(boxes, frustum);
        }
    }

    TEST_CASE("segments at an edge of two planes, whose centres are inside by rounding alone") {
        oracle::NearMisses random(44);
        int outside = 0;
        for (int trial = 0; trial < 6000; ++trial) {
            const glm::dvec3 p = (random.index(2) ? 1.0 : 1e3) * random.direction();
            Frustum frustum = half_space(random.direction(), p);
            frustum.planes[frustum.plane_count++] = half_space(random.direction(), p).planes[0];
            for (std::size_t i = 0; i < 2; ++i)
                frustum.planes[i].offset += (double(random.index(7)) - 3.0) * glm::length(p) * 0x1p-54;
            const glm::dvec3 a = frustum.planes[0].normal, b = frustum.planes[1].normal;
            Obb segment;
            segment.center = p;
            const glm::dvec3 x = glm::normalize(a - b), y = glm::normalize(glm::cross(x, random.direction()));
            segment.axes = glm::mat3(glm::dmat3(x, y, glm::cross(x, y)));
            segment.half_extents = {float(random.number(0.1, 1.0)), 0.0f, 0.0f};
            if (!validate(segment)) continue;
            const cull::Verdict expected = oracle::classify(frustum, segment);
            REQUIRE(cull::classify(frustum, segment) == expected);
            outside += expected == cull::Verdict::outside;
        }
        CHECK(outside > 100);
    }

    TEST_CASE("planes that just touch a corner, with numbers just above powers of two, whose roundings are largest") {
        oracle::NearMisses random(47);
        const auto above_one = [&] { return 1.0 + random.number(0.0, 0.01); };
        for (int trial = 0; trial < 4000; ++trial) {
            Obb box{};
            box.axes = glm::mat3(1.0f);
            // A point, or so small that the roundings are those of its centre.
            if (trial % 2) box.half_extents = glm::vec3(0x1p-40f * static_cast<float>(above_one()));
            Frustum frustum;
            frustum.plane_count = 1;
            Plane& plane = frustum.planes[0];
            const double side = trial % 4 < 2 ? 1.0 : -1.0;
            double distance = 0.0, radius = 0.0;
            for (int j = 0; j < 3; ++j) {
                const double sign = random.index(2) ? 1.0 : -1.0;
                plane.normal[j] = 0.5 * side * sign * above_one();
                frustum.origin[j] = -sign * random.number(2.0, 4.0);
                box.center[j] = frustum.origin[j] + sign * above_one();
                distance += plane.normal[j] * (box.center[j] - frustum.origin[j]);
                radius += std::fabs(plane.normal[j]) * static_cast<double>(box.half_extents[j]);
            }
            for (const double corner : {-radius, radius})
                for (int step = -4; step <= 4; ++step) {
                    plane.offset = corner - distance + step * 0x1p-54 * std::fabs(distance);
                    REQUIRE(cull::classify(frustum, box) == oracle::classify(frustum, box));
                }
        }
    }

    TEST_CASE("planes a little longer than unit vectors, far beyond a tree, lose none of it") {
        oracle::NearMisses random(46);
        std::vector<Obb> boxes(2000);
        for (Obb& box : boxes) {
            for (int j = 0; j < 3; ++j) box.center[j] = (random.index(2) ? 15.8 : -15.8) + random.number(-0.1, 0.1);
            box.half_extents = glm::vec3(0.01f);
        }
        auto tree = boxtree::BoxTree::build(boxes);
        REQUIRE(tree.has_value());
        // Twice as far out they lie where 16 bits just hold them.
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].center *= 2.0;
            REQUIRE(tree->move(static_cast<cull::ItemId>(i), boxes[i]).has_value());
        }
        tree->refit();
        for (int corner = 0; corner < 8; ++corner) {
            Frustum frustum;
            frustum.plane_count = 1;
            // Integers of 32 bits have room for the sums of a unit normal along a diagonal, not for those of this one.
            for (int j = 0; j < 3; ++j)
                frustum.planes[0].normal[j] = (corner >> j & 1 ? 1.2 : -1.2) * std::sqrt(1.0 / 3);
            frustum.planes[0].offset = 400.0;
            cull::VisibleSet visible;
            cull::find_visible(*tree, {frustum}, visible);
            CHECK(visible.size() == boxes.size());
            cull::MaskedVisibleSet many;
            (void)cull::find_visible(*tree, std::vector<cull::View>(2, cull::View{frustum}), many);
            CHECK(many.ids().size() == boxes.size());
        }
    }

    TEST_CASE("a tree answers views whose planes along the axes have normals of length two") {
        oracle::NearMisses random(45);
        std::vector<Obb> boxes(2000);
        for (Obb& box : boxes) {
            box.center = 20.0 * random.direction() * random.number(0.0, 1.0);
            box.half_extents = glm::vec3(0.2f);
        }
        const auto tree = boxtree::BoxTree::build(boxes);
        REQUIRE(tree.has_value());
        for (const double length : {2.0, 1.5, 0.01}) {
            Frustum frustum;
            frustum.plane_count = 6;
            for (std::size_t i = 0; i < 6; ++i) {
                frustum.planes[i].normal[static_cast<int>(i / 2)] = i % 2 ? length : -length;
                frustum.planes[i].offset = 7.0 * length;
            }
            cull::VisibleSet visible;
            cull::find_visible(*tree, {frustum}, visible);
            std::vector<cull::ItemId> expected;
            for (std::size_t i = 0; i < boxes.size(); ++i)
                if (cull::classify(frustum, boxes[i]) != cull::Verdict::outside)
                    expected.push_back(static_cast<cull::ItemId>(i));
            CHECK(test::ranges::equal(visible.ids(), expected));
            CHECK(expected.size() > 20);
        }
    }

    TEST_CASE("a plane that cuts off a segment's end by less than rounding is not left out") {
        // Found by a search for products and sums that round to too much, nearly all of them by half a unit. The
        // second plane leaves the segment's end alone, and the first cuts it off, or just does not.
        struct Badly {
            glm::dvec3 normal, center;
        };
        const Badly rounded[] = {{{0x1.002ca9bc1d7ccp-1, 0x1.000acf6158668p-1, 0x1.667b5b6607061p-1},
                                  {0x1.0031df7ac6e14p+1, 0x1.0018ade0d8566p+1, 0x1.6db9965553c1bp+1}},
                                 {{0x1.003500d334ef1p-1, 0x1.00065c59acbd2p-1, 0x1.66b53abe002acp-1},
                                  {0x1.0034da4f3a815p+1, 0x1.003d37bfa93e6p+1, 0x1.6dffe2a26f131p+1}},
                                 {{0x1.000e326a73292p-1, 0x1.00202b473e7cp-1, 0x1.66aa7458d77ep-1},
                                  {0x1.003be9fe3afd2p+1, 0x1.00316d741fe44p+1, 0x1.6dc7b46671379p+1}}};
        int cut_off = 0, left = 0;
        for (const auto& [normal, center] : rounded)
            for (const float half : {0x1p-10f, 0x1p-4f, 0x1p-1f})
                for (int axis = 0; axis < 3; ++axis) {
                    Obb segment;
                    segment.center = center;
                    segment.half_extents = glm::vec3(0.0f);
                    segment.half_extents[axis] = half;
                    glm::dvec3 end = center, back(0.0);
                    end[axis] -= static_cast<double>(half);  // exactly
                    back[axis] = -1.0;
                    mpq_class along = 0;
                    for (int k = 0; k < 3; ++k) along += mpq_class(normal[k]) * mpq_class(end[k]);
                    for (int step = -8; step <= 8; ++step) {
                        const double offset = -along.get_d() + step * 0x1p-51;
                        Frustum frustum;
                        frustum.plane_count = 2;
                        frustum.planes[0] = {normal, offset};
                        frustum.planes[1] = {back, end[axis]};
                        const bool meets = along + mpq_class(offset) >= 0;
                        CHECK((cull::classify(frustum, segment) != cull::Verdict::outside) == meets);
                        (meets ? left : cut_off) += 1;
                    }
                }
        CHECK(cut_off > 150);
        CHECK(left > 150);
    }
}
