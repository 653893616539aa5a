#include "script.hpp"

#include "assets/file.hpp"
#include "pipeline/camera_path.hpp"
#include "settings.hpp"

namespace crofton::viewer {
namespace {

tl::unexpected<Error> bad_event(std::size_t number, const std::string& why) {
    return fail(ErrorCode::parse, number, "script event " + std::to_string(number) + ": " + why);
}

bool is_pair_of_whole_numbers(const nlohmann::json& value) {
    return value.is_array() && value.size() == 2 && value[0].is_number_integer() && value[1].is_number_integer();
}

// The one field beside "frame" says what is to be done.
Result<Action> parse_action(const std::string& name, const nlohmann::json& value, std::size_t number) {
    Action action;
    if (name == "key" || name == "key_down" || name == "key_up" || name == "drop") {
        if (!value.is_string()) return bad_event(number, "'" + name + "' takes a text");
        action.event.text = value.get<std::string>();
        action.event.kind = name == "drop"     ? Event::Kind::drop
                            : name == "key_up" ? Event::Kind::key_up
                                               : Event::Kind::key_down;
    } else if (name == "camera") {
        auto camera = pipeline::camera_from_json(value, number);
        if (!camera) return bad_event(number, camera.error().message);
        action.kind = Action::Kind::camera;
        action.camera = *camera;
    } else if (name == "set") {
        if (!value.is_object()) return bad_event(number, "'set' takes an object of switches");
        Settings scratch;
        for (const auto& [key, wanted] : value.items())
            if (auto set = set_switch(scratch, key, wanted); !set) return bad_event(number, set.error().message);
        action.kind = Action::Kind::set;
        action.set = value;
    } else if (name == "screenshot") {
        if (!value.is_string()) return bad_event(number, "'screenshot' takes a file name");
        action.kind = Action::Kind::screenshot;
        action.file = value.get<std::string>();
    } else if (name == "click" || name == "resize") {
        if (!is_pair_of_whole_numbers(value)) return bad_event(number, "'" + name + "' takes two whole numbers");
        action.kind = name == "click" ? Action::Kind::click : Action::Kind::resize;
        action.at = {value[0].get<int>(), value[1].get<int>()};
        if (name == "resize" && (action.at.x < 1 || action.at.y < 1 || action.at.x > 16384 || action.at.y > 16384))
            return bad_event(number, "a size must be from 1 to 16384");
    } else if (name == "lose_device") {
        action.kind = Action::Kind::lose_device;
    } else if (name == "quit") {
        action.kind = Action::Kind::quit;
    } else {
        return bad_event(number, "unknown field '" + name + "'");
    }
    return action;
}

}  // namespace

Result<std::vector<Action>> parse_script(const std::string& text) {
    const nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
    if (document.is_discarded()) return fail(ErrorCode::parse, kNoItem, "script: not valid JSON");
    if (!document.is_object() || !document.contains("events") || !document["events"].is_array())
        return fail(ErrorCode::parse, kNoItem, "script: an object with an array 'events' is expected");
    std::vector<Action> actions;
    std::size_t number = 0;
    for (const nlohmann::json& entry : document["events"]) {
        if (!entry.is_object() || entry.size() != 2 || !entry.contains("frame") || !entry["frame"].is_number_unsigned())
            return bad_event(number, "an object with 'frame' (a whole number) and one action is expected");
        const auto frame = entry["frame"].get<std::uint32_t>();
        if (!actions.empty() && frame < actions.back().frame) return bad_event(number, "frames must not decrease");
        for (const auto& [name, value] : entry.items()) {
            if (name == "frame") continue;
            auto action = parse_action(name, value, number);
            if (!action) return tl::unexpected(std::move(action.error()));
            action->frame = frame;
            actions.push_back(std::move(*action));
            if (name != "key") continue;
            // A key pressed is also let go.
            actions.push_back(actions.back());
            actions.back().event.kind = Event::Kind::key_up;
        }
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
