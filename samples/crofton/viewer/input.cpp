// SPDX-License-Identifier: MIT
// The session's ears: keys, clicks, scripts, buttons.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <crofton/boxtree/structure.hpp>
#include <iterator>

#include "assets/file.hpp"
#include "json/json.hpp"
#include "pipeline/camera_path.hpp"
#include "session.hpp"

namespace crofton::viewer {

void Session::handle_events() {
    if (!window_) return;
    const ImGuiIO& io = ImGui::GetIO();
    for (const Event& event : window_->take_events()) {
        const bool key = event.kind == Event::Kind::key_down;
        const bool mouse = event.kind == Event::Kind::button_down || event.kind == Event::Kind::scroll;
        // Panels take the events that they want; releases go to both. Of keys, panels take only those that write text,
        // because ImGui wants the keyboard as long as a button is held down on any widget. ImGui knows the mouse of its
        // last frame only: a click may come with the motion that led it onto a panel.
        if (event.kind == Event::Kind::cursor) cursor_ = event.at;
        if (settings_.panels && ((key && io.WantTextInput) || (mouse && (io.WantCaptureMouse || on_panel(cursor_)))))
            continue;
        handle(event);
    }
}

void Session::handle(const Event& event) {
    if (event.kind == Event::Kind::cursor) cursor_ = event.at;
    if (event.kind == Event::Kind::scale) {
        wanted_scale_ = static_cast<float>(event.at.x);
        return;
    }
    if (event.kind == Event::Kind::drop) {
        SceneRequest request;
        request.source = event.text;
        if (auto loaded = load(request); !loaded) {
            report(loaded.error());
            note("the scene stays: " + loaded_->source().name);
        }
        return;
    }
    if (event.kind == Event::Kind::key_down && handle_key(event.text)) return;
    if (event.kind == Event::Kind::button_down && event.button == 0) click(event.at);
    controller_.handle(event);
}

// The switches that a key flips.
constexpr std::array<std::pair<const char*, bool Settings::*>, 14> kFlips{{{"F", &Settings::freeze},
                                                                           {"I", &Settings::inset},
                                                                           {"O", &Settings::outside},
                                                                           {"B", &Settings::bounds},
                                                                           {"U", &Settings::hulls},
                                                                           {"J", &Settings::depth_buffer},
                                                                           {"X", &Settings::wireframe},
                                                                           {"K", &Settings::collisions},
                                                                           {"L", &Settings::exact},
                                                                           {"G", &Settings::compare},
                                                                           {"P", &Settings::paused},
                                                                           {"Space", &Settings::paused},
                                                                           {"H", &Settings::panels},
                                                                           {"F1", &Settings::help}}};

template <class Enum>
void next(Enum& value, std::size_t count) {
    value = static_cast<Enum>((static_cast<std::size_t>(value) + 1) % count);
}

bool Session::handle_key(const std::string& key) {
    for (const auto& [name, flag] : kFlips)
        if (key == name) {
            settings_.*flag = !(settings_.*flag);
            return true;
        }
    return cycle_setting(key) || handle_bookmark(key) || handle_command(key);
}

bool Session::cycle_setting(const std::string& key) {
    Settings& s = settings_;
    if (key == "C") {
        next(s.coloring, std::size(kColoringNames));
    } else if (key == "N") {
        next(s.method.bounds, 6);
    } else if (key == "M") {
        next(s.method.cull, 3);
    } else if (key == "F4") {
        next(s.method.tree, 3);
    } else if (key == "Y") {
        next(s.method.triangulation, std::size(kTriangulationNames));
    } else if (key == "Z") {
        s.method.occlude = !s.method.occlude;
    } else if (key == "T") {
        const int height = static_cast<int>(loaded_->pipeline().world().tree().structure().height());
        s.tree_level = s.tree_level + 1 >= height ? -1 : s.tree_level + 1;
    } else if (key == "V") {
        s.cascades = s.cascades % 8 + 1;
    } else if (key == "-" || key == "+") {
        s.time_scale = std::clamp(s.time_scale * (key == "+" ? 2.0 : 0.5), 1.0 / 64.0, 64.0);
    } else {
        return false;
    }
    return true;
}

bool Session::handle_bookmark(const std::string& key) {
    const char last = key.empty() ? '0' : key.back();
    if (last < '1' || last > '9') return false;
    if (key == std::string("Ctrl+") + last) {
        controller_.store_bookmark(last - '0');
        note("bookmark " + std::string(1, last) + " set");
        return true;
    }
    if (key.size() != 1) return false;
    if (!controller_.recall_bookmark(last - '0')) note("bookmark " + key + " is not set: Ctrl+" + key + " sets it");
    return true;
}

bool Session::handle_command(const std::string& key) {
    if (key == "Tab") {
        controller_.mode = controller_.mode == CameraMode::fly ? CameraMode::orbit : CameraMode::fly;
    } else if (key == "Home") {
        controller_.frame_all(loaded_->focus(), loaded_->extent());
    } else if (key == ".") {
        step_ = true;
    } else if (key == "R") {
        toggle_recording();
    } else if (key == "F6") {
        toggle_replay();
    } else if (key == "F5") {
        export_files();
    } else if (key == "F2") {
        screenshots_.push_back(options_.output_folder + "/crofton_" + std::to_string(frame_index_) + ".png");
        note("saving " + screenshots_.back());
    } else if (key == "Ctrl+Q" || key == "Escape") {
        quit_ = true;
    } else {
        return false;
    }
    return true;
}

void Session::run_script() {
    while (!script_.empty() && script_.front().frame <= frame_index_) {
        const Action action = std::move(script_.front());
        script_.pop_front();
        perform(action);
    }
}

void Session::perform(const Action& action) {
    switch (action.kind) {
        case Action::Kind::event:
            handle(action.event);
            break;
        case Action::Kind::camera:
            replaying_ = false;
            controller_.look(action.camera);
            break;
        case Action::Kind::set:
            for (const auto& [name, value] : action.set.members())
                if (auto set = set_switch(settings_, name, value); !set) report(set.error());
            break;
        case Action::Kind::screenshot:
            screenshots_.push_back(action.file);
            break;
        case Action::Kind::click:
            click(glm::dvec2(action.at));
            break;
        case Action::Kind::resize:
            wanted_size_ = {static_cast<std::uint32_t>(action.at.x), static_cast<std::uint32_t>(action.at.y)};
            if (window_) window_->set_size(action.at.x, action.at.y);
            break;
        case Action::Kind::lose_device:
            lose_device_ = true;
            break;
        case Action::Kind::quit:
            quit_ = true;
            break;
    }
}

void Session::click(const glm::dvec2& pixel) {
    const glm::dvec2 size(wanted_size_.width, wanted_size_.height);
    const glm::dvec2 place(2.0 * (pixel.x + 0.5) / size.x - 1.0, 1.0 - 2.0 * (pixel.y + 0.5) / size.y);
    if (const pipeline::RegionPipeline* const regions = loaded_->regions())
        pick_ = pick(*regions, drawn_ids_, controller_.camera, place);
    else
        pick_ = pick(loaded_->pipeline().world(), loaded_->shapes(), drawn_ids_, controller_.camera, place);
    selected_ = pick_ ? pick_->instance : scene::kNone;
}

void Session::toggle_recording() {
    is_recording_ = !is_recording_;
    if (is_recording_) {
        recording_ = {};
        return note("recording the camera's path: R stops and saves it");
    }
    Json cameras = Json::array();
    for (std::size_t i = 0; i < recording_.cameras.size(); ++i) {
        cameras.push_back(pipeline::to_json(recording_.cameras[i]));
        cameras.back()["scene_frame"] = recording_.scene_frames[i];
    }
    const std::string file = options_.output_folder + "/camera_path.json";
    const auto written = assets::write_file(file, Json{{"cameras", std::move(cameras)}}.dump(1) + "\n");
    if (!written) return report(written.error());
    note("saved " + file + ": " + std::to_string(recording_.cameras.size()) + " cameras");
    path_ = recording_;
}

void Session::export_files() {
    const std::string base = options_.output_folder + "/statistics";
    for (const auto& [file, text] :
         {std::pair<std::string, std::string>{base + ".json", frame_history_.json().dump(1) + "\n"},
          {base + ".csv", frame_history_.csv()},
          {base + "_trace.json", frame_history_.chrome_trace()}})
        if (auto written = assets::write_file(file, text); !written) return report(written.error());
    note("saved " + base + ".json, .csv and _trace.json");
}

void Session::toggle_replay() {
    if (path_.cameras.empty()) return note("nothing to replay: R records a path, --camera FILE loads one");
    replaying_ = !replaying_;
    replayed_ = 0;
}

bool Session::on_panel(const glm::dvec2& at) const {
    return std::any_of(wish_.covered.begin(), wish_.covered.end(), [&](const PanelWish::Area& area) {
        return at.x >= area.left && at.x < area.right && at.y >= area.top && at.y < area.bottom;
    });
}

void Session::grant(const PanelWish& wish) {
    if (wish.frame_all) controller_.frame_all(loaded_->focus(), loaded_->extent());
    if (wish.record) toggle_recording();
    if (wish.replay) toggle_replay();
    if (wish.export_files) export_files();
    if (wish.screenshot) handle_key("F2");
    if (wish.step) step_ = true;
    if (wish.select) selected_ = *wish.select;
}

}  // namespace crofton::viewer
