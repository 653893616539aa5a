// SPDX-License-Identifier: MIT
#include "contacts_at.hpp"

#include <algorithm>
#include <crofton/convex/shape_maker.hpp>
#include <glm/matrix.hpp>

#include "part_cast.hpp"
#include "part_manifold.hpp"
#include "triangle_touch.hpp"
#include "union_normals.hpp"

namespace crofton::convex {
namespace {

constexpr double kSameNormal = 1e-9;
constexpr double kSameDirection = 1.0 - 1e-7;  // a cosine, of 0.03 degrees
constexpr double kShallowOverlap = 0.25;       // of the lesser shape: deeper overlaps have no plain way out

using PairVisitor = FunctionRef<bool(const Part& a, const Part& b)>;

// Calls `visit` for pairs of parts that may be within the margin. True ends the search.
bool visit_pairs(const ShapeAtPose& a, const ShapeAtPose& b, double margin, PairVisitor visit) {
    const auto with_a = [&](const Part& part_a) {
        const auto with_b = [&](const Part& part_b) { return visit(part_a, part_b); };
        if (b.shape.is_convex()) return with_b({b.shape, b.pose, {}, Sides::both});
        return visit_parts_near(b, {part_a.shape, part_a.pose}, margin, with_b);
    };
    if (a.shape.is_convex()) return with_a({a.shape, a.pose, {}, Sides::both});
    return visit_parts_near(a, b, margin, with_a);
}

// Other parts are nearer if their distance is below these.
struct Limits {
    double one_way, other_way;  // along the hit's normal, along other normals
};

bool is_nearer_than(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal, const Limits& limits) {
    const Distance d = near_distance(a, b, limits.other_way);
    const bool other_way = glm::dot(d.normal, normal) < kSameDirection;
    return d.distance < (other_way ? limits.other_way : limits.one_way);
}

// The same of all parts of a but one, and a convex b. Most lie behind the plane across `normal` that touches b's
// nearest points.
bool is_part_nearer(const ShapeAtPose& a, const ShapeAtPose& b, const glm::dvec3& normal, const PartId& but,
                    const Limits& limits) {
    const double limit = limits.other_way;
    const auto is_nearer = [&](const Part& part) {
        return part.id != but && is_nearer_than({part.shape, part.pose}, b, normal, limits);
    };
    const bool is_segment = b.shape.kind() == Kind::sphere || b.shape.kind() == Kind::capsule,
               is_box = b.shape.kind() == Kind::box;
    const double depth = core_support(b.shape, Pair::local(b.pose.rotation, -normal)).along + b.shape.radius();
    return visit_parts_near(
        a, b, limit, is_nearer, [&](const PartSearch& of, const Triangle& corners, std::uint32_t t) {
            if (PartId{of.child, t} == but) return false;
            const glm::dvec3 local = Pair::local(of.pose.rotation, normal),
                             offset = b.pose.translation - of.pose.translation;
            const double top = std::max(glm::dot(local, corners[0]),
                                        std::max(glm::dot(local, corners[1]), glm::dot(local, corners[2])));
            const double error =
                0x1p-47 * (of.shape->core_radius() + b.shape.core_radius() + b.shape.radius() + glm::length(offset));
            if (glm::dot(normal, offset) - depth - top - error >= limit) return false;
            const glm::dvec3& origin = of.pose.translation;
            const double reach = of.shape->core_radius(), far = std::max(limit, 0.0);
            Touch touch;
            const Warm warm =
                is_segment ? SegmentTouch(b, origin, reach, far).ask(placed_triangle(corners, of.pose, origin), touch)
                : is_box   ? BoxTouch(b, origin, reach, far).ask(placed_corners(corners, of.pose, origin), touch)
                           : Warm::unknown;
            if (warm == Warm::apart) return false;
            return is_nearer({ShapeMaker::triangle(corners), of.pose, {of.child, t}, of.sides});
        });
}

}  // namespace

bool is_nearer_elsewhere(const Mover& a, const Mover& b, const Impact& hit, double margin, double farther) {
    Flight flight(a.shape, a.motion, b.shape, b.motion);
    flight.move_to(hit.time);
    const bool bounded = !is_unbounded(a.shape) && !is_unbounded(b.shape);
    const Limits limits{hit.distance - margin, hit.distance + farther};
    if (bounded && b.shape.shape.is_convex())
        return is_part_nearer(flight.a(), flight.b(), hit.normal, hit.part_a, limits);
    if (bounded && a.shape.shape.is_convex())
        return is_part_nearer(flight.b(), flight.a(), -hit.normal, hit.part_b, limits);
    return visit_pairs(flight.a(), flight.b(), limits.other_way, [&](const Part& part_a, const Part& part_b) {
        if (part_a.id == hit.part_a && part_b.id == hit.part_b) return false;
        return is_nearer_than({part_a.shape, part_a.pose}, {part_b.shape, part_b.pose}, hit.normal, limits);
    });
}

Motion motion_of_part(const ShapeAtPose& whole, const Motion& motion, const RigidTransform& part) {
    Motion result = motion;
    result.pivot = glm::inverse(part.rotation) *
                   (whole.pose.rotation * motion.pivot + (whole.pose.translation - part.translation));
    return result;
}

bool comes_from_behind(const ShapeAtPose& triangle, const ShapeAtPose& b, const Impact& impact) {
    const glm::dvec3& origin = triangle.pose.translation;
    const Triangle corners{triangle.shape.vertex(0), triangle.shape.vertex(1), triangle.shape.vertex(2)};
    const PlacedTriangle there = placed_triangle(corners, triangle.pose, origin);
    if (impact.distance <= 0.0) return !is_in_front(there, b.shape, middle_of(b, origin));
    return glm::dot(impact.normal, there.normal) <= 0.0;
}

// At the start where the shapes are, later around a's place at the start: the world may lack digits there.
ContactsAt::ContactsAt(const Mover& a, const Mover& b, const CastOptions& options, double time)
    : flight_(a.shape, a.motion, b.shape, b.motion),
      time_(time),
      pose_a_(time > 0.0 ? (flight_.move_to(time), flight_.a().pose) : a.shape.pose),
      pose_b_(time > 0.0 ? flight_.b().pose : b.shape.pose),
      placed_a_{a.shape.shape, pose_a_},
      placed_b_{b.shape.shape, pose_b_},
      a_{placed_a_, a.motion, a.beside},
      b_{placed_b_, b.motion, b.beside},
      options_(options) {
    bool own = true;
    visit_all_pairs([&](bool is_own) { own = is_own; },
                    [&](const Part& part_a, const Motion& motion_a, const Part& part_b, const Motion& motion_b) {
                        const auto impact = touch(part_a, part_b);
                        if (!impact) return;
                        Contact contact{part_a, part_b, motion_a, motion_b, *impact, own};
                        contact.slides = slides_past(contact);
                        add(contact);
                    });
    close_cracks();
    find_covered();
}

bool ContactsAt::slides_past(const Contact& contact) const {
    const double left = options_.duration - time_;
    const Flight flight({contact.a.shape, contact.a.pose}, contact.motion_a, {contact.b.shape, contact.b.pose},
                        contact.motion_b);
    const double slack = 0x1p-40 * (flight.size() + flight.way(left));
    return flight.closing(contact.impact.normal)(left) < std::max(contact.impact.distance, slack);
}

// Corners of parts are floats, so flush parts may have cracks between them. A shape over a crack is nearest to the
// edges there. It touches a face that lies beside it by no more than rounding, unless a part overlaps along that face.
void ContactsAt::close_cracks() {
    if (count_ < 2) return;
    for (std::size_t i = 0; i < count_; ++i) {
        Contact& contact = at(i);
        Impact& impact = contact.impact;
        if (!(impact.distance > 0.0)) continue;
        const ShapeAtPose a{contact.a.shape, contact.a.pose}, b{contact.b.shape, contact.b.pose};
        const Pair pair(a, b);
        const double rounding = flush_tolerance(a, b);
        double least = std::min(rounding / impact.distance, 1.4);
        glm::dvec3 normal(0.0), over(0.0);
        bool of_a = false;
        const auto offer = [&](const glm::dvec3& face, bool is_of_a) {
            const double turn = glm::distance(face, impact.normal);
            if (face == glm::dvec3(0.0) || !(turn < least) || !is_free_face(face)) return;
            // The point over the face that is deepest along it.
            double extent = 0.0;
            const Corner corner = pair.support(face, extent);
            glm::dvec3 deepest = a.pose.translation + (is_of_a ? corner.on_b - b.shape.radius() * face
                                                               : corner.on_a + a.shape.radius() * face);
            const glm::dvec3& told = is_of_a ? impact.on_b : impact.on_a;
            const double deeper = glm::dot(face, impact.on_b - impact.on_a) + extent + pair.rounding();
            if (deeper <= 1e-9 * pair.size)
                deepest = told;
            else if (glm::distance(deepest, told) > rounding)
                return;
            least = turn;
            normal = face;
            over = deepest;
            of_a = is_of_a;
        };
        for (int k = 0; k < face_count(a.shape); ++k) offer(face_normal(a, k), true);
        for (int k = 0; k < face_count(b.shape); ++k) offer(-face_normal(b, k), false);
        if (normal == glm::dvec3(0.0)) continue;
        impact.normal = normal;
        impact.distance = of_a ? glm::dot(normal, over - impact.on_a) : glm::dot(normal, impact.on_b - over);
        impact.on_a = of_a ? over - impact.distance * normal : over;
        impact.on_b = of_a ? over : over + impact.distance * normal;
        contact.slides = slides_past(contact);
        contact.over_crack = true;
    }
}

// Whether none of the contacts' parts overlap along it by more than rounding.
bool ContactsAt::is_free_face(const glm::dvec3& face) const {
    for (std::size_t i = 0; i < count_; ++i) {
        const ShapeAtPose a{at(i).a.shape, at(i).a.pose}, b{at(i).b.shape, at(i).b.pose};
        if (is_half_space(a) || is_half_space(b)) continue;
        const Pair pair(a, b);
        if (pair.extent(face) + pair.rounding() > flush_tolerance(a, b)) return false;
    }
    return true;
}

std::optional<Impact> ContactsAt::deepest_over_crack() const {
    std::optional<Impact> best;
    for (std::size_t i = 0; i < count_; ++i) {
        const Contact& contact = at(i);
        if (!contact.over_crack || !contact.own || contact.slides) continue;
        if (!best || contact.impact.distance < best->distance) best = in_world(contact.impact);
    }
    return best;
}

void ContactsAt::visit_all_pairs(FunctionRef<void(bool own)> begin, MovingPairVisitor visit) const {
    const auto visit_moving = [&](const ShapeAtPose& a, const Motion& motion_a, const ShapeAtPose& b,
                                  const Motion& motion_b) {
        visit_pairs(a, b, options_.tolerance, [&](const Part& part_a, const Part& part_b) {
            visit(part_a, motion_of_part(a, motion_a, part_a.pose), part_b, motion_of_part(b, motion_b, part_b.pose));
            return false;
        });
    };
    begin(true);
    visit_moving(a_.shape, a_.motion, b_.shape, b_.motion);
    if (time_ > 0.0) return;
    begin(false);
    const Motion along_a{a_.motion.velocity, {}, {}}, along_b{b_.motion.velocity, {}, {}};
    for (const ShapeAtPose& other : b_.beside) visit_moving(a_.shape, a_.motion, other, along_b);
    for (const ShapeAtPose& other : a_.beside) visit_moving(other, along_a, b_.shape, b_.motion);
}

// Where two parts are within the tolerance, or overlap by less; by more, if such are left out.
std::optional<Impact> ContactsAt::touch(const Part& a, const Part& b) const {
    const ShapeAtPose placed_a{a.shape, a.pose}, placed_b{b.shape, b.pose};
    if (is_half_space(placed_a) && is_half_space(placed_b)) return std::nullopt;
    const CastOptions now{.duration = 0.0, .tolerance = options_.tolerance};
    Impact impact = advance(placed_a, {}, placed_b, {}, now, 0.0, nullptr);
    if (impact.result == CastResult::miss || impact.normal == glm::dvec3(0.0)) return std::nullopt;
    if (impact.distance <= -options_.tolerance) {
        const auto size = [](const Shape& shape) { return shape.core_radius() + shape.radius(); };
        const bool shallow = -impact.distance <= kShallowOverlap * std::min(size(a.shape), size(b.shape));
        if (!options_.ignore_initial_overlaps || !shallow) return std::nullopt;
    }
    if (a.sides == Sides::front && comes_from_behind(placed_a, placed_b, impact)) return std::nullopt;
    impact.normal = -impact.normal;
    if (b.sides == Sides::front && comes_from_behind(placed_b, placed_a, impact)) return std::nullopt;
    impact.normal = -impact.normal;
    impact.part_a = a.id;
    impact.part_b = b.id;
    return impact;
}

// One of each normal, the deepest.
void ContactsAt::add(const Contact& contact) {
    for (std::size_t i = 0; i < count_; ++i) {
        Contact& other = at(i);
        if (other.slides != contact.slides || other.own != contact.own) continue;
        if (glm::distance(other.impact.normal, contact.impact.normal) > kSameNormal) continue;
        if (contact.impact.distance < other.impact.distance) other = contact;
        return;
    }
    if (count_ < kMost) std::construct_at(&at(count_++), contact);
}

void ContactsAt::find_covered() {
    for (std::size_t i = 0; i < count_; ++i) {
        if (!at(i).slides) continue;
        for (std::size_t k = 0; k < count_ && !at(i).is_covered; ++k) at(i).is_covered = is_covered_by(at(i), at(k));
        slides_ |= !at(i).is_covered;
    }
}

// To the rounding of normals across gaps: floors whose tiles are flush to the tolerance alone have planes of their own.
bool ContactsAt::is_covered_by(const Contact& contact, const Contact& by) const {
    const auto lies_behind = [](const Contact& c, const Contact& plane) {
        const ShapeAtPose a{c.a.shape, c.a.pose}, b{c.b.shape, c.b.pose};
        if (is_half_space(a) || is_half_space(b)) return false;
        const Pair pair(a, b);
        const double gap = -pair.extent(plane.impact.normal) - pair.rounding();
        return gap >= plane.impact.distance - 0x1p-33 * pair.size;
    };
    return !by.slides && lies_behind(contact, by) && !lies_behind(by, contact);
}

void ContactsAt::count_behind() {
    visit_all_pairs([](bool) {},
                    [&](const Part& a, const Motion&, const Part& b, const Motion&) {
                        const ShapeAtPose placed_a{a.shape, a.pose}, placed_b{b.shape, b.pose};
                        if (is_half_space(placed_a) || is_half_space(placed_b) || !touch(a, b)) return;
                        for (std::size_t i = 0; i < count_; ++i)
                            at(i).behind += is_behind(placed_a, placed_b, at(i), 0.0);
                    });
}

// Whether two parts are no deeper along the contact's normal than it is, also when they have come together by
// `closing`.
bool ContactsAt::is_behind(const ShapeAtPose& a, const ShapeAtPose& b, const Contact& contact, double closing) const {
    const Pair pair(a, b);
    const double gap = -pair.extent(contact.impact.normal) - pair.rounding();
    const double allowed = std::max(options_.tolerance, flush_tolerance(a, b));
    return gap - std::max(closing, 0.0) >= std::min(contact.impact.distance, 0.0) - allowed;
}

// Whether a shape beside the two overlaps by more than the tolerance. What is less deep than it is yet to be met.
bool ContactsAt::is_left_out(const Contact& contact) const {
    return !contact.own && contact.impact.distance <= -options_.tolerance;
}

bool ContactsAt::is_flush_with(const ShapeAtPose& a, const ShapeAtPose& b, const Contact& contact) const {
    const Pair pair(a, b);
    const double gap = -pair.extent(contact.impact.normal) - pair.rounding();
    return std::abs(gap - contact.impact.distance) <= std::max(options_.tolerance, flush_tolerance(a, b));
}

bool ContactsAt::passes(const ShapeAtPose& first, const Motion& motion_first, const ShapeAtPose& second,
                        const Motion& motion_second, bool flipped) const {
    if (is_half_space(first) || is_half_space(second)) return false;
    const ShapeAtPose &a = flipped ? second : first, &b = flipped ? first : second;
    const Motion &motion_a = flipped ? motion_second : motion_first, &motion_b = flipped ? motion_first : motion_second;
    for (std::size_t i = 0; i < count_; ++i) {
        const Contact& contact = at(i);
        if (!contact.slides || contact.is_covered || !is_behind(a, b, contact, 0.0)) continue;
        if (is_left_out(contact) && !is_flush_with(a, b, contact)) continue;
        const Flight flight(a, motion_a, b, motion_b);
        if (is_behind(a, b, contact, flight.closing(contact.impact.normal)(options_.duration))) return true;
    }
    return false;
}

bool ContactsAt::is_told_by(const Contact& contact, const Contact& by) const {
    const ShapeAtPose a{contact.a.shape, contact.a.pose}, b{contact.b.shape, contact.b.pose};
    return by.behind > contact.behind && !is_half_space(a) && !is_half_space(b) && is_behind(a, b, by, 0.0);
}

std::optional<Impact> ContactsAt::deepest(const Impact& hit, double least_cosine) {
    if (count_ > 1) count_behind();
    std::optional<Impact> best, best_of_others;
    const auto offer = [](std::optional<Impact>& to, const Impact& impact) {
        if (!(to && impact.distance >= to->distance)) to = impact;
    };
    bool others_tell = false;
    for (std::size_t i = 0; i < count_; ++i) {
        const Contact& contact = at(i);
        if (!contact.own || contact.slides) continue;
        if (!contact.over_crack && glm::dot(contact.impact.normal, hit.normal) < least_cosine) continue;
        bool is_told = false;
        for (std::size_t k = 0; k < count_; ++k) {
            if (!is_told_by(contact, at(k))) continue;
            is_told = true;
            if (at(k).own) continue;
            others_tell = true;
            if (!at(k).slides) offer(best_of_others, at(k).impact);
        }
        if (!is_told) offer(best, contact.impact);
    }
    if (!best && best_of_others) {
        best = best_of_others;
        best->part_a = hit.part_a;
        best->part_b = hit.part_b;
    }
    if (!best) return others_tell ? best : hit;
    return in_world(*best);
}

Impact ContactsAt::in_world(Impact impact) const {
    impact.time = time_;
    if (time_ > 0.0) {
        impact.on_a = flight_.in_world(impact.on_a);
        impact.on_b = flight_.in_world(impact.on_b);
    }
    return impact;
}

}  // namespace crofton::convex
