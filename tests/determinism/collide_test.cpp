// SPDX-License-Identifier: MIT
// What touches what, in the same bits everywhere.
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <oracle/exact_boxes.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// Two frames of a crowd in motion.
std::uint64_t pairs(Executor& executor) {
    Digest digest;
    collide::Broadphase broadphase;
    std::vector<Obb> boxes = crowd(3000, 1e5, 41);
    Random random(42);
    for (int frame = 0; frame < 3; ++frame) {
        (void)broadphase.update(boxes, {}, executor);
        for (const auto list : {broadphase.pairs(), broadphase.began(), broadphase.ended()})
            for (const IdPair& pair : list) digest.add(pair.first).add(pair.second);
        for (std::size_t i = 0; i < 500; ++i) boxes[i].center += 0.5 * sampling::direction(random.point<2>());
    }
    return digest.value();
}

// Distances, depths, contact points and separating axes of the first few.
std::uint64_t pairs_closely() {
    Digest digest;
    const std::vector<Obb> boxes = crowd(300, 0.0, 43);
    for (std::size_t i = 1; i < boxes.size(); ++i) {
        Obb a = boxes[i - 1], b = boxes[i];
        b.center = a.center + 0.125 * (b.center - a.center);
        digest.add(static_cast<std::uint32_t>(collide::separating_axis(a, b)));
        const auto distance = collide::distance(a, b);
        const auto penetration = collide::penetration(a, b);
        const auto manifold = collide::contact_manifold(a, b);
        digest.add(distance.distance)
            .add(distance.on_a)
            .add(distance.on_b)
            .add(penetration.depth)
            .add(penetration.axis);
        for (int k = 0; k < manifold.count; ++k) digest.add(manifold.points[k].position).add(manifold.points[k].depth);
    }
    return digest.value();
}

std::uint64_t meshes() {
    Digest digest;
    const auto a = *mesh::MeshTree::build(torus(60, 30, 0.2)), b = *mesh::MeshTree::build(torus(30, 12, 0.0));
    Random random(44);
    for (int trial = 0; trial < 60; ++trial) {
        const double apart = random.uniform(0.0, 3.5);
        const RigidTransform pose{sampling::rotation(random.point<3>()),
                                  apart * sampling::direction(random.point<2>())};
        Vector<mesh::MeshContact> contacts;
        mesh::contacts(a, b, pose, contacts);
        for (const auto& c : contacts)
            digest.add(c.triangles.first).add(c.triangles.second).add(c.segment.begin).add(c.segment.end).add(c.normal);
        const collide::Manifold manifold = collide::contact_manifold(a, b, pose, contacts);
        digest.add(manifold.normal);
        for (int k = 0; k < manifold.count; ++k) digest.add(manifold.points[k].position).add(manifold.points[k].depth);
        const auto depth = mesh::separating_motion(a, b, pose, contacts);
        const auto distance = mesh::distance(a, b, pose);
        digest.add(depth.depth).add(depth.direction).add(distance.distance).add(distance.on_a).add(distance.on_b);
        digest.add(distance.triangles.first).add(distance.triangles.second);
        digest.add(static_cast<std::uint8_t>(mesh::containment(a, b, pose)));
        digest.add(static_cast<std::uint8_t>(mesh::closer_than(a, b, pose, 0.5)));
        const auto hit = mesh::raycast({pose.translation, -pose.translation}, a);
        if (hit) digest.add(hit->t).add(hit->triangle);
    }
    return digest.value();
}

// The nearest points of meshes of few leaves and of many, ties included, and on which side of them.
std::uint64_t points_at_meshes() {
    Digest digest;
    TriangleMesh box;
    for (unsigned i = 0; i < 8; ++i) box.positions.push_back({i & 1 ? 2 : -2, i & 2 ? 2 : -2, i & 4 ? 4 : -4});
    box.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                   2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    const auto house = *mesh::MeshTree::build(box), ring = *mesh::MeshTree::build(torus(60, 30, 0.2));
    Random random(45);
    for (int trial = 0; trial < 2000; ++trial) {
        const double length = random.uniform(0.0, trial % 2 == 0 ? 5.0 : 1.5);
        glm::dvec3 point = length * sampling::direction(random.point<2>());
        if (trial % 4 == 0) point = glm::round(point);
        const mesh::MeshTree& tree = trial % 2 == 0 ? house : ring;
        const auto found = mesh::distance_to_point(tree, point);
        digest.add(found.distance).add(found.on_a).add(found.triangles.first);
        digest.add(static_cast<std::uint8_t>(mesh::contains(tree, point)));
    }
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/collide") {
    TEST_CASE("nearest points of meshes, and the sides of points, are the same bits everywhere") {
        check_everywhere(0x37ebee0bae06d2c4, [](Executor&) { return points_at_meshes(); });
    }

    TEST_CASE("pairs of moving boxes are the same everywhere") {
        check_everywhere(0xc74938a5f930b243, [](Executor& e) { return pairs(e); });
    }

    TEST_CASE("distances, depths and contact points of boxes are the same bits everywhere") {
        check_everywhere(0xf960e9e963b3e82c, [](Executor&) { return pairs_closely(); });
    }

    TEST_CASE("contacts, depths, distances and rays of meshes are the same bits everywhere") {
        check_everywhere(0x82e0c5a32706bac8, [](Executor&) { return meshes(); });
    }

    TEST_CASE("the published pairs are those of rational arithmetic") {
        const std::vector<Obb> boxes = crowd(3000, 1e5, 41);
        collide::Broadphase broadphase;
        REQUIRE(broadphase.update(boxes).has_value());
        CHECK(broadphase.pairs().size() > 100);
        for (const IdPair& pair : broadphase.pairs())
            CHECK(oracle::boxes_meet_by_integers(boxes[pair.first], boxes[pair.second]));
        std::size_t meet = 0;
        for (std::size_t i = 0; i < 200; ++i)
            for (std::size_t j = i + 1; j < 200; ++j) meet += oracle::boxes_meet_by_integers(boxes[i], boxes[j]);
        const auto pairs = broadphase.pairs();  // libc++ 14 lacks the algorithms of std::ranges
        CHECK(meet == static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(),
                                                             [](const IdPair& pair) { return pair.second < 200; })));
    }
}
