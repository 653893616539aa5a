// SPDX-License-Identifier: MIT
#include <crofton/geometry/camera.hpp>
#include <crofton/study/convex_body.hpp>
#include <glm/geometric.hpp>

namespace crofton::study {
namespace {

std::size_t farthest(std::span<const glm::dvec3> points, const glm::dvec3& n) {
    std::size_t best = 0;
    double height = glm::dot(points[0], n);
    for (std::size_t i = 1; i < points.size(); ++i)
        if (const double h = glm::dot(points[i], n); h > height) height = h, best = i;
    return best;
}

}  // namespace

ConvexBody ConvexBody::box(const Obb& box) {
    const auto c = corners(box);
    return {{c.begin(), c.end()}, 0.0};
}

Result<ConvexBody> ConvexBody::frustum(const Camera& camera) {
    const auto frustum = frustum_of(camera);
    if (!frustum) return frustum.error();
    const auto c = frustum_corners(*frustum);
    if (!c) return c.error();
    ConvexBody body;
    for (const glm::dvec3& corner : *c) body.points.push_back(frustum->origin + corner);
    return body;
}

double support(const ConvexBody& body, const glm::dvec3& n) {
    return glm::dot(body.points[farthest(body.points, n)], n) + body.radius * glm::length(n);
}

glm::dvec3 support_point(const ConvexBody& body, const glm::dvec3& n) {
    return body.points[farthest(body.points, n)] + body.radius * n;
}

}  // namespace crofton::study
