// SPDX-License-Identifier: MIT
// Objects that are bounds alone, added, moved and removed at random: the answers, the bits, the memory.
#include <doctest/doctest.h>
#include <array>
#include <counting_memory.hpp>
#include <oracle/random_boxes.hpp>
#include <set>

#include "../../ranges.hpp"
#include "../../view_request.hpp"
#include "model.hpp"
#include "new_counter.hpp"

using namespace crofton;
using oracle::Model;
using oracle::NearMisses;

namespace {

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
    ViewResult visible;
    std::array<cull::View, 3> views{};
    for (cull::View& view : views) view = random_view(random);
    for (const cull::View& view : views) {
        const auto expected = model.visible(view);
        REQUIRE(world.view(request_of(view), visible).has_value());
        CHECK(std::vector(visible.ids().begin(), visible.ids().end()) == expected);
        REQUIRE(world.view(request_of(view, cull::ResultOrder::tree), visible).has_value());
        std::vector<std::uint32_t> seen(visible.ids().begin(), visible.ids().end());
        std::sort(seen.begin(), seen.end());
        CHECK(seen == expected);
        for (std::size_t i = 0; i < visible.size(); ++i) {
            CHECK(visible[i].object == model.objects.at(visible.ids()[i]).handle);
            CHECK(visible[i].user == model.objects.at(visible.ids()[i]).user);
        }
    }
    MultiViewResult in_views;
    REQUIRE(world.view(requests_of(views), in_views).has_value());
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
        world.raycast_all(ray, hits, {layers});
        REQUIRE(hits.size() == expected.size());
        for (std::size_t i = 0; i < hits.size(); ++i) {
            CHECK(hits[i].t == doctest::Approx(expected[i].first).epsilon(1e-9));
            CHECK(hits[i].user == model.objects.at(hits[i].object.index).user);
            CHECK(glm::length(hits[i].point - (ray.origin + hits[i].t * ray.direction)) == 0.0);
        }
        CHECK(world.raycast_any(ray, {layers}) == !expected.empty());
        const auto nearest = world.raycast(ray, {layers});
        REQUIRE(nearest.has_value() == !expected.empty());
        if (nearest) {
            CHECK(nearest->t == hits[0].t);
            CHECK(nearest->object == hits[0].object);
        }
        const Obb box = oracle::random_box(random, {}, 30.0);
        const Sphere sphere{box.center, random.number(0.0, 8.0)};
        world.overlap(box, found, {layers});
        CHECK(ids_of(found) == model.overlapping(box, layers));
        world.overlap(sphere, found, {layers});
        CHECK(ids_of(found) == model.overlapping(sphere, layers));
        world.overlap(collide::Capsule{sphere.center, sphere.center, sphere.radius}, found, {layers});
        CHECK(ids_of(found) == model.overlapping(sphere, layers));
        for (const double limit : {1.0, 1e3}) {
            const double least = model.distance_to(box, layers);
            const auto closest = world.closest(box, limit, {layers});
            REQUIRE(closest.has_value() == (least <= limit));
            if (!closest) continue;
            CHECK(closest->distance == doctest::Approx(least).epsilon(1e-9));
            CHECK(glm::length(closest->on_object - closest->on_shape) == doctest::Approx(least).epsilon(1e-6));
        }
    }
}

}  // namespace

TEST_SUITE("world/bounds changes") {
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
        std::vector<ObjectHandle> objects, twins;
        std::vector<Obb> boxes;
        for (int i = 0; i < 3000; ++i) {
            boxes.push_back(oracle::random_box(random, {}, 40.0));
            boxes.back().half_extents *= 6.0f;
            objects.push_back(serial.add({.bound = boxes.back()}).value());
            twins.push_back(parallel.add({.bound = boxes.back()}).value());
            CHECK(twins.back().index == objects.back().index);
        }
        for (int frame = 0; frame < 5; ++frame) {
            for (std::size_t i = 0; i < boxes.size(); i += 3) boxes[i].center += 0.1 * random.direction();
            REQUIRE(serial.set_bounds(objects, boxes).has_value());
            REQUIRE(parallel.set_bounds(twins, boxes).has_value());
            REQUIRE(serial.update().has_value());
            REQUIRE(parallel.update(pool).has_value());
            CHECK(serial.contacts().size() > 500);
            CHECK(test::ranges::equal(serial.contacts(), parallel.contacts(), [](const Contact& a, const Contact& b) {
                return a.first.object.index == b.first.object.index && a.second.object.index == b.second.object.index &&
                       a.phase == b.phase && a.normal == b.normal && a.depth == b.depth &&
                       test::ranges::equal(a.points, b.points, [](const auto& p, const auto& q) {
                           return p.position == q.position && p.depth == q.depth;
                       });
            }));
            ViewResult a, b;
            const cull::View view = random_view(random);
            REQUIRE(serial.view(request_of(view), a).has_value());
            REQUIRE(parallel.view(request_of(view), b, pool).has_value());
            CHECK(test::ranges::equal(a.ids(), b.ids()));
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
            ViewResult visible;
            MultiViewResult in_views;
            Vector<ObjectHit> hits;
            Vector<ObjectRef> found;
            std::array<cull::View, 2> views{random_view(random), random_view(random)};
            const auto requests = requests_of(views);
            const auto frame = [&](double shift) {
                for (std::size_t i = 0; i < boxes.size(); i += 3) boxes[i].center.x += shift;
                REQUIRE(world.set_bounds(objects, boxes).has_value());
                REQUIRE(world.update().has_value());
                REQUIRE(world.view(request_of(views[0]), visible).has_value());
                REQUIRE(world.view(requests, in_views).has_value());
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

    // Some of so many objects are replaced in each update. What it leaves behind, against a World that has just been
    // loaded with the same.
    void check_spawns(int live_count, int each_update, int updates) {
        CAPTURE(live_count);
        testing::CountingMemory memory;
        {
            World world;
            NearMisses random(14);
            std::vector<ObjectHandle> live;
            const auto spawn = [&] {
                live.push_back(world.add({.bound = oracle::random_box(random, {}, 200.0), .collides_with = 0}).value());
            };
            for (int i = 0; i < live_count; ++i) spawn();
            REQUIRE(world.update().has_value());
            std::size_t most = 0, first = 0;
            int built = 0;
            for (int frame = 0; frame < updates; ++frame) {
                for (int i = 0; i < each_update; ++i) {
                    std::swap(live[random.index(static_cast<unsigned>(live.size()))], live.back());
                    REQUIRE(world.remove(live.back()).has_value());
                    live.pop_back();
                }
                REQUIRE(world.update().has_value());
                built += world.statistics().tree_built;
                for (int i = 0; i < each_update; ++i) spawn();
                if (frame < updates / 3) first = std::max(first, memory.bytes_in_use());
                most = std::max(most, memory.bytes_in_use());
            }
            CHECK(built == 0);  // the work is spread over updates
            CHECK(most <= first + first / 5);
            std::uint32_t largest = 0;
            for (const ObjectHandle& handle : live) largest = std::max(largest, handle.index);
            CHECK(largest < static_cast<std::uint32_t>(live_count));
            for (int i = 0; i < 100; ++i) REQUIRE(world.update().has_value());
            World fresh;
            for (const ObjectHandle& handle : live)
                REQUIRE(fresh.add({.bound = world.box_of(handle).value()}).has_value());
            REQUIRE(fresh.update().has_value());
            ViewResult visible;
            std::uint64_t tested = 0, tested_fresh = 0;
            for (int i = 0; i < 100; ++i) {
                const cull::View view = random_view(random);
                REQUIRE(world.view({.volume = view.frustum}, visible).has_value());
                tested += visible.statistics().nodes_tested + visible.statistics().boxes_tested;
                const std::size_t seen = visible.size();
                REQUIRE(fresh.view({.volume = view.frustum}, visible).has_value());
                tested_fresh += visible.statistics().nodes_tested + visible.statistics().boxes_tested;
                CHECK(visible.size() == seen);
            }
            CHECK(tested_fresh > 1000);
            // The last that came are in leaves as wide as nodes until the next rebuild.
            CHECK(tested <= tested_fresh + tested_fresh / 7);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
    TEST_CASE("indices, memory and the cost of queries stay as after loading, however many come and go") {
        check_spawns(3000, 40, 1500);
        check_spawns(40000, 400, 50);  // a tree that is rebuilt in the background while little changes
    }
}
