// SPDX-License-Identifier: MIT
// How much memory a world takes, and that what it stores once serves all who read it.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/rebuilder.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <oracle/random_boxes.hpp>
#include <set>
#include <vector>

#include "box_at.hpp"

using namespace crofton;
using oracle::NearMisses;
using testing::box_at;
using testing::CountingMemory;

namespace {

// Bytes an object of a world with so many boxes, few of which touch, after some updates.
double bytes_an_object(std::size_t count, const WorldOptions& options) {
    const CountingMemory memory;
    World world(options);
    NearMisses random(61);
    for (std::size_t i = 0; i < count; ++i)
        REQUIRE(world.add({.bound = oracle::random_box(random, {}, 400.0)}).has_value());
    for (int update = 0; update < 4; ++update) REQUIRE(world.update().has_value());
    return static_cast<double>(memory.bytes_in_use()) / static_cast<double>(count);
}

struct Thing {
    ObjectHandle handle;
    Obb box;
    bool hidden = false;
};

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs pairs_of(const World& world) {
    Pairs pairs;
    for (const ObjectPair& pair : world.pairs()) pairs.insert({pair.first.object.index, pair.second.object.index});
    return pairs;
}

// One after the other; of two things `collide` tells whether they may be a pair.
template <class Collide>
Pairs all_pairs(const std::vector<Thing>& things, Collide collide) {
    Pairs pairs;
    for (std::size_t i = 0; i < things.size(); ++i)
        for (std::size_t j = i + 1; j < things.size(); ++j) {
            const Thing &a = things[i], &b = things[j];
            if (a.hidden || b.hidden || !collide(a, b) || !collide::intersects(a.box, b.box)) continue;
            pairs.insert(std::minmax(a.handle.index, b.handle.index));
        }
    return pairs;
}

// Comes, goes, is hidden, shown and moved at random; from time to time many come at once or all go but a few.
class Crowd {
  public:
    Crowd(World& world, unsigned seed) : world_(world), random_(seed) {}

    void add(std::size_t count) {
        for (; count > 0; --count) {
            Thing thing;
            thing.box = box();
            thing.hidden = random_.index(5) == 0;
            thing.handle = world_.add({.bound = thing.box, .hidden = thing.hidden}).value();
            things.push_back(thing);
        }
    }
    void remove(std::size_t count) {
        for (; count > 0 && !things.empty(); --count) {
            Thing& thing = any();
            REQUIRE(world_.remove(thing.handle).has_value());
            thing = things.back();
            things.pop_back();
        }
    }
    void change() {
        Thing& thing = any();
        switch (random_.index(3)) {
            case 0:
                thing.hidden = !thing.hidden;
                REQUIRE(world_.set_hidden(thing.handle, thing.hidden).has_value());
                break;
            default:
                thing.box = box();
                REQUIRE(world_.set_bound(thing.handle, thing.box).has_value());
        }
    }
    // A part keeps moving for some updates, then another.
    void drift(int update) {
        const std::size_t first = static_cast<std::size_t>(update / 12 % 4) * things.size() / 4;
        for (std::size_t i = first; i < first + things.size() / 4; ++i) {
            things[i].box.center += 0.05 * random_.direction();
            REQUIRE(world_.set_bound(things[i].handle, things[i].box).has_value());
        }
    }
    [[nodiscard]] Thing& any() { return things[random_.index(static_cast<unsigned>(things.size()))]; }
    [[nodiscard]] Obb box() { return oracle::random_box(random_, {}, 3.0); }
    [[nodiscard]] unsigned index(unsigned size) { return random_.index(size); }

    std::vector<Thing> things;

  private:
    World& world_;
    NearMisses random_;
};

}  // namespace

TEST_SUITE("world/storage") {
    TEST_CASE("a loaded world takes at most 200 bytes an object, and 250 where it finds pairs") {
        CHECK(bytes_an_object(50'000, {.pairs = false}) < 200.0);
        CHECK(bytes_an_object(50'000, {.pairs = true, .contacts = false}) < 250.0);
        CHECK(bytes_an_object(50'000, {}) < 250.0);
    }

    TEST_CASE("changes of one object after another copy no array of the world at once, so that no update is long") {
        const CountingMemory memory;
        NearMisses random(67);
        World world({.contacts = false, .rebuild_budget = 0});  // what a rebuild gives back would hide what is copied
        std::vector<ObjectHandle> objects;
        // One in a cube of side 20: few touch.
        const auto anywhere = [&] {
            const double x = random.number(0.0, 740.0), y = random.number(0.0, 740.0), z = random.number(0.0, 740.0);
            return Sphere{{x, y, z}, 1.0};
        };
        const auto add = [&] { objects.push_back(world.add({.bound = anywhere()}).value()); };
        for (int i = 0; i < 50'000; ++i) add();
        REQUIRE(world.update().has_value());
        REQUIRE(world.update().has_value());
        std::size_t most = 0;
        for (int update = 0; update < 12'000; ++update) {
            if (update % 3 == 0) REQUIRE(world.set_bound(objects[0], anywhere()).has_value());
            if (update % 3 == 1 || update > 60) add();
            if (update % 3 == 2 && update <= 60)
                REQUIRE(world.remove(objects[static_cast<std::size_t>(update)]).has_value());
            const std::size_t taken = memory.bytes_taken(), in_use = memory.bytes_in_use();
            REQUIRE(world.update().has_value());
            most = std::max(most, memory.bytes_replaced_since(taken, in_use));
        }
        // An array of four bytes an object would be 200,000.
        CHECK(most < 100'000);
    }

    TEST_CASE("objects that stop colliding one after another cost no copy of all boxes, and are in no pair") {
        const CountingMemory memory;
        World world({.contacts = false});
        Crowd crowd(world, 66);
        crowd.add(20'000);
        for (int update = 0; update < 3; ++update) REQUIRE(world.update().has_value());
        std::set<std::uint32_t> apart;
        const std::size_t before = memory.bytes_in_use();
        for (std::size_t i = 0; i < 100; ++i) {
            REQUIRE(world.set_collides_with(crowd.things[i].handle, 0).has_value());
            apart.insert(crowd.things[i].handle.index);
            REQUIRE(world.update().has_value());
        }
        CHECK(memory.bytes_in_use() < before + 20'000 * sizeof(Obb));
        const auto is_apart = [&](const ObjectPair& pair) {
            return apart.contains(pair.first.object.index) || apart.contains(pair.second.object.index);
        };
        CHECK(std::none_of(world.pairs().begin(), world.pairs().end(), is_apart));
        CHECK(world.pairs().size() > 100);
    }

    TEST_CASE("loading takes no more memory for good if all objects come at once than if they come one by one") {
        const auto bytes = [](std::size_t an_update) {
            const CountingMemory memory;
            World world;
            NearMisses random(62);
            for (std::size_t i = 0; i < 5000; ++i) {
                REQUIRE(world.add({.bound = oracle::random_box(random, {}, 200.0)}).has_value());
                if (i % an_update == an_update - 1) REQUIRE(world.update().has_value());
            }
            for (int update = 0; update < 100; ++update) REQUIRE(world.update().has_value());
            return static_cast<double>(memory.bytes_in_use());
        };
        CHECK(bytes(5000) < 1.1 * bytes(10));
    }

    TEST_CASE("pairs are those of all boxes that are shown, whatever comes, goes, hides, moves and comes to rest") {
        for (unsigned seed = 0; seed < 6; ++seed) {
            CAPTURE(seed);
            World world;
            Crowd crowd(world, 100 + seed);
            crowd.add(20);
            // Later in a life some collide with nothing, or have shapes beyond which contacts reach.
            const bool some_collide_with_nothing = seed % 2 != 0;
            std::set<std::uint32_t> apart;
            bool good = true;
            for (int update = 0; update < 400; ++update) {
                if (update % 97 == 50) crowd.add(150);
                if (update % 97 == 90) crowd.remove(140);
                for (unsigned changes = crowd.index(4); changes > 0; --changes) crowd.change();
                if (crowd.index(3) == 0) crowd.add(1);
                if (crowd.index(3) == 0 && crowd.things.size() > 8) crowd.remove(1);
                crowd.drift(update);
                std::erase_if(apart, [&](std::uint32_t id) {
                    return std::none_of(crowd.things.begin(), crowd.things.end(),
                                        [&](const Thing& thing) { return thing.handle.index == id; });
                });
                if (some_collide_with_nothing && update > 200 && update % 5 == 0) {
                    const ObjectHandle handle = crowd.any().handle;
                    const bool collides = crowd.index(2) == 0;
                    REQUIRE(world.set_collides_with(handle, collides ? ~0u : 0u).has_value());
                    collides ? (void)apart.erase(handle.index) : (void)apart.insert(handle.index);
                }
                REQUIRE(world.update().has_value());
                for (const Thing& thing : crowd.things)
                    if (apart.contains(thing.handle.index))
                        REQUIRE(world.set_collides_with(thing.handle, 0).has_value());
                good &= pairs_of(world) == all_pairs(crowd.things, [&](const Thing& a, const Thing& b) {
                            return !apart.contains(a.handle.index) && !apart.contains(b.handle.index);
                        });
                good &= world.tree().validate().has_value();
            }
            CHECK(good);
        }
    }

    TEST_CASE("while something comes or goes now and then, the tree is rebuilt once a 16th of it has") {
        World world({.pairs = false});
        NearMisses random(66);
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 4000; ++i)
            objects.push_back(world.add({.bound = oracle::random_box(random, {}, 100.0)}).value());
        for (int update = 0; update < 30; ++update) REQUIRE(world.update().has_value());
        // Each of the two calls changes one item of the tree, in one of two updates or three.
        int changes = 0, first = 0;
        const auto update = [&] {
            REQUIRE(world.update().has_value());
            const boxtree::RebuildStep& step = world.tree().rebuilder().last_step();
            if (first == 0 && step.items_added > 0) first = changes;
        };
        for (std::size_t n = 0; n < 400; ++n) {
            REQUIRE(world.set_hidden(objects[n], true).has_value());
            ++changes, update();
            REQUIRE(world.set_hidden(objects[n], false).has_value());
            ++changes, update();
            if (n % 2 == 0) update();
        }
        CHECK(first >= 4000 / 16);
        CHECK(first < 4000 / 16 + 10);
    }

    TEST_CASE("the tree is right while many come and go and it is rebuilt in the background") {
        for (const bool pairs : {false, true}) {
            World world({.pairs = pairs});
            NearMisses random(64);
            std::vector<ObjectHandle> objects;
            for (int i = 0; i < 6000; ++i)
                objects.push_back(world.add({.bound = oracle::random_box(random, {}, 60.0)}).value());
            for (int update = 0; update < 120; ++update) {
                for (int changes = 0; changes < 150; ++changes) {
                    ObjectHandle& object = objects[random.index(6000)];
                    REQUIRE(world.remove(object).has_value());
                    object = world.add({.bound = oracle::random_box(random, {}, 60.0)}).value();
                }
                REQUIRE(world.update().has_value());
                const auto valid = world.tree().validate();
                INFO((valid ? std::string() : valid.error().message));
                REQUIRE(valid.has_value());
            }
        }
    }

    TEST_CASE("pairs reach as far as the contact margin around shapes, also where a shape comes late and then rests") {
        World world({.contact_margin = 0.5});
        const ObjectHandle ground = world.add({.bound = box_at({0.0, 0.0, 0.0})}).value();
        const ObjectHandle mover = world.add({.bound = box_at({0.0, 9.0, 0.0})}).value();
        const convex::Shape cube = convex::Shape::box(glm::vec3(0.5f)).value();
        const auto update = [&](int count) {
            for (; count > 0; --count) REQUIRE(world.update().has_value());
        };
        update(10);
        REQUIRE(world.set_shape(ground, &cube).has_value());
        REQUIRE(world.set_shape(mover, &cube).has_value());
        for (int step = 0; step < 20; ++step) {
            REQUIRE(world.set_bound(mover, box_at({0.0, 9.0 - 0.38 * step, 0.0})).has_value());
            update(1);
        }
        CHECK(world.pairs().size() == 0);  // a gap of 0.78
        REQUIRE(world.set_bound(mover, box_at({0.0, 1.3, 0.0})).has_value());
        update(1);
        CHECK(world.pairs().size() == 1);
        update(100);
        CHECK(world.pairs().size() == 1);
        REQUIRE(world.add({.bound = box_at({0.0, 0.6, 0.0})}).has_value());
        update(1);
        CHECK(world.pairs().size() == 3);
    }

    TEST_CASE("boxes that are set many at once cover their objects' shapes, whatever else moves") {
        World at_once({.pairs = false}), one_by_one({.pairs = false});
        NearMisses random(63);
        std::vector<ObjectHandle> objects, twins;
        const auto add = [&] {
            const convex::Shape shape =
                convex::Shape::box(glm::vec3(static_cast<float>(random.number(0.2, 0.8)))).value();
            const ObjectDescription description{.bound = oracle::random_box(random, {}, 9.0),
                                                .shape = random.index(3) == 0 ? &shape : nullptr};
            objects.push_back(at_once.add(description).value());
            twins.push_back(one_by_one.add(description).value());
        };
        for (int i = 0; i < 60; ++i) add();
        for (int update = 0; update < 300; ++update) {
            for (unsigned changes = random.index(3); changes > 0; --changes) {
                const std::size_t which = random.index(static_cast<unsigned>(objects.size()));
                if (random.index(2) == 0) {
                    const convex::Shape shape =
                        convex::Shape::box(glm::vec3(static_cast<float>(random.number(0.2, 0.8)))).value();
                    const bool none = random.index(2) == 0;
                    REQUIRE(at_once.set_shape(objects[which], none ? nullptr : &shape).has_value());
                    REQUIRE(one_by_one.set_shape(twins[which], none ? nullptr : &shape).has_value());
                } else {
                    REQUIRE(at_once.remove(objects[which]).has_value());
                    REQUIRE(one_by_one.remove(twins[which]).has_value());
                    objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(which));
                    twins.erase(twins.begin() + static_cast<std::ptrdiff_t>(which));
                    add();
                }
            }
            std::vector<ObjectHandle> moved, moved_twins;
            std::vector<Obb> boxes;
            for (std::size_t i = 0; i < objects.size(); ++i) {
                if ((i + static_cast<std::size_t>(update / 40)) % 3 == 0) continue;
                moved.push_back(objects[i]);
                moved_twins.push_back(twins[i]);
                boxes.push_back(oracle::random_box(random, {}, 9.0));
            }
            REQUIRE(at_once.set_bounds(moved, boxes).has_value());
            for (std::size_t i = 0; i < boxes.size(); ++i)
                REQUIRE(one_by_one.set_bound(moved_twins[i], boxes[i]).has_value());
            REQUIRE(at_once.update().has_value());
            REQUIRE(one_by_one.update().has_value());
            bool same = true;
            for (std::size_t i = 0; i < objects.size(); ++i)
                same &= have_same_bits(at_once.box_of(objects[i]).value(), one_by_one.box_of(twins[i]).value());
            CHECK(same);
        }
    }
}
