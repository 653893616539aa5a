// SPDX-License-Identifier: MIT
// Every option of every overload of World::view, against the definition: each is obeyed, or refused by name.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <ranges.hpp>
#include <vector>

#include "occlusion_town.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

// Counts what it is asked for, and does it on this thread.
class CountingExecutor : public Executor {
  public:
    [[nodiscard]] unsigned concurrency() const override { return 4; }
    void parallel_for(std::size_t count, std::size_t grain, RangeTask body) override {
        ++calls;
        for (std::size_t begin = 0; begin < count; begin += grain) body(begin, std::min(count, begin + grain), 0);
    }
    int calls = 0;
};

constexpr std::uint32_t kLayers[3] = {~0u, 5u, 2u};

// Things that rest and things that move, in layers of their own; and houses, which hide them where that is asked for.
struct Crowd {
    Crowd() {
        NearMisses random(4711);
        for (std::uint32_t i = 0; i < 600; ++i) {
            Obb box = oracle::random_box(random, {}, 1.0);
            box.center = {random.number(-40.0, 40.0), random.number(-20.0, 20.0), random.number(-150.0, 10.0)};
            box.half_extents = glm::vec3(static_cast<float>(random.number(0.05, 1.5)));
            objects.push_back(world.add({.bound = box, .layers = 1u << i % 4}).value());
            boxes.push_back(box);
        }
        for (int update = 0; update < 30; ++update) {
            REQUIRE(world.update().has_value());
            for (std::size_t i = 0; i < objects.size(); i += 10) {
                boxes[i].center.x += update % 2 ? 0.25 : -0.25;
                REQUIRE(world.set_bound(objects[i], boxes[i]).has_value());
            }
        }
        REQUIRE(world.update().has_value());
        camera.position = {0.0, 0.0, 5.0};
        camera.fov_y = 1.2;
        for (int v = 0; v < 3; ++v) {
            camera.forward = {0.4 * v - 0.4, 0.0, -1.0};
            views.push_back({*occlude::occlusion_view_of(camera), kLayers[v]});
            plain.push_back({views.back().view.frustum, kLayers[v]});
        }
        camera.forward = {-0.4, 0.0, -1.0};
        limits = *cull::limits_of(camera, 1080.0, 20.0);
        among.assign(10, 0xf0f0f0f0f0f0f0f0u);
    }
    [[nodiscard]] bool sees(std::size_t v, std::size_t i, const cull::CullOptions& how) const {
        const std::uint32_t layers = plain[v].layer_mask & 1u << i % 4;
        const auto id = static_cast<std::uint32_t>(i);
        if (layers == 0 || cull::classify(plain[v].frustum, boxes[i], how.mode) == cull::Verdict::outside) return false;
        if (how.limits && !cull::is_worth_drawing(*how.limits, boxes[i], id, layers)) return false;
        return i % 10 == 0 || cull::is_among(how.among, id);
    }
    void check_one(const VisibleObjects& visible, std::size_t v, const cull::CullOptions& how) const {
        const std::vector<std::uint32_t> ids(visible.ids().begin(), visible.ids().end());
        std::vector<std::uint32_t> expected, sorted = ids;
        for (std::uint32_t i = 0; i < boxes.size(); ++i)
            if (sees(v, i, how)) expected.push_back(i);
        std::sort(sorted.begin(), sorted.end());
        CHECK(sorted == expected);
        const auto verdict = [&](std::uint32_t id) { return cull::classify(plain[v].frustum, boxes[id], how.mode); };
        const auto inside = std::count_if(ids.begin(), ids.end(),
                                          [&](std::uint32_t id) { return verdict(id) == cull::Verdict::inside; });
        CHECK(visible.inside_count() == std::size_t(inside));
        if (how.order == cull::ResultOrder::ascending) {
            CHECK(ids == sorted);
            REQUIRE(visible.verdicts().size() == ids.size());
            for (std::size_t i = 0; i < ids.size(); ++i) CHECK(visible.verdicts()[i] == verdict(ids[i]));
            return;
        }
        CHECK(visible.verdicts().empty());
        for (std::size_t i = 0; i < ids.size(); ++i)
            CHECK((i < visible.inside_count()) == (verdict(ids[i]) == cull::Verdict::inside));
    }
    void check_many(const VisibleInViews& visible, const cull::CullOptions& how) const {
        std::vector<std::uint32_t> masks(boxes.size(), 0);
        for (std::size_t i = 0; i < visible.size(); ++i) {
            CHECK(masks[visible.ids()[i]] == 0);
            CHECK(visible.view_mask(i) != 0);
            masks[visible.ids()[i]] = visible.view_mask(i);
        }
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t v = 0; v < plain.size(); ++v) CHECK((masks[i] >> v & 1u) == sees(v, i, how));
        const bool ascends = std::is_sorted(visible.ids().begin(), visible.ids().end());
        CHECK(ascends == (how.order == cull::ResultOrder::ascending));
    }

    World world;
    std::vector<ObjectHandle> objects;
    std::vector<Obb> boxes;
    Camera camera;  // of the first view
    std::vector<OccludingView> views;
    std::vector<cull::View> plain;
    cull::DrawLimits limits;
    std::vector<std::uint64_t> among;
};

}  // namespace

TEST_SUITE("world/view_options") {
    TEST_CASE(
        "each overload of view obeys mode, order, limits, among, layers and executor, with occlusion and without") {
        const Crowd crowd;
        ThreadPool pool(3);
        std::size_t limited = 0, chosen = 0;
        for (unsigned choice = 0; choice < 64; ++choice) {
            cull::CullOptions how;
            if (choice & 1u) how.mode = cull::CullMode::conservative;
            if (choice & 2u) how.order = cull::ResultOrder::tree;
            if (choice & 4u) how.limits = &crowd.limits;
            if (choice & 8u) how.among = crowd.among;
            Executor& executor = choice & 16u ? static_cast<Executor&>(pool) : serial_executor();
            OcclusionOptions occlusion;
            occlusion.enabled = (choice & 32u) != 0;
            occlusion.list_occluded = (choice & 16u) != 0;
            CAPTURE(choice);
            VisibleObjects visible;
            const auto check = [&](std::size_t v) { crowd.check_one(visible, v, how); };
            REQUIRE(crowd.world.view(crowd.camera, visible, how, executor).has_value());
            check(0);
            REQUIRE(crowd.world.view(crowd.camera, occlusion, visible, how, executor).has_value());
            check(0);
            for (std::size_t v = 0; v < crowd.views.size(); ++v) {
                crowd.world.view(crowd.plain[v], visible, how, executor);
                check(v);
                REQUIRE(crowd.world.view(crowd.views[v], occlusion, visible, how, executor).has_value());
                check(v);
            }
            VisibleInViews many;
            REQUIRE(crowd.world.view(crowd.plain, many, how, executor).has_value());
            crowd.check_many(many, how);
            CHECK(many.occlusion_view_count() == 0);
            REQUIRE(crowd.world.view(crowd.views, occlusion, many, how, executor).has_value());
            crowd.check_many(many, how);
            CHECK(many.occlusion_view_count() == (occlusion.enabled ? crowd.views.size() : 0));
            limited += how.limits ? many.size() : 0;
            chosen += how.limits ? 0 : many.size();
        }
        CHECK(3 * limited < 2 * chosen);
    }

    TEST_CASE("in tree order, what is not hidden comes as it does without occlusion, and what is hidden is listed") {
        NearMisses random(99);
        Town town(random, {}, 800);
        REQUIRE(town.world.update().has_value());
        std::size_t hidden = 0;
        for (int trial = 0; trial < 20; ++trial) {
            const OccludingView view{*occlude::occlusion_view_of(town.camera(random))};
            VisibleObjects plain, ascending, tree;
            town.world.view({view.view.frustum, ~0u}, plain, {.order = cull::ResultOrder::tree});
            const OcclusionOptions occlusion{.list_occluded = true};
            REQUIRE(town.world.view(view, occlusion, ascending).has_value());
            REQUIRE(town.world.view(view, occlusion, tree, {.order = cull::ResultOrder::tree}).has_value());
            CHECK(test::ranges::equal(ascending.occluded_ids(), tree.occluded_ids()));
            std::vector<std::uint32_t> left;
            std::size_t inside = 0;
            for (std::size_t i = 0; i < plain.size(); ++i) {
                const std::uint32_t id = plain.ids()[i];
                if (ascending.verdict_of(id) == occlude::Verdict::occluded) continue;
                left.push_back(id);
                inside += i < plain.inside_count();
                CHECK(tree.verdict_of(id) == ascending.verdict_of(id));
            }
            CHECK(test::ranges::equal(tree.ids(), left));
            CHECK(tree.inside_count() == inside);
            hidden += tree.occluded_ids().size();
            VisibleInViews many;
            REQUIRE(town.world.view(std::span(&view, 1), OcclusionOptions{}, many, {.order = cull::ResultOrder::tree})
                        .has_value());
            std::vector<std::uint32_t> of_many(many.ids().begin(), many.ids().end());
            std::sort(of_many.begin(), of_many.end());
            CHECK(test::ranges::equal(ascending.ids(), of_many));
        }
        CHECK(hidden > 100);
    }

    TEST_CASE("many views in ascending order are shared among the executor's threads") {
        const Crowd crowd;
        for (const bool enabled : {false, true}) {
            CountingExecutor executor;
            VisibleInViews many;
            REQUIRE(crowd.world.view(crowd.views, {.enabled = enabled}, many, {}, executor).has_value());
            CHECK(executor.calls > 0);
        }
        CountingExecutor executor;
        VisibleInViews many;
        REQUIRE(crowd.world.view(crowd.plain, many, {}, executor).has_value());
        CHECK(executor.calls > 0);
    }

    TEST_CASE("more than 32 views are refused by each call that takes many, and 32 are answered") {
        const Crowd crowd;
        const std::vector<OccludingView> views(33, crowd.views[0]);
        const std::vector<cull::View> plain(33, crowd.plain[0]);
        VisibleInViews many;
        CHECK(error_of(crowd.world.view(plain, many)).code == ErrorCode::out_of_range);
        for (const bool enabled : {false, true}) {
            const OcclusionOptions occlusion{.enabled = enabled};
            const Error error = error_of(crowd.world.view(views, occlusion, many));
            CHECK(error.code == ErrorCode::out_of_range);
            CHECK(error.item == 32);
            CHECK(error.message.find("33 views") != std::string::npos);
            REQUIRE(crowd.world.view(std::span(views).first(32), occlusion, many).has_value());
            for (std::size_t i = 0; i < many.size(); ++i) CHECK(many.view_mask(i) == ~0u);
            CHECK(many.size() > 0);
        }
    }
}
