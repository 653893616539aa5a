// SPDX-License-Identifier: MIT
// Which boxes come to lie side by side in the broadphase's order.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "../../ranges.hpp"
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
    }

    TEST_CASE("each stretch of 4096 boxes in a lattice is a block of a Morton curve: as few places as can be") {
        struct Lattice {
            std::array<unsigned, 3> bits;  // log2 of how many places along each axis
            std::array<unsigned, 3> block;
        };
        std::mt19937_64 random(72);
        for (const Lattice& lattice : {Lattice{{4, 4, 4}, {4, 8, 8}},
                                       {{3, 3, 3}, {2, 4, 4}},
                                       {{2, 2, 2}, {1, 2, 2}},
                                       {{4, 0, 0}, {1, 1, 1}},
                                       {{0, 4, 0}, {1, 1, 1}},
                                       {{0, 0, 4}, {1, 1, 1}}}) {
            std::vector<std::array<unsigned, 3>> places(65536);
            for (unsigned n = 0; n < 65536; ++n)
                for (unsigned axis = 0, rest = n; axis < 3; rest >>= lattice.bits[axis++])
                    places[n][axis] = rest & ((1u << lattice.bits[axis]) - 1);
            for (std::size_t n = 65536; n > 1; --n) std::swap(places[n - 1], places[random() % n]);
            std::vector<Obb> boxes(65536);
            for (std::size_t n = 0; n < 65536; ++n) {
                boxes[n].half_extents = glm::vec3(0.1f);
                for (int axis = 0; axis < 3; ++axis) boxes[n].center[axis] = places[n][static_cast<unsigned>(axis)];
            }
            collide::SpaceOrder order;
            order.sort(boxes);
            for (std::size_t begin = 0; begin < 65536; begin += 4096) {
                std::array<unsigned, 3> widths;
                for (unsigned axis = 0; axis < 3; ++axis) {
                    unsigned least = 16, most = 0;
                    for (const std::uint32_t item : order.items().subspan(begin, 4096)) {
                        least = std::min(least, places[item][axis]);
                        most = std::max(most, places[item][axis]);
                    }
                    widths[axis] = most - least + 1;
                }
                test::ranges::sort(widths);
                CHECK(widths == lattice.block);
            }
        }
    }
}
