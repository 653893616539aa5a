// SPDX-License-Identifier: MIT
// The session's panels, built and drawn over the picture.
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>

#include <ctime>
#include <utility>

#include "assets/file.hpp"
#include "session.hpp"

namespace crofton::viewer {
namespace {

// Returns the processor time of this thread; time that drawing takes from it does not count.
double computed_us() {
#ifdef CLOCK_THREAD_CPUTIME_ID
    timespec now{};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) == 0)
        return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
#endif
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

// Builds the panels and records how to draw them.
Result<void> Session::build_interface() {
    ui_us_ = 0.0;
    wish_ = {};
    if (!settings_.panels) return {};
    const double start = computed_us();
    ImGuiIO& io = ImGui::GetIO();
    io.DeltaTime = 1.0f / 60.0f;
    const glm::uvec2 size(rasterizer_->width(), rasterizer_->height());
    const ImVec2 pixels(static_cast<float>(size.x), static_cast<float>(size.y));
    if (imgui_window_) {
        ImGui_ImplGlfw_NewFrame();
        // The window system may speak in larger units than pixels; panels are laid out in pixels.
        if (io.DisplaySize.x > 0.0f && io.DisplaySize.y > 0.0f && io.MousePos.x > -1e6f)
            io.MousePos =
                ImVec2(io.MousePos.x * pixels.x / io.DisplaySize.x, io.MousePos.y * pixels.y / io.DisplaySize.y);
        io.DisplayFramebufferScale = ImVec2(1.0f, 1.0f);
    }
    io.DisplaySize = pixels;
    ImGui::NewFrame();
    const bool narrow = is_narrow(pixels);
    const bool folds = std::exchange(folded_, narrow).value_or(false) != narrow;
    const render::ImageResource* inset = settings_.inset ? rasterizer_->native_image(1) : nullptr;
    const ImTextureID shown = inset != nullptr ? ui_->show(inset->view) : nullptr;
    const ImVec2 inset_size =
        inset != nullptr ? ImVec2(static_cast<float>(rasterizer_->width(1)), static_cast<float>(rasterizer_->height(1)))
                         : ImVec2(0.0f, 0.0f);
    const auto depth = show_depth();
    if (!depth) {
        ImGui::EndFrame();
        return depth.error();
    }
    const pipeline::FrameStatistics* drawn =
        frame_history_.entries().empty() ? nullptr : &frame_history_.entries().back().frame;
    wish_ = draw_panels({settings_,
                         controller_,
                         *loaded_,
                         nodes_,
                         frame_,
                         drawn,
                         seen_frame_ ? &*seen_frame_ : nullptr,
                         other_ ? &other_frame_ : nullptr,
                         frame_history_,
                         instance_coloring_,
                         cluster_coloring_,
                         overlay_,
                         cascades_,
                         pick_,
                         selected_,
                         hiders_,
                         other_ ? other_->occlusion() : nullptr,
                         shown,
                         inset_size,
                         *depth,
                         depth_picture_,
                         *device_,
                         is_recording_,
                         replaying_,
                         notices_,
                         std::exchange(laid_out_, size) != size,
                         folds ? std::optional(narrow) : std::nullopt});
    ImGui::Render();
    if (auto begun = ui_commands_.begin(); !begun) return begun;
    if (auto recorded = ui_->record(ui_commands_.handle, *ImGui::GetDrawData()); !recorded) return recorded;
    ui_us_ = computed_us() - start;
    return {};
}

// The occluders' depth buffer, for its panel; null where it is not shown.
Result<ImTextureID> Session::show_depth() {
    const occlude::OcclusionBuffer* buffer = loaded_->pipeline().not_hidden().occlusion_buffer();
    if (!settings_.depth_buffer || loaded_->occlusion() == nullptr || buffer == nullptr) return nullptr;
    paint_depth(*buffer, depth_picture_);
    return ui_->show_pixels(depth_picture_.rgba, {depth_picture_.width, depth_picture_.height});
}

Result<void> Session::draw_interface() {
    if (ui_us_ == 0.0) return {};
    if (auto done = ui_commands_.submit_and_wait(); !done) return done;
    grant(wish_);
    return {};
}

void Session::save_what_there_is() {
    if (is_recording_) toggle_recording();
    if (auto finished = finish(); !finished) report(finished.error());
}

Result<void> Session::finish() {
    if (options_.json.empty() || !loaded_) return {};
    Json document = frame_history_.json();
    document["scene"] = {{"name", loaded_->source().name},
                         {"nodes", loaded_->scene().node_count()},
                         {"instances", loaded_->scene().instance_count()},
                         {"triangles", loaded_->triangle_count()}};
    if (device_) {
        document["device"] = device_->name();
        document["counts_exactly"] = device_->counts_exactly();
    }
    document["validation_messages"] = Json::array();
    for (const std::string& message : lost_messages_) document["validation_messages"].push_back(message);
    if (device_)
        for (const std::string& message : device_->validation_messages())
            document["validation_messages"].push_back(message);
    document["settings"] = to_json(settings_);
    document["pictures"] = pictures_;
    return assets::write_file(options_.json, document.dump(1) + "\n");
}

}  // namespace crofton::viewer
