// SPDX-License-Identifier: MIT
#include "part_query.hpp"

#include <algorithm>
#include <crofton/convex/shape_maker.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

#include "core_query.hpp"
#include "pair.hpp"
#include "triangle_touch.hpp"

namespace crofton::convex {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Shapes of parts and a shape this near to them, or nearer, may be told to meet: `Pair::doubt` of any pair of parts. An
// offset between parts is at most twice as large as the size here.
double doubt_of_parts(const ShapeAtPose& a, const ShapeAtPose& b) {
    const auto has_corners = [](const Shape& shape) {
        return shape.has_polytope_core() || shape.kind() == Kind::mesh || shape.kind() == Kind::height_field;
    };
    const double size =
        a.shape.core_radius() + b.shape.core_radius() + glm::length(b.pose.translation - a.pose.translation);
    return 4.0 * (has_corners(a.shape) && has_corners(b.shape) ? kRoundedDoubt : kRoundDoubt) * size;
}

// Improves `best` by the distances of a's parts from b, nearest first.
void search_nearest(const ShapeAtPose& a, const ShapeAtPose& b, Distance& best, double& lower) {
    const double doubt = doubt_of_parts(a, b);
    double limit = std::max(best.distance, doubt);
    const auto visit = [&](const Part& part) {
        const ShapeAtPose placed{part.shape, part.pose};
        Distance d;
        if (b.shape.is_convex()) {
            d = near_distance(placed, b, limit);
        } else {
            // The other's nearest part is asked for within the same limit.
            Distance inner;
            inner.distance = limit;
            double inner_lower = kInfinity;
            search_nearest(b, placed, inner, inner_lower);
            d = flipped(inner);
            d.lower = std::min(inner_lower, limit);
        }
        lower = std::min(lower, d.lower);
        if (d.distance < best.distance) {
            best = d;
            best.part_a = part.id;
            limit = std::max(d.distance, doubt);
        }
        return best.distance == 0.0;
    };
    if (is_unbounded(b))
        visit_parts(a, {}, kEverything, visit);
    else
        visit_nearest_parts(a, box_around(b, a.pose), limit, visit);
}

// Two meshes as the search through both of their trees sees them: the vertices of b are rounded to a's frame. It tells
// meshes apart that are farther apart than that, and finds a pair of triangles for the others.
struct MeshesInOneFrame {
    RigidTransform b_to_a;
    double error;        // of lengths there, at most
    bool keeps_lengths;  // a's pose is a rotation up to rounding
};
std::optional<MeshesInOneFrame> meshes_in_one_frame(const ShapeAtPose& a, const ShapeAtPose& b) {
    const auto is_plain_mesh = [](const Shape& shape) {
        return shape.kind() == Kind::mesh && ShapeMaker::map_of(shape) == nullptr;
    };
    if (!is_plain_mesh(a.shape) || !is_plain_mesh(b.shape)) return std::nullopt;
    const glm::dmat3& rotation = a.pose.rotation;
    const glm::dmat3 back = glm::inverse(rotation);
    const RigidTransform b_to_a{back * b.pose.rotation, back * (b.pose.translation - a.pose.translation)};
    if (!validate(b_to_a)) return std::nullopt;
    const double size = a.shape.core_radius() + b.shape.core_radius() + glm::length(b_to_a.translation);
    const glm::dmat3 gram = glm::transpose(rotation) * rotation;
    double skew = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) skew = std::max(skew, std::abs(gram[i][k] - (i == k ? 1.0 : 0.0)));
    return MeshesInOneFrame{b_to_a, 4e-12 * size, skew < 1e-13};
}

// The distance of one triangle of each mesh, as their shapes stand.
Distance distance_of_triangles(const ShapeAtPose& a, const ShapeAtPose& b, const mesh::MeshDistance& pair) {
    const Shape of_a = ShapeMaker::triangle(a.shape.mesh()->parts().triangle(pair.places.a)),
                of_b = ShapeMaker::triangle(b.shape.mesh()->parts().triangle(pair.places.b));
    Distance d = distance({of_a, a.pose}, {of_b, b.pose});
    d.part_a = {0, pair.triangles.first};
    d.part_b = {0, pair.triangles.second};
    return d;
}

// Whether two meshes meet; nothing if they are not two meshes, or touch by no more than rounding.
std::optional<bool> meshes_meet(const ShapeAtPose& a, const ShapeAtPose& b) {
    const auto frame = meshes_in_one_frame(a, b);
    if (!frame) return std::nullopt;
    const mesh::MeshTree &tree_a = *a.shape.mesh(), &tree_b = *b.shape.mesh();
    mesh::PairOfPlaces pair;
    if (mesh::intersects(tree_a, tree_b, frame->b_to_a, nullptr, &pair)) {
        const Shape of_a = ShapeMaker::triangle(tree_a.parts().triangle(pair.a)),
                    of_b = ShapeMaker::triangle(tree_b.parts().triangle(pair.b));
        if (intersects({of_a, a.pose}, {of_b, b.pose})) return true;
        return std::nullopt;
    }
    if (!mesh::closer_than(tree_a, tree_b, frame->b_to_a, frame->error)) return false;
    return std::nullopt;
}

}  // namespace

bool visit_parts_near(const ShapeAtPose& a, const ShapeAtPose& b, double margin, PartVisitor visit) {
    if (is_unbounded(b)) return visit_parts(a, {}, kEverything, visit);
    return visit_parts(a, box_around(b, a.pose), margin + doubt_of_parts(a, b), visit);
}

bool visit_parts_near(const ShapeAtPose& a, const ShapeAtPose& b, double margin, PartVisitor convex,
                      TriangleVisitor triangle) {
    if (is_unbounded(b)) return visit_parts(a, {}, kEverything, convex, triangle);
    return visit_parts(a, box_around(b, a.pose), margin + doubt_of_parts(a, b), convex, triangle);
}

// Most triangles near a sphere or a capsule are told in closed form.
bool parts_meet(const ShapeAtPose& a, const ShapeAtPose& b) {
    if (const auto meet = meshes_meet(a, b)) return *meet;
    const auto visit = [&](const Part& part) { return intersects({part.shape, part.pose}, b); };
    if (b.shape.kind() != Kind::sphere && b.shape.kind() != Kind::capsule) return visit_parts_near(a, b, 0.0, visit);
    return visit_parts_near(a, b, 0.0, visit, [&](const PartSearch& of, const Triangle& corners, std::uint32_t) {
        const glm::dvec3& origin = of.pose.translation;
        Touch touch;
        const Warm warm =
            SegmentTouch(b, origin, of.shape->core_radius(), 0.0).ask(placed_triangle(corners, of.pose, origin), touch);
        if (warm != Warm::unknown) return warm == Warm::touching;
        return intersects({ShapeMaker::triangle(corners), of.pose}, b);
    });
}

Distance distance_of_parts(const ShapeAtPose& a, const ShapeAtPose& b, double limit) {
    Distance best;
    best.distance = limit;
    double lower = kInfinity;
    if (const auto frame = meshes_in_one_frame(a, b)) {
        const mesh::MeshDistance pair =
            mesh::distance(*a.shape.mesh(), *b.shape.mesh(), frame->b_to_a, limit * (1.0 + 1e-5) + frame->error);
        if (!(pair.distance < kInfinity)) {
            best.distance = kInfinity;
            return best;
        }
        if (const Distance d = distance_of_triangles(a, b, pair); d.distance < best.distance) best = d;
        lower = std::max(0.0, pair.distance - frame->error);
        if (best.distance == 0.0 || (frame->keeps_lengths && lower > 0.0)) {
            best.lower = std::min(best.lower, lower);
            if (!(best.distance < limit)) best.distance = kInfinity;
            return best;
        }
        lower = best.distance < limit ? best.lower : kInfinity;
    }
    search_nearest(a, b, best, lower);
    if (!(best.distance < limit)) {
        if (limit < kInfinity) best.distance = kInfinity;
        return limit < kInfinity ? best : Distance{};  // a pose with NaN
    }
    best.lower = std::min(lower, best.distance);
    return best;
}

Penetration penetration_of_parts(const ShapeAtPose& a, const ShapeAtPose& b) {
    Penetration deepest;
    visit_parts_near(a, b, 0.0, [&](const Part& part) {
        const Penetration p = penetration({part.shape, part.pose}, b);
        if (p.overlapping && (!deepest.overlapping || p.depth > deepest.depth)) {
            const double lower = std::max(deepest.lower, p.lower);
            deepest = p;
            deepest.part_a = part.id;
            deepest.lower = lower;
        }
        return false;
    });
    if (deepest.overlapping) deepest.upper = kInfinity;
    return deepest;
}

void parts_near(const ShapeAtPose& shape, const ShapeAtPose& other, double margin, Vector<Part>& parts) {
    parts.clear();
    if (shape.shape.is_convex()) return parts.push_back({shape.shape, shape.pose, {}, Sides::both});
    visit_parts_near(shape, other, margin, [&](const Part& part) {
        parts.push_back(part);
        return false;
    });
}

}  // namespace crofton::convex
