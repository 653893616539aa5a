// SPDX-License-Identifier: MIT
// Pointer, wheel and keys of a real window, judged by what they do.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "drive.hpp"

using namespace crofton::test;

namespace {

glm::dvec3 vector(const json& value) {
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}
glm::dvec3 position(const json& picture) {
    return vector(picture["eye"]["position"]);
}
glm::dvec3 forward(const json& picture) {
    return glm::normalize(vector(picture["eye"]["forward"]));
}
double yaw(const json& picture) {
    return std::atan2(forward(picture).x, -forward(picture).z);
}
// The angle by which one turned further right, in (−π, π].
double turned(const json& from, const json& to) {
    return std::remainder(yaw(to) - yaw(from), 2.0 * std::acos(-1.0));
}

// Where the check mark is that is in one picture and not in the other.
glm::dvec2 check_mark(const Pixels& with, const Pixels& without) {
    glm::dvec2 sum(0.0);
    int count = 0;
    for (int y = 0; y < with.height; ++y)
        for (int x = 0; x < with.width; ++x) {
            const std::size_t i =
                4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(with.width) + static_cast<std::size_t>(x));
            const bool bright = with.rgba[i + 2] > 200 && with.rgba[i] < 120;
            if (!bright || without.rgba[i + 2] > 200) continue;
            sum += glm::dvec2(x, y);
            ++count;
        }
    REQUIRE(count > 5);
    return sum / static_cast<double>(count);
}

}  // namespace

TEST_SUITE("viewer/input") {
    TEST_CASE("a right drag looks around by 4 mrad a pixel, the wheel sets the speed, W flies forward, Shift faster") {
        CROFTON_REQUIRE_XDOTOOL();
        const ViewRun run = drive(R"(
xdotool key h; shoot
xdotool mousemove 300 300 mousedown 3 mousemove 400 270 mouseup 3; shoot
xdotool mousemove 500 500; shoot
xdotool click 4 click 4 click 5 click 4; shoot
xdotool keydown w; sleep 0.4; xdotool keyup w; shoot
xdotool keydown d; sleep 0.4; xdotool keyup d; shoot
)");
        check_clean(run);
        const json& p = run.document["pictures"];
        REQUIRE(p.size() == 7);
        CHECK(p[0]["settings"]["panels"] == true);
        CHECK(p[1]["settings"]["panels"] == false);
        CHECK(turned(p[1], p[2]) == doctest::Approx(0.4).epsilon(1e-6));
        CHECK(std::asin(forward(p[2]).y) - std::asin(forward(p[1]).y) == doctest::Approx(0.12).epsilon(1e-6));
        CHECK(p[3]["eye"] == p[2]["eye"]);  // let go, the pointer turns nothing
        CHECK(p[4]["speed"].get<double>() == doctest::Approx(1.5625 * p[3]["speed"].get<double>()));
        CHECK(p[4]["eye"] == p[3]["eye"]);
        const glm::dvec3 ahead = position(p[5]) - position(p[4]);
        REQUIRE(glm::length(ahead) > 0.0);
        CHECK(glm::dot(glm::normalize(ahead), forward(p[4])) == doctest::Approx(1.0));
        const glm::dvec3 aside = position(p[6]) - position(p[5]);
        REQUIRE(glm::length(aside) > 0.0);
        CHECK(glm::dot(aside, forward(p[4])) == doctest::Approx(0.0));
        CHECK(glm::dot(aside, glm::cross(forward(p[4]), glm::dvec3(0, 1, 0))) > 0.0);
    }
    TEST_CASE("in orbit the wheel comes nearer, and a right drag turns about a centre that stays") {
        CROFTON_REQUIRE_XDOTOOL();
        const ViewRun run = drive(R"(
xdotool key h key Home key Tab; shoot
xdotool click 4; shoot
xdotool mousemove 300 300 mousedown 3 mousemove 380 260 mouseup 3; shoot
xdotool key ctrl+3 key Home; shoot
xdotool key 3; shoot
)");
        check_clean(run);
        const json& p = run.document["pictures"];
        REQUIRE(p.size() == 6);
        CHECK(p[1]["orbit"] == true);
        // A step of the wheel leaves 0.87 of the distance.
        const glm::dvec3 nearer = position(p[2]) - position(p[1]);
        const double distance = glm::length(nearer) / 0.13 * 0.87;
        CHECK(glm::dot(glm::normalize(nearer), forward(p[1])) == doctest::Approx(1.0));
        const glm::dvec3 before = position(p[2]) + distance * forward(p[2]);
        const glm::dvec3 after = position(p[3]) + distance * forward(p[3]);
        CHECK(glm::length(after - before) < 1e-6 * distance);
        CHECK(turned(p[2], p[3]) == doctest::Approx(-0.32).epsilon(1e-6));
        // The bookmark brings it back.
        CHECK(p[4]["eye"]["position"] != p[3]["eye"]["position"]);
        CHECK(glm::length(position(p[5]) - position(p[3])) < 1e-9);
    }
    TEST_CASE("a click on a panel's checkbox does what its key does, and picks nothing behind the panel") {
        CROFTON_REQUIRE_XDOTOOL();
        // First where the box is, from what its key changes in the picture.
        const ViewRun keys = drive("xdotool key p key l; shoot\nxdotool key l; shoot\n");
        check_clean(keys);
        REQUIRE(keys.document["pictures"].size() == 3);
        const std::string folder = scratch().file("driven") + "/";
        const auto file = [&](std::size_t i) {
            return folder + keys.document["pictures"][i]["file"].get<std::string>();
        };
        CHECK(keys.document["pictures"][1]["settings"]["exact"] == false);
        CHECK(keys.document["pictures"][2]["settings"]["exact"] == true);
        const glm::dvec2 at = check_mark(Pixels(file(2)), Pixels(file(1)));
        const std::string click = "xdotool mousemove " + std::to_string(static_cast<int>(at.x)) + " " +
                                  std::to_string(static_cast<int>(at.y)) + " click 1\n";
        // The click must be seen by two frames: one for each way of the button.
        const ViewRun clicked = drive("xdotool key p\n" + click + "shoot\nshoot\n" + click + "shoot\nshoot\n");
        check_clean(clicked);
        const json& p = clicked.document["pictures"];
        REQUIRE(p.size() == 5);
        CHECK(p[0]["settings"]["exact"] == true);
        CHECK(p[2]["settings"]["exact"] == false);
        CHECK(p[4]["settings"]["exact"] == true);
        for (const json& picture : p) CHECK_FALSE(picture.contains("selected"));
    }
    TEST_CASE("a click picks the instance that a script's click at the same place picks, a click on the sky lets go") {
        CROFTON_REQUIRE_XDOTOOL();
        const ViewRun run = drive(R"(
xdotool key h key p; shoot
xdotool mousemove 300 450 click 1; shoot
xdotool mousemove 400 300 mousedown 3 mousemove 400 20 mouseup 3 click 1; shoot
)");
        check_clean(run);
        const json& p = run.document["pictures"];
        REQUIRE(p.size() == 4);
        REQUIRE(p[2].contains("selected"));
        CHECK_FALSE(p[3].contains("selected"));
        json camera = p[2]["eye"];
        camera["scene_frame"] = p[2]["scene_frame"];
        write_contents(scratch().file("there.json"), json{{"cameras", {camera}}}.dump());
        const ViewRun scripted = view({{{"frame", 1}, {"click", {300, 450}}}, shot(2, "there.png")},
                                      "--size 800x600 --camera '" + scratch().file("there.json") + "'", false);
        check_clean(scripted);
        CHECK(picture(scripted, "there.png")["selected"] == p[2]["selected"]);
    }
    TEST_CASE("minimised, the viewer rests, restored, it goes on, sizes may change with every frame") {
        CROFTON_REQUIRE_XDOTOOL();
#ifndef CROFTON_X_DESKTOP
        MESSAGE("skipped: Xlib's headers are not installed (third_party/install.sh)");
#else
        const ViewRun run = drive("'" CROFTON_X_DESKTOP "' minimise $window\nsleep 2\n'" CROFTON_X_DESKTOP
                                  "' restore $window\nshoot\n"
                                  "for i in $(seq 25); do xdotool windowsize $window $((50 + i * 31)) $((40 + i * 17 % "
                                  "400)); done\n"
                                  "xdotool windowsize --sync $window 640 400; shoot; shoot\n");
        check_clean(run);
        const json& p = run.document["pictures"];
        REQUIRE(p.size() == 4);
        CHECK(p[3]["width"] == 640);
        CHECK(p[3]["height"] == 400);
        CHECK(p[3]["eye"]["aspect"] == doctest::Approx(1.6));
#endif
    }
    TEST_CASE("a file dragged onto the window is opened, a broken one leaves the scene, and says so in the window") {
        CROFTON_REQUIRE_XDOTOOL();
#ifndef CROFTON_X_DESKTOP
        MESSAGE("skipped: Xlib's headers are not installed (third_party/install.sh)");
#else
        write_contents(scratch().file("dragged.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        write_contents(scratch().file("broken.obj"), "v 0 0 0\nf 1 2 3\n");
        const auto drop = [](const char* file) {
            return "'" CROFTON_X_DESKTOP "' drop $window '" + scratch().file(file) + "' || exit 7\nshoot\nshoot\n";
        };
        const ViewRun run = drive(drop("dragged.obj") + drop("broken.obj"));
        check_clean(run);
        const json& p = run.document["pictures"];
        REQUIRE(p.size() == 5);
        CHECK(p[0]["scene"] == "town");
        CHECK(p[2]["scene"] == "dragged.obj");
        CHECK(p[2]["statistics"]["instances"] == 1);
        CHECK(p[4]["scene"] == "dragged.obj");
        CHECK(p[4]["messages"].dump().find("broken.obj") != std::string::npos);
        CHECK(p[2]["messages"].dump().find("broken.obj") == std::string::npos);
#endif
    }
}
