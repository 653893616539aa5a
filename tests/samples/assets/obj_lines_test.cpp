// SPDX-License-Identifier: MIT
// OBJ files by all the programs that end, continue and decorate lines in their own way.
#include <doctest/doctest.h>
#include <assets/obj_file.hpp>
#include <assets/text_lines.hpp>
#include <random>

#include "test_files.hpp"

using namespace crofton;
using test_files::TemporaryFile;

namespace {

assets::ObjFile read_lines(const std::string& text) {
    const TemporaryFile file("lines.obj", text);
    auto obj = assets::read_obj(file.path());
    REQUIRE_MESSAGE(obj.has_value(), obj.error().message);
    return std::move(*obj);
}

void check_same(const assets::ObjFile& a, const assets::ObjFile& b) {
    CHECK(a.positions == b.positions);
    CHECK(a.colors == b.colors);
    CHECK(a.texcoords == b.texcoords);
    CHECK(a.normals == b.normals);
    CHECK(a.warnings == b.warnings);
    REQUIRE(a.parts.size() == b.parts.size());
    for (std::size_t p = 0; p < a.parts.size(); ++p) {
        CHECK(a.parts[p].name == b.parts[p].name);
        CHECK(a.parts[p].material == b.parts[p].material);
        CHECK(a.parts[p].indices == b.parts[p].indices);
        CHECK(a.parts[p].texcoord_indices == b.parts[p].texcoord_indices);
        CHECK(a.parts[p].normal_indices == b.parts[p].normal_indices);
    }
}

const std::vector<std::string> kPlain = {"# C:\\models\\",
                                         "v 0 0 0",
                                         "v 2 0 0 0.25 0.5 0.75",
                                         "v 2 2 0 1.0",
                                         "v 0 2 0",
                                         "vt 0 0",
                                         "vt 1 0.5",
                                         "vn 0 0 1",
                                         "o first",
                                         "usemtl red",
                                         "f 1/1/1 2/2/1 3//1 4",
                                         "g second",
                                         "f -4 -3 -2",
                                         "",
                                         "f 1/2 3/1 4/2"};

}  // namespace

TEST_SUITE("assets/obj_lines") {
    TEST_CASE("faces may come before what they name, wherever the vertices are, and negative numbers count back") {
        std::string plain, faces_first, vertices_between, dangling;
        const auto is_face_or_part = [](const std::string& line) {
            return line[0] == 'f' || line[0] == 'o' || line[0] == 'g' || line[0] == 'u';
        };
        for (std::string line : kPlain) {
            if (line.empty()) continue;
            if (line == "f -4 -3 -2") line = "f 1 2 3";
            plain += line + "\n";
            if (is_face_or_part(line)) faces_first += line + "\n";
        }
        for (const std::string& line : kPlain)
            if (!line.empty() && !is_face_or_part(line)) faces_first += line + "\n";
        check_same(read_lines(faces_first), read_lines(plain));
        // Only the last vertex comes later; negative numbers are those of the face's own place.
        const assets::ObjFile between =
            read_lines("v 0 0 0\nv 2 0 0\nv 2 2 0\no a\nf 1 2 3\nf 1 3 4\no b\nf -3 -2 -1\no c\nv 0 2 0\nf -3 -2 -1\n");
        REQUIRE(between.parts.size() == 3);
        CHECK(between.parts[0].indices == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
        CHECK(between.parts[1].indices == std::vector<std::uint32_t>{0, 1, 2});
        CHECK(between.parts[2].indices == std::vector<std::uint32_t>{1, 2, 3});
        // What never comes is missing, with the line that names it.
        const auto message = [](const std::string& text, bool lenient) {
            const TemporaryFile file("late.obj", text);
            const auto obj = assets::read_obj(file.path(), {.leave_out = lenient});
            return !obj ? obj.error().message : obj->warnings.empty() ? std::string() : obj->warnings[0];
        };
        for (const bool lenient : {false, true}) {
            const std::string told = message("f 1 2 3\nf 1 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", lenient);
            CHECK(told.find("line 2: face: vertex 4 of 3") != std::string::npos);
            CHECK(message("f 1 2 -1\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", lenient).find("line 1: face: vertex -1 of 3") !=
                  std::string::npos);
            CHECK(message("f 1 2 3\nv 0 0 0\nv 1 x 0\nv 0 1 0\n", true).find("vertex 2") != std::string::npos);
        }
    }

    TEST_CASE("line ends, continuations, blanks and comments of every kind mean the same") {
        std::string plain;
        for (const std::string& line : kPlain) plain += line + "\n";
        const assets::ObjFile expected = read_lines(plain);
        REQUIRE(expected.positions.size() == 4);
        REQUIRE(expected.parts.size() == 2);
        CHECK(expected.colors[1] == glm::vec3(0.25f, 0.5f, 0.75f));
        std::mt19937 random(4610);
        const char* const ends[] = {"\n", "\r\n", "\r"};
        const char* const blanks[] = {
            " ", "\t", "  \t ", "\v", " \\\n", "\\\r\n ", "\t\\\r\t", " \\ \n", " \\\n\\\r\n \\\r "};
        const char* const comments[] = {"", "", " ", "\t ", " # a comment", " # ends in \\", "\t#", " \\\n"};
        for (int trial = 0; trial < 2000; ++trial) {
            std::string text = trial % 7 == 0 ? "\xEF\xBB\xBF" : "";
            for (const std::string& line : kPlain) {
                const bool is_comment = line.empty() || line[0] == '#';
                for (const char c : line)
                    if (c == ' ' && !is_comment)
                        text += blanks[random() % std::size(blanks)];
                    else
                        text += c;
                // What continues must be followed by a line that is empty.
                const std::string comment = is_comment ? "" : comments[random() % std::size(comments)];
                text += comment + ends[trial % 4 == 3 ? random() % 3 : static_cast<std::size_t>(trial % 4)];
            }
            CAPTURE(text);
            check_same(read_lines(text), expected);
        }
    }

    TEST_CASE("a line of a million characters and one of a hundred thousand parts are lines") {
        std::string points, face = "f", parts = "f";
        for (int i = 0; i < 3; ++i) points += "v " + std::to_string(i) + " " + std::to_string(i * i) + " 0\n";
        for (int i = 1; i <= 3; ++i) {
            face += std::string(300'000, ' ') + std::to_string(i);
            for (int k = 0; k < 30'000; ++k) parts += "\\\n";
            parts += std::to_string(i);
        }
        check_same(read_lines(points + face + "\n"), read_lines(points + "f 1 2 3\n"));
        check_same(read_lines(points + parts), read_lines(points + "f 1 2 3\n"));
    }

    TEST_CASE("messages count lines as an editor does, whatever they end in") {
        const auto message = [](const std::string& text) {
            const TemporaryFile file("bad.obj", text);
            const auto obj = assets::read_obj(file.path());
            return obj ? "read" : obj.error().message.substr(file.path().size());
        };
        for (const std::string end : {"\n", "\r\n", "\r"}) {
            const std::string text =
                "v 0 0 0" + end + "v 1 \\" + end + "0 0" + end + end + "v 0 \\" + end + "x 0" + end;
            CHECK(message(text) == ": line 5: vertex 3: 'x' is not a finite number");
        }
        CHECK(message("v 0 0 0\rf 1 2 3\r") == ": line 2: face: vertex 2 of 1");
    }

    TEST_CASE("files that were put together keep their marks, numbers may have a plus or be too small to tell from 0") {
        const assets::ObjFile expected = read_lines("v 0 0 0\nv 2 0 0 1 0 0\nv 0 2 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
        check_same(
            read_lines("\xEF\xBB\xBFv 0 0 0\n\xEF\xBB\xBF\xEF\xBB\xBFv 2 0 0 1 0 0\nv 0 2 0\n\xEF\xBB\xBFvn 0 0 1\n"
                       "f +1//+1 +2//+1 +3//+1\n"),
            expected);
        check_same(read_lines("v 1e-400 0 -1E-9999\nv +2 0 0 1 1e-60 0\nv 0." + std::string(400, '0') +
                              "1 2 0\nvn 0 1e-46 1\nf 1//1 2//1 3//1\n"),
                   expected);
    }

    TEST_CASE("if vertices are missing, the first line whose keyword is none is named") {
        const auto message = [](const std::string& text) {
            const TemporaryFile file("bad.obj", text);
            const auto obj = assets::read_obj(file.path());
            return obj ? "read" + obj->unknown_line : obj.error().message.substr(file.path().size());
        };
        CHECK(message("v 0 0 0\nV 1 0 0\nv 0 1 0\nf 1 2 3\n") ==
              ": line 4: face: vertex 3 of 2; line 2 begins with 'V', which is no keyword");
        CHECK(message("ply\nformat ascii 1.0\n") == "read; line 1 begins with 'ply', which is no keyword");
        CHECK(message("#v\n# c\n\nvp 0\ns off\nlod 1\nl 1 2\ncurv2 1\n") == "read");
    }

    TEST_CASE("a line whose keyword is none is named, though there are faces") {
        const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        CHECK(read_lines(text).odd_lines.empty());
        CHECK(read_lines(text + "f\u00A03 2 1\n").odd_lines ==
              std::vector<std::string>{"line 5 begins with 'f\u00A03', which is no keyword: left out"});
        CHECK(read_lines("F 1 2 3\n" + text + "F 3 2 1\n").odd_lines ==
              std::vector<std::string>{"line 1 begins with 'F', which is no keyword: left out, and 1 more"});
    }

    TEST_CASE("lines: a text without an end, ends that meet, continuations at the end") {
        const auto lines_of = [](std::string_view text) {
            std::vector<std::string> result;
            assets::TextLines lines(text);
            for (std::string_view line; lines.next(line);) result.emplace_back(line);
            return result;
        };
        CHECK(lines_of("").empty());
        CHECK(lines_of("a") == std::vector<std::string>{"a"});
        CHECK(lines_of("a\r\rb\n\nc\r\n\r\nd") == std::vector<std::string>{"a", "", "b", "", "c", "", "d"});
        CHECK(lines_of("a\\") == std::vector<std::string>{"a "});
        CHECK(lines_of("a\\\nb\\\r\nc\\\rd\ne") == std::vector<std::string>{"a b c d", "e"});
        CHECK(lines_of("#a\\\nb #c\\\nd#\\\ne") == std::vector<std::string>{"#a\\", "b #c\\", "d# e"});
    }
}
