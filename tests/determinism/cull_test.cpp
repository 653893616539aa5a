// SPDX-License-Identifier: MIT
// What a camera sees, in the same bits everywhere.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <oracle/exact_frustum.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

struct Scene {
    std::vector<Frustum> frusta;
    std::vector<Obb> boxes;  // some of which nearly touch one of the frusta
};

Scene scene_at(double offset) {
    Random random(11);
    Scene scene{{}, crowd(3000, offset, 12)};
    for (int view = 0; view < 8; ++view) {
        scene.frusta.push_back(*frustum_of(random_camera(random, offset)));
        const auto corners = *frustum_corners(scene.frusta.back());
        for (int i = 0; i < 200; ++i) scene.boxes.push_back(near_miss(random, scene.frusta.back(), corners));
    }
    return scene;
}

std::uint64_t verdicts(const Scene& scene, Executor& executor) {
    Digest digest;
    const auto tree = *boxtree::BoxTree::build(scene.boxes, {}, executor);
    cull::BoxSet set;
    set.assign(scene.boxes, executor);
    std::vector<cull::View> views;
    for (const Frustum& frustum : scene.frusta) {
        views.push_back({frustum});
        digest.add(frustum.origin).add(frustum.view());
        std::vector<cull::Verdict> verdicts(scene.boxes.size());
        cull::classify(frustum, scene.boxes, verdicts);
        for (const cull::Verdict verdict : verdicts) digest.add(static_cast<std::uint8_t>(verdict));
        cull::VisibleSet visible;
        cull::find_visible(tree, views.back(), visible, {}, executor);
        digest.add(visible.ids()).add(std::uint64_t{visible.inside_count()});
        cull::VerdictBits bits;
        cull::find_visible(set, scene.boxes, views.back(), bits, cull::CullMode::conservative, executor);
        digest.add(bits.visible).add(bits.inside);
    }
    std::vector<std::uint32_t> masks(scene.boxes.size());
    (void)cull::find_visible(set, scene.boxes, {}, views, masks, cull::CullMode::exact, executor);
    return digest.add(masks).value();
}

// Depends on how trees are laid out as well.
std::uint64_t orders(const Scene& scene, Executor& executor) {
    Digest digest;
    const auto tree = *boxtree::BoxTree::build(scene.boxes, {}, executor);
    cull::VisibleSet visible;
    for (const Frustum& frustum : scene.frusta) {
        cull::find_visible(tree, {frustum}, visible, {cull::CullMode::exact, cull::ResultOrder::tree}, executor);
        digest.add(visible.ids()).add(std::uint64_t{visible.inside_count()});
    }
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/cull") {
    TEST_CASE("frusta, verdicts and ids are the same everywhere, far from the origin too") {
        check_everywhere(0x12bcad2cd0a7aefc, [scene = scene_at(0.0)](Executor& e) { return verdicts(scene, e); });
        check_everywhere(0x7a4fe3c9283dce97, [scene = scene_at(1e6)](Executor& e) { return verdicts(scene, e); });
    }

    TEST_CASE("the tree's own order is the same everywhere") {
        check_everywhere(0xa02ad4e8ef48c0cc, [scene = scene_at(0.0)](Executor& e) { return orders(scene, e); });
    }

    TEST_CASE("the published verdicts are those of rational arithmetic") {
        for (const double offset : {0.0, 1e6}) {
            const Scene scene = scene_at(offset);
            for (std::size_t view = 0; view < scene.frusta.size(); ++view)
                for (std::size_t i = 0; i < 40; ++i) {
                    const Obb& box = scene.boxes[3000 + 200 * view + i];
                    CHECK(cull::classify(scene.frusta[view], box) == oracle::classify(scene.frusta[view], box));
                }
        }
    }
}
