// The session's ears: keys, clicks, scripts, buttons.
#include <imgui.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/file.hpp"
#include "pipeline/camera_path.hpp"
#include "session.hpp"

namespace crofton::viewer {

void Session::handle_events() {
    if (!window_) return;
    const ImGuiIO& io = ImGui::GetIO();
    for (const Event& event : window_->take_events()) {
        const bool key = event.kind == Event::Kind::key_down;
        const bool mouse = event.kind == Event::Kind::button_down || event.kind == Event::Kind::scroll;
        // What the panels want is theirs; letting go is for both.
        if ((key && io.WantCaptureKeyboard) || (mouse && io.WantCaptureMouse)) continue;
        handle(event);
    }
}

void Session::handle(const Event& event) {
    if (event.kind == Event::Kind::cursor) cursor_ = event.at;
    if (event.kind == Event::Kind::drop) {
        SceneRequest request;
        request.source = event.text;
        if (auto loaded = load(request); !loaded) report(loaded.error());
        return;
    }
    if (event.kind == Event::Kind::key_down && handle_key(event.text)) return;
    if (event.kind == Event::Kind::button_down && event.button == 0) click(event.at);
    eye_.handle(event);
}

bool Session::handle_key(const std::string& key) {
    Settings& s = settings_;
    const auto flip = [](bool& flag) {
        flag = !flag;
        return true;
    };
    if (key.size() == 1 && key[0] >= '1' && key[0] <= '9') return eye_.recall_bookmark(key[0] - '0') || true;
    if (key.size() == 6 && key.rfind("Ctrl+", 0) == 0 && key[5] >= '1' && key[5] <= '9') {
        eye_.store_bookmark(key[5] - '0');
        return true;
    }
    if (key == "F") return flip(s.freeze);
    if (key == "I") return flip(s.inset);
    if (key == "O") return flip(s.outside);
    if (key == "B") return flip(s.bounds);
    if (key == "X") return flip(s.wireframe);
    if (key == "K") return flip(s.collisions);
    if (key == "L") return flip(s.exact);
    if (key == "G") return flip(s.compare);
    if (key == "P" || key == "Space") return flip(s.paused);
    if (key == "H") return flip(s.panels);
    if (key == ".") return step_ = true;
    if (key == "C") {
        s.coloring = static_cast<Coloring>((static_cast<std::size_t>(s.coloring) + 1) % std::size(kColoringNames));
        return true;
    }
    if (key == "N") {
        s.method.bounds = static_cast<pipeline::BoundsKind>((static_cast<int>(s.method.bounds) + 1) % 6);
        return true;
    }
    if (key == "M") {
        s.method.cull = static_cast<pipeline::CullMode>((static_cast<int>(s.method.cull) + 1) % 3);
        return true;
    }
    if (key == "Y") {
        Triangulation& t = s.method.triangulation;
        t = static_cast<Triangulation>((static_cast<std::size_t>(t) + 1) % std::size(kTriangulationNames));
        return true;
    }
    if (key == "T") {
        const int height = static_cast<int>(stage_->pipeline().tree().height());
        s.tree_level = s.tree_level + 1 >= height ? -1 : s.tree_level + 1;
        return true;
    }
    if (key == "V") {
        s.cascades = s.cascades % 8 + 1;
        return true;
    }
    if (key == "-" || key == "+") {
        s.time_scale = std::clamp(s.time_scale * (key == "+" ? 2.0 : 0.5), 1.0 / 64.0, 64.0);
        return true;
    }
    if (key == "Tab") {
        eye_.mode = eye_.mode == EyeMode::fly ? EyeMode::orbit : EyeMode::fly;
        return true;
    }
    if (key == "Home") {
        eye_.frame_all(stage_->focus(), stage_->extent());
        return true;
    }
    if (key == "R") {
        toggle_recording();
        return true;
    }
    if (key == "F5") {
        export_files();
        return true;
    }
    if (key == "F2") {
        screenshots_.push_back(options_.output_folder + "/crofton_" + std::to_string(frame_index_) + ".png");
        return true;
    }
    if (key == "Ctrl+Q" || key == "Escape") return quit_ = true;
    return false;
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
            eye_.look(action.camera);
            break;
        case Action::Kind::set:
            for (const auto& [name, value] : action.set.items())
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
    pick_ = pick(stage_->scene(), frame_.visible_ids, eye_.camera, place);
    selected_ = pick_ ? pick_->instance : scene::kNone;
}

void Session::toggle_recording() {
    is_recording_ = !is_recording_;
    if (is_recording_) {
        recording_.clear();
        return;
    }
    nlohmann::json cameras = nlohmann::json::array();
    for (const Camera& camera : recording_) cameras.push_back(pipeline::to_json(camera));
    const std::string file = options_.output_folder + "/camera_path.json";
    const auto written = assets::write_file(file, nlohmann::json{{"cameras", std::move(cameras)}}.dump(1) + "\n");
    if (!written) return report(written.error());
    replay_ = recording_;
}

void Session::export_files() {
    const std::string base = options_.output_folder + "/statistics";
    for (const auto& [file, text] :
         {std::pair<std::string, std::string>{base + ".json", journal_.json().dump(1) + "\n"},
          {base + ".csv", journal_.csv()},
          {base + "_trace.json", journal_.chrome_trace()}})
        if (auto written = assets::write_file(file, text); !written) report(written.error());
}

void Session::grant(const PanelWish& wish) {
    if (wish.frame_all) eye_.frame_all(stage_->focus(), stage_->extent());
    if (wish.record) toggle_recording();
    if (wish.replay) replaying_ = !replaying_ && !replay_.empty();
    if (wish.export_files) export_files();
    if (wish.screenshot) handle_key("F2");
    if (wish.step) step_ = true;
    if (wish.select) selected_ = *wish.select;
}

}  // namespace crofton::viewer
