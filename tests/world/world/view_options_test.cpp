// SPDX-License-Identifier: MIT
// Every option of a view request, alone and in a span, against the definition: each is obeyed, or refused by name.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <crofton/crofton.hpp>
#include <error_of.hpp>
#include <limits>
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
    void parallel_for(std::size_t count, std::size_t grain, RangeTask shape) override {
        ++calls;
        for (std::size_t begin = 0; begin < count; begin += grain) shape(begin, std::min(count, begin + grain), 0);
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
            cameras.push_back(camera);
            plain.push_back({frustum_of(camera).value(), kLayers[v]});
        }
        limits = *cull::limits_of(camera, 1080.0, 20.0);
        candidate_mask.assign(10, 0xf0f0f0f0f0f0f0f0u);
    }
    [[nodiscard]] ViewRequest request(std::size_t v, const cull::CullOptions& how) const {
        return {.camera = cameras[v],
                .layers = kLayers[v],
                .limits = how.limits,
                .candidate_mask = how.candidate_mask,
                .order = how.order,
                .mode = how.mode};
    }
    [[nodiscard]] bool sees(std::size_t v, std::size_t i, const cull::CullOptions& how) const {
        const std::uint32_t layers = plain[v].layer_mask & 1u << i % 4;
        const auto id = static_cast<std::uint32_t>(i);
        if (layers == 0 || cull::classify(plain[v].frustum, boxes[i], how.mode) == cull::Verdict::outside) return false;
        if (how.limits && !cull::is_worth_drawing(*how.limits, boxes[i], id, layers)) return false;
        return i % 10 == 0 || cull::is_candidate(how.candidate_mask, id);
    }
    void check_one(const ViewResult& visible, std::size_t v, const cull::CullOptions& how) const {
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
    void check_many(const MultiViewResult& visible, const std::array<cull::CullOptions, 3>& how) const {
        std::vector<std::uint32_t> masks(boxes.size(), 0);
        for (std::size_t i = 0; i < visible.size(); ++i) {
            CHECK(masks[visible.ids()[i]] == 0);
            CHECK(visible.view_mask(i) != 0);
            masks[visible.ids()[i]] = visible.view_mask(i);
        }
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t v = 0; v < plain.size(); ++v) CHECK((masks[i] >> v & 1u) == sees(v, i, how[v]));
        const bool ascends = std::is_sorted(visible.ids().begin(), visible.ids().end());
        CHECK(ascends == (how[0].order == cull::ResultOrder::ascending));
    }

    World world;
    std::vector<ObjectHandle> objects;
    std::vector<Obb> boxes;
    Camera camera;
    std::vector<Camera> cameras;
    std::vector<cull::View> plain;
    cull::DrawLimits limits;
    std::vector<std::uint64_t> candidate_mask;
};

}  // namespace

TEST_SUITE("world/view_options") {
    TEST_CASE("a candidate mask leaves out objects of small worlds and new objects, but none that has moved") {
        World world;
        std::vector<ObjectHandle> objects;
        for (int i = 0; i < 20; ++i)
            objects.push_back(world.add({.bound = Sphere{{0.5 * i - 5.0, 0.0, -12.0}, 0.1}}).value());
        REQUIRE(world.update().has_value());
        const std::array<std::uint64_t, 1> mask{0x0f0f0u};
        const auto listed = [&](bool occluded) {
            ViewRequest request{.camera = Camera{}, .candidate_mask = mask};
            if (occluded) request.occlusion = OcclusionOptions{};
            ViewResult visible;
            REQUIRE(world.view(request, visible).has_value());
            return std::vector<std::uint32_t>(visible.ids().begin(), visible.ids().end());
        };
        const std::vector<std::uint32_t> candidates{4, 5, 6, 7, 12, 13, 14, 15};
        for (const bool occluded : {false, true}) CHECK(listed(occluded) == candidates);
        REQUIRE(world.set_bound(objects[1], Sphere{{-4.0, 0.0, -12.0}, 0.1}).has_value());
        REQUIRE(world.update().has_value());
        std::vector<std::uint32_t> with_mover = candidates;
        with_mover.insert(with_mover.begin(), 1);
        for (const bool occluded : {false, true}) CHECK(listed(occluded) == with_mover);
        // New objects among many that rest.
        World large;
        for (int i = 0; i < 900; ++i)
            REQUIRE(large.add({.bound = Sphere{{0.02 * i - 9.0, 0.0, -12.0}, 0.01}}).has_value());
        for (int frame = 0; frame < 8; ++frame) REQUIRE(large.update().has_value());
        REQUIRE(large.add({.bound = Sphere{{0.0, 0.5, -12.0}, 0.1}}).has_value());
        REQUIRE(large.update().has_value());
        const std::vector<std::uint64_t> none(15, 0);
        ViewResult visible;
        REQUIRE(large.view({.camera = Camera{}, .candidate_mask = none}, visible).has_value());
        CHECK(visible.size() == 0);
        REQUIRE(large.view({.camera = Camera{}}, visible).has_value());
        CHECK(visible.size() > 100);
    }

    TEST_CASE("a view obeys mode, order, limits, candidates, layers and executor, with occlusion and without") {
        const Crowd crowd;
        ThreadPool pool(3);
        std::size_t limited = 0, chosen = 0;
        for (unsigned choice = 0; choice < 64; ++choice) {
            cull::CullOptions how;
            if (choice & 1u) how.mode = cull::CullMode::conservative;
            if (choice & 2u) how.order = cull::ResultOrder::tree;
            if (choice & 4u) how.limits = &crowd.limits;
            if (choice & 8u) how.candidate_mask = crowd.candidate_mask;
            Executor& executor = choice & 16u ? static_cast<Executor&>(pool) : serial_executor();
            CAPTURE(choice);
            std::array<ViewRequest, 3> requests;
            for (std::size_t v = 0; v < 3; ++v) {
                requests[v] = crowd.request(v, how);
                if (choice & 32u) requests[v].occlusion = OcclusionOptions{.list_occluded = (choice & 16u) != 0};
                ViewResult visible;
                REQUIRE(crowd.world.view(requests[v], visible, executor).has_value());
                crowd.check_one(visible, v, how);
                ViewRequest same = requests[v];
                same.camera.reset();
                if (choice & 32u) same.matrix = ViewMatrix{world_to_clip(crowd.cameras[v])};
                same.volume = crowd.plain[v].frustum;
                REQUIRE(crowd.world.view(same, visible, executor).has_value());
                crowd.check_one(visible, v, how);
            }
            MultiViewResult many;
            REQUIRE(crowd.world.view(requests, many, executor).has_value());
            crowd.check_many(many, {how, how, how});
            CHECK(many.view_count() == 3);
            CHECK((many.occlusion_buffer(0) != nullptr) == ((choice & 32u) != 0));
            limited += how.limits ? many.size() : 0;
            chosen += how.limits ? 0 : many.size();
        }
        CHECK(3 * limited < 2 * chosen);
    }

    TEST_CASE("views of one call each keep their own mode, limits, candidates and occlusion") {
        const Crowd crowd;
        ThreadPool pool(3);
        for (unsigned choice = 0; choice < 128; ++choice) {
            CAPTURE(choice);
            std::array<cull::CullOptions, 3> how;
            std::array<ViewRequest, 3> requests;
            for (std::size_t v = 0; v < 3; ++v) {
                if (choice >> v & 1u) how[v].limits = &crowd.limits;
                if (choice >> (v + 1) & 1u) how[v].candidate_mask = crowd.candidate_mask;
                if (choice >> (v + 2) & 1u) how[v].mode = cull::CullMode::conservative;
                if (choice & 64u) how[v].order = cull::ResultOrder::tree;
                requests[v] = crowd.request(v, how[v]);
                if (choice >> (v + 3) & 1u) requests[v].occlusion.emplace();
            }
            MultiViewResult many, threaded;
            REQUIRE(crowd.world.view(requests, many).has_value());
            crowd.check_many(many, how);
            REQUIRE(crowd.world.view(requests, threaded, pool).has_value());
            CHECK(test::ranges::equal(many.ids(), threaded.ids()));
            for (std::size_t i = 0; i < many.size(); ++i) CHECK(many.view_mask(i) == threaded.view_mask(i));
        }
    }

    TEST_CASE("a request that cannot be obeyed is refused by name, and every answer stays as it was") {
        const Crowd crowd;
        const double nan = std::numeric_limits<double>::quiet_NaN();
        const ViewRequest plain = crowd.request(0, {});
        const Frustum volume = crowd.plain[0].frustum;
        const ViewMatrix matrix{world_to_clip(crowd.camera)};
        Frustum many_planes = volume, nan_plane = volume, endless_plane = volume, nan_origin = volume;
        many_planes.plane_count = 13;
        nan_plane.planes[2].normal.y = nan;
        endless_plane.planes[5].offset = std::numeric_limits<double>::infinity();
        nan_origin.origin.z = nan;
        const OcclusionOptions occlusion;
        const depth::PictureView picture;
        cull::DrawLimits shrinking = crowd.limits, undefined = crowd.limits, few_layers = crowd.limits;
        shrinking.hysteresis = 0.5;
        undefined.hysteresis = nan;
        const std::array<float, 5> five_distances{};
        few_layers.layer_distances = five_distances;
        const std::vector<ViewRequest> wrong{
            {},
            {.camera = crowd.camera, .matrix = matrix},
            {.camera = crowd.camera, .volume = volume},
            {.volume = volume, .occlusion = occlusion},
            {.volume = volume, .picture = picture},
            {.volume = many_planes},
            {.volume = nan_plane},
            {.volume = endless_plane},
            {.volume = nan_origin},
            {.camera = crowd.camera, .volume = nan_plane, .occlusion = occlusion},
            {.camera = Camera{.fov_y = -1.0}},
            {.matrix = ViewMatrix{glm::dmat4(0.0)}},
            {.camera = crowd.camera, .occlusion = OcclusionOptions{.size = {4, 270}}},
            {.camera = crowd.camera, .occlusion = OcclusionOptions{.size = {480, 4097}}},
            {.camera = crowd.camera, .occlusion = OcclusionOptions{.least_cover = static_cast<float>(nan)}},
            {.camera = crowd.camera, .picture = depth::PictureView{.width = 0}},
            {.camera = crowd.camera, .occlusion = occlusion, .picture = picture},
            {.camera = crowd.camera, .limits = &shrinking},
            {.camera = crowd.camera, .limits = &undefined},
            {.camera = crowd.camera, .limits = &few_layers}};
        for (int before = 0; before < 3; ++before) {
            ViewRequest asked = plain;
            if (before == 1) asked.occlusion = OcclusionOptions{.list_occluded = true};
            if (before == 2) asked.picture = picture;
            ViewResult visible, untouched;
            MultiViewResult many, many_untouched;
            const std::array<ViewRequest, 2> both{asked, crowd.request(1, {})};
            REQUIRE(crowd.world.view(asked, visible).has_value());
            REQUIRE(crowd.world.view(asked, untouched).has_value());
            REQUIRE(crowd.world.view(both, many).has_value());
            REQUIRE(crowd.world.view(both, many_untouched).has_value());
            for (std::size_t w = 0; w < wrong.size(); ++w) {
                CAPTURE(before);
                CAPTURE(w);
                const Error error = error_of(crowd.world.view(wrong[w], visible));
                CHECK(error.item == kNoItem);
                CHECK_FALSE(error.message.empty());
                CHECK(test::ranges::equal(visible.ids(), untouched.ids()));
                CHECK(test::ranges::equal(visible.verdicts(), untouched.verdicts()));
                CHECK(visible.inside_count() == untouched.inside_count());
                CHECK(visible.has_picture() == untouched.has_picture());
                CHECK(visible.has_occlusion() == untouched.has_occlusion());
                CHECK(test::ranges::equal(visible.occluded_ids(), untouched.occluded_ids()));
                CHECK(visible.triangles().size() == untouched.triangles().size());
                const std::array<ViewRequest, 2> second{asked, wrong[w]};
                CHECK(error_of(crowd.world.view(second, many)).item == 1);
                CHECK(test::ranges::equal(many.ids(), many_untouched.ids()));
                for (std::size_t i = 0; i < many.size(); ++i) CHECK(many.view_mask(i) == many_untouched.view_mask(i));
                CHECK(many.view_count() == 2);
                for (std::size_t v = 0; v < 2; ++v) {
                    CHECK((many.occlusion_buffer(v) == nullptr) == (many_untouched.occlusion_buffer(v) == nullptr));
                    CHECK(many.triangles(v).size() == many_untouched.triangles(v).size());
                }
            }
        }
        std::array<ViewRequest, 2> orders{crowd.request(0, {}), crowd.request(1, {})};
        orders[1].order = cull::ResultOrder::tree;
        MultiViewResult many;
        CHECK(error_of(crowd.world.view(orders, many)).item == 1);
    }

    TEST_CASE("in tree order, what is not hidden comes as it does without occlusion, and what is hidden is listed") {
        NearMisses random(99);
        Town town(random, {}, 800);
        REQUIRE(town.world.update().has_value());
        std::size_t hidden = 0;
        for (int trial = 0; trial < 20; ++trial) {
            ViewRequest request{.camera = town.camera(random), .order = cull::ResultOrder::tree};
            ViewResult plain, ascending, tree;
            REQUIRE(town.world.view(request, plain).has_value());
            request.occlusion = OcclusionOptions{.list_occluded = true};
            REQUIRE(town.world.view(request, tree).has_value());
            MultiViewResult many;
            REQUIRE(town.world.view(std::span(&request, 1), many).has_value());
            request.order = cull::ResultOrder::ascending;
            REQUIRE(town.world.view(request, ascending).has_value());
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
            std::vector<std::uint32_t> of_many(many.ids().begin(), many.ids().end());
            std::sort(of_many.begin(), of_many.end());
            CHECK(test::ranges::equal(ascending.ids(), of_many));
        }
        CHECK(hidden > 100);
    }

    TEST_CASE("an object's verdict does not depend on the order in which a view lists objects") {
        const Crowd crowd;
        ViewResult tree, ascending;
        REQUIRE(crowd.world.view({.camera = crowd.camera, .order = cull::ResultOrder::tree}, tree).has_value());
        REQUIRE(crowd.world.view({.camera = crowd.camera}, ascending).has_value());
        REQUIRE(ascending.size() > 10);
        REQUIRE(ascending.size() < crowd.objects.size());
        for (const ObjectHandle object : crowd.objects) {
            const auto listed = std::find(ascending.ids().begin(), ascending.ids().end(), object.index);
            const auto expected =
                listed == ascending.ids().end()
                    ? occlude::Verdict::outside
                    : static_cast<occlude::Verdict>(
                          ascending.verdicts()[static_cast<std::size_t>(listed - ascending.ids().begin())]);
            CHECK(ascending.verdict_of(object.index) == expected);
            CHECK(tree.verdict_of(object.index) == expected);
        }
    }

    TEST_CASE("many views in ascending order are shared among the executor's threads") {
        const Crowd crowd;
        std::array<ViewRequest, 3> requests;
        for (std::size_t v = 0; v < 3; ++v) requests[v] = crowd.request(v, {});
        for (const bool occlusion : {false, true}) {
            if (occlusion)
                for (ViewRequest& request : requests) request.occlusion.emplace();
            CountingExecutor executor;
            MultiViewResult many;
            REQUIRE(crowd.world.view(requests, many, executor).has_value());
            CHECK(executor.calls > 0);
        }
    }

    TEST_CASE("more than 32 views are refused, and 32 are answered") {
        const Crowd crowd;
        for (const bool occlusion : {false, true}) {
            std::vector<ViewRequest> requests(33, crowd.request(0, {}));
            if (occlusion)
                for (ViewRequest& request : requests) request.occlusion.emplace();
            MultiViewResult many;
            const Error error = error_of(crowd.world.view(requests, many));
            CHECK(error.code == ErrorCode::out_of_range);
            CHECK(error.item == 32);
            CHECK(error.message.find("33 views") != std::string::npos);
            REQUIRE(crowd.world.view(std::span(requests).first(32), many).has_value());
            for (std::size_t i = 0; i < many.size(); ++i) CHECK(many.view_mask(i) == ~0u);
            CHECK(many.size() > 0);
        }
    }
}
