// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "box_pair.hpp"

namespace crofton::convex {
namespace {

// As deep as the least axis, for a face that nothing speaks for but its depth: of the size.
constexpr double kSameFace = 0.25e-9;

class BoxToucher {
  public:
    BoxToucher(const Placed& a, const Placed& b, const Pair& pair, const BoxPair& axes, BoxTouchOf& found)
        : a_(a), b_(b), pair_(pair), axes_(axes), found_(found) {}

    // Where the boxes touch at a face, of this extent. False if nothing above the face is as deep, but for `kept`: then
    // the nearest points lie elsewhere.
    bool at_face(bool of_a, int face, double extent, double kept);
    // At the crossing of two edges. False if the boxes are apart and other points are nearer.
    bool at_edges(const BoxAxis& axis);

  private:
    // Clips the other box's face against that of the reference, along touch.normal.
    void clip_faces(bool reference_is_a, int face);
    [[nodiscard]] glm::dvec3 deepest_corner(bool of_a, int& corner) const;
    [[nodiscard]] int face_towards(const Placed& box, const glm::dvec3& direction, double& along) const;

    const Placed &a_, &b_;
    const Pair& pair_;
    const BoxPair& axes_;
    BoxTouchOf& found_;
};

void BoxToucher::clip_faces(bool reference_is_a, int face) {
    const Placed &reference = reference_is_a ? a_ : b_, &incident = reference_is_a ? b_ : a_;
    const glm::dvec3 out = reference_is_a ? found_.touch.normal : -found_.touch.normal;
    Patch patch;
    patch_along(incident, -out, a_.pose.translation, patch);
    if (reference_is_a)
        BoxFace(reference, face, axes_.world_to_a(), a_.pose.translation).clip(patch, out, found_.clipped);
    else
        BoxFace(reference, face, glm::inverse(b_.pose.rotation), a_.pose.translation).clip(patch, out, found_.clipped);
    found_.reference = reference_is_a ? 1 : 2;
}

// The corner of a or b that is farthest into the other, around a's origin.
glm::dvec3 BoxToucher::deepest_corner(bool of_a, int& corner) const {
    const Placed& box = of_a ? a_ : b_;
    const Support s =
        core_support(box.body, Pair::local(box.pose.rotation, of_a ? found_.touch.normal : -found_.touch.normal));
    corner = s.vertex;
    return box.pose.rotation * s.point + (of_a ? glm::dvec3(0.0) : pair_.offset);
}

bool BoxToucher::at_face(bool of_a, int face, double extent, double kept) {
    Touch& touch = found_.touch;
    touch.normal = axes_.normal((of_a ? 0 : 3) + face / 2);
    clip_faces(of_a, face);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < found_.clipped.count; ++i) {
        const ClippedPoint& p = found_.clipped.point[i];
        const glm::dvec3 &on_a = of_a ? p.on_reference : p.on_incident, &on_b = of_a ? p.on_incident : p.on_reference;
        const double above = extent - glm::dot(on_a - on_b, touch.normal);
        if (!(above < least)) continue;
        least = above;
        touch.on_a = on_a;
        touch.on_b = on_b;
        touch.feature_a = of_a ? p.reference : p.incident;
        touch.feature_b = of_a ? p.incident : p.reference;
    }
    touch.known = true;
    touch.depth = extent;
    if (least <= kSameFace * pair_.size) return true;
    // The deepest corner itself may be of another face than the one that was clipped.
    int corner = 0;
    const glm::dvec3 x = deepest_corner(!of_a, corner);
    const glm::dmat3 to_local = of_a ? axes_.world_to_a() : glm::inverse(b_.pose.rotation);
    if (BoxFace(of_a ? a_ : b_, face, to_local, a_.pose.translation).distance_within(x) >= 0.0) {
        const Feature self{FeatureKind::face, static_cast<std::uint16_t>(face)},
            other{FeatureKind::vertex, static_cast<std::uint16_t>(corner)};
        touch.on_a = of_a ? x + extent * touch.normal : x;
        touch.on_b = of_a ? x : x - extent * touch.normal;
        touch.feature_a = of_a ? self : other;
        touch.feature_b = of_a ? other : self;
        return true;
    }
    touch.depth -= least;
    return least <= kept;
}

int BoxToucher::face_towards(const Placed& box, const glm::dvec3& direction, double& along) const {
    const int face = face_along(box.body, Pair::local(box.pose.rotation, direction));
    along = std::abs(glm::dot(box.pose.rotation[face / 2], direction));
    return face;
}

bool BoxToucher::at_edges(const BoxAxis& axis) {
    Touch& touch = found_.touch;
    const int i = (axis.number - 6) / 3, j = (axis.number - 6) % 3;
    const glm::dvec3 n = touch.normal = axes_.normal(axis.number);
    // From the middle of an edge of one box along it to the edge of the other.
    int corner_a = 0, corner_b = 0;
    const glm::dvec3 &u = a_.pose.rotation[i], &v = b_.pose.rotation[j];
    const double half_a = a_.body.half_extents()[i], half_b = b_.body.half_extents()[j];
    const glm::dvec3 from_a = deepest_corner(true, corner_a) - ((corner_a >> i & 1) != 0 ? half_a : -half_a) * u,
                     from_b = deepest_corner(false, corner_b) - ((corner_b >> j & 1) != 0 ? half_b : -half_b) * v;
    const glm::dvec3 across = glm::cross(u, v), between = from_b - from_a;
    const double squared = glm::dot(across, across);
    const double s = glm::dot(glm::cross(between, v), across) / squared,
                 t = glm::dot(glm::cross(between, u), across) / squared;
    if (axis.extent < 0.0 && !(std::abs(s) <= half_a && std::abs(t) <= half_b)) return false;
    touch.on_a = from_a + std::min(std::max(s, -half_a), half_a) * u;
    touch.on_b = from_b + std::min(std::max(t, -half_b), half_b) * v;
    touch.depth = axis.extent;
    const int on_a = corner_a & ~(1 << i), on_b = corner_b & ~(1 << j);
    touch.feature_a = {FeatureKind::edge, box_edge(on_a, on_a | 1 << i)};
    touch.feature_b = {FeatureKind::edge, box_edge(on_b, on_b | 1 << j)};
    touch.known = true;
    // Faces nearly along the normal touch as well: the reference is the one that looks along it more.
    double along_a = 0.0, along_b = 0.0;
    const int face_a = face_towards(a_, n, along_a), face_b = face_towards(b_, -n, along_b);
    const bool reference_is_a = along_a >= along_b - 1e-3;
    clip_faces(reference_is_a, reference_is_a ? face_a : face_b);
    return true;
}

}  // namespace

Warm touch_of_boxes(const Placed& a, const Placed& b, const Pair& pair, double margin, PairCache* cache,
                    BoxTouchOf& found) {
    if (!(pair.size < std::numeric_limits<double>::infinity())) return Warm::unknown;
    const double rounding = a.body.radius() + b.body.radius(), limit = -(rounding + margin);
    if (cache != nullptr && cache->reference == 0 && cache->axis != glm::dvec3(0.0) &&
        pair.extent(cache->axis) < limit * (1.0 + 0x1p-50) - pair.error)
        return Warm::apart;
    BoxPair axes(pair);
    const BoxAxis least = axes.least(limit - axes.error());
    if (least.number < 0 || std::isnan(least.extent)) return Warm::unknown;
    if (least.extent < limit - axes.error()) {
        if (cache != nullptr) cache->axis = axes.normal(least.number), cache->reference = 0;
        return Warm::apart;
    }
    // Contacts nearer than rounding tells are decided exactly by the other way.
    if (std::abs(least.extent) <= axes.error()) return Warm::unknown;
    BoxToucher toucher(a, b, pair, axes, found);
    const double kept = kKeptDepth * pair.size;
    bool of_a = cache != nullptr && cache->reference == 1;
    int face = 0;
    bool touches = false;
    if (cache != nullptr && cache->reference != 0 && cache->face < 6) {
        face = cache->face;
        const double extent = axes.face_extent(of_a, face);
        touches = extent <= least.extent + kept && toucher.at_face(of_a, face, extent, kept);
    }
    bool has_face = touches;
    if (!touches && least.number < 6) {
        of_a = least.number < 3;
        face = axes.face_towards_other(least.number);
        touches = has_face = toucher.at_face(of_a, face, least.extent, kSameFace * pair.size);
    } else if (!touches) {
        touches = toucher.at_edges(least);
    }
    if (!touches) return Warm::unknown;
    found.touch.depth += rounding;
    if (!(found.touch.depth >= -margin)) return Warm::unknown;
    if (cache != nullptr) {
        cache->axis = found.touch.normal;
        cache->reference = static_cast<std::uint16_t>(!has_face ? 0 : of_a ? 1 : 2);
        cache->face = static_cast<std::uint16_t>(face);
    }
    return Warm::touching;
}

}  // namespace crofton::convex
