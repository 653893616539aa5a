// SPDX-License-Identifier: MIT
// The culling camera stays, the eye flies on; time stands still, or does not.
#include "view_run.hpp"

using namespace crofton::test;

TEST_SUITE("viewer/freeze") {
    TEST_CASE("freeze keeps what is culled while the eye flies on, culled boxes, frustum and inset are drawn") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "verdict"}}),
                                     shot(1, "before.png"),
                                     {{"frame", 2}, {"key", "F"}},
                                     {{"frame", 3}, {"key", "Home"}},
                                     shot(4, "frozen.png"),
                                     set(5, {{"outside", true}}),
                                     shot(6, "outside.png"),
                                     set(7, {{"inset", true}, {"panels", true}}),
                                     shot(8, "inset.png"),
                                     set(9, {{"freeze", false}}),
                                     shot(10, "thawed.png")});
        check_clean(result);
        const json &before = picture(result, "before.png"), &frozen = picture(result, "frozen.png");
        CHECK(frozen["statistics"]["visible"] == before["statistics"]["visible"]);
        CHECK(frozen["statistics"]["camera"] == before["statistics"]["camera"]);
        CHECK(frozen["eye"] != before["eye"]);
        CHECK(before["lines"] == 0);
        CHECK(frozen["lines"] == 12);  // the frustum
        const json& outside = picture(result, "outside.png");
        const json& s = outside["statistics"];
        CHECK(outside["lines"] == 12 + 12 * (s["instances"].get<int>() - s["visible"].get<int>()));
        CHECK(Pixels(scratch().file("outside.png")).different(Pixels(scratch().file("frozen.png"))) > 500);
        CHECK(picture(result, "thawed.png")["statistics"]["camera"] == picture(result, "thawed.png")["eye"]);
    }
    TEST_CASE("owned pixels are counted for each picture, from the culling eye, unless switched off") {
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}}),
                                     shot(1, "before.png"),
                                     {{"frame", 2}, {"key", "F"}},
                                     {{"frame", 3}, {"key", "Home"}},
                                     shot(4, "frozen.png"),
                                     set(5, {{"occlude", true}, {"inset", true}}),
                                     shot(6, "occluded.png"),
                                     set(7, {{"seen", false}}),
                                     shot(8, "off.png")},
                                    {}, false);
        check_clean(result);
        const json& before = picture(result, "before.png")["statistics"];
        REQUIRE(before["triangles_seen"].is_number());
        CHECK(before["triangles_seen"].get<int>() > 0);
        CHECK(before["triangles_seen"].get<int>() <= before["triangles_passed"].get<int>());
        CHECK(before["instances_seen"].get<int>() <= before["visible"].get<int>());
        for (const char* name : {"frozen.png", "occluded.png"})
            for (const char* field : {"triangles_seen", "instances_seen"})
                CHECK(picture(result, name)["statistics"][field] == before[field]);
        CHECK(picture(result, "off.png")["statistics"]["triangles_seen"].is_null());
        // Every thirtieth frame, and those of pictures.
        CHECK(result.document["frames"][0]["triangles_seen"].is_number());
        CHECK(result.document["frames"][2]["triangles_seen"].is_null());
    }
    TEST_CASE("time stands still when paused, and steps frame by frame") {
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}}),
                                     shot(1, "a.png"),
                                     shot(6, "b.png"),
                                     {{"frame", 7}, {"key", "."}},
                                     shot(7, "c.png"),
                                     {{"frame", 8}, {"key", "Home"}},
                                     {{"frame", 8}, {"quit", true}}},
                                    {}, false);
        check_clean(result);
        CHECK(Pixels(scratch().file("a.png")).different(Pixels(scratch().file("b.png"))) == 0);
        CHECK(Pixels(scratch().file("c.png")).different(Pixels(scratch().file("b.png"))) > 0);
    }
}
