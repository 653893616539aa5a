// SPDX-License-Identifier: MIT
// Bounds, culling and triangulation switched live, and two methods compared.
#include "view_run.hpp"

using namespace crofton::test;

TEST_SUITE("viewer/methods") {
    TEST_CASE(
        "methods switch live, two are compared on the same frame, and no method loses what another finds visible") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result =
            view({set(0, {{"paused", true}, {"compare", true}, {"other_bounds_kind", "aabb"}, {"other_cull", "flat"}}),
                  shot(1, "ab.png"), set(2, {{"bounds_kind", "obb-volume"}}), shot(3, "volume.png"),
                  set(4, {{"cull", "none"}, {"cascades", 4}}), shot(5, "all.png"),
                  set(6, {{"exact", false}, {"cull", "tree"}}), shot(7, "planes.png")});
        check_clean(result);
        const json& ab = picture(result, "ab.png");
        CHECK(ab["other"]["triangles_passed"] == ab["statistics"]["triangles_passed"]);
        CHECK(picture(result, "volume.png")["statistics"]["triangles_passed"] == ab["statistics"]["triangles_passed"]);
        const json& all = picture(result, "all.png");
        CHECK(all["statistics"]["visible"] == all["statistics"]["instances"]);
        CHECK(all["statistics"]["triangles_passed"] == ab["statistics"]["triangles_passed"]);
        CHECK(all["views"].size() == 4);
        CHECK(picture(result, "planes.png")["statistics"]["visible"] >=
              picture(result, "volume.png")["statistics"]["visible"]);
    }
    TEST_CASE("triangulations switch live: the same surfaces and counts under other wires, compared side by side") {
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}}),
                                     shot(1, "surface.png"),
                                     set(2, {{"wireframe", true}}),
                                     shot(3, "loaded.png"),
                                     {{"frame", 4}, {"key", "Y"}},  // ear
                                     shot(5, "ear.png"),
                                     set(6, {{"triangulation", "delaunay"}}),
                                     shot(7, "delaunay.png"),
                                     set(8, {{"wireframe", false}}),
                                     shot(9, "same_surface.png"),
                                     set(10, {{"compare", true}, {"other_triangulation", "minimum-weight"}}),
                                     shot(11, "compared.png"),
                                     set(12, {{"triangulation", "loaded"}, {"compare", false}, {"wireframe", true}}),
                                     shot(13, "back.png")},
                                    {}, false);
        check_clean(result);
        CHECK(picture(result, "ear.png")["settings"]["triangulation"] == "ear");
        const json& statistics = picture(result, "surface.png")["statistics"];
        for (const char* name : {"ear.png", "delaunay.png", "compared.png"}) {
            CHECK(picture(result, name)["statistics"]["triangles_submitted"] == statistics["triangles_submitted"]);
            CHECK(picture(result, name)["statistics"]["visible"] == statistics["visible"]);
        }
        CHECK(picture(result, "compared.png")["other"]["triangles_submitted"] == statistics["triangles_submitted"]);
        const Pixels loaded(scratch().file("loaded.png")), ear(scratch().file("ear.png")),
            delaunay(scratch().file("delaunay.png"));
        CHECK(ear.different(loaded) > 200);
        CHECK(ear.different(delaunay) > 200);
        CHECK(Pixels(scratch().file("same_surface.png")).different(Pixels(scratch().file("surface.png"))) < 200);
        CHECK(Pixels(scratch().file("back.png")).different(loaded) == 0);
    }
}
