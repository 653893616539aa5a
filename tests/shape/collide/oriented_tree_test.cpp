// SPDX-License-Identifier: MIT
// Rays and shapes against trees whose inner bounds lie along turned axes.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>
#include <oracle/turned_crowd.hpp>

#include "../../ranges.hpp"

using namespace crofton;
using boxtree::Orientation;

TEST_SUITE("collide/oriented trees") {
    TEST_CASE("rays meet and shapes overlap in an oriented tree what they do in a list") {
        oracle::NearMisses random(1);
        for (const double offset : {0.0, 1e4, 1e7}) {
            const oracle::Crowd crowd = oracle::turned_crowd(2500, offset, 2);
            const glm::dvec3 middle = offset * glm::dvec3(1.0, -0.7, 0.3);
            const auto tree =
                *boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = Orientation::oriented});
            const auto flat = *boxtree::BoxTree::build(crowd.boxes, crowd.layers);
            REQUIRE(tree.structure().axes().size() > 1);
            std::size_t met = 0, touched = 0;
            for (int trial = 0; trial < 200; ++trial) {
                Ray ray;
                ray.origin = middle + 50.0 * random.direction();
                const Obb& aim = crowd.boxes[random.index(2500)];
                ray.direction = trial % 3 ? aim.center - ray.origin : random.direction();
                if (trial % 5 == 0) ray.direction = glm::dvec3(aim.axes[0]);  // along the axes of the bounds
                if (trial % 5 == 0) ray.origin = aim.center - 30.0 * ray.direction;
                const auto here = collide::raycast(ray, tree), there = collide::raycast(ray, flat);
                REQUIRE(here.has_value() == there.has_value());
                met += here.has_value();
                if (here) {
                    CHECK(here->item == there->item);
                    CHECK(here->t == there->t);
                }
                Vector<boxtree::ItemId> found, expected;
                Obb shape = oracle::random_box(random, aim.center, 2.0);
                shape.half_extents *= 4.0f;
                collide::overlapping(tree, shape, found);
                for (std::size_t i = 0; i < crowd.boxes.size(); ++i)
                    if (collide::intersects(crowd.boxes[i], shape)) expected.push_back(static_cast<boxtree::ItemId>(i));
                touched += expected.size();
                REQUIRE(test::ranges::equal(found, expected));
                collide::overlapping(tree, Sphere{shape.center, 3.0}, found);
                collide::overlapping(flat, Sphere{shape.center, 3.0}, expected);
                REQUIRE(test::ranges::equal(found, expected));
            }
            CHECK(met > 100);
            CHECK(touched > 100);
        }
    }
}
