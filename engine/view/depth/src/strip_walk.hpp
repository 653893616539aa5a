// SPDX-License-Identifier: MIT
// The walk from front to back over a strip of the picture: some columns of tiles.
//
// The whole picture is one strip, or several strips are walked at once: the union of what they find is the same.
// - An object's bound contains those of its clusters, and these the triangles, in samples and in nearness. So if an
//   object or a cluster is hidden in a strip, its triangles are hidden in that strip.
// - What is hidden in a strip would not raise its tiles: a lower bound of its nearness is at most the upper one.
// - Items come in the same order in each strip.
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <crofton/core/memory.hpp>
#include <crofton/depth/depth_culler.hpp>
#include <cstdint>
#include <span>

#include "culler_data.hpp"
#include "depth_frame.hpp"

namespace crofton::depth {

// Work that strips have done together, counted at most once for each object and cluster: clusters that were asked, and
// triangles that were drawn.
struct SharedWork {
    std::uint64_t limit = 0;
    std::atomic<std::uint64_t> done{0};
};

// A cluster with all its triangles.
[[nodiscard]] inline VisibleCluster all_of(const ClusteredMesh& mesh, std::uint32_t object, std::uint32_t cluster) {
    return {object, cluster, ~std::uint64_t{0} >> (64 - mesh.triangles_of(cluster))};
}

class StripWalk {
  public:
    // Tiles [first_column, end_column) of each row. Where the strip is the whole picture, what is left is listed after
    // `work.limit`; where it is not, the walk stops when all strips together have done more.
    void run(const DepthFrame& frame, std::uint32_t first_column, std::uint32_t end_column, SharedWork& work);

    // Those that were drawn, with the triangles that may own a sample; in any order.
    [[nodiscard]] std::span<const VisibleCluster> clusters() const { return clusters_; }
    // Objects into which the walk looked, each once.
    [[nodiscard]] std::span<const std::uint32_t> objects() const { return asked_; }
    // Those that were not hidden after the limit, with all triangles.
    [[nodiscard]] std::span<const VisibleCluster> untested() const { return untested_; }
    [[nodiscard]] bool has_column(std::uint32_t column) const {
        return column >= first_column_ && column < end_column_;
    }
    // True if all samples of the rectangle that lie in the strip are nearer.
    [[nodiscard]] bool hides(const Projection& projection) const { return is_hidden(picture_.tiles, projection); }
    // Of a pixel in the strip.
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const {
        const Tiles& tiles = picture_.tiles;
        const std::size_t t = std::size_t{y / kTile} * tiles.columns + x / kTile;
        const float floor = tiles.floors[t];
        if (tiles.written[t] == 0) return floor;
        return std::max(floor, tiles.pixels[t * kTilePixels + y % kTile * kTile + x % kTile]);
    }

  private:
    static constexpr std::uint32_t kEnd = ~std::uint32_t{0};

    struct Item {
        std::uint32_t object = 0, cluster = 0;
        std::uint32_t next = kEnd;
        Projection projection{};
    };

    void begin(std::uint32_t first_column, std::uint32_t end_column);
    void raise_floors();
    void walk_bin(std::uint32_t bin);
    void look_into(std::uint32_t object);
    void split(std::uint32_t object);
    void push(const Item& item);
    // `bound`: what `projection` is of.
    void draw(std::uint32_t object, std::uint32_t cluster, const ClusterBox& bound, const Projection& projection);
    void ask_unclear();
    void list_whole(std::uint32_t object, std::uint32_t cluster);
    // Counts what is done for a box in one of the strips.
    void count(std::uint64_t work, const Projection& box);
    [[nodiscard]] bool is_exceeded() const { return work_->done.load(std::memory_order_relaxed) > work_->limit; }

    const DepthFrame* frame_ = nullptr;
    SharedWork* work_ = nullptr;
    PictureData picture_{};
    bool whole_ = true;
    std::uint32_t first_column_ = 0, end_column_ = 0;
    std::uint32_t bin_ = 0;
    Vector<float> pixels_, least_, floors_;
    Vector<std::uint8_t> written_;
    // Clusters that wait, by bin.
    std::array<std::uint32_t, DepthFrame::kBins> first_{}, last_{};
    Vector<Item> items_;
    Vector<Projection> projections_;  // of the clusters of one object
    Owner<Patch> patch_;              // the cluster that is drawn
    std::uint32_t drawn_ = kEnd;      // its object, or that of the one before
    ObjectData drawn_data_{};
    struct Unclear {
        std::size_t place;  // in clusters_
        Projection projection;
    };
    Vector<VisibleCluster> clusters_, untested_;
    Vector<Unclear> unclear_;
    Vector<std::uint32_t> asked_;
};

}  // namespace crofton::depth
