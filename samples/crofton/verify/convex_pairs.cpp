// SPDX-License-Identifier: MIT
#include "convex_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace crofton::cli {

double ConvexPairs::number(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
}

glm::dvec3 ConvexPairs::direction() {
    for (;;) {
        const double x = number(-1, 1), y = number(-1, 1), z = number(-1, 1);
        const glm::dvec3 v(x, y, z);
        if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
    }
}

glm::dmat3 ConvexPairs::rotation() {
    const double angle = number(0.0, 6.2);
    const glm::dvec3 axis = direction();
    return glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis));
}

convex::Shape ConvexPairs::polytope(int corners, double size, std::unique_ptr<convex::Hull>& hull) {
    const int kind = index(8);
    if (kind < 3) {
        const double x = number(0.1, 1), y = number(0.1, 1), z = number(0.1, 1);
        return *convex::Shape::box(glm::vec3(size * glm::dvec3(x, y, z)));
    }
    glm::dvec3 scale(size);
    const int form = index(4);
    if (form == 2) scale.z *= 1e-3;
    if (form == 3) scale.y = scale.z = 0.02 * size;
    for (;;) {
        std::vector<glm::vec3> points;
        const int count = kind == 3 ? 3 : 4 + index(corners - 3);
        for (int i = 0; i < count; ++i) {
            const double radius = form == 1 ? number(0.3, 1.0) : 1.0;
            points.emplace_back(scale * radius * direction());
        }
        if (kind == 3) return *convex::Shape::triangle(points[0], points[1], points[2]);
        auto built = convex::Hull::build(points);
        if (!built) continue;
        hull = std::make_unique<convex::Hull>(std::move(*built));
        return convex::Shape::hull(*hull);
    }
}

ConvexPairs::Pair ConvexPairs::next(int corners, double gap, double offset) {
    const convex::Shape a = polytope(corners, 1.0, hulls_[0]), b = polytope(corners, 1.0, hulls_[1]);
    return touching(a, b, gap, offset);
}

ConvexPairs::Pair ConvexPairs::next_of_sizes(int corners, double gap, double offset) {
    const double power_a = number(-6.0, 6.0), power_b = number(-6.0, 6.0);
    const double size_a = std::pow(10.0, power_a), size_b = std::pow(10.0, power_b);
    const convex::Shape a = polytope(corners, size_a, hulls_[0]), b = polytope(corners, size_b, hulls_[1]);
    return touching(a, b, std::max(size_a, size_b) * gap, offset);
}

ConvexPairs::Pair ConvexPairs::touching(const convex::Shape& a, const convex::Shape& b, double gap, double offset) {
    Pair pair{a, b, {rotation(), offset * glm::dvec3(1.0, -0.7, 0.3)}, {}, {}};
    pair.pose_b.rotation = index(3) != 0 ? rotation() : pair.pose_a.rotation;
    glm::dvec3 local = direction();
    if (a.hull() != nullptr && index(2) != 0) local = a.hull()->face_normal(index(a.hull()->face_count()));
    if (a.kind() == convex::Kind::box && index(2) != 0) local = glm::dvec3(0.0, 1.0, 0.0);
    pair.normal = glm::normalize(pair.pose_a.rotation * local);
    const glm::dvec3 back = glm::transpose(pair.pose_b.rotation) * -pair.normal;
    pair.pose_b.translation = pair.pose_a.translation + pair.pose_a.rotation * convex::support_point(a, local) -
                              pair.pose_b.rotation * convex::support_point(b, back) + gap * pair.normal;
    return pair;
}

}  // namespace crofton::cli
