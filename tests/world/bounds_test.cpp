// SPDX-License-Identifier: MIT
// Objects that are bounds alone.
#include <doctest/doctest.h>
#include <array>
#include <counting_memory.hpp>
#include <limits>
#include <oracle/code_of.hpp>
#include <oracle/random_boxes.hpp>
#include <set>

#include "model.hpp"
#include "new_counter.hpp"

using namespace crofton;
using oracle::Model;
using oracle::NearMisses;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

Obb box_at(const glm::dvec3& center, float half = 0.5f) {
    Obb box;
    box.center = center;
    box.half_extents = glm::vec3(half);
    return box;
}

Bound random_bound(NearMisses& random, double spread) {
    Obb box = oracle::random_box(random, glm::dvec3(3.0, -2.0, 1.0), spread);
    switch (random.index(3)) {
        case 0:
            return box;
        case 1:
            return aabb_of(box);
        default:
            return Sphere{box.center, static_cast<double>(box.half_extents.x)};
    }
}

cull::View random_view(NearMisses& random) {
    Camera camera;
    camera.position = 30.0 * random.direction();
    camera.forward = glm::normalize(-camera.position + 10.0 * random.direction());
    camera.up = random.direction();
    camera.far_distance = 60.0;
    return {.frustum = frustum_of(camera).value(), .layer_mask = random.index(2) ? ~0u : 1u << random.index(4)};
}

Ray random_ray(NearMisses& random) {
    Ray ray;
    ray.origin = 40.0 * random.direction();
    ray.direction = -ray.origin + 15.0 * random.direction();
    if (random.index(3) == 0) ray.max_t = random.number(0.0, 2.0);
    return ray;
}

std::vector<std::uint32_t> ids_of(const Vector<ObjectRef>& found) {
    std::vector<std::uint32_t> ids;
    for (const ObjectRef& object : found) ids.push_back(object.object.index);
    return ids;
}

// Everything that a world is asked, against the model.
void check_answers(const World& world, const Model& model, NearMisses& random) {
    VisibleObjects visible;
    std::array<cull::View, 3> views{};
    for (cull::View& view : views) view = random_view(random);
    for (const cull::View& view : views) {
        const auto expected = model.visible(view);
        world.view(view, visible);
        CHECK(std::vector(visible.ids().begin(), visible.ids().end()) == expected);
        world.view(view, visible, {.order = cull::ResultOrder::tree});
        std::vector<std::uint32_t> seen(visible.ids().begin(), visible.ids().end());
        std::sort(seen.begin(), seen.end());
        CHECK(seen == expected);
        for (std::size_t i = 0; i < visible.size(); ++i) {
            CHECK(visible[i].object == model.objects.at(visible.ids()[i]).handle);
            CHECK(visible[i].user == model.objects.at(visible.ids()[i]).user);
        }
    }
    VisibleInViews in_views;
    world.view(views, in_views);
    for (std::size_t v = 0; v < views.size(); ++v) {
        std::vector<std::uint32_t> seen;
        for (std::size_t i = 0; i < in_views.size(); ++i)
            if (in_views.view_mask(i) >> v & 1) seen.push_back(in_views[i].object.index);
        std::sort(seen.begin(), seen.end());
        CHECK(seen == model.visible(views[v]));
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const ObjectPair& pair : world.pairs()) pairs.emplace_back(pair.first.object.index, pair.second.object.index);
    CHECK(pairs == model.pairs());

    Vector<ObjectHit> hits;
    Vector<ObjectRef> found;
    for (int query = 0; query < 5; ++query) {
        const std::uint32_t layers = random.index(2) ? ~0u : 1u << random.index(4);
        const Ray ray = random_ray(random);
        const auto expected = model.along(ray, layers);
        world.raycast_all(ray, hits, layers);
        REQUIRE(hits.size() == expected.size());
        for (std::size_t i = 0; i < hits.size(); ++i) {
            CHECK(hits[i].t == doctest::Approx(expected[i].first).epsilon(1e-9));
            CHECK(hits[i].user == model.objects.at(hits[i].object.index).user);
            CHECK(glm::length(hits[i].point - (ray.origin + hits[i].t * ray.direction)) == 0.0);
        }
        CHECK(world.raycast_any(ray, layers) == !expected.empty());
        const auto nearest = world.raycast(ray, layers);
        REQUIRE(nearest.has_value() == !expected.empty());
        if (nearest) {
            CHECK(nearest->t == hits[0].t);
            CHECK(nearest->object == hits[0].object);
        }
        const Obb box = oracle::random_box(random, {}, 30.0);
        const Sphere ball{box.center, random.number(0.0, 8.0)};
        world.overlap(box, found, layers);
        CHECK(ids_of(found) == model.overlapping(box, layers));
        world.overlap(ball, found, layers);
        CHECK(ids_of(found) == model.overlapping(ball, layers));
        world.overlap(collide::Capsule{ball.center, ball.center, ball.radius}, found, layers);
        CHECK(ids_of(found) == model.overlapping(ball, layers));
        for (const double limit : {1.0, 1e3}) {
            const double least = model.distance_to(box, layers);
            const auto closest = world.closest(box, limit, layers);
            REQUIRE(closest.has_value() == (least <= limit));
            if (!closest) continue;
            CHECK(closest->distance == doctest::Approx(least).epsilon(1e-9));
            CHECK(glm::length(closest->on_object - closest->on_shape) == doctest::Approx(least).epsilon(1e-6));
        }
    }
}

}  // namespace

TEST_SUITE("world/bounds") {
    TEST_CASE("an empty world answers, before and after its first update") {
        World world;
        VisibleObjects visible;
        Vector<ObjectHit> hits(1);
        Vector<ObjectRef> found(1);
        for (int update = 0; update < 2; ++update) {
            REQUIRE(world.view(Camera(), visible).has_value());
            CHECK(visible.size() == 0);
            CHECK(!world.raycast({}));
            CHECK(!world.raycast_any({}));
            world.raycast_all({}, hits);
            CHECK(hits.empty());
            world.overlap(Sphere{{}, 1e3}, found);
            CHECK(found.empty());
            CHECK(!world.closest(Sphere{}, 1e9));
            CHECK(world.pairs().empty());
            CHECK(world.contacts().empty());
            REQUIRE(world.update().has_value());
        }
        CHECK(world.object_count() == 0);
        CHECK(!world.contains(ObjectHandle()));
        CHECK(world.remove(ObjectHandle()).error().code == ErrorCode::stale_handle);
    }

    TEST_CASE("bounds that are none are refused with a reason, and spoil nothing") {
        World world;
        const auto good = world.add({.bound = box_at({}), .user = 5}).value();
        Obb bad = box_at({});
        CHECK(oracle::code_of(world.add({})) == ErrorCode::invalid_argument);
        for (const double number : {kNan, kInfinity, 2e30}) {
            bad.center = {0.0, number, 0.0};
            const ErrorCode code = number == 2e30 ? ErrorCode::out_of_range : ErrorCode::non_finite;
            CHECK(world.add({.bound = bad}).error().code == code);
            CHECK(world.set_bound(good, bad).error().code == code);
            CHECK(world.set_bound(good, bad).error().item == good.index);
            CHECK(world.add({.bound = Sphere{{0.0, number, 0.0}, 1.0}}).error().code == code);
            CHECK(world.add({.bound = Sphere{{}, number}}).error().code == code);
            CHECK_FALSE(world.add({.bound = Aabb{{}, glm::dvec3(number)}}).has_value());
        }
        CHECK(oracle::code_of(world.add({.bound = Sphere{{}, -1.0}})) == ErrorCode::invalid_argument);
        CHECK_FALSE(world.add({.bound = Aabb()}).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.object_count() == 1);
        CHECK(world.box_of(good)->center == glm::dvec3(0.0));
        CHECK(!world.raycast({{kNan, 0.0, 0.0}, {1.0, 0.0, 0.0}}));
        Vector<ObjectRef> found;
        for (const double number : {kNan, kInfinity, -1.0}) {
            world.overlap(Sphere{{}, number}, found);
            CHECK(found.empty());
            CHECK(!world.closest(Sphere{{}, number}, 1.0));
            CHECK(!world.closest(Sphere{{0.0, 5.0, 0.0}, 1.0}, number == kInfinity ? kNan : number));
        }
        CHECK(world.closest(Sphere{{0.0, 5.0, 0.0}, 1.0}, kInfinity)->distance == doctest::Approx(3.5));
    }

    TEST_CASE("of many boxes the bad ones are refused, the first is named, and the others move") {
        World world;
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 6; ++i) objects.push_back(world.add({.bound = box_at({3.0 * i, 0.0, 0.0})}).value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(objects[4]).has_value());
        std::vector<Obb> boxes;
        for (int i = 0; i < 6; ++i) boxes.push_back(box_at({3.0 * i, 7.0, 0.0}));
        boxes[2].half_extents.y = -1.0f;
        const auto moved = world.set_bounds(objects, boxes);
        REQUIRE_FALSE(moved.has_value());
        CHECK(moved.error().item == 2);
        CHECK(oracle::code_of(moved) == ErrorCode::invalid_argument);
        boxes[2].half_extents.y = 1.0f;
        CHECK(world.set_bounds(objects, boxes).error().item == 4);
        CHECK(world.set_bounds(objects, boxes).error().code == ErrorCode::stale_handle);
        CHECK(oracle::code_of(world.set_bounds(objects, std::vector<Obb>(2))) == ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        for (const int i : {0, 1, 2, 3, 5}) CHECK(world.box_of(objects[std::size_t(i)])->center.y == 7.0);
    }

    TEST_CASE("members of the caller's own structs are read in place") {
        struct Thing {
            std::string name;
            ObjectHandle handle;
            Obb box;
        };
        World world;
        std::vector<Thing> things(5);
        for (Thing& thing : things) thing.handle = world.add({.bound = box_at({})}).value();
        for (std::size_t i = 0; i < 5; ++i) things[i].box = box_at({0.0, double(i), 0.0});
        REQUIRE(
            world.set_bounds({&things[0].handle, 5, sizeof(Thing)}, {&things[0].box, 5, sizeof(Thing)}).has_value());
        REQUIRE(world.update().has_value());
        for (const Thing& thing : things) CHECK(world.box_of(thing.handle)->center == thing.box.center);
    }

    TEST_CASE("a handle is stale from the removal on, also when its index is used again") {
        World world;
        const auto first = world.add({.bound = box_at({}), .user = 1}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(first).has_value());
        CHECK(!world.raycast({{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}}));
        for (int update = 0; update < 2; ++update) {
            CHECK(!world.contains(first));
            CHECK(world.remove(first).error().code == ErrorCode::stale_handle);
            CHECK(world.set_bound(first, box_at({})).error().code == ErrorCode::stale_handle);
            CHECK(world.set_hidden(first, true).error().code == ErrorCode::stale_handle);
            CHECK(world.set_layers(first, 1).error().code == ErrorCode::stale_handle);
            CHECK(world.set_collides_with(first, 1).error().code == ErrorCode::stale_handle);
            CHECK(world.set_user(first, 1).error().code == ErrorCode::stale_handle);
            CHECK(world.user_of(first).error().code == ErrorCode::stale_handle);
            CHECK(world.box_of(first).error().code == ErrorCode::stale_handle);
            CHECK(world.remove(ObjectHandle{first.index, first.generation + 7}).error().code ==
                  ErrorCode::stale_handle);
            REQUIRE(world.update().has_value());
        }
        const auto second = world.add({.bound = box_at({}), .user = 2}).value();
        CHECK(second.index == first.index);
        CHECK(second != first);
        CHECK(!world.contains(first));
        CHECK(world.user_of(second).value() == 2);
        CHECK(world.box_of(second).error().code == ErrorCode::empty);
    }

    TEST_CASE("an object removed before its first update was never there") {
        World world;
        const auto object = world.add({.bound = box_at({})}).value();
        REQUIRE(world.remove(object).has_value());
        REQUIRE(world.update().has_value());
        CHECK(!world.raycast({{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}}));
        CHECK(world.add({.bound = box_at({})})->index == object.index);
    }

    TEST_CASE("what moves in a row leaves the tree, and what has rested goes back") {
        World world({.updates_to_rest = 5});
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 100; ++i) objects.push_back(world.add({.bound = box_at({3.0 * i, 0.0, 0.0})}).value());
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().resting == 100);
        CHECK(world.statistics().tree_built);
        const auto move = [&](double y) {
            REQUIRE(world.set_bound(objects[0], box_at({0.0, y, 0.0})).has_value());
            REQUIRE(world.update().has_value());
        };
        move(1.0);
        CHECK(world.statistics().moving == 0);  // once is no habit
        REQUIRE(world.update().has_value());
        move(2.0);
        CHECK(world.statistics().moving == 0);
        move(3.0);
        CHECK(world.statistics().moving == 1);
        CHECK(world.statistics().resting == 99);
        for (int i = 0; i < 4; ++i) move(3.0);  // to where it is
        CHECK(world.statistics().moving == 1);
        CHECK(world.statistics().boxes_changed == 0);
        move(3.0);
        CHECK(world.statistics().moving == 0);
        CHECK(world.statistics().resting == 100);
        CHECK(world.box_of(objects[0])->center.y == 3.0);
        const auto late = world.add({.bound = box_at({0.0, 0.0, 50.0})}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.statistics().moving == 1);
        CHECK(!world.statistics().tree_built);
        for (int i = 0; i < 5; ++i) REQUIRE(world.update().has_value());
        CHECK(world.statistics().moving == 0);
        CHECK(world.statistics().resting == 101);
        CHECK(world.raycast({{0.0, 0.0, 60.0}, {0.0, 0.0, -1.0}})->object == late);
    }

    TEST_CASE("contacts begin, stay and end, with their normal, depth and points") {
        World world;
        const auto box = world.add({.bound = box_at({}), .user = 10}).value();
        const auto ball = world.add({.bound = Sphere{{3.0, 0.0, 0.0}, 1.0}, .user = 20}).value();
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().empty());
        REQUIRE(world.set_bound(ball, Sphere{{1.25, 0.0, 0.0}, 1.0}).has_value());
        double far = 0.0;
        for (const ContactPhase phase : {ContactPhase::began, ContactPhase::stayed, ContactPhase::stayed}) {
            REQUIRE(world.update().has_value());
            REQUIRE(world.contacts().size() == 1);
            const Contact& contact = world.contacts()[0];
            CHECK(contact.phase == phase);
            CHECK(contact.first.object == box);
            CHECK(contact.second.object == ball);
            CHECK(contact.first.user == 10);
            CHECK(contact.second.user == 20);
            CHECK(contact.depth == doctest::Approx(0.25));
            CHECK(contact.normal.x == doctest::Approx(1.0));
            REQUIRE(contact.points.size() == 1);
            CHECK(contact.points[0].position.x == doctest::Approx(0.375));
            if (phase == ContactPhase::stayed)  // as of an update in which something else moved, too
                REQUIRE(world.add({.bound = box_at({far += 50.0, 0.0, 0.0})}).has_value());
        }
        REQUIRE(world.remove(ball).has_value());
        const auto third = world.add({.bound = box_at({0.0, 0.75, 0.0}), .user = 30}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 2);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
        CHECK(world.contacts()[0].second.object == ball);
        CHECK(world.contacts()[0].second.user == 20);
        CHECK(world.contacts()[0].points.empty());
        CHECK(world.contacts()[1].phase == ContactPhase::began);
        CHECK(world.contacts()[1].second.object == third);
        CHECK(world.contacts()[1].points.size() == 4);
        REQUIRE(world.update().has_value());
        CHECK(world.contacts().size() == 1);
        REQUIRE(world.set_hidden(box, true).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::ended);
    }

    TEST_CASE("an index that is used again in the same frame ends one contact and begins another") {
        World world;
        REQUIRE(world.add({.bound = box_at({})}).has_value());
        const auto old = world.add({.bound = box_at({0.5, 0.0, 0.0})}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.remove(old).has_value());
        REQUIRE(world.update().has_value());
        const auto fresh = world.add({.bound = box_at({0.5, 0.0, 0.0})}).value();
        CHECK(fresh.index == old.index);
        REQUIRE(world.update().has_value());
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].phase == ContactPhase::began);
        CHECK(world.contacts()[0].second.object == fresh);
    }

    TEST_CASE("more pairs than allowed are an error, the views are right all the same, and fewer are found again") {
        World world({.max_pairs = 10});
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 10; ++i) objects.push_back(world.add({.bound = box_at({0.1 * i, 0.0, 0.0})}).value());
        CHECK(world.update().error().code == ErrorCode::budget_exceeded);
        CHECK(world.pairs().empty());
        CHECK(world.contacts().empty());
        VisibleObjects visible;
        Camera camera;
        camera.position.z = 10.0;
        REQUIRE(world.view(camera, visible).has_value());
        CHECK(visible.size() == 10);
        CHECK_FALSE(world.update().has_value());
        for (int i = 4; i < 10; ++i) REQUIRE(world.remove(objects[std::size_t(i)]).has_value());
        REQUIRE(world.update().has_value());
        CHECK(world.pairs().size() == 6);
    }

    TEST_CASE("answers are those of a plain list, whatever was added, moved, hidden, removed") {
        NearMisses random(11);
        for (const std::uint32_t rest : {1u, 6u}) {
            World world({.rebuild_budget = 60, .updates_to_rest = rest});
            Model model;
            std::size_t rested = 0, moved = 0;
            for (int frame = 0; frame < 120; ++frame) {
                const unsigned changes = frame % 40 == 0 ? 150 : random.index(12);
                for (unsigned change = 0; change < changes; ++change) {
                    const unsigned kind = random.index(frame % 40 == 0 ? 2u : 12u);
                    auto known = model.objects.begin();
                    if (!model.objects.empty())
                        std::advance(known, random.index(static_cast<unsigned>(model.objects.size())));
                    if (kind < 2 || model.objects.empty()) {
                        oracle::ModelObject object;
                        object.bound = random_bound(random, 25.0);
                        object.user = random.index(1u << 30);
                        object.layers = 1u << random.index(4) | 1u << random.index(4);
                        object.collides_with = random.index(2) ? ~0u : 1u << random.index(4);
                        object.handle = world
                                            .add({.bound = object.bound,
                                                  .user = object.user,
                                                  .layers = object.layers,
                                                  .collides_with = object.collides_with})
                                            .value();
                        CHECK(!model.objects.contains(object.handle.index));
                        model.objects[object.handle.index] = object;
                        continue;
                    }
                    oracle::ModelObject& object = known->second;
                    if (kind == 2) {
                        object.hidden = random.index(3) == 0;
                        REQUIRE(world.set_hidden(object.handle, object.hidden).has_value());
                    } else if (kind == 3) {
                        object.layers = 1u << random.index(4);
                        REQUIRE(world.set_layers(object.handle, object.layers).has_value());
                    } else if (kind == 4) {
                        object.collides_with = random.index(2) ? 3u : 0u;
                        REQUIRE(world.set_collides_with(object.handle, object.collides_with).has_value());
                    } else if (kind == 5) {
                        object.user = random.index(1u << 30);
                        REQUIRE(world.set_user(object.handle, object.user).has_value());
                    } else if (kind == 6) {
                        REQUIRE(world.remove(object.handle).has_value());
                        model.objects.erase(known);
                    } else {
                        object.bound = random_bound(random, 25.0);
                        REQUIRE(world.set_bound(object.handle, object.bound).has_value());
                    }
                }
                // A few move in every frame.
                for (auto& [id, object] : model.objects) {
                    if (id % 5 != 0) continue;
                    object.bound.box.center += 0.2 * random.direction();
                    REQUIRE(world.set_bound(object.handle, object.bound).has_value());
                }
                REQUIRE(world.update().has_value());
                rested += world.statistics().resting;
                moved += world.statistics().moving;
                CHECK(world.object_count() == model.objects.size());
                check_answers(world, model, random);
            }
            CHECK(rested > 1000);
            CHECK(moved > 1000);
        }
    }

    TEST_CASE("the same bits with any number of threads") {
        ThreadPool pool(3);
        World serial, parallel;
        NearMisses random(12);
        std::vector<ObjectHandle> objects;
        std::vector<Obb> boxes;
        for (int i = 0; i < 3000; ++i) {
            boxes.push_back(oracle::random_box(random, {}, 40.0));
            boxes.back().half_extents *= 6.0f;
            objects.push_back(serial.add({.bound = boxes.back()}).value());
            CHECK(parallel.add({.bound = boxes.back()}).value() == objects.back());
        }
        for (int frame = 0; frame < 5; ++frame) {
            for (std::size_t i = 0; i < boxes.size(); i += 3) boxes[i].center += 0.1 * random.direction();
            REQUIRE(serial.set_bounds(objects, boxes).has_value());
            REQUIRE(parallel.set_bounds(objects, boxes).has_value());
            REQUIRE(serial.update().has_value());
            REQUIRE(parallel.update(pool).has_value());
            CHECK(serial.contacts().size() > 500);
            CHECK(std::ranges::equal(serial.contacts(), parallel.contacts(), [](const Contact& a, const Contact& b) {
                return a.first.object == b.first.object && a.second.object == b.second.object && a.phase == b.phase &&
                       a.normal == b.normal && a.depth == b.depth &&
                       std::ranges::equal(a.points, b.points, [](const auto& p, const auto& q) {
                           return p.position == q.position && p.depth == q.depth;
                       });
            }));
            VisibleObjects a, b;
            const cull::View view = random_view(random);
            serial.view(view, a);
            parallel.view(view, b, {}, pool);
            CHECK(std::ranges::equal(a.ids(), b.ids()));
        }
    }

    TEST_CASE("a warm world allocates nothing, neither through the memory hook nor past it") {
        testing::CountingMemory memory;
        {
            World world({.rebuild_budget = 0});
            NearMisses random(13);
            std::vector<ObjectHandle> objects;
            std::vector<Obb> boxes;
            for (int i = 0; i < 2000; ++i) {
                boxes.push_back(oracle::random_box(random, {}, 40.0));
                boxes.back().half_extents *= 6.0f;
                objects.push_back(world.add({.bound = boxes.back()}).value());
            }
            VisibleObjects visible;
            VisibleInViews in_views;
            Vector<ObjectHit> hits;
            Vector<ObjectRef> found;
            std::array<cull::View, 2> views{random_view(random), random_view(random)};
            const auto frame = [&](double shift) {
                for (std::size_t i = 0; i < boxes.size(); i += 3) boxes[i].center.x += shift;
                REQUIRE(world.set_bounds(objects, boxes).has_value());
                REQUIRE(world.update().has_value());
                world.view(views[0], visible);
                world.view(views, in_views);
                const Ray ray{{-90.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
                world.raycast_all(ray, hits);
                CHECK(world.raycast(ray).has_value());
                CHECK(world.raycast_any(ray));
                world.overlap(Sphere{{}, 50.0}, found);
                CHECK(world.closest(Sphere{{}, 1.0}, 50.0).has_value());
            };
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            const std::size_t before = memory.allocations(), news = testing::operator_news();
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            CHECK(memory.allocations() == before);
            CHECK(testing::operator_news() == news);
            CHECK(world.contacts().size() > 100);
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("indices, memory and the cost of queries stay as after loading, however many come and go") {
        testing::CountingMemory memory;
        {
            World world;
            NearMisses random(14);
            std::vector<ObjectHandle> live;
            const auto spawn = [&] {
                live.push_back(world.add({.bound = oracle::random_box(random, {}, 200.0), .collides_with = 0}).value());
            };
            for (int i = 0; i < 3000; ++i) spawn();
            REQUIRE(world.update().has_value());
            std::size_t most = 0, first = 0;
            for (int frame = 0; frame < 1500; ++frame) {
                for (int i = 0; i < 40; ++i) {
                    std::swap(live[random.index(static_cast<unsigned>(live.size()))], live.back());
                    REQUIRE(world.remove(live.back()).has_value());
                    live.pop_back();
                }
                REQUIRE(world.update().has_value());
                for (int i = 0; i < 40; ++i) spawn();
                if (frame < 300) first = std::max(first, memory.bytes_in_use());
                most = std::max(most, memory.bytes_in_use());
            }
            CHECK(most <= first + first / 5);
            std::uint32_t largest = 0;
            for (const ObjectHandle& handle : live) largest = std::max(largest, handle.index);
            CHECK(largest < 3000);
            for (int i = 0; i < 100; ++i) REQUIRE(world.update().has_value());
            World fresh;
            for (const ObjectHandle& handle : live)
                REQUIRE(fresh.add({.bound = world.box_of(handle).value()}).has_value());
            REQUIRE(fresh.update().has_value());
            VisibleObjects visible;
            std::uint64_t tested = 0, tested_fresh = 0;
            for (int i = 0; i < 100; ++i) {
                const cull::View view = random_view(random);
                world.view({.frustum = view.frustum}, visible);
                tested += visible.statistics().nodes_tested + visible.statistics().boxes_tested;
                const std::size_t seen = visible.size();
                fresh.view({.frustum = view.frustum}, visible);
                tested_fresh += visible.statistics().nodes_tested + visible.statistics().boxes_tested;
                CHECK(visible.size() == seen);
            }
            CHECK(tested_fresh > 1000);
            CHECK(tested <= tested_fresh + tested_fresh / 10);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
