// SPDX-License-Identifier: MIT
// Names that come from files, with characters that terminals and pages obey.
#include <doctest/doctest.h>
#include <assets/print.hpp>

#include "run_cli.hpp"

using namespace crofton::test;

namespace {

using Json = nlohmann::json;

// Clears the screen, rings, returns, ends the line, ends C's text, turns the direction, and closes tags. In UTF-8.
const char kEvilText[] = "\x1b[2J\a\r\ncrofton: all is well\0\u009b31m\u202e</text><script>'\"&\x7f";
const std::string kEvil(kEvilText, sizeof kEvilText - 1);
const std::string kNotUtf8 = "\x1b[31m\xff\xc0\x80\xed\xa0\x80";

// Nothing in it but visible characters and ends of lines.
bool is_visible(const std::string& text) {
    std::string lines;
    for (const char c : text) lines += c == '\n' ? ' ' : c;
    return crofton::printable(lines) == lines;
}

// Each line is the program's own too.
bool is_safe(const std::string& text) {
    return is_visible(text) && text.find("\ncrofton: all is well") == text.npos;
}

void write_file(const std::string& name, const std::string& contents) {
    write_contents(scratch().file(name), contents);
}

// What a run says is safe to see; "" where it is not read.
std::string check_run(const std::string& arguments) {
    CAPTURE(arguments);
    const CliRun run = run_cli(arguments);
    CHECK((run.status == 0 || run.status == 2));
    CHECK_MESSAGE(is_safe(run.err), run.err);
    CHECK_MESSAGE(is_safe(run.out), run.out);
    return run.err + run.out;
}

// What XML and HTML readers refuse, or take for a tag of the page.
bool is_sound_markup(const std::string& page) {
    return is_visible(page) && page.find("<script") == page.npos && page.find("</text><script") == page.npos;
}

Json triangle_gltf() {
    return {{"asset", {{"version", "2.0"}}},
            {"extensionsUsed", {kEvil + "_used"}},
            {"buffers",
             {{{"byteLength", 36},
               {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}}},
            {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
            {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}},
            {"materials", {{{"name", kEvil}, {"extensions", {{kEvil, Json::object()}}}}}},
            {"meshes", {{{"name", kEvil}, {"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}}}},
            {"nodes",
             {{{"mesh", 0}, {"name", kEvil}, {"extensions", {{kEvil + "_node", {{"x", 1}}}}}},
              {{"mesh", 7}, {"name", kEvil}}}},
            {"scenes", {{{"nodes", {0, 1}}, {"name", kEvil}}}},
            {"scene", 0}};
}

}  // namespace

TEST_SUITE("cli/names") {
    TEST_CASE("text is made printable: control characters, bidi marks and what is not UTF-8 are spelled out") {
        using crofton::printable;
        CHECK(printable("caf\u00e9 \u4e2d \U0001F600") == "caf\u00e9 \u4e2d \U0001F600");
        CHECK(printable(std::string("\x1b\r\n\a\0\x7f", 6)) == "\\x1b\\x0d\\x0a\\x07\\x00\\x7f");
        CHECK(printable("\u009b\u061c\u200f\u202e\u2066\u2028\ufeff") ==
              "\\u009b\\u061c\\u200f\\u202e\\u2066\\u2028\\ufeff");
        // Overlong, a surrogate, beyond the last character, cut off, a head alone.
        CHECK(printable("\xc0\x80") == "\\xc0\\x80");
        CHECK(printable("\xed\xa0\x80") == "\\xed\\xa0\\x80");
        CHECK(printable("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
        CHECK(printable("a\xe4\xb8") == "a\\xe4\\xb8");
        CHECK(printable("\xff\xfe") == "\\xff\\xfe");
        CHECK(crofton::markup_text("<a b='\"&'>\n\x1b") == "&lt;a b=&#39;&quot;&amp;&#39;&gt;\n\\x1b");
    }

    TEST_CASE("names of a glTF reach neither the terminal nor a page as they are, and stay in its JSON") {
        write_file("evil.gltf", triangle_gltf().dump());
        const std::string gltf = "'" + scratch().file("evil.gltf") + "'",
                          baked = "'" + scratch().file("e.crofton") + "'", out = scratch().file("out"),
                          quoted = "'" + out + "'";
        const std::string told = check_run("frames --no-draw --frames 1 " + gltf);
        CHECK(told.find("\\x1b[2J\\x07\\x0d\\x0acrofton: all is well\\x00\\u009b31m\\u202e") != told.npos);
        for (const std::string& arguments :
             {"frames --no-draw --frames 1 --strict " + gltf, "frames --no-draw --frames 1 --camera street " + gltf,
              "fit " + gltf, "triangulate " + gltf, "triangulate --out " + scratch().file("out.glb") + " " + gltf,
              "bake -o " + baked + " " + gltf, "frames --no-draw --frames 1 " + baked, "collide " + gltf + " " + gltf,
              "study measure --lines 1000 " + gltf, "study factors --blocks 1 " + gltf,
              "study radiosity --runs 1 " + gltf})
            check_run(arguments);

        for (const std::string& arguments :
             {"frames --no-draw --frames 1 " + gltf, "fit " + gltf, "triangulate " + gltf}) {
            CAPTURE(arguments);
            const CliRun run = run_cli(arguments + " --json -");
            CHECK(is_safe(run.err));
            CHECK_FALSE(run.json().is_discarded());
        }
        const Json list = run_cli("triangulate " + gltf + " --json -").json();
        CHECK(list["meshes"][0]["name"] == kEvil);
        REQUIRE(
            run_cli("frames --no-draw --frames 1 " + gltf + " --report " + quoted + ".html --trace " + quoted).status ==
            0);
        CHECK(is_sound_markup(contents_of(out + ".html")));
        CHECK_FALSE(Json::parse(contents_of(out), nullptr, false).is_discarded());
    }

    TEST_CASE("errors that quote a file quote it printably") {
        const auto load = [](const Json& document) {
            write_file("bad.gltf", document.dump(-1, ' ', false, Json::error_handler_t::replace));
            for (const char* command : {"frames --no-draw --frames 1", "fit", "triangulate"}) {
                const std::string told = check_run(std::string(command) + " '" + scratch().file("bad.gltf") + "'");
                CHECK(told.find("crofton: ") != told.npos);
            }
        };
        Json bad = triangle_gltf();
        bad["extensionsRequired"] = {kEvil};
        load(bad);
        bad = triangle_gltf();
        bad["buffers"][0]["uri"] = kEvil;
        load(bad);
        bad["buffers"][0]["uri"] = "%1b%5b31m%0d%ff%e2%80%ae.bin";
        load(bad);
        bad["buffers"][0]["uri"] = "data:" + kEvil + ";base64,AAAA";
        load(bad);
        bad = triangle_gltf();
        bad["accessors"][0]["type"] = kEvil;
        load(bad);
        bad = triangle_gltf();
        bad["asset"]["version"] = kEvil;
        load(bad);
        bad = triangle_gltf();
        bad["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = kEvil;
        load(bad);

        write_file("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + kNotUtf8 + " 1\nmtllib " + kNotUtf8 + ".mtl\nusemtl " +
                                  kNotUtf8 + "\no " + kNotUtf8 + "\nf 1 2 3\nf 1 2 " + kNotUtf8 + "\n");
        write_file("none.obj", kNotUtf8 + "\n");
        const std::string obj = "'" + scratch().file("bad.obj") + "'", glb = "'" + scratch().file("obj.glb") + "'";
        check_run("frames --no-draw --frames 1 " + obj);
        check_run("fit " + obj);
        check_run("fit '" + scratch().file("none.obj") + "'");
        check_run("triangulate " + obj + " --out " + glb);
        check_run("triangulate " + glb);
        write_file("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no " + kNotUtf8 + "\nf 1 2 3\n");
        const CliRun good = run_cli("triangulate '" + scratch().file("good.obj") + "' --json - --out " + glb);
        CHECK(good.status == 0);
        CHECK_FALSE(good.json().is_discarded());
        check_run("frames --no-draw --frames 1 " + glb);
    }

    TEST_CASE("names of polygons and levels are safe to see in tables, messages and drawings") {
        const auto feature = [](const Json& coordinates) {
            return Json{{"type", "Feature"},
                        {"properties", {{"name", kEvil}}},
                        {"geometry", {{"type", "Polygon"}, {"coordinates", coordinates}}}};
        };
        const Json square = Json::array({Json::array({{0, 0}, {1, 0}, {1, 1}, {0, 1}})});
        const Json crossed = Json::array({Json::array({{0, 0}, {1, 1}, {1, 0}, {0, 1}})});
        Json other = feature(square);
        other["geometry"]["type"] = kEvil;
        const Json files[] = {feature(square),
                              {{"type", "FeatureCollection"}, {"features", {feature(crossed), other}}},
                              feature(Json::array({Json::array({kEvil})}))};
        for (const Json& document : files) {
            write_file("names.geojson", document.dump());
            const std::string path = "'" + scratch().file("names.geojson") + "'", svg = scratch().file("names.svg");
            check_run("triangulate " + path);
            check_run("fit --planar " + path);
            for (const char* command : {"triangulate ", "fit --planar "}) {
                const CliRun run = run_cli(command + path + " --json -");
                CHECK(is_safe(run.err));
                CHECK((run.out.empty() || !run.json().is_discarded()));
                std::filesystem::remove(svg);
                run_cli(command + path + " --svg '" + svg + "'");
                CHECK(is_sound_markup(contents_of(svg)));
            }
        }
        write_file("names.poly", "P " + kNotUtf8 + "<b 1\n4 0 0 1 0 1 1 0 1\nP " + kNotUtf8 + " 1\n3 0 0 x");
        check_run("triangulate '" + scratch().file("names.poly") + "'");
        write_file("names.poly", "P " + kNotUtf8 + "<b 1\n4 0 0 1 0 1 1 0 1\n");
        check_run("fit --planar '" + scratch().file("names.poly") + "'");
        CHECK_FALSE(run_cli("triangulate '" + scratch().file("names.poly") + "' --json -").json().is_discarded());

        // One lump, MAP01's, whose name rings; one whose data is beyond the file.
        const auto lump = [](std::uint32_t size, const std::string& name) {
            std::string entry(8, '\0');
            entry[0] = 12, entry[4] = static_cast<char>(size);
            return entry + name + std::string(8 - name.size(), '\0');
        };
        const std::string head("IWAD\2\0\0\0\x0c\0\0\0", 12);
        for (const std::uint32_t size : {0u, 100u}) {
            write_file("names.wad", head + lump(0, "\x1b[2J\xff") + lump(size, "\x1b]\a<"));
            check_run("frames --no-draw --frames 1 '" + scratch().file("names.wad") + "'");
            check_run("triangulate '" + scratch().file("names.wad") + "'");
        }
        write_file("text.wad", std::string("PWAD\2\0\0\0\x12\0\0\0", 12) + "\x1b[2J\xff;" + lump(0, "\x1b[2J") +
                                   lump(6, "TEXTMAP"));
        check_run("frames --no-draw --frames 1 '" + scratch().file("text.wad") + "'");
    }

    TEST_CASE("a file's own name, and arguments that are wrong, are safe to see") {
        const std::string name = scratch().file("<b>&'\x1b[2J\a\u202e\xff.obj"),
                          missing = scratch().file("\x1b[2J.obj");
        write_contents(name, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n");
        std::string quoted = "\"" + name + "\"";
        const std::string svg = scratch().file("fit.svg");
        for (const char* command : {"fit ", "frames --no-draw --frames 1 ", "triangulate ",
                                    "study measure --lines 1000 ", "bake ", "frames --no-draw --camera "})
            check_run(command + quoted);
        check_run("fit " + quoted + " " + quoted);
        check_run("fit \"" + missing + "\"");
        check_run("\"\x1b[2J\a\"");
        check_run("fit \"--\x1b[2J\a\"");
        check_run("fit --quality \"\x1b[2J\a\" " + quoted);
        check_run("help \"\x1b[2J\a\"");
        check_run("frames room --no-draw --size \"\x1b[2J\a\"");
        CHECK_FALSE(run_cli("fit " + quoted + " --json -").json().is_discarded());
        REQUIRE(run_cli("fit " + quoted + " --svg '" + svg + "'").status == 0);
        CHECK(is_sound_markup(contents_of(svg)));
        // A name that is longer with its escapes than a buffer once was.
        const std::string large = scratch().file(std::string(240, '&') + ".obj");
        write_contents(large, contents_of(name));
        REQUIRE(run_cli("fit '" + large + "' --svg '" + svg + "'").status == 0);
        CHECK(contents_of(svg).find(".obj</text>") != std::string::npos);
        const std::string page = scratch().file("page.html");
        REQUIRE(run_cli("frames --no-draw --frames 1 " + quoted + " --report '" + page + "'").status == 0);
        CHECK(is_sound_markup(contents_of(page)));
    }
}
