// SPDX-License-Identifier: MIT
#include "part_cast.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <glm/matrix.hpp>

#include "contacts_at.hpp"
#include "core_query.hpp"
#include "passage.hpp"

namespace crofton::convex {
namespace {

constexpr int kManyParts = 24;  // in a stretch of time that is then halved
constexpr int kMaxHalvings = 40;

// From the shape's origin to its pivot.
glm::dvec3 arm_of(const RigidTransform& pose, const Motion& motion) {
    return pose.rotation * motion.pivot;
}

// Seeks the first touch of b with a's parts. A stretch of time in which b passes near many parts is halved, so that
// those it meets last are not asked.
class PartCaster {
  public:
    PartCaster(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
               const CastOptions& options, const ContactsAt* slide, bool flipped)
        : a_(a), b_(b), motion_a_(motion_a), motion_b_(motion_b), options_(options), slide_(slide), flipped_(flipped) {
        best_.time = std::min(options.early_out, options.duration) + 0.0;
        const Aabb& bounds = b.shape.bounds();
        b_turns_ = motion_b.spin != glm::dvec3(0.0);
        pivot_ = b_turns_ || is_unbounded(b) ? motion_b.pivot : bounds.center();
        around_ = glm::length(bounds.half_extents()) + glm::length(bounds.center() - pivot_);
        apart_ = (b.pose.rotation * pivot_ - arm_of(a.pose, motion_a)) + (b.pose.translation - a.pose.translation);
    }

    void search(double from, double to) {
        if (passes_straight() && to > from && is_surface(a_.shape))
            search_surface(from, to);
        else
            search_box(from, to, 0);
    }

    [[nodiscard]] const Impact& best() const { return best_; }

  private:
    [[nodiscard]] static bool is_surface(const Shape& shape) {
        return shape.kind() == Kind::mesh || shape.kind() == Kind::height_field;
    }
    // Whether a convex b flies along a line, seen from a.
    [[nodiscard]] bool passes_straight() const {
        const glm::dvec3 velocity = motion_b_.velocity - motion_a_.velocity;
        const double squared = glm::dot(velocity, velocity);
        return !b_turns_ && motion_a_.spin == glm::dvec3(0.0) && squared > 1e-200 && squared < 1e200 &&
               b_.shape.is_convex() && !is_unbounded(b_);
    }
    [[nodiscard]] Passage passage_by(const ShapeAtPose& surface, double from, double to) const {
        const double rounding = 1e-13 * (around_ + surface.shape.core_radius());
        return {b_,   surface.pose, surface.shape.bounds(),       motion_b_.velocity - motion_a_.velocity,
                from, to,           options_.tolerance + rounding};
    }

    void search_surface(double from, double to) {
        const Passage passage = passage_by(a_, from, std::min(to, best_.time));
        const auto visit = [&](const Triangle& corners, std::uint32_t triangle) {
            const Passage::Entry entry = passage.entry(corners, best_.time);
            if (entry.time > best_.time) return;
            cast_part({ShapeMaker::triangle(corners), a_.pose, {0, triangle}, a_.shape.sides()}, from,
                      entry.is_apart ? std::max(entry.time, from) : from);
        };
        if (a_.shape.kind() == Kind::mesh)
            passage.visit_mesh(a_.shape, best_.time, visit);
        else
            passage.visit_field(*a_.shape.height_field(), best_.time, visit);
    }

    // Seeks between two times among the parts near the box that b sweeps.
    void search_box(double from, double to, int halvings) {
        to = std::min(to, best_.time);
        if (from > best_.time || (from == best_.time && best_.result != CastResult::miss)) return;
        const RigidTransform pose = moved(a_.pose, motion_a_, from);
        const QueryBox box = swept_box(pose, from, to);
        int count = 0;
        if (halvings < kMaxHalvings && to > from && !is_unbounded(b_))
            visit(box, [&](const Part&) { return ++count > kManyParts; });
        if (count > kManyParts && way(from, to) > 0.5 * around_) {
            const double middle = 0.5 * (from + to);
            search_box(from, middle, halvings + 1);
            return search_box(middle, to, halvings + 1);
        }
        const auto cast_all = [&](const QueryBox& within, bool stops) {
            visit(within, [&](const Part& part) {
                cast_part(part, from, from);
                return stops && hits_at(from);
            });
        };
        cast_all(box, true);
        // Finds the deepest of the parts that are in contact from the start.
        if (hits_at(from)) cast_all(swept_box(pose, from, from), false);
    }

    [[nodiscard]] bool hits_at(double time) const { return best_.time <= time && best_.result != CastResult::miss; }

    // How far b's pivot may come from where it is half way between two times, seen from a: its own way, and what a
    // turns under it. And how long that way is about.
    [[nodiscard]] double way(double from, double to) const {
        const double half = 0.5 * (to - from);
        const double travel = half * glm::length(motion_b_.velocity - motion_a_.velocity);
        return travel + half * glm::length(motion_a_.spin) * distance_at(0.5 * (from + to), travel);
    }
    [[nodiscard]] double distance_at(double time, double travel) const {
        return glm::length(apart_ + time * (motion_b_.velocity - motion_a_.velocity)) + travel + around_;
    }

    // All that b passes between two times, in the frame in which a stands at the first of them.
    [[nodiscard]] QueryBox swept_box(const RigidTransform& pose, double from, double to) const {
        if (to == from) return box_at(pose, from);
        const glm::dvec3 velocity = motion_b_.velocity - motion_a_.velocity;
        const double middle = 0.5 * (from + to), speed = glm::length(velocity);
        const bool a_turns = motion_a_.spin != glm::dvec3(0.0);
        const glm::dmat3 back = glm::inverse(pose.rotation);
        // Where b's pivot would be from a's origin, if a kept the place it has at `from`.
        const glm::dvec3 center = apart_ + middle * velocity + arm_of(pose, motion_a_);
        QueryBox box;
        if (b_turns_ || a_turns || speed == 0.0) {
            const Sphere sphere = around_b(middle, 0.5 * (to - from));
            double grown = sphere.radius + 0.5 * (to - from) * speed;
            if (a_turns) grown += (to - from) * glm::length(motion_a_.spin) * distance_at(middle, way(from, to));
            box.axes = glm::dmat3(1.0);
            box.half = glm::dvec3(grown);
            box.center = back * (center + sphere.center);
        } else {
            box = along_way(back, center, velocity / speed, 0.5 * (to - from) * speed);
        }
        box.rounding = rounding(to);
        return box;
    }

    // b at one time alone, however it turns.
    [[nodiscard]] QueryBox box_at(const RigidTransform& pose, double time) const {
        const RigidTransform then = moved(b_.pose, motion_b_, time);
        const Aabb& bounds = b_.shape.bounds();
        const glm::dvec3 half = bounds.half_extents();
        QueryBox box;
        for (int k = 0; k < 3; ++k) box.half += half[k] * glm::abs(then.rotation[k]);
        box.half = box.half * 1.00001;  // a pose is orthonormal to 1e-6
        box.axes = glm::inverse(pose.rotation);
        box.center = box.axes * (then.rotation * bounds.center() + (then.translation - pose.translation));
        box.rounding = rounding(time);
        return box;
    }

    struct Sphere {
        glm::dvec3 center;  // from b's pivot
        double radius;
    };
    // Contains b while it turns, for half a stretch before and after a time: around its pivot, or around its own centre
    // where that does not come far.
    [[nodiscard]] Sphere around_b(double middle, double half_stretch) const {
        const Aabb& bounds = b_.shape.bounds();
        const glm::dvec3 arm = bounds.center() - pivot_;
        const double own = glm::length(bounds.half_extents()) * 1.00001 +
                           half_stretch * glm::length(motion_b_.spin) * glm::length(arm);
        if (!(own < around_)) return {glm::dvec3(0.0), around_};
        return {moved(b_.pose, motion_b_, middle).rotation * arm, own};
    }

    // Of the shapes' places up to a time, as `moved` has them, from each other.
    [[nodiscard]] double rounding(double time) const {
        return 1e-15 * (glm::length(a_.pose.translation) + glm::length(b_.pose.translation) +
                        time * (glm::length(motion_a_.velocity) + glm::length(motion_b_.velocity)));
    }

    // b does not turn: its box, swept along a unit vector.
    [[nodiscard]] QueryBox along_way(const glm::dmat3& back, const glm::dvec3& pivot, const glm::dvec3& unit,
                                     double half_way) const {
        const glm::dvec3 across = unit_across(unit);
        const glm::dmat3 axes(unit, across, glm::cross(unit, across));
        const Aabb& bounds = b_.shape.bounds();
        const glm::dmat3 sides = glm::transpose(axes) * b_.pose.rotation;
        QueryBox box;
        const glm::dvec3 half = bounds.half_extents();
        for (int k = 0; k < 3; ++k) box.half += half[k] * glm::abs(sides[k]);
        box.half = box.half * 1.00001;  // a pose is orthonormal to 1e-6
        box.half.x += half_way;
        box.axes = back * axes;
        box.center = back * (pivot + b_.pose.rotation * (bounds.center() - pivot_));
        return box;
    }

    // Parts stand as at time 0, whenever the box is of.
    void visit(const QueryBox& box, PartVisitor visitor) const {
        if (is_unbounded(b_)) return (void)visit_parts(a_, {}, kEverything, visitor);
        const double reach = is_unbounded(a_) ? 0.0 : a_.shape.core_radius();
        visit_parts(a_, box, options_.tolerance + 1e-9 * (around_ + reach), visitor);
    }

    // `start`: from `from` up to there the part is surely not met. The first hit counts, whatever order the parts come
    // in; of hits at `from` the deepest, and of hits alike that of the least part.
    void cast_part(const Part& part, double from, double start) {
        const Motion motion = a_.shape.kind() == Kind::compound ? motion_of_part(a_, motion_a_, part.pose) : motion_a_;
        CastOptions options = options_;
        options.early_out = best_.time;
        if (start > from) options.ignore_initial_overlaps = false;  // there are none
        const ShapeAtPose placed{part.shape, part.pose};
        if (comes_later(placed)) return;
        const bool convex = b_.shape.is_convex();
        if (convex && slide_ != nullptr && slide_->passes(placed, motion, b_, motion_b_, flipped_)) return;
        Impact impact = convex ? advance(placed, motion, b_, motion_b_, options, start, nullptr)
                               : reversed(cast_parts(b_, motion_b_, placed, motion, options, start, slide_, !flipped_));
        if (impact.result == CastResult::miss || !comes_first(impact, part.id, from)) return;
        if (part.sides == Sides::front) {
            const RigidTransform then = moved(part.pose, motion, impact.time),
                                 b_then = moved(b_.pose, motion_b_, impact.time);
            if (comes_from_behind({part.shape, then}, {b_.shape, b_then}, impact)) return;
        }
        best_ = impact;
        best_.part_a = part.id;
    }

    [[nodiscard]] bool comes_first(const Impact& impact, const PartId& part, double from) const {
        if (best_.result == CastResult::miss || impact.time != best_.time) return impact.time <= best_.time;
        if (impact.time == from && impact.distance != best_.distance) return impact.distance < best_.distance;
        return part < best_.part_a;
    }

    // Whether neither turns, and along their way they are too far apart to touch by the time of the best.
    [[nodiscard]] bool comes_later(const ShapeAtPose& part) const {
        const glm::dvec3 velocity = motion_b_.velocity - motion_a_.velocity;
        const double speed = glm::length(velocity);
        if (b_turns_ || motion_a_.spin != glm::dvec3(0.0) || !(speed > 0.0) || is_unbounded(b_)) return false;
        if (is_half_space(part)) return false;
        if (!b_.shape.is_convex()) return false;
        const Pair pair(part, b_);
        const double gap = -pair.extent(-velocity / speed) - pair.error - part.shape.radius() - b_.shape.radius();
        return gap - 2.0 * options_.tolerance > speed * best_.time * (1.0 + 1e-9);
    }

    [[nodiscard]] static Impact reversed(Impact impact) {
        impact.normal = -impact.normal;
        std::swap(impact.on_a, impact.on_b);
        std::swap(impact.part_a, impact.part_b);
        return impact;
    }

    const ShapeAtPose &a_, &b_;
    const Motion &motion_a_, &motion_b_;
    const CastOptions& options_;
    const ContactsAt* const slide_;
    const bool flipped_;
    Impact best_;
    glm::dvec3 pivot_{0.0};  // of b; its centre where it does not turn
    double around_ = 0.0;    // radius of b around its pivot
    glm::dvec3 apart_{0.0};
    bool b_turns_ = false;
};

}  // namespace

Impact cast_parts(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                  const CastOptions& options, double start, const ContactsAt* slide, bool flipped) {
    PartCaster caster(a, motion_a, b, motion_b, options, slide, flipped);
    caster.search(start, options.duration);
    return caster.best();
}

}  // namespace crofton::convex
