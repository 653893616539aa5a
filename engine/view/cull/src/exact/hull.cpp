// SPDX-License-Identifier: MIT
// A convex hull against a view, exactly: by its corners, its triangles, and whether it holds the whole view.
#include <array>
#include <crofton/convex/shape.hpp>
#include <crofton/cull/classify.hpp>

#include "exact/box_constraints.hpp"
#include "exact/numbers.hpp"

namespace crofton::cull {
namespace {

// The sign of the plane's value at the point, exactly: one rounding in the difference, one a product, three additions.
int side(const Plane& plane, const glm::dvec3& origin, const glm::dvec3& point) {
    const glm::dvec3 d = point - origin;
    const double x = plane.normal.x * d.x, y = plane.normal.y * d.y, z = plane.normal.z * d.z;
    const double value = x + y + z + plane.offset;
    const double bound = 8.0 * kUnit * (std::fabs(x) + std::fabs(y) + std::fabs(z) + std::fabs(plane.offset)) + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    Dyadic sum(plane.offset);
    for (int k = 0; k < 3; ++k) sum = sum + Dyadic(plane.normal[k]) * (Dyadic(point[k]) - Dyadic(origin[k]));
    return sum.sign();
}

template <class Number>
Vector3<Number> numbers(const glm::dvec3& v) {
    return {Number(v.x), Number(v.y), Number(v.z)};
}
// Whether the point where planes i, j, k meet, if they do in one, lies in the frustum and in the hull. It is origin +
// point / scale. `unknown`: rounding hides a sign.
template <class Number>
Answer is_common_corner(const Frustum& frustum, const convex::Hull& hull, std::array<std::uint32_t, 3> at,
                        bool& in_frustum) {
    in_frustum = false;
    std::array<Vector3<Number>, 3> normals;
    for (std::size_t k = 0; k < 3; ++k) normals[k] = numbers<Number>(frustum.planes[at[k]].normal);
    const std::array<Vector3<Number>, 3> sides{cross(normals[1], normals[2]), cross(normals[2], normals[0]),
                                               cross(normals[0], normals[1])};
    Number scale = dot(normals[0], sides[0]);
    const bool turned = scale.is_negative();
    if (!turned && !scale.is_positive()) return std::is_same_v<Number, Exact> ? Answer::no : Answer::unknown;
    const Number zero(0.0);
    Vector3<Number> point{zero, zero, zero};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < 3; ++c) point[c] = point[c] - Number(frustum.planes[at[k]].offset) * sides[k][c];
    if (turned) {
        scale = zero - scale;
        for (Number& c : point) c = zero - c;
    }
    const auto sign = [](const Number& value) {
        return value.is_negative() ? -1 : value.is_positive() || std::is_same_v<Number, Exact> ? 1 : 0;
    };
    for (std::uint32_t m = 0; m < frustum.plane_count; ++m) {
        if (m == at[0] || m == at[1] || m == at[2]) continue;
        const int there =
            sign(dot(numbers<Number>(frustum.planes[m].normal), point) + Number(frustum.planes[m].offset) * scale);
        if (there < 0) return Answer::no;
        if (there == 0) return Answer::unknown;
    }
    in_frustum = true;
    const auto indices = hull.triangles();
    const auto origin = numbers<Number>(frustum.origin);
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        std::array<Vector3<Number>, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = numbers<Number>(glm::dvec3(hull.vertices()[indices[t + k]]));
        Vector3<Number> x, y, from;
        for (std::size_t c = 0; c < 3; ++c) {
            x[c] = corner[1][c] - corner[0][c], y[c] = corner[2][c] - corner[0][c];
            from[c] = (corner[0][c] - origin[c]) * scale - point[c];
        }
        const int inner = sign(dot(cross(x, y), from));
        if (inner < 0) return Answer::no;
        if (inner == 0) return Answer::unknown;
    }
    return Answer::yes;
}

// Whether a view that no triangle of the hull meets lies within the hull, not outside. A closed volume in a hull has
// corners, and any one of them decides.
bool holds_view(const Frustum& frustum, const convex::Hull& hull) {
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i)
        for (std::uint32_t j = i + 1; j < frustum.plane_count; ++j)
            for (std::uint32_t k = j + 1; k < frustum.plane_count; ++k) {
                bool in_frustum = false;
                Answer answer = is_common_corner<Bounded>(frustum, hull, {i, j, k}, in_frustum);
                if (answer == Answer::unknown) answer = is_common_corner<Exact>(frustum, hull, {i, j, k}, in_frustum);
                if (in_frustum) return answer == Answer::yes;
            }
    return false;
}

bool meets(const Frustum& frustum, const convex::Hull& hull, std::span<const std::uint32_t> rejected_by) {
    const auto corners = hull.vertices();
    for (const std::uint32_t planes : rejected_by)
        if (planes == 0) return true;
    const auto indices = hull.triangles();
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        const std::uint16_t a = indices[t], b = indices[t + 1], c = indices[t + 2];
        if ((rejected_by[a] & rejected_by[b] & rejected_by[c]) != 0) continue;
        if (intersects(frustum, glm::dvec3(corners[a]), glm::dvec3(corners[b]), glm::dvec3(corners[c]))) return true;
    }
    return holds_view(frustum, hull);
}

}  // namespace

Verdict classify(const Frustum& frustum, const convex::Hull& hull, CullMode mode) {
    if (!is_usable(frustum)) return Verdict::straddling;
    const auto corners = hull.vertices();
    std::array<std::uint32_t, convex::kMaxHullVertices> rejected_by{};  // bit i: plane i has the corner outside
    bool inside = true;
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        bool all_out = true;
        for (std::size_t v = 0; v < corners.size(); ++v) {
            if (side(frustum.planes[i], frustum.origin, glm::dvec3(corners[v])) < 0)
                rejected_by[v] |= 1u << i;
            else
                all_out = false;
        }
        if (all_out) return Verdict::outside;
    }
    for (std::size_t v = 0; v < corners.size(); ++v) inside = inside && rejected_by[v] == 0;
    if (inside) return Verdict::inside;
    const bool keep = mode == CullMode::conservative || meets(frustum, hull, {rejected_by.data(), corners.size()});
    return keep ? Verdict::straddling : Verdict::outside;
}

}  // namespace crofton::cull
