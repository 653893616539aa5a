// SPDX-License-Identifier: MIT
#include "receiver_mask.hpp"

#include <algorithm>
#include <bit>
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
ClusterBox box_of(const std::array<glm::dvec3, 3>& corners) {
    ClusterBox box;
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

// Pixels, and nearness.
glm::dvec3 place_of(const PictureData& picture, const std::array<double, 4>& clip) {
    return {clip[0] / clip[3] * double{picture.half_width} + double{picture.middle_x},
            clip[1] / clip[3] * double{picture.half_height} + double{picture.middle_y}, clip[2] / clip[3]};
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

void ReceiverMask::find(const SeenPicture& seen, const DepthReceivers& receivers, const PictureView& map) {
    begin(seen, receivers, map);
    std::span<const VisibleCluster> clusters = seen.clusters;
    for (const SeenObject& object : seen.objects) {
        if (everything_) return;
        std::size_t count = 0;
        while (count < clusters.size() && clusters[count].object == object.object) ++count;
        add_object(receivers.objects[object.object], object, clusters.first(count));
        clusters = clusters.subspan(count);
    }
}

void ReceiverMask::begin(const SeenPicture& seen, const DepthReceivers& receivers, const PictureView& map) {
    if (!patch_) patch_ = Owner<Patch>::make();
    strips_ = seen.strips;
    picture_ = seen.picture;
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

void ReceiverMask::add_object(const DepthReceiver& receiver, const SeenObject& seen,
                              std::span<const VisibleCluster> clusters) {
    const ClusteredMesh& mesh = *receiver.mesh;
    in_picture_ = seen.in_picture;
    add_interpolation_error(in_picture_, mesh.largest());
    in_map_ = {};
    for (glm::length_t i = 0; i < 4; ++i) {
        const float share = i == 0 ? widened_.x : i == 1 ? widened_.y : i == 2 ? map_.z_sign : 1.0f;
        for (glm::length_t c = 0; c < 4; ++c) in_map_.columns[c][i] = share * receiver.to_map[c][i];
        for (int c = 0; c < 3; ++c) in_map_.moved[i] += std::abs(in_map_.columns[c][i]);
        in_map_.moved[i] *= seen.position_error;
    }
    add_interpolation_error(in_map_, mesh.largest());
    if (!(seen.position_error >= 0.0f) || !can_be_placed(in_map_)) return mark_everything();
    if (!receiver.solid) return add_clusters(mesh, clusters);
    boxes_.assign(1, mesh.bound());
    project_into_map();
    if (!map_projections_[0].is_unclear() || !is_before_light(boxes_[0])) mark(map_projections_[0]);
}

void ReceiverMask::add_clusters(const ClusteredMesh& mesh, std::span<const VisibleCluster> clusters) {
    boxes_.clear();
    for (const VisibleCluster& c : clusters) boxes_.push_back(mesh.box_of(c.cluster));
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
    PatchReader::read(mesh, cluster.cluster, *patch_);
    for (std::uint64_t left = cluster.triangles; left != 0; left &= left - 1) {
        const auto t = static_cast<std::uint32_t>(std::countr_zero(left));
        Piece& piece = pieces_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) piece.corners[k] = patch_->vertex(patch_->corner(t, k));
    }
}

// Level by level; each halves what is left.
void ReceiverMask::add_pieces() {
    for (std::uint32_t level = 0; !pieces_.empty() && !everything_; ++level) {
        boxes_.clear();
        for (const Piece& piece : pieces_) boxes_.push_back(box_of(piece.corners));
        project_into_map();
        picture_projections_.resize(boxes_.size() + kTile);
        project_boxes(picture_, in_picture_, whole(picture_), boxes_.data(), boxes_.size(),
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
            if (!ends && splits_left_ > 0) {
                const PictureTriangle placed = triangle_in_picture(pieces_[i]);
                if (in_map.is_unclear() || is_worth_splitting(placed, in_picture)) {
                    split(pieces_[i], placed, in_picture, level);
                    continue;
                }
            }
            if (in_map.is_unclear())
                mark_everything();
            else
                mark_triangle(pieces_[i], boxes_[i], in_map);
        }
        std::swap(pieces_, next_);
    }
}

ReceiverMask::PictureTriangle ReceiverMask::triangle_in_picture(const Piece& piece) const {
    PictureTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 4> clip = clip_of(in_picture_, piece.corners[k]);
        t.before_eye = t.before_eye && clip[3] > 0.0;
        t.corners[k] = place_of(picture_, clip);
    }
    return t;
}

// True if more than half of the piece seems to be outside the picture or hidden, by some of its pixels. It decides what
// is worth the time: a piece that is not split is marked as it is.
bool ReceiverMask::is_worth_splitting(const PictureTriangle& piece, const Projection& in_picture) const {
    if (!piece.before_eye || strips_.empty()) return true;
    constexpr int kDistance = 32, kMostSteps = 8;
    const int size = std::max(in_picture.x1 - in_picture.x0, in_picture.y1 - in_picture.y0);
    const int steps = std::clamp(size / kDistance, 2, kMostSteps), all = steps * (steps + 1) / 2;
    const glm::dvec3 &from = piece.corners[0], a = piece.corners[1] - from, b = piece.corners[2] - from;
    const double area = a.x * b.y - a.y * b.x;
    if (area == 0.0) return true;
    const double across = (a.z * b.y - a.y * b.z) / area, up = (a.x * b.z - a.z * b.x) / area;
    const auto width = static_cast<double>(picture_.tiles.width), height = static_cast<double>(picture_.tiles.height);
    const auto is_lost = [&](double u, double v) {
        const double x = from.x + u * a.x + v * b.x, y = from.y + u * a.y + v * b.y;
        if (!(x >= 0.0 && x < width && y >= 0.0 && y < height)) return true;
        const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
        // At the pixel's middle, so that a surface does not hide itself.
        const double z = from.z + (column + 0.5 - from.x) * across + (row + 0.5 - from.y) * up;
        return double{nearness(column, row)} > z;
    };
    int asked = 0, lost = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; i + j < steps; ++j) {
            ++asked;
            lost += is_lost((i + 1.0 / 3.0) / steps, (j + 1.0 / 3.0) / steps);
            if (2 * lost > all) return true;
            if (2 * (asked - lost) >= all) return false;
        }
    return false;
}

void ReceiverMask::split(const Piece& piece, const PictureTriangle& placed, const Projection& in_picture,
                         std::uint32_t level) {
    --splits_left_;
    Piece part = piece;
    if (level == 0) {
        part.nearest = in_picture.nearest;
        part.slope = slope_of(picture_, in_picture_, piece.corners);
    }
    // The longest edge in the picture; where a corner is behind the eye, in space.
    std::size_t from = 0;
    double longest = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t n = (k + 1) % 3;
        const double length = placed.before_eye
                                  ? glm::distance(glm::dvec2(placed.corners[k]), glm::dvec2(placed.corners[n]))
                                  : glm::distance(piece.corners[k], piece.corners[n]);
        if (length > longest) from = k, longest = length;
    }
    const std::size_t to = (from + 1) % 3;
    const glm::dvec3 middle = 0.5 * (piece.corners[from] + piece.corners[to]);
    for (const std::size_t replaced : {from, to}) {
        part.corners = piece.corners;
        part.corners[replaced] = middle;
        next_.push_back(part);
    }
}

void ReceiverMask::project_into_map() {
    map_projections_.resize(boxes_.size() + kTile);
    project_boxes(map_, in_map_, whole(map_), boxes_.data(), boxes_.size(), map_projections_.data());
}

bool ReceiverMask::is_before_light(const ClusterBox& box) const {
    PictureData map = map_;
    map.near_share = true_near_share_;
    ObjectData object = in_map_;
    for (auto& column : object.columns) column[2] = -column[2];
    Projection projections[1 + kTile];
    project_boxes(map, object, whole(map), &box, 1, projections);
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

float ReceiverMask::nearness(std::uint32_t x, std::uint32_t y) const {
    for (const StripWalk& strip : strips_)
        if (strip.has_column(x / kTile)) return strip.nearness(x, y);
    return kNothing;
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
void ReceiverMask::mark_triangle(const Piece& piece, const ClusterBox& box, const Projection& in_map) {
    const bool marked =
        mark_rows(triangle_in_map(piece, box), in_map.y0 / kTile, in_map.y1 / kTile, map_.tiles.width, floors_.data());
    empty_ = empty_ && !marked;
}

MapTriangle ReceiverMask::triangle_in_map(const Piece& piece, const ClusterBox& box) const {
    MapTriangle t{};
    double least_w = std::numeric_limits<double>::infinity(), deepest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 4> clip = clip_of(in_map_, piece.corners[k]);
        const glm::dvec3 place = place_of(map_, clip);
        t.x[k] = place.x, t.y[k] = place.y, t.z[k] = place.z;
        least_w = std::min(least_w, clip[3]);
        deepest = std::max(deepest, std::abs(place.z));
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t n = (k + 1) % 3;
        const double up = t.y[n] - t.y[k];
        t.x_per_row[k] = up != 0.0 ? (t.x[n] - t.x[k]) / up : 0.0;
        t.z_per_row[k] = up != 0.0 ? (t.z[n] - t.z[k]) / up : 0.0;
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
