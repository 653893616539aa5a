// SPDX-License-Identifier: MIT
// Clusters in the colour of why they are drawn or not.
#include "view_run.hpp"

using namespace crofton::test;

namespace {

// One-sided squares of 2 m, facing +z, each at its place and of its size.
std::string squares_gltf(const json& nodes) {
    // Base64 of the floats −1 −1 0, 1 −1 0, 1 1 0, −1 −1 0, 1 1 0, −1 1 0.
    const std::string data =
        "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAA";
    json list = json::array();
    for (std::size_t n = 0; n < nodes.size(); ++n) list.push_back(n);
    return json{{"asset", {{"version", "2.0"}}},
                {"scenes", {{{"nodes", list}}}},
                {"nodes", nodes},
                {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
                {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}}}},
                {"bufferViews", {{{"buffer", 0}, {"byteLength", 72}}}},
                {"buffers", {{{"byteLength", 72}, {"uri", "data:application/octet-stream;base64," + data}}}}}
        .dump();
}

std::uint64_t total(const json& picture, const char* unit) {
    std::uint64_t sum = 0;
    for (const json& fate : picture["clusters"]) sum += fate[unit].get<std::uint64_t>();
    return sum;
}

std::uint64_t triangles_of(const json& picture, const std::string& name) {
    for (const json& fate : picture["clusters"])
        if (fate["name"] == name) return fate["triangles"].get<std::uint64_t>();
    return ~std::uint64_t{0};
}

}  // namespace

TEST_SUITE("viewer/clusters") {
    TEST_CASE("each cluster has the reason that it was made for") {
        const auto at = [](double x, double y, double z, double size) {
            return json{{"mesh", 0}, {"translation", {x, y, z}}, {"scale", {size, size, size}}};
        };
        json away = at(8, 0, -10, 1);
        away["rotation"] = {0, 1, 0, 0};  // half a turn
        const std::string file = scratch().file("squares.gltf");
        // In front; behind it; behind the eye; turned away; tiny, between the samples at 0.5 pixel from the middle.
        write_contents(file,
                       squares_gltf({at(0, 0, -5, 1), at(0, 0, -9, 1), at(0, 0, 5, 1), away, at(0, 3, -10, 1e-6)}));
        const json eye{{"position", {0, 0, 0}}, {"forward", {0, 0, -1}}, {"near", 0.1}, {"far", 100}};
        const ViewRun result = view({set(0, {{"panels", false}}),
                                     {{"frame", 0}, {"drop", file}},
                                     {{"frame", 1}, {"camera", eye}},
                                     set(1, {{"coloring", "clusters"}}),
                                     shot(2, "squares.png")},
                                    {}, false);
        INFO(result.run.err);
        REQUIRE(result.run.status == 0);
        const json& shown = picture(result, "squares.png");
        REQUIRE(shown["clusters"].size() == 5);
        for (const json& fate : shown["clusters"]) {
            CAPTURE(fate["name"].get<std::string>());
            CHECK(fate["clusters"] == 1);
            CHECK(fate["triangles"] == 2);
        }
        CHECK(Pixels(scratch().file("squares.png")).green() > 1000);
    }
    TEST_CASE("the eye that culls sees nothing but what is drawn, and from aside the rest is there") {
        const json eye{{"position", {-57, 2.4, 55}}, {"forward", {0.7, 0.0, -0.7}}, {"near", 0.1}, {"far", 1000}};
        const json aside{{"position", {-78, 62, 92}}, {"forward", {0.50, -0.60, -0.62}}};
        const ViewRun result = view({set(0, {{"panels", false}, {"paused", true}, {"coloring", "clusters"}}),
                                     {{"frame", 0}, {"camera", eye}},
                                     shot(1, "own.png"),
                                     {{"frame", 2}, {"key", "F"}},
                                     {{"frame", 3}, {"camera", aside}},
                                     shot(4, "aside.png"),
                                     set(5, {{"coloring", "lit"}, {"freeze", false}}),
                                     shot(6, "lit.png")},
                                    {}, false);
        INFO(result.run.err);
        REQUIRE(result.run.status == 0);
        const json &own = picture(result, "own.png"), &aside_of = picture(result, "aside.png");
        CHECK(own["clusters"] == aside_of["clusters"]);
        CHECK(own["statistics"]["triangles_clipped"] == own["statistics"]["gpu"]["clipping_primitives"]);
        CHECK(total(own, "triangles") == own["statistics"]["gpu"]["input_assembly_primitives"]);
        // At least what owns a pixel; the rest is more than half of the scene.
        CHECK(triangles_of(own, "drawn") >= own["statistics"]["triangles_seen"].get<std::uint64_t>());
        CHECK(triangles_of(own, "drawn") < total(own, "triangles") / 2);
        const auto magenta = [](int r, int g, int b) { return r > 60 && b > r / 2 && g < r / 2; };
        const auto blue = [](int r, int g, int b) { return b > 60 && r < b / 2 && g < (2 * b) / 3; };
        const Pixels from_eye(scratch().file("own.png")), from_aside(scratch().file("aside.png"));
        CHECK(from_eye.green() > 20'000);
        CHECK(from_eye.count(magenta) == 0);
        CHECK(from_eye.count(blue) == 0);
        CHECK(from_eye.amber() == 0);
        CHECK(from_aside.green() > 1000);
        CHECK(from_aside.count(magenta) > 1000);
        CHECK(from_aside.count(blue) > 200);
        CHECK_FALSE(picture(result, "lit.png").contains("clusters"));
    }
}
