// SPDX-License-Identifier: MIT
// The session's beginnings: window, device, interface, scene.
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <memory>

#include <crofton/render/vertex.hpp>
#include <filesystem>

#include "pipeline/camera_path.hpp"
#include "pipeline/free_space.hpp"
#include "pipeline/street.hpp"
#include "session.hpp"
#include "shape_colors.hpp"

namespace crofton::viewer {

Session::~Session() {
    // ImGui's window backend before the window, everything on the device before the device.
    if (imgui_window_) ImGui_ImplGlfw_Shutdown();
    ui_.reset();
    ui_commands_ = {};
    rasterizer_.reset();
    window_.reset();
    device_.reset();
    if (imgui_) ImGui::DestroyContext();
}

Result<void> Session::start() {
    wanted_size_ = {options_.width, options_.height};
    if (!options_.script.empty()) {
        auto actions = load_script(options_.script);
        if (!actions) return std::move(actions.error());
        script_.assign(actions->begin(), actions->end());
    }
    if (options_.window)
        if (auto started = start_window(); !started) return started;
    if (auto started = start_device(); !started) return started;
    if (auto started = start_interface(); !started) return started;
    options_.scene.waits_for_regions = unattended();
    if (auto loaded = load(options_.scene); !loaded) return loaded;
    return load_replay();
}

Result<void> Session::start_window() {
    auto window = Window::create("Crofton", static_cast<int>(options_.width), static_cast<int>(options_.height));
    if (!window) return std::move(window.error());
    window_ = std::move(*window);
    return {};
}

Result<void> Session::start_device() {
    render::DeviceOptions wanted;
    wanted.name = options_.device;
    wanted.validation = options_.validation;
    if (window_) {
        wanted.instance_extensions = Window::instance_extensions();
        wanted.device_extensions = Window::device_extensions();
    }
    auto device = render::Device::create(wanted);
    if (!device) return std::move(device.error());
    device_ = std::make_unique<render::Device>(std::move(*device));
    render::RasterizerOptions size;
    size.width = options_.width;
    size.height = options_.height;
    auto rasterizer = render::Rasterizer::create(*device_, size);
    if (!rasterizer) return std::move(rasterizer.error());
    rasterizer_ = std::make_unique<render::Rasterizer>(std::move(*rasterizer));
    return window_ ? window_->attach(device_->context()) : Result<void>{};
}

Result<void> Session::start_interface() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    imgui_ = true;
    ImGui::GetIO().IniFilename = nullptr;
    if (window_) imgui_window_ = ImGui_ImplGlfw_InitForOther(window_->handle(), true);
    if (window_) wanted_scale_ = window_->content_scale();
    scale_ = options_.scale > 0.0f ? options_.scale : wanted_scale_;
    apply_style(scale_);
    return start_ui_renderer();
}

Result<void> Session::start_ui_renderer() {
    auto ui = UiRenderer::create(device_->context());
    if (!ui) return std::move(ui.error());
    ui_ = std::move(*ui);
    auto commands = render::Commands::create(device_->context());
    if (!commands) return std::move(commands.error());
    ui_commands_ = std::move(*commands);
    return {};
}

// A device or a surface is gone: all that lived on it is made anew, the scene and the user's view stay.
Result<void> Session::recover() {
    for (const std::string& message : device_->validation_messages()) lost_messages_.push_back(message);
    device_->context().vk.vkDeviceWaitIdle(device_->context().device);
    ui_.reset();
    ui_commands_ = {};
    rasterizer_.reset();
    if (window_) window_->detach();
    device_.reset();
    if (auto started = start_device(); !started) return started;
    if (auto started = start_ui_renderer(); !started) return started;
    stale_size_ = true;
    return upload_geometry();
}

Result<void> Session::load(const SceneRequest& request) {
    const bool same_scene = loaded_ && request.source == request_.source && request.map == request_.map;
    auto loaded = LoadedScene::load(request, settings_.method, settings_, same_scene ? loaded_.get() : nullptr);
    if (!loaded) return std::move(loaded.error());
    // First drop everything that refers to the old scene.
    list_.reset();
    contacts_ = {};
    sight_.reset();
    hiders_.clear();
    drawn_ids_.clear();
    seen_frame_.reset();
    pick_.reset();
    if (!same_scene) {
        other_.reset();
        selected_ = scene::kNone;
        scene_time_ = 0.0;
        replaying_ = false;
    }
    loaded_ = std::move(*loaded);
    request_ = request;
    nodes_.rebuild(loaded_->scene());
    for (const std::string& warning : loaded_->source().warnings) report({ErrorCode::unsupported, kNoItem, warning});
    if (!same_scene) {
        controller_.frame_all(loaded_->focus(), loaded_->extent());
        const std::vector<glm::dvec3>& walk = loaded_->source().walk;
        if (walk.size() > 1)
            controller_.stand(walk[0], walk[1], pipeline::FreeSpace::kPersonEye);
        else if (!loaded_->regions())
            stand_inside();
        culling_camera_ = controller_.camera;
        if (window_) window_->set_title("Crofton: " + loaded_->source().name + " (F1: help)");
    }
    if (!same_scene && window_)
        note("W A S D: walk; Q E: down, up; drag with the right button: look; wheel: speed; F1: all keys", 20.0);
    clusters_.reset();
    list_geometry();
    return upload_geometry();
}

void Session::list_geometry() {
    if (const pipeline::RegionPipeline* const regions = loaded_->regions()) {
        listed_meshes_ = regions->mesh_revision();
        list_ = std::make_unique<pipeline::DrawList>(
            regions->drawables(), pipeline::DrawList::Looks{regions->unlit(), regions->one_sided(), regions->flat()},
            nullptr);
        return;
    }
    const assets::SceneSource& source = loaded_->source();
    list_ = std::make_unique<pipeline::DrawList>(
        source.scene, pipeline::DrawList::Looks{source.unlit, source.one_sided, source.flat}, clusters_);
}

// Regions that have come may have brought meshes.
Result<void> Session::follow_regions() {
    if (!loaded_->regions() || loaded_->regions()->mesh_revision() == listed_meshes_) return {};
    list_geometry();
    return upload_geometry();
}

// What needs a scene, or bounds of all objects.
void Session::leave_out_what_regions_lack() {
    if (!loaded_->regions()) return;
    Settings& s = settings_;
    const bool shows = s.coloring == Coloring::lit || s.coloring == Coloring::verdict ||
                       s.coloring == Coloring::shape || s.coloring == Coloring::regions ||
                       s.coloring == Coloring::visible_set;
    if (shows && !s.compare && !s.outside && !s.bounds && !s.hulls && !s.depth_buffer && !s.method.occlude &&
        s.cascades == 1 && s.tree_level < 0)
        return;
    if (!shows) s.coloring = Coloring::regions;
    s.compare = s.outside = s.bounds = s.hulls = s.depth_buffer = s.method.occlude = false;
    s.cascades = 1, s.tree_level = -1;
    note(
        "over regions there are the colourings lit, verdict, shape, visible set and regions, and no overlays of "
        "objects");
}

Result<void> Session::cut_clusters() {
    if (settings_.coloring != Coloring::clusters || clusters_) return {};
    clusters_ = loaded_->clusters();
    if (!clusters_) {
        auto cut = pipeline::cut_scene(loaded_->scene(), serial_executor());
        if (!cut) return lasting(std::move(cut.error()));
        clusters_ = std::make_shared<const pipeline::SceneClusters>(std::move(*cut));
    }
    list_geometry();
    stale_geometry_ = true;
    return {};
}

// A level is looked at from where much of it is seen; what has no inside stays framed as a whole.
void Session::stand_inside() {
    const auto space = pipeline::FreeSpace::find(loaded_->scene(), loaded_->focus(), {.unit = loaded_->source().unit});
    const auto stand = space ? space->best_stand() : std::nullopt;
    if (stand) controller_.stand(stand->eye, stand->eye + stand->forward, space->eye_height());
}

Result<void> Session::upload_geometry() {
    stale_geometry_ = true;
    shape_uploaded_ = settings_.coloring == Coloring::shape;
    const auto upload = [&] {
        if (!shape_uploaded_) return rasterizer_->set_geometry(list_->vertices(), list_->indices());
        const ShapeColored colored = color_by_shape(list_->vertices(), list_->indices());
        return rasterizer_->set_geometry(colored.vertices, colored.indices);
    };
    auto uploaded = upload();
    stale_geometry_ = !uploaded;
    return uploaded;
}

Result<void> Session::follow_settings() {
    leave_out_what_regions_lack();
    // A file may have gone or changed since: the scene on show stays, with the method that it has.
    if (loaded_->needs_reload(settings_.method)) {
        if (auto loaded = load(request_); !loaded) {
            report(loaded.error());
            settings_.method = loaded_->method();
        }
    } else if (auto configured = loaded_->configure(settings_.method, settings_); !configured) {
        return lasting(std::move(configured));
    }
    if (!settings_.compare) {
        other_.reset();
    } else if (!other_ || other_->needs_reload(settings_.other)) {
        auto other = LoadedScene::load(request_, settings_.other, settings_, loaded_.get());
        if (other) {
            other_ = std::move(*other);
        } else {
            report(other.error());
            settings_.compare = false;
        }
    } else if (auto configured = other_->configure(settings_.other, settings_); !configured) {
        return lasting(std::move(configured));
    }
    if (auto cut = cut_clusters(); !cut) return cut;
    if (stale_geometry_ || shape_uploaded_ != (settings_.coloring == Coloring::shape)) return upload_geometry();
    return {};
}

Result<void> Session::load_replay() {
    if (options_.camera.empty()) return {};
    pipeline::PathOptions path;
    path.kind = options_.camera;
    const bool built_in = !std::filesystem::exists(path.kind);
    path.frames = options_.frames > 0 ? options_.frames : built_in ? 600 : 0;
    path.aspect = static_cast<double>(options_.width) / options_.height;
    path.limits = options_.scene.limits;
    pipeline::Street street;
    if (path.kind == "street" && loaded_->regions() == nullptr) {
        street = pipeline::street_of(loaded_->source(), loaded_->focus());
    } else if (path.kind == "street") {
        auto found = pipeline::street_of_regions(request_.source, loaded_->regions()->stream().index(), path.limits);
        if (!found) return std::move(found.error());
        street = std::move(*found);
    }
    if (!street.remark.empty()) report({ErrorCode::unsupported, kNoItem, street.remark});
    street.set(path);
    auto made =
        pipeline::make_camera_path(path, loaded_->regions() ? loaded_->extent() : loaded_->focus(), street.walk);
    if (!made) return std::move(made.error());
    path_ = std::move(*made);
    replaying_ = true;
    return {};
}

}  // namespace crofton::viewer
