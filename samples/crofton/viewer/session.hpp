// SPDX-License-Identifier: MIT
// The viewer's state and one frame of it: events, motion, culling, drawing, user interface, picture.
#pragma once
#include <chrono>
#include <crofton/cull/cull.hpp>
#include <deque>
#include <memory>

#include "camera_controller.hpp"
#include "cluster_coloring.hpp"
#include "depth_picture.hpp"
#include "frame_history.hpp"
#include "instance_coloring.hpp"
#include "json/json.hpp"
#include "overlay.hpp"
#include "panels.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/owner_picture.hpp"
#include "script.hpp"
#include "ui_renderer.hpp"
#include "viewer.hpp"
#include "window.hpp"

namespace crofton::viewer {

class Session {
  public:
    explicit Session(const ViewerOptions& options) : options_(options), settings_(options.settings) {}
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    [[nodiscard]] Result<void> start();
    [[nodiscard]] bool running() const;
    [[nodiscard]] Result<void> run_frame();
    // The last screenshot and the statistics.
    [[nodiscard]] Result<void> finish();
    // After an error: the path that is being recorded, and the statistics so far.
    void save_what_there_is();

  private:
    using Clock = std::chrono::steady_clock;

    // Loading (loading.cpp)
    [[nodiscard]] Result<void> start_window();
    [[nodiscard]] Result<void> start_device();
    [[nodiscard]] Result<void> start_interface();
    [[nodiscard]] Result<void> start_ui_renderer();
    [[nodiscard]] Result<void> recover();
    [[nodiscard]] Result<void> load(const SceneRequest& request);
    void stand_inside();
    void list_geometry();
    [[nodiscard]] Result<void> follow_regions();
    void leave_out_what_regions_lack();
    [[nodiscard]] Result<void> upload_geometry();
    [[nodiscard]] Result<void> cut_clusters();
    [[nodiscard]] Result<void> follow_settings();
    [[nodiscard]] Result<void> load_replay();

    // Input (input.cpp)
    void handle_events();
    void handle(const Event& event);
    bool handle_key(const std::string& key);
    bool cycle_setting(const std::string& key);
    bool handle_bookmark(const std::string& key);
    bool handle_command(const std::string& key);
    [[nodiscard]] bool on_panel(const glm::dvec2& at) const;
    void run_script();
    void perform(const Action& action);
    void click(const glm::dvec2& pixel);
    void toggle_recording();
    void toggle_replay();
    void export_files();
    void grant(const PanelWish& wish);

    // One frame (session.cpp)
    [[nodiscard]] bool unattended() const { return options_.frames > 0 || !options_.script.empty(); }
    [[nodiscard]] Result<void> try_turn();
    [[nodiscard]] Result<void> lasting(Result<void> failed);
    [[nodiscard]] Result<void> resize();
    [[nodiscard]] Result<void> follow_scale();
    void advance(double seconds);
    [[nodiscard]] Result<void> cull();
    void find_contacts();
    void list_drawn();
    [[nodiscard]] Result<void> color_clusters();
    [[nodiscard]] VkExtent2D drawn_size() const;
    [[nodiscard]] Result<void> draw_other();
    [[nodiscard]] Result<void> start_drawing();
    [[nodiscard]] Result<void> finish_drawing();
    [[nodiscard]] Result<void> count_seen();
    [[nodiscard]] Result<void> submit_view(const Camera& camera, std::uint32_t picture, bool show_frustum);
    [[nodiscard]] Result<void> submit(const Camera& camera, std::uint32_t picture);
    [[nodiscard]] Result<ImTextureID> show_depth();
    [[nodiscard]] Result<void> build_interface();
    [[nodiscard]] Result<void> draw_interface();
    [[nodiscard]] Result<void> save_screenshots();
    // To stderr and into the window.
    void report(const Error& error);
    // Into the window.
    void note(const std::string& text, double seconds = 4.0);

    ViewerOptions options_;
    Settings settings_;
    SceneRequest request_;  // the scene on show
    std::unique_ptr<Window> window_;
    std::unique_ptr<render::Device> device_;
    std::unique_ptr<render::Rasterizer> rasterizer_;
    std::unique_ptr<UiRenderer> ui_;
    render::Commands ui_commands_;
    bool imgui_ = false, imgui_window_ = false;

    std::unique_ptr<LoadedScene> loaded_, other_;
    std::unique_ptr<pipeline::DrawList> list_;
    bool shape_uploaded_ = false;
    NodeTree nodes_;
    CameraController controller_;
    Camera culling_camera_;
    pipeline::FrameStatistics frame_, other_frame_;
    std::optional<pipeline::FrameStatistics> seen_frame_;  // the last that says what is seen
    pipeline::OwnerPicture owner_picture_;
    std::vector<scene::InstanceId> drawn_ids_;  // in this frame: what is visible, and what is hidden where it is shown
    std::vector<scene::NodeId> hiders_;         // that hide the selected instance
    DepthPicture depth_picture_;
    FoundContacts contacts_;          // of the scene as it stands
    std::optional<CellSight> sight_;  // of the camera that culls
    std::vector<Cascade> cascades_;
    ViewResult cascade_visible_;
    InstanceColoring instance_coloring_;
    std::shared_ptr<const pipeline::SceneClusters> clusters_;  // of the scene, once their colours have been asked for
    ClusterColoring cluster_coloring_;
    VkExtent2D culling_size_{};  // of the picture that the camera that culls takes
    Overlay overlay_;
    LineList lines_;
    FrameHistory frame_history_;
    std::optional<Pick> pick_;
    scene::InstanceId selected_ = scene::kNone;

    std::deque<Action> script_;
    pipeline::CameraPath path_, recording_;  // to be replayed, being recorded
    std::size_t replayed_ = 0;
    bool replaying_ = false, is_recording_ = false, quit_ = false, step_ = false, stale_size_ = true;
    bool lose_device_ = false, is_lasting_ = false, advanced_ = false;
    std::uint64_t listed_meshes_ = 0;  // the revision of the regions' meshes that list_ has
    bool stale_geometry_ = false;      // what is on the device is of another scene, or nothing
    int recoveries_ = 0;
    std::vector<std::string> lost_messages_;  // validation's, of devices that are gone
    std::uint32_t frame_index_ = 0;
    double scene_time_ = 0.0;  // in frames of 1/60 s
    double seconds_ = 0.0;     // that the session has run
    std::deque<Notice> notices_;
    VkExtent2D wanted_size_{};
    double drawn_resolution_ = 1.0;
    float wanted_scale_ = 1.0f, scale_ = 0.0f;  // of texts and panels: the display's, and what they have
    Clock::time_point last_turn_ = Clock::now(), draw_start_;
    double ui_us_ = 0.0;
    PanelWish wish_;
    glm::uvec2 laid_out_{0};  // the picture's size that the panels lie in
    std::optional<bool> folded_;
    glm::dvec2 cursor_{0.0};
    std::vector<std::string> screenshots_;  // to be taken this frame
    Json pictures_ = Json::array();
    render::Image image_;
};

}  // namespace crofton::viewer
