// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton {

Result<void> validate(const RigidTransform& pose, std::uint64_t item) {
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3& c = pose.rotation[i];
        if (!std::isfinite(c.x + c.y + c.z) || !std::isfinite(pose.translation[i]))
            return fail(ErrorCode::non_finite, item, "pose: an entry is NaN or infinite");
        if (std::abs(pose.translation[i]) > 1e18)
            return fail(ErrorCode::out_of_range, item, "pose: translation beyond 1e18");
        for (int j = i; j < 3; ++j)
            if (!(std::abs(glm::dot(c, pose.rotation[j]) - (i == j ? 1.0 : 0.0)) <= 1e-6))
                return fail(ErrorCode::invalid_argument, item, "pose: the matrix is not a rotation to 1e-6");
    }
    return {};
}

glm::dvec3 transform(const RigidTransform& pose, const glm::dvec3& point) {
    glm::dvec3 result;
    for (int i = 0; i < 3; ++i) {
        const double sum = (pose.rotation[0][i] * point.x + pose.rotation[1][i] * point.y) +
                           pose.rotation[2][i] * point.z + pose.translation[i];
        result[i] = std::abs(sum) < 1e-60 ? 0.0 : sum;
    }
    return result;
}

RigidTransform inverse(const RigidTransform& pose) {
    const glm::dmat3 back = glm::transpose(pose.rotation);
    return {back, -(back * pose.translation)};
}

RigidTransform operator*(const RigidTransform& outer, const RigidTransform& inner) {
    return {outer.rotation * inner.rotation, outer.rotation * inner.translation + outer.translation};
}

RigidTransform relative(const RigidTransform& a, const RigidTransform& b) {
    const glm::dmat3 back = glm::transpose(a.rotation);
    return {back * b.rotation, back * (b.translation - a.translation)};
}

}  // namespace crofton
