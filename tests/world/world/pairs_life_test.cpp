// SPDX-License-Identifier: MIT
// The life of a world for thousands of updates: pairs and contacts against all pairs of objects, one after the other.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <counting_memory.hpp>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/convex/query.hpp>
#include <map>
#include <optional>
#include <oracle/random_boxes.hpp>
#include <tuple>
#include <vector>

#include "../../ranges.hpp"
#include "model.hpp"

using namespace crofton;
using oracle::Model;
using oracle::NearMisses;
using testing::CountingMemory;

namespace {

using Key = std::pair<std::uint32_t, std::uint32_t>;

Bound random_bound(NearMisses& random) {
    const Obb box = oracle::random_box(random, glm::dvec3(0.0), 2.5);
    switch (random.index(3)) {
        case 0:
            return box;
        case 1:
            return aabb_of(box);
        default:
            return Sphere{box.center, static_cast<double>(box.half_extents.x)};
    }
}

// The manifold of two bounds, from the one with the lower index.
collide::Manifold touch(const Bound& a, const Bound& b) {
    const bool sphere_a = a.kind == BoundKind::sphere, sphere_b = b.kind == BoundKind::sphere;
    const Sphere of_a{a.box.center, a.radius}, of_b{b.box.center, b.radius};
    if (sphere_a && sphere_b) return collide::contact_manifold(of_a, of_b);
    if (sphere_b) return collide::contact_manifold(a.box, of_b);
    if (!sphere_a) return collide::contact_manifold(a.box, b.box);
    collide::Manifold manifold = collide::contact_manifold(b.box, of_a);
    manifold.normal = -manifold.normal;
    return manifold;
}

bool are_equal(const ObjectRef& a, const oracle::ModelObject& b) {
    return a.object == b.handle && a.user == b.user;
}

// In any of the Worlds: their handles differ in generations alone.
bool is_object(const ObjectRef& a, std::uint32_t index, const Model& model) {
    return a.object.index == index && a.user == model.objects.at(index).user;
}
bool are_same(const ObjectRef& a, const ObjectRef& b) {
    return a.object.index == b.object.index && a.user == b.user;
}

template <class Point>
bool are_equal(std::span<const collide::ContactPoint> a, std::span<const Point> b) {
    return test::ranges::equal(
        a, b, [](const auto& p, const auto& q) { return p.position == q.position && p.depth == q.depth; });
}

// Whether a contact tells a manifold.
template <class Manifold>
bool tells(const Contact& contact, const Manifold& expected) {
    const std::span points(expected.points, static_cast<std::size_t>(expected.count));
    return contact.normal == expected.normal && contact.depth == expected.depth && are_equal(contact.points, points);
}

// What a world told of contacts after the update before.
using Before = std::map<Key, std::pair<ObjectHandle, ObjectHandle>>;

// Whether a list of contacts tells what has begun, stayed and ended.
template <class Contacts, class IsContact>
bool check_phases(const Contacts& contacts, const Model& model, const std::vector<Key>& pairs, IsContact is_contact,
                  Before& before) {
    bool good = true;
    Before now, told;
    for (const Key& pair : pairs)
        if (is_contact(pair)) now[pair] = {model.objects.at(pair.first).handle, model.objects.at(pair.second).handle};
    std::optional<Key> last;
    for (const auto& contact : contacts) {
        const Key pair{contact.first.object.index, contact.second.object.index};
        good &= !last || *last < pair;
        last = pair;
        const auto old = before.find(pair);
        if (contact.phase == ContactPhase::ended) {
            good &= !now.contains(pair) && old != before.end() &&
                    old->second == std::pair(contact.first.object, contact.second.object);
            if (old != before.end()) before.erase(old);
            continue;
        }
        good &= now.contains(pair) && now[pair] == std::pair(contact.first.object, contact.second.object);
        good &= (contact.phase == ContactPhase::stayed) == (old != before.end());
        if (old != before.end()) before.erase(old);
        told[pair];
    }
    good &= before.empty() && told.size() == now.size();  // all that there was is told of, and all that there is
    before = now;
    return good;
}

class Life {
  public:
    explicit Life(unsigned seed) : random_(seed) {}

    void change(unsigned changes) {
        for (; changes > 0; --changes) {
            if (model.objects.empty() || (model.objects.size() < 100 && random_.index(6) == 0)) {
                add();
                continue;
            }
            auto known = model.objects.begin();
            std::advance(known, random_.index(static_cast<unsigned>(model.objects.size())));
            change(known);
        }
    }
    void move(unsigned part) {
        for (auto& [id, object] : model.objects) {
            if (random_.index(part) != 0) continue;
            object.bound.box.center += 0.3 * random_.direction();
            for (const auto& [world, handle] : in_worlds(id))
                REQUIRE(world->set_bound(handle, object.bound).has_value());
        }
    }

    World serial, parallel, seldom_asked;
    Model model;  // with the handles of serial: each World gives its own
    std::map<std::uint32_t, convex::Shape> shapes;

  private:
    void add() {
        oracle::ModelObject object;
        object.bound = random_bound(random_);
        object.user = random_.index(1u << 30);
        object.layers = random_.index(4) ? ~0u : random_.index(4);
        object.collides_with = random_.index(4) ? ~0u : random_.index(4);
        Handles handles;
        for (std::size_t i = 0; i < worlds_.size(); ++i)
            handles[i] = {worlds_[i], worlds_[i]
                                          ->add({.bound = object.bound,
                                                 .user = object.user,
                                                 .layers = object.layers,
                                                 .collides_with = object.collides_with})
                                          .value()};
        object.handle = handles[0].second;
        for (const auto& [world, handle] : handles) REQUIRE(handle.index == object.handle.index);
        model.objects[object.handle.index] = object;
        handles_[object.handle.index] = handles;
    }
    void change(std::map<std::uint32_t, oracle::ModelObject>::iterator known) {
        oracle::ModelObject& object = known->second;
        const unsigned kind = random_.index(9);
        if (kind == 0) object.hidden = !object.hidden;
        if (kind == 1) object.layers = random_.index(4) ? ~0u : random_.index(4);
        if (kind == 2) object.collides_with = random_.index(4) ? ~0u : random_.index(4);
        if (kind == 3) object.user = random_.index(1u << 30);
        if (kind == 4) object.bound = random_bound(random_);
        if (kind == 4 || kind == 5) shapes.erase(known->first);  // a shape lies within the bound
        if (kind == 6)
            shapes.insert_or_assign(known->first,
                                    convex::Shape::box(glm::vec3(object.bound.box.half_extents) *
                                                       (object.bound.kind == BoundKind::sphere ? 0.57f : 0.99f))
                                        .value());
        for (const auto& [world, handle] : in_worlds(known->first)) {
            Result<void> done;
            if (kind == 0) done = world->set_hidden(handle, object.hidden);
            if (kind == 1) done = world->set_layers(handle, object.layers);
            if (kind == 2) done = world->set_collides_with(handle, object.collides_with);
            if (kind == 3) done = world->set_user(handle, object.user);
            if (kind == 4) REQUIRE(world->set_bound(handle, object.bound).has_value());
            if (kind == 4 || kind == 5) done = world->set_shape(handle, nullptr);
            if (kind == 6) done = world->set_shape(handle, &shapes.at(known->first));
            if (kind == 7) done = world->remove(handle);
            REQUIRE(done.has_value());
        }
        if (kind == 7) {
            shapes.erase(known->first);
            model.objects.erase(known);
        }
    }

    using Handles = std::array<std::pair<World*, ObjectHandle>, 3>;
    const Handles& in_worlds(std::uint32_t id) const { return handles_.at(id); }

    NearMisses random_;
    std::array<World*, 3> worlds_{&serial, &parallel, &seldom_asked};
    std::map<std::uint32_t, Handles> handles_;
};

}  // namespace

TEST_SUITE("world/pairs life") {
    TEST_CASE("pairs and contacts are those of all objects, whatever comes, goes, moves, hides or changes") {
        ThreadPool pool(3);
        for (const unsigned seed : {51u, 52u, 55u}) {
            Life life(seed);
            NearMisses random(seed + 100);
            Before before;
            std::size_t contacts = 0, ended = 0, shape_contacts = 0, of_one_shape = 0;
            for (int frame = 0; frame < 1500; ++frame) {
                CAPTURE(frame);
                life.change(frame % 400 == 0 ? 120 : frame % 3 == 0 ? random.index(4) : 0);
                if (frame % 5 != 4) life.move(frame % 7 == 0 ? 2 : 25);
                REQUIRE(life.serial.update().has_value());
                REQUIRE(life.parallel.update(pool).has_value());
                REQUIRE(life.seldom_asked.update().has_value());
                const Model& model = life.model;
                const auto pairs = model.pairs();
                const auto are_pairs = [&](std::span<const ObjectPair> told) {
                    return test::ranges::equal(told, pairs, [&](const ObjectPair& a, const Key& b) {
                        return is_object(a.first, b.first, model) && is_object(a.second, b.second, model);
                    });
                };
                CHECK(are_pairs(life.serial.pairs()));
                CHECK(are_pairs(life.parallel.pairs()));
                if (frame % 29 == 0) CHECK(are_pairs(life.seldom_asked.pairs()));
                const auto have_shapes = [&](const Key& pair) {
                    return life.shapes.contains(pair.first) && life.shapes.contains(pair.second);
                };
                const auto has_shape = [&](const Key& pair) {
                    return life.shapes.contains(pair.first) || life.shapes.contains(pair.second);
                };
                const auto pose_of = [&](std::uint32_t id) {
                    const Bound& bound = model.objects.at(id).bound;
                    const bool sphere = bound.kind == BoundKind::sphere;
                    return RigidTransform{sphere ? glm::dmat3(1.0) : glm::dmat3(bound.box.axes), bound.box.center};
                };
                const auto shape_of = [&](std::uint32_t id) {
                    const Bound& bound = model.objects.at(id).bound;
                    if (const auto own = life.shapes.find(id); own != life.shapes.end()) return own->second;
                    if (bound.kind == BoundKind::sphere) return convex::Shape::sphere(bound.radius).value();
                    return convex::Shape::box(bound.box.half_extents).value();
                };
                const auto with_placed = [&](const Key& pair, const auto& ask) {
                    const convex::Shape a = shape_of(pair.first), b = shape_of(pair.second);
                    const RigidTransform pose_a = pose_of(pair.first), pose_b = pose_of(pair.second);
                    return ask(convex::ShapeAtPose{a, pose_a}, convex::ShapeAtPose{b, pose_b});
                };
                const auto meet = [&](const Key& pair) {
                    return with_placed(pair, [](const auto& a, const auto& b) { return convex::intersects(a, b); });
                };
                std::vector<Contact> of_bounds, of_shapes;
                for (const Contact& contact : life.serial.contacts())
                    (contact.shape_points.empty() ? of_bounds : of_shapes).push_back(contact);
                bool good = true;
                for (const Contact& contact : of_bounds) {
                    ++contacts;
                    if (contact.phase == ContactPhase::ended) {
                        ++ended;
                        good &= contact.points.empty() && contact.depth == 0.0 && contact.normal == glm::dvec3(0.0);
                        continue;
                    }
                    const auto &a = model.objects.at(contact.first.object.index),
                               &b = model.objects.at(contact.second.object.index);
                    const Key pair{contact.first.object.index, contact.second.object.index};
                    const bool mixed = has_shape(pair);
                    of_one_shape += mixed;
                    good &= are_equal(contact.first, a) && are_equal(contact.second, b) && contact.triangles.empty();
                    good &= mixed ? tells(contact, with_placed(pair,
                                                               [](const auto& x, const auto& y) {
                                                                   return convex::contact_manifold(x, y);
                                                               }))
                                  : tells(contact, touch(a.bound, b.bound));
                }
                for (const Contact& contact : of_shapes) {
                    double deepest = -HUGE_VAL;
                    glm::dvec3 normal(0.0);
                    for (const convex::TrackedPoint& point : contact.shape_points)
                        if (point.contact.depth > deepest) deepest = point.contact.depth, normal = point.normal;
                    good &= contact.phase != ContactPhase::ended && contact.points.empty() && contact.triangles.empty();
                    good &= contact.depth == deepest && contact.normal == normal;
                }
                CHECK(good);
                for (const World* other : {&life.parallel, &life.seldom_asked})
                    CHECK(test::ranges::equal(
                        life.serial.contacts(), other->contacts(), [](const Contact& a, const Contact& b) {
                            return are_same(a.first, b.first) && are_same(a.second, b.second) && a.phase == b.phase &&
                                   a.normal == b.normal && a.depth == b.depth && are_equal(a.points, b.points) &&
                                   a.shape_points.size() == b.shape_points.size();
                        }));
                // Boxes as shapes.
                std::map<Key, bool> shapes_meet;
                for (const Contact& contact : of_shapes)
                    shapes_meet[{contact.first.object.index, contact.second.object.index}] = true;
                // One list in order, which has each pair once, however it is tested.
                CHECK(check_phases(
                    life.serial.contacts(), model, pairs,
                    [&](const Key& pair) {
                        return have_shapes(pair) ? shapes_meet[pair] : !has_shape(pair) || meet(pair);
                    },
                    before));
                for (const Key& pair : pairs)
                    if (have_shapes(pair)) {
                        ++shape_contacts;
                        CHECK(shapes_meet[pair] == meet(pair));
                    }
            }
            CHECK(contacts > 5000);
            CHECK(ended > 200);
            CHECK(shape_contacts > 200);
            CHECK(of_one_shape > 1000);
        }
    }

    TEST_CASE("if one object changes in a world of thousands, only objects near it are tested") {
        World world;
        NearMisses random(53);
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 4000; ++i)
            objects.push_back(world.add({.bound = oracle::random_box(random, {}, 25.0)}).value());
        for (int frame = 0; frame < 40; ++frame) REQUIRE(world.update().has_value());
        const std::size_t all = world.contacts().size();
        REQUIRE(all > 100);
        std::size_t looked_at = 0;
        for (int frame = 0; frame < 300; ++frame) {
            ObjectHandle& object = objects[random.index(4000)];
            const unsigned kind = static_cast<unsigned>(frame) % 6;
            if (kind == 0) REQUIRE(world.set_layers(object, 1u << random.index(2)).has_value());
            if (kind == 1) REQUIRE(world.set_user(object, random.index(1000)).has_value());
            if (kind == 2) REQUIRE(world.set_hidden(object, random.index(2) == 0).has_value());
            if (kind == 3) REQUIRE(world.set_collides_with(object, random.index(2) ? ~0u : 0u).has_value());
            if (kind == 4) REQUIRE(world.remove(object).has_value());
            if (kind == 4 || kind == 5) object = world.add({.bound = oracle::random_box(random, {}, 25.0)}).value();
            REQUIRE(world.update().has_value());
            looked_at += world.statistics().box_pairs_tested + world.statistics().contact_pairs_tested;
        }
        CHECK(looked_at < 300 * 12);
        CHECK(world.contacts().size() > all / 2);
    }

    TEST_CASE("a warm world in which objects come and go allocates no more for pairs and contacts than it did") {
        CountingMemory memory;
        World world({.rebuild_budget = 0});
        NearMisses random(54);
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 500; ++i)
            objects.push_back(world.add({.bound = oracle::random_box(random, {}, 12.0)}).value());
        std::size_t early = 0;
        for (int frame = 0; frame < 16000; ++frame) {
            ObjectHandle& object = objects[random.index(500)];
            REQUIRE(world.remove(object).has_value());
            object = world.add({.bound = oracle::random_box(random, {}, 12.0)}).value();
            REQUIRE(world.update().has_value());
            if (frame == 8000) early = memory.bytes_in_use();
        }
        CHECK(static_cast<double>(memory.bytes_in_use()) < 1.1 * static_cast<double>(early));
    }
}
