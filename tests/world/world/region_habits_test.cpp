// SPDX-License-Identifier: MIT
// What games do with regions beside walking through them: save and load, shift the origin, attach too often.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <map>
#include <memory>
#include <oracle/random_boxes.hpp>
#include <tuple>
#include <vector>

#include "box_at.hpp"

using namespace crofton;
using oracle::NearMisses;

namespace {

// Coordinates are multiples of 1/1024 below 64, so that sums with whole origins up to 2^40 are exact.
std::vector<RegionObject> exact_objects(NearMisses& random, std::size_t count) {
    std::vector<RegionObject> objects(count);
    for (RegionObject& object : objects) {
        Obb box;
        for (int k = 0; k < 3; ++k) {
            box.center[k] = std::floor(random.number(-65536.0, 65536.0)) / 1024.0;
            box.half_extents[k] = static_cast<float>(random.index(1024)) / 512.0f;
        }
        object.bound = box;
        object.user = random.index(1000);
    }
    return objects;
}

// A name that does not change: the number that a game gives to a region, and the object's place in it.
using Name = std::pair<std::size_t, std::uint32_t>;

struct Game {
    World world{{.pairs = false}};
    std::map<RegionHandle, std::size_t> numbers;
    std::vector<RegionHandle> handles;  // by number

    explicit Game(std::size_t regions) : handles(regions) {}
    void attach(std::size_t number, const Region& region, const glm::dvec3& origin) {
        handles[number] = world.attach(region, origin).value();
        numbers[handles[number]] = number;
    }
    void detach(std::size_t number) {
        world.detach(handles[number]).value();
        numbers.erase(handles[number]);
    }
    [[nodiscard]] Name name(ObjectHandle object) const {
        const RegionPlace place = world.place_of(object).value();
        return {numbers.at(place.region), place.index};
    }
    [[nodiscard]] std::vector<Name> names(const Vector<ObjectRef>& found) const {
        std::vector<Name> result;
        for (const ObjectRef& ref : found) result.push_back(name(ref.object));
        std::sort(result.begin(), result.end());
        return result;
    }
};

// What a World says around a place: a view, an overlap, the nearest object and rays, with lengths.
struct Answers {
    std::vector<std::pair<Name, occlude::Verdict>> seen;
    std::vector<Name> overlapped;
    std::vector<std::tuple<Name, double>> hits;
    double closest = 0.0;
    bool operator==(const Answers&) const = default;
};

Answers ask(const Game& game, const glm::dvec3& at) {
    Answers answers;
    Frustum volume;
    volume.origin = at;
    volume.plane_count = 6;
    for (std::uint32_t p = 0; p < 6; ++p) {
        glm::dvec3 normal(0.0);
        normal[static_cast<int>(p / 2)] = p % 2 ? 1.0 : -1.0;
        volume.planes[p] = {normal, 30.0 + p};
    }
    ViewResult visible;
    game.world.view({.volume = volume}, visible).value();
    for (std::size_t i = 0; i < visible.size(); ++i)
        answers.seen.emplace_back(game.name(visible[i].object), static_cast<occlude::Verdict>(visible.verdicts()[i]));
    std::sort(answers.seen.begin(), answers.seen.end());
    Vector<ObjectRef> found;
    game.world.overlap(Obb{.center = at, .half_extents = glm::vec3(20.0f)}, found);
    answers.overlapped = game.names(found);
    const auto closest = game.world.closest(Sphere{at + glm::dvec3(0.0, 70.0, 0.0), 0.5}, 1e6);
    answers.closest = closest ? closest->distance : -1.0;
    for (int i = 0; i < 64; ++i) {
        const glm::dvec3 to(i % 4 - 1.5, i / 4 % 4 - 1.5, i / 16 - 1.5);
        if (const auto hit = game.world.raycast({at - 64.0 * to, to}))
            answers.hits.emplace_back(game.name(hit->object), hit->t);
    }
    return answers;
}

}  // namespace

TEST_SUITE("world/region_habits") {
    TEST_CASE("a game that is loaded, its regions attached again in another order, answers as the one that was saved") {
        NearMisses random(90);
        std::vector<Region> regions;
        for (int i = 0; i < 12; ++i)
            regions.push_back(Region::prepare(exact_objects(random, 20 + 100 * static_cast<std::size_t>(i))).value());
        std::vector<glm::dvec3> origins;
        for (std::size_t i = 0; i < regions.size(); ++i)
            origins.emplace_back(16.0 * double(i) - 90.0, 8.0 * double(i % 3), 0.0);
        Game saved(regions.size());
        for (std::size_t i = 0; i < regions.size(); ++i) saved.attach(i, regions[i], origins[i]);
        saved.world.update().value();
        const Answers before = ask(saved, glm::dvec3(0.0));
        REQUIRE(before.seen.size() > 100);
        REQUIRE(before.hits.size() > 10);
        const ObjectHandle old = saved.world.object_in(saved.handles[3], 5).value();
        // In the same World, whose indices are used again, and in a new one.
        for (std::size_t i = 0; i < regions.size(); ++i) saved.detach(i);
        Game loaded(regions.size());
        for (Game* const game : {&saved, &loaded}) {
            for (std::size_t i = regions.size(); i-- > 0;) game->attach(i, regions[i], origins[i]);
            game->world.update().value();
            CHECK(ask(*game, glm::dvec3(0.0)) == before);
            // A handle is of its World and its time: what is saved are names.
            CHECK_FALSE(game->world.contains(old));
            CHECK(error_of(game->world.place_of(old)).code == ErrorCode::stale_handle);
        }
    }

    TEST_CASE("all that is shifted by a vector of few digits, regions by attaching them again, gets the same answers") {
        NearMisses random(91);
        std::vector<Region> regions;
        std::vector<glm::dvec3> origins;
        for (int i = 0; i < 8; ++i) {
            regions.push_back(Region::prepare(exact_objects(random, 200)).value());
            origins.emplace_back(32.0 * i - 100.0, 0.0, 16.0 * (i % 2));
        }
        Game game(regions.size());
        for (std::size_t i = 0; i < regions.size(); ++i) game.attach(i, regions[i], origins[i]);
        game.world.update().value();
        const Answers before = ask(game, glm::dvec3(0.0));
        REQUIRE(before.seen.size() > 50);
        glm::dvec3 shifted(0.0);
        for (int shift = 0; shift < 20; ++shift) {
            const glm::dvec3 by(std::ldexp(1.0, shift), -std::ldexp(3.0, shift / 2), double(shift));
            shifted += by;
            for (std::size_t i = 0; i < regions.size(); ++i) {
                game.detach(i);
                game.attach(i, regions[i], origins[i] + shifted);
            }
            game.world.update().value();
            CHECK(ask(game, shifted) == before);
            CHECK(game.world.object_count() == 8 * 200);
        }
    }

    TEST_CASE("what is attached and detached between two updates has never been there") {
        testing::CountingMemory memory;
        NearMisses random(92);
        const Region stays = Region::prepare(exact_objects(random, 300)).value(),
                     passes = Region::prepare(exact_objects(random, 500)).value();
        Game game(2);
        game.attach(0, stays, glm::dvec3(0.0));
        game.world.update().value();
        const Answers before = ask(game, glm::dvec3(0.0));
        std::size_t memory_after_first = 0;
        for (int round = 0; round < 3; ++round) {
            for (int i = 0; i < 1000; ++i) {
                const RegionHandle handle = game.world.attach(passes, glm::dvec3(i % 7)).value();
                const ObjectHandle object = game.world.object_in(handle, 7).value();
                game.world.set_hidden(object, true).value();
                game.world.detach(handle).value();
                CHECK_FALSE(game.world.contains(handle));
                CHECK_FALSE(game.world.contains(object));
                CHECK(error_of(game.world.detach(handle)).code == ErrorCode::stale_handle);
            }
            CHECK(ask(game, glm::dvec3(0.0)) == before);
            game.world.update().value();
            CHECK(ask(game, glm::dvec3(0.0)) == before);
            CHECK(game.world.object_count() == 300);
            if (round == 0) memory_after_first = memory.bytes_in_use();
        }
        CHECK(memory.bytes_in_use() == memory_after_first);
        // One that is moved in a frame: its old objects are stale, its new ones are where it went.
        game.detach(0);
        game.attach(0, stays, glm::dvec3(1024.0));
        game.world.update().value();
        CHECK(ask(game, glm::dvec3(1024.0)) == before);
        CHECK(ask(game, glm::dvec3(0.0)).seen.empty());
    }

    TEST_CASE("one region ten thousand times, nested in itself, answers as many, and its memory is there once") {
        NearMisses random(93);
        constexpr std::size_t kTimes = 10'000;
        const std::vector<RegionObject> objects = exact_objects(random, 1000);
        const Region region = Region::prepare(objects).value();
        testing::CountingMemory memory;
        World world({.pairs = false});
        std::vector<RegionHandle> handles;
        const auto origin = [](std::size_t i) {
            return glm::dvec3(0.5, 0.25, 1.0) * glm::dvec3(i % 10, i / 10 % 10, i / 100);
        };
        for (std::size_t i = 0; i < kTimes; ++i) handles.push_back(world.attach(region, origin(i)).value());
        world.update().value();
        CHECK(memory.bytes_in_use() < kTimes * 1000);
        CHECK(world.object_count() == kTimes * 1000);
        const auto expected_overlaps = [&](const Obb& probe, std::size_t step) {
            std::size_t count = 0;
            for (std::size_t i = 0; i < kTimes; i += step)
                for (const RegionObject& object : objects) {
                    const glm::dvec3 apart = glm::abs(object.bound.box.center + origin(i) - probe.center);
                    const glm::dvec3 sum = glm::dvec3(object.bound.box.half_extents) + glm::dvec3(probe.half_extents);
                    count += apart.x <= sum.x && apart.y <= sum.y && apart.z <= sum.z;
                }
            return count;
        };
        const Obb probe{.center = {10.0, -3.0, 40.0}, .half_extents = {1.0f, 2.0f, 0.5f}};
        Vector<ObjectRef> found;
        world.overlap(probe, found);
        CHECK(found.size() == expected_overlaps(probe, 1));
        for (std::size_t i = 0; i < kTimes; ++i)
            if (i % 4 != 0) world.detach(handles[i]).value();
        world.update().value();
        world.overlap(probe, found);
        CHECK(found.size() == expected_overlaps(probe, 4));
    }

    TEST_CASE("regions with more than 2^31 objects in all are refused, and leave what is attached as it is") {
        const std::vector<RegionObject> objects(100'000, RegionObject{.bound = testing::box_at(glm::dvec3(0.0))});
        const Region region = Region::prepare(objects).value();
        World world({.pairs = false});
        std::vector<RegionHandle> handles;
        for (;;) {
            const auto handle = world.attach(region, glm::dvec3(double(handles.size()), 0.0, 0.0));
            if (!handle) {
                CHECK(handle.error().code == ErrorCode::out_of_range);
                break;
            }
            handles.push_back(*handle);
        }
        // A region takes whole pages of 1,024 indices.
        CHECK(handles.size() == ((std::uint64_t{1} << 31) / 1024 - 1) / 98);
        CHECK(world.object_count() == handles.size() * 100'000);
        world.update().value();
        const auto hit = world.raycast({{double(handles.size()) + 10.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}});
        REQUIRE(hit);
        CHECK(world.place_of(hit->object)->region == handles.back());
        world.detach(handles[7]).value();
        world.update().value();
        CHECK(world.attach(region, glm::dvec3(0.0)));
    }

    TEST_CASE("Worlds and Regions may be destroyed in any order, also between changes and their update") {
        testing::CountingMemory memory;
        for (int order = 0; order < 4; ++order) {
            NearMisses random(94);
            auto region = std::make_unique<Region>(Region::prepare(exact_objects(random, 1000)).value());
            auto world = std::make_unique<World>(WorldOptions{.pairs = false});
            const RegionHandle a = world->attach(*region, glm::dvec3(0.0)).value();
            world->update().value();
            const RegionHandle b = world->attach(*region, glm::dvec3(1.0)).value();
            if (order % 2 == 0) world->detach(a).value();
            if (order < 2) region.reset();
            if (order % 2 == 0) world->update().value();
            CHECK(world->contains(b));
            CHECK(world->contains(a) == (order % 2 != 0));
            world.reset();
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
