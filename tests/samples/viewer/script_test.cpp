// SPDX-License-Identifier: MIT
// Scripts and switches: what is refused, and by which name.
#include <doctest/doctest.h>
#include <error_of.hpp>

#include "viewer/script.hpp"
#include "viewer/settings.hpp"

using namespace crofton;
using namespace crofton::viewer;

TEST_SUITE("viewer/script") {
    TEST_CASE("damaged scripts are refused, naming the event") {
        CHECK_FALSE(parse_script("{"));
        CHECK_FALSE(parse_script("[]"));
        CHECK_FALSE(parse_script(R"({"events": 3})"));
        const char* bad[] = {R"({"frame": -1, "key": "F"})",
                             R"({"frame": 1})",
                             R"({"frame": 1, "key": "F", "set": {}})",
                             R"({"frame": 1, "key": 7})",
                             R"({"frame": 1, "jump": true})",
                             R"({"frame": 1, "set": {"coloring": "plaid"}})",
                             R"({"frame": 1, "set": {"no such switch": true}})",
                             R"({"frame": 1, "click": [1]})",
                             R"({"frame": 1, "resize": [0, 5]})",
                             R"({"frame": 1, "camera": {"fov_y": -3}})"};
        for (const char* event : bad) {
            CAPTURE(event);
            const auto refused = parse_script(R"({"events": [{"frame": 0, "key": "H"}, )" + std::string(event) + "]}");
            REQUIRE_FALSE(refused);
            CHECK(error_of(refused).item == 1);
            CHECK(error_of(refused).message.find("event 1") != std::string::npos);
        }
        CHECK(error_of(parse_script(R"({"events": [{"frame": 1, "key": "Foo"}]})")).message.find("'Foo'") !=
              std::string::npos);
        CHECK_FALSE(parse_script(R"({"events": [{"frame": 5, "key": "H"}, {"frame": 4, "key": "H"}]})"));
        CHECK(error_of(load_script("no/such/file.json")).message.find("no/such/file.json") != std::string::npos);
    }
    TEST_CASE("errors name the line: of the event, or where the text stops being JSON") {
        const auto message = [](const std::string& text) { return error_of(parse_script(text)).message; };
        CHECK(message("{\n\"note\": [\"]{\\\"\", {\"events\": [1]}],\n\"events\": [\n  {\"frame\": 1, \"key\": \"F\"}, "
                      "{\"frame\": 2,\n\"key\": \"F\"},\n\n {\"frame\":\n3, \"jump\": 1}]}")
                  .find("line 7, event 2: unknown action 'jump'") != std::string::npos);
        CHECK(message("{\"events\": [\n 3 ]}").find("line 2, event 0") != std::string::npos);
        CHECK(message("{\"events\": [\n{\"frame\": 1,\n\"key\" \"F\"}]}").find("line 3: not valid JSON") !=
              std::string::npos);
        CHECK(message("").find("line 1") != std::string::npos);
        CHECK(message("{\"events\": [\n\n").find("line 3") != std::string::npos);
        CHECK(parse_script("{\"events\": []}")->empty());
    }
    TEST_CASE("a key is pressed and let go, held keys are held") {
        const auto actions =
            parse_script(R"({"events": [{"frame": 2, "key": "F"}, {"frame": 3, "key_down": "W"}]})").value();
        REQUIRE(actions.size() == 3);
        CHECK(actions[0].event.kind == Event::Kind::key_down);
        CHECK(actions[1].event.kind == Event::Kind::key_up);
        CHECK(actions[2].frame == 3);
    }
}

TEST_SUITE("viewer/settings") {
    TEST_CASE("values of the wrong kind or range change nothing") {
        Settings settings;
        CHECK_FALSE(set_switch(settings, "freeze", 1));
        CHECK_FALSE(set_switch(settings, "cascades", 9));
        CHECK_FALSE(set_switch(settings, "cascades", 2.5));
        CHECK_FALSE(set_switch(settings, "time_scale", -1.0));
        CHECK_FALSE(set_switch(settings, "cull", "octree"));
        CHECK_FALSE(set_switch(settings, "triangulation", "fan"));
        CHECK_FALSE(set_switch(settings, "triangulation", 2));
        CHECK_FALSE(set_switch(settings, "bounds_kind", "capsule"));
        CHECK_FALSE(set_switch(settings, "other_tree", "slanted"));
        CHECK(to_json(settings).dump() == to_json(Settings{}).dump());
    }
    TEST_CASE("every switch that is written can be read back") {
        Settings settings;
        settings.coloring = Coloring::improper;
        settings.freeze = settings.compare = settings.outside = true;
        settings.tree_level = 2;
        settings.cascades = 3;
        settings.method = {pipeline::BoundsKind::sphere, pipeline::CullMode::flat};
        settings.other = {pipeline::BoundsKind::aabb, pipeline::CullMode::none, boxtree::Orientation::automatic,
                          Triangulation::delaunay};
        Settings copy;
        const Json written = to_json(settings);
        for (const auto& [name, value] : written.members()) CHECK(set_switch(copy, name, value));
        CHECK(to_json(copy).dump() == to_json(settings).dump());
    }
}
