// SPDX-License-Identifier: MIT
// What a profiler is told: zones that nest and end, counters that say what answers say.
#include <doctest/doctest.h>
#include <crofton/world/world.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

using namespace crofton;

namespace {

struct Told {
    std::vector<std::string> open, ended;
    std::map<std::string, double> counts;
    bool nested = true;

    [[nodiscard]] TraceHooks hooks() {
        return {
            [](void* user, const char* zone) { static_cast<Told*>(user)->open.emplace_back(zone); },
            [](void* user, const char* zone) { static_cast<Told*>(user)->close(zone); },
            [](void* user, const char* counter, double value) { static_cast<Told*>(user)->counts[counter] = value; },
            this};
    }
    void close(const char* zone) {
        nested = nested && !open.empty() && open.back() == zone;
        if (!open.empty()) open.pop_back();
        ended.emplace_back(zone);
    }
    [[nodiscard]] bool has(const char* zone) const {
        return std::find(ended.begin(), ended.end(), zone) != ended.end();
    }
};

void add_sphere(World& world, double x) {
    REQUIRE(world.add({.bound = Sphere{{x, 0.0, -5.0}, 1.0}}).has_value());
}

}  // namespace

TEST_SUITE("world/trace") {
    TEST_CASE("zones nest and end, and counters agree with the answers") {
        Told told;
        World world({.trace = told.hooks()});
        add_sphere(world, 0.0);
        add_sphere(world, 1.0);
        add_sphere(world, 300.0);
        REQUIRE(world.update().has_value());
        CHECK(told.has("update: transforms"));
        CHECK(told.has("update: pairs and contacts"));
        CHECK(told.ended.back() == "World::update");
        CHECK(told.counts["pairs"] == 1.0);
        ViewResult visible;
        REQUIRE(world.view({.camera = Camera{}}, visible).has_value());
        CHECK(told.ended.back() == "World::view");
        CHECK(told.counts["objects in view"] == static_cast<double>(visible.ids().size()));
        REQUIRE(world.view({.camera = Camera{}, .occlusion = OcclusionOptions{}}, visible).has_value());
        CHECK(told.has("view: draw occluders"));
        CHECK(told.ended.back() == "World::view with occlusion");
        CHECK(told.counts["objects not hidden"] == 2.0);
        CHECK(told.open.empty());
        CHECK(told.nested);
    }

    TEST_CASE("functions that are null are not called, and a world that is moved goes on telling") {
        Told told;
        TraceHooks hooks = told.hooks();
        hooks.begin = nullptr;
        hooks.count = nullptr;
        World world({.trace = hooks});
        World moved = std::move(world);
        add_sphere(moved, 0.0);
        REQUIRE(moved.update().has_value());
        CHECK(told.has("World::update"));
        CHECK(told.counts.empty());
    }
}
