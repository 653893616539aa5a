// SPDX-License-Identifier: MIT
#include <crofton/depth/depth_culler.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "depth_frame.hpp"
#include "receiver_mask.hpp"
#include "strip_walk.hpp"

namespace crofton::depth {
namespace {

// Strips for each thread that may run: few, as what reaches into several is set up in each, but more than one, as some
// are empty.
constexpr std::uint32_t kStripsPerThread = 2;

Result<void> check(std::span<const DepthObject> objects, const PictureView& view) {
    if (auto checked = view.check(); !checked) return checked;
    if (objects.size() >= std::numeric_limits<std::uint32_t>::max())
        return fail(ErrorCode::out_of_range, kNoItem, "depth: too many objects");
    for (std::size_t i = 0; i < objects.size(); ++i)
        if (objects[i].mesh == nullptr || objects[i].mesh->clusters().empty())
            return fail(ErrorCode::invalid_argument, i,
                        "depth: an object has no mesh; cut one, or leave the object out");
    return {};
}

// `drawn`: objects in the camera's picture; `seen`: those of which something is seen.
Result<void> check(const DepthReceivers& receivers, std::size_t drawn, std::span<const SeenObject> seen,
                   const PictureView& map) {
    if (map.samples != 1) return fail(ErrorCode::out_of_range, kNoItem, "depth: a shadow map has 1 sample per texel");
    if (!DepthReceivers::has_radius(receivers.radius))
        return fail(ErrorCode::out_of_range, kNoItem, "depth: the radius of lookups is 0.5 to 1,024 texels");
    if (receivers.objects.size() != drawn)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "depth: there must be one receiver for each object of the camera's picture");
    for (const SeenObject& object : seen) {
        const ClusteredMesh* const mesh = receivers.objects[object.object].mesh;
        if (mesh == nullptr || mesh->identity() != object.mesh)
            return fail(ErrorCode::invalid_argument, object.object,
                        "depth: a receiver has another mesh than in the camera's picture, or one that has been cut "
                        "anew: find what the camera sees again");
    }
    return {};
}

}  // namespace

Result<void> PictureView::check(std::uint64_t item) const {
    if (width == 0 || height == 0 || width > kMaxSize || height > kMaxSize)
        return fail(ErrorCode::out_of_range, item, "picture: it has 1 to 16,384 pixels each way");
    if (!std::has_single_bit(samples) || samples > 8)
        return fail(ErrorCode::out_of_range, item, "picture: a pixel has 1, 2, 4 or 8 samples");
    return {};
}

struct DepthCuller::State {
    DepthFrame frame;
    ReceiverMask receivers;
    std::uint32_t samples = 1;  // of a pixel
    Vector<StripWalk> strips;
    std::uint32_t strip_count = 0;  // of the last picture
    Vector<VisibleCluster> found, sorted;
    Vector<VisibleCluster> of_samples;  // found at any of those that were looked at
    Vector<std::uint32_t> ends;
    Vector<std::uint8_t> looked_into;  // by object
    DepthStatistics statistics;
    // Kept from find_visible(), for receivers of shadows.
    bool has_picture = false;
    std::size_t drawn = 0;    // objects that were given
    Vector<SeenObject> seen;  // those that are listed

    // Requires checked objects and a checked view.
    std::span<const VisibleCluster> find(std::span<const DepthObject> objects, const PictureView& view,
                                         std::span<const float> floors, Executor& executor) {
        const std::uint64_t limit = view.work_limit != 0 ? view.work_limit : ~std::uint64_t{0};
        const unsigned threads = executor.concurrency();
        samples = view.samples;
        of_samples.clear();
        DepthStatistics sum;
        // nearness() is that of the last: the first sample.
        for (std::uint32_t sample = samples; sample-- > 0;) {
            frame.set(objects, view, sample, floors, executor);
            // Which of the clusters are the first within the limit only one walk can tell.
            if (!walk(threads == 1 ? 1 : kStripsPerThread * threads, limit, executor)) (void)walk(1, limit, executor);
            if (samples > 1) add_samples(std::exchange(sum, {}));
            sum = statistics;
        }
        keep_seen(!floors.empty());
        frame.forget_objects();
        return sorted;
    }

    void keep_seen(bool of_light) {
        has_picture = !of_light;
        drawn = frame.objects().size();
        seen.clear();
        for (std::size_t i = 0; has_picture && i < sorted.size(); ++i) {
            const std::uint32_t object = sorted[i].object;
            if (i > 0 && sorted[i - 1].object == object) continue;
            const DepthObject& given = frame.objects()[object];
            seen.push_back({object, given.mesh->identity(), frame.data_of(object), given.position_error});
        }
    }

    // Returns false if several strips did more together than the limit: what one walk would list is not known then.
    bool walk(std::uint32_t count, std::uint64_t limit, Executor& executor) {
        const std::uint32_t columns = (frame.picture().tiles.width + kTile - 1) / kTile;
        strip_count = std::min(count, columns);
        if (strips.size() < strip_count) strips.resize(strip_count);
        SharedWork work;
        work.limit = limit;
        executor.parallel_for(strip_count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t s = begin; s < end; ++s)
                strips[s].run(frame, static_cast<std::uint32_t>(s * columns / strip_count),
                              static_cast<std::uint32_t>((s + 1) * columns / strip_count), work);
        });
        if (strip_count > 1 && work.done.load() > limit) return false;
        merge();
        return strip_count == 1 || statistics.clusters_asked + statistics.triangles_drawn <= limit;
    }

    // What the strips found, by object, then by cluster; each once.
    void merge() {
        statistics = {};
        statistics.objects_asked = frame.count();
        count_objects();
        found.clear();
        for (const StripWalk& strip : walked())
            found.insert(found.end(), strip.clusters().begin(), strip.clusters().end());
        if (strip_count > 1) {
            sort();
            unite();
            std::swap(found, sorted);
        }
        statistics.clusters_drawn = found.size();
        for (const VisibleCluster& c : found) statistics.triangles_drawn += mesh_of(c.object).triangles_of(c.cluster);
        for (const StripWalk& strip : walked())
            found.insert(found.end(), strip.untested().begin(), strip.untested().end());
        for (const std::uint32_t object : frame.unplaced())
            for (std::uint32_t c = 0; c < mesh_of(object).clusters().size(); ++c)
                found.push_back(all_of(mesh_of(object), object, c));
        std::erase_if(found, [](const VisibleCluster& c) { return c.triangles == 0; });
        sort();
        count_listed();
    }

    [[nodiscard]] std::span<const StripWalk> walked() const { return std::span(strips).first(strip_count); }
    [[nodiscard]] const ClusteredMesh& mesh_of(std::uint32_t object) const { return *frame.objects()[object].mesh; }

    void count_objects() {
        if (strip_count > 1) looked_into.assign(frame.objects().size(), 0);
        for (const StripWalk& strip : walked())
            for (const std::uint32_t object : strip.objects())
                if (strip_count == 1 || std::exchange(looked_into[object], std::uint8_t{1}) == 0)
                    statistics.clusters_asked += mesh_of(object).clusters().size();
    }

    void sort() {
        ends.assign(frame.objects().size() + 1, 0);
        for (const VisibleCluster& c : found) ++ends[c.object];
        std::uint32_t sum = 0;
        for (std::uint32_t& end : ends) sum += std::exchange(end, sum);
        sorted.resize(found.size());
        for (const VisibleCluster& c : found) sorted[ends[c.object]++] = c;
        for (std::size_t begin = 0; begin < sorted.size();) {
            const std::uint32_t end = ends[sorted[begin].object];
            std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.begin() + end,
                      [](const VisibleCluster& a, const VisibleCluster& b) { return a.cluster < b.cluster; });
            begin = end;
        }
    }

    // Takes up what was found at the samples before this one.
    void add_samples(const DepthStatistics& before) {
        found.assign(of_samples.begin(), of_samples.end());
        found.insert(found.end(), sorted.begin(), sorted.end());
        sort();
        unite();
        statistics.objects_asked += before.objects_asked;
        statistics.clusters_asked += before.clusters_asked;
        statistics.clusters_drawn += before.clusters_drawn;
        statistics.triangles_drawn += before.triangles_drawn;
        statistics.objects_listed = statistics.triangles_listed = 0;
        count_listed();
        of_samples.assign(sorted.begin(), sorted.end());
    }

    // Clusters that several strips or samples found.
    void unite() {
        std::size_t count = 0;
        for (const VisibleCluster& c : sorted)
            if (count != 0 && sorted[count - 1].object == c.object && sorted[count - 1].cluster == c.cluster)
                sorted[count - 1].triangles |= c.triangles;
            else
                sorted[count++] = c;
        sorted.resize(count);
    }

    void count_listed() {
        for (std::size_t i = 0; i < sorted.size(); ++i) {
            statistics.objects_listed += i == 0 || sorted[i - 1].object != sorted[i].object;
            statistics.triangles_listed += static_cast<std::uint64_t>(std::popcount(sorted[i].triangles));
        }
    }
};

DepthCuller::DepthCuller() : state_(Owner<State>::make()) {}
DepthCuller::~DepthCuller() = default;
DepthCuller::DepthCuller(DepthCuller&&) noexcept = default;
DepthCuller& DepthCuller::operator=(DepthCuller&&) noexcept = default;

Result<std::span<const VisibleCluster>> DepthCuller::find_visible(std::span<const DepthObject> objects,
                                                                  const PictureView& view, Executor& executor) {
    if (auto checked = check(objects, view); !checked) return checked.error();
    return state_->find(objects, view, {}, executor);
}

Result<std::span<const VisibleCluster>> DepthCuller::find_casters(std::span<const DepthObject> objects,
                                                                  const PictureView& map,
                                                                  const DepthReceivers& receivers, Executor& executor) {
    if (receivers.seen == nullptr || receivers.seen == this || !receivers.seen->state_->has_picture)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "depth: casters need another culler, whose last answer is what the camera sees");
    const State& seen = *receivers.seen->state_;
    if (auto checked = check(objects, map); !checked) return checked.error();
    if (auto checked = check(receivers, seen.drawn, seen.seen, map); !checked) return checked.error();
    const auto strips = seen.samples == 1 ? seen.walked() : std::span<const StripWalk>();
    state_->receivers.find({seen.frame.picture(), seen.seen, seen.sorted, strips}, receivers, map);
    if (state_->receivers.is_empty()) objects = {};
    return state_->find(objects, map, state_->receivers.floors(), executor);
}

const DepthStatistics& DepthCuller::statistics() const {
    return state_->statistics;
}

float DepthCuller::nearness(std::uint32_t x, std::uint32_t y) const {
    for (const StripWalk& strip : state_->walked())
        if (strip.has_column(x / kTile)) return strip.nearness(x, y);
    return kNothing;
}

}  // namespace crofton::depth
