// SPDX-License-Identifier: MIT
#include "pipeline.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/convex_query.hpp>
#include <crofton/cull/cull.hpp>
#include <utility>

#include "object_counts.hpp"

namespace crofton::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<std::pair<const char*, CullMode>, 3> kModes = {
    {{"none", CullMode::none}, {"flat", CullMode::flat}, {"tree", CullMode::tree}}};

// Items' worth of rebuilding a frame: some ten microseconds, and the tree keeps its quality however long the traffic
// flows.
constexpr std::size_t kMaintenancePerFrame = 100;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

}  // namespace

Result<CullMode> cull_mode_from(const std::string& name) {
    for (const auto& [known, mode] : kModes)
        if (name == known) return mode;
    return fail(ErrorCode::invalid_argument, kNoItem, "cull: '" + name + "' is not one of none, flat, tree");
}

const char* to_string(CullMode mode) {
    return kModes[static_cast<std::size_t>(mode)].first;
}

struct Pipeline::State {
    const scene::Scene& scene;
    std::vector<scene::InstanceId> movers;
    PipelineOptions options;
    Executor& executor;
    Bounds bounds;
    std::optional<boxtree::BoxTree> tree;
    collide::Broadphase broadphase;
    std::vector<Obb> mover_boxes, moved_boxes;
    cull::VisibleSet visible;
    std::vector<cull::Verdict> verdicts;
    std::vector<scene::InstanceId> visible_ids;
    ObjectCounter counter;

    State(const scene::Scene& the_scene, std::vector<scene::InstanceId> the_movers, const PipelineOptions& the_options,
          Executor& the_executor)
        : scene(the_scene),
          movers(std::move(the_movers)),
          options(the_options),
          executor(the_executor),
          bounds(the_scene, the_options.bounds),
          verdicts(the_scene.instance_count(), cull::Verdict::outside) {
        std::sort(movers.begin(), movers.end());
    }

    Result<void> build_tree() {
        auto built = boxtree::BoxTree::build(bounds.boxes(), scene.layer_masks(), {}, executor);
        if (!built) return tl::unexpected(built.error());
        tree.emplace(std::move(*built));
        return {};
    }

    Result<void> follow_motion() {
        bounds.update();
        const auto moved = scene.moved_instances();
        if (moved.empty()) return {};
        moved_boxes.clear();
        for (const scene::InstanceId i : moved) moved_boxes.push_back(bounds.boxes()[i]);
        if (auto done = tree->move(moved, moved_boxes); !done) return done;
        tree->refit();
        tree->rebuild_step(kMaintenancePerFrame);
        return {};
    }

    // Without culling every bound is all of space, and that straddles.
    void list_all() {
        visible_ids.clear();
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i)
            if (!scene.is_removed(i)) visible_ids.push_back(i);
        for (const scene::InstanceId i : visible_ids) verdicts[i] = cull::Verdict::straddling;
    }

    void list_visible(const Frustum& frustum) {
        const cull::View view{frustum};
        if (options.cull == CullMode::tree)
            cull::find_visible(*tree, view, visible, {.mode = options.mode, .order = cull::ResultOrder::ascending},
                               executor);
        else
            cull::find_visible(bounds.boxes(), scene.layer_masks(), view, visible,
                               {.mode = options.mode, .order = cull::ResultOrder::ascending}, executor);
        visible_ids.clear();
        for (std::size_t k = 0; k < visible.size(); ++k) {
            const scene::InstanceId instance = visible.ids()[k];
            // Spheres by planes alone: near the frustum's edges one outside may pass, which is one reason for boxes.
            const auto verdict = bounds.spheres().empty() ? visible.verdicts()[k]
                                                          : cull::classify(frustum, bounds.spheres()[instance],
                                                                           cull::CullMode::conservative);
            verdicts[instance] = verdict;
            if (verdict != cull::Verdict::outside) visible_ids.push_back(instance);
        }
    }

    // Pairs of movers by their oriented boxes, whatever bound the views are culled by.
    Result<void> find_pairs(FrameStatistics& frame) {
        mover_boxes.clear();
        for (const scene::InstanceId mover : movers) mover_boxes.push_back(scene.world_boxes()[mover]);
        if (auto updated = broadphase.update(mover_boxes, {}, executor); !updated) return updated;
        for (const IdPair& pair : broadphase.pairs())
            frame.colliding_ids.emplace_back(movers[pair.first], movers[pair.second]);
        frame.colliding_pairs = frame.colliding_ids.size();
        const collide::BatchStatistics& decided = broadphase.statistics().boxes;
        frame.pairs_tested = broadphase.statistics().bound_pairs;
        frame.separated_by_face_a = decided.separated_by_face_a;
        frame.separated_by_face_b = decided.separated_by_face_b;
        frame.separated_by_edges = decided.separated_by_edges;
        frame.pairs_refined = decided.refined;
        for (const IdPair& pair : broadphase.pairs()) {
            const auto manifold = collide::contact_manifold(mover_boxes[pair.first], mover_boxes[pair.second]);
            frame.contacts += static_cast<std::uint64_t>(manifold.count);
        }
        return {};
    }
};

Pipeline::Pipeline(std::unique_ptr<State> state) : state_(std::move(state)) {}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

Result<Pipeline> Pipeline::create(const scene::Scene& scene, std::vector<scene::InstanceId> movers,
                                  const PipelineOptions& options, Executor& executor) {
    for (const scene::InstanceId mover : movers)
        if (mover >= scene.instance_count())
            return fail(ErrorCode::out_of_range, mover, "pipeline: a mover is not an instance");
    auto state = std::make_unique<State>(scene, std::move(movers), options, executor);
    if (auto built = state->build_tree(); !built) return tl::unexpected(built.error());
    return Pipeline(std::move(state));
}

Result<FrameStatistics> Pipeline::run(const Camera& camera) {
    State& s = *state_;
    const auto frustum = frustum_of(camera);
    if (!frustum) return tl::unexpected(frustum.error());
    FrameStatistics frame;
    frame.camera = camera;
    const auto start = Clock::now();
    if (auto followed = s.follow_motion(); !followed) return tl::unexpected(followed.error());
    frame.update_us = microseconds_since(start);

    const auto cull_start = Clock::now();
    for (const scene::InstanceId i : s.visible_ids) s.verdicts[i] = cull::Verdict::outside;
    if (s.options.cull == CullMode::none)
        s.list_all();
    else
        s.list_visible(*frustum);
    frame.cull_us = microseconds_since(cull_start);

    const auto collide_start = Clock::now();
    if (s.options.collide)
        if (auto found = s.find_pairs(frame); !found) return tl::unexpected(found.error());
    frame.collide_us = microseconds_since(collide_start);

    for (scene::InstanceId i = 0; i < s.scene.instance_count(); ++i) frame.instances += !s.scene.is_removed(i);
    frame.visible = s.visible_ids.size();
    for (const scene::InstanceId i : s.visible_ids) frame.inside += s.verdicts[i] == cull::Verdict::inside;
    frame.straddling = frame.visible - frame.inside;
    frame.nodes_tested = s.options.cull == CullMode::none ? 0 : s.visible.statistics().nodes_tested;
    frame.visible_ids = s.visible_ids;
    if (s.options.count_triangles) {
        const ObjectCounts counts = s.counter.count(s.scene, *frustum, s.visible_ids, s.verdicts);
        frame.triangles_submitted = counts.triangles_submitted;
        frame.triangles_passed = counts.triangles_passed;
        frame.improper = counts.improper;
    }
    return frame;
}

std::span<const cull::Verdict> Pipeline::verdicts() const {
    return state_->verdicts;
}
const Bounds& Pipeline::bounds() const {
    return state_->bounds;
}
std::span<const scene::InstanceId> Pipeline::movers() const {
    return state_->movers;
}

const boxtree::BoxTree& Pipeline::tree() const {
    return *state_->tree;
}

std::vector<scene::InstanceId> Pipeline::spatial_order() const {
    std::vector<scene::InstanceId> order;
    for (const boxtree::ItemId item : state_->tree->spatial_order())
        if (!state_->scene.is_removed(item)) order.push_back(item);
    return order;
}

}  // namespace crofton::pipeline
