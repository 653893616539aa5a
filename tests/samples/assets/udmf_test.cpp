// SPDX-License-Identifier: MIT
// Levels of text (UDMF) and of Hexen's binary format show what the same level shows in DOOM's.
#include <doctest/doctest.h>
#include <array>
#include <assets/scene_source.hpp>
#include <assets/sector_polygons.hpp>
#include <assets/udmf.hpp>
#include <assets/wad_file.hpp>
#include <cmath>
#include <cstdio>
#include <random>

#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::says;
using test_files::TemporaryFile;
using test_files::Wad;
using test_files::wad_file;

namespace {

// The room with a column of test_files::Wad, as text.
std::string room_text() {
    std::string text = "namespace = \"zdoom\"; // a comment\n/* and\none of lines { */\n";
    const int corners[8][2] = {{0, 0}, {0, 256}, {256, 256}, {256, 0}, {96, 96}, {160, 96}, {160, 160}, {96, 160}};
    for (const auto& c : corners)
        text += "vertex { x = " + std::to_string(c[0]) + ".000; y = " + std::to_string(c[1]) + "; zfloor = 3; }\n";
    for (int i = 0; i < 8; ++i)
        text += "LineDef // " + std::to_string(i) + "\n{\n  V1 = " + std::to_string(i) +
                ";\n  v2=" + std::to_string(4 * (i / 4) + (i + 1) % 4) + "; sidefront = " + std::to_string(i) +
                "; sideback = -1; blocking = true; comment = \"a \\\"}\\\" b\"; }\n";
    for (int i = 0; i < 8; ++i) text += "sidedef { sector = 0; texturemiddle = \"Brick1\"; }";
    return text +
           "sector { heightfloor = 0; heightceiling = 0x80; texturefloor = \"FLOOR4_8\"; textureceiling = "
           "\"CEIL3_5\"; lightlevel = 160; id = 7; }\nthing { x = 32; y = 32; type = 1; }\nunknown { field = 1e3; }";
}

std::string text_wad(const std::string& text) {
    return wad_file({{"MAP01", ""}, {"TEXTMAP", text}, {"ZNODES", "xx"}, {"BLOCKMAP", ""}, {"ENDMAP", ""}});
}

Result<assets::SceneSource> load_level(const std::string& bytes) {
    const TemporaryFile file("level.wad", bytes);
    return assets::load_scene(file.path());
}

void check_same_level(const assets::SceneSource& a, const assets::SceneSource& b) {
    CHECK(a.warnings == b.warnings);
    REQUIRE(a.scene.instance_count() == b.scene.instance_count());
    for (scene::MeshId m = 0; m < a.scene.mesh_count(); ++m) {
        CHECK(a.scene.mesh(m).positions == b.scene.mesh(m).positions);
        CHECK(a.scene.mesh(m).indices == b.scene.mesh(m).indices);
        CHECK(a.scene.mesh(m).colors == b.scene.mesh(m).colors);
    }
    CHECK(a.rooms.size() == b.rooms.size());
}

}  // namespace

TEST_SUITE("assets/udmf") {
    TEST_CASE("a level of text shows what the same level shows in DOOM's format") {
        const auto binary = load_level(Wad().file()), text = load_level(text_wad(room_text()));
        REQUIRE_MESSAGE(text.has_value(), test_files::message(text));
        CHECK(text->warnings.empty());
        check_same_level(*text, *binary);
    }

    TEST_CASE("a level with Hexen's lines shows what it shows with DOOM's") {
        Wad wad;
        std::string lines;
        for (std::size_t i = 0; i < wad.lines.size(); i += 14)
            lines += wad.lines.substr(i, 4) + std::string(8, '\1') + wad.lines.substr(i + 10, 4);
        const auto hexen = load_level(wad_file({{"MAP01", ""},
                                                {"LINEDEFS", lines},
                                                {"SIDEDEFS", wad.sides},
                                                {"VERTEXES", wad.vertices},
                                                {"SECTORS", wad.sectors},
                                                {"BEHAVIOR", "ACS"}}));
        REQUIRE_MESSAGE(hexen.has_value(), test_files::message(hexen));
        check_same_level(*hexen, *load_level(wad.file()));
    }

    TEST_CASE("levels of both kinds in one file are distinguished, and text between levels is not a level") {
        Wad wad;
        const std::string text = room_text();
        const std::string file = wad_file({{"MAP02", ""},
                                           {"TEXTMAP", text},
                                           {"BEHAVIOR", ""},
                                           {"DIALOGUE", ""},
                                           {"BLOCKMAP", ""},
                                           {"ENDMAP", ""},
                                           {"E1M1", ""},
                                           {"LINEDEFS", wad.lines},
                                           {"SIDEDEFS", wad.sides},
                                           {"VERTEXES", wad.vertices},
                                           {"SECTORS", wad.sectors},
                                           {"PLAYPAL", "x"},
                                           {"MAP03", ""},
                                           {"TEXTMAP", text}});
        const auto names = assets::list_levels(file).value();
        CHECK(names == std::vector<std::string>{"MAP02", "E1M1", "MAP03"});
        for (const std::string& name : names) {
            const auto level = assets::read_level(file, name).value();
            CHECK(level.name == name);
            CHECK(level.lines.size() == 8);
            CHECK(level.lines[0].left == assets::kNoSide);
        }
    }

    TEST_CASE("coordinates with fractions, numbers of every kind, sectors of exact areas") {
        std::mt19937 random(4617);
        for (int trial = 0; trial < 300; ++trial) {
            // A star around a random centre; every coordinate in steps of 1/32,768.
            const int corners = 3 + static_cast<int>(random() % 20);
            const double cx = static_cast<double>(random() % 60'000) - 30'000.0;
            std::vector<std::array<double, 2>> points;
            std::string text;
            for (int i = 0; i < corners; ++i) {
                const double angle = -6.283185307179586 * i / corners,
                             radius = 1.0 + static_cast<double>(random() % 1000);
                const auto step = [](double x) { return std::round(x * 32768.0) / 32768.0; };
                points.push_back({step(cx + radius * std::cos(angle)), step(radius * std::sin(angle))});
                char line[160];
                std::snprintf(line, sizeof line, "vertex{x=%.17g;y=%+.16e;}", points.back()[0], points.back()[1]);
                text += line;
            }
            for (int i = 0; i < corners; ++i)
                text +=
                    "linedef{v1=" + std::to_string(i) + ";v2=" + std::to_string((i + 1) % corners) + ";sidefront=0;}";
            const auto level = assets::read_udmf(text + "sidedef{sector=0;}sector{heightceiling=0100;}").value();
            CHECK(level.sectors[0].ceiling == 64);
            CHECK(level.sides[0].middle == "-");
            double area = 0.0, found = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto &a = points[i], &b = points[(i + 1) % points.size()];
                area -= 0.5 * ((a[0] - cx) * b[1] - a[1] * (b[0] - cx));
            }
            const auto sectors = sector_polygons(level);
            REQUIRE(sectors[0].polygons.size() == 1);
            const auto& ring = sectors[0].polygons[0].points;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const auto &a = ring[i], &b = ring[(i + 1) % ring.size()];
                found += 0.5 * ((a.x - cx) * b.y - a.y * (b.x - cx));
            }
            CHECK(found == doctest::Approx(area).epsilon(1e-12));
        }
    }

    TEST_CASE("a sector whose lines all face away from it is taken to lie inside them") {
        const auto level =
            assets::read_udmf(
                "vertex{x=0;y=0;}vertex{x=64;y=0;}vertex{x=64;y=64;}vertex{x=0;y=64;}"
                "linedef{v1=0;v2=1;sidefront=0;}linedef{v1=1;v2=2;sidefront=0;}linedef{v1=2;v2=3;sidefront=0;}"
                "linedef{v1=3;v2=0;sidefront=0;}sidedef{sector=0;}sector{heightceiling=128;}")
                .value();
        const auto sectors = sector_polygons(level);
        CHECK(sectors[0].problem.empty());
        REQUIRE(sectors[0].polygons.size() == 1);
        CHECK(sectors[0].polygons[0].points.size() == 4);
    }

    TEST_CASE("text that is no level is named by line") {
        const auto why = [](const std::string& text) { return test_files::message(load_level(text_wad(text))); };
        CHECK(says(why("vertex { x = 1; }"), "MAP01: TEXTMAP: line 1: a block has no y"));
        CHECK(says(why("\n\nvertex { x = 1; y = oops; }"), "line 3: y: 'oops' is no number"));
        CHECK(says(why("vertex { x = 40000; y = 0; }"), "'40000' is no number from -32767 to 32767"));
        CHECK(says(why("vertex { x = nan; y = 0; }"), "'nan' is no number"));
        CHECK(says(why("vertex { x = 1; y = 2;"), "ends too early"));
        CHECK(says(why("vertex x = 1;"), "line 1: 'x' is not expected here"));
        CHECK(says(why("vertex { x 1; }"), "'1' is not expected here"));
        CHECK(says(why("/* without an end"), "show nothing"));
        CHECK(says(why("// a comment"), "show nothing"));
        CHECK(says(why("namespace = \"doom"), "ends too early"));
        CHECK(says(why("linedef { v1 = 0; sidefront = 0; }"), "has no v2"));
        CHECK(says(why("linedef { v1 = 0; v2 = 1; }"), "has no sidefront"));
        CHECK(says(why("sidedef { }"), "has no sector"));
        CHECK(says(why("linedef { v1 = 0; v2 = 1; sidefront = 0; }"), "line 0: vertex 0 of 0"));
        CHECK(says(why("sidedef { sector = 5; }"), "side 0: sector 5 of 0"));
        CHECK(says(why("linedef { v1 = -1; v2 = 99999999999; sidefront = 0; }"), "v2: '99999999999' is no number"));
        std::mt19937 random(4618);
        const std::string sound = room_text();
        for (int trial = 0; trial < 3000; ++trial) {
            std::string text = sound;
            if (trial % 3 == 0) text.resize(random() % text.size());
            for (int k = 0; k < 3 && trial % 3 != 0; ++k)
                text[random() % text.size()] = static_cast<char>(random() & 127u);
            (void)why(text);
        }
    }
}
