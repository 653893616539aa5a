// SPDX-License-Identifier: MIT
// Convex shapes from the fuzzer's bytes, and poses in which two of them nearly touch.
#pragma once
#include <crofton/convex/shape.hpp>
#include <memory>

#include "shapes.hpp"

namespace crofton::fuzz {

class ConvexShapes {
  public:
    explicit ConvexShapes(Shapes& in) : in_(in) {}

    convex::Shape shape() {
        using convex::Shape;
        const unsigned kind = in_.below(8);
        if (kind == 0) return round();
        if (kind == 1) {
            glm::vec3 corners[3];
            for (glm::vec3& p : corners) p = glm::vec3(in_.point());
            return *Shape::triangle(corners[0], corners[1], corners[2]);
        }
        if (kind < 4) {
            glm::vec3 half;
            for (int k = 0; k < 3; ++k) half[k] = in_.extent();
            return *Shape::box(half);
        }
        std::vector<glm::vec3> points(4 + in_.below(6));
        for (glm::vec3& p : points) p = glm::vec3(in_.point());
        auto hull = convex::Hull::build(points);
        if (!hull) return *Shape::box(glm::vec3(1.0f));
        hulls_.push_back(std::make_unique<convex::Hull>(std::move(*hull)));
        return Shape::hull(*hulls_.back());
    }

    // A pose of b, next to a.
    RigidTransform touching(const convex::Shape& a, const RigidTransform& pose_a, const convex::Shape& b) {
        RigidTransform pose;
        pose.rotation = in_.flag() ? pose_a.rotation : in_.rotation();
        glm::dvec3 normal = in_.direction();
        if (a.hull() != nullptr && in_.flag()) normal = a.hull()->face_normal(in_.byte() % a.hull()->face_count());
        const glm::dvec3 world = pose_a.rotation * normal;
        const glm::dvec3 on_a = pose_a.rotation * convex::support_point(a, normal);
        const glm::dvec3 on_b = pose.rotation * convex::support_point(b, glm::transpose(pose.rotation) * -world);
        pose.translation = pose_a.translation + on_a - on_b + in_.nudge();
        return pose;
    }

  private:
    convex::Shape round() {
        using convex::Shape;
        const float radius = in_.extent(), height = in_.extent();
        switch (in_.below(5)) {
            case 0:
                return *Shape::sphere(radius);
            case 1:
                return *Shape::capsule(height, radius);
            case 2:
                return *Shape::cylinder(height, radius);
            case 3:
                return *Shape::cone(height, radius);
            default:
                return *Shape::rounded(*Shape::box(glm::vec3(height)), radius);
        }
    }

    Shapes& in_;
    std::vector<std::unique_ptr<convex::Hull>> hulls_;
};

}  // namespace crofton::fuzz
