// SPDX-License-Identifier: MIT
// How two boxes touch: the face or the pair of edges that separates them best.
#include <algorithm>
#include <cmath>

#include "box_pair.hpp"

namespace crofton::convex {
namespace {

// As deep as the least axis, for a face that nothing speaks for but its depth: of the size.
constexpr double kSameFace = 0.25e-9;

// Of two degrees, and what a pose's edges are off by.
constexpr double kParallelSine2 = 1.2181e-3;

class BoxToucher {
  public:
    BoxToucher(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin, Touch& touch,
               GatheredPoints& points)
        : a_(a), b_(b), pair_(pair), axes_(pair), margin_(margin), touch_(touch), points_(points) {
        rounding_ = a.shape.radius() + b.shape.radius();
    }

    // The answer, and for the cache whose face of which number the touch is at: 0 where it is at edges.
    [[nodiscard]] Warm ask(int& reference, int& face);
    [[nodiscard]] glm::dvec3 separating_normal() const { return axes_.normal(least_.number); }
    // Whether exact sums have told that boxes without rounding meet.
    [[nodiscard]] bool surely_meets() const { return surely_meets_; }
    // Of boxes that do: what is above the face by no more than counts as the same face touches it.
    void lower_points() {
        for (int i = 0; i < points_.count; ++i)
            if (double& depth = points_.point[i].depth; depth < 0.0 && depth >= -kSameFace * pair_.size) depth = 0.0;
    }

  private:
    // Of boxes nearer to a touch than rounding tells: as they are exactly.
    [[nodiscard]] Warm decide();

    // Whether the cached face is proven to be the least deep but for kKeptDepth, looking along no other axis.
    [[nodiscard]] Warm stays(bool of_a, int face, double limit);
    // Where the boxes touch at a face, of this extent. False if nothing above the face is as deep, but for `kept`: then
    // the nearest points lie elsewhere.
    [[nodiscard]] bool at_face(bool of_a, int face, double extent, double kept) {
        touch_.normal = axes_.normal((of_a ? 0 : 3) + face / 2);
        return at_face(BoxClip(a_, b_, axes_, of_a, face, touch_.normal), of_a, face, extent, kept);
    }
    [[nodiscard]] bool at_face(const BoxClip& clip, bool of_a, int face, double extent, double kept);
    // At the crossing of two edges. False if the boxes are apart and other points are nearer.
    [[nodiscard]] bool at_edges();
    void add_deepest(const glm::dvec3& on_a, const glm::dvec3& on_b, Feature feature_a, Feature feature_b);
    // The corner of a or b that is farthest into the other, around a's origin.
    [[nodiscard]] glm::dvec3 deepest_corner(bool of_a, int& corner) const;

    const ShapeAtPose &a_, &b_;
    const Pair& pair_;
    BoxPair axes_;
    BoxAxis least_;
    double margin_, rounding_, above_ = 0.0;
    bool surely_meets_ = false;
    Touch& touch_;
    GatheredPoints& points_;
};

glm::dvec3 BoxToucher::deepest_corner(bool of_a, int& corner) const {
    const ShapeAtPose& box = of_a ? a_ : b_;
    const Support s = core_support(box.shape, Pair::local(box.pose.rotation, of_a ? touch_.normal : -touch_.normal));
    corner = s.vertex;
    return box.pose.rotation * s.point + (of_a ? glm::dvec3(0.0) : pair_.offset);
}

void BoxToucher::add_deepest(const glm::dvec3& on_a, const glm::dvec3& on_b, Feature feature_a, Feature feature_b) {
    touch_.on_a = on_a;
    touch_.on_b = on_b;
    touch_.feature_a = feature_a;
    touch_.feature_b = feature_b;
    touch_.known = true;
    Gatherer gatherer({a_.pose.translation, a_.shape.radius(), b_.shape.radius(), margin_, pair_.size}, touch_,
                      points_);
    if (gatherer.lacks_deepest(1e-9 * pair_.size)) gatherer.add_deepest();
}

bool BoxToucher::at_face(const BoxClip& clip, bool of_a, int face, double extent, double kept) {
    const double least = extent - clip.deepest();
    touch_.depth = extent + rounding_;
    if (least <= kSameFace * pair_.size) {
        clip.gather(touch_, margin_, points_);
        return points_.count > 0;  // none where rounding tells of more than the margin
    }
    // The deepest corner itself may be of another face than the one that was clipped.
    int corner = 0;
    const glm::dvec3 x = deepest_corner(!of_a, corner);
    if (clip.corner_within(corner) >= above_) {
        clip.gather(touch_, margin_, points_);
        const Feature self{FeatureKind::face, static_cast<std::uint16_t>(face)},
            other{FeatureKind::vertex, static_cast<std::uint16_t>(corner)};
        add_deepest(of_a ? x + extent * touch_.normal : x, of_a ? x : x - extent * touch_.normal, of_a ? self : other,
                    of_a ? other : self);
        return true;
    }
    if (!(least <= kept)) return false;
    touch_.depth -= std::max(0.0, least);
    clip.gather(touch_, margin_, points_);
    return points_.count > 0;
}

bool BoxToucher::at_edges() {
    const int i = (least_.number - 6) / 3, j = (least_.number - 6) % 3;
    touch_.normal = axes_.normal(least_.number);
    touch_.depth = least_.extent + rounding_;
    int corner_a = 0, corner_b = 0;
    const glm::dvec3 &u = a_.pose.rotation[i], &v = b_.pose.rotation[j];
    const double half_a = a_.shape.half_extents()[i], half_b = b_.shape.half_extents()[j];
    // The middles of the edges that face each other, and where the edges cross, seen along the axis.
    const glm::dvec3 end_a = deepest_corner(true, corner_a), end_b = deepest_corner(false, corner_b);
    const glm::dvec3 from_a = end_a - ((corner_a >> i & 1) != 0 ? half_a : -half_a) * u,
                     from_b = end_b - ((corner_b >> j & 1) != 0 ? half_b : -half_b) * v;
    const glm::dvec3 across = glm::cross(u, v), between = from_b - from_a;
    const double squared = glm::dot(across, across);
    // Rounded edges that are nearly parallel touch along a stretch, not where they cross.
    if (rounding_ > 0.0 && squared <= kParallelSine2) return false;
    const double s = glm::dot(glm::cross(between, v), across) / squared,
                 t = glm::dot(glm::cross(between, u), across) / squared;
    if (least_.extent < 0.0 && !(std::abs(s) <= half_a && std::abs(t) <= half_b)) return false;
    // Faces nearly along the normal touch as well: the reference is the one that looks along it more.
    const glm::dvec3 facing_a = glm::abs(Pair::local(a_.pose.rotation, touch_.normal)),
                     facing_b = glm::abs(Pair::local(b_.pose.rotation, touch_.normal));
    const double most_a = std::max(facing_a.x, std::max(facing_a.y, facing_a.z)),
                 most_b = std::max(facing_b.x, std::max(facing_b.y, facing_b.z));
    const bool of_a = most_a >= most_b - 1e-3;
    const int face = face_along((of_a ? a_ : b_).shape,
                                Pair::local((of_a ? a_ : b_).pose.rotation, of_a ? touch_.normal : -touch_.normal));
    BoxClip(a_, b_, axes_, of_a, face, touch_.normal).gather(touch_, margin_, points_);
    const int on_a = corner_a & ~(1 << i), on_b = corner_b & ~(1 << j);
    add_deepest(from_a + std::min(std::max(s, -half_a), half_a) * u,
                from_b + std::min(std::max(t, -half_b), half_b) * v, {FeatureKind::edge, box_edge(on_a, on_a | 1 << i)},
                {FeatureKind::edge, box_edge(on_b, on_b | 1 << j)});
    return true;
}

Warm BoxToucher::stays(bool of_a, int face, double limit) {
    least_ = axes_.look_along((of_a ? 0 : 3) + face / 2);
    const double extent = least_.extent;
    if (extent < limit) return Warm::apart;
    // A box may have passed to the face's other side.
    if (!(std::abs(extent) > axes_.error()) || face != axes_.face_towards_other(least_.number)) return Warm::unknown;
    touch_.normal = axes_.normal(least_.number);
    const BoxClip clip(a_, b_, axes_, of_a, face, touch_.normal);
    const double kept = kKeptDepth * pair_.size;
    if (!clip.proves_least(extent, kept)) return Warm::unknown;
    return at_face(clip, of_a, face, extent, kept) ? Warm::touching : Warm::unknown;
}

// The difference body holds an octant of space at each of its corners. So boxes that no axis parts by more than
// rounding are no farther apart than its square root of 3 times. Points within it of a face's rim are above the face.
Warm BoxToucher::decide() {
    if (rounding_ > 0.0) return Warm::touching;
    const std::optional<bool> meet = axes_.meet_exactly();
    if (!meet) return Warm::unknown;
    surely_meets_ = *meet;
    if (!*meet && margin_ == 0.0) return Warm::apart;
    least_.extent = *meet ? std::max(0.0, least_.extent) : std::min(0.0, least_.extent);
    above_ = -axes_.error();
    if (*meet) margin_ = std::max(margin_, kSameFace * pair_.size);
    return Warm::touching;
}

Warm BoxToucher::ask(int& reference, int& face) {
    const double limit = -(rounding_ + margin_) - axes_.error() - pair_.doubt();
    // Of boxes that are not turned all axes take less than the proof.
    if (reference != 0 && !axes_.is_straight()) {
        if (const Warm warm = stays(reference == 1, face, limit); warm != Warm::unknown) return warm;
        points_.count = 0;
    }
    least_ = axes_.least(limit);
    if (std::isnan(least_.extent)) return Warm::unknown;
    if (least_.extent < limit) return Warm::apart;
    const double kept = kKeptDepth * pair_.size;
    // Another axis may be less deep by kSameDepth of the size, and a sliver beside it by its width.
    const bool sure = std::abs(least_.extent) > axes_.error() + kSameDepth * pair_.size + axes_.sliver_width();
    if (reference != 0 && sure) {
        // Thin boxes may have passed to the face's other side, or be apart while the face is not left.
        const double extent = axes_.face_extent(reference == 1, face);
        const bool faces = face == axes_.face_towards_other((reference == 1 ? 0 : 3) + face / 2),
                   same_side = (extent > 0.0) == (least_.extent > 0.0);
        if (faces && same_side && extent + axes_.sliver_width() <= least_.extent + kept &&
            at_face(reference == 1, face, extent, kept))
            return Warm::touching;
    }
    if (axes_.sliver_width() > 0.1 * kSameFace * pair_.size || !sure) axes_.try_slivers(least_);
    if (least_.extent < limit) return Warm::apart;
    if (std::abs(least_.extent) <= axes_.error())
        if (const Warm decided = decide(); decided != Warm::touching) return decided;
    if (least_.number >= 6) {
        reference = 0;
        return at_edges() ? Warm::touching : Warm::unknown;
    }
    reference = least_.number < 3 ? 1 : 2;
    face = axes_.face_towards_other(least_.number);
    return at_face(reference == 1, face, least_.extent, kSameFace * pair_.size) ? Warm::touching : Warm::unknown;
}

}  // namespace

Warm touch_of_boxes(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin, PairCache* cache,
                    Touch& touch, GatheredPoints& points) {
    if (!(pair.size < std::numeric_limits<double>::infinity())) return Warm::unknown;
    const double limit = -(pair.rounding() + margin + pair.doubt());
    if (cache != nullptr && cache->reference == 0 && cache->axis != glm::dvec3(0.0) &&
        pair.extent(cache->axis) < limit * (1.0 + 0x1p-50) - pair.error)
        return Warm::apart;
    int reference = cache != nullptr && cache->face < 6 ? cache->reference : 0;
    int face = reference != 0 ? cache->face : 0;
    BoxToucher toucher(a, b, pair, margin, touch, points);
    const Warm answer = toucher.ask(reference, face);
    if (toucher.surely_meets()) toucher.lower_points();
    // Another axis may be less deep by kSameDepth of the size, and leave the boxes farther apart than the margin.
    const double least_depth = -margin + kSameDepth * pair.size;
    const bool too_far = !toucher.surely_meets() && !(touch.depth >= least_depth);
    const bool doubtful = pair.doubt() > 0.0 && std::abs(touch.depth) <= pair.doubt() + kSameDepth * pair.size;
    if (answer == Warm::touching && doubtful) return Warm::unknown;
    if (answer == Warm::unknown || (answer == Warm::touching && too_far)) return Warm::unknown;
    if (cache != nullptr) {
        cache->axis = answer == Warm::apart ? toucher.separating_normal() : touch.normal;
        cache->reference = static_cast<std::uint16_t>(answer == Warm::apart ? 0 : reference);
        cache->face = static_cast<std::uint16_t>(face);
    }
    return answer;
}

}  // namespace crofton::convex
