// SPDX-License-Identifier: MIT
#include <crofton/depth/depth_culler.hpp>

#include <hwy/cache_control.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "culler_data.hpp"

namespace crofton::depth {
namespace {

constexpr std::uint32_t kWholeObject = ~std::uint32_t{0};
constexpr std::uint32_t kEnd = ~std::uint32_t{0};

// Objects and clusters by distance: bins of a sixteenth of an octave. Those of one bin come in the order in which they
// were put there, so that the order is the same everywhere.
struct Item {
    std::uint32_t object = 0;
    std::uint32_t cluster = kWholeObject;
    std::uint32_t next = kEnd;
    Projection projection{};
};

class NearestFirst {
  public:
    void clear() {
        first_.fill(kEnd);
        items_.clear();
        at_ = 0;
    }

    // By a distance ≥ 0; one nearer than what has been taken comes next.
    void push(Item item, float distance) {
        const std::uint32_t bin = std::max(bin_of(distance), at_);
        const auto number = static_cast<std::uint32_t>(items_.size());
        items_.push_back(item);
        if (first_[bin] == kEnd)
            first_[bin] = number;
        else
            items_[last_[bin]].next = number;
        last_[bin] = number;
    }

    [[nodiscard]] bool pop(Item& item) {
        while (first_[at_] == kEnd)
            if (++at_ == kBins) return at_ = kBins - 1, false;
        item = items_[first_[at_]];
        first_[at_] = item.next;
        if (item.next != kEnd) hwy::Prefetch(&items_[item.next]);
        return true;
    }

  private:
    static constexpr std::uint32_t kBins = 1024;

    static std::uint32_t bin_of(float distance) {
        constexpr std::int32_t kFirst = std::bit_cast<std::int32_t>(0x1p-20f) >> 19;
        const std::int32_t bin = (std::bit_cast<std::int32_t>(std::max(distance, 0.0f)) >> 19) - kFirst;
        return static_cast<std::uint32_t>(std::clamp(bin, 0, static_cast<std::int32_t>(kBins) - 1));
    }

    std::array<std::uint32_t, kBins> first_{}, last_{};
    Vector<Item> items_;
    std::uint32_t at_ = 0;
};

struct Prepared {
    ObjectData data{};
    bool valid = false;
};

}  // namespace

struct DepthCuller::State {
    Vector<float> pixels, least, floors;
    Vector<std::uint8_t> written;
    PictureData picture{};
    bool perspective = true;
    Vector<Prepared> objects;
    Vector<Projection> projections;
    NearestFirst queue;
    Vector<VisibleCluster> found, sorted;
    Vector<std::uint32_t> ends;
    DepthStatistics statistics;

    void begin(const PictureView& view) {
        Tiles& tiles = picture.tiles;
        tiles.columns = (view.width + kTile - 1) / kTile, tiles.rows = (view.height + kTile - 1) / kTile;
        tiles.width = view.width, tiles.height = view.height;
        const std::size_t count = std::size_t{tiles.columns} * tiles.rows;
        if (pixels.size() < count * kTilePixels) pixels.resize(count * kTilePixels);
        least.assign(count + kTile, kNothing);  // kernels read and write a vector beyond the end
        floors.assign(count + kTile, kNothing);
        written.assign(count, 0);
        tiles.pixels = pixels.data(), tiles.least = least.data(), tiles.floors = floors.data();
        tiles.written = written.data();
        picture.half_width = 0.5f * static_cast<float>(view.width);
        picture.half_height = 0.5f * static_cast<float>(view.height);
        const bool reversed = view.depth == DepthRange::reversed_zero_to_one;
        picture.near_share = view.depth == DepthRange::zero_to_one ? 0.0f : 1.0f;
        picture.infinitely_far = reversed ? 0.0f : -1.0f;
        // Half a step of the grid, and the rounding of three operations on numbers up to the picture's size.
        picture.grid = 0x1p-9f + 0x1p-21f * static_cast<float>(std::max(view.width, view.height));
        statistics = {};
        queue.clear();
        found.clear();
    }

    void prepare(const DepthObject& object, bool reversed, Prepared& to) const {
        const glm::vec3 largest = object.mesh->layout().largest;
        to = {};
        float sum = 0.0f;
        for (glm::length_t i = 0; i < 4; ++i) {
            const float sign = i == 2 && !reversed ? -1.0f : 1.0f;
            float size = std::abs(object.to_clip[3][i]), moved = 0.0f;
            for (glm::length_t c = 0; c < 4; ++c) {
                to.data.columns[c][i] = sign * object.to_clip[c][i];
                if (c == 3) continue;
                size += std::abs(object.to_clip[c][i]) * largest[c];
                moved += std::abs(object.to_clip[c][i]);
            }
            to.data.moved[i] = moved * object.position_error;
            sum += size;
        }
        to.data.one_sided = object.one_sided;
        to.data.hides = object.hides;
        to.valid = sum < 1e30f && object.position_error >= 0.0f && object.position_error < 1e30f;
    }

    [[nodiscard]] float distance_of(const Projection& p) const {
        if (p.coverage == Coverage::unclear) return 0.0f;
        return perspective ? p.least_w : std::max(picture.near_share - p.nearest, 0.0f);
    }

    void push(std::uint32_t object, std::uint32_t cluster, const Projection& projection) {
        queue.push({object, cluster, kEnd, projection}, distance_of(projection));
    }

    // All of an object that cannot be placed.
    void list_whole(std::uint32_t object, const ClusteredMesh& mesh) {
        const std::span<const Cluster> clusters = mesh.clusters();
        for (std::uint32_t c = 0; c < clusters.size(); ++c)
            list({object, c, ~std::uint64_t{0} >> (64 - clusters[c].triangle_count)});
    }

    void list(const VisibleCluster& cluster) {
        found.push_back(cluster);
        statistics.triangles_listed += static_cast<std::uint64_t>(std::popcount(cluster.triangles));
    }

    void split(std::uint32_t object, const ClusteredMesh& mesh) {
        const std::span<const Cluster> clusters = mesh.clusters();
        statistics.clusters_asked += clusters.size();
        if (projections.size() < clusters.size()) projections.resize(clusters.size());
        project_bounds(picture, objects[object].data, clusters.data(), clusters.size(), projections.data());
        for (std::uint32_t c = 0; c < clusters.size(); ++c)
            if (projections[c].coverage != Coverage::nothing) push(object, c, projections[c]);
    }

    void draw(std::uint32_t object, std::uint32_t cluster, const ClusteredMesh& mesh, const Projection& projection) {
        const ClusteredMesh::Layout layout = mesh.layout();
        const ClusteredMesh::Patch& patch = layout.patches[cluster];
        const PatchData data{layout.coordinates.data() + patch.first_coordinate,
                             layout.blocks.data() + patch.first_block,
                             patch.vertex_count,
                             patch.triangle_count,
                             projection.least_w,
                             projection.errors,
                             projection.coverage == Coverage::unclear};
        const std::uint64_t triangles = draw_patch(picture, objects[object].data, data);
        ++statistics.clusters_drawn;
        statistics.triangles_drawn += patch.triangle_count;
        if (triangles != 0) list({object, cluster, triangles});
    }

    void ask(const Item& item, const ClusteredMesh& mesh) {
        if (item.projection.coverage != Coverage::unclear && is_hidden(picture.tiles, item.projection)) return;
        if (item.cluster != kWholeObject) return draw(item.object, item.cluster, mesh, item.projection);
        if (mesh.clusters().size() > 1) return split(item.object, mesh);
        ++statistics.clusters_asked;
        draw(item.object, 0, mesh, item.projection);
    }

    // By object, then by cluster.
    void sort(std::size_t object_count) {
        ends.assign(object_count + 1, 0);
        for (const VisibleCluster& c : found) ++ends[c.object];
        std::uint32_t sum = 0;
        for (std::uint32_t& end : ends) {
            statistics.objects_listed += end != 0;
            sum += std::exchange(end, sum);
        }
        sorted.resize(found.size());
        for (const VisibleCluster& c : found) sorted[ends[c.object]++] = c;
        for (std::size_t begin = 0; begin < sorted.size();) {
            const std::uint32_t end = ends[sorted[begin].object];
            std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.begin() + end,
                      [](const VisibleCluster& a, const VisibleCluster& b) { return a.cluster < b.cluster; });
            begin = end;
        }
    }
};

DepthCuller::DepthCuller() : state_(Owner<State>::make()) {}
DepthCuller::~DepthCuller() = default;
DepthCuller::DepthCuller(DepthCuller&&) noexcept = default;
DepthCuller& DepthCuller::operator=(DepthCuller&&) noexcept = default;

Result<std::span<const VisibleCluster>> DepthCuller::find_visible(std::span<const DepthObject> objects,
                                                                  const PictureView& view) {
    if (view.width == 0 || view.height == 0 || view.width > PictureView::kMaxSize ||
        view.height > PictureView::kMaxSize)
        return fail(ErrorCode::out_of_range, kNoItem, "depth: a picture has 1 to 16,384 pixels each way");
    if (objects.size() >= kEnd) return fail(ErrorCode::out_of_range, kNoItem, "depth: too many objects");
    for (std::size_t i = 0; i < objects.size(); ++i)
        if (objects[i].mesh == nullptr || objects[i].mesh->clusters().empty())
            return fail(ErrorCode::invalid_argument, i,
                        "depth: an object has no mesh; cut one, or leave the object out");
    State& s = *state_;
    s.begin(view);
    s.objects.resize(objects.size());
    s.perspective = std::any_of(objects.begin(), objects.end(), [](const DepthObject& o) {
        return o.to_clip[0][3] != 0.0f || o.to_clip[1][3] != 0.0f || o.to_clip[2][3] != 0.0f;
    });
    const bool reversed = view.depth == DepthRange::reversed_zero_to_one;
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        s.prepare(objects[i], reversed, s.objects[i]);
        if (!s.objects[i].valid) {
            s.list_whole(i, *objects[i].mesh);
            continue;
        }
        Projection projection;
        project_bounds(s.picture, s.objects[i].data, &objects[i].mesh->bound(), 1, &projection);
        if (projection.coverage == Coverage::nothing) continue;
        ++s.statistics.objects_asked;
        s.push(i, kWholeObject, projection);
    }
    for (Item item; s.queue.pop(item);) s.ask(item, *objects[item.object].mesh);
    s.sort(objects.size());
    return std::span<const VisibleCluster>(s.sorted);
}

const DepthStatistics& DepthCuller::statistics() const {
    return state_->statistics;
}

float DepthCuller::nearness(std::uint32_t x, std::uint32_t y) const {
    const Tiles& tiles = state_->picture.tiles;
    const std::size_t t = std::size_t{y / kTile} * tiles.columns + x / kTile;
    const float floor = tiles.floors[t];
    if (tiles.written[t] == 0) return floor;
    return std::max(floor, tiles.pixels[t * kTilePixels + y % kTile * kTile + x % kTile]);
}

}  // namespace crofton::depth
