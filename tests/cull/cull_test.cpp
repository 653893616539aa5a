#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/cull/cull.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

using namespace crofton;
using cull::Verdict;

TEST_SUITE("cull/cull") {
    TEST_CASE("nothing to cull gives nothing") {
        const auto tree = tree::BoxTree::build(std::span<const Obb>{});
        REQUIRE(tree.has_value());
        cull::VisibleSet visible;
        cull::cull(*tree, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 0);
        cull::cull(std::span<const Obb>{}, {}, {*frustum_of(Camera{})}, visible);
        CHECK(visible.size() == 0);
    }

    TEST_CASE("a view that is not finite sees everything in its layers") {
        const oracle::Crowd town = oracle::random_crowd(100, 0.0, 1);
        const auto tree = tree::BoxTree::build(town.boxes, town.layers);
        REQUIRE(tree.has_value());
        cull::View view{*frustum_of(Camera{}), 2u};
        view.frustum.planes[0].offset = std::nan("");
        cull::VisibleSet visible;
        cull::cull(*tree, view, visible);
        std::size_t expected = 0;
        for (const std::uint32_t mask : town.layers) expected += (mask & 2u) != 0;
        CHECK(visible.size() == expected);
        CHECK(std::count(visible.verdicts().begin(), visible.verdicts().end(), Verdict::straddling) ==
              std::ptrdiff_t(expected));
    }

    TEST_CASE("a hundred thousand identical boxes are all seen, or none") {
        Obb box;
        box.half_extents = glm::vec3(0.5f);
        const std::vector<Obb> boxes(100000, box);
        const auto tree = tree::BoxTree::build(boxes);
        REQUIRE(tree.has_value());
        cull::VisibleSet visible;
        Camera camera;
        camera.position = {0.0, 0.0, 5.0};
        cull::cull(*tree, {*frustum_of(camera)}, visible);
        CHECK(visible.size() == boxes.size());
        camera.forward = {0.0, 0.0, 1.0};
        cull::cull(*tree, {*frustum_of(camera)}, visible);
        CHECK(visible.size() == 0);
    }

    TEST_CASE("tree and list give classify's verdicts, sorted, at every offset and in every mode") {
        for (const double offset : {0.0, 1e5, 1e7})
            for (const std::size_t count : {1u, 17u, 3000u}) {
                const oracle::Crowd town = oracle::random_crowd(count, offset, count);
                const auto tree = tree::BoxTree::build(town.boxes, town.layers);
                REQUIRE(tree.has_value());
                oracle::NearMisses random(7, offset);
                cull::VisibleSet from_tree, from_list;
                for (int trial = 0; trial < 25; ++trial) {
                    Camera camera = random.camera();
                    camera.far = camera.near + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera), trial % 3 ? ~0u : 5u};
                    cull::Options options;
                    options.mode = trial % 2 ? cull::Mode::exact : cull::Mode::conservative;
                    std::vector<cull::ItemId> ids;
                    std::vector<Verdict> verdicts;
                    for (std::size_t i = 0; i < count; ++i) {
                        const Verdict verdict = cull::classify(view.frustum, town.boxes[i], options.mode);
                        if (verdict == Verdict::outside || !(town.layers[i] & view.layer_mask)) continue;
                        ids.push_back(static_cast<cull::ItemId>(i));
                        verdicts.push_back(verdict);
                    }
                    cull::cull(*tree, view, from_tree, options);
                    cull::cull(town.boxes, town.layers, view, from_list, options);
                    for (const cull::VisibleSet* visible : {&from_tree, &from_list}) {
                        CHECK(std::ranges::equal(visible->ids(), ids));
                        CHECK(std::ranges::equal(visible->verdicts(), verdicts));
                    }
                    options.order = cull::Order::tree;
                    cull::cull(*tree, view, from_tree, options);
                    std::vector<cull::ItemId> sorted(from_tree.ids().begin(), from_tree.ids().end());
                    std::ranges::sort(sorted);
                    CHECK(sorted == ids);
                }
            }
    }
}
