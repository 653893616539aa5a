// SPDX-License-Identifier: MIT
// Bodies and rays that touch a box of a tree to the last bit: what the tree rounds it must round outward. And trees
// that have lived.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <oracle/aged_tree.hpp>
#include <oracle/edges.hpp>

#include "../../ranges.hpp"

using namespace crofton;
using namespace crofton::collide;
using oracle::NearMisses;

namespace {

using Items = std::vector<boxtree::ItemId>;

// Upright boxes, so that their bounds are no larger than they are; some are points.
std::vector<Obb> cluster(NearMisses& random, const glm::dvec3& middle, double size, double half) {
    std::vector<Obb> boxes(1 + random.index(random.index(4) ? 16 : 60));
    for (Obb& box : boxes) {
        box.center = middle + size * glm::dvec3(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        for (int k = 0; k < 3; ++k)
            box.half_extents[k] = random.index(3) ? float(half * random.number(0.1, 1.0)) : 0.0f;
    }
    return boxes;
}

template <class Body>
void check_body(const boxtree::BoxTree& tree, const Body& body) {
    Items expected;
    for (std::size_t i = 0; i < tree.boxes().size(); ++i)
        if (intersects(tree.boxes()[i], body)) expected.push_back(static_cast<boxtree::ItemId>(i));
    Vector<boxtree::ItemId> items;
    overlapping(tree, body, items);
    REQUIRE(test::ranges::equal(items, expected));
}

// Bodies of growing size about one place: just before and just after each begins to touch box `item`.
template <class Number, class BodyOf>
void check_growing(const boxtree::BoxTree& tree, const Obb& box, Number most, BodyOf body_of) {
    const auto meets = [&](Number size) { return intersects(box, body_of(size)); };
    if (meets(Number(0)) || !meets(most)) return;
    const auto edge = oracle::edge_between(Number(0), most, [&](Number size) { return !meets(size); });
    Number size = edge.first;
    for (int step = 0; step < 3; ++step, size = std::nextafter(size, most)) check_body(tree, body_of(size));
}

void check_rays(NearMisses& random, const boxtree::BoxTree& tree, const Obb& box, double size) {
    Ray ray;
    const int axis = static_cast<int>(random.index(3));
    ray.direction = random.index(2) ? random.direction() : glm::dvec3(0.0);
    if (ray.direction == glm::dvec3(0.0)) ray.direction[axis] = random.index(2) ? 1.0 : -1.0;
    // Through a point of an edge of the box, or ending on its surface.
    glm::dvec3 target = box.center;
    for (int k = 0; k < 3; ++k)
        target[k] +=
            (random.index(3) ? (random.index(2) ? 1.0 : -1.0) : random.number(-1, 1)) * double{box.half_extents[k]};
    const double away = size * std::exp(random.number(-2.0, 14.0));
    ray.origin = target - away * ray.direction;
    for (const double end : {0.0, away, 3.0 * away})
        for (int step = -2; step <= 2; ++step) {
            ray.max_t = end;
            for (int i = 0; i < std::abs(step); ++i) ray.max_t = std::nextafter(ray.max_t, step < 0 ? 0.0 : 1e300);
            Items expected, found;
            for (std::size_t i = 0; i < tree.boxes().size(); ++i)
                if (mesh::raycast(ray, tree.boxes()[i])) expected.push_back(static_cast<boxtree::ItemId>(i));
            visit_along(ray, tree, [&](boxtree::ItemId item, double) { return found.push_back(item), ray.max_t; });
            test::ranges::sort(found);
            REQUIRE(found == expected);
        }
}

}  // namespace

TEST_SUITE("collide/tree edges") {
    TEST_CASE("bodies that begin to touch a box are found at that very size, near the origin and far from it") {
        NearMisses random(71);
        for (int trial = 0; trial < 1500; ++trial) {
            const double offset = trial % 3 == 0 ? 0.0 : trial % 3 == 1 ? 1e4 : 1e8;
            const glm::dvec3 middle = offset * glm::dvec3(1.0, -0.7, 0.3);
            // Far away a cluster may be smaller than what its coordinates are rounded to.
            const double size = std::exp(random.number(offset > 1e6 ? -16.0 : -5.0, 3.0));
            const auto boxes = cluster(random, middle, size, size * std::exp(random.number(-10.0, 1.0)));
            const auto tree = boxtree::BoxTree::build(boxes).value();
            const Obb& box = boxes[random.index(static_cast<unsigned>(boxes.size()))];
            // Beside one face, so that one coordinate decides.
            glm::dvec3 place = box.center;
            const int axis = static_cast<int>(random.index(3));
            place[axis] += (random.index(2) ? 1.0 : -1.0) * (box.half_extents[axis] + size * random.number(0.01, 2.0));
            const double most = 1e3 * size + 1.0;
            check_growing(tree, box, float(most), [&](float half) {
                Obb body;
                body.center = place;
                body.half_extents = glm::vec3(half);
                return body;
            });
            check_growing(tree, box, most, [&](double radius) { return Sphere{place, radius}; });
            const glm::dvec3 along = random.number(0.0, size) * glm::dvec3(axis == 0, axis == 1, axis == 2);
            const double side = place[axis] > box.center[axis] ? 1.0 : -1.0;
            check_growing(tree, box, most, [&](double radius) { return Capsule{place, place + side * along, radius}; });
        }
    }

    TEST_CASE("boxes are near at the very distance at which they begin to be") {
        NearMisses random(72);
        for (int trial = 0; trial < 1500; ++trial) {
            const glm::dvec3 middle = (trial % 2 ? 0.0 : 1e8) * glm::dvec3(1.0, -0.7, 0.3);
            const double size = std::exp(random.number(-16.0, 3.0));
            const auto boxes = cluster(random, middle, size, size * std::exp(random.number(-10.0, 1.0)));
            const auto tree = boxtree::BoxTree::build(boxes).value();
            const auto item = random.index(static_cast<unsigned>(boxes.size()));
            const int axis = static_cast<int>(random.index(3));
            // A point beside one face: its distance is a difference of two coordinates, exact in rational arithmetic,
            // and rounded down here.
            glm::dvec3 place = boxes[item].center;
            place[axis] += boxes[item].half_extents[axis] + size * random.number(0.01, 2.0);
            const double gap = (place[axis] - boxes[item].center[axis]) - double{boxes[item].half_extents[axis]};
            if (!(gap > 0.0)) continue;
            for (const double distance : {gap, std::nextafter(gap, 1e300)}) {
                bool found = false;
                visit_near({place, place}, distance, tree, [&](boxtree::ItemId i) {
                    found = found || i == item;
                    return distance;
                });
                REQUIRE(found);
            }
        }
    }

    TEST_CASE("boxes that are tiny relative to their leaf's units stay near their true extent") {
        NearMisses random(74);
        for (int trial = 0; trial < 4000; ++trial) {
            const int axis = static_cast<int>(random.index(3));
            std::vector<Obb> boxes(3);
            for (Obb& box : boxes) box.half_extents = glm::vec3(0.0f);
            boxes[0].center[axis] = 1.0;
            boxes[1].center[axis] = -1.0;
            // Half a unit or one and a half from the leaf's origin, and 2^-24 units wide, or so.
            const double unit =
                static_cast<double>(boxtree::BoxTree::build(boxes)->structure().leaves()[0].position_unit);
            boxes[2].center[axis] =
                (random.index(2) ? 0.5 : 1.5) * unit * (1.0 + 0x1p-40) * (random.index(2) ? 1.0 : -1.0);
            boxes[2].half_extents[axis] = float(unit * 0x1p-25 * random.number(0.1, 4.0));
            const auto tree = boxtree::BoxTree::build(boxes).value();
            for (const double side : {1.0, -1.0}) {
                glm::dvec3 end(0.0);
                end[axis] = boxes[2].center[axis] + side * double{boxes[2].half_extents[axis]};
                bool found = false;
                visit_near({end, end}, 0.0, tree, [&](boxtree::ItemId i) {
                    found = found || i == 2;
                    return 0.0;
                });
                REQUIRE(found);
            }
        }
    }

    TEST_CASE("rays that graze a box, or end on it, meet what each box alone says") {
        NearMisses random(73);
        for (int trial = 0; trial < 1500; ++trial) {
            const glm::dvec3 middle = (trial % 3 ? 0.0 : 1e6) * glm::dvec3(1.0, -0.7, 0.3);
            const double size = std::exp(random.number(-5.0, 3.0));
            const auto boxes = cluster(random, middle, size, size * std::exp(random.number(-10.0, 1.0)));
            const auto tree = boxtree::BoxTree::build(boxes).value();
            check_rays(random, tree, boxes[random.index(static_cast<unsigned>(boxes.size()))], size);
        }
    }

    TEST_CASE("in trees of every age bodies, rays and distances meet what each box alone says") {
        NearMisses random(74);
        oracle::for_each_age(75, 1500, [&](const oracle::AgedTree& aged) {
            const auto expect = [&](std::uint32_t layers, auto meets) {
                Items items;
                for (std::size_t i = 0; i < aged.boxes.size(); ++i)
                    if (aged.holds(i) && (aged.layers[i] & layers) != 0 && meets(aged.boxes[i]))
                        items.push_back(static_cast<boxtree::ItemId>(i));
                return items;
            };
            for (int trial = 0; trial < 40; ++trial) {
                const std::uint32_t layers = trial % 3 ? ~0u : 1u << random.index(5);
                Obb body = oracle::random_box(random, glm::dvec3(0.0), 40.0);
                body.half_extents *= 20.0f;
                Vector<boxtree::ItemId> items;
                overlapping(aged.tree, body, items, layers);
                REQUIRE(test::ranges::equal(items, expect(layers, [&](const Obb& b) { return intersects(b, body); })));
                const Sphere sphere{body.center, random.number(0.0, 30.0)};
                overlapping(aged.tree, sphere, items, layers);
                REQUIRE(
                    test::ranges::equal(items, expect(layers, [&](const Obb& b) { return intersects(b, sphere); })));
                Ray ray{60.0 * random.direction(), random.direction()};
                ray.direction -= random.number(0.5, 2.0) * ray.origin / 60.0;
                Items found;
                visit_along(
                    ray, aged.tree, [&](boxtree::ItemId item, double) { return found.push_back(item), ray.max_t; },
                    layers);
                test::ranges::sort(found);
                REQUIRE(found == expect(layers, [&](const Obb& b) { return mesh::raycast(ray, b).has_value(); }));
            }
        });
    }
}
