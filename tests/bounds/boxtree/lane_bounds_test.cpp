// SPDX-License-Identifier: MIT
// The bounds of all lanes of a node at once, against one lane at a time.
#include <doctest/doctest.h>
#include <crofton/sampling/sampling.hpp>

#include "../../../engine/bounds/boxtree/src/bounds.hpp"
#include "../../../engine/bounds/boxtree/src/turned_bounds.hpp"

using namespace crofton;

namespace {

boxtree::Node random_node(sampling::Random& random, const boxtree::Axes& axes, double offset) {
    Aabb whole;
    Aabb children[boxtree::kWidth];
    for (Aabb& child : children) {
        glm::dvec3 center;
        for (int k = 0; k < 3; ++k) center[k] = offset * (k - 0.5) + random.uniform(-50.0, 50.0);
        child.include(center);
        for (int corner = 0; corner < 2; ++corner)
            child.include(center + 5.0 * sampling::direction(random.point<2>()) * random.uniform());
        whole.include(child);
    }
    boxtree::Node node{};
    boxtree::clear(node);
    boxtree::fit_frame(node, whole, axes);
    node.count = boxtree::kWidth;
    for (unsigned lane = 0; lane < boxtree::kWidth; ++lane) {
        boxtree::clear_lane(node, lane);
        if (random.uniform() < 0.7) REQUIRE(boxtree::write_lane(node, lane, children[lane], axes));
    }
    return node;
}

}  // namespace

TEST_SUITE("boxtree/lane_bounds") {
    TEST_CASE("all lanes at once have the bits of each, empty ones included, at offsets to 1e7") {
        sampling::Random random(1);
        std::size_t empty = 0;
        for (int trial = 0; trial < 5000; ++trial) {
            const double offsets[] = {0.0, 1e3, 1e7};
            const boxtree::Axes axes =
                trial % 4 == 0 ? boxtree::Axes{} : boxtree::axes_of(glm::mat3(sampling::rotation(random.point<3>())));
            const boxtree::Node node = random_node(random, axes, offsets[trial % 3]);
            boxtree::LaneBounds together;
            boxtree::bounds_of_lanes(node, axes, together);
            for (unsigned lane = 0; lane < boxtree::kWidth; ++lane) {
                const Aabb alone = boxtree::bounds_of_lane(node, lane, axes);
                empty += alone.is_empty();
                for (unsigned k = 0; k < 3; ++k) {
                    const auto axis = static_cast<int>(k);
                    REQUIRE(together.min[k][lane] == alone.min[axis]);
                    REQUIRE(together.max[k][lane] == alone.max[axis]);
                }
            }
        }
        CHECK(empty > 10'000);
        CHECK(empty < 40'000);
    }
}
