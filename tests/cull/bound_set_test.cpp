#include <doctest/doctest.h>
#include <crofton/cull/bound_set.hpp>
#include <limits>
#include <oracle/random_boxes.hpp>
#include <vector>

using namespace crofton;
using cull::BoxSet;
using cull::Verdict;

TEST_SUITE("cull/bound_set") {
    TEST_CASE(
        "boxes that are not finite are straddling for every view, and their neighbours are as if they were absent") {
        oracle::Crowd crowd = oracle::random_crowd(200, 0.0, 1);
        crowd.boxes[3].center.x = std::nan("");
        crowd.boxes[17].half_extents.y = std::numeric_limits<float>::infinity();
        crowd.boxes[199].axes[0].x = std::nanf("");
        BoxSet set;
        set.assign(crowd.boxes);
        cull::VerdictBits bits;
        oracle::NearMisses random(2);
        for (int trial = 0; trial < 20; ++trial) {
            const cull::View view{*frustum_of(random.camera())};
            cull::cull(set, crowd.boxes, view, bits);
            for (std::size_t i = 0; i < crowd.boxes.size(); ++i)
                CHECK(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i]));
            CHECK(bits.verdict(17) == Verdict::straddling);
        }
    }

    TEST_CASE("an empty set, a view without planes and normals that are not unit are all answered") {
        BoxSet set;
        cull::VerdictBits bits;
        cull::cull(set, {}, {*frustum_of(Camera{})}, bits);
        CHECK(bits.visible.empty());
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 1);
        set.assign(crowd.boxes);
        cull::cull(set, crowd.boxes, cull::View{}, bits);
        for (std::size_t i = 0; i < 100; ++i) CHECK(bits.verdict(i) == Verdict::inside);
        cull::View scaled{*frustum_of(Camera{})};
        scaled.frustum.planes[1].normal *= 1.9;
        cull::cull(set, crowd.boxes, scaled, bits);
        for (std::size_t i = 0; i < 100; ++i) CHECK(bits.verdict(i) == cull::classify(scaled.frustum, crowd.boxes[i]));
    }

    TEST_CASE("all verdicts are classify's, at every offset and in every mode, after updates too") {
        for (const double offset : {0.0, 1e4, 1e5, 1e6, 1e7})
            for (const std::size_t count : {1u, 63u, 9000u}) {
                oracle::Crowd crowd = oracle::random_crowd(count, offset, count);
                BoxSet set;
                set.assign(crowd.boxes);
                cull::VerdictBits bits;
                oracle::NearMisses random(3, offset);
                for (int trial = 0; trial < 8; ++trial) {
                    Camera camera = random.camera();
                    camera.far = camera.near + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera)};
                    std::vector<std::uint32_t> moved;
                    for (std::uint32_t i = 0; i < count; i += 3) {
                        crowd.boxes[i] = oracle::random_box(random, camera.position, 40.0);
                        moved.push_back(i);
                    }
                    // Some barely touch.
                    for (std::uint32_t i = 0; i < count; i += 15) crowd.boxes[i] = random.box(view.frustum, 1e-9, 1e-3);
                    set.update(moved, crowd.boxes);
                    const cull::Mode mode = trial % 2 ? cull::Mode::exact : cull::Mode::conservative;
                    cull::cull(set, crowd.boxes, view, bits, mode);
                    std::size_t visible = 0;
                    for (std::size_t i = 0; i < count; ++i) {
                        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i], mode));
                        visible += bits.verdict(i) != Verdict::outside;
                    }
                    std::vector<cull::ItemId> ids(visible + 16);
                    REQUIRE(cull::list_bits(bits.visible, ids) == visible);
                    for (std::size_t n = 0; n < visible; ++n) REQUIRE(bits.verdict(ids[n]) != Verdict::outside);
                }
            }
    }
}
