// SPDX-License-Identifier: MIT
// What the help promises: keys, statistics rows, and the scripts of the page about the viewer.
#include <doctest/doctest.h>

#include <set>
#include <sstream>

#include "view_run.hpp"
#include "viewer/keys.hpp"
#include "viewer/script.hpp"
#include "viewer/statistics_panel.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

// The blocks of ```json in a page.
std::vector<std::string> json_blocks(const std::string& page) {
    std::vector<std::string> blocks;
    for (std::size_t at = page.find("```json\n"); at != std::string::npos; at = page.find("```json\n", at)) {
        const std::size_t begin = at + 8, end = page.find("```", begin);
        REQUIRE(end != std::string::npos);
        blocks.push_back(page.substr(begin, end - begin));
        at = end + 3;
    }
    return blocks;
}

}  // namespace

TEST_SUITE("viewer/keys") {
    TEST_CASE("names are keys, other words are not, and no key is listed twice") {
        CHECK(viewer::is_key("F"));
        CHECK(viewer::is_key("Ctrl+9"));
        CHECK(viewer::is_key("."));
        for (const char* word : {"", " ", "f", "Foo", "W A", "Ctrl+", "F12"}) CHECK_FALSE(viewer::is_key(word));
        std::set<std::string> seen;
        for (const viewer::KeyGroup& group : viewer::key_groups())
            for (const viewer::KeyHelp& key : group.keys) {
                std::istringstream names(key.names);
                for (std::string name; names >> name;) CHECK_MESSAGE(seen.insert(name).second, name);
                CHECK(viewer::key_help().find(key.does) != std::string::npos);
            }
    }
    TEST_CASE("every number of crofton frames has one row in the panel, and every row a number") {
        std::multiset<std::string> rows, columns;
        for (const auto& list : {viewer::main_rows(), viewer::more_rows()})
            for (const viewer::StatisticsRow& row : list) rows.insert(row.column);
        for (const pipeline::StatisticsColumn& column : pipeline::statistics_columns()) columns.insert(column.name);
        CHECK(rows == columns);
    }
    TEST_CASE("triangles counted otherwise than predicted are a fault only where the device counts exactly") {
        CHECK(viewer::clip_counts(8600, 8600, true) == "clipped: predicted 8 600 = 8 600 counted");
        CHECK(viewer::clip_counts(8600, 8413, true) == "clipped: predicted 8 600 but 8 413 counted");
        CHECK(viewer::clip_counts(8600, 8413, false) == "clipped: predicted 8 600, 8 413 counted");
    }
    TEST_CASE("every key of the help does something: it changes a setting, the camera, time, or says something") {
        json events = json::array();
        int frame = 1;
        std::vector<std::string> pressed;
        events.push_back(shot(frame++, "before.png"));
        for (const viewer::KeyGroup& group : viewer::key_groups())
            for (const viewer::KeyHelp& key : group.keys) {
                std::istringstream names(key.names);
                for (std::string name; names >> name;) {
                    if (name == "Shift" || name == "Escape" || name == "Ctrl+Q") continue;
                    // Time stands still, so that nothing changes but by a key. Pictures are taken by a key, too.
                    events.push_back(set(frame, {{"paused", true}, {"panels", false}}));
                    events.push_back({{"frame", frame++}, {"key_down", name}});
                    events.push_back(shot(frame, std::to_string(pressed.size()) + ".png"));
                    events.push_back({{"frame", ++frame}, {"key_up", name}});
                    pressed.push_back(name);
                }
            }
        const ViewRun run = view(events, "--size 96x54", false);
        check_clean(run);
        const auto state = [](json entry) {
            for (const char* noise : {"file", "frame", "statistics", "other", "tints", "lines"}) entry.erase(noise);
            return entry;
        };
        json last = state(picture(run, "before.png"));
        for (std::size_t i = 0; i < pressed.size(); ++i) {
            CAPTURE(pressed[i]);
            const json now = state(picture(run, std::to_string(i) + ".png"));
            CHECK(now != last);
            last = now;
        }
    }
}

TEST_SUITE("viewer/docs") {
    TEST_CASE("the scripts in docs/viewer.md run, and show every kind of event") {
        const std::vector<std::string> blocks = json_blocks(contents_of(CROFTON_SOURCE "/docs/viewer.md"));
        REQUIRE(blocks.size() >= 1);
        std::set<std::string> kinds;
        for (const std::string& block : blocks) {
            CAPTURE(block);
            const auto actions = viewer::parse_script(block);
            REQUIRE_MESSAGE(actions, (actions ? "" : actions.error().message));
            json events = json::parse(block)["events"];
            for (json& event : events) {
                for (const auto& [name, value] : event.items())
                    if (name != "frame") kinds.insert(name);
                // The example's own files, in the tests' folder.
                if (event.contains("drop"))
                    write_contents(scratch().file("scene.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
                for (const char* file : {"drop", "screenshot"})
                    if (event.contains(file)) event[file] = scratch().file(event[file].get<std::string>());
            }
            check_clean(view(events, {}, false));
        }
        CHECK(kinds == std::set<std::string>{"key", "key_down", "key_up", "set", "camera", "click", "resize", "scale",
                                             "drop", "screenshot", "lose_device", "quit"});
        // The same kinds are in the help.
        const CliRun help = run_cli("view --help");
        for (const std::string& kind : kinds) CHECK_MESSAGE(help.out.find(kind) != std::string::npos, kind);
        // And every switch is in the page.
        const std::string page = contents_of(CROFTON_SOURCE "/docs/viewer.md");
        const Json switches = viewer::to_json(viewer::Settings{});
        CHECK(switches.size() > 10);
        for (const Json::Member& item : switches.members())
            CHECK_MESSAGE(page.find("`" + item.key + "`") != std::string::npos, item.key);
    }
}
