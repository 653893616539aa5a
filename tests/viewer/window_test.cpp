// `crofton view` as a user runs it, under a virtual display: pictures are judged by what they must mean.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "../cli/run_cli.hpp"

#define STBI_ONLY_PNG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

using namespace crofton::test;
using nlohmann::json;

namespace {

struct Pixels {
    int width = 0, height = 0;
    std::vector<unsigned char> rgba;

    explicit Pixels(const std::string& file) {
        int channels = 0;
        unsigned char* data = stbi_load(file.c_str(), &width, &height, &channels, 4);
        REQUIRE_MESSAGE(data != nullptr, file);
        rgba.assign(data, data + 4 * width * height);
        stbi_image_free(data);
    }
    template <class Predicate>
    [[nodiscard]] int count(Predicate is) const {
        int n = 0;
        for (std::size_t i = 0; i < rgba.size(); i += 4)
            n += is(int{rgba[i]}, int{rgba[i + 1]}, int{rgba[i + 2]}) ? 1 : 0;
        return n;
    }
    // The hues of the palette, whatever the light on them (docs/viewer.md).
    [[nodiscard]] int green() const {
        return count([](int r, int g, int b) { return g > 60 && g > 2 * r && g > 2 * b; });
    }
    [[nodiscard]] int amber() const {
        return count([](int r, int g, int b) { return r > 80 && g > r / 2 && g < r && b < g / 2; });
    }
    [[nodiscard]] int red() const {
        return count([](int r, int g, int b) { return r > 80 && g < r / 3 && b < r / 3; });
    }
    [[nodiscard]] int magenta() const {
        return count([](int r, int g, int b) { return r > 80 && b > r / 2 && g < r / 3; });
    }
    [[nodiscard]] int different(const Pixels& other) const {
        int n = 0;
        for (std::size_t i = 0; i < std::min(rgba.size(), other.rgba.size()); i += 4)
            n += std::equal(rgba.begin() + static_cast<std::ptrdiff_t>(i),
                            rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3,
                            other.rgba.begin() + static_cast<std::ptrdiff_t>(i))
                     ? 0
                     : 1;
        return n;
    }
};

bool have(const char* program) {
    return std::system((std::string("command -v ") + program + " >/dev/null 2>&1").c_str()) == 0;
}

// Runs a script in a window on a virtual display of its own, with validation, and hands back the JSON.
struct ViewRun {
    CliRun run;
    json document;
};

ViewRun view(const json& events, const std::string& arguments = {}, bool window = true) {
    const std::string script = scratch().file("script.json"), out = scratch().file("out.json");
    std::filesystem::remove(out);
    write_contents(script, json{{"events", events}}.dump());
    const std::string all = "view --instances 400 --size 480x270 --validation --device cpu --output '" +
                            scratch().file("") + "' --script '" + script + "' --json '" + out + "' " +
                            (window ? "" : "--no-window ") + arguments;
    ViewRun result;
    const std::string err = scratch().file("view_stderr");
    const std::string command = std::string(window ? "xvfb-run -a " : "") + "'" CROFTON_CLI "' " + all +
                                " >/dev/null 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    result.run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.run.err = contents_of(err);
    result.document = json::parse(contents_of(out), nullptr, false);
    return result;
}

// A clean run: it ended well, every prediction came true, and validation had nothing to say.
void check_clean(const ViewRun& result) {
    INFO(result.run.err);
    REQUIRE(result.run.status == 0);
    REQUIRE(result.document.is_object());
    CHECK(result.document["validation_messages"].empty());
    for (const json& frame : result.document["frames"]) {
        CHECK(frame["gpu"]["clipping_primitives"] == frame["triangles_clipped"]);
        CHECK(frame["gpu"]["input_assembly_primitives"] == frame["triangles_submitted"]);
    }
}

json shot(int frame, const std::string& name) {
    return {{"frame", frame}, {"screenshot", scratch().file(name)}};
}
json set(int frame, const json& switches) {
    return {{"frame", frame}, {"set", switches}};
}

// A square of 2 m across the z axis, its colour (1/4, 1/2, 1/16).
std::string square_gltf(bool unlit) {
    json material{{"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.0625, 1.0}}}}};
    if (unlit) material["extensions"] = {{"KHR_materials_unlit", json::object()}};
    // Base64 of the floats −1 −1 0, 1 −1 0, 1 1 0, −1 −1 0, 1 1 0, −1 1 0.
    const std::string data =
        "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAA";
    return json{{"asset", {{"version", "2.0"}}},
                {"scenes", {{{"nodes", {0}}}}},
                {"nodes", {{{"mesh", 0}}}},
                {"materials", {material}},
                {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}}}},
                {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}}}},
                {"bufferViews", {{{"buffer", 0}, {"byteLength", 72}}}},
                {"buffers", {{{"byteLength", 72}, {"uri", "data:application/octet-stream;base64," + data}}}}}
        .dump();
}

const json& picture(const ViewRun& result, const std::string& name) {
    for (const json& entry : result.document["pictures"])
        if (entry["file"] == scratch().file(name)) return entry;
    FAIL("no picture " << name);
    return result.document;
}

}  // namespace

#define CROFTON_REQUIRE_DISPLAY()                      \
    if (!have("xvfb-run")) {                           \
        MESSAGE("skipped: xvfb-run is not installed"); \
        return;                                        \
    }

TEST_SUITE("viewer/window") {
    TEST_CASE("bad usage and bad scenes end with exit 2 and a message; no picture is left behind") {
        CHECK(run_cli("view --no-window").status == 2);
        CHECK(run_cli("view --no-window --screenshot x.png").status == 2);
        CHECK(run_cli("view --size big --after 1").status == 2);
        const CliRun missing =
            run_cli("view nowhere.glb --no-window --after 1 --screenshot " + scratch().file("none.png"));
        CHECK(missing.status == 2);
        CHECK(missing.err.find("nowhere.glb") != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(scratch().file("none.png")));
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
    TEST_CASE("verdict colours appear exactly where the statistics say there is something to colour") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "verdict"}}),
                                     shot(1, "street.png"),
                                     {{"frame", 2}, {"key", "Home"}},
                                     shot(3, "above.png"),
                                     set(4, {{"coloring", "lit"}}),
                                     shot(5, "lit.png")});
        check_clean(result);
        const json& street = picture(result, "street.png")["statistics"];
        const Pixels pixels(scratch().file("street.png"));
        REQUIRE(street["inside"] > 0);
        REQUIRE(street["straddling"] > 0);
        CHECK(pixels.green() > 200);
        CHECK(pixels.amber() > 200);
        CHECK(pixels.red() + pixels.magenta() == 0);
        for (const json& tint : picture(result, "street.png")["tints"])
            CHECK(tint["instances"] == street[tint["name"].get<std::string>()]);
        const json& above = picture(result, "above.png")["statistics"];
        const Pixels seen(scratch().file("above.png"));
        CHECK((seen.green() > 0) == (above["inside"] > 0));
        CHECK((seen.amber() > 0) == (above["straddling"] > 0));
    }
    TEST_CASE("freeze keeps what is culled while the eye flies on; culled boxes, frustum and inset are drawn") {
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
    TEST_CASE("bounds, tree levels, wires and shapes change the picture as they should") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}}),
                                     shot(1, "plain.png"),
                                     {{"frame", 2}, {"key", "B"}},
                                     shot(3, "bounds.png"),
                                     {{"frame", 4}, {"key", "B"}},
                                     {{"frame", 4}, {"key", "T"}},
                                     shot(5, "tree.png"),
                                     set(6, {{"tree_level", -1}, {"wireframe", true}}),
                                     shot(7, "wires.png"),
                                     set(8, {{"wireframe", false}, {"coloring", "shape"}}),
                                     shot(9, "shape.png"),
                                     set(10, {{"coloring", "depth"}}),
                                     shot(11, "depth.png"),
                                     set(12, {{"coloring", "lit"}}),
                                     shot(13, "again.png")});
        check_clean(result);
        CHECK(picture(result, "bounds.png")["lines"] ==
              12 * picture(result, "bounds.png")["statistics"]["visible"].get<int>());
        CHECK(picture(result, "tree.png")["lines"].get<int>() % 12 == 0);
        CHECK(picture(result, "tree.png")["lines"] > 0);
        const Pixels plain(scratch().file("plain.png")), wires(scratch().file("wires.png"));
        const auto dark = [](int r, int g, int b) { return r + g + b < 60; };
        CHECK(wires.count(dark) > plain.count(dark) + 500);
        CHECK(Pixels(scratch().file("shape.png")).different(plain) > 5000);
        int instances = 0;
        for (const json& tint : picture(result, "depth.png")["tints"]) instances += tint["instances"].get<int>();
        CHECK(picture(result, "depth.png")["statistics"]["visible"] == instances);
        CHECK(Pixels(scratch().file("again.png")).different(plain) == 0);  // nothing sticks
    }
    TEST_CASE("improper tests and collisions are coloured where they are counted") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({set(0, {{"panels", false}, {"coloring", "improper"}, {"bounds_kind", "sphere"}}),
                                     shot(2, "improper.png"),
                                     set(3, {{"coloring", "collision"}}),
                                     {{"frame", 3}, {"key", "Home"}},
                                     shot(5, "collision.png"),
                                     {{"frame", 6}, {"key", "K"}},
                                     shot(7, "none.png")});
        check_clean(result);
        const json& improper = picture(result, "improper.png");
        for (const json& tint : improper["tints"])
            if (tint["name"] == "improper") CHECK(tint["instances"] == improper["statistics"]["improper"]);
        const json& collision = picture(result, "collision.png");
        CHECK((collision["statistics"]["colliding_pairs"] > 0) == (Pixels(scratch().file("collision.png")).red() > 0));
        // Near misses show what separates them; both kinds go with the collisions.
        CHECK(collision["separations"] > 0);
        CHECK(picture(result, "none.png")["separations"] == 0);
        CHECK(picture(result, "none.png")["contacts"] == 0);
        CHECK(picture(result, "none.png")["lines"] == 0);
        CHECK(picture(result, "none.png")["statistics"]["colliding_pairs"] == 0);
        CHECK(Pixels(scratch().file("none.png")).red() == 0);
    }
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
    TEST_CASE("a click picks what is in the middle, and clicking the sky lets go") {
        CROFTON_REQUIRE_DISPLAY();
        const ViewRun result = view({set(0, {{"panels", false}}),
                                     {{"frame", 1}, {"click", {240, 250}}},
                                     shot(2, "picked.png"),
                                     {{"frame", 3}, {"camera", {{"position", {0, 50, 0}}, {"forward", {0, 1, 0.1}}}}},
                                     {{"frame", 4}, {"click", {240, 135}}},
                                     shot(5, "sky.png")});
        check_clean(result);
        CHECK(picture(result, "picked.png").contains("selected"));
        CHECK_FALSE(picture(result, "sky.png").contains("selected"));
    }
    TEST_CASE("the window is resized and the picture follows; tiny and large sizes too") {
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
    TEST_CASE("a path flown by keys is recorded and replays; exports are complete") {
        const ViewRun flown = view({{{"frame", 1}, {"key", "R"}},
                                    {{"frame", 1}, {"key_down", "W"}},
                                    {{"frame", 9}, {"key_up", "W"}},
                                    {{"frame", 9}, {"key", "R"}},
                                    {{"frame", 10}, {"key", "F5"}},
                                    {{"frame", 11}, {"quit", true}}},
                                   {}, false);
        check_clean(flown);
        const json path = json::parse(contents_of(scratch().file("camera_path.json")), nullptr, false);
        REQUIRE(path["cameras"].size() == 8);
        CHECK(path["cameras"][0]["position"] != path["cameras"][7]["position"]);
        const ViewRun replayed =
            view({{{"frame", 8}, {"quit", true}}}, "--camera '" + scratch().file("camera_path.json") + "'", false);
        check_clean(replayed);
        CHECK(replayed.document["frames"][7]["camera"]["position"] == path["cameras"][7]["position"]);
        CHECK(json::parse(contents_of(scratch().file("statistics.json")), nullptr, false)["frames"].size() == 10);
        CHECK(
            json::parse(contents_of(scratch().file("statistics_trace.json")), nullptr, false).contains("traceEvents"));
        CHECK(contents_of(scratch().file("statistics.csv")).find("triangles_passed") != std::string::npos);
    }
    TEST_CASE("a scene dropped on the window replaces the old one, and a damaged one leaves it") {
        write_contents(scratch().file("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        write_contents(scratch().file("damaged.obj"), "v 0 0 0\nf 1 2 3\n");
        const ViewRun result = view({shot(1, "town.png"),
                                     {{"frame", 2}, {"drop", scratch().file("one.obj")}},
                                     shot(3, "dropped.png"),
                                     {{"frame", 4}, {"drop", scratch().file("damaged.obj")}},
                                     shot(5, "kept.png")},
                                    {}, false);
        check_clean(result);
        CHECK(picture(result, "dropped.png")["statistics"]["instances"] == 1);
        CHECK(picture(result, "kept.png")["statistics"]["instances"] == 1);
        CHECK(result.run.err.find("damaged.obj") != std::string::npos);
    }
    TEST_CASE("a material without light shows its colour as it is, until it is tinted; one with light is shaded") {
        for (const bool unlit : {true, false}) {
            const std::string file = scratch().file("square.gltf");
            write_contents(file, square_gltf(unlit));
            const json eye{{"position", {0, 0, 3}}, {"forward", {0, 0, -1}}};
            const ViewRun result = view({set(0, {{"panels", false}}),
                                         {{"frame", 0}, {"drop", file}},
                                         {{"frame", 1}, {"camera", eye}},
                                         shot(2, "square.png"),
                                         set(3, {{"coloring", "verdict"}}),
                                         shot(4, "tinted.png")},
                                        {}, false);
            check_clean(result);
            // Square roots of 1/4, 1/2 and 1/16 in bytes.
            const auto as_given = [](int r, int g, int b) {
                return std::abs(r - 128) <= 1 && std::abs(g - 180) <= 1 && std::abs(b - 64) <= 1;
            };
            const int count = Pixels(scratch().file("square.png")).count(as_given);
            CHECK((unlit ? count > 5000 : count == 0));
            CHECK(Pixels(scratch().file("tinted.png")).count(as_given) == 0);
            CHECK(Pixels(scratch().file("tinted.png")).green() > 5000);
        }
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
