// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <assets/scene_source.hpp>
#include <assets/sector_polygons.hpp>
#include <assets/wad_file.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>

#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::message;
using test_files::says;
using test_files::TemporaryFile;
using test_files::Wad;

namespace {

Result<assets::SceneSource> load_wad(const std::string& bytes, const std::string& map = {}) {
    const TemporaryFile file("level.wad", bytes);
    assets::LoadOptions options;
    options.map = map;
    return assets::load_scene(file.path(), options);
}

double area(const Polygon& polygon) {
    double sum = 0.0;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        double twice = 0.0;
        const auto ring = polygon.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
            twice += a.x * b.y - a.y * b.x;
        }
        sum += 0.5 * (r == 0 ? std::abs(twice) : -std::abs(twice));
    }
    return sum;
}

// Lines around the cells of a chequered board; cell c is sector sectors[c] or none (−1). Right side faces the cell.
assets::WadLevel board(int columns, const std::vector<int>& sectors) {
    assets::WadLevel level;
    const int rows = static_cast<int>(sectors.size()) / columns;
    level.sectors.resize(4);
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) level.vertices.push_back({64 * x, 64 * y});
    const auto vertex = [&](int x, int y) { return static_cast<std::uint32_t>((columns + 1) * y + x); };
    const auto side = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= columns || y >= rows || sectors[static_cast<std::size_t>(columns * y + x)] < 0)
            return assets::kNoSide;
        level.sides.push_back(
            {static_cast<std::uint32_t>(sectors[static_cast<std::size_t>(columns * y + x)]), {}, {}, {}});
        return static_cast<std::uint32_t>(level.sides.size() - 1);
    };
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x <= columns; ++x)  // upward lines: right is the cell to the right
            level.lines.push_back({vertex(x, y), vertex(x, y + 1), side(x, y), side(x - 1, y)});
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x < columns; ++x)  // lines to the right: right is below
            level.lines.push_back({vertex(x, y), vertex(x + 1, y), side(x, y - 1), side(x, y)});
    return level;
}

}  // namespace

TEST_SUITE("assets/wad_loader") {
    TEST_CASE("damaged archives and levels are named by lump, line, side and sector") {
        CHECK(says(message(load_wad("")), "level.wad: the file is empty"));
        CHECK(says(message(load_wad("PWAD\xff\xff\xff\xff\x0c\0\0\0")), "not a WAD"));
        std::string file = Wad().file();
        CHECK(says(message(load_wad(file.substr(0, file.size() - 5))), "directory"));
        CHECK(says(message(load_wad(file, "E1M2")), "no level 'E1M2'; there are: E1M1"));
        Wad wad;
        wad.lines.pop_back();
        CHECK(says(message(load_wad(wad.file())), "LINEDEFS: its size"));
        wad = Wad();
        wad.line(0, 99, 0, 0xFFFF);
        CHECK(says(message(load_wad(wad.file())), "line 8: vertex 99 of 8"));
        wad = Wad();
        wad.line(0, 1, 200, 0xFFFF);
        CHECK(says(message(load_wad(wad.file())), "line 8: side 200 of 8"));
        wad = Wad();
        wad.side(5);
        CHECK(says(message(load_wad(wad.file())), "side 8: sector 5 of 1"));
        wad = Wad();
        wad.sectors.clear();
        CHECK_FALSE(load_wad(wad.file()).has_value());
        file = Wad().file();
        file[file.size() - 16] = '\x7f';  // the last lump's offset
        file[file.size() - 14] = '\x7f';
        CHECK(says(message(load_wad(file)), "SECTORS: ends beyond"));
    }

    TEST_CASE("a sector whose lines do not close is reported and left out, its walls are not") {
        Wad wad;
        wad.lines.resize(wad.lines.size() - 14);  // the column's last side
        const auto source = load_wad(wad.file());
        REQUIRE_MESSAGE(source.has_value(), message(source));
        REQUIRE(source->warnings.size() == 1);
        CHECK(says(source->warnings[0], "sector 0"));
        CHECK(says(source->warnings[0], "do not close"));
        CHECK(source->scene.instance_count() == 7);
    }

    TEST_CASE("a room with a column: floor and ceiling have a hole, walls face the room") {
        const auto source = load_wad(Wad().file(), "e1m1");
        REQUIRE_MESSAGE(source.has_value(), message(source));
        CHECK(source->warnings.empty());
        const scene::Scene& scene = source->scene;
        REQUIRE(scene.instance_count() == 10);
        REQUIRE(scene.polygon(0) != nullptr);
        CHECK(scene.polygon(0)->polygon.ring_count() == 2);
        CHECK(area(scene.polygon(0)->polygon) == 256.0 * 256.0 - 64.0 * 64.0);
        const auto normal = [&](scene::MeshId m, std::size_t t) {
            const TriangleMesh& mesh = scene.mesh(m);
            const auto p = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * t + k]]; };
            return glm::cross(p(1) - p(0), p(2) - p(0));
        };
        for (std::size_t t = 0; t < scene.mesh(0).triangle_count(); ++t) {
            CHECK(normal(0, t).y > 0.0f);
            CHECK(normal(1, t).y < 0.0f);
        }
        // Outer walls look to the room's middle (4, ·, −4), the column's away from it.
        for (scene::MeshId m = 2; m < 10; ++m) {
            const glm::vec3 toward =
                glm::vec3(4, 2, -4) - 0.5f * (scene.mesh(m).positions[0] + scene.mesh(m).positions[2]);
            CHECK((glm::dot(normal(m, 0), toward) > 0.0f) == (m < 6));
        }
    }

    TEST_CASE("rooms: convex pieces of each sector, and which sides are walls from floor to ceiling") {
        // The column's inside as a sector of its own, or as none.
        const auto sector = [](int floor, int ceiling, const char* floor_name, const char* ceiling_name) {
            return test_files::bytes_of(static_cast<std::int16_t>(floor)) +
                   test_files::bytes_of(static_cast<std::int16_t>(ceiling)) + test_files::name8(floor_name) +
                   test_files::name8(ceiling_name) + test_files::bytes_of(std::int16_t{160}) + std::string(4, '\0');
        };
        struct Case {
            const char* what;
            std::string inside;
            bool is_wall, has_inside;
        };
        const Case cases[] = {{"no sector", "", true, false},
                              {"a step", sector(64, 128, "FLAT1", "FLAT1"), false, true},
                              {"a window", sector(64, 100, "FLAT1", "FLAT1"), false, true},
                              {"a floor at the ceiling", sector(128, 200, "FLAT1", "FLAT1"), true, true},
                              {"a closed door", sector(0, 0, "FLAT1", "FLAT1"), true, false},
                              {"one unit open", sector(0, 1, "FLAT1", "FLAT1"), false, true}};
        for (const Case& c : cases) {
            CAPTURE(c.what);
            Wad wad;
            if (!c.inside.empty()) {
                wad.lines.resize(wad.lines.size() - 4 * 14);
                for (int k = 0; k < 4; ++k) wad.line(4 + k, 4 + (k + 1) % 4, 4 + k, 8 + k);
                for (int k = 0; k < 4; ++k) wad.side(1);
                wad.sectors += c.inside;
            }
            const auto source = load_wad(wad.file());
            REQUIRE_MESSAGE(source.has_value(), message(source));
            double inside = 0.0, around = 0.0;
            int walls = 0, column_walls = 0;
            for (const assets::Room& room : source->rooms) {
                double twice = 0.0;
                bool is_column = true;
                const std::size_t corners = room.corners[3] == room.corners[2] ? 3 : 4;
                for (std::size_t k = 0; k < corners; ++k) {
                    const glm::dvec2 &p = room.corners[k], &q = room.corners[(k + 1) % corners];
                    twice += p.y * q.x - p.x * q.y;  // (x, −z)
                    is_column = is_column && p.x >= 3 && p.x <= 5 && p.y >= -5 && p.y <= -3;
                }
                CHECK(twice > 0.0);
                (is_column ? inside : around) += 0.5 * twice;
                if (is_column) continue;
                CHECK(room.floor == 0.0);
                CHECK(room.ceiling == 4.0);
                CHECK(room.has_floor);
                CHECK(room.has_ceiling);
                for (std::size_t k = 0; k < corners; ++k) {
                    const glm::dvec2 &p = room.corners[k], &q = room.corners[(k + 1) % corners];
                    const auto outer = [](const glm::dvec2& x) {
                        return x.x == 0 || x.x == 8 || x.y == 0 || x.y == -8;
                    };
                    const bool on_outer = outer(p) && outer(q) && (p.x == q.x || p.y == q.y),
                               on_column = !outer(p) && !outer(q) && (p.x == q.x || p.y == q.y);
                    CHECK(room.is_wall[k] == (on_outer || (on_column && c.is_wall)));
                    walls += on_outer;
                    column_walls += on_column;
                }
            }
            CHECK(walls == 4);
            CHECK(column_walls == 4);
            CHECK(around == doctest::Approx(60.0));
            CHECK(inside == (c.has_inside ? doctest::Approx(4.0) : doctest::Approx(0.0)));
        }
        Wad sky;
        sky.sectors = sector(0, 128, "FLOOR4_8", "F_SKY1");
        const auto source = load_wad(sky.file()).value();
        REQUIRE_FALSE(source.rooms.empty());
        CHECK(source.rooms[0].has_floor);
        CHECK_FALSE(source.rooms[0].has_ceiling);
    }

    TEST_CASE("rings that touch in a point are separate rings") {
        // A board whose diagonal cells are one sector: two outlines that touch in the middle.
        const auto diagonal = sector_polygons(board(2, {0, 1, 1, 0}));
        for (const std::size_t s : {0u, 1u}) {
            CHECK(diagonal[s].problem.empty());
            REQUIRE(diagonal[s].polygons.size() == 2);
            CHECK(area(diagonal[s].polygons[0]) + area(diagonal[s].polygons[1]) == 2.0 * 64.0 * 64.0);
        }
        // A frame of eight cells around one of another sector, and around none.
        for (const int middle : {1, -1}) {
            const auto frame = sector_polygons(board(3, {0, 0, 0, 0, middle, 0, 0, 0, 0}));
            REQUIRE(frame[0].polygons.size() == 1);
            CHECK(frame[0].polygons[0].ring_count() == 2);
            CHECK(area(frame[0].polygons[0]) == 8.0 * 64.0 * 64.0);
        }
        // Two holes that touch in a point, and an island in a hole.
        const auto holes = sector_polygons(board(4, {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}));
        REQUIRE(holes[0].polygons.size() == 1);
        CHECK(area(holes[0].polygons[0]) == 14.0 * 64.0 * 64.0);
        const auto island =
            sector_polygons(board(5, {0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0}));
        REQUIRE(island[0].polygons.size() == 2);
        CHECK(area(island[0].polygons[0]) + area(island[0].polygons[1]) == 17.0 * 64.0 * 64.0);
        REQUIRE(island[1].polygons.size() == 1);
        CHECK(area(island[1].polygons[0]) == 8.0 * 64.0 * 64.0);
    }

    TEST_CASE("32 real levels load, and hardly a sector is lost") {
        const std::string path = std::string(CROFTON_SHARED_DATA) + "/scenes/freedoom2_maps.wad";
        std::ifstream stream(path, std::ios::binary);
        if (!stream) return;
        std::stringstream bytes;
        bytes << stream.rdbuf();
        const auto names = assets::list_levels(bytes.str()).value();
        CHECK(names.size() == 32);
        std::size_t sectors = 0, lost = 0;
        for (const std::string& name : names) {
            const auto level = assets::read_level(bytes.str(), name).value();
            for (const auto& sector : sector_polygons(level)) {
                ++sectors;
                lost += sector.polygons.empty() ? 1u : 0u;
            }
        }
        CHECK(sectors > 10'000);
        CHECK(lost < sectors / 100);
        for (const char* map : {"MAP01", "MAP07", "MAP16"}) {
            assets::LoadOptions options;
            options.map = map;
            const auto source = assets::load_scene(path, options);
            REQUIRE_MESSAGE(source.has_value(), message(source));
            CHECK(source->scene.instance_count() > 500);
            CHECK(source->walk.size() > 3);
        }
    }
}
