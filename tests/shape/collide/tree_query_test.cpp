// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/moved_tree.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "counting_memory.hpp"
#include "oracle/random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using oracle::NearMisses;

namespace {

struct {
    std::size_t count;
    double offset;
} const kCrowds[] = {{2000, 0.0}, {2000, 1e5}, {2000, 1e7}, {70'000, 0.0}};  // the last makes more levels

oracle::Crowd crowd_of(std::size_t count, double offset, std::uint64_t seed) {
    oracle::Crowd crowd = oracle::random_crowd(count, offset, seed);
    for (Obb& box : crowd.boxes) box.half_extents *= 8.0f;
    return crowd;
}

boxtree::BoxTree tree_of(const oracle::Crowd& crowd) {
    return boxtree::BoxTree::build(crowd.boxes, crowd.layers).value();
}

// Every box asked, one after the other.
template <class Meets>
std::vector<boxtree::ItemId> by_brute_force(const oracle::Crowd& crowd, std::uint32_t layers, Meets meets) {
    std::vector<boxtree::ItemId> items;
    for (std::size_t i = 0; i < crowd.boxes.size(); ++i)
        if ((crowd.layers[i] & layers) != 0 && meets(crowd.boxes[i])) items.push_back(static_cast<boxtree::ItemId>(i));
    return items;
}

std::vector<boxtree::ItemId> list(const Vector<boxtree::ItemId>& items) {
    return {items.begin(), items.end()};
}

std::vector<boxtree::ItemId> all_along(const Ray& ray, const boxtree::BoxTree& tree, std::uint32_t layers) {
    std::vector<boxtree::ItemId> items;
    visit_along(
        ray, tree, [&](boxtree::ItemId item, double) { return items.push_back(item), ray.max_t; }, layers);
    std::sort(items.begin(), items.end());
    return items;
}

Ray random_ray(NearMisses& random, const glm::dvec3& middle, double spread) {
    Ray ray;
    ray.origin = middle + random.number(0.0, spread) * random.direction();
    ray.direction = std::exp(random.number(-8.0, 8.0)) * random.direction();
    if (random.index(4) == 0) ray.direction[static_cast<int>(random.index(3))] = 0.0;
    if (random.index(4) == 0) ray.direction = {0.0, 0.0, random.index(2) ? 1.0 : -1.0};
    if (random.index(2) == 0) ray.max_t = random.number(0.0, spread) / glm::length(ray.direction);
    return ray;
}

}  // namespace

TEST_SUITE("collide/tree_query") {
    TEST_CASE("shapes and rays that are none meet nothing, and a tree without items answers") {
        const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
        const oracle::Crowd crowd = crowd_of(300, 0.0, 1);
        const boxtree::BoxTree tree = tree_of(crowd);
        Vector<boxtree::ItemId> items(3);
        Obb bad = crowd.boxes[0];
        bad.center.y = nan;
        overlapping(tree, bad, items);
        CHECK(items.empty());
        for (const double number : {nan, infinity, -infinity}) {
            overlapping(tree, Sphere{{number, 0.0, 0.0}, 1.0}, items);
            CHECK(items.empty());
            overlapping(tree, Sphere{{0.0, 0.0, 0.0}, number}, items);
            CHECK(items.empty());
            overlapping(tree, Capsule{{0.0, 0.0, 0.0}, {0.0, number, 0.0}, 1.0}, items);
            CHECK(items.empty());
            CHECK_FALSE(raycast(Ray{{number, 0.0, 0.0}}, tree).has_value());
        }
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, tree).has_value());
        CHECK_FALSE(raycast(Ray{{0.0, 0.0, -90.0}, {0.0, 0.0, 1.0}, -1.0}, tree).has_value());
        const auto empty = boxtree::BoxTree::build({});
        CHECK_FALSE(raycast(Ray{}, *empty).has_value());
        overlapping(*empty, Sphere{{}, 1e9}, items);
        CHECK(items.empty());
    }

    TEST_CASE("boxes, spheres and capsules meet what each box alone says, at any offset") {
        for (const auto& [count, offset] : kCrowds) {
            const oracle::Crowd crowd = crowd_of(count, offset, 2);
            const boxtree::BoxTree tree = tree_of(crowd);
            const glm::dvec3 middle = offset * glm::dvec3(1.0, -0.7, 0.3);
            NearMisses random(3);
            Vector<boxtree::ItemId> items;
            std::size_t found = 0;
            for (int trial = 0; trial < (count > 2000 ? 20 : 200); ++trial) {
                const std::uint32_t layers = random.index(3) ? ~0u : 1u << random.index(5);
                Obb box = oracle::random_box(random, middle, 60.0);
                box.half_extents *= 20.0f;
                overlapping(tree, box, items, layers);
                CHECK(list(items) == by_brute_force(crowd, layers, [&](const Obb& b) { return intersects(b, box); }));
                found += items.size();
                const Sphere sphere{box.center, random.number(0.0, 30.0)};
                overlapping(tree, sphere, items, layers);
                CHECK(list(items) ==
                      by_brute_force(crowd, layers, [&](const Obb& b) { return intersects(b, sphere); }));
                const Capsule capsule{box.center, box.center + 20.0 * random.direction(), random.number(0.0, 5.0)};
                overlapping(tree, capsule, items, layers);
                CHECK(list(items) ==
                      by_brute_force(crowd, layers, [&](const Obb& b) { return intersects(b, capsule); }));
                found += items.size();
            }
            CHECK(found > 1000);
        }
    }

    TEST_CASE("boxes that only touch are found") {
        oracle::Crowd crowd;
        for (int i = 0; i < 500; ++i)
            crowd.boxes.push_back({{2.0 * (i % 25), 2.0 * (i / 25), 0.0}, glm::mat3(1.0f), glm::vec3(1.0f)});
        crowd.layers.assign(500, 1u);
        const boxtree::BoxTree tree = tree_of(crowd);
        Vector<boxtree::ItemId> items;
        for (const int i : {26 * 3, 26 * 5, 26 * 11}) {
            overlapping(tree, crowd.boxes[static_cast<std::size_t>(i)], items);
            CHECK(items.size() == 9);
        }
        // Along a plane in which boxes of two rows touch each other.
        CHECK(all_along(Ray{{-5.0, 1.0, 0.0}, {1.0, 0.0, 0.0}}, tree, 1u).size() == 50);
        CHECK(all_along(Ray{{-5.0, 1.0, 1.0}, {1.0, 0.0, 0.0}}, tree, 1u).size() == 50);
        CHECK(all_along(Ray{{-5.0, 1.0, 1.0000001}, {1.0, 0.0, 0.0}}, tree, 1u).empty());
    }

    TEST_CASE("rays visit exactly the boxes that each alone is hit, and end at the nearest") {
        for (const auto& [count, offset] : kCrowds) {
            const oracle::Crowd crowd = crowd_of(count, offset, 4);
            const boxtree::BoxTree tree = tree_of(crowd);
            NearMisses random(5);
            std::size_t found = 0;
            for (int trial = 0; trial < (count > 2000 ? 30 : 300); ++trial) {
                const std::uint32_t layers = random.index(3) ? ~0u : 1u << random.index(5);
                const Ray ray = random_ray(random, offset * glm::dvec3(1.0, -0.7, 0.3), 90.0);
                const auto expected =
                    by_brute_force(crowd, layers, [&](const Obb& b) { return mesh::raycast(ray, b).has_value(); });
                CHECK(all_along(ray, tree, layers) == expected);
                const auto nearest = raycast(ray, tree, layers);
                REQUIRE(nearest.has_value() == !expected.empty());
                found += expected.size();
                if (!nearest) continue;
                BoxHit best{std::numeric_limits<double>::infinity(), 0};
                for (const boxtree::ItemId item : expected)
                    if (const double t = *mesh::raycast(ray, crowd.boxes[item]); t < best.t) best = {t, item};
                CHECK(nearest->t == best.t);
                CHECK(nearest->item == best.item);
            }
            CHECK(found > 1000);
        }
    }

    TEST_CASE("a visitor ends the ray where it likes") {
        const oracle::Crowd crowd = crowd_of(2000, 0.0, 6);
        const boxtree::BoxTree tree = tree_of(crowd);
        int visits = 0;
        visit_along(Ray{{-50.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, tree,
                    [&](boxtree::ItemId, double) { return ++visits, -1.0; });
        CHECK(visits == 1);
    }

    TEST_CASE("a ray allocates nothing, nor does a shape once the list has grown") {
        const oracle::Crowd crowd = crowd_of(2000, 0.0, 6);
        const boxtree::BoxTree tree = tree_of(crowd);
        Vector<boxtree::ItemId> items;
        overlapping(tree, Sphere{{}, 1e3}, items);
        const testing::CountingMemory memory;
        overlapping(tree, Sphere{{}, 1e3}, items);
        CHECK(items.size() == 2000);
        CHECK(raycast(Ray{{-50.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, tree).has_value());
        CHECK(memory.allocations() == 0);
    }

    TEST_CASE("after moves, inserts and removals and a refit the answers are those of the boxes now") {
        oracle::Crowd crowd = crowd_of(1000, 0.0, 7);
        boxtree::BoxTree tree = tree_of(crowd);
        NearMisses random(8);
        for (int i = 0; i < 300; ++i) {
            const auto item = random.index(1000);
            crowd.boxes[item] = oracle::random_box(random, glm::dvec3(0.0), 40.0);
            REQUIRE(tree.move(static_cast<boxtree::ItemId>(item), crowd.boxes[item]).has_value());
        }
        for (int i = 0; i < 100; ++i) {
            crowd.boxes.push_back(oracle::random_box(random, glm::dvec3(0.0), 40.0));
            crowd.layers.push_back(1u);
            REQUIRE(tree.insert(crowd.boxes.back(), 1u).has_value());
        }
        for (boxtree::ItemId item = 0; item < 1100; item += 7) {
            REQUIRE(tree.remove(item).has_value());
            crowd.layers[item] = 0;
        }
        tree.refit();
        for (int trial = 0; trial < 200; ++trial) {
            const Ray ray = random_ray(random, glm::dvec3(0.0), 90.0);
            CHECK(all_along(ray, tree, ~0u) ==
                  by_brute_force(crowd, ~0u, [&](const Obb& b) { return mesh::raycast(ray, b).has_value(); }));
        }
    }

    TEST_CASE("visit_near visits near items for every visitor, and a negative result ends the visit") {
        NearMisses random(7);
        const oracle::Crowd crowd = crowd_of(2000, 1e4, 7);
        const boxtree::BoxTree tree = tree_of(crowd);
        std::size_t nearest_found = 0;
        for (int query = 0; query < 300; ++query) {
            const Aabb bounds = aabb_of(oracle::random_box(random, crowd.boxes[random.index(2000)].center, 30.0));
            const double distance = query % 3 ? random.number(0.0, 20.0) : 0.0;
            // Axis by axis, as far as the bounds of the box and the query's are apart.
            const auto gap_to = [&](const Obb& box) {
                const Aabb other = aabb_of(box);
                const glm::dvec3 gap = glm::max(glm::max(other.min - bounds.max, bounds.min - other.max), 0.0);
                return glm::length(gap);
            };
            const auto near = by_brute_force(crowd, 6, [&](const Obb& box) { return gap_to(box) <= distance; });
            std::vector<boxtree::ItemId> visited;
            visit_near(
                bounds, distance, tree, [&](boxtree::ItemId item) { return visited.push_back(item), distance; }, 6);
            std::sort(visited.begin(), visited.end());
            CHECK(std::includes(visited.begin(), visited.end(), near.begin(), near.end()));
            double least = distance, expected = std::numeric_limits<double>::infinity();
            std::size_t asked = 0;
            visit_near(
                bounds, distance, tree,
                [&](boxtree::ItemId item) {
                    ++asked;
                    return least = std::min(least, gap_to(tree.boxes()[item]));
                },
                6);
            for (const boxtree::ItemId item : near) expected = std::min(expected, gap_to(crowd.boxes[item]));
            CHECK(least == std::min(distance, expected));
            CHECK(asked <= visited.size());
            nearest_found += !near.empty();
            asked = 0;
            visit_near(bounds, distance, tree, [&](boxtree::ItemId) { return ++asked, -1.0; });
            CHECK(asked <= 1);
        }
        CHECK(nearest_found > 100);
        std::size_t visits = 0;
        for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1.0})
            visit_near(aabb_of(crowd.boxes[0]), bad, tree,
                       [&](boxtree::ItemId) { return static_cast<double>(++visits); });
        visit_near(Aabb(), 1.0, tree, [&](boxtree::ItemId) { return static_cast<double>(++visits); });
        CHECK(visits == 0);
    }

    TEST_CASE("the nearest item is found soon within any distance, from far away and from amid the items") {
        NearMisses random(33);
        for (const auto orientation : {boxtree::Orientation::aligned, boxtree::Orientation::oriented})
            for (const double offset : {0.0, 1e7}) {
                const oracle::Crowd crowd = crowd_of(2000, offset, 34);
                const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = orientation});
                REQUIRE(tree.has_value());
                std::size_t asked = 0, queries = 0;
                for (const double limit : {1e2, 1e9, 1e300, std::numeric_limits<double>::infinity()})
                    for (int query = 0; query < 50; ++query, ++queries) {
                        const double away = std::exp(random.number(-3.0, 12.0));
                        const glm::dvec3 place = crowd.boxes[random.index(2000)].center + away * random.direction();
                        const auto gap_to = [&](const Obb& box) {
                            return distance(box, Capsule{place, place, 0.0}).distance;
                        };
                        double least = limit, expected = limit;
                        for (const Obb& box : crowd.boxes) expected = std::min(expected, gap_to(box));
                        visit_near({place, place}, limit, *tree, [&](boxtree::ItemId item) {
                            ++asked;
                            return least = std::min(least, gap_to(crowd.boxes[item]));
                        });
                        CHECK(least == expected);
                    }
                CHECK(asked < 100 * queries);
            }
    }

    TEST_CASE("a box that moves far visits all boxes that it may meet, and ends soon at the first") {
        NearMisses random(35);
        for (const auto orientation : {boxtree::Orientation::aligned, boxtree::Orientation::oriented})
            for (const double offset : {0.0, 1e5, 1e7}) {
                const oracle::Crowd crowd = crowd_of(2000, offset, 36);
                const auto tree = boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = orientation});
                REQUIRE(tree.has_value());
                std::size_t met = 0, visited = 0, visited_to_first = 0;
                for (int trial = 0; trial < 100; ++trial) {
                    const Ray path = random_ray(random, offset * glm::dvec3(1.0, -0.7, 0.3), 90.0);
                    const double thin = random.index(3) ? 1.0 : 0.0;
                    const glm::dvec3 half(random.number(0.0, 6.0), thin * random.number(0.0, 6.0), 3.0 * thin);
                    const double end = std::min(path.max_t, 200.0 / glm::length(path.direction));
                    // The first of many times at which the moving box meets one at rest.
                    const auto entry = [&](const Obb& box) -> std::optional<double> {
                        Aabb near = aabb_of(box);
                        near = {near.min - half - 1e-3, near.max + half + 1e-3};
                        if (!mesh::raycast(path, obb_of(near))) return std::nullopt;
                        for (int k = 0; k <= 100; ++k) {
                            const double t = 0.01 * k * end;
                            const Obb moved{path.origin + t * path.direction, glm::mat3(1.0f), glm::vec3(half)};
                            if (intersects(moved, box)) return t;
                        }
                        return std::nullopt;
                    };
                    std::vector<boxtree::ItemId> items;
                    visit_swept(path, half, *tree,
                                [&](boxtree::ItemId item) { return items.push_back(item), path.max_t; });
                    std::sort(items.begin(), items.end());
                    CHECK(std::adjacent_find(items.begin(), items.end()) == items.end());
                    double first = std::numeric_limits<double>::infinity();
                    for (boxtree::ItemId item = 0; item < 2000; ++item)
                        if (const auto t = entry(crowd.boxes[item])) {
                            ++met;
                            first = std::min(first, *t);
                            CHECK(std::binary_search(items.begin(), items.end(), item));
                        }
                    visited += items.size();
                    double least = path.max_t, found = std::numeric_limits<double>::infinity();
                    visit_swept(path, half, *tree, [&](boxtree::ItemId item) {
                        ++visited_to_first;
                        if (const auto t = entry(crowd.boxes[item])) found = least = std::min(least, *t);
                        return least;
                    });
                    CHECK(found == first);
                }
                CHECK(met > 1000);
                CHECK(visited < 3 * met);
                CHECK(2 * visited_to_first < visited);
            }
        int visits = 0;
        visit_swept(Ray{{}, {0.0, 0.0, 0.0}}, glm::dvec3(1.0), tree_of(crowd_of(10, 0.0, 37)),
                    [&](boxtree::ItemId) { return ++visits, 0.0; });
        CHECK(visits == 0);
    }

    TEST_CASE("bounds and distances without end are near to all, rays may be as long as numbers go") {
        const oracle::Crowd crowd = crowd_of(300, 1e3, 31);
        const boxtree::BoxTree tree = tree_of(crowd);
        const auto count = [&](const Aabb& bounds, double distance) {
            std::size_t visited = 0;
            visit_near(bounds, distance, tree, [&](boxtree::ItemId) { return ++visited, distance; });
            return visited;
        };
        constexpr double kMost = std::numeric_limits<double>::max(), kNoEnd = std::numeric_limits<double>::infinity();
        for (const double distance : {1e31, 1e300, kMost, kNoEnd})
            CHECK(count({glm::dvec3(1.0), glm::dvec3(2.0)}, distance) == crowd.boxes.size());
        CHECK(count({glm::dvec3(-kMost), glm::dvec3(kMost)}, 0.0) == crowd.boxes.size());
        CHECK(count({glm::dvec3(-kNoEnd), glm::dvec3(kNoEnd)}, 1.0) == 0);
        NearMisses random(32);
        std::size_t hits = 0;
        for (int i = 0; i < 300; ++i) {
            Ray ray = random_ray(random, crowd.boxes[random.index(300)].center, 5.0);
            ray.direction /= glm::length(ray.direction);
            const auto near = raycast(ray, tree);
            for (const double length : {0x1p-500, 0x1p400, 0x1p600, 0x1p1000}) {
                Ray scaled = ray;
                scaled.direction *= length;
                scaled.max_t /= length;
                const auto far = raycast(scaled, tree);
                REQUIRE(far.has_value() == near.has_value());
                if (near) CHECK(far->item == near->item);
                if (near) CHECK(far->t * length == doctest::Approx(near->t));
            }
            hits += near.has_value();
        }
        CHECK(hits > 50);
    }
}
