// SPDX-License-Identifier: MIT
// Of the module's own parts: which boxes come to lie side by side.
#include <doctest/doctest.h>
#include <algorithm>
#include <random>
#include <vector>

#include "../ranges.hpp"
#include "space_order.hpp"

using namespace crofton;

namespace {

// Whether all items of one stretch lie before those of the other, along some axis.
bool are_parted(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                const std::vector<Obb>& boxes) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            return boxes[a].center[axis] < boxes[b].center[axis];
        };
        if (!before(*test::ranges::min_element(second, before), *test::ranges::max_element(first, before))) return true;
    }
    return false;
}

}  // namespace

TEST_SUITE("collide/space_order") {
    TEST_CASE("the order is halved by planes, down to sixteen boxes") {
        std::mt19937_64 random(71);
        std::vector<Obb> boxes(4096);
        for (Obb& box : boxes) {
            box.axes = glm::mat3(1.0f);
            box.half_extents = glm::vec3(1.0f);
            // Whole numbers: floats part them as doubles do.
            for (int j = 0; j < 3; ++j) box.center[j] = static_cast<double>(random() % 100000);
        }
        collide::SpaceOrder order;
        order.sort(boxes);
        for (std::size_t width = 4096; width > 16; width /= 2)
            for (std::size_t begin = 0; begin < boxes.size(); begin += width)
                CHECK(are_parted(order.items().subspan(begin, width / 2),
                                 order.items().subspan(begin + width / 2, width / 2), boxes));
        for (std::uint32_t slot = 0; slot < 4096; ++slot) CHECK(order.slots()[order.items()[slot]] == slot);
    }
}
