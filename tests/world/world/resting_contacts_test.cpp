// SPDX-License-Identifier: MIT
// Contacts of shapes of which few move: what is not computed anew is as if it were.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <optional>
#include <random>
#include <vector>

#include "new_counter.hpp"

using namespace crofton;

namespace {

// The same crates in two Worlds. In the second each shape is set again before each update, so that all is computed.
class Heaps {
  public:
    // On a slab, so many crates wide that it meets a crowd, or in the air.
    Heaps(std::uint64_t seed, bool on_slab) : random_(seed), wide_(on_slab ? 9 : 5), high_(on_slab ? 2 : 4) {
        (void)offset();
        Obb box;
        box.center = {4.0, -1.0 + 1e-4, 4.0};
        box.half_extents = {6.0f, 0.5f, 6.0f};
        if (on_slab) add(box, slab_);
    }

    int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
    // A place of a grid on which crates touch exactly, or a little off it.
    Obb place() {
        Obb box;
        box.half_extents = glm::vec3(0.5f);
        box.center = glm::dvec3(index(wide_), index(high_), index(wide_));
        if (index(3) == 0)
            for (int k = 0; k < 3; ++k) box.center[k] += std::uniform_real_distribution<double>(-1e-3, 1e-3)(random_);
        return box;
    }
    void add() { add(place(), crate_); }
    void add(const Obb& box, const convex::Shape& shape) {
        const std::uint64_t user = random_();
        for (World* const world : {&few, &all}) {
            const ObjectHandle object = world->add({.bound = box, .user = user}).value();
            REQUIRE(world->set_shape(object, &shape).has_value());
            if (world == &few && &shape == &slab_) slab = object;
            if (world == &few && &shape == &crate_) objects.push_back(object);
        }
    }
    void remove(std::size_t which) {
        for (World* const world : {&few, &all}) REQUIRE(world->remove(in(*world, objects[which])).has_value());
        objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(which));
    }
    void change() {
        const std::size_t which = static_cast<std::size_t>(index(static_cast<int>(objects.size())));
        const Obb box = place();
        const std::uint64_t user = random_();
        const int what = index(8);
        const std::uint32_t layers = index(2) == 0 ? 0u : ~0u;
        if (what == 0) return remove(which);
        if (what == 1) return add();
        for (World* const world : {&few, &all}) {
            const ObjectHandle object = in(*world, objects[which]);
            if (what == 2) REQUIRE(world->set_user(object, user).has_value());
            if (what == 3) REQUIRE(world->set_shape(object, layers == 0 ? nullptr : &crate_).has_value());
            if (what == 4) REQUIRE(world->set_collides_with(object, layers).has_value());
            if (what >= 5) REQUIRE(world->set_bound(object, box).has_value());
        }
        if (what == 3) bare_[objects[which].index] = layers == 0;
    }
    void update() {
        for (const ObjectHandle object : objects)
            if (!bare_[object.index]) REQUIRE(all.set_shape(in(all, object), &crate_).has_value());
        if (slab) REQUIRE(all.set_shape(in(all, *slab), &slab_).has_value());
        REQUIRE(few.update().has_value());
        REQUIRE(all.update().has_value());
    }
    // Handles of the two Worlds differ by where their generations begin.
    ObjectHandle in(World& world, ObjectHandle object) {
        if (&world == &few) return object;
        ObjectHandle other = object;
        other.generation += offset();
        return other;
    }
    std::uint32_t offset() {
        if (offset_ == 0) {
            const ObjectHandle a = few.add({.bound = Sphere{{1e6, 0, 0}, 1.0}}).value(),
                               b = all.add({.bound = Sphere{{1e6, 0, 0}, 1.0}}).value();
            offset_ = b.generation - a.generation;
        }
        return offset_;
    }

    World few, all;
    std::vector<ObjectHandle> objects;
    std::optional<ObjectHandle> slab;

  private:
    std::mt19937_64 random_;
    int wide_, high_;
    convex::Shape slab_ = convex::Shape::box({6.0f, 0.5f, 6.0f}).value();
    convex::Shape crate_ = convex::Shape::box(glm::vec3(0.5f)).value();
    std::uint32_t offset_ = 0;
    bool bare_[4096] = {};
};

}  // namespace

TEST_SUITE("world/resting_contacts") {
    TEST_CASE("while few crates of a heap move, come and go, all contacts are as if each were computed again") {
        std::size_t contacts = 0, computed_few = 0, computed_all = 0, ended = 0, deep = 0;
        std::size_t most_on_slab = 0;
        for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
            const bool on_slab = seed > 2;
            Heaps heaps(seed, on_slab);
            for (int i = 0; i < (on_slab ? 150 : 60); ++i) heaps.add();
            for (int frame = 0; frame < (on_slab ? 60 : 150); ++frame) {
                CAPTURE(seed);
                CAPTURE(frame);
                for (int n = heaps.index(3); n > 0; --n) heaps.change();
                heaps.update();
                computed_few += heaps.few.statistics().shape_pairs_computed;
                computed_all += heaps.all.statistics().shape_pairs_computed;
                const auto few = heaps.few.contacts(), all = heaps.all.contacts();
                REQUIRE(few.size() == all.size());
                for (std::size_t i = 0; i < few.size(); ++i) {
                    const Contact &a = few[i], &b = all[i];
                    CHECK(heaps.in(heaps.all, a.first.object) == b.first.object);
                    CHECK(heaps.in(heaps.all, a.second.object) == b.second.object);
                    CHECK(a.first.user == b.first.user);
                    CHECK(a.second.user == b.second.user);
                    CHECK(a.phase == b.phase);
                    REQUIRE(a.shape_points.size() == b.shape_points.size());
                    REQUIRE(a.points.size() == b.points.size());  // of crates without shapes
                    CHECK(a.depth == doctest::Approx(b.depth).epsilon(1e-12));
                    CHECK((!a.shape_points.empty() || !a.points.empty()) == (a.phase != ContactPhase::ended));
                    ended += a.phase == ContactPhase::ended;
                    double most = 0.0;
                    for (std::size_t k = 0; k < a.shape_points.size(); ++k) {
                        const convex::TrackedPoint &p = a.shape_points[k], &q = b.shape_points[k];
                        CHECK(glm::distance(p.normal, q.normal) < 1e-12);
                        CHECK(glm::distance(p.contact.position, q.contact.position) < 1e-12);
                        CHECK(std::abs(p.contact.depth - q.contact.depth) < 1e-12);
                        CHECK(p.began == q.began);
                        most = std::max(most, std::abs(p.contact.depth));
                    }
                    deep += most > 1e-5;
                }
                contacts += few.size();
                most_on_slab = std::max<std::size_t>(
                    most_on_slab, static_cast<std::size_t>(std::count_if(few.begin(), few.end(), [&](const auto& c) {
                        return heaps.slab && (c.first.object == *heaps.slab || c.second.object == *heaps.slab);
                    })));
            }
        }
        MESSAGE(contacts, " contacts, ", ended, " ended, ", deep, " deep; computed ", computed_few, " of ",
                computed_all);
        CHECK(ended > 100);
        CHECK(deep > 1000);
        CHECK(most_on_slab > 64);
        CHECK(2 * computed_few < computed_all);
    }

    TEST_CASE("a stack that rests costs one crate's mover its own pairs, and allocates nothing once warm") {
        testing::CountingMemory memory;
        {
            World world;
            const convex::Shape crate = convex::Shape::box(glm::vec3(0.5f)).value();
            std::vector<ObjectHandle> objects;
            std::vector<Obb> boxes;
            for (int i = 0; i < 8 * 8 * 8; ++i) {
                Obb box;
                box.half_extents = glm::vec3(0.5f);
                box.center = glm::dvec3(i % 8, i / 8 % 8, i / 64);
                boxes.push_back(box);
                objects.push_back(world.add({.bound = box}).value());
                REQUIRE(world.set_shape(objects.back(), &crate).has_value());
            }
            for (int i = 0; i < 10; ++i) REQUIRE(world.update().has_value());
            CHECK(world.contacts().size() == (22 * 22 * 22 - 512) / 2);
            CHECK(world.statistics().shape_pairs_computed == 0);
            // In and out of the layer on top. Lists of pairs that nobody asks for gather changes for 100 updates.
            const std::size_t which = 3 + 8 * 7 + 64 * 3;
            const auto move = [&](int frame) {
                Obb moved = boxes[which];
                moved.center.y += frame % 2 != 0 ? 0.25 : 0.0;
                REQUIRE(world.set_bound(objects[which], moved).has_value());
                REQUIRE(world.update().has_value());
            };
            for (int frame = 0; frame < 400; ++frame) move(frame);
            const std::size_t before = memory.allocations(), news = testing::operator_news();
            for (int frame = 0; frame < 20; ++frame) {
                move(frame);
                CHECK(world.statistics().shape_pairs_computed <= 17);
            }
            CHECK(memory.allocations() == before);
            CHECK(testing::operator_news() == news);
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("contacts of shapes and of boxes are one list in order, and reading it allocates nothing once warm") {
        testing::CountingMemory memory;
        {
            World world;
            const convex::Shape crate = convex::Shape::box(glm::vec3(0.5f)).value();
            std::vector<ObjectHandle> objects;
            std::vector<Obb> boxes;
            for (int i = 0; i < 64; ++i) {  // a row; every third is a trigger without a shape
                Obb box;
                box.half_extents = glm::vec3(0.5f);
                box.center = {0.9 * i, 0, 0};
                boxes.push_back(box);
                objects.push_back(world.add({.bound = box}).value());
                if (i % 3 != 0) REQUIRE(world.set_shape(objects.back(), &crate).has_value());
            }
            const auto check = [&](bool apart, bool ended) {
                std::uint32_t place = 0;
                for (const Contact& contact : world.contacts()) {
                    if (place == 31 && apart && !ended) place += 2;
                    REQUIRE(contact.first.object == objects[place]);
                    REQUIRE(contact.second.object == objects[place + 1]);
                    const bool of_shapes = place % 3 == 1, is_over = ended && (place == 31 || place == 32);
                    CHECK((contact.phase == ContactPhase::ended) == is_over);
                    CHECK(contact.shape_points.size() == (of_shapes && !is_over ? 4u : 0u));
                    CHECK(contact.points.size() == (of_shapes || is_over ? 0u : 4u));
                    CHECK(contact.depth == doctest::Approx(is_over ? 0.0 : 0.1));
                    CHECK(contact.normal.x == doctest::Approx(is_over ? 0.0 : 1.0));
                    ++place;
                }
                CHECK(place == 63);
            };
            const auto frames = [&](int count) {
                for (int frame = 0; frame < count; ++frame) {
                    Obb moved = boxes[32];
                    moved.center.y += frame % 8 < 4 ? 5.0 : 0.0;
                    if (frame % 4 == 0) REQUIRE(world.set_bound(objects[32], moved).has_value());
                    REQUIRE(world.update().has_value());
                    check(frame % 8 < 4, frame % 8 == 0);
                }
            };
            REQUIRE(world.update().has_value());
            check(false, false);
            frames(400);
            const std::size_t before = memory.allocations(), news = testing::operator_news();
            frames(80);
            CHECK(memory.allocations() == before);
            CHECK(testing::operator_news() == news);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
