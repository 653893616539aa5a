// SPDX-License-Identifier: MIT
// What goes in and out while the viewer runs: scenes dropped, paths recorded, statistics exported, instances picked.
#include <sstream>

#include "view_run.hpp"

using namespace crofton::test;

namespace {

// CSV without quotes.
struct Table {
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> rows;

    explicit Table(const std::string& text) {
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            std::vector<std::string> cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            if (names.empty())
                names = cells;
            else
                rows.push_back(cells);
        }
        for (const auto& row : rows) REQUIRE(row.size() == names.size());
    }
};

// Not by the clock, nor by what went before: nodes are tested in a tree that frames before have changed.
bool is_of_the_frame(const std::string& name) {
    return name != "index" && name != "nodes_tested" && name.find("_us") == std::string::npos;
}

bool same_work(const json& a, const json& b) {
    for (const auto& [name, value] : a.items())
        if (is_of_the_frame(name) && !name.ends_with("seen") && value != b[name]) return false;
    return true;
}

}  // namespace

TEST_SUITE("viewer/files") {
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
    TEST_CASE("a path flown by keys is recorded and replays, is replayed") {
        const ViewRun flown = view({{{"frame", 1}, {"key", "R"}},
                                    {{"frame", 1}, {"key_down", "W"}},
                                    {{"frame", 9}, {"key_up", "W"}},
                                    {{"frame", 9}, {"key", "R"}},
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
    }
    TEST_CASE(
        "crofton frames finds on a recorded path what the viewer has exported, frame by frame, under the same names") {
        // Time runs at two speeds and stops while the path is flown; the recording starts late.
        const ViewRun flown = view({set(0, {{"time_scale", 3.0}}),
                                    {{"frame", 2}, {"key", "R"}},
                                    {{"frame", 2}, {"key_down", "W"}},
                                    set(6, {{"paused", true}}),
                                    {{"frame", 9}, {"key_up", "W"}},
                                    {{"frame", 9}, {"key", "R"}},
                                    {{"frame", 9}, {"key", "F5"}},
                                    {{"frame", 9}, {"quit", true}}},
                                   "--bounds aabb", false);
        check_clean(flown);
        const Table viewed(contents_of(scratch().file("statistics.csv")));
        const std::string path = "--bounds aabb --camera '" + scratch().file("camera_path.json") + "'";
        const CliRun run = run_cli("frames --instances 400 --size 480x270 --csv - " + path);
        REQUIRE(run.status == 0);
        const Table replayed(run.out);
        CHECK(viewed.names == replayed.names);
        REQUIRE(viewed.rows.size() == 9);
        REQUIRE(replayed.rows.size() == 7);
        for (std::size_t i = 0; i < replayed.rows.size(); ++i)
            for (std::size_t column = 0; column < replayed.names.size(); ++column) {
                const std::string& name = replayed.names[column];
                if (!is_of_the_frame(name)) continue;
                CAPTURE(name);
                // The viewer does not count in every frame what is seen.
                if (viewed.rows[i + 2][column].empty() && name.ends_with("seen")) continue;
                CHECK(replayed.rows[i][column] == viewed.rows[i + 2][column]);
            }
        // The viewer shows the same again, and so does the key.
        const ViewRun again = view({{{"frame", 6}, {"quit", true}}}, path, false);
        check_clean(again);
        const ViewRun keyed =
            view({{{"frame", 0}, {"key", "F6"}}, {{"frame", 2}, {"key", "F6"}}, {{"frame", 8}, {"quit", true}}}, path,
                 false);
        check_clean(keyed);
        for (std::size_t i = 0; i < 6; ++i) {
            CHECK(same_work(again.document["frames"][i], flown.document["frames"][i + 2]));
            CHECK(same_work(keyed.document["frames"][i + 2], flown.document["frames"][i + 2]));
        }
    }
    TEST_CASE("statistics are exported as JSON, CSV and a Chrome trace of the same frames") {
        const ViewRun run = view({{{"frame", 4}, {"key", "F5"}}, {{"frame", 5}, {"quit", true}}}, {}, false);
        check_clean(run);
        const json exported = json::parse(contents_of(scratch().file("statistics.json")), nullptr, false);
        const json trace = json::parse(contents_of(scratch().file("statistics_trace.json")), nullptr, false);
        const Table table(contents_of(scratch().file("statistics.csv")));
        REQUIRE(exported["frames"].size() == 4);
        REQUIRE(table.rows.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(exported["frames"][i] == run.document["frames"][i]);
            for (std::size_t column = 0; column < table.names.size(); ++column) {
                const std::string& name = table.names[column];
                const json& frame = exported["frames"][i];
                const json value = name.rfind("gpu_", 0) == 0 ? frame["gpu"][name.substr(4)] : frame[name];
                if (value.is_null()) {
                    CHECK_MESSAGE(table.rows[i][column].empty(), name);
                    continue;
                }
                CHECK_MESSAGE(std::stod(table.rows[i][column]) == doctest::Approx(value.get<double>()).epsilon(1e-3),
                              name);
            }
        }
        for (const std::string& name : table.names)
            if (name != "index") CHECK_MESSAGE(exported["summary"].contains("mean_" + name), name);
        // Spans of a frame lie within it, one after the other, as long as the statistics say.
        std::size_t frames = 0;
        for (const json& event : trace["traceEvents"]) {
            for (const char* field : {"name", "ph", "pid", "ts"}) CHECK_MESSAGE(event.contains(field), field);
            if (event["name"] == "frame") CHECK(event["dur"] == exported["frames"][frames++]["frame_us"]);
            if (event["name"] == "cull") CHECK(event["dur"] == exported["frames"][frames - 1]["cull_us"]);
            if (event["ph"] == "C") CHECK(event["args"]["visible"] == exported["frames"][frames - 1]["visible"]);
        }
        CHECK(frames == 4);
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
        CHECK(picture(result, "dropped.png")["messages"].empty());
        CHECK(picture(result, "kept.png")["messages"].dump().find("damaged.obj") != std::string::npos);
    }
}
