// SPDX-License-Identifier: MIT
#include "strip_walk.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cstddef>
#include <utility>

namespace crofton::depth {

void StripWalk::run(const DepthFrame& frame, std::uint32_t first_column, std::uint32_t end_column, SharedWork& work) {
    frame_ = &frame;
    work_ = &work;
    begin(first_column, end_column);
    for (bin_ = 0; bin_ < DepthFrame::kBins; ++bin_) {
        walk_bin(bin_);
        if (!whole_ && is_exceeded()) return;
    }
    ask_unclear();
}

void StripWalk::begin(std::uint32_t first_column, std::uint32_t end_column) {
    picture_ = frame_->picture();
    first_column_ = first_column, end_column_ = end_column;
    Tiles& tiles = picture_.tiles;
    const std::uint32_t rows = (tiles.height + kTile - 1) / kTile;
    tiles.columns = end_column - first_column;
    tiles.first_x = static_cast<std::int32_t>(first_column * kTile);
    tiles.last_x = static_cast<std::int32_t>(std::min(end_column * kTile, tiles.width)) - 1;
    whole_ = tiles.first_x == 0 && tiles.last_x + 1 == static_cast<std::int32_t>(tiles.width);
    // Tile (x, y) is at y · columns + x of the lists: they begin with the strip's first column. Kernels read and write
    // a vector beyond the end.
    const std::size_t count = std::size_t{tiles.columns} * rows + first_column;
    if (pixels_.size() < count * kTilePixels) pixels_.resize(count * kTilePixels);
    least_.assign(count + kTile, kNothing);
    floors_.assign(count + kTile, kNothing);
    written_.assign(count, 0);
    if (!frame_->floors().empty()) raise_floors();
    tiles.pixels = pixels_.data(), tiles.least = least_.data(), tiles.floors = floors_.data();
    tiles.written = written_.data();
    if (!patch_) patch_ = Owner<Patch>::make();
    first_.fill(kEnd);
    drawn_ = kEnd;
    items_.clear();
    clusters_.clear();
    unclear_.clear();
    asked_.clear();
    untested_.clear();
}

// From the beginning, tiles are as near as the frame says.
void StripWalk::raise_floors() {
    const std::uint32_t columns = (picture_.tiles.width + kTile - 1) / kTile;
    const std::uint32_t rows = (picture_.tiles.height + kTile - 1) / kTile;
    for (std::uint32_t y = 0; y < rows; ++y) {
        const std::span<const float> row =
            frame_->floors().subspan(std::size_t{y} * columns + first_column_, picture_.tiles.columns);
        const auto to = static_cast<std::ptrdiff_t>(std::size_t{y} * picture_.tiles.columns + first_column_);
        std::copy(row.begin(), row.end(), floors_.begin() + to);
        std::copy(row.begin(), row.end(), least_.begin() + to);
    }
}

// Objects first: clusters come to this bin only while it is walked, or from nearer objects that reach as far.
void StripWalk::walk_bin(std::uint32_t bin) {
    const std::span<const std::uint32_t> objects = frame_->in_bin(bin);
    const Projection* const projections = frame_->projections().data();
    for (std::size_t i = 0;; ++i) {
        i = first_shown(picture_.tiles, projections, objects.data(), i, objects.size());
        if (i == objects.size()) break;
        look_into(objects[i]);
    }
    while (first_[bin] != kEnd) {
        const Item item = items_[first_[bin]];
        first_[bin] = item.next;
        if (item.next != kEnd) hwy::Prefetch(&items_[item.next]);
        if (is_hidden(picture_.tiles, item.projection)) continue;
        draw(item.object, item.cluster, frame_->objects()[item.object].mesh->box_of(item.cluster), item.projection);
    }
}

void StripWalk::look_into(std::uint32_t object) {
    const ClusteredMesh& mesh = *frame_->objects()[object].mesh;
    const auto clusters = static_cast<std::uint32_t>(mesh.clusters().size());
    if (whole_ && is_exceeded()) {
        for (std::uint32_t c = 0; c < clusters; ++c) list_whole(object, c);
        return;
    }
    asked_.push_back(object);
    count(clusters, frame_->projections()[object]);
    if (clusters > 1) return split(object);
    draw(object, 0, mesh.bound(), frame_->projections()[object]);
}

void StripWalk::split(std::uint32_t object) {
    const std::span<const ClusteredMesh::PackedBox> boxes = frame_->objects()[object].mesh->boxes();
    const Projection& whole = frame_->projections()[object];
    if (projections_.size() < boxes.size() + kTile) projections_.resize(boxes.size() + kTile);
    project_clusters(picture_, frame_->data_of(object), whole, boxes.data(), boxes.size(), projections_.data());
    for (std::uint32_t c = 0; c < boxes.size(); ++c) {
        const Projection& p = projections_[c];
        if (!p.covers_nothing() && p.x1 >= picture_.tiles.first_x && p.x0 <= picture_.tiles.last_x)
            push({object, c, kEnd, p});
    }
}

// One that is nearer than what has been taken comes next.
void StripWalk::push(const Item& item) {
    const std::uint32_t bin = std::max(frame_->bin_of(item.projection), bin_);
    const auto number = static_cast<std::uint32_t>(items_.size());
    items_.push_back(item);
    if (first_[bin] == kEnd)
        first_[bin] = number;
    else
        items_[last_[bin]].next = number;
    last_[bin] = number;
}

void StripWalk::draw(std::uint32_t object, std::uint32_t cluster, const ClusterBox& bound,
                     const Projection& projection) {
    if (whole_ && is_exceeded()) return list_whole(object, cluster);
    PatchReader::open(*frame_->objects()[object].mesh, cluster, *patch_);
    count(patch_->triangle_count, projection);
    const PatchData data{*patch_, bound, projection};
    if (projection.is_unclear()) unclear_.push_back({clusters_.size(), projection});
    if (std::exchange(drawn_, object) != object) drawn_data_ = frame_->data_of(object);
    clusters_.push_back({object, cluster, draw_patch(picture_, drawn_data_, data)});
}

// Clusters that reach the near plane come first, with all triangles that may be in the picture: nothing is known then
// of what is in front of them.
void StripWalk::ask_unclear() {
    for (const Unclear& unclear : unclear_) {
        VisibleCluster& found = clusters_[unclear.place];
        const ClusteredMesh& mesh = *frame_->objects()[found.object].mesh;
        PatchReader::open(mesh, found.cluster, *patch_);
        const ClusterBox bound = mesh.clusters().size() > 1 ? mesh.box_of(found.cluster) : mesh.bound();
        found.triangles &= ask_patch(picture_, frame_->data_of(found.object), {*patch_, bound, unclear.projection});
    }
}

void StripWalk::list_whole(std::uint32_t object, std::uint32_t cluster) {
    untested_.push_back(all_of(*frame_->objects()[object].mesh, object, cluster));
}

void StripWalk::count(std::uint64_t work, const Projection& box) {
    const bool counts = box.x0 >= picture_.tiles.first_x && box.x0 <= picture_.tiles.last_x;
    if (counts) work_->done.fetch_add(work, std::memory_order_relaxed);
}

}  // namespace crofton::depth
