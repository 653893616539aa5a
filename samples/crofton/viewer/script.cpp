#include "script.hpp"

#include "assets/file.hpp"
#include "keys.hpp"
#include "pipeline/camera_path.hpp"
#include "script_lines.hpp"
#include "settings.hpp"

namespace crofton::viewer {
namespace {

tl::unexpected<Error> bad_event(const std::string& why) {
    return fail(ErrorCode::parse, kNoItem, why);
}

bool is_pair_of_whole_numbers(const nlohmann::json& value) {
    return value.is_array() && value.size() == 2 && value[0].is_number_integer() && value[1].is_number_integer();
}

// The one field beside "frame" says what is to be done.
Result<Action> parse_action(const std::string& name, const nlohmann::json& value) {
    Action action;
    if (name == "key" || name == "key_down" || name == "key_up" || name == "drop") {
        if (!value.is_string()) return bad_event("'" + name + "' takes a text");
        action.event.text = value.get<std::string>();
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
        for (const auto& [key, wanted] : value.items())
            if (auto set = set_switch(scratch, key, wanted); !set) return bad_event(set.error().message);
        action.kind = Action::Kind::set;
        action.set = value;
    } else if (name == "screenshot") {
        if (!value.is_string()) return bad_event("'screenshot' takes a file name");
        action.kind = Action::Kind::screenshot;
        action.file = value.get<std::string>();
    } else if (name == "click" || name == "resize") {
        if (!is_pair_of_whole_numbers(value)) return bad_event("'" + name + "' takes two whole numbers");
        action.kind = name == "click" ? Action::Kind::click : Action::Kind::resize;
        action.at = {value[0].get<int>(), value[1].get<int>()};
        if (name == "resize" && (action.at.x < 1 || action.at.y < 1 || action.at.x > 16384 || action.at.y > 16384))
            return bad_event("a size must be from 1 to 16384");
    } else if (name == "scale") {
        if (!value.is_number() || !(value.get<double>() >= 0.5 && value.get<double>() <= 8.0))
            return bad_event("'scale' takes a number from 0.5 to 8");
        action.event.kind = Event::Kind::scale;
        action.event.at = glm::dvec2(value.get<double>());
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
Result<void> parse_entry(const nlohmann::json& entry, std::vector<Action>& actions) {
    if (!entry.is_object() || entry.size() != 2 || !entry.contains("frame") || !entry["frame"].is_number_unsigned())
        return bad_event("an object with 'frame' (a whole number) and one action is expected");
    const auto frame = entry["frame"].get<std::uint32_t>();
    if (!actions.empty() && frame < actions.back().frame) return bad_event("frames must not decrease");
    for (const auto& [name, value] : entry.items()) {
        if (name == "frame") continue;
        auto action = parse_action(name, value);
        if (!action) return tl::unexpected(std::move(action.error()));
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
    const nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
    if (!document.is_object() || !document.contains("events") || !document["events"].is_array())
        return fail(ErrorCode::parse, kNoItem, "script: an object with an array 'events' is expected");
    const std::vector<std::size_t> lines = lines_of_events(text);
    std::vector<Action> actions;
    std::size_t number = 0;
    for (const nlohmann::json& entry : document["events"]) {
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
    if (!text) return tl::unexpected(std::move(text.error()));
    auto actions = parse_script(*text);
    if (!actions) return fail(actions.error().code, actions.error().item, path + ": " + actions.error().message);
    return actions;
}

}  // namespace crofton::viewer
