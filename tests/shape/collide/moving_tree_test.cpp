// SPDX-License-Identifier: MIT
// The tree of boxes that all move.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/moving_tree.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>
#include <vector>

#include "oracle/random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using oracle::NearMisses;

namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

// Boxes that drift. In each step some get another's place, as where one goes and the last takes its index.
struct Drift {
    NearMisses random{81};
    double place;
    std::vector<Obb> boxes;

    Drift(std::size_t count, double where) : place(where) {
        while (boxes.size() < count) boxes.push_back(any());
    }
    Obb any() { return oracle::random_box(random, place * glm::dvec3(1.0, -0.7, 0.3), 60.0); }
    void step(std::size_t jumps) {
        for (Obb& box : boxes) box.center += 0.1 * random.direction();
        for (std::size_t n = 0; n < jumps; ++n) {
            const std::size_t i = random.index(static_cast<unsigned>(boxes.size()));
            boxes[i] = boxes.back();
            boxes.pop_back();
        }
        for (std::size_t n = 0; n < jumps; ++n) boxes.push_back(any());
    }
};

}  // namespace

TEST_SUITE("collide/moving_tree") {
    TEST_CASE("boxes that a moving box meets are visited, and the first soon, whichever drift, jump, come and go") {
        for (const double place : {0.0, 1e7})
            for (const unsigned jumps : {0u, 3u, 40u, 300u}) {
                Drift drift(1000, place);
                MovingTree tree;
                std::size_t met = 0, visited = 0, visited_to_first = 0;
                for (int step = 0; step < 60; ++step) {
                    tree.update(drift.boxes);
                    for (int query = 0; query < 5; ++query) {
                        Ray path{drift.any().center, drift.random.direction()};
                        if (query % 2 == 0) path.max_t = drift.random.number(0.0, 60.0);
                        if (query == 3) path.direction = {0.0, 1.0, 0.0};
                        const glm::dvec3 half(drift.random.number(0.0, 15.0), query == 4 ? 0.0 : 10.0, 5.0);
                        const auto entry = [&](const Obb& box) {
                            const Aabb bounds = aabb_of(box);
                            return mesh::raycast(path, obb_of({bounds.min - half + 1e-6, bounds.max + half - 1e-6}));
                        };
                        std::vector<std::uint32_t> items;
                        tree.visit_along(path, half, [&](std::uint32_t i) { return items.push_back(i), path.max_t; });
                        std::sort(items.begin(), items.end());
                        CHECK(std::adjacent_find(items.begin(), items.end()) == items.end());
                        double first = kNoEnd, found = kNoEnd, least = path.max_t;
                        for (std::uint32_t i = 0; i < drift.boxes.size(); ++i)
                            if (const auto t = entry(drift.boxes[i])) {
                                ++met;
                                first = std::min(first, *t);
                                CHECK(std::binary_search(items.begin(), items.end(), i));
                            }
                        visited += items.size();
                        tree.visit_along(path, half, [&](std::uint32_t i) {
                            ++visited_to_first;
                            if (const auto t = entry(drift.boxes[i])) found = least = std::min(least, *t);
                            return least;
                        });
                        CHECK(found == first);
                    }
                    drift.step(jumps);
                }
                CHECK(met > 1500);
                CHECK(visited < 2 * met);
                CHECK(3 * visited_to_first < 2 * visited);
            }
    }

    TEST_CASE("the nearest box is found soon within any distance") {
        for (const unsigned jumps : {3u, 40u}) {
            Drift drift(1000, 1e3);
            MovingTree tree;
            std::size_t asked = 0, queries = 0;
            for (int step = 0; step < 60; ++step) {
                tree.update(drift.boxes);
                for (const double limit : {0.0, 1.0, 1e2, 1e12, kNoEnd}) {
                    ++queries;
                    const glm::dvec3 place = drift.any().center;
                    const auto gap_to = [&](std::uint32_t i) {
                        return distance(drift.boxes[i], Capsule{place, place, 0.0}).distance;
                    };
                    double least = limit, expected = limit;
                    for (std::uint32_t i = 0; i < 1000; ++i) expected = std::min(expected, gap_to(i));
                    tree.visit_near({place, place}, limit, [&](std::uint32_t i) {
                        ++asked;
                        return least = std::min(least, gap_to(i));
                    });
                    CHECK(least == expected);
                }
                drift.step(jumps);
            }
            CHECK(asked < 40 * queries);
        }
    }

    TEST_CASE("a query without end visits all, and a negative result ends it") {
        const Drift drift(300, 0.0);
        MovingTree tree;
        tree.update(drift.boxes);
        std::size_t visits = 0;
        const auto count = [&](std::uint32_t) { return ++visits, kNoEnd; };
        tree.visit_near({glm::dvec3(0.0), glm::dvec3(0.0)}, kNoEnd, count);
        CHECK(visits == 300);
        tree.visit_near({glm::dvec3(-1e300), glm::dvec3(1e300)}, 0.0, count);
        CHECK(visits == 600);
        tree.visit_along({glm::dvec3(kNoEnd), {1.0, 0.0, 0.0}}, glm::dvec3(0.0), count);
        CHECK(visits == 900);
        const auto stop = [&](std::uint32_t) { return ++visits, -1.0; };
        tree.visit_near({glm::dvec3(0.0), glm::dvec3(0.0)}, kNoEnd, stop);
        tree.visit_along({glm::dvec3(-200.0, 0.0, 0.0), {1.0, 0.0, 0.0}}, glm::dvec3(100.0), stop);
        CHECK(visits == 902);
    }
}
