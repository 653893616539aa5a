// SPDX-License-Identifier: MIT
// Refusals whose messages name numbers and paths, while memory ends: code and item are told, the message may be empty.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/bake/baked_scene.hpp>
#include <crofton/convex/shape.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/scene/scene.hpp>
#include <string>
#include <vector>

#include "failing_memory.hpp"

using namespace crofton;

namespace {

// `refuse` returns an Error; its n-th allocation fails, for every n.
template <class Refuse>
void sweep_refusal(const char* name, ErrorCode code, std::uint64_t item, const Refuse& refuse) {
    CAPTURE(std::string(name));
    const Error told = refuse();
    REQUIRE(told.code == code);
    REQUIRE(told.item == item);
    REQUIRE(told.message.size() > 15);  // longer than a string holds without memory
    bool emptied = false;
    for (std::int64_t n = 0;; ++n) {
        testing::has_failed = false;
        testing::allocations_left = n;
        const Error error = refuse();
        testing::allocations_left = testing::kNever;
        if (!testing::has_failed) break;
        const bool is_told = error.code == code && error.item == item;
        CHECK((is_told || error.code == ErrorCode::out_of_memory));
        CHECK((error.message.empty() || error.message == told.message || error.code == ErrorCode::out_of_memory));
        emptied = emptied || (is_told && error.message.empty());
    }
    CHECK(emptied);
}

}  // namespace

TEST_SUITE("memory/messages") {
    TEST_CASE("an error that contains numbers is returned even if its text finds no memory") {
        const testing::FailingMemory hooks;
        std::vector<glm::vec3> points(9, glm::vec3(1.0f));
        points[7].y = std::nanf("");
        const std::span<const glm::vec3> span(points);
        sweep_refusal("fit", ErrorCode::non_finite, 7, [&] { return fit::fit_obb(span).error(); });
        sweep_refusal("hull", ErrorCode::non_finite, 7, [&] { return convex_hull(span).error(); });
        sweep_refusal("convex hull", ErrorCode::non_finite, 7, [&] { return convex::Hull::build(span).error(); });
        const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 5}, {}};
        sweep_refusal("mesh", ErrorCode::out_of_range, 2, [&] { return validate(mesh).error(); });
        scene::Scene scene;
        sweep_refusal("scene", ErrorCode::out_of_range, 3, [&] { return scene.set_layer_mask(3, 1).error(); });
        const std::string path = "a path that is longer than a short string/no such file.crofton";
        sweep_refusal("file", ErrorCode::io, kNoItem, [&] { return bake::BakedScene::open(path).error(); });
    }
}
