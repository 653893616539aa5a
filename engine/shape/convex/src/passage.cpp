// SPDX-License-Identifier: MIT
#include "passage.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/swept_triangles.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "map_frame.hpp"

namespace crofton::convex {
namespace {

constexpr int kRounds = 3;
constexpr double kNever = std::numeric_limits<double>::infinity();

double sum_abs(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

// About the point of a triangle that is nearest to x.
glm::dvec3 nearest_on(const glm::dvec3 (&p)[3], const glm::dvec3 (&edge)[3], const glm::dvec3& normal,
                      const glm::dvec3& x) {
    double least = kNever;
    bool within = true;
    glm::dvec3 nearest(0.0);
    for (int e = 0; e < 3; ++e) {
        const glm::dvec3 offset = x - p[e];
        within = within && glm::dot(glm::cross(edge[e], offset), normal) >= 0.0;
        const double squared = glm::dot(edge[e], edge[e]);
        const double at = squared > 0.0 ? std::clamp(glm::dot(offset, edge[e]) / squared, 0.0, 1.0) : 0.0;
        const glm::dvec3 way = offset - at * edge[e];
        if (!(glm::dot(way, way) < least)) continue;
        least = glm::dot(way, way);
        nearest = x - way;
    }
    const double area = glm::dot(normal, normal);
    return within && area > 0.0 ? x - glm::dot(x - p[0], normal) / area * normal : nearest;
}

}  // namespace

// In times from `middle_` on.
struct Passage::Stretch {
    double first, last;
    const double start = first;
    bool is_apart = false;

    // Along an axis, the two are `low` to `high` apart at `middle_`, grown by the shape's extent.
    void cut(double low, double high, double speed, double more) {
        is_apart |= low - more > start * speed || high + more < start * speed;
        if (speed > 0.0) {
            first = std::max(first, low / speed);
            last = std::min(last, high / speed);
        } else if (speed < 0.0) {
            first = std::max(first, high / speed);
            last = std::min(last, low / speed);
        } else if (low > 0.0 || high < 0.0) {
            first = kNever;
        }
    }
};

// In the box's frame p ↦ Aᵀ (p − center), where A are its axes, a box whose axes are skew is within skew(A) of its size
// of one that is upright, and lengths are as those of the surface's frame within skew(A).
//
// Let u be 2^-53. A corner there is off by 8u of its distance from the box, a product with an axis by 4u more, and
// quotients by 2u of the way: below 2^-46 of the size, which counts all of these.
Passage::Passage(const ShapeAtPose& shape, const RigidTransform& surface, const Aabb& bounds,
                 const glm::dvec3& velocity, double from, double to, double tolerance)
    : box_(box_around(shape, surface)), from_(from), to_(to) {
    const glm::dmat3 back = glm::inverse(surface.rotation);
    velocity_ = back * velocity;
    speed_ = glm::length(velocity_);
    const double turn = 3.0 * skew(surface.rotation), bent = 3.0 * skew(box_.axes);
    radius_ = box_.radius * (1.0 + 2.0 * (turn + bent));
    box_.radius = 0.0;
    more_ = 0.5 * tolerance * (1.0 + 2.0 * (turn + bent));
    left_ = more_ + bent * sum_abs(box_.half) + 2.0 * box_.rounding;
    // Far from the surface it is not near: times around the nearest are enough.
    const glm::dvec3 apart = bounds.center() - box_.center;
    const double reach = glm::length(bounds.half_extents()),
                 size = (reach + sum_abs(box_.half) + radius_ + left_ + more_) * 1.0001;
    middle_ = std::min(std::max(glm::dot(apart, velocity_) / (speed_ * speed_), from), to);
    box_.center += middle_ * velocity_;
    box_.rounding += 0x1p-51 * (sum_abs(apart) + sum_abs(bounds.center()) + middle_ * speed_);
    const double around = (size + box_.rounding) * (1.0 + 0x1p-40) / speed_;
    is_late_ = middle_ - around > from_;
    from_ = std::max(from_, middle_ - around);
    to_ = std::min(to_, middle_ + around);
    if (glm::length(bounds.center() - box_.center) > 2.0 * size + 4.0 * box_.rounding) to_ = -kNever;
    left_ += 2.0 * box_.rounding + 0x1p-46 * (4.0 * size + sum_abs(bounds.center()));
    to_box_ = glm::transpose(box_.axes);
    along_ = to_box_ * velocity_;
    const Aabb core = bounds_of(box_);
    bounds_ = {core.min - (radius_ + left_), core.max + (radius_ + left_)};
}

void Passage::cut(const glm::dvec3 (&p)[3], const glm::dvec3& axis, Stretch& met) const {
    const double at[3] = {glm::dot(axis, p[0]), glm::dot(axis, p[1]), glm::dot(axis, p[2])};
    const double length = glm::length(axis);
    if (!(length > 1e-140 && length < 1e140)) return;  // of a triangle without area
    const double reach = glm::dot(glm::abs(axis), box_.half) + length * (radius_ + left_);
    met.cut(std::min(at[0], std::min(at[1], at[2])) - reach, std::max(at[0], std::max(at[1], at[2])) + reach,
            glm::dot(axis, along_), length * more_);
}

Passage::Entry Passage::entry(const Triangle& corners, double until) const {
    glm::dvec3 p[3];
    for (std::size_t v = 0; v < 3; ++v) p[v] = to_box_ * (corners[v] - box_.center);
    // Rounding leaves out no triangle that comes at `until` itself: of those alike the least number counts.
    const double last = std::min(until, to_) - middle_;
    Stretch met{from_ - middle_, last + 0x1p-50 * (std::abs(last) + std::abs(middle_))};
    for (int k = 0; k < 3; ++k) {
        const double reach = box_.half[k] + radius_ + left_;
        met.cut(std::min(p[0][k], std::min(p[1][k], p[2][k])) - reach,
                std::max(p[0][k], std::max(p[1][k], p[2][k])) + reach, along_[k], more_);
    }
    if (!(met.first <= met.last)) return {kNever, true};
    const glm::dvec3 edge[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]}, normal = glm::cross(edge[0], edge[1]);
    cut(p, normal, met);
    for (int e = 0; e < 3 && met.first <= met.last; ++e) {
        const glm::dvec3& u = edge[e];
        if (box_.half.x > 0.0) cut(p, {0.0, u.z, -u.y}, met);
        if (box_.half.y > 0.0) cut(p, {-u.z, 0.0, u.x}, met);
        if (box_.half.z > 0.0) cut(p, {u.y, -u.x, 0.0}, met);
        if (radius_ > 0.0) cut(p, glm::cross(u, normal), met);
    }
    // A rounded shape's bound gets closer along the way between its core and the triangle where the bound has it.
    for (int round = 0; round < kRounds && radius_ > 0.0 && met.first <= met.last; ++round) {
        const glm::dvec3 center = met.first * along_;
        const glm::dvec3 near_center = nearest_on(p, edge, normal, center);
        const glm::dvec3 on_core = center + glm::clamp(near_center - center, -box_.half, box_.half);
        cut(p, on_core - (on_core == center ? near_center : nearest_on(p, edge, normal, on_core)), met);
    }
    if (!(met.first <= met.last)) return {kNever, true};
    return {std::max(from_, met.first + middle_), met.is_apart || is_late_};
}

double Passage::entry(const Aabb& box, double until) const {
    Stretch met{from_ - middle_, std::min(until, to_) - middle_};
    for (int k = 0; k < 3; ++k) met.cut(box.min[k] - bounds_.max[k], box.max[k] - bounds_.min[k], velocity_[k], 0.0);
    return met.first <= met.last ? std::max(from_, met.first + middle_) : kNever;
}

void Passage::visit_mesh(const Shape& shape, const double& until, TriangleInPath visit) const {
    if (!(from_ <= to_)) return;
    const mesh::MeshTree& mesh = *shape.mesh();
    const mesh::MeshParts& parts = mesh.parts();
    const MapFrame frame(ShapeMaker::map_of(shape));
    const auto offer = [&](const mesh::MeshLeaf& leaf, std::uint32_t lane) {
        Triangle corners;
        for (int v = 0; v < 3; ++v)
            corners[static_cast<std::size_t>(v)] =
                glm::dvec3(glm::vec3(leaf.vertex[v][0][lane], leaf.vertex[v][1][lane], leaf.vertex[v][2][lane]));
        visit(frame.image(corners), leaf.triangle[lane]);
    };
    if (!frame.is_usable()) {
        for (const mesh::MeshLeaf& leaf : parts.leaves)
            for (std::uint32_t lane = 0; lane < leaf.count; ++lane) offer(leaf, lane);
        return;
    }
    QueryBox core = box_;
    glm::dvec3 velocity = velocity_;
    double speed = speed_, radius = radius_, left = left_;
    if (frame.map != nullptr) {
        core.radius = radius_;
        core = frame.box(core);
        velocity = frame.inverse * velocity_;
        speed = glm::length(velocity);
        radius = 0.0;
        left = left_ * frame.stretch * (1.0 + 2.0 * frame.error) + core.rounding;
    }
    const glm::dvec3 way = velocity / speed;
    mesh::SweptBox swept{};
    double size = static_cast<double>(mesh.extent());
    for (int k = 0; k < 3; ++k) {
        swept.box.core.center[k] = static_cast<float>(core.center[k]);
        swept.box.core.half[k] = static_cast<float>(core.half[k]);
        for (int i = 0; i < 3; ++i) swept.box.core.axes[k][i] = static_cast<float>(core.axes[k][i]);
        swept.way[k] = static_cast<float>(way[k]);
        size += std::abs(core.center[k]) + 50.0 * core.half[k];  // axes are orthonormal to 4e-6 alone
    }
    const auto on_way = [&](double time) { return (time - middle_) * speed; };
    const double longest = std::max(std::abs(on_way(from_)), std::abs(on_way(to_)));
    const double doubt = 0x1p-19 * longest;
    swept.box.radius = static_cast<float>(radius * 1.00001);
    swept.box.error = static_cast<float>(left + 0x1p-18 * (size + longest) + 2.0 * frame.error * longest) +
                      std::numeric_limits<float>::min();
    swept.from = static_cast<float>(on_way(from_) - doubt);
    swept.to = static_cast<float>(on_way(to_) + doubt);
    float limit = swept.to;
    const auto lessen = [&] { limit = std::min(limit, static_cast<float>(on_way(until) + doubt)); };
    lessen();
    mesh::visit_swept_triangles(parts.nodes.data(), parts.leaves.data(), swept, limit,
                                [&](const mesh::MeshLeaf& leaf, std::uint32_t lane) {
                                    offer(leaf, lane);
                                    lessen();
                                    return false;
                                });
}

}  // namespace crofton::convex
