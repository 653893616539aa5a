// SPDX-License-Identifier: MIT
#include "receiver_mask.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace crofton::depth {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Triangles and parts of them that one call may split: beyond it, what is left is marked as it is.
constexpr std::size_t kMaxSplits = std::size_t{1} << 14;
constexpr std::uint32_t kMaxLevel = 28;
// The same for parts whose place in the map is not known, because the light is among them.
constexpr std::uint32_t kMaxUnclearLevel = 12;
// Parts that are so small are split no further: as a share of the map, and in pixels of the camera's picture.
constexpr std::uint32_t kCoarseShare = 32;
constexpr std::int32_t kFewPixels = 16;
// The largest error, in pixels, of a box whose place is known (kMaxPixelError of the kernels).
constexpr float kMaxPixelError = 0.25f;

Projection whole(const PictureData& picture) {
    return {0,         static_cast<std::uint16_t>(picture.tiles.width - 1),
            0,         static_cast<std::uint16_t>(picture.tiles.height - 1),
            kInfinity, 0.0f};
}

// A triangle as a box: a flat one, of twice its area.
Cluster box_of(const std::array<glm::dvec3, 3>& corners) {
    Cluster box;
    box.center = glm::vec3(0.5 * (corners[1] + corners[2]));
    box.half_edges[0] = glm::vec3(0.5 * (corners[1] - corners[0]));
    box.half_edges[1] = glm::vec3(0.5 * (corners[2] - corners[0]));
    return box;
}

// Adds what rounding may move a point by that is computed from a mesh's vertices: 8 · 2^-24 of the largest terms.
void add_interpolation_error(ObjectData& object, const glm::vec3& largest) {
    for (int i = 0; i < 4; ++i)
        object.moved[i] += 0x1.00002p-21f *
                           ((std::abs(object.columns[0][i]) * largest.x + std::abs(object.columns[1][i]) * largest.y) +
                            (std::abs(object.columns[2][i]) * largest.z + std::abs(object.columns[3][i])));
}

bool can_be_placed(const ObjectData& object) {
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 4; ++c) sum += std::abs(object.columns[c][i]);
    return sum + object.moved[0] + object.moved[1] + object.moved[2] + object.moved[3] < 1e30f;
}

// At most so wide and so high.
bool is_within(const Projection& p, std::int32_t samples) {
    return p.x1 - p.x0 < samples && p.y1 - p.y0 < samples;
}

// Homogeneous, in double.
std::array<double, 4> clip_of(const ObjectData& object, const glm::dvec3& point) {
    std::array<double, 4> clip;
    for (std::size_t i = 0; i < 4; ++i)
        clip[i] = double{object.columns[0][i]} * point.x + double{object.columns[1][i]} * point.y +
                  (double{object.columns[2][i]} * point.z + double{object.columns[3][i]});
    return clip;
}

// The edge from corner k to the next, that is the longest in the picture; where a corner is behind the eye, in space.
std::size_t longest_edge(const PictureData& picture, const ObjectData& object,
                         const std::array<glm::dvec3, 3>& corners) {
    std::array<glm::dvec2, 3> places;
    bool before = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 4> clip = clip_of(object, corners[k]);
        before = before && clip[3] > 0.0;
        places[k] = {clip[0] / clip[3] * double{picture.half_width}, clip[1] / clip[3] * double{picture.half_height}};
    }
    std::size_t longest = 0;
    double most = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t n = (k + 1) % 3;
        const double length = before ? glm::distance(places[k], places[n]) : glm::distance(corners[k], corners[n]);
        if (length > most) longest = k, most = length;
    }
    return longest;
}

// How much the nearness of a triangle's plane changes from pixel to pixel, |across| + |up|; infinity if that is not
// known. Planes: docs/notes/depth.md, "Near the eye".
float slope_of(const PictureData& picture, const ObjectData& object, const std::array<glm::dvec3, 3>& corners) {
    std::array<glm::dvec3, 3> points;  // pixels · w, and w
    std::array<double, 3> depths, lengths;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 4> clip = clip_of(object, corners[k]);
        points[k] = {clip[0] * double{picture.half_width}, clip[1] * double{picture.half_height}, clip[3]};
        depths[k] = clip[2];
        lengths[k] = glm::length(points[k]);
    }
    // Products of three numbers each, of doubles that are off by 2^-50 of their terms.
    constexpr double kRounding = 0x1p-44;
    const double determinant = glm::dot(points[0], glm::cross(points[1], points[2]));
    double across = 0.0, up = 0.0, terms = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        const glm::dvec3 line = glm::cross(points[next], points[last]);
        across += depths[k] * line.x, up += depths[k] * line.y;
        terms += std::abs(depths[k]) * lengths[next] * lengths[last];
    }
    const double least = std::abs(determinant) - kRounding * lengths[0] * lengths[1] * lengths[2];
    const double slope = (std::abs(across) + std::abs(up) + kRounding * terms) / least;
    return least > 0.0 && slope < 1e30 ? static_cast<float>(slope * (1.0 + 0x1p-20)) : kInfinity;
}

}  // namespace

void ReceiverMask::find(const SeenPicture& seen, const ShadowReceivers& receivers, const PictureView& map) {
    begin(seen, receivers, map);
    for (std::size_t i = 0; i < seen.clusters.size() && !everything_;) {
        const std::uint32_t object = seen.clusters[i].object;
        std::size_t end = i;
        while (end < seen.clusters.size() && seen.clusters[end].object == object) ++end;
        const DepthObject& drawn = seen.frame.objects()[object];
        in_picture_ = seen.frame.data_of(object);
        add_interpolation_error(in_picture_, drawn.mesh->layout().largest);
        add_object(receivers.objects[object], drawn, seen.clusters.subspan(i, end - i));
        i = end;
    }
}

void ReceiverMask::begin(const SeenPicture& seen, const ShadowReceivers& receivers, const PictureView& map) {
    strips_ = seen.strips;
    picture_ = seen.frame.picture();
    // Other samples are less than a pixel away.
    if (strips_.empty()) picture_.grid += 1.0f;
    const auto size = static_cast<float>(std::max(map.width, map.height));
    // A texel's place is rounded three times in float, here too, and to 1/256 by the sampler.
    const float reach = receivers.radius + 0x1p-8f + 0x1p-20f * size;
    map_ = {};
    map_.tiles.width = map.width, map_.tiles.height = map.height;
    map_.middle_x = 0.5f * static_cast<float>(map.width), map_.middle_y = 0.5f * static_cast<float>(map.height);
    // The sides of the clip volume are farther apart by the reach, and pixels stay what they are.
    map_.half_width = map_.middle_x + reach, map_.half_height = map_.middle_y + reach;
    widened_ = {map_.middle_x / map_.half_width, map_.middle_y / map_.half_height};
    map_.grid = 0.5f * reach;  // boxes keep twice that
    // Nearness is negated, and limited nowhere.
    map_.near_share = 0x1p60f;
    map_.z_sign = map.depth == DepthRange::reversed_zero_to_one ? -1.0f : 1.0f;
    true_near_share_ = map.depth == DepthRange::zero_to_one ? 0.0f : 1.0f;
    columns_ = (map.width + kTile - 1) / kTile;
    const std::uint32_t rows = (map.height + kTile - 1) / kTile;
    floors_.assign(std::size_t{columns_} * rows, kInfinity);
    // Two tiles each way, beside what lookups add.
    small_ = static_cast<std::int32_t>(2 * kTile) + static_cast<std::int32_t>(2.0f * reach);
    coarse_ = small_ + static_cast<std::int32_t>(std::max(map.width, map.height) / kCoarseShare);
    splits_left_ = kMaxSplits;
    everything_ = false;
    empty_ = true;
}

void ReceiverMask::add_object(const DepthReceiver& receiver, const DepthObject& drawn,
                              std::span<const VisibleCluster> clusters) {
    const ClusteredMesh& mesh = *drawn.mesh;
    in_map_ = {};
    for (glm::length_t i = 0; i < 4; ++i) {
        const float share = i == 0 ? widened_.x : i == 1 ? widened_.y : i == 2 ? map_.z_sign : 1.0f;
        for (glm::length_t c = 0; c < 4; ++c) in_map_.columns[c][i] = share * receiver.to_map[c][i];
        for (int c = 0; c < 3; ++c) in_map_.moved[i] += std::abs(in_map_.columns[c][i]);
        in_map_.moved[i] *= drawn.position_error;
    }
    add_interpolation_error(in_map_, mesh.layout().largest);
    if (!(drawn.position_error >= 0.0f) || !can_be_placed(in_map_)) return mark_everything();
    if (!receiver.solid) return add_clusters(mesh, clusters);
    boxes_.assign(1, mesh.bound());
    project_into_map();
    if (!map_projections_[0].is_unclear() || !is_before_light(boxes_[0])) mark(map_projections_[0]);
}

void ReceiverMask::add_clusters(const ClusteredMesh& mesh, std::span<const VisibleCluster> clusters) {
    boxes_.clear();
    for (const VisibleCluster& c : clusters) boxes_.push_back(mesh.clusters()[c.cluster]);
    project_into_map();
    pieces_.clear();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        const Projection& p = map_projections_[i];
        if (p.covers_nothing()) continue;
        if (!p.is_unclear() && is_within(p, small_))
            mark(p);
        else
            add_triangles(mesh, clusters[i]);
    }
    add_pieces();
}

void ReceiverMask::add_triangles(const ClusteredMesh& mesh, const VisibleCluster& cluster) {
    const ClusteredMesh::Layout layout = mesh.layout();
    const ClusteredMesh::Patch& patch = layout.patches[cluster.cluster];
    const std::size_t padded =
        (patch.vertex_count + ClusteredMesh::kLanes - 1) / ClusteredMesh::kLanes * ClusteredMesh::kLanes;
    const float* const x = layout.coordinates.data() + patch.first_coordinate;
    for (std::uint32_t t = 0; t < patch.triangle_count; ++t) {
        if ((cluster.triangles >> t & 1) == 0) continue;
        const ClusteredMesh::Block& block = layout.blocks[patch.first_block + t / ClusteredMesh::kLanes];
        Piece& piece = pieces_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = block.corners[k][t % ClusteredMesh::kLanes];
            piece.corners[k] = {x[v], x[padded + v], x[2 * padded + v]};
        }
    }
}

// Level by level; each halves what is left.
void ReceiverMask::add_pieces() {
    for (std::uint32_t level = 0; !pieces_.empty() && !everything_; ++level) {
        boxes_.clear();
        for (const Piece& piece : pieces_) boxes_.push_back(box_of(piece.corners));
        project_into_map();
        picture_projections_.resize(boxes_.size() + kTile);
        project_clusters(picture_, in_picture_, whole(picture_), boxes_.data(), boxes_.size(),
                         picture_projections_.data());
        next_.clear();
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const Projection &in_map = map_projections_[i], &in_picture = picture_projections_[i];
            if (in_map.covers_nothing() || !is_seen(pieces_[i], in_picture)) continue;
            if (in_map.is_unclear() && is_before_light(boxes_[i])) continue;
            if (!in_map.is_unclear() && is_within(in_map, small_)) {
                mark(in_map);
                continue;
            }
            const bool ends = in_map.is_unclear() ? level >= kMaxUnclearLevel
                                                  : level >= kMaxLevel || is_within(in_picture, kFewPixels) ||
                                                        is_within(in_map, coarse_);
            if (!ends && splits_left_ > 0)
                split(pieces_[i], in_picture, level);
            else if (in_map.is_unclear())
                mark_everything();
            else
                mark_rows(pieces_[i], boxes_[i], in_map);
        }
        std::swap(pieces_, next_);
    }
}

void ReceiverMask::split(const Piece& piece, const Projection& in_picture, std::uint32_t level) {
    --splits_left_;
    Piece part = piece;
    if (level == 0) {
        part.nearest = in_picture.nearest;
        part.slope = slope_of(picture_, in_picture_, piece.corners);
    }
    const std::size_t from = longest_edge(picture_, in_picture_, piece.corners), to = (from + 1) % 3;
    const glm::dvec3 middle = 0.5 * (piece.corners[from] + piece.corners[to]);
    for (const std::size_t replaced : {from, to}) {
        part.corners = piece.corners;
        part.corners[replaced] = middle;
        next_.push_back(part);
    }
}

void ReceiverMask::project_into_map() {
    map_projections_.resize(boxes_.size() + kTile);
    project_clusters(map_, in_map_, whole(map_), boxes_.data(), boxes_.size(), map_projections_.data());
}

bool ReceiverMask::is_before_light(const Cluster& box) const {
    PictureData map = map_;
    map.near_share = true_near_share_;
    ObjectData object = in_map_;
    for (auto& column : object.columns) column[2] = -column[2];
    Projection projections[1 + kTile];
    project_clusters(map, object, whole(map), &box, 1, projections);
    return projections[0].covers_nothing();
}

// A renderer's depth at a sample is that of a point of the triangle within the grid of it, or of the plane at the
// sample: the slope over a few steps of the grid covers both, as for triangles that are tested.
bool ReceiverMask::is_seen(const Piece& piece, Projection p) const {
    if (p.covers_nothing()) return false;
    if (p.is_unclear() || strips_.empty()) return true;
    const float move = picture_.grid + kMaxPixelError;
    p.nearest = std::min(piece.nearest, p.nearest + 4.0f * move * piece.slope);
    return !std::all_of(strips_.begin(), strips_.end(), [&](const StripWalk& strip) { return strip.hides(p); });
}

void ReceiverMask::mark(const Projection& p) {
    if (p.covers_nothing()) return;
    if (p.is_unclear()) return mark_everything();
    empty_ = false;
    for (std::uint32_t ty = p.y0 / kTile; ty <= p.y1 / kTile; ++ty)
        for (std::uint32_t tx = p.x0 / kTile; tx <= p.x1 / kTile; ++tx) {
            float& floor = floors_[std::size_t{ty} * columns_ + tx];
            floor = std::min(floor, -p.nearest);
        }
}

// The triangle's part in each row of tiles, wider and higher by what lookups reach. Bounds are those of project().
void ReceiverMask::mark_rows(const Piece& piece, const Cluster& box, const Projection& in_map) {
    const MapTriangle t = triangle_in_map(piece, box);
    const auto size = static_cast<double>(map_.tiles.width);
    for (std::uint32_t ty = in_map.y0 / kTile; ty <= in_map.y1 / kTile; ++ty) {
        const double low = ty * double{kTile} + 0.5 - t.reach, high = low + (kTile - 1.0) + 2.0 * t.reach;
        double first = size, last = -1.0, farthest = -std::numeric_limits<double>::infinity();
        const auto include = [&](const glm::dvec3& end, const glm::dvec2& per_row) {
            // The end of the edge, or where it leaves the rows.
            const double up = std::clamp(end.y, low, high) - end.y;
            const double x = end.x + up * per_row.x;
            first = std::min(first, x), last = std::max(last, x);
            farthest = std::max(farthest, end.z + up * per_row.y);
        };
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 &a = t.corners[k], &b = t.corners[(k + 1) % 3];
            if (std::max(a.y, b.y) < low || std::min(a.y, b.y) > high) continue;
            include(a, t.per_row[k]);
            include(b, t.per_row[k]);
        }
        const double from = std::max(std::ceil(first - t.reach - 0.5), 0.0);
        const double to = std::min(std::floor(last + t.reach - 0.5), size - 1.0);
        if (!(from <= to)) continue;
        const auto floor = static_cast<float>(-farthest - t.depth_error);
        empty_ = false;
        float* const row = floors_.data() + std::size_t{ty} * columns_;
        for (auto tx = static_cast<std::uint32_t>(from) / kTile; tx <= static_cast<std::uint32_t>(to) / kTile; ++tx)
            row[tx] = std::min(row[tx], floor);
    }
}

ReceiverMask::MapTriangle ReceiverMask::triangle_in_map(const Piece& piece, const Cluster& box) const {
    MapTriangle t;
    double least_w = std::numeric_limits<double>::infinity(), deepest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 4> clip = clip_of(in_map_, piece.corners[k]);
        t.corners[k] = {clip[0] / clip[3] * double{map_.half_width} + double{map_.middle_x},
                        clip[1] / clip[3] * double{map_.half_height} + double{map_.middle_y}, clip[2] / clip[3]};
        least_w = std::min(least_w, clip[3]);
        deepest = std::max(deepest, std::abs(t.corners[k].z));
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 edge = t.corners[(k + 1) % 3] - t.corners[k];
        t.per_row[k] = edge.y != 0.0 ? glm::dvec2(edge.x / edge.y, edge.z / edge.y) : glm::dvec2(0.0);
    }
    std::array<double, 4> errors;
    for (std::size_t i = 0; i < 4; ++i) {
        double terms = std::abs(double{in_map_.columns[3][i]});
        for (glm::length_t c = 0; c < 3; ++c) {
            double coordinate = std::abs(double{box.center[c]});
            for (const glm::vec3& edge : box.half_edges) coordinate += std::abs(double{edge[c]});
            terms += std::abs(double{in_map_.columns[c][i]}) * coordinate;
        }
        errors[i] = 0x1.00002p-21 * terms + double{in_map_.moved[i]};
    }
    const double w = least_w - 2.0 * errors[3];
    const double moved = std::max((errors[0] + 2.0 * errors[3]) * double{map_.half_width},
                                  (errors[1] + 2.0 * errors[3]) * double{map_.half_height}) /
                         w;
    t.reach = 2.0 * (double{map_.grid} + moved);
    t.depth_error = 2.0 * (errors[2] + deepest * errors[3]) / w + 0x1p-20 * deepest;
    return t;
}

void ReceiverMask::mark_everything() {
    std::fill(floors_.begin(), floors_.end(), kNothing);
    everything_ = true;
    empty_ = false;
}

}  // namespace crofton::depth
