// SPDX-License-Identifier: MIT
// `crofton view` starts, ends and survives: usage, displays, drivers, sizes, lost devices.
#include "view_run.hpp"

using namespace crofton::test;

TEST_SUITE("viewer/window") {
    TEST_CASE("bad usage and bad scenes end with exit 2 and a message, no picture is left behind") {
        CHECK(run_cli("view --no-window").status == 2);
        CHECK(run_cli("view --no-window --screenshot x.png").status == 2);
        CHECK(run_cli("view --size big --after 1").status == 2);
        const CliRun missing =
            run_cli("view nowhere.glb --no-window --after 1 --screenshot " + scratch().file("never.png"));
        CHECK(missing.status == 2);
        CHECK(missing.err.find("nowhere.glb") != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(scratch().file("never.png")));
        write_contents(scratch().file("bad.json"), R"({"events": [{"frame": 0, "set": {"coloring": "plaid"}}]})");
        const CliRun script = run_cli("view --no-window --script " + scratch().file("bad.json"));
        CHECK(script.status == 2);
        CHECK(script.err.find("event 0") != std::string::npos);
    }
    TEST_CASE("without a display it says how to run without one") {
        const CliRun run = run_cli("view --after 1", "-u DISPLAY -u WAYLAND_DISPLAY");
        CHECK(run.status == 2);
        CHECK(run.err.find("--no-window") != std::string::npos);
        CHECK(run.err.find("xvfb-run") != std::string::npos);
    }
    TEST_CASE("without a driver it says what to install") {
        const CliRun run = run_cli("view --no-window --after 1",
                                   "VK_ICD_FILENAMES=/nonexistent.json VK_DRIVER_FILES=/nonexistent.json");
        CHECK(run.status == 2);
        CHECK(run.err.find("mesa-vulkan-drivers") != std::string::npos);
    }
    TEST_CASE("it starts, draws the town under sky with its panels, and quits") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({shot(2, "panels.png"), set(3, {{"panels", false}}), shot(4, "plain.png")});
        check_clean(result);
        const Pixels panels(scratch().file("panels.png")), plain(scratch().file("plain.png"));
        CHECK(plain.width == 480);
        CHECK(panels.different(plain) > 480 * 270 / 10);
        CHECK(plain.count([](int r, int, int b) { return b > r + 30; }) > 1000);  // sky
        CHECK(result.document["frames"][4]["ui_us"] == 0.0);
        CHECK(result.document["frames"][1]["ui_us"] > 0.0);
    }
    TEST_CASE("the window is resized and the picture follows, tiny and large sizes too") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({{{"frame", 1}, {"resize", {300, 200}}},
                                     shot(6, "small.png"),
                                     {{"frame", 7}, {"resize", {640, 400}}},
                                     shot(12, "large.png"),
                                     {{"frame", 13}, {"resize", {40, 30}}},
                                     shot(18, "tiny.png")});
        check_clean(result);
        CHECK(Pixels(scratch().file("small.png")).width == 300);
        CHECK(Pixels(scratch().file("large.png")).height == 400);
        CHECK(Pixels(scratch().file("tiny.png")).width == 40);
        CHECK(picture(result, "large.png")["eye"]["aspect"] == doctest::Approx(1.6));
    }
    TEST_CASE("a lower resolution leaves the counts, the picture's size and the panels as they are") {
        const ViewRun result = view({set(0, {{"paused", true}}),
                                     shot(2, "full.png"),
                                     set(3, {{"resolution", 0.5}}),
                                     shot(5, "half.png"),
                                     {{"frame", 6}, {"quit", true}}},
                                    "--size 800x450", false);
        check_clean(result);
        const json &full = picture(result, "full.png")["statistics"], &half = picture(result, "half.png")["statistics"];
        for (const char* count : {"triangles_submitted", "triangles_passed", "triangles_clipped"})
            CHECK(full[count] == half[count]);
        const double share = half["gpu"]["samples_passed"].get<double>() / full["gpu"]["samples_passed"].get<double>();
        CHECK(share > 0.2);
        CHECK(share < 0.3);
        const Pixels a(scratch().file("full.png")), b(scratch().file("half.png"));
        CHECK(a.width == b.width);
        // Edges differ between the two, most of the picture does not.
        CHECK(a.different(b) < a.width * a.height / 2);
    }
    TEST_CASE("a lost device is replaced: a message, the same picture, nothing to say for validation") {
        CROFTON_REQUIRE_DISPLAY();
        for (const bool window : {true, false}) {
            const ViewRun result = view({set(0, {{"paused", true}, {"panels", false}}),
                                         shot(1, "whole.png"),
                                         {{"frame", 2}, {"lose_device", true}},
                                         shot(3, "anew.png"),
                                         set(4, {{"inset", true}, {"panels", true}}),
                                         {{"frame", 6}, {"quit", true}}},
                                        {}, window);
            check_clean(result);
            CHECK(result.run.err.find("VK_ERROR_DEVICE_LOST") != std::string::npos);
            CHECK(Pixels(scratch().file("anew.png")).different(Pixels(scratch().file("whole.png"))) == 0);
        }
    }
    TEST_CASE("texts and panels grow with the display's scale") {
        const json script{{{"frame", 0}, {"resize", {1600, 900}}},
                          shot(2, "panels.png"),
                          set(3, {{"panels", false}}),
                          shot(4, "plain.png")};
        int covered[2];
        for (const int scale : {1, 2}) {
            check_clean(view(script, "--scale " + std::to_string(scale), false));
            covered[scale - 1] = Pixels(scratch().file("panels.png")).different(Pixels(scratch().file("plain.png")));
        }
        CHECK(covered[1] > 3 * covered[0] / 2);
        CHECK(covered[1] < 4 * covered[0]);
    }
    TEST_CASE(
        "a window that comes onto another display takes over its scale, and back, unless --scale says otherwise") {
        json script{set(0, {{"paused", true}}), {{"frame", 0}, {"resize", {1600, 900}}}};
        const auto at = [&](int frame, double scale, const char* name) {
            script.push_back({{"frame", frame}, {"scale", scale}});
            script.push_back(set(frame, {{"panels", true}}));
            script.push_back(shot(frame + 1, std::string(name) + ".png"));
            script.push_back(set(frame + 2, {{"panels", false}}));
            script.push_back(shot(frame + 3, std::string(name) + "_plain.png"));
        };
        at(1, 1.0, "one"), at(5, 2.0, "two"), at(9, 1.0, "back");
        const auto covered = [](const std::string& name) {
            return Pixels(scratch().file(name + ".png")).different(Pixels(scratch().file(name + "_plain.png")));
        };
        const auto nearly = [](int a, int b) { return std::abs(a - b) < b / 20; };
        check_clean(view(script, {}, false));
        const int one = covered("one"), two = covered("two");
        CHECK(two > 3 * one / 2);
        CHECK(nearly(covered("back"), one));
        check_clean(view(script, "--scale 2", false));
        for (const char* name : {"one", "two", "back"}) CHECK(nearly(covered(name), two));
    }
    TEST_CASE("panels fold where a window is too small for them and a picture, and unfold again") {
        const auto shots = [](int frame, int width, int height, const std::string& name) {
            return json{{{"frame", frame}, {"resize", {width, height}}},
                        set(frame, {{"panels", true}}),
                        shot(frame + 2, name + ".png"),
                        set(frame + 3, {{"panels", false}}),
                        shot(frame + 4, name + "_plain.png")};
        };
        json script = json::array({set(0, {{"paused", true}})});
        for (const json& event : shots(1, 320, 200, "small")) script.push_back(event);
        for (const json& event : shots(6, 1280, 720, "large")) script.push_back(event);
        check_clean(view(script, {}, false));
        const auto share = [](const std::string& name) {
            const Pixels panels(scratch().file(name + ".png")), plain(scratch().file(name + "_plain.png"));
            return static_cast<double>(panels.different(plain)) / (panels.width * panels.height);
        };
        CHECK(share("small") < 0.2);
        CHECK(share("large") > 0.2);
        CHECK(share("large") < 0.5);
    }
}
