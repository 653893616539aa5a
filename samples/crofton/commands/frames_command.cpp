// SPDX-License-Identifier: MIT
// `crofton frames`: the main job. A scene, a camera path; each frame culled, collided, drawn and counted.
#include <algorithm>
#include <chrono>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/render/device.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "assets/flat_scene.hpp"
#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "frames_output.hpp"
#include "html_report.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "pipeline/baked_parts.hpp"
#include "pipeline/camera_path.hpp"
#include "pipeline/draw_list.hpp"
#include "pipeline/frame_statistics.hpp"
#include "pipeline/owner_picture.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/region_pipeline.hpp"
#include "pipeline/street.hpp"
#include "pipeline/verify.hpp"
#include "progress_bar.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "stopwatch.hpp"
#include "trace_file.hpp"

namespace crofton::cli {
namespace {

using Clock = std::chrono::steady_clock;
using pipeline::FrameStatistics;

class FramesDrawing {
  public:
    // The list must outlive it. `haze`: RenderEnvironment's distance. `occlusion`: frames are drawn both ways. Errors:
    // unavailable where there is no Vulkan driver; Vulkan's.
    [[nodiscard]] static Result<std::unique_ptr<FramesDrawing>> create(pipeline::DrawList& list, const ImageSize& size,
                                                                       double haze, bool occlusion);

    // To be called when the list has other meshes.
    [[nodiscard]] Result<void> upload_geometry();

    // Fills gpu, triangles_clipped and draw_us of the frame, and of its occlusion where it has one.
    [[nodiscard]] Result<void> draw(pipeline::FrameStatistics& frame);
    // The picture of the last frame, without what is hidden.
    [[nodiscard]] Result<const render::Image*> picture();

    // Fills `seen` of the last frame, by the colours of a picture, if the device supports it. Takes as long as draw()
    // and is not part of its time.
    [[nodiscard]] Result<void> find_seen(pipeline::FrameStatistics& frame);
    // Returns the owners of pixels of the last frame, and how many pixels differ between the two pictures. Requires
    // occlusion, and a call of find_seen() before.
    [[nodiscard]] Result<pipeline::BothOwners> find_owners(const pipeline::FrameStatistics& frame);
    [[nodiscard]] Result<std::uint64_t> count_changed_pixels();

    [[nodiscard]] const render::Device& device() const { return device_; }

  private:
    FramesDrawing(pipeline::DrawList& list, render::Device device, double haze)
        : list_(list), device_(std::move(device)), haze_(haze) {}
    // Draws what is visible in `columns`, the frame's or its `occlusion`'s, and writes the cost there.
    template <class Columns>
    [[nodiscard]] Result<void> draw(Columns& columns, const Camera& camera, std::uint32_t picture);

    pipeline::DrawList& list_;
    render::Device device_;
    std::optional<render::Rasterizer> rasterizer_;
    double haze_;
    render::Image image_, other_image_;
    pipeline::OwnerPicture owners_of_shown_, owners_of_all_;
};

// The rasterizer's pictures: what is shown, the owners of pixels, and with occlusion all that is visible.
constexpr std::uint32_t kShown = 0, kOwners = 1, kAll = 2;

Result<std::unique_ptr<FramesDrawing>> FramesDrawing::create(pipeline::DrawList& list, const ImageSize& size,
                                                             double haze, bool occlusion) {
    auto device = render::Device::create();
    if (!device) return device.error();
    std::unique_ptr<FramesDrawing> drawing(new FramesDrawing(list, std::move(*device), haze));
    auto rasterizer = render::Rasterizer::create(drawing->device_, {.width = size.width, .height = size.height});
    if (!rasterizer) return rasterizer.error();
    for (const std::uint32_t picture : {kOwners, kAll}) {
        if (picture == kAll && !occlusion) continue;
        if (auto made = rasterizer->resize(size.width, size.height, picture); !made) return made.error();
    }
    drawing->rasterizer_.emplace(std::move(*rasterizer));
    if (auto set = drawing->upload_geometry(); !set) return set.error();
    return drawing;
}

Result<void> FramesDrawing::upload_geometry() {
    return rasterizer_->set_geometry(list_.vertices(), list_.indices());
}

template <class Columns>
Result<void> FramesDrawing::draw(Columns& columns, const Camera& camera, std::uint32_t picture) {
    const auto start = Clock::now();
    if constexpr (std::is_same_v<Columns, pipeline::OccludedFrame>)
        list_.select(columns, camera);
    else
        list_.select(columns.visible_ids, camera);
    render::Frame frame;
    frame.camera = camera;
    frame.transforms = list_.transforms();
    frame.ranges = list_.ranges();
    frame.environment.haze_distance = static_cast<float>(haze_);
    const auto counters = rasterizer_->draw(frame, picture);
    if (!counters) return counters.error();
    columns.gpu = *counters;
    columns.draw_us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    columns.triangles_clipped = list_.predict_clipped();
    return {};
}

// With occlusion either picture comes first in turn: the second finds warm caches.
Result<void> FramesDrawing::draw(pipeline::FrameStatistics& frame) {
    if (!frame.occlusion) return draw(frame, frame.camera, kShown);
    const bool all_first = frame.index % 2 == 0;
    for (const bool all : {all_first, !all_first}) {
        auto drawn = all ? draw(frame, frame.camera, kAll) : draw(*frame.occlusion, frame.camera, kShown);
        if (!drawn) return drawn;
    }
    return {};
}

Result<const render::Image*> FramesDrawing::picture() {
    if (auto read = rasterizer_->read_pixels(image_, kShown); !read) return read.error();
    return &image_;
}

Result<void> FramesDrawing::find_seen(pipeline::FrameStatistics& frame) {
    if (frame.occlusion)
        list_.select(*frame.occlusion, frame.camera);
    else
        list_.select(frame.visible_ids, frame.camera);
    if (auto drawn = owners_of_shown_.draw(*rasterizer_, kOwners, list_, frame.camera); !drawn)
        return drawn.error().code == ErrorCode::unsupported ? Result<void>{} : drawn;
    frame.seen = pipeline::Seen{owners_of_shown_.instances().size(), owners_of_shown_.triangles().size()};
    return {};
}

Result<pipeline::BothOwners> FramesDrawing::find_owners(const pipeline::FrameStatistics& frame) {
    list_.select(frame.visible_ids, frame.camera);
    if (auto drawn = owners_of_all_.draw(*rasterizer_, kOwners, list_, frame.camera); !drawn) return drawn.error();
    return pipeline::BothOwners{owners_of_all_.triangles(), owners_of_shown_.triangles()};
}

Result<std::uint64_t> FramesDrawing::count_changed_pixels() {
    if (auto read = rasterizer_->read_pixels(image_, kShown); !read) return read.error();
    if (auto read = rasterizer_->read_pixels(other_image_, kAll); !read) return read.error();
    std::uint64_t changed = 0;
    for (std::size_t p = 0; p < image_.rgba.size(); p += 4)
        changed += std::memcmp(&image_.rgba[p], &other_image_.rgba[p], 4) != 0;
    return changed;
}

struct FramesOptions {
    std::string scene = "town", map, camera, size = "1280x720", bounds = "obb-perimeter", cull = "tree",
                tree = "aligned";
    std::optional<std::uint32_t> frames;  // absent: pipeline::kBuiltInFrames, or all of a recorded path
    std::uint32_t instances = 0;
    std::uint64_t seed = 1;
    unsigned threads = 1;
    bool no_draw = false, no_seen = false, verify = false;
    bool occlude = false;
    double region_distance = 0.0;  // 0: by the regions' size
    bool real_time = false;
    std::string occlusion, occlusion_size;  // empty: not said
    std::optional<std::uint32_t> occluders;
    std::uint32_t shadow = 0;  // texels each way; 0: not wanted
    std::string baked;         // a file with the scene's occluders; empty: they are found
    FramesOutput output;
    std::string report;  // a file of HTML; empty: not wanted
    std::string trace;   // a file of zones and counters; empty: not wanted
    ReadOptions read;
};

// As many pictures as a reader looks at.
constexpr std::uint32_t kReportPictures = 6;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

class FramesRun {
  public:
    explicit FramesRun(FramesOptions options) : options_(std::move(options)) {
        if (options_.camera.empty()) options_.camera = pipeline::holds_regions(options_.scene) ? "flight" : "orbit";
        if (!options_.trace.empty()) trace_ = std::make_unique<TraceFile>();
    }

    Result<int> run() {
        if (auto prepared = prepare(); !prepared) return prepared.error();
        catch_interrupts();  // before, there is nothing to keep
        std::optional<pipeline::Verification> verification;
        if (options_.verify) verification.emplace();
        std::vector<FrameStatistics> frames;
        const SceneFacts facts = scene_facts();
        {
            FramesStream stream(options_.output, facts, path_.cameras.size());
            const auto count = static_cast<std::uint32_t>(path_.cameras.size());
            ProgressBar bar("frames", count);
            for (std::uint32_t index = 0; index < count && !interrupted(); ++index) {
                auto frame = regions_ ? run_frame_of_regions(index) : run_frame(index);
                if (!frame)
                    return fail(frame.error().code, frame.error().item,
                                "frame " + std::to_string(index) + ": " + frame.error().message);
                if (auto saved = save_picture(index); !saved) return saved.error();
                if (verification)
                    if (auto done = verify(*frame, *verification); !done) return done.error();
                if (!options_.output.ids) forget_ids(*frame);
                stream.add(*frame);
                frames.push_back(std::move(*frame));
                bar.set(index + 1);
            }
        }
        finish_what_there_is();
        if (frames.empty()) return fail(ErrorCode::cancelled, kNoItem, "interrupted before the first frame");
        if (auto written = write_results(options_.output, facts, frames, verification); !written)
            return written.error();
        if (regions_ && options_.output.json != "-" && options_.output.csv != "-")
            print_to(stdout, "the first frame was found %.0f ms after the start\n", first_frame_ms_);
        if (auto written = write_report(facts, frames, verification); !written) return written.error();
        if (trace_)
            if (auto written = trace_->write(options_.trace); !written) return written.error();
        if (verification)
            for (const std::string& message : verification->messages)
                print_to(stderr, "crofton: mismatch: %s\n", printable(message).c_str());
        if (frames.size() < path_.cameras.size()) {
            print_to(stderr, "crofton: interrupted after %zu of %zu frames, which are written\n", frames.size(),
                     path_.cameras.size());
            return kInterrupted;
        }
        return verification && verification->mismatches() > 0 ? kCheckFailed : kSuccess;
    }

  private:
    Result<void> prepare() {
        const auto size = image_size_from(options_.size);
        if (!size) return size.error();
        const auto bounds = pipeline::bounds_kind_from(options_.bounds);
        if (!bounds) return bounds.error();
        const auto mode = pipeline::cull_mode_from(options_.cull);
        if (!mode) return mode.error();
        const auto tree = pipeline::orientation_from(options_.tree);
        if (!tree) return tree.error();
        const double aspect = static_cast<double>(size->width) / size->height;
        if (options_.frames == 0u) return fail(ErrorCode::invalid_argument, kNoItem, "--frames must be at least 1");
        if (!options_.output.png.empty())
            if (auto made = make_picture_folder(options_.output.png); !made) return made;
        if (options_.threads != 1) pool_.emplace(options_.threads);
        if (pipeline::holds_regions(options_.scene)) return prepare_regions(*size, aspect);
        if (options_.real_time || options_.region_distance > 0.0)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "--real-time and --region-distance are for a folder of regions, by 'crofton bake --regions'");

        // obb-frustum fits the boxes to the frustum in use: 60° with this aspect, and a depth of the order of a street.
        Camera typical;
        typical.aspect = aspect;
        typical.far_distance = 200.0;
        const auto criterion = pipeline::criterion_for(*bounds, typical);
        if (!criterion) return criterion.error();
        auto source = load_updated_scene(
            options_.scene, options_.read,
            {.criterion = *criterion, .map = options_.map, .seed = options_.seed, .instances = options_.instances},
            executor());
        if (!source) return source.error();
        source_.emplace(std::move(*source));
        focus_ = pipeline::focus_of(source_->scene);
        pipeline::Street street;
        if (options_.camera == "street") street = pipeline::street_of(*source_, focus_);
        if (auto path = make_path(street, aspect); !path) return path;
        pipeline_options_ = {*bounds, *mode, true};
        pipeline_options_.one_sided = source_->one_sided;
        pipeline_options_.clusters = pipeline::take_clusters(*source_);
        if (auto set = set_occlusion(*size); !set) return set;
        pipeline_options_.tree = *tree;
        if (trace_) pipeline_options_.trace = trace_->hooks();
        const auto occluders = baked_occluders();
        if (!occluders) return occluders.error();
        auto frames =
            pipeline::Pipeline::create(source_->scene, source_->movers, pipeline_options_, executor(), *occluders);
        if (!frames) return frames.error();
        pipeline_.emplace(std::move(*frames));
        return prepare_drawing(*size);
    }

    // The camera's path; a street is walked, if that is what is asked for.
    Result<void> make_path(const pipeline::Street& street, double aspect) {
        if (!street.remark.empty()) print_to(stderr, "crofton: %s\n", printable(street.remark).c_str());
        pipeline::PathOptions options{options_.camera, options_.frames.value_or(0), options_.seed, aspect,
                                      options_.read.limits};
        street.set(options);
        auto path = pipeline::make_camera_path(options, focus_, street.walk);
        if (!path) return path.error();
        path_ = std::move(*path);
        return {};
    }

    // The flight begins when the regions near its first place are loaded.
    Result<void> prepare_regions(const ImageSize& size, double aspect) {
        if (options_.read.unit > 0.0)
            return fail(ErrorCode::unsupported, kNoItem, "--unit is not for a folder of regions");
        const FramesOptions fixed;
        if (options_.verify && options_.real_time)
            return fail(ErrorCode::unsupported, kNoItem,
                        "--verify needs frames that wait for what they see: leave out --real-time");
        if (options_.bounds != fixed.bounds || options_.cull != fixed.cull || options_.tree != fixed.tree ||
            !options_.baked.empty() || !options_.map.empty() || options_.instances != 0)
            return fail(ErrorCode::unsupported, kNoItem,
                        "--bounds, --cull, --tree, --baked, --map and --instances are not for a folder of "
                        "regions, which holds its trees, bounds and occluders");
        if (auto set = set_occlusion(size); !set) return set;
        pipeline::RegionPipelineOptions how;
        how.stream = {.distance = options_.region_distance,
                      .meshes = options_.occlude && !by_sets(),
                      .waits = !options_.real_time,
                      .places_occluders = pipeline_options_.occlusion.has_value(),
                      .loaders = pool_ ? pool_->concurrency() : 1,
                      .largest_file = options_.read.limits.bytes,
                      .sets = by_sets()};
        how.by_sets = by_sets();
        how.occlusion = pipeline_options_.occlusion;
        how.picture = pipeline_options_.picture;
        auto opened = pipeline::RegionPipeline::open(options_.scene, how);
        if (!opened) return opened.error();
        regions_.emplace(std::move(*opened));
        focus_ = regions_->stream().bounds();
        pipeline::Street street;
        if (options_.camera == "street") {
            auto found = pipeline::street_of_regions(options_.scene, regions_->stream().index(), options_.read.limits);
            if (!found) return found.error();
            street = std::move(*found);
        }
        if (auto path = make_path(street, aspect); !path) return path;
        make_list();
        return start_drawing(size, 0.0);
    }

    [[nodiscard]] SceneFacts scene_facts() const {
        if (regions_) {
            const std::uint64_t count = regions_->stream().object_count();
            return {std::filesystem::path(options_.scene).lexically_normal().string(), count, count};
        }
        return {source_->name, source_->scene.node_count(), source_->scene.instance_count(),
                assets::instanced_triangles(source_->scene)};
    }

    // Regions may have brought new meshes.
    void make_list() {
        if (list_ && listed_ == regions_->mesh_revision()) return;
        listed_ = regions_->mesh_revision();
        list_.emplace(regions_->drawables(),
                      pipeline::DrawList::Looks{regions_->unlit(), regions_->one_sided(), regions_->flat()},
                      regions_->clusters());
    }

    Result<FrameStatistics> run_frame_of_regions(std::uint32_t index) {
        const FileZone zone(trace_.get(), "frame");
        const auto start = Clock::now();
        auto frame = regions_->run(path_.cameras[index], executor());
        if (!frame) return frame;
        frame->index = index;
        if (index == 0) first_frame_ms_ = since_start_.milliseconds();
        const bool is_new = listed_ != regions_->mesh_revision();
        make_list();
        if (drawing_ && is_new)
            if (auto set = drawing_->upload_geometry(); !set) return set.error();
        if (auto drawn = draw_or_predict(*frame); !drawn) return drawn.error();
        if (options_.real_time) std::this_thread::sleep_until(start + std::chrono::microseconds(16'667));
        return frame;
    }

    // Options of occluders imply them.
    [[nodiscard]] bool by_occluders() const {
        if (!options_.occlusion.empty()) return options_.occlusion == "occluders";
        return options_.occluders || !options_.occlusion_size.empty() || !options_.baked.empty();
    }

    [[nodiscard]] bool by_sets() const { return options_.occlude && options_.occlusion == "sets"; }

    Result<void> set_occlusion(const ImageSize& size) {
        if (!options_.occlude) return {};
        if (!options_.occlusion.empty() && options_.occlusion != "depth" && options_.occlusion != "occluders" &&
            options_.occlusion != "sets")
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "--occlusion: '" + options_.occlusion + "' is not one of depth, occluders, sets");
        if (by_sets() && !pipeline::holds_regions(options_.scene))
            return fail(ErrorCode::unsupported, kNoItem, "--occlusion sets needs a folder of regions");
        if (options_.shadow != 0 && (by_occluders() || pipeline::holds_regions(options_.scene)))
            return fail(ErrorCode::unsupported, kNoItem,
                        "--shadow needs --occlusion depth, and a scene that is no folder of regions");
        pipeline_options_.shadow_map = options_.shadow;
        if (by_occluders()) {
            const auto buffer = image_size_from(options_.occlusion_size.empty() ? "400x225" : options_.occlusion_size,
                                                "--occlusion-size", 8, 4096);
            if (!buffer) return buffer.error();
            pipeline_options_.occlusion = OcclusionOptions{.size = {buffer->width, buffer->height},
                                                           .max_occluders = options_.occluders.value_or(128)};
            return {};
        }
        if (options_.occluders || !options_.occlusion_size.empty() || !options_.baked.empty())
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "--occluders, --occlusion-size and --baked need --occlusion occluders");
        if (!by_sets()) pipeline_options_.picture = {size.width, size.height};
        return {};
    }

    Result<std::shared_ptr<const pipeline::SceneOccluders>> baked_occluders() {
        std::shared_ptr<const pipeline::SceneOccluders> none;
        const bool is_own = options_.baked.empty() && assets::extension(options_.scene) == "crofton";
        if (!pipeline_options_.occlusion || (options_.baked.empty() && !is_own)) return none;
        const auto parts =
            pipeline::load_baked_parts(is_own ? options_.scene : options_.baked, source_->scene, options_.read.limits);
        if (is_own && (!parts || !parts->occluders)) return none;  // baked without: they are found
        if (!parts) return parts.error();
        if (!parts->occluders && !parts->left_out.empty()) return parts->left_out.front();
        if (!parts->occluders)
            return fail(ErrorCode::empty, kNoItem, options_.baked + ": has no occluders: 'crofton bake' writes them");
        return parts->occluders;
    }

    Result<void> prepare_drawing(const ImageSize& size) {
        list_.emplace(source_->scene, pipeline::DrawList::Looks{source_->unlit, source_->one_sided, source_->flat},
                      pipeline_->clusters());
        // Half of the light is haze at three times the size of the place; none where the light is baked in.
        return start_drawing(size, source_->unlit.empty() ? 3.0 * glm::length(focus_.half_extents()) : 0.0);
    }

    Result<void> start_drawing(const ImageSize& size, double haze) {
        if (options_.no_draw) return {};
        auto drawing = FramesDrawing::create(*list_, size, haze, options_.occlude);
        if (drawing) {
            drawing_ = std::move(*drawing);
            return {};
        }
        if (!options_.output.png.empty() || drawing.error().code != ErrorCode::unavailable) return drawing.error();
        print_to(stderr, "crofton: not drawing: %s\n", printable(drawing.error().message).c_str());
        return {};
    }

    Result<FrameStatistics> run_frame(std::uint32_t index) {
        const auto start = Clock::now();
        const FileZone zone(trace_.get(), "frame");
        {
            const FileZone part(trace_.get(), "scene");
            source_->animate(path_.scene_frames[index]);
            source_->scene.update(executor());
        }
        const double scene_us = microseconds_since(start);
        auto frame = pipeline_->run(path_.cameras[index]);
        if (!frame) return frame;
        frame->index = index;
        frame->update_us += scene_us;
        if (auto drawn = draw_or_predict(*frame); !drawn) return drawn.error();
        return frame;
    }

    Result<void> draw_or_predict(FrameStatistics& frame) {
        const FileZone part(trace_.get(), "draw and count triangles");
        if (!drawing_) {
            predict(frame);
            return {};
        }
        if (auto drawn = drawing_->draw(frame); !drawn) return drawn;
        return !options_.no_seen || options_.verify ? drawing_->find_seen(frame) : Result<void>{};
    }

    void predict(FrameStatistics& frame) {
        list_->select(frame.visible_ids, frame.camera);
        frame.triangles_clipped = list_->predict_clipped();
        if (!frame.occlusion) return;
        list_->select(*frame.occlusion, frame.camera);
        frame.occlusion->triangles_clipped = list_->predict_clipped();
    }

    Result<void> verify(const FrameStatistics& frame, pipeline::Verification& verification) {
        const bool exactly = drawing_ && drawing_->device().counts_exactly();
        if (regions_)
            pipeline::verify_frame(*regions_, frame, exactly, verification);
        else
            pipeline::verify_frame(source_->scene, *pipeline_, pipeline_options_, frame, exactly, verification);
        if (!frame.occlusion || !drawing_) return {};
        const auto owners = drawing_->find_owners(frame);
        if (!owners) return owners.error();
        const auto changed = drawing_->count_changed_pixels();
        if (!changed) return changed.error();
        if (regions_)
            pipeline::verify_occlusion(*regions_->drawables(), *owners, *changed, exactly, frame, verification);
        else
            pipeline::verify_occlusion(pipeline::SceneDrawables(source_->scene), *owners, *changed, exactly, frame,
                                       verification);
        return {};
    }

    static void forget_ids(FrameStatistics& frame) {
        frame.visible_ids.clear();
        frame.colliding_ids.clear();
        if (frame.occlusion) frame.occlusion->visible_ids.clear(), frame.occlusion->clusters.clear();
    }

    Result<void> save_picture(std::uint32_t index) {
        const auto count = static_cast<std::uint32_t>(path_.cameras.size());
        const std::uint32_t step = std::max<std::uint32_t>(1, count / kReportPictures);
        const bool report = !options_.report.empty() && index % step == 0 && report_pictures_.size() < kReportPictures;
        if (!drawing_ || (options_.output.png.empty() && !report)) return {};
        const auto picture = drawing_->picture();
        if (!picture) return picture.error();
        if (report) report_pictures_.push_back({index, **picture});
        if (index == 0 && !options_.output.png.empty())
            if (auto removed = remove_old_pictures(options_.output.png); !removed) return removed;
        return options_.output.png.empty() ? Result<void>{} : write_picture(options_.output.png, index, **picture);
    }

    Result<void> write_report(const SceneFacts& facts, std::span<const FrameStatistics> frames,
                              const std::optional<pipeline::Verification>& verification) {
        if (options_.report.empty()) return {};
        ReportContents contents{facts, {}, frames, verification, std::move(report_pictures_)};
        contents.settings = {{"scene", options_.scene},
                             {"map", options_.map},
                             {"camera", options_.camera},
                             {"frames", std::to_string(frames.size())},
                             {"seed", std::to_string(options_.seed)},
                             {"size", options_.size},
                             {"bounds", options_.bounds},
                             {"cull", options_.cull},
                             {"tree", options_.tree},
                             {"occlusion", occlusion_setting()},
                             {"device", drawing_ ? drawing_->device().name() : "none: not drawn"}};
        return write_file(options_.report, html_report(contents));
    }

    [[nodiscard]] std::string occlusion_setting() const {
        if (pipeline_options_.picture) return "by the depth of drawn triangles";
        if (by_sets()) return "by the regions' visible sets";
        if (!pipeline_options_.occlusion) return "";
        const OcclusionOptions& o = *pipeline_options_.occlusion;
        return std::to_string(o.max_occluders) + " occluders at most, " + std::to_string(o.size.width) + "x" +
               std::to_string(o.size.height) + " pixels";
    }

    Executor& executor() { return pool_ ? static_cast<Executor&>(*pool_) : serial_executor(); }

    FramesOptions options_;
    pipeline::PipelineOptions pipeline_options_;
    std::unique_ptr<TraceFile> trace_;  // before the pipeline, which tells it
    std::optional<ThreadPool> pool_;
    std::optional<assets::SceneSource> source_;
    Aabb focus_;
    pipeline::CameraPath path_;
    std::optional<pipeline::Pipeline> pipeline_;
    std::optional<pipeline::RegionPipeline> regions_;  // in place of source_ and pipeline_
    std::optional<pipeline::DrawList> list_;
    std::uint64_t listed_ = 0;  // the revision of the regions' meshes that it has
    Stopwatch since_start_;
    double first_frame_ms_ = 0.0;
    std::unique_ptr<FramesDrawing> drawing_;
    std::vector<ReportPicture> report_pictures_;
};

constexpr const char* kFramesExamples =
    "Columns of the table, one line per frame:\n"
    "  visible     instances whose bound meets the view\n"
    "  straddle    those whose bound meets the surface of the view\n"
    "  improper    of those, instances whose triangles lie entirely inside or outside\n"
    "  nodes       tested tree nodes\n"
    "  submitted   triangles of the visible instances\n"
    "  passed      those that meet the frustum\n"
    "  seen        those that own a pixel\n"
    "  ratio       passed / seen\n"
    "  clipped     triangles that clipping leaves\n"
    "  pairs       pairs of instances whose boxes overlap\n"
    "  ... us      microseconds to update, cull, collide (hits) and draw\n"
    "\n"
    "With --occlude the columns come in pairs, without and with occlusion culling: instances; triangles submitted;\n"
    "triangles passed, with seen and the ratio; milliseconds to find and draw, and the part that occlusion culling "
    "takes.\n"
    "Triangles are tested front to back against the depth of those before. --occlusion occluders hides whole "
    "instances\n"
    "by occluders that are found in the scene's meshes or baked. --verify then also compares the triangles that own "
    "each\n"
    "pixel: none of them may be hidden, and both pictures must be equal.\n"
    "\n"
    "Exit status: 0 done, 1 --verify found a mismatch, 2 bad usage or input, or nothing could be written,\n"
    "130 interrupted; results so far are written.\n"
    "\n"
    "Examples:\n"
    "  crofton frames                                     # the built-in town, 120 frames around it\n"
    "  crofton frames town --camera street --verify       # every frame checked by brute force\n"
    "  crofton frames town --camera street --occlude      # without and with occlusion culling, side by side\n"
    "  crofton frames town --camera street --occlude --shadow 2048   # and what a shadow map needs\n"
    "  crofton frames town --instances 100000 --no-draw   # a larger town, culled and collided only\n"
    "  crofton frames parts/ --camera street              # a city composed from a folder of parts\n"
    "  crofton frames level.wad --map MAP01 --png out     # a DOOM level, a picture per frame in out/\n"
    "  crofton frames city.glb --bounds aabb --csv -      # another bound, one line per frame to stdout\n"
    "  crofton frames regions/ --no-draw                  # a flight over regions by 'crofton bake --regions'\n"
    "  crofton frames town --report town.html             # one page with pictures and charts\n"
    "  crofton frames town --json run.json && crofton frames town --camera run.json   # the same path again\n";

}  // namespace

void add_frames_command(CommandLine& line) {
    auto options = std::make_shared<FramesOptions>();
    Command command =
        line.command("frames", "Run a camera path through a scene: cull, collide, draw and count each frame");
    command.footer(std::string(kFramesExamples) + "\n" + kSceneFormats);
    command
        .option(
            "scene", options->scene,
            "town, room, office, valley, hall, a folder of city parts or of regions, or a .glb, .gltf, .obj, .wad or "
            ".crofton file")
        .show_default();
    command.option("--frames", options->frames, "Number of frames; by default 120, or all of a recorded path");
    command.option(
        "--camera", options->camera,
        "orbit | street | flight | random, or a JSON file of cameras; orbit by default, flight over regions");
    command.option("--seed", options->seed, "Seed of built-in scenes and of random cameras").show_default();
    command.option("--instances", options->instances, "Number of instances of the town, up to 16000000; 0: about 3000")
        .show_default();
    command.option("--size", options->size, "Size of the picture, WIDTHxHEIGHT").show_default();
    command.option("--bounds", options->bounds, "sphere | aabb | obb-volume | obb-area | obb-perimeter | obb-frustum")
        .show_default();
    command.option("--cull", options->cull, "none | flat | tree").show_default();
    command
        .option("--region-distance", options->region_distance,
                "Attach regions of a folder within this distance of the camera, and see no farther. By default the "
                "size of an average region")
        .positive();
    command.flag("--real-time", options->real_time,
                 "Show 60 frames a second and wait for no region: a frame attaches at most one, when it is loaded");
    const Option occlude =
        command.flag("--occlude", options->occlude, "Also draw each frame without hidden objects, and compare both");
    command
        .option("--occlusion", options->occlusion,
                "depth | occluders | sets, what finds what is hidden: the depth of this picture's triangles drawn "
                "before; solid boxes found in the scene, for any picture; visible sets of regions ('crofton pvs' on "
                "the folder). Default: depth, or occluders if one of the next three options is given")
        .needs(occlude);
    command.option("--occluders", options->occluders, "Largest number of occluders to draw; 128 by default")
        .whole_between(0, 1000000)
        .needs(occlude);
    command
        .option("--baked", options->baked,
                "Use the occluders in this .crofton file, by 'crofton bake'; if the scene is such a file, its own are "
                "used by default")
        .needs(occlude);
    command
        .option("--occlusion-size", options->occlusion_size,
                "Size of the occluders' buffer, WIDTHxHEIGHT, 8 to 4096; 400x225 by default")
        .needs(occlude);
    command
        .option(
            "--shadow", options->shadow,
            "Also list what a sun's shadow map over the scene needs, SIZE x SIZE texels: the triangles whose shadows "
            "the camera may see")
        .whole_between(16, 16384)
        .needs(occlude);
    command.option("--tree", options->tree, "aligned | oriented | automatic: axes of the tree's inner bounds")
        .show_default();
    command.option("--map", options->map, "Level of a .wad file; the first by default");
    command.option("--threads", options->threads, "Worker threads; 0: one per core")
        .whole_between(0, 256)
        .show_default();
    command.flag("--no-seen", options->no_seen,
                 "Do not count the triangles that own a pixel, which takes another draw of each frame");
    const Option no_draw = command.flag("--no-draw", options->no_draw, "Do not draw; all counts are the CPU's");
    command.flag("--verify", options->verify, "Check every frame by brute force; exit 1 on any mismatch");
    const Option json = command.option("--json", options->output.json, "Write everything as JSON; - for stdout")
                            .writable_file_or_stdout();
    command.flag("--ids", options->output.ids, "List visible and colliding ids in the JSON").needs(json);
    command.option("--csv", options->output.csv, "Write a line per frame as CSV; - for stdout")
        .writable_file_or_stdout();
    command.option("--png", options->output.png, "Write a picture per frame into this folder").excludes(no_draw);
    command.option("--report", options->report, "Write one self-contained HTML page: pictures, charts, summary")
        .writable_file();
    command.option("--trace", options->trace, "Write timings for chrome://tracing or Perfetto").writable_file();
    add_unit_option(command, options->read);
    add_read_options(command, options->read);
    command.action([options] {
        const auto status = FramesRun(*options).run();
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
