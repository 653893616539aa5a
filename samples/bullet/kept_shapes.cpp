// SPDX-License-Identifier: MIT
#include "kept_shapes.hpp"

#include <cstring>
#include <string_view>
#include <vector>

namespace crofton::bullet {
namespace {

// What the shape is made of: half extents, a radius, or points; the last is the rounding.
std::vector<float> numbers_of(const btCollisionShape& shape) {
    std::vector<float> numbers;
    const auto add = [&](const btVector3& v) { numbers.insert(numbers.end(), {v.x(), v.y(), v.z()}); };
    switch (shape.getShapeType()) {
        case BOX_SHAPE_PROXYTYPE:
            add(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
            break;
        case SPHERE_SHAPE_PROXYTYPE:
            numbers.push_back(static_cast<const btSphereShape&>(shape).getRadius());
            break;
        default: {
            const auto& hull = static_cast<const btConvexHullShape&>(shape);
            for (int i = 0; i < hull.getNumPoints(); ++i) add(hull.getScaledPoint(i));
            numbers.push_back(hull.getMargin());
        }
    }
    return numbers;
}

std::size_t fingerprint_of(const btCollisionShape& shape, const std::vector<float>& numbers) {
    const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
    return std::hash<std::string_view>()(bytes) + static_cast<std::size_t>(shape.getShapeType());
}

void make(const btCollisionShape& shape, const std::vector<float>& numbers, KeptShape& made) {
    const auto take = [&](const Result<convex::Shape>& found) {
        if (found) made.shape = *found;
    };
    switch (shape.getShapeType()) {
        case BOX_SHAPE_PROXYTYPE:
            return take(convex::Shape::box({numbers[0], numbers[1], numbers[2]}));
        case SPHERE_SHAPE_PROXYTYPE:
            return take(convex::Shape::sphere(numbers[0]));
        default: {
            std::vector<glm::vec3> points;
            for (std::size_t i = 0; i + 3 < numbers.size(); i += 3)
                points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
            auto hull = convex::Hull::build(points);
            if (!hull) return;
            const convex::Shape core = convex::Shape::hull(made.hull.emplace(std::move(*hull)));
            if (numbers.back() == 0.0f) return take(core);
            return take(convex::Shape::rounded(core, numbers.back()));
        }
    }
}

}  // namespace

bool has_shape(int shape_type) {
    return shape_type == BOX_SHAPE_PROXYTYPE || shape_type == CONVEX_HULL_SHAPE_PROXYTYPE ||
           shape_type == SPHERE_SHAPE_PROXYTYPE;
}

std::shared_ptr<const KeptShape> KeptShapes::get(const btCollisionShape& shape) {
    const std::vector<float> numbers = numbers_of(shape);
    const std::size_t fingerprint = fingerprint_of(shape, numbers);
    std::shared_ptr<const KeptShape>& known = shapes_[&shape];
    if (!known || known->fingerprint != fingerprint) {
        auto made = std::make_shared<KeptShape>();
        made->fingerprint = fingerprint;
        make(shape, numbers, *made);
        known = std::move(made);
    }
    return known->shape ? known : nullptr;
}

}  // namespace crofton::bullet
