// SPDX-License-Identifier: MIT
// Rays, overlaps and nearest objects among many objects that move: as if each were looked at.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <oracle/random_boxes.hpp>
#include <thread>
#include <vector>

#include "model.hpp"

using namespace crofton;
using oracle::Model;
using oracle::NearMisses;

namespace {

std::vector<std::uint32_t> ids_of(const Vector<ObjectRef>& found) {
    std::vector<std::uint32_t> ids;
    for (const ObjectRef& object : found) ids.push_back(object.object.index);
    return ids;
}

// On a grid of halves: boxes touch, and rays pass along their faces.
Bound bound_on_grid(NearMisses& random, double place) {
    const auto number = [&] { return 0.5 * std::floor(random.number(-2.0 * place, 2.0 * place)); };
    Obb box;
    box.center = {number(), number(), number()};
    box.half_extents = 0.5f * glm::vec3(1 + random.index(3), 1 + random.index(3), 1 + random.index(3));
    if (random.index(3) == 0) return Sphere{box.center, 0.5 * (1 + random.index(3))};
    if (random.index(4) == 0) return oracle::random_box(random, box.center, 1.0);
    return box;
}

Ray ray_on_grid(NearMisses& random, double place) {
    const auto number = [&] { return 0.5 * std::floor(random.number(-2.0 * place, 2.0 * place)); };
    Ray ray{{number(), number(), number()}, {number(), number(), number()}};
    for (int i = 0; i < 3; ++i)
        if (random.index(2) == 0) ray.direction[i] = 0.0;
    if (ray.direction == glm::dvec3(0.0)) ray.direction[static_cast<int>(random.index(3))] = -1.0;
    if (random.index(3) == 0) ray.max_t = 0.5 * random.index(8);
    return ray;
}

void check_queries(const World& world, const Model& model, NearMisses& random, double place) {
    Vector<ObjectHit> hits;
    Vector<ObjectRef> found;
    const std::uint32_t layers = random.index(2) ? ~0u : 1u << random.index(3);
    const Ray ray = ray_on_grid(random, place);
    const auto along = model.along(ray, layers);
    world.raycast_all(ray, hits, {layers});
    REQUIRE(hits.size() == along.size());
    for (std::size_t i = 0; i < hits.size(); ++i) CHECK(hits[i].t == doctest::Approx(along[i].first).epsilon(1e-9));
    CHECK(world.raycast_any(ray, {layers}) == !along.empty());
    const auto nearest = world.raycast(ray, {layers});
    REQUIRE(nearest.has_value() == !along.empty());
    if (nearest) CHECK(nearest->object == hits[0].object);

    const Bound probe = bound_on_grid(random, place);
    const auto expected = model.overlapping(probe.box, layers);
    world.overlap(probe.box, found, {layers});
    CHECK(ids_of(found) == expected);
    const Sphere sphere{probe.box.center, 0.5 * random.index(6)};
    world.overlap(sphere, found, {layers});
    CHECK(ids_of(found) == model.overlapping(sphere, layers));
    for (const double limit : {0.5, 1e3, 1e300}) {
        const double least = model.distance_to(probe.box, layers);
        const auto closest = world.closest(probe.box, limit, {layers});
        REQUIRE(closest.has_value() == (least <= limit));
        if (closest) CHECK(closest->distance == doctest::Approx(least).epsilon(1e-9));
    }
}

}  // namespace

TEST_SUITE("world/moving queries") {
    TEST_CASE("among hundreds that move, come and go, queries find what a look at each finds, touching or far away") {
        for (const double far : {0.0, 1e6}) {
            NearMisses random(61);
            World world({.pairs = false}), pairs;
            Model model;
            std::map<std::uint32_t, ObjectHandle> in_pairs;  // the same objects' handles there
            for (int frame = 0; frame < 150; ++frame) {
                CAPTURE(frame);
                const double place = frame < 75 ? 12.0 : 5.0;
                const auto random_bound = [&] {
                    Bound bound = bound_on_grid(random, place);
                    if (random.index(40) == 0 && far > 0.0) bound.box.center.x += far;
                    return bound;
                };
                while (model.objects.size() < (frame < 50 ? 500u : 150u)) {
                    oracle::ModelObject object;
                    object.bound = random_bound();
                    object.layers = 1u << random.index(3);
                    object.handle = world.add({.bound = object.bound, .layers = object.layers}).value();
                    const auto other = pairs.add({.bound = object.bound, .layers = object.layers}).value();
                    REQUIRE(other.index == object.handle.index);
                    in_pairs[other.index] = other;
                    model.objects[object.handle.index] = object;
                }
                for (unsigned n = frame == 50 ? 350 : random.index(6); n > 0; --n) {
                    auto known = model.objects.begin();
                    std::advance(known, random.index(static_cast<unsigned>(model.objects.size())));
                    REQUIRE(world.remove(known->second.handle).has_value());
                    REQUIRE(pairs.remove(in_pairs.at(known->first)).has_value());
                    model.objects.erase(known);
                }
                for (auto& [id, object] : model.objects) {
                    if (id % 5 == 0 && frame % 20 != 0) continue;
                    if (random.index(30) == 0)
                        object.bound = random_bound();
                    else
                        object.bound.box.center[static_cast<int>(random.index(3))] += random.index(2) ? 0.5 : -0.5;
                    REQUIRE(world.set_bound(object.handle, object.bound).has_value());
                    REQUIRE(pairs.set_bound(in_pairs.at(id), object.bound).has_value());
                }
                REQUIRE(world.update().has_value());
                REQUIRE(pairs.update().has_value());
                if (frame % 3 == 2) continue;  // not asked
                for (int query = 0; query < 12; ++query) check_queries(world, model, random, place);
                check_queries(pairs, model, random, place);
                if (frame > 5) CHECK(world.statistics().moving > 64);
            }
        }
    }

    TEST_CASE("a shape that is cast hits the same among what moves as among the same objects at rest") {
        NearMisses random(62);
        World moving({.pairs = false}), resting({.pairs = false});
        std::vector<ObjectHandle> objects;
        std::vector<Bound> bounds;
        for (int i = 0; i < 400; ++i) {
            bounds.push_back(bound_on_grid(random, 12.0));
            objects.push_back(moving.add({.bound = bounds.back()}).value());
            CHECK(resting.add({.bound = bounds.back()}).value().index == objects.back().index);
        }
        for (int frame = 0; frame < 4; ++frame) {
            for (std::size_t i = 0; i < objects.size(); ++i) {
                Bound bound = bounds[i];
                if (frame < 3) bound.box.center += 0.1 * random.direction();
                REQUIRE(moving.set_bound(objects[i], bound).has_value());
            }
            REQUIRE(moving.update().has_value());
            REQUIRE(resting.update().has_value());
        }
        REQUIRE(moving.statistics().moving == 400);
        const auto shape = convex::Shape::box(glm::vec3(0.4f, 0.3f, 0.2f)).value();
        std::size_t hits = 0;
        for (int n = 0; n < 300; ++n) {
            const RigidTransform pose{glm::dmat3(1.0), 14.0 * random.direction()};
            const convex::Motion motion{.velocity = -2.0 * pose.translation};
            const auto a = moving.cast(shape, pose, motion, {}).value(),
                       b = resting.cast(shape, pose, motion, {}).value();
            REQUIRE(a.has_value() == b.has_value());
            if (!a) continue;
            ++hits;
            CHECK(a->time == doctest::Approx(b->time).epsilon(1e-6));
        }
        CHECK(hits > 200);
    }

    TEST_CASE("a shape that flies far, turning or not, hits first what a cast at each object alone hits first") {
        NearMisses random(64);
        for (const double place : {0.0, 1e6}) {
            World world({.pairs = false});
            std::vector<ObjectHandle> objects;
            std::vector<Bound> bounds;
            for (int i = 0; i < 600; ++i) {
                bounds.push_back(bound_on_grid(random, 40.0));
                bounds.back().box.center.x += place;
                objects.push_back(world.add({.bound = bounds.back()}).value());
            }
            for (int frame = 0; frame < 3; ++frame) {
                for (std::size_t i = 0; i < objects.size(); i += 3) {
                    bounds[i].box.center.y += 0.125;
                    REQUIRE(world.set_bound(objects[i], bounds[i]).has_value());
                }
                REQUIRE(world.update().has_value());
            }
            REQUIRE(world.statistics().moving == 200);
            const auto cast_at = [&](std::size_t i, const convex::ShapeAtPose& probe, const convex::Motion& motion,
                                     const convex::CastOptions& options) {
                const Obb& box = bounds[i].box;
                const auto shape = bounds[i].kind == BoundKind::sphere ? convex::Shape::sphere(bounds[i].radius)
                                                                       : convex::Shape::box(box.half_extents);
                return convex::cast(probe, motion, {*shape, {glm::dmat3(box.axes), box.center}}, {}, options).value();
            };
            const auto shape = convex::Shape::box(glm::vec3(0.8f, 0.3f, 0.2f)).value();
            std::size_t hits = 0, misses = 0;
            Vector<ShapeHit> all;
            for (int n = 0; n < 200; ++n) {
                RigidTransform pose{glm::dmat3(1.0), 45.0 * random.direction()};
                convex::Motion motion{.velocity = -std::exp(random.number(-4.0, 4.0)) * pose.translation};
                if (n % 4 == 0) motion.velocity = {0.0, random.number(-90.0, 90.0), 0.0};
                if (n % 3 == 0) motion.spin = 0.3 * random.direction(), motion.pivot = {0.5, 0.0, 0.0};
                pose.translation.x += place;
                convex::CastOptions options{.duration = 90.0 / glm::length(motion.velocity)};
                options.early_out = n % 5 == 0 ? 0.3 * options.duration : options.duration;
                std::optional<double> first;
                std::size_t met = 0;
                for (std::size_t i = 0; i < objects.size(); ++i) {
                    const convex::Impact impact = cast_at(i, {shape, pose}, motion, options);
                    if (impact.result == convex::CastResult::miss) continue;
                    ++met;
                    first = std::min(first.value_or(impact.time), impact.time);
                }
                const auto hit = world.cast(shape, pose, motion, options).value();
                REQUIRE(hit.has_value() == first.has_value());
                if (hit) CHECK(std::abs(hit->time - *first) * glm::length(motion.velocity) < 1e-5);
                (hit ? hits : misses) += 1;
                REQUIRE(world.cast_all(shape, pose, motion, options, all).has_value());
                CHECK(all.size() == met);
            }
            CHECK(hits > 50);
            CHECK(misses > 10);
        }
    }

    TEST_CASE("many threads may query after an update, each with the answers of a single thread") {
        NearMisses random(63);
        World world({.pairs = false});
        std::vector<ObjectHandle> objects;
        std::vector<Bound> bounds;
        for (int i = 0; i < 1000; ++i) {
            bounds.push_back(bound_on_grid(random, 15.0));
            objects.push_back(world.add({.bound = bounds.back()}).value());
        }
        for (int frame = 0; frame < 10; ++frame) {
            for (std::size_t i = 0; i < objects.size(); ++i) {
                bounds[i].box.center.y += 0.01;
                REQUIRE(world.set_bound(objects[i], bounds[i]).has_value());
            }
            REQUIRE(world.update().has_value());
            const Ray ray = ray_on_grid(random, 15.0);
            std::vector<Vector<ObjectHit>> hits(4);
            std::vector<std::thread> threads;
            for (auto& list : hits) threads.emplace_back([&] { world.raycast_all(ray, list); });
            for (std::thread& thread : threads) thread.join();
            for (const auto& list : hits) {
                REQUIRE(list.size() == hits[0].size());
                for (std::size_t i = 0; i < list.size(); ++i) {
                    CHECK(list[i].object == hits[0][i].object);
                    CHECK(list[i].t == hits[0][i].t);
                }
            }
        }
    }
}
