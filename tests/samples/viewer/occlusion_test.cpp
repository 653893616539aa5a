// SPDX-License-Identifier: MIT
// Occlusion in the viewer: what is left out, how it is coloured, what hides it, and the depth buffer as a picture.
#include <array>

#include "view_run.hpp"
#include "viewer/depth_picture.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

std::uint64_t number(const json& entry, const char* name) {
    return entry["statistics"][name].get<std::uint64_t>();
}
std::uint64_t hidden(const json& entry, const char* name) {
    return entry["occlusion"][name].get<std::uint64_t>();
}

// A wall of 8 m across the view, a small triangle behind it and one beside it; the eye is 10 m before the wall.
std::string wall_obj() {
    return "o wall\nv -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3\nf 1 3 4\n"
           "o behind\nv -1 -1 -6\nv 1 -1 -6\nv 0 1 -6\nf 5 6 7\n"
           "o beside\nv 7 -1 -6\nv 9 -1 -6\nv 8 1 -6\nf 8 9 10\n";
}
const json kEye{{"position", {0, 0, 10}}, {"forward", {0, 0, -1}}};

occlude::OcclusionBuffer draw_box(const glm::dvec3& center, const glm::vec3& half_extents) {
    occlude::OccluderSet occluders;
    Obb box;
    box.center = center;
    box.half_extents = half_extents;
    REQUIRE(occluders.place(box));
    auto buffer = occlude::OcclusionBuffer::create({64, 32});
    const auto view = occlude::occlusion_view_of(Camera{});
    REQUIRE(buffer);
    REQUIRE(view);
    buffer->draw(occluders, *view);
    return std::move(*buffer);
}

}  // namespace

TEST_SUITE("viewer/occlusion") {
    TEST_CASE("hidden objects are not drawn, and the picture has the same bits") {
        const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}}),
                                  shot(1, "all.png"),
                                  {{"frame", 2}, {"key", "Z"}},
                                  shot(3, "rest.png"),
                                  {{"frame", 4}, {"key", "Z"}},
                                  shot(5, "again.png")},
                                 {}, false);
        check_clean(run);
        const json &all = picture(run, "all.png"), &rest = picture(run, "rest.png");
        CHECK(Pixels(scratch().file("all.png")).different(Pixels(scratch().file("rest.png"))) == 0);
        CHECK_FALSE(all.contains("occlusion"));
        REQUIRE(hidden(rest, "hidden") > 20);
        CHECK(hidden(rest, "occluders") > 5);
        CHECK(number(rest, "visible") + hidden(rest, "hidden") == number(all, "visible"));
        CHECK(number(rest, "triangles_submitted") + hidden(rest, "triangles_hidden") ==
              number(all, "triangles_submitted"));
        CHECK(2 * number(rest, "triangles_submitted") < number(all, "triangles_submitted"));
        CHECK(number(rest, "inside") + number(rest, "straddling") == number(rest, "visible"));
        CHECK(number(picture(run, "again.png"), "visible") == number(all, "visible"));
    }
    TEST_CASE("hidden instances are magenta from elsewhere, and never from the eye that they are hidden from") {
        const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}, {"occlude", true}}),
                                  set(0, {{"coloring", "occlusion"}}),
                                  shot(1, "eye.png"),
                                  {{"frame", 2}, {"key", "F"}},
                                  {{"frame", 2}, {"key", "Home"}},
                                  shot(3, "above.png")},
                                 {}, false);
        REQUIRE(run.run.status == 0);
        const Pixels eye(scratch().file("eye.png")), above(scratch().file("above.png"));
        CHECK(eye.magenta() == 0);
        CHECK(eye.green() > 200);
        CHECK(eye.amber() > 200);
        CHECK(above.magenta() > 200);
        CHECK(above.green() + above.amber() > 200);
        const json& entry = picture(run, "above.png");
        CHECK(tinted(entry, "hidden") == hidden(entry, "hidden"));
        CHECK(tinted(entry, "visible") + tinted(entry, "visible, hides others") == number(entry, "visible"));
        CHECK(hidden(entry, "hidden") == hidden(picture(run, "eye.png"), "hidden"));
        // Both kinds are drawn.
        for (const json& frame : run.document["frames"])
            if (frame["index"].get<int>() >= 3)
                CHECK(frame["gpu"]["input_assembly_primitives"] ==
                      number(entry, "triangles_submitted") + hidden(entry, "triangles_hidden"));
    }
    TEST_CASE("a click on what is hidden says what hides it, which turns red") {
        write_contents(scratch().file("wall.obj"), wall_obj());
        const ViewRun run = view({{{"frame", 0}, {"drop", scratch().file("wall.obj")}},
                                  {{"frame", 0}, {"camera", kEye}},
                                  set(0, {{"panels", false}, {"occlude", true}, {"coloring", "occlusion"}}),
                                  shot(1, "wall.png"),
                                  {{"frame", 2}, {"key", "F"}},
                                  {{"frame", 3}, {"camera", {{"position", {0, 0, -12}}, {"forward", {0, 0, 1}}}}},
                                  {{"frame", 4}, {"click", {240, 135}}},
                                  shot(5, "picked.png"),
                                  {{"frame", 6}, {"camera", kEye}},
                                  shot(7, "red.png"),
                                  set(8, {{"occlude", false}}),
                                  shot(9, "off.png")},
                                 {}, false);
        REQUIRE(run.run.status == 0);
        const json& wall = picture(run, "wall.png");
        CHECK(number(wall, "visible") == 2);
        CHECK(hidden(wall, "hidden") == 1);
        CHECK(hidden(wall, "triangles_hidden") == 1);
        const json& picked = picture(run, "picked.png");
        REQUIRE(picked.contains("selected"));
        REQUIRE(picked.contains("hidden_by"));
        CHECK(picked["hidden_by"].size() == 1);
        CHECK(tinted(picked, "hides the selected") >= 1);
        CHECK(tinted(picked, "selected") == 1);
        // The wall fills much of the picture.
        CHECK(Pixels(scratch().file("red.png")).red() > 5000);
        CHECK_FALSE(picture(run, "off.png").contains("hidden_by"));
        CHECK(Pixels(scratch().file("off.png")).red() == 0);
    }
    TEST_CASE("baked occluders hide what found ones hide, also after a change of bounds") {
        const std::string file = scratch().file("town.crofton");
        REQUIRE(run_cli("bake town --instances 400 -o " + file).status == 0);
        const json events{set(0, {{"panels", false}, {"paused", true}, {"occlude", true}}),
                          shot(1, "a.png"),
                          set(2, {{"bounds_kind", "aabb"}}),
                          shot(3, "aabb.png"),
                          set(4, {{"bounds_kind", "obb-perimeter"}, {"cull", "flat"}, {"collisions", false}}),
                          shot(5, "flat.png")};
        const ViewRun found = view(events, {}, false), baked = view(events, "--baked '" + file + "'", false);
        check_clean(found);
        check_clean(baked);
        for (const char* name : {"a.png", "aabb.png", "flat.png"}) {
            CAPTURE(name);
            const json &a = picture(found, name), &b = picture(baked, name);
            REQUIRE(hidden(a, "hidden") > 20);
            for (const char* count : {"hidden", "triangles_hidden", "occluders"})
                CHECK(hidden(a, count) == hidden(b, count));
            CHECK(number(a, "visible") == number(b, "visible"));
        }
        CHECK(picture(found, "flat.png")["occlusion"]["hidden"] == picture(found, "a.png")["occlusion"]["hidden"]);
        CHECK(number(picture(found, "flat.png"), "colliding_pairs") == 0);
    }
    TEST_CASE("a file that was baked from another scene, shows nothing, or is missing is refused by name") {
        const std::string file = scratch().file("other.crofton"), bare = scratch().file("bare.crofton"),
                          sets = scratch().file("sets.crofton");
        REQUIRE(run_cli("pvs town --instances 400 --seed 2 --cells 2x1x2 --epsilon 0.1 --out " + sets).status == 0);
        REQUIRE(run_cli("bake town --instances 400 --seed 2 -o " + file).status == 0);
        REQUIRE(run_cli("bake town --instances 400 --no-occluders -o " + bare).status == 0);
        for (const auto& [path, why] : {std::pair{file, "baked of another scene"},
                                        {sets, "baked of another scene"},
                                        {bare, "neither occluders"},
                                        {scratch().file("none.crofton"), "none.crofton"}}) {
            const ViewRun run = view({{{"frame", 0}, {"quit", true}}}, "--baked '" + path + "'", false);
            CHECK(run.run.status == 2);
            CAPTURE(run.run.err);
            CHECK(run.run.err.find(why) != std::string::npos);
            CHECK(run.run.err.find(".crofton") != std::string::npos);
        }
    }
    TEST_CASE("compared, A without what is hidden and B with it have their own counts and times") {
        const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}}), shot(1, "all.png"),
                                  set(2, {{"compare", true}, {"occlude", true}}), shot(3, "ab.png"),
                                  set(4, {{"occlude", false}, {"other_occlude", true}}), shot(5, "ba.png")},
                                 {}, false);
        check_clean(run);
        const json &all = picture(run, "all.png"), &ab = picture(run, "ab.png"), &ba = picture(run, "ba.png");
        for (const char* name :
             {"visible", "inside", "improper", "triangles_submitted", "triangles_passed", "triangles_clipped"}) {
            CAPTURE(name);
            CHECK(ab["other"][name] == all["statistics"][name]);
            CHECK(ba["statistics"][name] == all["statistics"][name]);
            CHECK(ba["other"][name] == ab["statistics"][name]);
        }
        CHECK(ab["other"]["gpu"]["clipping_primitives"] == all["statistics"]["triangles_clipped"]);
        CHECK(ab["other"]["draw_us"] > 0.0);
        CHECK(ba["other_occlusion"]["hidden"] == ab["occlusion"]["hidden"]);
        CHECK(Pixels(scratch().file("all.png")).different(Pixels(scratch().file("ab.png"))) == 0);
    }
    TEST_CASE("the depth buffer is shown with what is open in blue, and says so where occlusion is off") {
        const ViewRun run = view({{{"frame", 0}, {"resize", {900, 500}}},
                                  set(0, {{"paused", true}, {"occlude", true}, {"coloring", "verdict"}}),
                                  shot(1, "without.png"),
                                  {{"frame", 2}, {"key", "J"}},
                                  shot(4, "depth.png"),
                                  set(5, {{"occlude", false}}),
                                  shot(7, "off.png")},
                                 {}, false);
        check_clean(run);
        const auto open = [](const char* name) { return Pixels(scratch().file(name)).near(16, 42, 90, 3); };
        // A sky is open; the street is not.
        const auto covered = [](const char* name) {
            return Pixels(scratch().file(name)).count([](int r, int g, int b) {
                return r > 200 && g < r && b < g && b > 60 && r - b > 30;
            });
        };
        CHECK(open("without.png") == 0);
        CHECK(open("depth.png") > 300);
        CHECK(covered("depth.png") > covered("without.png") + 3000);
        CHECK(open("off.png") == 0);
    }
}

TEST_SUITE("viewer/depth_picture") {
    TEST_CASE("near is lighter than far, what is open has its own colour, the top row comes first") {
        // Above the middle, from the left edge on, 10 to 12 m away.
        const auto buffer = draw_box({-8.0, 4.0, -11.0}, {8.0f, 3.0f, 1.0f});
        viewer::DepthPicture picture;
        viewer::paint_depth(buffer, picture);
        REQUIRE(picture.rgba.size() == 64 * 32);
        const auto at = [&](int x, int y) { return picture.rgba[static_cast<std::size_t>(y * 64 + x)]; };
        CHECK(at(20, 10) == viewer::depth_color(0.0));  // one face, at one depth
        CHECK(at(20, 25) == viewer::kOpenColor);
        CHECK(at(60, 10) == viewer::kOpenColor);
        CHECK(picture.nearest == doctest::Approx(10.0).epsilon(1e-4));
        CHECK(picture.covered > 0.05);
        CHECK(picture.covered < 0.5);
        const auto luminance = [](std::uint32_t c) { return (c & 255) + 2 * (c >> 8 & 255) + (c >> 16 & 255); };
        for (int i = 1; i <= 8; ++i)
            CHECK(luminance(viewer::depth_color(i / 8.0)) < luminance(viewer::depth_color((i - 1) / 8.0)));
    }
    TEST_CASE("a buffer that nothing covers is open everywhere") {
        const auto buffer = draw_box({0.0, 0.0, 50.0}, {1.0f, 1.0f, 1.0f});  // behind the eye
        viewer::DepthPicture picture;
        viewer::paint_depth(buffer, picture);
        CHECK(picture.covered == 0.0);
        CHECK(picture.nearest == 0.0);
        CHECK(picture.farthest == 0.0);
        for (const std::uint32_t pixel : picture.rgba) REQUIRE(pixel == viewer::kOpenColor);
    }
}
