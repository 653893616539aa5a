// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <string>

#include <crofton/geometry/valid_transform.hpp>

namespace crofton {
namespace {

constexpr double kUnitTolerance = 0.01;    // of a quaternion's length
constexpr double kUnitRounding = 0x1p-50;  // of its squared length: left as it is

}  // namespace

Transform operator*(const Transform& outer, const Transform& inner) {
    return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}

glm::dvec3 operator*(const Transform& transform, const glm::dvec3& point) {
    return transform.linear * point + transform.translation;
}

Result<Transform> from_trs(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    const double squared = glm::dot(rotation, rotation);
    if (!std::isfinite(squared))
        return fail(ErrorCode::non_finite, kNoItem, "transform: the rotation holds a NaN or infinite number");
    const double length = std::sqrt(squared);
    if (!(std::abs(length - 1.0) <= kUnitTolerance))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    {"transform: the quaternion has length ", length, ", not 1 within 1 %; normalise it first"});
    const bool is_unit = std::abs(squared - 1.0) <= kUnitRounding;
    Transform result{glm::mat3_cast(is_unit ? rotation : rotation / length), translation};
    for (int k = 0; k < 3; ++k) result.linear[k] *= scale[k];
    if (auto valid = validate(result); !valid) return valid.error();
    return result;
}

Result<Transform> from_matrix(const glm::dmat4& matrix) {
    const Transform transform{glm::dmat3(matrix), glm::dvec3(matrix[3])};
    if (auto valid = validate(transform); !valid) return valid.error();
    for (int c = 0; c < 4; ++c)
        if (!(matrix[c][3] == (c == 3 ? 1.0 : 0.0)))
            return fail(ErrorCode::unsupported, kNoItem,
                        "transform: the matrix is projective, its last row is not 0 0 0 1");
    return transform;
}

Result<void> validate(const Transform& transform, std::uint64_t item) {
    if (is_valid(transform)) return {};
    const auto bad = [&](ErrorCode code, const char* why) { return fail(code, item, why); };
    for (int k = 0; k < 3; ++k)
        if (!is_finite(transform.linear[k]))
            return bad(ErrorCode::non_finite, "transform: the matrix holds a NaN or infinite number");
    if (!is_finite(transform.translation))
        return bad(ErrorCode::non_finite, "transform: the translation is NaN or infinite");
    if (!glm::all(glm::lessThanEqual(glm::abs(transform.translation), glm::dvec3(kLargestTransformEntry))))
        return bad(ErrorCode::out_of_range, "transform: the translation exceeds 1e15");
    return bad(ErrorCode::out_of_range, "transform: the matrix scales by more than 1e15");
}

bool maps_to_point(const Transform& transform) {
    return transform.linear == glm::dmat3(0.0);
}

}  // namespace crofton
