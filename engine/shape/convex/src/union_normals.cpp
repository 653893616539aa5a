// SPDX-License-Identifier: MIT
#include "union_normals.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/shape_maker.hpp>
#include <glm/matrix.hpp>

#include "core_query.hpp"
#include "edge_rule.hpp"
#include "part_manifold.hpp"

namespace crofton::convex {
namespace {

// Faces count as flush that are so within rounding of the sizes to float.
constexpr double kFlush = 0x1p-22;
// Flush faces of hulls may be tilted against each other, as their corners are floats.
constexpr double kFlatSlope = 2e-5;
constexpr double kShallow = 0.25;

// 0 of a half-space.
double reach_of(const Shape& shape) {
    return shape.is_bounded() ? shape.core_radius() + shape.radius() : 0.0;
}

ShapeAtPose point_at(const RigidTransform& place) {
    static const Shape kPoint = *Shape::sphere(0.0);
    return {kPoint, place};
}

// Whether the cores of a, which is no half-space, and b are surely no farther apart than this.
bool are_within(const ShapeAtPose& a, const ShapeAtPose& b, double distance) {
    if (is_half_space(b)) return half_space_gap(b, a).gap <= distance;
    return nearest_points(Pair(a, b), nullptr, 0.5 * distance, distance).lower <= distance;
}

// A half-space rises without end but along its normal.
bool rises_above(const ShapeAtPose& shape, const glm::dvec3& point, const glm::dvec3& direction, double tolerance) {
    if (is_half_space(shape)) {
        const RigidTransform at{glm::dmat3(1.0), point};
        const HalfSpaceGap gap = half_space_gap(shape, point_at(at));
        return glm::distance(gap.outward, direction) > kFlatSine || -gap.gap > tolerance;
    }
    const Support s = core_support(shape.shape, Pair::local(shape.pose.rotation, direction));
    const glm::dvec3 way =
        shape.pose.rotation * s.point + (shape.pose.translation - point) + shape.shape.radius() * direction;
    return glm::dot(way, direction) > kFlatSine * glm::length(way) + tolerance;
}

// Returns how far a point is beyond the plane of the hull's surface that it is farthest beyond; negative inside.
double beyond_planes(const Hull& hull, const glm::dvec3& point) {
    const double *x = hull.plane_column(0), *y = hull.plane_column(1), *z = hull.plane_column(2),
                 *level = hull.plane_column(3);
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < hull.triangles().size() / 3; ++i)
        most = std::max(most, x[i] * point.x + y[i] * point.y + z[i] * point.z - level[i]);
    return most;
}

double depth_of(const UnionNormals::Contact& contact) {
    double depth = -HUGE_VAL;
    for (int i = 0; i < contact.count; ++i) depth = std::max(depth, contact.points[i].depth);
    return depth;
}

}  // namespace

int face_count(const Shape& shape) {
    switch (shape.kind()) {
        case Kind::box:
            return 6;
        case Kind::hull:
            return shape.hull()->face_count();
        case Kind::triangle:
        case Kind::cylinder:
            return 2;
        default:
            return shape.kind() == Kind::cone ? 1 : 0;
    }
}

glm::dvec3 face_normal(const ShapeAtPose& placed, int face) {
    const Shape& shape = placed.shape;
    const glm::dmat3& rotation = placed.pose.rotation;
    glm::dvec3 local(0.0);
    if (shape.kind() == Kind::box)
        local[face / 2] = (face & 1) != 0 ? 1.0 : -1.0;
    else if (shape.kind() == Kind::hull)
        local = shape.hull()->face_normal(face);
    else if (shape.kind() == Kind::triangle)
        return (face == 0 ? 1.0 : -1.0) *
               triangle_normal(rotation, {shape.vertex(0), shape.vertex(1), shape.vertex(2)});
    else
        local.y = face == 0 ? -1.0 : 1.0;
    return local == glm::dvec3(0.0) ? local : turned_normal(rotation, local);
}

double flush_tolerance(const ShapeAtPose& a, const ShapeAtPose& b) {
    const glm::dvec3 place = glm::abs(a.pose.translation);
    const double size = reach_of(a.shape) + reach_of(b.shape) + glm::distance(a.pose.translation, b.pose.translation);
    return kFlush * size + 0x1p-50 * (place.x + place.y + place.z);
}

// Where a contact is on one of its parts, as far as that part is farthest along the normal there: points, those between
// them, and their middle. Points within `rounding` of the farthest are as far, so that rounding chooses none of them.
struct UnionNormals::Samples {
    glm::dvec3 point[25], middle{0.0};
    int corners = 0, count;
    double radius = 0.0;

    Samples(const Contact& contact, int list, double rounding) {
        const double side = list == 0 ? 1.0 : -1.0;
        glm::dvec3 place[8];
        double along[8], most = -HUGE_VAL;
        for (int i = 0; i < contact.count; ++i) {
            const ContactPoint& p = contact.points[i];
            place[i] = p.position + side * 0.5 * p.depth * contact.normal;
            along[i] = side * glm::dot(contact.normal, place[i] - place[0]);
            most = std::max(most, along[i]);
        }
        const double top = most - rounding;
        for (int i = 0; i < contact.count; ++i) {
            bool farthest = along[i] >= top;
            for (int k = 0; k < contact.count && !farthest; ++k)
                farthest = along[k] >= top && top - along[i] <= kFlatSine * glm::distance(place[i], place[k]);
            if (farthest) point[corners++] = place[i];
        }
        for (int i = 0; i < corners; ++i) middle += point[i] / static_cast<double>(corners);
        count = corners;
        for (int i = 0; i < corners; ++i) {
            radius = std::max(radius, glm::distance(point[i], middle));
            if (corners == 1) continue;
            point[count++] = 0.5 * (point[i] + point[(i + 1) % corners]);
            point[count++] = 0.5 * (point[i] + middle);
        }
        if (corners > 1) point[count++] = middle;
    }
};

void UnionNormals::start(double margin) {
    margin_ = margin;
    for (int list = 0; list < 2; ++list) keep_parts(list, 0);
    contacts_.clear();
}

std::uint32_t UnionNormals::add_part(int list, const Part& part) {
    parts_[list].push_back(part);
    to_local_[list].push_back(is_sharp_box(part.shape) ? glm::inverse(part.pose.rotation) : glm::dmat3(1.0));
    return static_cast<std::uint32_t>(parts_[list].size() - 1);
}

void UnionNormals::add_contact(std::uint32_t first, std::uint32_t second, const Manifold& manifold) {
    if (manifold.count == 0) return;
    Contact& contact = contacts_.emplace_back();
    contact.part[0] = first;
    contact.part[1] = second;
    contact.normal = manifold.normal;
    contact.depth = manifold.depth;
    contact.count = manifold.count;
    std::copy_n(manifold.points, manifold.count, contact.points);
}

UnionNormals::Neighbor UnionNormals::neighbor_of(int list, std::uint32_t own, std::uint32_t other) const {
    const ShapeAtPose shape = placed(list, other);
    const double tolerance = flush_tolerance(placed(list, own), shape);
    const double reach = shape.shape.is_bounded() ? reach_of(shape.shape) + tolerance : HUGE_VAL;
    return {other, shape, tolerance, reach, to_local_[list][other]};
}

bool UnionNormals::Neighbor::is_near(const glm::dvec3& point, double radius) const {
    const glm::dvec3 offset = point - shape.pose.translation;
    const double within = reach + radius;
    if (glm::dot(offset, offset) > within * within * (1.0 + 1e-12)) return false;
    if (!is_box()) return true;
    // Frames are rigid to 1e-6.
    const double wider = (radius + tolerance) * (1.0 + 1e-5) + 1e-5 * tolerance;
    const glm::dvec3 p = glm::abs(to_local * offset), &half = shape.shape.half_extents();
    return p.x <= half.x + wider && p.y <= half.y + wider && p.z <= half.z + wider;
}

bool UnionNormals::Neighbor::holds(const glm::dvec3& point) const {
    if (is_box()) {
        const glm::dvec3 p = glm::abs(to_local * (point - shape.pose.translation)), &half = shape.shape.half_extents();
        return p.x <= half.x + tolerance && p.y <= half.y + tolerance && p.z <= half.z + tolerance;
    }
    const double within = shape.shape.radius() + tolerance;
    if (const Hull* hull = shape.shape.hull()) {
        // Frames are rigid to 1e-6, planes to their error.
        const glm::dvec3 offset = point - shape.pose.translation;
        const double slack = (1e-5 + 2.0 * hull->plane_error()) * (reach + glm::length(offset));
        const double beyond = beyond_planes(*hull, glm::transpose(shape.pose.rotation) * offset);
        if (beyond > within + slack) return false;
        if (beyond < -slack) return true;
    }
    const RigidTransform at{glm::dmat3(1.0), point};
    return are_within(point_at(at), shape, within);
}

// Along one of the box's axes. Frames are rigid to 1e-6.
bool UnionNormals::Neighbor::is_beside(const Samples& polygon) const {
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (int i = 0; i < polygon.corners; ++i) {
        const glm::dvec3 p = to_local * (polygon.point[i] - shape.pose.translation);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    for (int k = 0; k < 3; ++k) {
        const double within = shape.shape.half_extents()[k] + tolerance * (1.0 + 1e-5) + 1e-13 * reach;
        if (low[k] > within || high[k] < -within) return true;
    }
    return false;
}

bool UnionNormals::Neighbor::covers(const glm::dvec3& point, const glm::dvec3& direction) const {
    if (glm::distance(point, shape.pose.translation) > reach) return false;
    if (is_box()) return holds(point) && rises_above(shape, point, direction, tolerance);
    return rises_above(shape, point, direction, tolerance) && holds(point);
}

void UnionNormals::list_near(int list, std::uint32_t own, const glm::dvec3& middle, double radius) const {
    near_.clear();
    for (std::uint32_t other = 0; other < parts_[list].size(); ++other) {
        if (other == own) continue;
        const Neighbor neighbor = neighbor_of(list, own, other);
        if (neighbor.is_near(middle, radius)) near_.push_back(neighbor);
    }
}

bool UnionNormals::is_covered(const glm::dvec3& point, const glm::dvec3& direction) const {
    return std::any_of(near_.begin(), near_.end(),
                       [&](const Neighbor& neighbor) { return neighbor.covers(point, direction); });
}

// Whether a neighbour that rises above the contact's polygon comes to any point of it. A half-space holds a corner,
// too.
bool UnionNormals::meets_polygon(const Neighbor& neighbor, const Samples& samples, const glm::dvec3& direction) {
    if (is_half_space(neighbor.shape) || (neighbor.is_box() && neighbor.is_beside(samples))) return false;
    const ShapeAtPose& shape = neighbor.shape;
    const double within = shape.shape.radius() + neighbor.tolerance;
    // How far its highest point rises above the lowest of the polygon's, and how far it is from all of them.
    const Support top = core_support(shape.shape, Pair::local(shape.pose.rotation, direction));
    const glm::dvec3 way =
        shape.pose.rotation * top.point + (shape.pose.translation - samples.middle) + shape.shape.radius() * direction;
    double lowest = 0.0;
    for (int i = 0; i < samples.corners; ++i)
        lowest = std::min(lowest, glm::dot(direction, samples.point[i] - samples.middle));
    const double away = std::max(0.0, glm::length(way) - samples.radius);
    if (glm::dot(direction, way) - lowest < 0.999 * (kFlatSine * away + neighbor.tolerance)) return false;
    const RigidTransform at{glm::dmat3(1.0), samples.middle};
    for (int i = 1; i + 1 < std::max(samples.corners, 3); ++i) {
        const auto corner = [&](int k) { return samples.point[std::min(k, samples.corners - 1)] - samples.middle; };
        const Shape triangle = ShapeMaker::triangle({corner(0), corner(i), corner(i + 1)});
        const Nearest found = nearest_points(Pair({triangle, at}, shape), nullptr, 0.5 * within, within);
        if (found.lower > within || found.simplex.count == 0) continue;
        glm::dvec3 on_polygon = samples.middle;
        for (int k = 0; k < found.simplex.count; ++k)
            on_polygon += found.simplex.weight[k] * found.simplex.corner[k].on_a;
        if (rises_above(shape, on_polygon, direction, neighbor.tolerance)) return true;
    }
    return false;
}

bool UnionNormals::Neighbor::covers_any(const Samples& samples, const glm::dvec3& direction) const {
    if (is_box() && is_beside(samples)) return false;
    for (int i = 0; i < samples.count; ++i)
        if (covers(samples.point[i], direction)) return true;
    return samples.corners > 1 && meets_polygon(*this, samples, direction);
}

UnionNormals::Samples UnionNormals::samples_of(const Contact& contact, int list) const {
    return {contact, list, flush_tolerance(placed(0, contact.part[0]), placed(1, contact.part[1]))};
}

UnionNormals::State UnionNormals::state_on(int list, const Contact& contact) const {
    if (parts_[list].size() < 2) return State::free;
    const Samples samples = samples_of(contact, list);
    const glm::dvec3 direction = list == 0 ? contact.normal : -contact.normal;
    list_near(list, contact.part[list], samples.middle, samples.radius);
    if (near_.empty()) return State::free;
    int covered = 0;
    for (int i = 0; i < samples.count; ++i)
        if (is_covered(samples.point[i], direction))
            ++covered;
        else if (covered > 0)
            return State::partly_covered;
    if (covered == samples.count) return State::covered;
    if (covered > 0) return State::partly_covered;
    if (samples.corners > 1 && std::any_of(near_.begin(), near_.end(), [&](const Neighbor& neighbor) {
            return meets_polygon(neighbor, samples, direction);
        }))
        return State::partly_covered;
    return State::free;
}

bool UnionNormals::is_of_half_space(const Contact& contact) const {
    return is_half_space(placed(0, contact.part[0])) || is_half_space(placed(1, contact.part[1]));
}

// No other normal parts a shape from a half-space.
UnionNormals::State UnionNormals::state_of(const Contact& contact) const {
    if (is_of_half_space(contact)) return State::free;
    const State first = state_on(0, contact);
    return first == State::covered ? first : std::max(first, state_on(1, contact));
}

// Whether the motion that ends one contact ends the other.
bool UnionNormals::parts_pair(const Contact& by, const Contact& contact) const {
    if (is_of_half_space(contact)) return false;
    const ShapeAtPose a = placed(0, contact.part[0]), b = placed(1, contact.part[1]);
    const double extent = Pair(a, b).extent(by.normal) + a.shape.radius() + b.shape.radius();
    // From the contact to what is farthest along the normal, at most: which corner of a face that is, rounding decides.
    const glm::dvec3& near = contact.points[0].position;
    const double away = glm::distance(a.pose.translation, near) + reach_of(a.shape) +
                        glm::distance(b.pose.translation, near) + reach_of(b.shape);
    return extent <= by.depth + flush_tolerance(a, b) + kFlatSlope * away;
}

// Keeps the points that no neighbour covers, at the front. Returns how many.
int UnionNormals::leave_out_covered(int list, std::uint32_t own, const glm::dvec3& normal, ContactPoint* points,
                                    int count) const {
    if (count == 0) return 0;
    const double side = list == 0 ? 1.0 : -1.0;
    const auto place = [&](int i) { return points[i].position + side * 0.5 * points[i].depth * normal; };
    const glm::dvec3 middle = place(0);
    double radius = 0.0;
    for (int i = 1; i < count; ++i) radius = std::max(radius, glm::distance(place(i), middle));
    list_near(list, own, middle, radius);
    int kept = 0;
    for (int i = 0; i < count; ++i)
        if (!is_covered(place(i), side * normal)) points[kept++] = points[i];
    return kept;
}

// The points of a pair of parts along a normal, but those that neighbours cover. Returns how deep the deepest one is
// with these.
double UnionNormals::gather_along(const glm::dvec3& normal, Contact& contact) const {
    const ShapeAtPose a = placed(0, contact.part[0]), b = placed(1, contact.part[1]);
    const Pair pair(a, b);
    Touch touch;
    touch.normal = normal;
    touch.depth = HUGE_VAL;
    Patch on_a, on_b;
    patch_along(a, normal, a.pose.translation, on_a);
    patch_along(b, -normal, a.pose.translation, on_b);
    GatheredPoints points;
    Gatherer gatherer({a.pose.translation, a.shape.radius(), b.shape.radius(), margin_, pair.size}, touch, points);
    Clipped clipped;
    (void)gather_patches(on_a, on_b, normal, clipped, gatherer);
    double extent = 0.0;
    const Corner deepest = pair.support(normal, extent);
    touch.depth = extent + a.shape.radius() + b.shape.radius();
    if (gatherer.lacks_deepest(1e-9 * pair.size)) {
        add_support(on_a, normal, deepest.on_b, deepest.b, true, gatherer);
        add_support(on_b, -normal, deepest.on_a, deepest.a, false, gatherer);
    }
    move_to_surface(a, b, normal, touch.depth, {points.point, static_cast<std::size_t>(points.count)});
    double most = -HUGE_VAL;
    for (int i = 0; i < points.count; ++i) most = std::max(most, points.point[i].depth);
    int kept = points.count;
    for (int list = 0; list < 2; ++list) kept = leave_out_covered(list, contact.part[list], normal, points.point, kept);
    Manifold manifold;
    manifold.normal = normal;
    if (kept > 0) thin_out(manifold, points.point, kept, 8);
    contact.normal = normal;
    contact.count = manifold.count;
    std::copy_n(manifold.points, manifold.count, contact.points);
    contact.depth = depth_of(contact);
    return most;
}

// The least deep of the free contacts that part the pair as well.
const UnionNormals::Contact* UnionNormals::find_free(const Contact& contact) const {
    const Contact* best = nullptr;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& by = contacts_[i];
        if (states_[i] != State::free) continue;
        if ((best == nullptr || by.depth < best->depth) && parts_pair(by, contact)) best = &by;
    }
    return best;
}

void UnionNormals::replace_by_free() {
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (states_[i] != State::partly_covered && states_[i] != State::covered) continue;
        const Contact* const by = find_free(contacts_[i]);
        if (by == nullptr) continue;
        (void)gather_along(by->normal, contacts_[i]);
        states_[i] = State::replaced;
    }
}

// Along the free face of either part that is least deep, if that is not deep within them: there no way out is plain.
bool UnionNormals::find_own_face(const Contact& contact, Contact& found) const {
    found.count = 0;
    const ShapeAtPose placed_parts[2] = {placed(0, contact.part[0]), placed(1, contact.part[1])};
    const Pair pair(placed_parts[0], placed_parts[1]);
    const double rounding = pair.a.radius() + pair.b.radius();
    double least = kShallow * std::min(reach_of(pair.a), reach_of(pair.b));
    Contact tried;
    tried.part[0] = contact.part[0];
    tried.part[1] = contact.part[1];
    for (int list = 0; list < 2; ++list)
        for (int face = 0; face < face_count(placed_parts[list].shape); ++face) {
            const glm::dvec3 outward = face_normal(placed_parts[list], face);
            if (outward == glm::dvec3(0.0)) continue;
            const glm::dvec3 normal = list == 0 ? outward : -outward;
            const double extent = pair.extent(normal) + rounding;
            if (!(extent < least) || extent < -margin_) continue;
            const double most = gather_along(normal, tried);
            if (tried.count == 0 || tried.depth < most - 1e-9 * pair.size) continue;
            least = extent;
            found = tried;
        }
    return found.count > 0;
}

// Of the contacts still covered that whose own free face is least deep pushes along it. False: none has one.
bool UnionNormals::push_least_deep() {
    Contact best, found;
    best.count = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (states_[i] != State::covered || !find_own_face(contacts_[i], found)) continue;
        if (best.count > 0 && !(found.depth < best.depth)) continue;
        best = found;
        at = i;
    }
    if (best.count == 0) return false;
    contacts_[at] = best;
    states_[at] = State::free;
    return true;
}

// Whether a contact's points are where the shape has sunk in through the part of another, below a thin one or beside a
// sheet: they are out once that contact has pushed.
bool UnionNormals::is_behind(const Contact& contact, const Contact& other) const {
    // One of the two parts is another.
    const bool first_differs = contact.part[0] != other.part[0], second_differs = contact.part[1] != other.part[1];
    if (!(other.depth > 0.0) || first_differs == second_differs) return false;
    if (!parts_pair(other, contact) || parts_pair(contact, other)) return false;
    const int list = first_differs ? 0 : 1;
    const Samples samples = samples_of(contact, list);
    const ShapeAtPose shape = placed(list, other.part[list]);
    const double within = shape.shape.radius() + flush_tolerance(placed(list, contact.part[list]), shape);
    const glm::dvec3 way = (list == 0 ? other.depth : -other.depth) * other.normal;
    const RigidTransform at{glm::dmat3(1.0), samples.middle};
    const Shape swept = ShapeMaker::triangle({glm::dvec3(0.0), way, way});
    return are_within({swept, at}, shape, within);
}

void UnionNormals::replace_behind() {
    for (std::size_t i = 0; i < contacts_.size(); ++i)
        for (std::size_t j = 0; j < contacts_.size() && states_[i] == State::free; ++j) {
            if (i == j || states_[j] != State::free || !is_behind(contacts_[i], contacts_[j])) continue;
            (void)gather_along(contacts_[j].normal, contacts_[i]);
            states_[i] = State::replaced;
        }
}

// A contact's deepest point seen along another normal, up at the face of a part across it. The overlap there is that of
// a ball and the face, or as deep as if both surfaces were flat. If the normals differ too much for that, all of the
// overlap counts, and the point lies below the core of the round part.
void UnionNormals::keep_deepest(const Contact& from, Contact& contact) const {
    const ShapeAtPose parts[2] = {placed(0, contact.part[0]), placed(1, contact.part[1])};
    const Pair pair(parts[0], parts[1]);
    const ContactPoint* deepest = from.points;
    for (int i = 1; i < from.count; ++i)
        if (from.points[i].depth > deepest->depth) deepest = from.points + i;
    const glm::dvec3 half = 0.5 * deepest->depth * from.normal;
    const glm::dvec3 on[2] = {deepest->position + half, deepest->position - half};
    const auto outward = [](int list, const glm::dvec3& normal) { return list == 0 ? normal : -normal; };
    const double turn = glm::dot(from.normal, contact.normal);
    const double extent = pair.extent(contact.normal) + pair.a.radius() + pair.b.radius();
    const bool is_flat = turn > 0.5;
    const int face = parts[0].shape.kind() == Kind::sphere ? 1 : 0;
    const int core = parts[1 - face].shape.radius() > 0.0 ? 1 - face : face;
    const ShapeAtPose &part = parts[face], &other = parts[1 - face];
    const glm::dvec3 normal = outward(face, contact.normal);
    glm::dvec3 at = is_flat ? on[face] : on[core] - parts[core].shape.radius() * outward(core, from.normal);
    const double top = core_support(part.shape, Pair::local(part.pose.rotation, normal)).along + part.shape.radius();
    at += (top - glm::dot(at - part.pose.translation, normal)) * normal;
    ContactPoint& point = contact.points[0];
    point = *deepest;
    point.depth = is_flat ? std::min(extent, deepest->depth / turn) : extent;
    if (other.shape.kind() == Kind::sphere) {
        const glm::dvec3 from_center = at - other.pose.translation;
        const double along = glm::dot(from_center, normal), radius = other.shape.radius();
        const double aside = glm::dot(from_center, from_center) - along * along;
        point.depth = along + std::sqrt(std::max(0.0, radius * radius - aside));
    }
    point.position = at - 0.5 * point.depth * normal;
    contact.count = 1;
    contact.depth = point.depth;
}

// Whether the first contact may be behind that of its part with another: not where the two are apart, nor where the
// contact's motion parts them.
bool UnionNormals::may_be_behind(int list, std::uint32_t part) const {
    const Contact& contact = contacts_[0];
    const ShapeAtPose a = placed(0, list == 0 ? part : 0), b = placed(1, list == 0 ? 0 : part);
    if (is_half_space(a) || is_half_space(b)) return true;
    const Pair pair(a, b);
    const double reach = reach_of(a.shape) + reach_of(b.shape);
    if (glm::dot(pair.offset, pair.offset) > reach * reach * (1.0 + 1e-12)) return false;
    return pair.extent(contact.normal) + pair.rounding() > contact.depth + flush_tolerance(a, b);
}

bool UnionNormals::is_first_left(PartTest counts, PairTouch touch) {
    const Contact& contact = contacts_[0];
    if (is_of_half_space(contact)) return true;
    bool any_covers = false;
    glm::dvec3 middle[2];
    for (int list = 0; list < 2; ++list) {
        const Samples samples = samples_of(contact, list);
        middle[list] = samples.middle;
        const glm::dvec3 direction = list == 0 ? contact.normal : -contact.normal;
        list_near(list, 0, samples.middle, samples.radius);
        for (const Neighbor& neighbor : near_) {
            if (!neighbor.covers_any(samples, direction)) continue;
            if (counts(list, neighbor.number)) return false;
            any_covers = true;
        }
    }
    if (!any_covers) return true;
    // Where nothing covers the contact, it is replaced only if it is behind another one.
    for (int list = 0; list < 2; ++list)
        for (std::uint32_t part = 1; part < parts_[list].size(); ++part) {
            if (!may_be_behind(list, part) || !counts(list, part)) continue;
            const PairContact found = list == 0 ? touch(part, 0) : touch(0, part);
            if (!found.touches || !(found.depth > 0.0)) continue;
            // The way out of the other contact, from here, does not come to the other part.
            if (!neighbor_of(list, 0, part).is_near(middle[list], found.depth)) continue;
            Contact other;
            other.part[0] = list == 0 ? part : 0;
            other.part[1] = list == 0 ? 0 : part;
            other.normal = found.normal;
            other.depth = found.depth;
            other.count = 1;
            other.points[0].position = found.point;
            if (is_behind(contact, other)) return false;
        }
    return true;
}

bool UnionNormals::is_any_covered() const {
    return std::any_of(contacts_.begin(), contacts_.end(),
                       [&](const Contact& contact) { return state_of(contact) != State::free; });
}

void UnionNormals::apply(std::size_t told) {
    if (contacts_.empty() || parts_[0].size() + parts_[1].size() < 3) return;
    raw_.assign(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(told));
    states_.clear();
    for (const Contact& contact : contacts_) states_.push_back(state_of(contact));
    replace_behind();
    replace_by_free();
    std::replace(states_.begin(), states_.end(), State::partly_covered, State::free);
    do {
        replace_by_free();
    } while (push_least_deep());
    for (std::size_t i = 0; i < told; ++i)
        if (contacts_[i].count == 0) keep_deepest(raw_[i], contacts_[i]);
}

}  // namespace crofton::convex
