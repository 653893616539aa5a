// SPDX-License-Identifier: MIT
// Scripts for unattended runs: keys, cameras, switches and pictures by frame.
#pragma once
#include <crofton/geometry/camera.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "json/json.hpp"
#include "window.hpp"

namespace crofton::viewer {

struct Action {
    enum class Kind { event, camera, set, screenshot, click, resize, lose_device, quit } kind = Kind::event;
    std::uint32_t frame = 0;
    Event event;       // event: a key, a dropped file or a display's scale
    Camera camera;     // camera
    Json set;          // set: names to values, already tried on a copy of the settings
    std::string file;  // screenshot
    glm::ivec2 at{0};  // click: pixels from the top left; resize: the new size
};

// {"events": [{"frame": 3, "key": "F"}, {"frame": 4, "set": {"coloring": "verdict"}}, {"frame": 5, "camera": {…}},
//  {"frame": 6, "screenshot": "a.png"}, {"frame": 7, "click": [640, 360]}, {"frame": 8, "resize": [800, 600]},
//  {"frame": 9, "drop": "scene.glb"}, {"frame": 10, "key_down": "W"}, {"frame": 20, "key_up": "W"}, {"frame": 30,
//  "quit": true}]}, {"frame": 11, "scale": 2.0}, as if the window had come onto a display of that scale,
// and {"frame": 12, "lose_device": true}, which goes on as after a lost Vulkan device.
// Frames never decrease. Errors name the line and the event by its number.
[[nodiscard]] Result<std::vector<Action>> parse_script(const std::string& text);
[[nodiscard]] Result<std::vector<Action>> load_script(const std::string& path);

// The line, from 1, on which the text stops being JSON. Absent where it is JSON.
[[nodiscard]] std::optional<std::size_t> line_of_syntax_error(const std::string& text);

// The line, from 1, on which each entry of the array under the top-level name "events" begins. Requires JSON.
[[nodiscard]] std::vector<std::size_t> lines_of_events(const std::string& text);

}  // namespace crofton::viewer
