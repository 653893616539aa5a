// SPDX-License-Identifier: MIT
// Finds the casters that may throw a shadow onto a receiver in view, by pictures of the receivers' depths from the
// light.
#include <algorithm>
#include <cmath>
#include <crofton/cull/lights.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/moderate_length.hpp>
#include <glm/geometric.hpp>

#include "exact/box_constraints.hpp"

namespace crofton::cull {
namespace {

// Results in doubles are moved outwards by this share of the sizes that went into them. That is far more than their
// some twenty roundings of 2^-53.
constexpr double kOutward = 0x1p-40;

struct Interval {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    [[nodiscard]] bool is_empty() const { return !(low <= high); }
};

// A half-space in a face's frame: along · t + (what is linear in the picture) ≥ 0.
struct FacePlane {
    double across, up, along, offset;
};

// A convex body before a face: at most twelve planes, moved outwards.
struct FaceBody {
    FacePlane planes[Frustum::kMaxPlanes];
    std::uint32_t count = 0;

    void add(const glm::dvec3& normal, double offset, double size, const glm::dvec3 (&axes)[3]) {
        planes[count++] = {glm::dot(normal, axes[0]), glm::dot(normal, axes[1]), glm::dot(normal, axes[2]),
                           offset + kOutward * size};
    }
};

// A rectangle of a face's picture.
struct Rectangle2 {
    Interval side[2];
};

// A range that contains all depths at which rays through the rectangle may be inside the body.
Interval depths(const FaceBody& body, const Rectangle2& tile, bool is_sun) {
    Interval result;
    if (!is_sun) result.low = 0.0;
    for (std::uint32_t i = 0; i < body.count; ++i) {
        const FacePlane& plane = body.planes[i];
        const double across = std::max(plane.across * tile.side[0].low, plane.across * tile.side[0].high),
                     up = std::max(plane.up * tile.side[1].low, plane.up * tile.side[1].high);
        // Sun: t · along + most ≥ 0. Else t · most + offset ≥ 0, t ≥ 0.
        const double most = across + up + (is_sun ? plane.offset : plane.along);
        const double size = std::fabs(across) + std::fabs(up) + (is_sun ? std::fabs(plane.offset) : 1.0);
        const double most_and_error = most + kOutward * size;
        const double slope = is_sun ? plane.along : most_and_error, rest = is_sun ? most_and_error : plane.offset;
        if (slope > 0.0)
            result.low = std::max(result.low, -rest / slope - kOutward * std::fabs(rest / slope));
        else if (slope < 0.0)
            result.high = std::min(result.high, rest / -slope + kOutward * std::fabs(rest / slope));
        else if (rest < 0.0)
            return {1.0, 0.0};
    }
    return result;
}

// For points within `extent` of the face's origin.
FaceBody body_of(const Frustum& frustum, const glm::dvec3& origin, const glm::dvec3 (&axes)[3], double extent) {
    FaceBody body;
    const glm::dvec3 d = origin - frustum.origin;
    for (const Plane& plane : frustum.view()) {
        const double size = std::fabs(plane.normal.x * d.x) + std::fabs(plane.normal.y * d.y) +
                            std::fabs(plane.normal.z * d.z) + std::fabs(plane.offset) + extent;
        body.add(plane.normal, glm::dot(plane.normal, d) + plane.offset, size, axes);
    }
    return body;
}

// The box's faces; its axes are orthonormal to 1e-4 only, so normals are their products.
FaceBody body_of(const Obb& box, const glm::dvec3& origin, const glm::dvec3 (&axes)[3]) {
    FaceBody body;
    const glm::dvec3 d = origin - box.center;
    const double away = glm::length(d);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a(box.axes[(k + 1) % 3]), b(box.axes[(k + 2) % 3]);
        const glm::dvec3 normal = glm::cross(a, b);
        const double half = std::fabs(glm::dot(normal, half_edge(box, k)));
        for (const double side : {1.0, -1.0})
            body.add(side * normal, half + side * glm::dot(normal, d), 2.0 * (away + half), axes);
    }
    return body;
}

}  // namespace

// The work on one CasterFilter.
class ReceiverPass {
  public:
    explicit ReceiverPass(const CasterFilter& set) : set_(set) {}

    // The box's rectangle in a face's picture; all of it if the box reaches level with or behind the light.
    [[nodiscard]] Rectangle2 rectangle_of(const Obb& box, const CasterFilter::Face& face) const {
        Rectangle2 result{{{kFar, -kFar}, {kFar, -kFar}}};
        for (const glm::dvec3& corner : corners(box)) {
            const glm::dvec3 d = corner - set_.origin_;
            const double size = std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z) +
                                (set_.is_sun_ ? glm::length(box.center - set_.origin_) : 0.0);
            const double along = set_.is_sun_ ? 1.0 : glm::dot(d, face.axes[2]);
            if (!set_.is_sun_ && !(along > 1e-3 * size)) return {};
            for (int k = 0; k < 2; ++k) {
                const double at = glm::dot(d, face.axes[k]) / along, off = 4.0 * kOutward * size / along;
                result.side[k].low = std::min(result.side[k].low, at - off);
                result.side[k].high = std::max(result.side[k].high, at + off);
            }
        }
        return result;
    }

    struct Tiles {
        std::uint32_t first[2], last[2];  // last: one beyond
    };

    // The square of the least across² + up² in it: how far its rays are from the face's axis.
    static double from_axis(const Rectangle2& tile) {
        double result = 0.0;
        for (const Interval& side : tile.side) {
            const double least = std::max({0.0, side.low, -side.high});
            result += least * least;
        }
        return result;
    }
    // Whether the tile is lit and `depth` is within the light's range.
    [[nodiscard]] bool is_in_range(const Rectangle2& tile, double depth) const {
        if (set_.is_sun_) return true;
        const double square = from_axis(tile) * (1.0 - kOutward);
        if (set_.tangent_ > 0.0 && square > set_.tangent_ * set_.tangent_) return false;
        return depth * std::sqrt(1.0 + square) * (1.0 - kOutward) <= set_.range_;
    }
    [[nodiscard]] Rectangle2 tile_at(std::size_t at) const {
        const auto i = static_cast<std::uint32_t>(at % set_.tiles_),
                   j = static_cast<std::uint32_t>(at / set_.tiles_ % set_.tiles_);
        const auto f = at / set_.tiles_ / set_.tiles_;
        return rectangle_of(Tiles{{i, j}, {i + 1, j + 1}}, set_.faces_[f]);
    }

    [[nodiscard]] Tiles tiles_of(const Rectangle2& rectangle, const CasterFilter::Face& face) const {
        Tiles result{};
        for (int k = 0; k < 2; ++k) {
            const double most = set_.tiles_;
            const auto place = [&](double at) { return std::floor((at - face.low[k]) / face.size[k]); };
            const double low = place(rectangle.side[k].low) - kTileMargin,
                         high = place(rectangle.side[k].high) + kTileMargin;
            result.first[k] = static_cast<std::uint32_t>(std::min(most, std::max(0.0, low)));
            result.last[k] = static_cast<std::uint32_t>(std::min(most, std::max(0.0, high + 1.0)));
        }
        return result;
    }

    [[nodiscard]] Rectangle2 rectangle_of(const Tiles& tiles, const CasterFilter::Face& face) const {
        Rectangle2 result;
        for (int k = 0; k < 2; ++k) {
            const double low = face.low[k] + tiles.first[k] * face.size[k],
                         high = face.low[k] + tiles.last[k] * face.size[k];
            const double off = kOutward * (std::fabs(low) + std::fabs(high) + face.size[k]);
            result.side[k] = {low - off, high + off};
        }
        return result;
    }

    // visit(tile index, depths of the body in it) until it returns true.
    template <class Visit>
    bool visit_tiles(const Obb& box, std::uint32_t f, const Visit& visit) const {
        const CasterFilter::Face& face = set_.faces_[f];
        const FaceBody body = body_of(box, set_.origin_, face.axes);
        const Tiles tiles = tiles_of(rectangle_of(box, face), face);
        return visit_tiles(body, f, tiles, visit);
    }

    // Recurses by halves, so that tiles which the body does not meet cost little.
    template <class Visit>
    bool visit_tiles(const FaceBody& body, std::uint32_t f, Tiles tiles, const Visit& visit) const {
        if (tiles.first[0] >= tiles.last[0] || tiles.first[1] >= tiles.last[1]) return false;
        const Interval depth = depths(body, rectangle_of(tiles, set_.faces_[f]), set_.is_sun_);
        if (depth.is_empty()) return false;
        const std::uint32_t size[2] = {tiles.last[0] - tiles.first[0], tiles.last[1] - tiles.first[1]};
        if (size[0] == 1 && size[1] == 1)
            return visit((std::size_t{f} * set_.tiles_ + tiles.first[1]) * set_.tiles_ + tiles.first[0], depth);
        const int k = size[0] >= size[1] ? 0 : 1;
        Tiles other = tiles;
        tiles.last[k] = other.first[k] = tiles.first[k] + size[k] / 2;
        return visit_tiles(body, f, tiles, visit) || visit_tiles(body, f, other, visit);
    }

    static Result<void> start(CasterFilter& set, const Frustum& view, std::span<const Obb> receivers,
                              std::uint32_t tiles) {
        set.face_count_ = 0;
        set.tiles_ = tiles;
        set.tangent_ = 0.0;
        if (!is_usable(view)) return fail(ErrorCode::non_finite, kNoItem, "shadow receivers: the view is not finite");
        if (tiles == 0 || tiles > 1024)
            return fail(ErrorCode::out_of_range, kNoItem, "shadow receivers: 1 to 1024 tiles are needed");
        for (std::size_t i = 0; i < receivers.size(); ++i)
            if (auto valid = validate(receivers[i], i); !valid) return valid;
        return {};
    }

    // Faces, origin and range are set.
    static void fill(CasterFilter& set, const Frustum& view, std::span<const Obb> receivers) {
        const ReceiverPass pass(set);
        set.grid_.assign(std::size_t{set.face_count_} * set.tiles_ * set.tiles_, {});
        double extent = 0.0;
        for (const Obb& receiver : receivers)
            for (const glm::dvec3& corner : corners(receiver))
                extent = std::max(extent, glm::length(corner - set.origin_));
        for (std::uint32_t f = 0; f < set.face_count_; ++f) {
            const FaceBody seen = body_of(view, set.origin_, set.faces_[f].axes, extent);
            for (const Obb& receiver : receivers)
                pass.visit_tiles(receiver, f, [&](std::size_t at, Interval depth) {
                    const Rectangle2 rectangle = pass.tile_at(at);
                    const Interval view_depth = depths(seen, rectangle, set.is_sun_);
                    depth = {std::max(depth.low, view_depth.low), std::min(depth.high, view_depth.high)};
                    if (depth.is_empty() || !pass.is_in_range(rectangle, depth.low)) return false;
                    CasterFilter::Tile& tile = set.grid_[at];
                    tile.nearest = std::min(tile.nearest, depth.low);
                    tile.farthest = std::max(tile.farthest, depth.high);
                    return false;
                });
        }
    }

    static void add_cube(CasterFilter& set) {
        set.face_count_ = 6;
        for (int f = 0; f < 6; ++f) {
            CasterFilter::Face& face = set.faces_[f];
            for (int k = 0; k < 3; ++k) {
                face.axes[k] = glm::dvec3(0.0);
                face.axes[k][(f / 2 + 1 + k) % 3] = k == 2 && f % 2 ? -1.0 : 1.0;
            }
            set_picture(set, face, {{{-1.0, 1.0}, {-1.0, 1.0}}});
        }
    }

    // Slightly larger than `picture`.
    static void set_picture(const CasterFilter& set, CasterFilter::Face& face, const Rectangle2& picture) {
        for (int k = 0; k < 2; ++k) {
            const Interval& side = picture.side[k];
            const double more =
                0x1p-20 * (side.high - side.low) + kOutward * (std::fabs(side.low) + std::fabs(side.high)) + 1e-30;
            face.low[k] = side.low - more;
            face.size[k] = (side.high - side.low + 2.0 * more) / set.tiles_;
        }
    }

    static void set_axes(CasterFilter::Face& face, const glm::dvec3& along) {
        const glm::dvec3 w = glm::normalize(along), a = glm::abs(w);
        const glm::dvec3 other = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                                 : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                          : glm::dvec3(0, 0, 1);
        face.axes[0] = glm::normalize(glm::cross(other, w));
        face.axes[1] = glm::cross(w, face.axes[0]);
        face.axes[2] = w;
    }

  private:
    static constexpr double kFar = std::numeric_limits<double>::infinity(), kTileMargin = 0x1p-20;

    const CasterFilter& set_;
};

Result<void> CasterFilter::set_sun(const Frustum& view, std::span<const Obb> receivers, const glm::dvec3& toward_light,
                                   double shadow_length, std::uint32_t tiles) {
    if (auto valid = ReceiverPass::start(*this, view, receivers, tiles); !valid) return valid;
    if (!is_finite(toward_light) || toward_light == glm::dvec3(0.0) || !(shadow_length >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "shadow receivers: a direction that is finite and not zero and a length of at least 0 are needed");
    is_sun_ = true;
    origin_ = view.origin;
    range_ = shadow_length;
    ReceiverPass::set_axes(faces_[0], -of_moderate_length(toward_light));
    Rectangle2 picture{{{1e300, -1e300}, {1e300, -1e300}}};
    for (const Obb& receiver : receivers) {
        const Rectangle2 of = ReceiverPass(*this).rectangle_of(receiver, faces_[0]);
        for (int k = 0; k < 2; ++k) {
            picture.side[k].low = std::min(picture.side[k].low, of.side[k].low);
            picture.side[k].high = std::max(picture.side[k].high, of.side[k].high);
        }
    }
    if (receivers.empty()) return {};
    if (const auto seen = frustum_corners(view); seen)
        for (int k = 0; k < 2; ++k) {
            Interval side{1e300, -1e300};
            for (const glm::dvec3& corner : *seen) {
                const double at = glm::dot(corner, faces_[0].axes[k]), off = 0x1p-30 * glm::length(corner);
                side = {std::min(side.low, at - off), std::max(side.high, at + off)};
            }
            picture.side[k] = {std::max(picture.side[k].low, side.low), std::min(picture.side[k].high, side.high)};
            if (picture.side[k].is_empty()) return {};
        }
    face_count_ = 1;
    ReceiverPass::set_picture(*this, faces_[0], picture);
    ReceiverPass::fill(*this, view, receivers);
    return {};
}

Result<void> CasterFilter::set_point(const Frustum& view, std::span<const Obb> receivers, const Sphere& light,
                                     std::uint32_t tiles) {
    if (auto valid = ReceiverPass::start(*this, view, receivers, tiles); !valid) return valid;
    if (!is_usable(light))
        return fail(ErrorCode::invalid_argument, kNoItem, "shadow receivers: the light is not finite or negative");
    is_sun_ = false;
    origin_ = light.center;
    range_ = light.radius * (1.0 + kOutward);
    ReceiverPass::add_cube(*this);
    ReceiverPass::fill(*this, view, receivers);
    return {};
}

Result<void> CasterFilter::set_spot(const Frustum& view, std::span<const Obb> receivers, const SpotLight& light,
                                    std::uint32_t tiles) {
    const double cosine = static_cast<double>(light.cos_half_angle);
    const glm::dvec3 axis(light.axis);
    if (!(cosine >= 0.0 && cosine <= 1.0) || !is_finite(axis) || axis == glm::dvec3(0.0)) {
        face_count_ = 0;
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "shadow receivers: the spot's axis is zero or not finite, or its cosine outside [0, 1]");
    }
    if (auto valid = set_point(view, {}, {light.apex, static_cast<double>(light.range)}, tiles); !valid) return valid;
    if (auto valid = ReceiverPass::start(*this, view, receivers, tiles); !valid) return valid;
    if (cosine < 0.26) {
        ReceiverPass::add_cube(*this);
    } else {
        face_count_ = 1;
        ReceiverPass::set_axes(faces_[0], axis);
        const double edge = std::sqrt(1.0 - cosine * cosine) / cosine;
        tangent_ = edge * (1.0 + kOutward);
        ReceiverPass::set_picture(*this, faces_[0], {{{-edge, edge}, {-edge, edge}}});
    }
    ReceiverPass::fill(*this, view, receivers);
    return {};
}

bool CasterFilter::wants(const Obb& caster) const {
    if (!validate(caster)) return true;
    const ReceiverPass pass(*this);
    for (std::uint32_t f = 0; f < face_count_; ++f)
        if (pass.visit_tiles(caster, f, [&](std::size_t at, const Interval& depth) {
                const Tile& tile = grid_[at];
                if (!(depth.low <= tile.farthest)) return false;
                return is_sun_ ? depth.high + range_ >= tile.nearest : pass.is_in_range(pass.tile_at(at), depth.low);
            }))
            return true;
    return false;
}

void CasterFilter::find_casters(std::span<const Obb> casters, Vector<std::uint32_t>& wanted) const {
    wanted.clear();
    for (std::size_t i = 0; i < casters.size(); ++i)
        if (wants(casters[i])) wanted.push_back(static_cast<std::uint32_t>(i));
}

}  // namespace crofton::cull
