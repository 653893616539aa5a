// SPDX-License-Identifier: MIT
#include "script.hpp"

#include <algorithm>

#include "assets/file.hpp"
#include "keys.hpp"
#include "pipeline/camera_path.hpp"
#include "settings.hpp"

namespace crofton::viewer {
namespace {

Error bad_event(const std::string& why) {
    return fail(ErrorCode::parse, kNoItem, why);
}

bool is_pair_of_whole_numbers(const Json& value) {
    const std::span<const Json> parts = value.elements();
    return parts.size() == 2 && parts[0].is_number_integer() && parts[1].is_number_integer();
}

int pixels(const Json& value) {
    constexpr std::int64_t kFarOutside = 1'000'000;
    return static_cast<int>(std::clamp(value.integer(), -kFarOutside, kFarOutside));
}

// The one field beside "frame" says what is to be done.
Result<Action> parse_action(const std::string& name, const Json& value) {
    Action action;
    if (name == "key" || name == "key_down" || name == "key_up" || name == "drop") {
        if (!value.is_string()) return bad_event("'" + name + "' takes a text");
        action.event.text = value.text();
        if (name != "drop" && !is_key(action.event.text))
            return bad_event("no key is called '" + action.event.text + "' (crofton view --help lists them)");
        action.event.kind = name == "drop"     ? Event::Kind::drop
                            : name == "key_up" ? Event::Kind::key_up
                                               : Event::Kind::key_down;
    } else if (name == "camera") {
        auto camera = pipeline::camera_from_json(value, kNoItem);
        if (!camera) return bad_event(camera.error().message);
        action.kind = Action::Kind::camera;
        action.camera = *camera;
    } else if (name == "set") {
        if (!value.is_object()) return bad_event("'set' takes an object of switches");
        Settings scratch;
        for (const auto& [key, wanted] : value.members())
            if (auto set = set_switch(scratch, key, wanted); !set) return bad_event(set.error().message);
        action.kind = Action::Kind::set;
        action.set = value;
    } else if (name == "screenshot") {
        if (!value.is_string()) return bad_event("'screenshot' takes a file name");
        action.kind = Action::Kind::screenshot;
        action.file = value.text();
    } else if (name == "click" || name == "resize") {
        if (!is_pair_of_whole_numbers(value)) return bad_event("'" + name + "' takes two whole numbers");
        action.kind = name == "click" ? Action::Kind::click : Action::Kind::resize;
        action.at = {pixels(value.elements()[0]), pixels(value.elements()[1])};
        if (name == "resize" && (action.at.x < 1 || action.at.y < 1 || action.at.x > 16384 || action.at.y > 16384))
            return bad_event("a size must be from 1 to 16384");
    } else if (name == "scale") {
        if (!value.is_number() || !(value.number() >= 0.5 && value.number() <= 8.0))
            return bad_event("'scale' takes a number from 0.5 to 8");
        action.event.kind = Event::Kind::scale;
        action.event.at = glm::dvec2(value.number());
    } else if (name == "lose_device") {
        action.kind = Action::Kind::lose_device;
    } else if (name == "quit") {
        action.kind = Action::Kind::quit;
    } else {
        return bad_event("unknown action '" + name +
                         "'; there are key, key_down, key_up, set, camera, click, resize, scale, drop, screenshot, "
                         "lose_device and quit");
    }
    return action;
}

// One entry of the script, behind those before it.
Result<void> parse_entry(const Json& entry, std::vector<Action>& actions) {
    const Json* at = entry.find("frame");
    if (at == nullptr || entry.members().size() != 2 || !at->is_number_unsigned())
        return bad_event("an object with 'frame' (a whole number) and one action is expected");
    const auto frame = static_cast<std::uint32_t>(at->whole());
    if (!actions.empty() && frame < actions.back().frame) return bad_event("frames must not decrease");
    for (const auto& [name, value] : entry.members()) {
        if (name == "frame") continue;
        auto action = parse_action(name, value);
        if (!action) return std::move(action.error());
        action->frame = frame;
        actions.push_back(std::move(*action));
        if (name != "key") continue;
        // A key pressed is also let go.
        actions.push_back(actions.back());
        actions.back().event.kind = Event::Kind::key_up;
    }
    return {};
}

}  // namespace

Result<std::vector<Action>> parse_script(const std::string& text) {
    if (const auto line = line_of_syntax_error(text))
        return fail(ErrorCode::parse, kNoItem, "script line " + std::to_string(*line) + ": not valid JSON");
    Json document;
    if (!parse_json(text, document))
        return fail(ErrorCode::parse, kNoItem,
                    "script: nested deeper than " + std::to_string(kMaxJsonDepth) + " arrays and objects");
    const Json* events = document.find("events");
    if (events == nullptr || !events->is_array())
        return fail(ErrorCode::parse, kNoItem, "script: an object with an array 'events' is expected");
    const std::vector<std::size_t> lines = lines_of_events(text);
    std::vector<Action> actions;
    std::size_t number = 0;
    for (const Json& entry : events->elements()) {
        if (auto parsed = parse_entry(entry, actions); !parsed)
            return fail(ErrorCode::parse, number,
                        "script line " + std::to_string(lines[number]) + ", event " + std::to_string(number) + ": " +
                            parsed.error().message);
        ++number;
    }
    return actions;
}

Result<std::vector<Action>> load_script(const std::string& path) {
    auto text = assets::read_file(path);
    if (!text) return std::move(text.error());
    auto actions = parse_script(*text);
    if (!actions) return fail(actions.error().code, actions.error().item, path + ": " + actions.error().message);
    return actions;
}

}  // namespace crofton::viewer
