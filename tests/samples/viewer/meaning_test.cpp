// SPDX-License-Identifier: MIT
// What is drawn over and beside the scene, counted in pixels and compared with what it stands for.
#include <array>
#include <cmath>

#include "view_run.hpp"

using namespace crofton::test;

namespace {

struct Rgb {
    int r, g, b;
};
// Colours of samples/crofton/viewer/overlay.cpp: the first four views, and the tree's bounds.
constexpr std::array<Rgb, 4> kViews{{{255, 90, 90}, {255, 190, 70}, {130, 230, 90}, {70, 220, 220}}};
constexpr Rgb kTree{110, 220, 255};

int count(const Pixels& pixels, const Rgb& color) {
    return pixels.near(color.r, color.g, color.b);
}

// One triangle in front of the eye, with the given top.
void drop_triangle(json& events, int frame, const std::string& name, double x, double y) {
    const std::string file = scratch().file(name + ".obj");
    write_contents(file, "v -1 0 0\nv 1 0 0\nv " + std::to_string(x) + " " + std::to_string(y) + " 0\nf 1 2 3\n");
    events.push_back({{"frame", frame}, {"drop", file}});
    events.push_back({{"frame", frame}, {"camera", {{"position", {0, 0.5, 3}}, {"forward", {0, 0, -1}}}}});
    events.push_back(shot(frame, name + ".png"));
}

}  // namespace

TEST_SUITE("viewer/meaning") {
    TEST_CASE(
        "each of the views into which the depth is split is drawn in its colour, and they see what one view sees") {
        const ViewRun run =
            view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "collision"}, {"collisions", false}}),
                  shot(1, "street.png"),
                  set(2, {{"freeze", true}, {"cascades", 4}}),
                  {{"frame", 3},
                   {"camera", {{"position", {-700, 900, 1800}}, {"forward", {0.4, -0.5, -0.9}}, {"far", 9000}}}},
                  shot(4, "four.png"),
                  set(5, {{"cascades", 2}}),
                  shot(6, "two.png"),
                  set(7, {{"cascades", 1}}),
                  shot(8, "one.png")},
                 {}, false);
        check_clean(run);
        const Pixels four(scratch().file("four.png")), two(scratch().file("two.png")), one(scratch().file("one.png"));
        for (std::size_t i = 0; i < kViews.size(); ++i) {
            CAPTURE(i);
            CHECK(count(four, kViews[i]) > 5);
            CHECK((count(two, kViews[i]) > 0) == (i < 2));
            CHECK(count(one, kViews[i]) == 0);
        }
        CHECK(count(one, {255, 255, 255}) > 20);  // the one frustum is white
        CHECK(picture(run, "four.png")["lines"] == 4 * 12);
        // Every visible instance is in one of the views at least; the first sees most.
        std::uint64_t sum = 0;
        for (const json& seen : picture(run, "four.png")["views"]) sum += seen.get<std::uint64_t>();
        CHECK(sum >= picture(run, "four.png")["statistics"]["visible"].get<std::uint64_t>());
    }
    TEST_CASE(
        "the root's bound is one box, each level's boxes are within the level's number of lanes, none is drawn when "
        "off") {
        json events{set(0, {{"panels", false}, {"paused", true}, {"coloring", "depth"}}),
                    {{"frame", 0}, {"key", "Home"}}};
        for (int level = -1; level < 4; ++level) {
            events.push_back(set(2 * level + 3, {{"tree_level", level}}));
            events.push_back(shot(2 * level + 4, "level" + std::to_string(level) + ".png"));
        }
        const ViewRun run = view(events, {}, false);
        check_clean(run);
        std::vector<int> boxes;
        for (int level = 0; level < 4; ++level) {
            const std::string name = "level" + std::to_string(level) + ".png";
            boxes.push_back(picture(run, name)["lines"].get<int>() / 12);
            CHECK((count(Pixels(scratch().file(name)), kTree) > 20) == (boxes.back() > 0));
        }
        CHECK(picture(run, "level-1.png")["lines"] == 0);
        CHECK(count(Pixels(scratch().file("level-1.png")), kTree) == 0);
        CHECK(boxes[0] == 1);
        CHECK(boxes[1] > 1);
        CHECK(boxes[1] <= 16);
        CHECK(boxes[2] <= 16 * boxes[1]);
    }
    TEST_CASE("depths that hold instances are coloured, the others are not") {
        const ViewRun run = view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "depth"}}),
                                  {{"frame", 0}, {"key", "Home"}},
                                  shot(1, "depth.png")},
                                 {}, false);
        check_clean(run);
        // By hue: red, orange, green, turquoise, blue, violet, each as bright as the light makes it.
        const Pixels pixels(scratch().file("depth.png"));
        const std::array<int, 6> seen{
            pixels.count([](int r, int g, int b) { return r > 60 && 3 * g < 2 * r && 3 * b < 2 * r; }),
            pixels.count([](int r, int g, int b) { return r > 60 && 3 * g >= 2 * r && g < r && 2 * b < r; }),
            pixels.count([](int r, int g, int b) { return g > 60 && r < g && 3 * b < 2 * g; }),
            pixels.count([](int r, int g, int b) { return g > 60 && 2 * r < g && 3 * b >= 2 * g && 2 * b < 3 * g; }),
            pixels.count([](int r, int g, int b) { return b > 60 && 2 * r < b && 3 * g < 2 * b; }),
            pixels.count([](int r, int g, int b) { return b > 60 && 2 * r >= b && 2 * g < b; })};
        const json& tints = picture(run, "depth.png")["tints"];
        REQUIRE(tints.size() >= seen.size());
        for (std::size_t i = 0; i < seen.size(); ++i) {
            CAPTURE(tints[i]["name"]);
            CHECK((seen[i] > 50) == (tints[i]["instances"] > 0));
        }
    }
    TEST_CASE("an equilateral triangle is green, a sliver red, one between yellow") {
        json events = json::array({set(0, {{"panels", false}, {"coloring", "shape"}})});
        drop_triangle(events, 1, "equilateral", 0.0, std::sqrt(3.0));
        drop_triangle(events, 2, "sliver", 0.0, 0.05);
        drop_triangle(events, 3, "middling", 0.0, 0.55);  // quality 0.73 … 0.8 of 1
        const ViewRun run = view(events, {}, false);
        check_clean(run);
        const Pixels equilateral(scratch().file("equilateral.png")), sliver(scratch().file("sliver.png")),
            middling(scratch().file("middling.png"));
        CHECK(equilateral.green() > 3000);
        CHECK(equilateral.red() == 0);
        CHECK(sliver.red() > 50);
        CHECK(sliver.green() == 0);
        CHECK(middling.red() + middling.green() == 0);
        CHECK(middling.count([](int r, int g, int b) { return r > 60 && g > 60 && 2 * b < g; }) > 1000);
    }
    TEST_CASE("improper tests are magenta where there are some, tight boxes leave fewer than spheres") {
        const ViewRun run =
            view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "improper"}, {"bounds_kind", "sphere"}}),
                  shot(1, "spheres.png"), set(2, {{"bounds_kind", "obb-perimeter"}}), shot(3, "boxes.png")},
                 {}, false);
        check_clean(run);
        const auto improper = [&](const char* name) { return picture(run, name)["statistics"]["improper"].get<int>(); };
        CHECK(improper("spheres.png") > improper("boxes.png"));
        // What straddles without meeting the view has no pixels of its own: the colour shows in the outside picture.
        for (const char* name : {"spheres.png", "boxes.png"})
            for (const json& tint : picture(run, name)["tints"])
                if (tint["name"] == "improper") CHECK(tint["instances"] == improper(name));
        const ViewRun outside = view({set(0, {{"panels", false},
                                              {"paused", true},
                                              {"coloring", "improper"},
                                              {"bounds_kind", "sphere"},
                                              {"freeze", true}}),
                                      {{"frame", 1}, {"key", "F"}},
                                      {{"frame", 2}, {"key", "F"}},
                                      {{"frame", 3}, {"key", "Home"}},
                                      shot(4, "seen.png"),
                                      set(5, {{"coloring", "verdict"}}),
                                      shot(6, "verdicts.png")},
                                     {}, false);
        check_clean(outside);
        CHECK(outside.document["pictures"][0]["statistics"]["improper"] > 0);
        CHECK(Pixels(scratch().file("seen.png")).magenta() > 10);
        CHECK(Pixels(scratch().file("verdicts.png")).magenta() == 0);
    }
    TEST_CASE("movers move with the time's scale, stand with none, and step by one") {
        json events = json::array({set(0, {{"panels", false}, {"time_scale", 4.0}})});
        for (const auto& [frame, name] : {std::pair{1, "a.png"}, {6, "b.png"}}) events.push_back(shot(frame, name));
        events.push_back(set(7, {{"time_scale", 0.0}}));
        events.push_back(shot(8, "c.png"));
        events.push_back(shot(12, "d.png"));
        events.push_back({{"frame", 13}, {"key", "."}});
        events.push_back(shot(13, "e.png"));
        const ViewRun run = view(events, {}, false);
        check_clean(run);
        const auto time = [&](const char* name) { return picture(run, name)["scene_frame"].get<int>(); };
        CHECK(time("b.png") - time("a.png") == 20);
        CHECK(time("d.png") == time("c.png"));
        CHECK(time("e.png") == time("d.png") + 1);
        const auto moved = [](const char* a, const char* b) {
            return Pixels(scratch().file(a)).different(Pixels(scratch().file(b)));
        };
        CHECK(moved("a.png", "b.png") > 0);
        CHECK(moved("c.png", "d.png") == 0);
        CHECK(moved("d.png", "e.png") > 0);
    }
    TEST_CASE("a picked object turns blue, gets a box with axes, and is described in the scene panel") {
        const ViewRun run =
            view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "collision"}, {"collisions", false}}),
                  shot(1, "none.png"),
                  {{"frame", 2}, {"click", {240, 250}}},
                  shot(3, "picked.png"),
                  set(4, {{"panels", true}}),
                  shot(5, "told.png"),
                  {{"frame", 6}, {"camera", {{"position", {0, 50, 0}}, {"forward", {0, 1, 0.1}}}}},
                  {{"frame", 7}, {"click", {240, 135}}},
                  shot(8, "sky.png")},
                 {}, false);
        check_clean(run);
        const auto blue = [](int r, int g, int b) { return b > 90 && 2 * r < b && 10 * g > 3 * b && g < b; };
        CHECK(Pixels(scratch().file("none.png")).count(blue) == 0);
        CHECK(Pixels(scratch().file("picked.png")).count(blue) > 100);
        CHECK(picture(run, "picked.png")["lines"] == 12 + 3);
        CHECK(picture(run, "none.png")["lines"] == 0);
        int selected = 0;
        for (const json& tint : picture(run, "picked.png")["tints"])
            if (tint["name"] == "selected") selected = tint["instances"].get<int>();
        CHECK(selected == 1);
        CHECK_FALSE(picture(run, "sky.png").contains("selected"));
    }
    TEST_CASE("the histogram of frame times has a bar for each span of 5 ms that was met") {
        const ViewRun run =
            view({set(0, {{"history", true}, {"paused", true}, {"coloring", "collision"}, {"collisions", false}}),
                  {{"frame", 0}, {"resize", {800, 1400}}},
                  shot(12, "history.png")},
                 {}, false);
        check_clean(run);
        std::array<int, 20> bins{};
        for (std::size_t i = 0; i < 12; ++i)
            ++bins[std::min<std::size_t>(
                static_cast<std::size_t>(run.document["frames"][i]["frame_us"].get<double>() / 5000.0), 19)];
        const auto expected = std::count_if(bins.begin(), bins.end(), [](int n) { return n > 0; });
        // Runs of ImGui's histogram colour along the row where each bar stands on its ground: the lowest that has it.
        const Pixels pixels(scratch().file("history.png"));
        const auto is_bar = [&](int x, int y) {
            const auto i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels.width) +
                                static_cast<std::size_t>(x));
            return pixels.rgba[i] > 200 && std::abs(pixels.rgba[i + 1] - 178) < 30 && pixels.rgba[i + 2] < 60;
        };
        int bars = 0;
        for (int y = pixels.height - 1; y >= 0 && bars == 0; --y)
            for (int x = 1; x < 400; ++x) bars += is_bar(x, y) && !is_bar(x - 1, y) ? 1 : 0;
        CHECK(bars >= 1);
        CHECK(bars <= expected);
        // The lines: grey on dark, several plots of them.
        CHECK(pixels.near(156, 156, 156, 16) > 200);
    }
    TEST_CASE("compared, A and B find what each finds alone") {
        const auto run = [](const json& settings) {
            json all = settings;
            all["paused"] = true;
            const ViewRun result = view({set(0, all), shot(1, "compared.png")}, {}, false);
            check_clean(result);
            return picture(result, "compared.png");
        };
        const json both = run(
            {{"compare", true}, {"bounds_kind", "obb-area"}, {"other_bounds_kind", "sphere"}, {"other_cull", "flat"}});
        const json a = run({{"bounds_kind", "obb-area"}}), b = run({{"bounds_kind", "sphere"}, {"cull", "flat"}});
        for (const char* name : {"visible", "inside", "straddling", "improper", "nodes_tested", "triangles_submitted",
                                 "triangles_passed", "colliding_pairs"}) {
            CAPTURE(name);
            CHECK(both["statistics"][name] == a["statistics"][name]);
            CHECK(both["other"][name] == b["statistics"][name]);
        }
        CHECK(both["other"]["improper"] != both["statistics"]["improper"]);
    }
    TEST_CASE("the axes of the tree's bounds change what is tested, not what is found, and are compared as A and B") {
        const ViewRun result = view({set(0, {{"paused", true}, {"compare", true}, {"other_tree", "oriented"}}),
                                     shot(1, "axes.png"),
                                     {{"frame", 2}, {"key", "F4"}},
                                     shot(3, "turned.png")},
                                    "--instances 3000 --size 160x90", false);
        check_clean(result);
        const json &axes = picture(result, "axes.png"), &turned = picture(result, "turned.png");
        CHECK(axes["settings"]["tree"] == "aligned");
        CHECK(turned["settings"]["tree"] == "oriented");
        for (const char* name : {"visible", "inside", "straddling", "triangles_passed"}) {
            CAPTURE(name);
            CHECK(axes["other"][name] == axes["statistics"][name]);
            CHECK(turned["statistics"][name] == axes["statistics"][name]);
        }
        CHECK(axes["other"]["nodes_tested"] != axes["statistics"]["nodes_tested"]);
        CHECK(turned["statistics"]["nodes_tested"] == axes["other"]["nodes_tested"]);
    }
    TEST_CASE("the inset shows the frozen frustum from outside, white and unmoved by the eye") {
        const auto corner = [](const char* name) {
            // The inset's picture lies at the bottom right, under its title.
            const Pixels pixels(scratch().file(name));
            int white = 0;
            for (int y = pixels.height - 225; y < pixels.height - 16; ++y)
                for (int x = pixels.width - 400; x < pixels.width - 16; ++x) {
                    const auto i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels.width) +
                                        static_cast<std::size_t>(x));
                    white += pixels.rgba[i] > 245 && pixels.rgba[i + 1] > 245 && pixels.rgba[i + 2] > 245 ? 1 : 0;
                }
            return white;
        };
        const ViewRun run =
            view({{{"frame", 0}, {"resize", {900, 500}}},
                  set(0, {{"paused", true}, {"coloring", "verdict"}}),
                  shot(2, "without.png"),
                  set(3, {{"inset", true}}),
                  {{"frame", 4}, {"key", "F"}},
                  shot(5, "frozen.png"),
                  {{"frame", 6}, {"camera", {{"position", {-50, 30, 40}}, {"forward", {0.5, -0.2, -1}}}}},
                  shot(7, "flown.png")},
                 {}, false);
        check_clean(run);
        CHECK(corner("without.png") < 20);
        CHECK(corner("frozen.png") > 100);
        CHECK(corner("flown.png") == corner("frozen.png"));
        CHECK(picture(run, "flown.png")["statistics"]["visible"] ==
              picture(run, "frozen.png")["statistics"]["visible"]);
    }
}
