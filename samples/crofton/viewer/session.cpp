// SPDX-License-Identifier: MIT
#include "session.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/cull/cull.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <thread>
#include <utility>

#include "assets/file.hpp"
#include "assets/print.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/png.hpp"

namespace crofton::viewer {
namespace {

constexpr double kInsetAspect = 16.0 / 9.0;
// The rasterizer's pictures beside that of the window, which is 0.
constexpr std::uint32_t kInset = 1, kOwners = 2;
// So many frames between two counts of what is seen.
constexpr std::uint32_t kSeenEvery = 30;
// A driver that loses its device again and again is given up on.
constexpr int kMaxRecoveries = 5;
// How long a message stays.
constexpr double kErrorSeconds = 12.0;

double microseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

// Behind and above the camera that culls, far enough to see what it sees.
Camera from_outside(const Camera& camera, double range) {
    const auto corners = view_corners(camera, range);
    Aabb bounds;
    for (const glm::dvec3& corner : corners) bounds.include(corner);
    const double radius = glm::length(bounds.half_extents());
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const glm::dvec3 side = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0)) + glm::dvec3(1e-9, 0.0, 0.0));
    Camera outside;
    outside.forward = glm::normalize(0.55 * forward - 0.45 * side - glm::dvec3(0.0, 0.7, 0.0));
    outside.position = bounds.center() - outside.forward * (radius / std::sin(0.5 * outside.fov_y));
    outside.near_distance = std::max(radius * 0.01, 1e-3);
    outside.far_distance = 20.0 * radius;
    outside.aspect = kInsetAspect;
    return outside;
}

}  // namespace

bool Session::running() const {
    if (advanced_) return true;  // a turn is to be taken again
    if (quit_ || (window_ && window_->should_close())) return false;
    if (options_.frames > 0) return frame_index_ < options_.frames;
    return options_.script.empty() ? window_ != nullptr : !script_.empty();
}

Result<void> Session::run_frame() {
    auto turned = try_turn();
    if (turned || std::exchange(is_lasting_, false)) return turned;
    if (recoveries_++ == kMaxRecoveries) return turned;
    report(turned.error());
    print_to(stderr, "crofton: restarting the device\n");
    return recover();
}

Result<void> Session::try_turn() {
    if (window_) {
        window_->wait_while_minimised();
        window_->poll();
    }
    const auto start = Clock::now();
    // Unattended runs must not depend on the machine's speed.
    const double seconds = unattended() ? 1.0 / 60.0 : std::min(microseconds_since(last_turn_) * 1e-6, 0.25);
    last_turn_ = start;
    handle_events();
    run_script();
    if (std::exchange(lose_device_, false)) return render::vulkan_failure(VK_ERROR_DEVICE_LOST, "script");
    if (auto followed = follow_settings(); !followed) return followed;
    if (auto resized = resize(); !resized) return resized;
    if (auto scaled = follow_scale(); !scaled) return scaled;
    // A turn that is taken again, after the device failed, shows the same moment.
    if (!std::exchange(advanced_, true)) advance(seconds);
    if (auto culled = cull(); !culled) return lasting(std::move(culled));
    if (auto followed = follow_regions(); !followed) return followed;
    if (auto started = start_drawing(); !started) return started;
    // The device draws; what needs no picture is done meanwhile.
    frame_.triangles_clipped = list_->predict_clipped();
    auto built = build_interface();
    if (auto finished = finish_drawing(); !finished) return finished;
    if (!built) return built;
    if (auto drawn = draw_interface(); !drawn) return drawn;
    if (auto saved = save_screenshots(); !saved) return saved;
    if (window_) {
        const VkExtent2D size{rasterizer_->width(), rasterizer_->height()};
        if (auto shown = window_->present(rasterizer_->native_image()->handle, size); !shown) return shown;
    }
    advanced_ = false;
    frame_.index = frame_index_++;
    const OcclusionCounts occlusion = loaded_->occlusion() ? loaded_->occlusion()->counts() : OcclusionCounts{};
    frame_history_.add({frame_, microseconds_since(start), ui_us_, occlusion, static_cast<std::uint32_t>(scene_time_)});
    // Presenting does not pace on every device: no more than 60 pictures a second.
    if (window_ && !unattended()) std::this_thread::sleep_until(start + std::chrono::microseconds(16'600));
    return {};
}

// The device is not to blame: another one would not help.
Result<void> Session::lasting(Result<void> failed) {
    is_lasting_ = true;
    return failed;
}

Result<void> Session::resize() {
    if (window_) {
        const VkExtent2D now = window_->framebuffer_size();
        if (now.width > 0 && now.height > 0) wanted_size_ = now;
    }
    if (!stale_size_ && wanted_size_.width == rasterizer_->width() && wanted_size_.height == rasterizer_->height() &&
        settings_.resolution == drawn_resolution_)
        return {};
    drawn_resolution_ = settings_.resolution;
    auto resized =
        rasterizer_->resize(wanted_size_.width, wanted_size_.height, 0, static_cast<float>(drawn_resolution_));
    if (!resized) return resized;
    stale_size_ = false;
    controller_.camera.aspect = static_cast<double>(wanted_size_.width) / wanted_size_.height;
    return ui_->set_target(rasterizer_->native_image()->view, wanted_size_);
}

// The window may come onto a display of another scale.
Result<void> Session::follow_scale() {
    const float wanted = options_.scale > 0.0f ? options_.scale : wanted_scale_;
    if (wanted == scale_) return {};
    scale_ = wanted;
    apply_style(scale_);
    laid_out_ = glm::uvec2(0);
    return ui_->upload_font();
}

void Session::advance(double seconds) {
    seconds_ += seconds;
    while (!notices_.empty() && (notices_.size() > 8 || notices_.front().until <= seconds_)) notices_.pop_front();
    if (!settings_.paused) scene_time_ += seconds * 60.0 * settings_.time_scale;
    if (std::exchange(step_, false)) scene_time_ += 1.0;
    if (replaying_ && !path_.cameras.empty()) {
        const std::size_t now = replayed_++ % path_.cameras.size();
        controller_.look(path_.cameras[now]);
        if (!settings_.paused) scene_time_ = path_.scene_frames[now];
    }
    controller_.advance(seconds);
    if (!settings_.freeze) culling_camera_ = controller_.camera, culling_size_ = drawn_size();
    const auto scene_frame = static_cast<std::uint32_t>(scene_time_);
    if (is_recording_) {
        recording_.cameras.push_back(controller_.camera);
        recording_.scene_frames.push_back(scene_frame);
    }
    loaded_->animate(scene_frame);
    if (other_) other_->animate(scene_frame);
}

Result<void> Session::cull() {
    auto frame = loaded_->run(culling_camera_);
    if (!frame) return std::move(frame.error());
    frame_ = std::move(*frame);
    // What is seen is counted no farther than regions are attached.
    if (loaded_->regions()) culling_camera_.far_distance = frame_.camera.far_distance;
    if (other_) {
        auto compared = other_->run(culling_camera_);
        if (!compared) return std::move(compared.error());
        other_frame_ = std::move(*compared);
    }
    cascades_.clear();
    if (settings_.cascades > 1)
        cascades_ =
            split_view(culling_camera_, settings_.cascades, 1.5 * glm::length(loaded_->extent().half_extents()));
    for (Cascade& cascade : cascades_) {
        const auto frustum = frustum_of(cascade.camera);
        if (!frustum) return frustum.error();
        (void)loaded_->pipeline().world().view({.volume = *frustum, .layers = pipeline::kSeenLayer}, cascade_visible_);
        cascade.visible = cascade_visible_.size();
    }
    list_drawn();
    hiders_.clear();
    if (loaded_->occlusion() && selected_ < loaded_->scene().instance_count())
        hiders_ = nodes_that_hide(loaded_->pipeline(), selected_);
    sight_ = settings_.coloring == Coloring::visible_set ? look_up(loaded_->pvs(), frame_) : std::nullopt;
    instance_coloring_.classify(*loaded_, frame_, settings_.coloring, selected_, hiders_);
    find_contacts();
    return color_clusters();
}

Result<void> Session::color_clusters() {
    if (settings_.coloring != Coloring::clusters) return {};
    std::vector<scene::InstanceId> in_view;
    const auto verdicts = loaded_->pipeline().verdicts();
    for (scene::InstanceId i = 0; i < verdicts.size(); ++i)
        if (verdicts[i] != cull::Verdict::outside) in_view.push_back(i);
    return cluster_coloring_.classify(loaded_->source(), *clusters_, in_view, culling_camera_,
                                      {culling_size_.width, culling_size_.height});
}

// Hidden objects are drawn if their colouring is on: they can be seen from elsewhere.
void Session::list_drawn() {
    drawn_ids_ = frame_.visible_ids;
    if (settings_.coloring != Coloring::occlusion || loaded_->occlusion() == nullptr) return;
    const auto hidden = loaded_->occlusion()->hidden();
    const auto middle = static_cast<std::ptrdiff_t>(drawn_ids_.size());
    drawn_ids_.insert(drawn_ids_.end(), hidden.begin(), hidden.end());
    std::inplace_merge(drawn_ids_.begin(), drawn_ids_.begin() + middle, drawn_ids_.end());
}

void Session::find_contacts() {
    const bool triangles = settings_.coloring == Coloring::collision && settings_.collisions;
    contacts_.update(loaded_->shapes(), loaded_->scene_frame(), frame_.colliding_ids, triangles, settings_.hulls);
}

Result<void> Session::submit_view(const Camera& camera, std::uint32_t picture, bool show_frustum) {
    if (settings_.coloring == Coloring::clusters)
        list_->select(cluster_coloring_.pieces(), camera);
    else
        list_->select(drawn_ids_, camera);
    lines_.clear(camera.position);
    overlay_.draw(lines_, settings_, *loaded_, frame_, contacts_, cascades_, selected_, show_frustum);
    if (settings_.hulls) overlay_.draw_hulls(lines_, loaded_->shapes(), loaded_->scene(), frame_, contacts_.hulls());
    if (sight_) overlay_.draw_cell(lines_, *sight_);
    return submit(camera, picture);
}

// Submits the frame, with the selection in its colours, and the lines.
Result<void> Session::submit(const Camera& camera, std::uint32_t picture) {
    instance_coloring_.paint(*list_, settings_.wireframe,
                             settings_.coloring == Coloring::clusters ? &cluster_coloring_ : nullptr);
    render::Frame frame;
    frame.camera = camera;
    frame.transforms = instance_coloring_.transforms();
    frame.ranges = instance_coloring_.ranges();
    frame.wire_ranges = instance_coloring_.wire_ranges();
    frame.lines = lines_.vertices();
    // Colours that mean something are not hazed, nor is light that has been computed.
    if (settings_.coloring != Coloring::lit) {
        frame.environment.haze_distance = 0.0f;
        frame.environment.sky = false;
        frame.environment.horizon = glm::vec3(0.012f, 0.014f, 0.02f);
    } else {
        const bool hazy = loaded_->source().unlit.empty() && picture == 0;
        double distance = hazy ? 2.5 * glm::length(loaded_->extent().half_extents()) : 0.0;
        if (hazy && loaded_->regions()) distance = loaded_->regions()->stream().distance();
        frame.environment.haze_distance = static_cast<float>(distance);
    }
    return rasterizer_->submit(frame, picture);
}

// B of the comparison, where the picture A will be: for its time and its counts. Its triangles are A's unless they are
// cut in another way.
Result<void> Session::draw_other() {
    other_frame_.gpu.reset();
    if (settings_.other.triangulation != settings_.method.triangulation) return {};
    const auto start = Clock::now();
    list_->select(other_frame_.visible_ids, controller_.camera);
    lines_.clear(controller_.camera.position);
    if (auto begun = submit(controller_.camera, 0); !begun) return begun;
    other_frame_.triangles_clipped = list_->predict_clipped();
    auto counters = rasterizer_->finish();
    if (!counters) return std::move(counters.error());
    other_frame_.draw_us = microseconds_since(start);
    other_frame_.gpu = *counters;
    return {};
}

Result<void> Session::start_drawing() {
    if (settings_.inset) {
        // As texts are scaled, but no wider than half the picture.
        double width = std::min(400.0 * static_cast<double>(scale_), 0.45 * wanted_size_.width);
        if (settings_.depth_buffer)
            width = std::min(width, static_cast<double>(half_beside_main_panel(static_cast<float>(wanted_size_.width),
                                                                               font_pixels(scale_))));
        const auto columns = static_cast<std::uint32_t>(std::max(width, 16.0));
        const auto rows = static_cast<std::uint32_t>(std::max(width / kInsetAspect, 9.0));
        if (auto sized = rasterizer_->resize(columns, rows, kInset); !sized) return sized;
        // Use the extent of most triangles; with the far landscape the scene would be a speck.
        const double range = glm::length(loaded_->focus().half_extents());
        if (auto begun = submit_view(from_outside(culling_camera_, range), kInset, true); !begun) return begun;
        if (auto done = rasterizer_->finish(); !done) return std::move(done.error());
    }
    if (other_)
        if (auto drawn = draw_other(); !drawn) return drawn;
    draw_start_ = Clock::now();
    return submit_view(controller_.camera, 0, settings_.freeze);
}

Result<void> Session::finish_drawing() {
    auto counters = rasterizer_->finish();
    if (!counters) return std::move(counters.error());
    frame_.draw_us = microseconds_since(draw_start_);
    frame_.gpu = *counters;
    if (options_.frames > 0 && frame_index_ + 1 == options_.frames && !options_.screenshot.empty())
        screenshots_.push_back(options_.screenshot);
    const bool wanted = frame_index_ % kSeenEvery == 0 || !screenshots_.empty();
    return settings_.seen && wanted ? count_seen() : Result<void>{};
}

VkExtent2D Session::drawn_size() const {
    const auto side = [&](std::uint32_t whole) {
        return std::max(1u, static_cast<std::uint32_t>(std::lround(whole * drawn_resolution_)));
    };
    return {side(rasterizer_->width()), side(rasterizer_->height())};
}

// From the eye that culls, with as many pixels as are drawn.
Result<void> Session::count_seen() {
    // Pictures are made one after another.
    if (rasterizer_->native_image(kInset) == nullptr)
        if (auto made = rasterizer_->resize(16, 9, kInset); !made) return made;
    const VkExtent2D size = drawn_size();
    if (auto sized = rasterizer_->resize(size.width, size.height, kOwners); !sized) return sized;
    list_->select(frame_.visible_ids, culling_camera_);
    auto counted = owner_picture_.draw(*rasterizer_, kOwners, *list_, culling_camera_);
    if (!counted) return counted.error().code == ErrorCode::unsupported ? Result<void>{} : counted;
    frame_.seen = pipeline::Seen{owner_picture_.instances().size(), owner_picture_.triangles().size()};
    seen_frame_ = frame_;
    return {};
}

Result<void> Session::save_screenshots() {
    if (screenshots_.empty()) return {};
    if (auto read = rasterizer_->read_pixels(image_); !read) return read;
    for (const std::string& file : screenshots_) {
        if (auto written = assets::write_file(file, pipeline::encode_png(image_)); !written) {
            if (unattended()) return lasting(std::move(written));
            report(written.error());
            continue;
        }
        Json tints = Json::array();
        for (const InstanceColoring::Count& tint : instance_coloring_.counts())
            tints.push_back({{"name", tint.name}, {"instances", tint.instances}});
        Json views = Json::array();
        for (const Cascade& cascade : cascades_) views.push_back(cascade.visible);
        pictures_.push_back({{"file", file},
                             {"frame", frame_index_},
                             {"width", image_.width},
                             {"height", image_.height},
                             {"scene", loaded_->source().name},
                             {"settings", to_json(settings_)},
                             {"statistics", pipeline::to_json(frame_, false)},
                             {"scene_frame", static_cast<std::uint32_t>(scene_time_)},
                             {"eye", pipeline::to_json(controller_.camera)},
                             {"speed", controller_.speed},
                             {"orbit", controller_.mode == CameraMode::orbit},
                             {"tints", std::move(tints)},
                             {"views", std::move(views)},
                             {"contacts", overlay_.contact_count()},
                             {"separations", overlay_.separation_count()},
                             {"hulls", overlay_.hull_count()},
                             {"manifold_points", overlay_.manifold_point_count()},
                             {"lines", lines_.vertices().size() / 2}});
        if (settings_.coloring == Coloring::clusters) {
            Json fates = Json::array();
            for (const ClusterColoring::Count& fate : cluster_coloring_.counts())
                fates.push_back({{"name", fate.name}, {"clusters", fate.clusters}, {"triangles", fate.triangles}});
            pictures_.back()["clusters"] = std::move(fates);
        }
        if (other_) pictures_.back()["other"] = pipeline::to_json(other_frame_, false);
        if (loaded_->occlusion()) pictures_.back()["occlusion"] = to_json(loaded_->occlusion()->counts());
        if (other_ && other_->occlusion()) pictures_.back()["other_occlusion"] = to_json(other_->occlusion()->counts());
        if (sight_) pictures_.back()["visible_set"] = to_json(*sight_);
        if (selected_ != scene::kNone) pictures_.back()["selected"] = selected_;
        if (!hiders_.empty()) pictures_.back()["hidden_by"] = hiders_;
        pictures_.back()["messages"] = Json::array();
        for (const Notice& notice : notices_) pictures_.back()["messages"].push_back(notice.text);
    }
    screenshots_.clear();
    return {};
}

void Session::report(const Error& error) {
    print_to(stderr, "crofton: %s\n", printable(error.message).c_str());
    notices_.push_back({error.message, true, seconds_ + kErrorSeconds});
}

void Session::note(const std::string& text, double seconds) {
    notices_.push_back({text, false, seconds_ + seconds});
}

}  // namespace crofton::viewer
