// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/crofton.hpp>
#include <crofton/pvs/pvs.hpp>
#include <set>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

std::vector<std::uint32_t> sorted(std::span<const std::uint32_t> ids) {
    std::vector<std::uint32_t> result(ids.begin(), ids.end());
    std::sort(result.begin(), result.end());
    return result;
}

// A world of boxes, some of which move, and sets of bits for it.
struct Town {
    World world{{.pairs = false, .rebuild_budget = 0}};
    std::vector<ObjectHandle> objects;
    std::vector<Obb> boxes;
    std::set<std::uint32_t> moving;
    Vector<std::uint64_t> words;

    Town(std::uint64_t seed, int count, double share) {
        sampling::Random random(seed);
        for (int i = 0; i < count; ++i) {
            const auto at = random.point<3>();
            const auto size = random.point<3>();
            boxes.push_back(
                obb_of(box_around(glm::dvec3(200.0 * at[0] - 100.0, 10.0 * at[1], 200.0 * at[2] - 100.0),
                                  glm::dvec3(0.2 + 3.0 * size[0], 0.2 + 3.0 * size[1], 0.2 + 3.0 * size[2]))));
            objects.push_back(
                world.add({.bound = boxes.back(), .layers = 1u + static_cast<std::uint32_t>(random.bits() % 3)})
                    .value());
        }
        REQUIRE(world.update().has_value());
        for (int i = 0; i < count; i += 7) moving.insert(static_cast<std::uint32_t>(i));
        for (int frame = 0; frame < 3; ++frame) {
            for (const std::uint32_t i : moving) {
                boxes[i].center.x += 0.125;
                REQUIRE(world.set_bound(objects[i], boxes[i]).has_value());
            }
            REQUIRE(world.update().has_value());
        }
        // Some ids lie beyond the set.
        words.assign(static_cast<std::size_t>(count) / 64, 0);
        for (std::uint64_t& word : words)
            for (int bit = 0; bit < 64; ++bit) word |= std::uint64_t{random.uniform() < share} << bit;
    }

    [[nodiscard]] bool is_kept(std::uint32_t id) const {
        return moving.count(id) || id / 64 >= words.size() || (words[id / 64] >> (id % 64) & 1);
    }
    [[nodiscard]] std::vector<std::uint32_t> kept(std::span<const std::uint32_t> ids) const {
        std::vector<std::uint32_t> result;
        std::copy_if(ids.begin(), ids.end(), std::back_inserter(result), [&](std::uint32_t id) { return is_kept(id); });
        return result;
    }
};

}  // namespace

TEST_SUITE("pvs/view") {
    TEST_CASE("a view among a set is the view less what rests and is not in it, in both orders, with its verdicts") {
        ThreadPool pool(3);
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const Town town(seed, 3000, seed % 3 == 0 ? 0.02 : 0.4);
            ViewResult all, some;
            std::size_t left_out = 0;
            sampling::Random random(seed);
            for (int frame = 0; frame < 20; ++frame) {
                Camera camera;
                camera.fov_y = 0.9;
                camera = sampling::random_camera(camera, {{-80.0, 1.0, -80.0}, {80.0, 3.0, 80.0}}, random.point<6>());
                ViewRequest plain{.camera = camera}, candidate_mask{.camera = camera};
                plain.order = candidate_mask.order = frame % 2 ? cull::ResultOrder::tree : cull::ResultOrder::ascending;
                candidate_mask.candidate_mask = town.words;
                Executor& executor = frame % 3 ? serial_executor() : static_cast<Executor&>(pool);
                REQUIRE(town.world.view(plain, all, executor).has_value());
                REQUIRE(town.world.view(candidate_mask, some, executor).has_value());
                REQUIRE(sorted(some.ids()) == sorted(town.kept(all.ids())));
                left_out += all.size() - some.size();
                const auto inside = all.ids().first(all.inside_count());
                if (plain.order == cull::ResultOrder::tree) CHECK(some.inside_count() == town.kept(inside).size());
                for (std::size_t i = 0, j = 0; i < all.verdicts().size(); ++i)
                    if (town.is_kept(all.ids()[i])) REQUIRE(some.verdicts()[j++] == all.verdicts()[i]);
            }
            CHECK(left_out > 100);
        }
    }

    TEST_CASE("objects that have moved, and objects that reuse an index, are not judged by the set") {
        World world({.pairs = false});
        std::vector<ObjectHandle> objects;
        const auto sphere = [](double x) { return Sphere{{x, 0.0, -20.0}, 0.25}; };
        for (int i = 0; i < 200; ++i) objects.push_back(world.add({.bound = sphere(0.05 * i - 5.0)}).value());
        for (int frame = 0; frame < 40; ++frame) REQUIRE(world.update().has_value());
        const std::vector<std::uint64_t> none(8, 0);  // room for those that come later
        const auto seen = [&](const ObjectHandle& object) {
            ViewResult plain, hiding;
            REQUIRE(world.view({.camera = Camera{}, .candidate_mask = none}, plain).has_value());
            REQUIRE(world.view({.camera = Camera{}, .occlusion = OcclusionOptions{}, .candidate_mask = none}, hiding)
                        .has_value());
            CHECK(sorted(plain.ids()) == sorted(hiding.ids()));
            return std::count(plain.ids().begin(), plain.ids().end(), object.index) == 1;
        };
        CHECK_FALSE(seen(objects[0]));
        // Every second update: it never leaves the tree.
        for (int frame = 0; frame < 20; ++frame) {
            if (frame % 2 == 0) REQUIRE(world.set_bound(objects[3], sphere(0.01 * frame)).has_value());
            REQUIRE(world.update().has_value());
            CHECK(seen(objects[3]));
        }
        // Once, hidden, and back in the tree for long.
        REQUIRE(world.set_hidden(objects[4], true).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.set_bound(objects[4], sphere(1.0)).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.set_hidden(objects[4], false).has_value());
        // New ones: one rests from the beginning, one moves a little first, one has the index of another.
        const auto resting = world.add({.bound = sphere(0.1)}).value(),
                   restless = world.add({.bound = sphere(0.2)}).value();
        REQUIRE(world.remove(objects[5]).has_value());
        for (int frame = 0; frame < 5; ++frame) {
            REQUIRE(world.update().has_value());
            REQUIRE(world.set_bound(restless, sphere(0.2 + 0.1 * frame)).has_value());
        }
        const auto heir = world.add({.bound = sphere(0.3)}).value();
        REQUIRE(heir.index == objects[5].index);
        for (int frame = 0; frame < 60; ++frame) REQUIRE(world.update().has_value());
        CHECK_FALSE(seen(objects[0]));
        CHECK_FALSE(seen(objects[199]));
        CHECK_FALSE(seen(resting));
        CHECK(seen(objects[3]));
        CHECK(seen(objects[4]));
        CHECK(seen(restless));
        CHECK(seen(heir));
    }

    TEST_CASE("an object that moved before it first rested is not judged by the set, also if it was hidden meanwhile") {
        World world({.pairs = false});
        const auto sphere = [](double x) { return Sphere{{x, 0.0, -20.0}, 0.25}; };
        const auto moved = world.add({.bound = sphere(0.0)}).value(),
                   rested = world.add({.bound = sphere(1.0)}).value();
        REQUIRE(world.update().has_value());
        REQUIRE(world.set_bound(moved, sphere(0.5)).has_value());
        REQUIRE(world.update().has_value());
        for (const bool hidden : {true, false}) {
            REQUIRE(world.set_hidden(moved, hidden).has_value());
            REQUIRE(world.set_hidden(rested, hidden).has_value());
            REQUIRE(world.update().has_value());
        }
        for (int frame = 0; frame < 40; ++frame) REQUIRE(world.update().has_value());
        CHECK(world.statistics().resting == 2);
        const std::vector<std::uint64_t> none(1, 0);
        ViewResult visible;
        REQUIRE(world.view({.camera = Camera{}, .candidate_mask = none}, visible).has_value());
        CHECK(std::vector(visible.ids().begin(), visible.ids().end()) == std::vector{moved.index});
    }

    TEST_CASE("with occlusion the same objects are left out") {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            Town town(seed, 2000, 0.5);
            // A wall that hides much.
            const auto cube = [] {
                pvs::BakeGeometry shape;
                add_box(shape, box_around({}, glm::dvec3(1.0)));
                return shape.mesh;
            }();
            const auto mesh = town.world.add_mesh({.positions = cube.positions, .indices = cube.indices}).value();
            REQUIRE(town.world.find_occluders(mesh).has_value());
            glm::dmat3 size(1.0);
            size[0][0] = 40.0, size[1][1] = 8.0;
            REQUIRE(town.world.add({.mesh = mesh, .transform = Transform{size, {0.0, 4.0, -20.0}}}).has_value());
            REQUIRE(town.world.update().has_value());
            ViewResult all, some, plain;
            Camera camera;
            camera.position = {0.0, 3.0, 0.0};
            REQUIRE(town.world.view({.camera = camera}, plain).has_value());
            REQUIRE(town.world.view({.camera = camera, .occlusion = OcclusionOptions{}}, all).has_value());
            REQUIRE(
                town.world.view({.camera = camera, .occlusion = OcclusionOptions{}, .candidate_mask = town.words}, some)
                    .has_value());
            CHECK(all.size() < plain.size());
            CHECK(some.size() < all.size());
            CHECK(sorted(some.ids()) == sorted(town.kept(all.ids())));
            CHECK(some.has_occlusion());
        }
    }

    TEST_CASE("a list of boxes gives the same answers") {
        const Town town(9, 1000, 0.3);
        Camera camera;
        camera.position = {0.0, 3.0, 0.0};
        const cull::View view{.frustum = frustum_of(camera).value()};
        cull::VisibleSet all, some;
        for (const auto order : {cull::ResultOrder::tree, cull::ResultOrder::ascending}) {
            cull::find_visible(town.boxes, {}, view, all, {.order = order});
            cull::find_visible(town.boxes, {}, view, some, {.order = order, .candidate_mask = town.words});
            std::vector<std::uint32_t> expected;
            for (const std::uint32_t id : all.ids())
                if (cull::is_candidate(town.words, id)) expected.push_back(id);
            CHECK(std::vector<std::uint32_t>(some.ids().begin(), some.ids().end()) == expected);
            CHECK(some.size() < all.size());
        }
    }

    TEST_CASE("the set of an eye is that of its cell, and of an eye without a cell everything") {
        const pvs::BakeGeometry geometry = random_geometry(4, 90);
        const pvs::Cells cells = pvs::Cells::grid({{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}}, {5, 1, 5}).value();
        auto bake = pvs::Bake::create(geometry, cells, {.epsilon = 1e-2, .confidence = 0.9}).value();
        REQUIRE(bake.run().has_value());
        const pvs::Pvs sets = pvs::Pvs::finish(bake).value();
        sampling::Random random(5);
        int without = 0;
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 eye = sampling::box_point({{-12.0, -1.0, -12.0}, {12.0, 4.0, 12.0}}, random.point<3>());
            const std::uint32_t cell = sets.find_cell(eye);
            const auto set = sets.visible_from(eye, pvs::Mode::statistical);
            without += cell == pvs::kNoCell;
            if (cell == pvs::kNoCell)
                CHECK(set.empty());
            else
                CHECK(set.data() == sets.visible_from(cell, pvs::Mode::statistical).data());
        }
        CHECK(without > 50);
        CHECK(without < 450);
    }
}
