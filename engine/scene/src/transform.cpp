#include <cmath>
#include <crofton/scene/transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

namespace crofton::scene {
namespace {

constexpr double kSmallest = 1e-15;
constexpr double kLargest = 1e15;
constexpr double kSingular = 1e-12;

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Transform operator*(const Transform& outer, const Transform& inner) {
    return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}

glm::dvec3 operator*(const Transform& transform, const glm::dvec3& point) {
    return transform.linear * point + transform.translation;
}

Transform from_trs(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    glm::dmat3 linear = glm::mat3_cast(rotation);
    for (int k = 0; k < 3; ++k) linear[k] *= scale[k];
    return {linear, translation};
}

Result<Transform> from_matrix(const glm::dmat4& matrix) {
    const Transform transform{glm::dmat3(matrix), glm::dvec3(matrix[3])};
    if (auto valid = validate(transform); !valid) return tl::unexpected(valid.error());
    for (int c = 0; c < 4; ++c)
        if (!(matrix[c][3] == (c == 3 ? 1.0 : 0.0)))
            return fail(ErrorCode::unsupported, kNoItem,
                        "transform: the matrix is projective, its last row is not 0 0 0 1");
    return transform;
}

Result<void> validate(const Transform& transform, std::uint64_t item) {
    const auto bad = [&](ErrorCode code, const char* why) {
        return fail(code, item, std::string("transform: ") + why);
    };
    for (int k = 0; k < 3; ++k)
        if (!is_finite(transform.linear[k]))
            return bad(ErrorCode::non_finite, "the matrix holds a NaN or infinite number");
    if (!is_finite(transform.translation)) return bad(ErrorCode::non_finite, "the translation is NaN or infinite");
    double scale = 1.0;
    for (int k = 0; k < 3; ++k) {
        const double length = glm::length(transform.linear[k]);
        if (length == 0.0) return bad(ErrorCode::degenerate, "the matrix is singular: it has a zero column");
        if (!(length >= kSmallest && length <= kLargest))
            return bad(ErrorCode::out_of_range, "the matrix scales by less than 1e-15 or more than 1e15");
        if (!(std::abs(transform.translation[k]) <= kLargest))
            return bad(ErrorCode::out_of_range, "the translation exceeds 1e15");
        scale *= length;
    }
    if (!(std::abs(glm::determinant(transform.linear)) > kSingular * scale))
        return bad(ErrorCode::degenerate, "the matrix is singular: it flattens space");
    return {};
}

}  // namespace crofton::scene
