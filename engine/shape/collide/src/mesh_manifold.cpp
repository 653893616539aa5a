// SPDX-License-Identifier: MIT
// A few points for the contact of two meshes, from the curve in which their surfaces cross.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <span>

#include "manifold_points.hpp"

namespace crofton::collide {
namespace {

using Contacts = std::span<const mesh::MeshContact>;

struct Curve {
    glm::dvec3 middle{0.0};
    double length = 0.0;
};

Curve curve_of(Contacts contacts) {
    Curve curve;
    glm::dvec3 sum(0.0), plain(0.0);
    for (const mesh::MeshContact& contact : contacts) {
        const glm::dvec3 middle = 0.5 * (contact.segment.begin + contact.segment.end);
        const double length = glm::length(contact.segment.end - contact.segment.begin);
        sum += length * middle;
        plain += middle;
        curve.length += length;
    }
    curve.middle = curve.length > 0.0 ? sum / curve.length : plain / static_cast<double>(contacts.size());
    return curve;
}

glm::dvec3 vector_of(const float (&v)[3]) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// The vector area that the curve goes around, ½ ∮ x × dx: that of a's surface inside b, and of b's inside a, turned
// round. Where it vanishes, against b's normals; at last from centre to centre.
glm::dvec3 normal_of(Contacts contacts, const Curve& curve, const glm::dvec3& between_centers) {
    constexpr double kLeastShare = 1e-6;  // of the squared length: a circle has 1 / 4π
    glm::dvec3 area(0.0), against(0.0);
    for (const mesh::MeshContact& contact : contacts) {
        area += 0.5 * glm::cross(contact.segment.begin - curve.middle, contact.segment.end - curve.middle);
        against -= contact.normal;
    }
    for (const auto& [direction, least] : {std::pair(area, kLeastShare * curve.length * curve.length),
                                           std::pair(against, kLeastShare), std::pair(between_centers, 0.0)})
        if (const double length = glm::length(direction); length > least) return direction / length;
    return {0.0, 0.0, 1.0};
}

// How deep the shapes overlap on the line along the normal through a point of both.
class Overlap {
  public:
    Overlap(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a, const glm::dvec3& normal)
        : a_(a),
          b_(b),
          to_b_(inverse(b_to_a)),
          normal_(normal),
          step_(1e-7 * (static_cast<double>(a.extent()) + static_cast<double>(b.extent()))) {}

    // The middle of the overlap; depth −1 where the point is not in both.
    [[nodiscard]] ContactPoint at(const glm::dvec3& point) const {
        // Points of the curve lie on both surfaces, or beside them by rounding: a step back is inside.
        const glm::dvec3 in_a = point - step_ * normal_, in_b = transform(to_b_, point + step_ * normal_);
        if (!may_contain(a_, in_a) || !may_contain(b_, in_b)) return {point, -1.0};
        const auto up = raycast(Ray{in_a, normal_}, a_), down = raycast(Ray{in_b, -(to_b_.rotation * normal_)}, b_);
        if (!up || !down) return {point, -1.0};
        const double above = up->t - step_, below = down->t - step_;
        return {point + 0.5 * (above - below) * normal_, std::max(0.0, above + below)};
    }

  private:
    // Open meshes have no inside: there the ray alone says.
    static bool may_contain(const mesh::MeshTree& mesh, const glm::dvec3& point) {
        for (const mesh::MeshPiece& piece : mesh.pieces())
            if (!piece.closed) return true;
        return mesh::contains(mesh, point);
    }

    const mesh::MeshTree &a_, &b_;
    RigidTransform to_b_;
    glm::dvec3 normal_;
    double step_;
};

// The points of the curve that are farthest along six directions across the normal.
std::array<glm::dvec3, 6> outermost(Contacts contacts, const glm::dvec3& normal) {
    const glm::dvec3 size = glm::abs(normal);
    const int least = size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2);
    glm::dvec3 axis(0.0);
    axis[least] = 1.0;
    const glm::dvec3 u = glm::normalize(glm::cross(normal, axis)), v = glm::cross(normal, u);
    // At 15°, 75° and 135°: every right angle has one, and the sides of boxes along the axes are met at no right angle,
    // where all their points would be as far.
    constexpr double kCosine = 0.9659258262890683, kSine = 0.25881904510252074, kRoot = 0.7071067811865476;
    const glm::dvec3 directions[3] = {kCosine * u + kSine * v, kSine * u + kCosine * v, kRoot * (v - u)};
    std::array<glm::dvec3, 6> points;
    points.fill(contacts[0].segment.begin);
    for (const mesh::MeshContact& contact : contacts)
        for (const glm::dvec3& end : {contact.segment.begin, contact.segment.end})
            for (std::size_t k = 0; k < 3; ++k) {
                const double along = glm::dot(directions[k], end);
                if (along > glm::dot(directions[k], points[k])) points[k] = end;
                if (along < glm::dot(directions[k], points[k + 3])) points[k + 3] = end;
            }
    return points;
}

void add_once(const ContactPoint& point, double apart, Manifold& manifold) {
    for (int i = 0; i < manifold.count; ++i)
        if (glm::distance(manifold.points[i].position, point.position) <= apart) return;
    manifold.points[manifold.count++] = point;
}

}  // namespace

Manifold contact_manifold(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                          std::span<const mesh::MeshContact> contacts) {
    Manifold manifold;
    if (contacts.empty()) return manifold;
    const Curve curve = curve_of(contacts);
    manifold.normal =
        normal_of(contacts, curve,
                  transform(b_to_a, vector_of(b.parts().root_box.center)) - vector_of(a.parts().root_box.center));
    const Overlap overlap(a, b, b_to_a, manifold.normal);
    const double apart = 1e-6 * curve.length;
    for (const glm::dvec3& outer : outermost(contacts, manifold.normal)) {
        // On the curve itself the overlap ends: a little within it says how deep the shapes are there.
        ContactPoint point{outer, 0.0};
        for (const double share : {1.0 / 16.0, 1.0 / 256.0}) {
            const ContactPoint within = overlap.at(outer + share * (curve.middle - outer));
            if (within.depth < 0.0) continue;
            point = within;
            break;
        }
        add_once(point, apart, manifold);
    }
    // Where the outer points are as deep as the middle, they alone keep the area.
    set_depth(manifold);
    if (const ContactPoint middle = overlap.at(curve.middle); middle.depth > 1.01 * manifold.depth)
        add_once(middle, apart, manifold);
    reduce(manifold);
    set_depth(manifold);
    return manifold;
}

}  // namespace crofton::collide
