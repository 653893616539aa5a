// SPDX-License-Identifier: MIT
// Does a triangle meet a frustum? Exactly, for any number of planes.
#include <array>
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/dyadic.hpp>

namespace crofton {
namespace {

// The triangle's points are λa·a + λb·b + λc·c with λ ≥ 0; plane i keeps those with Σ λ_v f_i(v) ≥ 0, f_i(v) its value
// at corner v. The triangle meets the frustum iff the cone { λ : rows · λ ≥ 0 } (unit rows for λ ≥ 0 included) is more
// than 0. Being pointed it then has an extreme ray, which is the cross product of two of the rows.
constexpr std::uint32_t kMaxRows = Frustum::kMaxPlanes + 3;

// A row in double: `value` within 6·2^-53·`size` of the exact one (difference, product, three additions).
struct Row {
    std::array<double, 3> value;
    std::array<double, 3> size;
};

struct Rows {
    const Frustum& frustum;
    const std::array<const glm::dvec3*, 3> corners;
    std::array<Row, kMaxRows> rows;
    std::uint32_t count = 0;

    [[nodiscard]] Dyadic exact(std::uint32_t row, std::uint32_t corner) const {
        if (row >= frustum.plane_count) return Dyadic(row - frustum.plane_count == corner ? 1.0 : 0.0);
        const Plane& plane = frustum.planes[row];
        Dyadic sum(plane.offset);
        for (int j = 0; j < 3; ++j)
            sum = sum + Dyadic(plane.normal[j]) * (Dyadic((*corners[corner])[j]) - Dyadic(frustum.origin[j]));
        return sum;
    }
};

constexpr double kUnit = 0x1p-53;
// Products this small may have lost bits to underflow; the exact path decides.
constexpr double kTiny = 1e-200;
// Added to the size of what is multiplied further: what underflow takes from it, 2^-1074, is then within the bounds.
constexpr double kLost = 1e-290;

Rows rows_of(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    Rows result{frustum, {&a, &b, &c}, {}, frustum.plane_count + 3};
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        const Plane& plane = frustum.planes[i];
        for (std::uint32_t v = 0; v < 3; ++v) {
            const glm::dvec3 d = *result.corners[v] - frustum.origin;
            const double x = plane.normal.x * d.x, y = plane.normal.y * d.y, z = plane.normal.z * d.z;
            result.rows[i].value[v] = x + y + z + plane.offset;
            result.rows[i].size[v] = std::fabs(x) + std::fabs(y) + std::fabs(z) + std::fabs(plane.offset) + kLost;
        }
    }
    for (std::uint32_t v = 0; v < 3; ++v) {
        Row& unit = result.rows[frustum.plane_count + v];
        unit = {};
        unit.value[v] = unit.size[v] = 1.0;
    }
    return result;
}

// −1 or +1 where the filter is sure of the sign of f_i(corner), else 0.
int certain_sign(const Row& row, std::uint32_t corner) {
    const double bound = 8.0 * kUnit * row.size[corner] + kTiny;
    return row.value[corner] > bound ? 1 : row.value[corner] < -bound ? -1 : 0;
}

// Sign of det(row i, row j, row m): m's value on the ray i × j. Six products of three entries, each entry within 6u of
// its size: (18 + 2 + 5)u in all, doubled for the higher orders.
int determinant_sign(const Rows& rows, std::uint32_t i, std::uint32_t j, std::uint32_t m) {
    const Row &p = rows.rows[i], &q = rows.rows[j], &r = rows.rows[m];
    double value = 0.0, size = 0.0;
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned x = (k + 1) % 3, y = (k + 2) % 3;
        value += r.value[k] * (p.value[x] * q.value[y] - p.value[y] * q.value[x]);
        size += r.size[k] * (p.size[x] * q.size[y] + p.size[y] * q.size[x] + kLost);
    }
    const double bound = 50.0 * kUnit * size + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    Dyadic sum;
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned x = (k + 1) % 3, y = (k + 2) % 3;
        sum = sum + rows.exact(m, k) * (rows.exact(i, x) * rows.exact(j, y) - rows.exact(i, y) * rows.exact(j, x));
    }
    return sum.sign();
}

// Whether i × j or its opposite, if not 0, satisfies all rows.
bool is_extreme_ray(const Rows& rows, std::uint32_t i, std::uint32_t j) {
    int side = 0;
    for (std::uint32_t m = rows.count; m-- > 0;) {
        if (m == i || m == j) continue;
        const int sign = determinant_sign(rows, i, j, m);
        if (sign * side < 0) return false;
        if (sign != 0) side = sign;
    }
    // A ray that is not 0 has a component k that is not 0. It is not perpendicular to unit row k, which was therefore
    // asked.
    return side != 0;
}

}  // namespace

bool intersects(const Frustum& frustum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const Rows rows = rows_of(frustum, a, b, c);
    std::array<bool, 3> corner_inside{true, true, true};
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        int outside = 0;
        for (std::uint32_t v = 0; v < 3; ++v) {
            const int sign = certain_sign(rows.rows[i], v);
            outside += sign < 0;
            corner_inside[v] = corner_inside[v] && sign > 0;
        }
        if (outside == 3) return false;
    }
    if (corner_inside[0] || corner_inside[1] || corner_inside[2]) return true;
    for (std::uint32_t i = 0; i < rows.count; ++i)
        for (std::uint32_t j = i + 1; j < rows.count; ++j)
            if (is_extreme_ray(rows, i, j)) return true;
    return false;
}

}  // namespace crofton
