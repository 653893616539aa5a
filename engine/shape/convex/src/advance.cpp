// SPDX-License-Identifier: MIT
// Conservative advancement of two convex shapes.
#include <algorithm>
#include <cmath>

#include "closing.hpp"
#include "part_cast.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {
namespace {

// How often a pair within the tolerance is asked whether it goes on to touch, before that counts as a hit.
constexpr int kMaxProofs = 32;

// Where two shapes are nearest, or deepest in each other, seen from a's origin.
struct Contact {
    double distance = 0.0;  // negative: how deep they overlap
    double lower = 0.0;     // proven
    glm::dvec3 normal{0.0}, on_a{0.0}, on_b{0.0};
    bool closed = false;       // in closed form
    double within = HUGE_VAL;  // else: how far they are apart at most, where that is known
};
Contact contact_of(const Distance& d) {
    return {d.distance, d.lower, d.normal, d.on_a, d.on_b};
}

// Whether deepest points of a triangle and a box lie on both. If a side of one lies along the other, many corners are
// equally deep, and the closed form takes any.
bool lie_on_both(const Triangle& corners, const ShapeAtPose& triangle, const ShapeAtPose& box,
                 const glm::dvec3& on_triangle, const glm::dvec3& on_box, double error) {
    const glm::dvec3 p = glm::inverse(triangle.pose.rotation) * (on_triangle - triangle.pose.translation),
                     q = glm::abs(glm::inverse(box.pose.rotation) * (on_box - box.pose.translation)),
                     normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 edge = corners[k == 2 ? 0 : k + 1] - corners[k];
        if (glm::dot(glm::cross(normal, edge), p - corners[k]) < -error * glm::length(normal) * glm::length(edge))
            return false;
    }
    const glm::dvec3 limit = box.shape.half_extents() + (box.shape.radius() + error);
    return q.x <= limit.x && q.y <= limit.y && q.z <= limit.z;
}

// Handles a triangle and a sphere, a capsule or a box in closed form. Returns false if that leaves a doubt.
bool triangle_contact(const ShapeAtPose& triangle, const ShapeAtPose& other, Contact& contact) {
    const Kind kind = other.shape.kind();
    if (triangle.shape.kind() != Kind::triangle || triangle.shape.radius() > 0.0) return false;
    if (kind != Kind::sphere && kind != Kind::capsule && kind != Kind::box) return false;
    const glm::dvec3& origin = triangle.pose.translation;
    const double reach = triangle.shape.core_radius();
    const Triangle corners{triangle.shape.vertex(0), triangle.shape.vertex(1), triangle.shape.vertex(2)};
    Touch touch;
    const Warm warm =
        kind == Kind::box
            ? BoxTouch(other, origin, reach, HUGE_VAL).ask(placed_corners(corners, triangle.pose, origin), touch)
            : SegmentTouch(other, origin, reach, HUGE_VAL)
                  .ask(placed_triangle(corners, triangle.pose, origin), touch, &contact.within);
    if (warm != Warm::touching) return false;
    const Pair pair(triangle, other);
    contact.distance = -touch.depth;
    contact.lower = std::max(0.0, -pair.extent(touch.normal) - pair.error - pair.rounding());
    contact.normal = touch.normal;
    contact.on_a = origin + touch.on_a;
    contact.on_b = contact.on_a - touch.depth * touch.normal;
    contact.closed = true;
    return kind != Kind::box || touch.depth <= other.shape.radius() ||
           lie_on_both(corners, triangle, other, contact.on_a, contact.on_b, 1e-10 * pair.size);
}
bool contact_in_closed_form(const ShapeAtPose& a, const ShapeAtPose& b, Contact& contact) {
    if (triangle_contact(a, b, contact)) return true;
    if (!triangle_contact(b, a, contact)) return false;
    contact.normal = -contact.normal;
    std::swap(contact.on_a, contact.on_b);
    return true;
}

// How close the bounds of a distance are that is only stepped by, where the search for it takes long.
constexpr double kShare = 0.03;

class Advancement {
  public:
    Advancement(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
                const CastOptions& options, double start, PairCache& cache)
        : flight_(a, motion_a, b, motion_b), options_(options), cache_(cache), start_(start) {
        early_ = std::min(options.early_out, options.duration);
    }

    Impact run();

  private:
    [[nodiscard]] bool begins_in_contact();
    [[nodiscard]] Contact nearest(double near, bool& reached);
    [[nodiscard]] Contact contact();
    [[nodiscard]] bool meet_after(double step, bool closed);
    [[nodiscard]] double proven(const Contact& now) const {
        return (now.lower - flight_.path_error()) * (1.0 - 0x1p-40);
    }
    [[nodiscard]] Impact impact(CastResult result, const Contact& now, int steps) const;
    [[nodiscard]] Impact miss(int steps) const;

    Flight flight_;
    const CastOptions& options_;
    PairCache& cache_;
    const double start_;
    double early_ = 0.0;
    glm::dvec3 parted_{0.0};  // the direction that parted the shapes last
};

Impact Advancement::impact(CastResult result, const Contact& now, int steps) const {
    Impact impact;
    impact.result = result;
    impact.time = flight_.time();
    impact.normal = now.normal;
    impact.on_a = flight_.in_world(now.on_a);
    impact.on_b = flight_.in_world(now.on_b);
    impact.distance = now.distance + 0.0;  // never −0
    impact.steps = steps;
    return impact;
}

Impact Advancement::miss(int steps) const {
    Impact impact;
    impact.time = early_ + 0.0;
    impact.steps = steps;
    return impact;
}

// As `distance`, where the bounds need not be close: a tenth of the distance. `reached`: it is not above `near`, and no
// more is known.
Contact Advancement::nearest(double near, bool& reached) {
    const ShapeAtPose a = flight_.a(), b = flight_.b();
    Contact closed;
    if (contact_in_closed_form(a, b, closed)) return closed;
    if (closed.within <= near) {
        reached = true;
        return {};
    }
    if (is_half_space(a) || is_half_space(b)) {
        const Distance d = distance(a, b);
        reached = d.distance <= near;
        return contact_of(d);
    }
    const Pair pair(a, b);
    const double rounding = a.shape.radius() + b.shape.radius();
    Nearest core = nearest_points(pair, &cache_, rounding + near, HUGE_VAL, pair.has_polytope_cores() ? 0.0 : kShare);
    reached = core.upper <= rounding + near;
    if (reached) return {};
    if (!(core.upper - core.lower <= 0.1 * (core.lower - rounding))) core = core_distance(pair, &cache_, 0.0, HUGE_VAL);
    remember(core, &cache_);
    return contact_of(distance_of(pair, core));
}

// The direction that proves the bound of round cores' distance, and the one between their nearest points, differ by the
// root of what the search has left. Here that between the points, so that they are apart along the normal.
void align(const ShapeAtPose& a, const ShapeAtPose& b, Contact& contact) {
    const double ra = a.shape.radius(), rb = b.shape.radius();
    const glm::dvec3 on_a = contact.on_a - ra * contact.normal, on_b = contact.on_b + rb * contact.normal;
    const double length = glm::distance(on_a, on_b);
    if (!(length > 1e-3 * (a.shape.core_radius() + b.shape.core_radius())))
        return;  // what the points are off across would turn it
    contact.normal = (on_b - on_a) / length;
    contact.on_a = on_a + ra * contact.normal;
    contact.on_b = on_b - rb * contact.normal;
}

// As `distance` and `penetration` tell.
Contact Advancement::contact() {
    const ShapeAtPose a = flight_.a(), b = flight_.b();
    Contact closed;
    if (contact_in_closed_form(a, b, closed)) return closed;
    const Distance d = distance(a, b, &cache_);
    if (d.distance > 0.0) {
        Contact apart = contact_of(d);
        if (!a.shape.has_polytope_core() || !b.shape.has_polytope_core())
            if (!is_half_space(a) && !is_half_space(b)) align(a, b, apart);
        return apart;
    }
    const Penetration p = penetration(a, b);
    if (p.overlapping && p.normal != glm::dvec3(0.0)) return {-p.depth, 0.0, p.normal, p.on_a, p.on_b};
    return {0.0, 0.0, parted_, d.on_a, d.on_b};
}

// Whether the shapes surely overlap a little later: then they touch before. `closed`: by the closed form alone.
bool Advancement::meet_after(double step, bool closed) {
    const double now = flight_.time();
    flight_.move_to(now + step);
    const ShapeAtPose a = flight_.a(), b = flight_.b();
    bool meet = false;
    if (closed) {
        Contact later;
        meet = contact_in_closed_form(a, b, later) && later.distance < -2.0 * flight_.path_error();
    } else if (!is_half_space(a) && !is_half_space(b)) {
        const Pair pair(a, b);
        const Nearest core = nearest_points(pair, &cache_, pair.rounding(), pair.rounding());
        meet = core.relation == Relation::overlapping || core.upper <= pair.rounding() - pair.doubt();
    }
    flight_.move_to(now);
    return meet;
}

// At time 0, where the search begins later.
bool Advancement::begins_in_contact() {
    flight_.move_to(0.0);
    bool reached = false;
    const Contact now = nearest(options_.tolerance, reached);
    return reached || now.distance < options_.tolerance;
}

Impact Advancement::run() {
    const double tolerance = options_.tolerance;
    if (options_.ignore_initial_overlaps && start_ > 0.0 && begins_in_contact()) return miss(1);
    Impact first;  // where they came within the tolerance
    bool within = false, lifting = false;
    double near = 0.99 * tolerance;
    int proofs = 0;
    flight_.move_to(start_);
    for (int steps = 1;; ++steps) {
        bool reached = false;
        Contact now = nearest(near, reached);
        if (reached && within) return first;
        const bool was_within = within;
        const bool nearer = within && now.distance < first.distance;
        if (!now.closed && (reached || !(proven(now) > 0.0) || (now.distance < tolerance && !nearer))) now = contact();
        const double gap = proven(now);
        const bool touching = !(gap > 0.0), starts = flight_.time() == start_;
        if (!touching && now.distance >= tolerance) {
            within = false;
        } else {
            // A later time is as good while they come no nearer.
            if (!within) proofs = 0;
            if (!within || now.distance >= first.distance) first = impact(CastResult::hit, now, steps);
            within = true;
            if (starts && options_.ignore_initial_overlaps) return miss(steps);
            if (touching && (!starts || now.distance <= -tolerance)) return first;
            if (now.normal == glm::dvec3(0.0) || flight_.rests() || options_.duration == 0.0 || proofs++ == kMaxProofs)
                return first;
        }
        if (lifting && touching) return first;
        if (steps > options_.max_steps) return within ? first : impact(CastResult::unresolved, contact(), steps);
        parted_ = now.normal;

        const double left = options_.duration - flight_.time();
        const Closing closing = flight_.closing(now.normal);
        // Along, within rounding.
        const double slack = starts && within ? 0x1p-40 * (flight_.size() + flight_.way(left)) : 0.0;
        if (closing(left) < std::max(gap, slack)) return miss(steps);
        if (!within && early_ < options_.duration && closing(early_ - flight_.time()) < gap - tolerance)
            return miss(steps);
        if (touching && !flight_.turns()) return first;
        // The way to a touch that turns is long, and the closed form leaves the last of it to a search; a step beyond
        // the touch tells as much.
        if (within && !was_within && !touching && (flight_.turns() ? !starts : now.closed) &&
            meet_after(std::min(left, closing.safe_step(2.0 * gap, left)), !flight_.turns()))
            return first;
        lifting = touching;
        const double kept = within ? std::max(0x1p-12 * gap, 64.0 * flight_.path_error()) : 0.5 * tolerance;
        near = within ? 2.0 * kept : 0.99 * tolerance;
        const double step = closing.safe_step(touching ? slack : std::max(gap - kept, 0.5 * gap), left);
        const double next = flight_.time() + step;
        if (next == flight_.time()) return within ? first : impact(CastResult::hit, contact(), steps);
        if (!within && next > early_) return miss(steps);
        flight_.move_to(next);
    }
}

}  // namespace

Impact advance(const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b, const Motion& motion_b,
               const CastOptions& options, double start, PairCache* cache) {
    PairCache own;
    return Advancement(a, motion_a, b, motion_b, options, start, cache != nullptr ? *cache : own).run();
}

}  // namespace crofton::convex
