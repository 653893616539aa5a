// SPDX-License-Identifier: MIT
// The example of docs/collide.md, compiled and run.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/collide/broadphase.hpp>
#include <crofton/convex/query.hpp>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

int collide_boxes() {
    // clang-format off
    std::vector<crofton::Obb> boxes(3);
    boxes[1].center = {0.0, 0.0, 1.9};
    for (crofton::Obb& box : boxes) box.half_extents = {1.0f, 1.0f, 1.0f};
    boxes[2].center = {9.0, 0.0, 0.0};

    crofton::collide::Broadphase broadphase;
    if (auto result = broadphase.update(boxes); !result) return report(result.error());

    // In the next frame one box has moved.
    boxes[2].center.x = 1.5;
    const std::uint32_t moved[] = {2};
    if (auto result = broadphase.update_moved(boxes, moved); !result) return report(result.error());

    const auto shape = crofton::convex::Shape::box({1.0f, 1.0f, 1.0f});
    if (!shape) return report(shape.error());
    const auto pose_of = [&](std::uint32_t box) { return crofton::RigidTransform{glm::dmat3(boxes[box].axes), boxes[box].center}; };
    for (const crofton::IdPair pair : broadphase.pairs()) {
        const auto manifold = crofton::convex::contact_manifold({*shape, pose_of(pair.first)}, {*shape, pose_of(pair.second)});
        for (int i = 0; i < manifold.count; ++i)
            std::printf("%u and %u touch %g deep\n", pair.first, pair.second, manifold.points[i].depth);
    }
    // clang-format on
    if (broadphase.pairs().size() != 3 || broadphase.began().size() != 2) return 2;
    // Boxes of half extent 1 overlap by 2 less the distance of their centres, along the axis where that is least.
    const double least[] = {0.1, 0.5, 0.1};
    for (std::size_t k = 0; k < 3; ++k) {
        const crofton::IdPair pair = broadphase.pairs()[k];
        const auto manifold =
            crofton::convex::contact_manifold({*shape, pose_of(pair.first)}, {*shape, pose_of(pair.second)});
        if (manifold.count != 4) return 3;
        for (int i = 0; i < manifold.count; ++i)
            if (std::abs(manifold.points[i].depth - least[k]) > 1e-12) return 4;
    }
    return 0;
}

}  // namespace

TEST_SUITE("collide/guide") {
    TEST_CASE("the example of the guide runs, and its boxes touch as deep as they overlap") {
        CHECK(collide_boxes() == 0);
    }
}
