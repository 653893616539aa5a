// The input points as the searches see them: checked, normalised, asked only for support points.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/aabb.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::fit {

// The extreme points along each axis: index 2k the farthest along +axes[k], 2k + 1 along −axes[k].
using Supports = std::array<glm::dvec3, 6>;

// Normalised coordinates are (p − origin) / unit with `unit` a power of two: all within [−1, 1]. Every answer depends
// on the set of points alone, never on their order: ties go to the lexicographically least point.
class PointCloud {
  public:
    // Errors: no points; NaN, infinite or beyond kMaxCoordinate: the item is the first such index.
    template <class Point>
    [[nodiscard]] static Result<PointCloud> make(std::span<const Point> points);

    [[nodiscard]] const Aabb& bounds() const { return bounds_; }
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }
    [[nodiscard]] double unit() const { return unit_; }

    [[nodiscard]] Supports supports(const glm::dmat3& axes) const;
    // Appends the two extreme points along each direction.
    void extremes(std::span<const glm::dvec3> directions, Vector<glm::dvec3>& out) const;

  private:
    [[nodiscard]] std::array<glm::dvec3, 2> extreme_pair(const glm::dvec3& direction) const;

    Vector<glm::dvec3> points_;
    Aabb bounds_;
    glm::dvec3 origin_{0.0};
    double unit_ = 1.0;
};

[[nodiscard]] inline bool lexicographic(const glm::dvec3& a, const glm::dvec3& b) {
    if (a.x != b.x) return a.x < b.x;
    return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Sorts and removes duplicates: the canonical order of a point set.
void make_canonical(Vector<glm::dvec3>& points);

}  // namespace crofton::fit
