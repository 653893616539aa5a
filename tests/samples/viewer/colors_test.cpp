// SPDX-License-Identifier: MIT
// What is coloured and drawn over the scene, against the statistics of the same frame.
#include <cmath>

#include "view_run.hpp"

using namespace crofton::test;

namespace {

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

}  // namespace

TEST_SUITE("viewer/colors") {
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
    TEST_CASE("a material without light shows its colour as it is, until it is tinted, one with light is shaded") {
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
}
