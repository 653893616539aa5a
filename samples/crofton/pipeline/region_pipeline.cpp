// SPDX-License-Identifier: MIT
#include "region_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "object_counts.hpp"

namespace crofton::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

// The meshes of regions, numbered as they come, and where the objects of attached regions stand.
class RegionDrawables final : public Drawables {
  public:
    RegionDrawables(const RegionStream& stream, std::vector<scene::InstanceId> firsts)
        : stream_(stream), firsts_(std::move(firsts)), regions_(stream.index().size()), ids_(stream.index().size()) {}

    [[nodiscard]] std::size_t mesh_count() const override { return meshes_.size(); }
    [[nodiscard]] const TriangleMesh& mesh(scene::MeshId mesh) const override { return meshes_[mesh]->mesh; }
    [[nodiscard]] scene::MeshId mesh_of(scene::InstanceId instance) const override {
        const std::uint32_t place = place_of(instance);
        return ids_[place][regions_[place]->mesh_of[instance - firsts_[place]]];
    }
    [[nodiscard]] Transform world_of(scene::InstanceId instance) const override {
        const std::uint32_t place = place_of(instance);
        Transform transform = regions_[place]->transforms[instance - firsts_[place]];
        transform.translation += stream_.index()[place].origin;
        return transform;
    }

    [[nodiscard]] std::uint32_t place_of(scene::InstanceId instance) const {
        const auto after = std::upper_bound(firsts_.begin(), firsts_.end(), instance);
        return static_cast<std::uint32_t>(after - firsts_.begin()) - 1;
    }
    [[nodiscard]] scene::InstanceId first_of(std::uint32_t place) const { return firsts_[place]; }

    // Takes over which regions are attached. Numbers their meshes, and moves some of those that no region in memory has
    // any more to `unused`; later ones get their numbers. Returns whether there are new ones.
    bool follow(std::span<const RegionStream::Attached> attached,
                std::vector<std::shared_ptr<const RegionDrawMesh>>& unused) {
        std::vector<const StreamedRegion*> before(regions_.size(), nullptr);
        before.swap(regions_);
        for (const RegionStream::Attached& entry : attached) regions_[entry.place] = entry.region;
        take_unused(unused);
        bool any = false;
        for (const RegionStream::Attached& entry : attached) {
            if (before[entry.place] == entry.region) continue;
            ids_[entry.place].clear();
            for (const auto& mesh : entry.region->meshes) {
                const auto [known, is_new] = number_.try_emplace(mesh.get(), 0);
                if (is_new) known->second = add(mesh);
                any = any || is_new;
                ids_[entry.place].push_back(known->second);
            }
        }
        return any;
    }
    [[nodiscard]] std::span<const std::shared_ptr<const RegionDrawMesh>> meshes() const { return meshes_; }

  private:
    scene::MeshId add(const std::shared_ptr<const RegionDrawMesh>& mesh) {
        if (free_.empty()) {
            free_.push_back(static_cast<scene::MeshId>(meshes_.size()));
            meshes_.emplace_back();
        }
        const scene::MeshId id = free_.back();
        free_.pop_back();
        meshes_[id] = mesh;
        return id;
    }
    // Looks at some of the meshes, so that no frame takes long where a whole town is left at once.
    void take_unused(std::vector<std::shared_ptr<const RegionDrawMesh>>& unused) {
        constexpr std::size_t kAtOnce = 128;
        for (std::size_t i = 0; i < std::min(kAtOnce, meshes_.size()); ++i) {
            next_ = (next_ + 1) % meshes_.size();
            if (meshes_[next_].use_count() != 1) continue;
            number_.erase(meshes_[next_].get());
            unused.push_back(std::exchange(meshes_[next_], none_));
            free_.push_back(static_cast<scene::MeshId>(next_));
        }
    }

    const RegionStream& stream_;
    std::vector<scene::InstanceId> firsts_;        // by region
    std::vector<const StreamedRegion*> regions_;   // by region; nullptr: not attached
    std::vector<std::vector<scene::MeshId>> ids_;  // by region, by its mesh
    std::vector<std::shared_ptr<const RegionDrawMesh>> meshes_;
    std::size_t next_ = 0;             // of `meshes_`, that take_unused() has looked at last
    std::vector<scene::MeshId> free_;  // of `meshes_`, which have `none_`
    std::shared_ptr<const RegionDrawMesh> none_ = std::make_shared<RegionDrawMesh>();
    std::unordered_map<const RegionDrawMesh*, scene::MeshId> number_;
};

// The far plane for which all of the view is within a distance of the eye.
double far_within(double distance, const Camera& camera) {
    const double y = std::tan(0.5 * camera.fov_y), x = y * camera.aspect;
    return distance / std::sqrt(1.0 + x * x + y * y);
}

}  // namespace

struct RegionPipeline::State {
    RegionStream stream;
    RegionPipelineOptions options;
    std::shared_ptr<RegionDrawables> drawables;
    std::uint64_t mesh_revision = 0;
    std::vector<std::uint8_t> unlit, one_sided, flat;
    std::shared_ptr<const SceneClusters> clusters;
    bool all_cut = true;
    ViewResult visible, not_hidden;
    std::vector<cull::Verdict> verdicts;  // by instance
    std::vector<scene::InstanceId> visible_ids;
    std::vector<RegionStream::Attached> in_order;  // by region
    ObjectCounter counter;

    State(RegionStream the_stream, const RegionPipelineOptions& the_options)
        : stream(std::move(the_stream)), options(the_options) {}

    // Takes over the meshes of regions that have come.
    void follow_meshes() {
        in_order.assign(stream.attached().begin(), stream.attached().end());
        std::sort(in_order.begin(), in_order.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
        auto unused = std::make_unique<StreamedRegion>();
        const bool any = drawables->follow(in_order, unused->meshes);
        if (!unused->meshes.empty()) stream.drop(std::move(unused));
        if (!any) return;
        ++mesh_revision;
        const auto flags = [&](bool bake::MeshLook::*look) {
            std::vector<std::uint8_t> result;
            for (const auto& mesh : drawables->meshes()) result.push_back(mesh->look.*look);
            return result;
        };
        unlit = flags(&bake::MeshLook::unlit);
        one_sided = flags(&bake::MeshLook::one_sided);
        flat = flags(&bake::MeshLook::flat);
        if (!options.picture) return;
        auto cut = std::make_shared<SceneClusters>();
        all_cut = true;
        for (const auto& mesh : drawables->meshes()) {
            all_cut = all_cut && (!mesh->clusters->clusters().empty() || mesh->mesh.indices.empty());
            cut->meshes.push_back(mesh->clusters);
        }
        clusters = std::move(cut);
    }

    // Calls body(first, last, region) for the runs of a list of the World's indices, ascending, in order of regions.
    template <class Index, class Body>
    void for_each_run(std::size_t size, Index index, Body body) const {
        for (const RegionStream::Attached& entry : in_order) {
            const std::uint64_t end = std::uint64_t{entry.first_object} + entry.region->region.object_count();
            std::size_t low = 0, high = size;
            const auto first_at_least = [&](std::uint64_t value) {
                std::size_t a = low, b = high;
                while (a < b) {
                    const std::size_t middle = a + (b - a) / 2;
                    if (index(middle) < value)
                        a = middle + 1;
                    else
                        b = middle;
                }
                return a;
            };
            low = first_at_least(entry.first_object);
            body(low, first_at_least(end), drawables->first_of(entry.place) - entry.first_object);
        }
    }

    void list_visible() {
        for (const scene::InstanceId i : visible_ids) verdicts[i] = cull::Verdict::outside;
        visible_ids.clear();
        const auto ids = visible.ids();
        const auto found = visible.verdicts();
        for_each_run(
            ids.size(), [&](std::size_t k) { return ids[k]; },
            [&](std::size_t first, std::size_t last, std::uint32_t shift) {
                for (std::size_t k = first; k < last; ++k) {
                    visible_ids.push_back(ids[k] + shift);
                    verdicts[ids[k] + shift] = found[k];
                }
            });
    }

    void count_triangles(const Frustum& frustum, OccludedFrame& frame) {
        if (!options.count_triangles) return;
        const ObjectCounts counts = counter.count(*drawables, frustum, frame.visible_ids, verdicts);
        frame.triangles_submitted = counts.triangles_submitted;
        frame.triangles_passed = counts.triangles_passed;
    }

    // nullptr: the region is not attached.
    [[nodiscard]] const RegionStream::Attached* attached_at(std::uint32_t place) const {
        const auto entry = std::lower_bound(in_order.begin(), in_order.end(), place,
                                            [](const auto& a, std::uint32_t at) { return a.place < at; });
        return entry != in_order.end() && entry->place == place ? &*entry : nullptr;
    }

    // As RegionPipeline::set_of().
    [[nodiscard]] std::span<const std::uint64_t> set_of(const RegionStream::Attached& entry,
                                                        const Camera& camera) const {
        if (!entry.region->sets) return {};
        return entry.region->sets->seen_by(camera, stream.index()[entry.place].origin);
    }

    // Keeps the visible instances that no region's sets prove hidden.
    void keep_in_sets(const Camera& camera, OccludedFrame& frame) const {
        const auto start = Clock::now();
        std::size_t next = 0;
        for (const RegionStream::Attached& entry : in_order) {
            const scene::InstanceId first = drawables->first_of(entry.place);
            const auto count = static_cast<std::uint32_t>(entry.region->region.object_count());
            const auto seen = set_of(entry, camera);
            for (; next < visible_ids.size() && visible_ids[next] - first < count; ++next)
                if (cull::is_candidate(seen, visible_ids[next] - first)) frame.visible_ids.push_back(visible_ids[next]);
        }
        frame.occlude_us = us_since(start);
    }

    Result<void> find_not_hidden(const Camera& camera, const Frustum& frustum, OccludedFrame& frame,
                                 Executor& executor) {
        if (options.by_sets) {
            keep_in_sets(camera, frame);
            frame.visible = frame.visible_ids.size();
            count_triangles(frustum, frame);
            return {};
        }
        const auto start = Clock::now();
        const ViewRequest request{.camera = camera, .occlusion = options.occlusion, .picture = options.picture};
        if (auto seen = stream.world().view(request, not_hidden, executor); !seen) return seen;
        frame.occlude_us = us_since(start);
        const auto ids = not_hidden.ids();
        for_each_run(
            ids.size(), [&](std::size_t k) { return ids[k]; },
            [&](std::size_t first, std::size_t last, std::uint32_t shift) {
                for (std::size_t k = first; k < last; ++k)
                    if (verdicts[ids[k] + shift] != cull::Verdict::outside) frame.visible_ids.push_back(ids[k] + shift);
            });
        frame.visible = frame.visible_ids.size();
        if (!options.picture) {
            frame.occluders = not_hidden.occlusion_statistics().occluders_drawn;
            count_triangles(frustum, frame);
            return {};
        }
        frame.by_depth = true;
        const auto triangles = not_hidden.triangles();
        for_each_run(
            triangles.size(), [&](std::size_t k) { return triangles[k].object; },
            [&](std::size_t first, std::size_t last, std::uint32_t shift) {
                for (std::size_t k = first; k < last; ++k) {
                    frame.clusters.push_back(triangles[k]);
                    frame.clusters.back().object += shift;
                }
            });
        frame.triangles_submitted = not_hidden.picture_statistics().triangles_listed;
        if (options.count_triangles)
            frame.triangles_passed = counter.count(*drawables, frustum, *clusters, frame.clusters);
        return {};
    }
};

RegionPipeline::RegionPipeline(std::unique_ptr<State> state) : state_(std::move(state)) {}
RegionPipeline::~RegionPipeline() = default;
RegionPipeline::RegionPipeline(RegionPipeline&&) noexcept = default;
RegionPipeline& RegionPipeline::operator=(RegionPipeline&&) noexcept = default;

Result<RegionPipeline> RegionPipeline::open(const std::string& folder, const RegionPipelineOptions& options) {
    auto stream = RegionStream::open(folder, options.stream);
    if (!stream) return stream.error();
    if (stream->object_count() >= scene::kNone)
        return fail(ErrorCode::out_of_range, kNoItem, folder + ": has more than 2^32 - 2 objects");
    std::vector<scene::InstanceId> firsts;
    std::uint64_t count = 0;
    for (const bake::RegionFile& file : stream->index()) {
        firsts.push_back(static_cast<scene::InstanceId>(count));
        count += file.objects;
    }
    auto state = std::make_unique<State>(std::move(*stream), options);
    state->drawables = std::make_shared<RegionDrawables>(state->stream, std::move(firsts));
    state->verdicts.assign(count, cull::Verdict::outside);
    return RegionPipeline(std::move(state));
}

Result<FrameStatistics> RegionPipeline::run(const Camera& given, Executor& executor) {
    State& s = *state_;
    Camera camera = given;
    camera.far_distance = std::min(camera.far_distance, far_within(s.stream.distance(), camera));
    const auto frustum = frustum_of(camera);
    if (!frustum) return frustum.error();
    FrameStatistics frame;
    frame.camera = camera;
    const auto streamed = s.stream.follow(camera.position);
    if (!streamed) return streamed.error();
    const auto start = Clock::now();
    s.follow_meshes();
    frame.regions = *streamed;
    frame.update_us = streamed->attach_us + us_since(start);
    if (!s.all_cut)
        return fail(ErrorCode::unsupported, kNoItem,
                    "a region was baked without clusters, by which hidden triangles are found");

    const auto cull_start = Clock::now();
    if (auto seen = s.stream.world().view({.volume = *frustum}, s.visible, executor); !seen) return seen.error();
    s.list_visible();
    frame.cull_us = us_since(cull_start);
    frame.instances = s.stream.object_count();
    frame.visible = s.visible_ids.size();
    for (const scene::InstanceId i : s.visible_ids) frame.inside += s.verdicts[i] == cull::Verdict::inside;
    frame.straddling = frame.visible - frame.inside;
    frame.nodes_tested = s.visible.statistics().nodes_tested;
    frame.visible_ids = s.visible_ids;
    if (s.options.count_triangles) {
        const ObjectCounts counts = s.counter.count(*s.drawables, *frustum, s.visible_ids, s.verdicts);
        frame.triangles_submitted = counts.triangles_submitted;
        frame.triangles_passed = counts.triangles_passed;
        frame.improper = counts.improper;
    }
    if (s.options.picture || s.options.occlusion || s.options.by_sets)
        if (auto found = s.find_not_hidden(camera, *frustum, frame.occlusion.emplace(), executor); !found)
            return found.error();
    return frame;
}

std::uint64_t RegionPipeline::mesh_revision() const {
    return state_->mesh_revision;
}
std::shared_ptr<const Drawables> RegionPipeline::drawables() const {
    return state_->drawables;
}
std::span<const std::uint8_t> RegionPipeline::unlit() const {
    return state_->unlit;
}
std::span<const std::uint8_t> RegionPipeline::one_sided() const {
    return state_->one_sided;
}
std::span<const std::uint8_t> RegionPipeline::flat() const {
    return state_->flat;
}
std::shared_ptr<const SceneClusters> RegionPipeline::clusters() const {
    return state_->clusters;
}
const RegionStream& RegionPipeline::stream() const {
    return state_->stream;
}
std::span<const cull::Verdict> RegionPipeline::verdicts() const {
    return state_->verdicts;
}
std::uint32_t RegionPipeline::place_of(scene::InstanceId instance) const {
    return state_->drawables->place_of(instance);
}
scene::InstanceId RegionPipeline::first_of(std::uint32_t place) const {
    return state_->drawables->first_of(place);
}
scene::InstanceId RegionPipeline::instance_of(ObjectHandle object) const {
    const World& world = state_->stream.world();
    const auto place = world.place_of(object);
    if (!place) return scene::kNone;
    for (const RegionStream::Attached& entry : state_->in_order)
        if (entry.handle == place->region) return first_of(entry.place) + place->index;
    return scene::kNone;
}
std::span<const std::uint64_t> RegionPipeline::set_of(std::uint32_t place, const Camera& camera) const {
    const RegionStream::Attached* const entry = state_->attached_at(place);
    return entry != nullptr ? state_->set_of(*entry, camera) : std::span<const std::uint64_t>();
}
ObjectHandle RegionPipeline::object_of(scene::InstanceId instance) const {
    if (instance >= state_->verdicts.size()) return {};
    const std::uint32_t place = place_of(instance);
    const RegionStream::Attached* const entry = state_->attached_at(place);
    if (entry == nullptr) return {};
    return state_->stream.world().object_in(entry->handle, instance - first_of(place)).value_or(ObjectHandle{});
}

}  // namespace crofton::pipeline
