// SPDX-License-Identifier: MIT
// Random convex shapes and poses, and pairs that nearly touch.
#pragma once
#include <crofton/convex/query.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>
#include <vector>

namespace crofton::testing {

[[nodiscard]] inline RigidTransform at(const glm::dvec3& p) {
    return {glm::dmat3(1.0), p};
}

class RandomShapes {
  public:
    explicit RandomShapes(std::uint64_t seed) : random_(seed) {}

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 v(number(-1, 1), number(-1, 1), number(-1, 1));
            if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
        }
    }
    glm::dmat3 rotation() {
        const double angle = number(0.0, 6.2);
        return glm::mat3_cast(glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * direction()));
    }
    // Points of a sphere, a box, a thin plate or a long rod, times `size`.
    std::vector<glm::vec3> points(int count, double size = 1.0) {
        glm::dvec3 scale(size);
        const int form = index(4);
        if (form == 2) scale.z *= 1e-3;
        if (form == 3) scale.y *= 0.02, scale.z *= 0.02;
        std::vector<glm::vec3> result;
        for (int i = 0; i < count; ++i)
            result.emplace_back(scale *
                                (form == 1 ? glm::dvec3(number(-1, 1), number(-1, 1), number(-1, 1)) : direction()));
        return result;
    }
    convex::Shape hull(int count, double size = 1.0) {
        hulls_.push_back(std::make_unique<convex::Hull>(convex::Hull::build(points(count, size)).value()));
        return convex::Shape::hull(*hulls_.back());
    }
    convex::Shape box(double size = 1.0) {
        return convex::Shape::box(glm::vec3(size * glm::dvec3(number(0.1, 1), number(0.1, 1), number(0.1, 1)))).value();
    }
    convex::Shape polytope(int count, double size = 1.0) {
        const int kind = index(8);
        if (kind == 0) {
            const auto p = points(3, size);
            return convex::Shape::triangle(p[0], p[1], p[2]).value();
        }
        return kind < 4 ? box(size) : hull(4 + index(count - 3), size);
    }
    // A point of the shape's surface: a corner, or on an edge or a face of it, as far as convex combinations of few
    // vertices that are far along one direction tell.
    glm::dvec3 surface_point(const convex::Shape& shape, const glm::dvec3& d) {
        return convex::support_point(shape, d);
    }

  private:
    std::mt19937_64 random_;
    std::vector<std::unique_ptr<convex::Hull>> hulls_;
};

struct CasePair {
    RigidTransform pose_a, pose_b;
    glm::dvec3 normal;  // from a to b, about where they touch
    glm::dvec3 touch;   // about the point
};

// b stands so that along a direction it is `gap` away from a: its farthest point above a's. Half of the directions are
// normals of faces of a.
inline CasePair nearly_touching(RandomShapes& random, const convex::Shape& a, const convex::Shape& b, double gap,
                                double offset) {
    CasePair result;
    result.pose_a = {random.rotation(), offset * glm::dvec3(1.0, -0.7, 0.3)};
    result.pose_b = {random.index(3) != 0 ? random.rotation() : result.pose_a.rotation, glm::dvec3(0.0)};
    glm::dvec3 local = random.direction();
    if (a.hull() != nullptr && random.index(2) != 0)
        local = a.hull()->face_normal(random.index(a.hull()->face_count()));
    if (a.kind() == convex::Kind::box && random.index(2) != 0) local = glm::dvec3(0.0, 1.0, 0.0);
    result.normal = glm::normalize(result.pose_a.rotation * local);
    result.touch = result.pose_a.translation + result.pose_a.rotation * convex::support_point(a, local);
    const glm::dvec3 back = glm::transpose(result.pose_b.rotation) * -result.normal;
    result.pose_b.translation =
        result.touch - result.pose_b.rotation * convex::support_point(b, back) + gap * result.normal;
    return result;
}

}  // namespace crofton::testing
