// SPDX-License-Identifier: MIT
// Box against convex volume, exactly: certificates in double first, vertex enumeration where they do not decide.
#include <algorithm>
#include <array>
#include <cmath>

#include "exact/box_constraints.hpp"

namespace crofton::cull {
namespace {

// u = 2^-53 times this bounds the error of a combination y · (slopes, base) + Σ|y · slope| relative to Σ y_i size_i.
// Entries have 7u, at most three products and additions per entry 5u, four additions and absolute values 4u.
constexpr double kCombinationRounding = 32.0 * kUnit;

struct Weighted {
    double weight;
    const Constraint& constraint;
};

// A combination Σ y_i · constraint_i, y ≥ 0, that is negative on the whole cube proves that no point satisfies all.
template <class... Terms>
bool separates(const Terms&... terms) {
    if (!((terms.weight >= 0.0) && ...)) return false;
    double projected_radius = 0.0;
    for (unsigned k = 0; k < 3; ++k) projected_radius += std::fabs(((terms.weight * terms.constraint.slope[k]) + ...));
    const double base = ((terms.weight * terms.constraint.base) + ...);
    const double size = ((terms.weight * terms.constraint.size()) + ...);
    return base + projected_radius < -(kCombinationRounding * size + kTiny);
}

// Tries the separating axes across an edge of the frustum and one of the box. base + Σ|slope| of (1−y) i + y j is
// convex and piecewise linear in y, so its minimum lies where one slope vanishes.
bool edge_separates(const Constraint& i, const Constraint& j) {
    for (unsigned k = 0; k < 3; ++k)
        if (i.slope[k] * j.slope[k] < 0.0 &&
            separates(Weighted{std::fabs(j.slope[k]), i}, Weighted{std::fabs(i.slope[k]), j}))
            return true;
    return false;
}

// Tries the separating axes of a vertex of the frustum and a face of the box: two slopes vanish.
bool vertex_separates(const Constraint& a, const Constraint& b, const Constraint& c) {
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned p = (k + 1) % 3, q = (k + 2) % 3;
        double x = b.slope[p] * c.slope[q] - b.slope[q] * c.slope[p];
        double y = c.slope[p] * a.slope[q] - c.slope[q] * a.slope[p];
        double z = a.slope[p] * b.slope[q] - a.slope[q] * b.slope[p];
        if (x < 0.0 || (x == 0.0 && (y < 0.0 || (y == 0.0 && z < 0.0)))) x = -x, y = -y, z = -z;
        if (y >= 0.0 && z >= 0.0 && separates(Weighted{x, a}, Weighted{y, b}, Weighted{z, c})) return true;
    }
    return false;
}

// Looks for a point of the box inside all planes by projecting onto the most violated one; true is proof.
bool finds_witness(std::span<const Constraint> constraints, int rounds) {
    double t[3] = {0.0, 0.0, 0.0};
    for (int round = 0; round < rounds; ++round) {
        double worst = 0.0;
        const Constraint* violated = nullptr;
        for (const Constraint& c : constraints) {
            const double value = c.base + c.slope[0] * t[0] + c.slope[1] * t[1] + c.slope[2] * t[2];
            // Entries 7u and at most 4 roundings more each; the stored t is exact by definition.
            const double margin = value - (16.0 * kUnit * c.size() + kTiny);
            const double steepness = std::fabs(c.slope[0]) + std::fabs(c.slope[1]) + std::fabs(c.slope[2]);
            if (margin < 0.0 && (!violated || margin < worst * steepness)) {
                violated = &c;
                worst = steepness > 0.0 ? margin / steepness : -1e300;
            }
        }
        if (!violated) return true;
        // Move against the gap, a little past the plane, with the clamped coordinates' share taken by the free ones.
        for (int pass = 0; pass < 3; ++pass) {
            const double value =
                violated->base + violated->slope[0] * t[0] + violated->slope[1] * t[1] + violated->slope[2] * t[2];
            double free_norm = 0.0;
            for (unsigned k = 0; k < 3; ++k)
                if (std::fabs(t[k]) < 1.0 || violated->slope[k] * t[k] < 0.0)
                    free_norm += violated->slope[k] * violated->slope[k];
            if (!(free_norm > 0.0)) return false;
            const double projected_radius = violated->projected_radius();
            const double step = (-value + 1e-3 * projected_radius) / free_norm;
            for (unsigned k = 0; k < 3; ++k) t[k] = std::min(1.0, std::max(-1.0, t[k] + step * violated->slope[k]));
            if (violated->base + violated->slope[0] * t[0] + violated->slope[1] * t[1] + violated->slope[2] * t[2] >
                0.0)
                break;
        }
    }
    return false;
}

// All rows (slope, base) of the polytope in t: the planes, then the cube's faces t_k + 1 ≥ 0 and 1 − t_k ≥ 0.
// The polytope is bounded, so if it is not empty it has a vertex, where three independent rows vanish. In homogeneous
// coordinates it is their generalised cross product.
template <class Box>
class Enumeration {
  public:
    Enumeration(const Frustum& frustum, const Box& box, const Constraint* constraints) : frustum_(frustum), box_(box) {
        for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
            const Constraint& c = constraints[i];
            value_[i] = {c.slope[0], c.slope[1], c.slope[2], c.base};
            size_[i] = {c.slope_size[0], c.slope_size[1], c.slope_size[2], c.base_size};
        }
        count_ = frustum.plane_count;
        for (unsigned face = 0; face < 6; ++face, ++count_) {
            value_[count_] = {0.0, 0.0, 0.0, 1.0};
            value_[count_][face / 2] = face % 2 ? -1.0 : 1.0;
            for (unsigned k = 0; k < 4; ++k) size_[count_][k] = std::fabs(value_[count_][k]);
        }
    }

    [[nodiscard]] bool has_vertex() {
        for (std::uint32_t i = 0; i < count_; ++i)
            for (std::uint32_t j = i + 1; j < count_; ++j)
                for (std::uint32_t k = j + 1; k < count_; ++k)
                    if (is_vertex({i, j, k})) return true;
        return false;
    }

  private:
    static constexpr std::uint32_t kMaxRows = Frustum::kMaxPlanes + 6;
    using Triple = std::array<std::uint32_t, 3>;

    template <class Number>
    static Number minor(const Number (&r)[3][4], unsigned x, unsigned y, unsigned z) {
        return r[0][x] * (r[1][y] * r[2][z] - r[1][z] * r[2][y]) - r[0][y] * (r[1][x] * r[2][z] - r[1][z] * r[2][x]) +
               r[0][z] * (r[1][x] * r[2][y] - r[1][y] * r[2][x]);
    }

    static double minor_size(const double (&r)[3][4], unsigned x, unsigned y, unsigned z) {
        return r[0][x] * (r[1][y] * r[2][z] + r[1][z] * r[2][y]) + r[0][y] * (r[1][x] * r[2][z] + r[1][z] * r[2][x]) +
               r[0][z] * (r[1][x] * r[2][y] + r[1][y] * r[2][x]);
    }

    [[nodiscard]] bool is_vertex(const Triple& rows) {
        double value[3][4], size[3][4];
        for (unsigned a = 0; a < 3; ++a)
            for (unsigned b = 0; b < 4; ++b) value[a][b] = value_[rows[a]][b], size[a][b] = size_[rows[a]][b];
        const double at[4] = {minor(value, 1, 2, 3), -minor(value, 0, 2, 3), minor(value, 0, 1, 3),
                              -minor(value, 0, 1, 2)};
        const double at_size[4] = {minor_size(size, 1, 2, 3), minor_size(size, 0, 2, 3), minor_size(size, 0, 1, 3),
                                   minor_size(size, 0, 1, 2)};
        exact_ready_ = false;
        int side = 0;
        // Faces first: |t_k| ≤ 1 rejects most triples.
        for (std::uint32_t m = count_; m-- > 0;) {
            if (m == rows[0] || m == rows[1] || m == rows[2]) continue;
            double sum = 0.0, sum_size = 0.0;
            for (unsigned b = 0; b < 4; ++b) sum += value_[m][b] * at[b], sum_size += size_[m][b] * at_size[b];
            // 24 products of four entries, each entry within 7u of its size, three multiplications, at most eight
            // additions deep: 39u; 64u covers the higher orders.
            const double bound = 64.0 * kUnit * sum_size + kTiny;
            const int sign = sum > bound ? 1 : sum < -bound ? -1 : exact_sign(rows, m);
            if (sign * side < 0) return false;
            if (sign != 0) side = sign;
        }
        // A vertex at infinity (weight 0) fails a pair of faces unless it is 0 altogether, where every sign is 0.
        return side != 0;
    }

    [[nodiscard]] Dyadic exact_row(std::uint32_t row, unsigned b) const {
        if (row >= frustum_.plane_count) return Dyadic(value_[row][b]);
        return exact_entry(frustum_.planes[row], frustum_.origin, box_, b);
    }

    [[nodiscard]] int exact_sign(const Triple& rows, std::uint32_t m) {
        if (!exact_ready_) {
            Dyadic entries[3][4];
            for (unsigned a = 0; a < 3; ++a)
                for (unsigned b = 0; b < 4; ++b) entries[a][b] = exact_row(rows[a], b);
            exact_at_[0] = minor(entries, 1, 2, 3);
            exact_at_[1] = -minor(entries, 0, 2, 3);
            exact_at_[2] = minor(entries, 0, 1, 3);
            exact_at_[3] = -minor(entries, 0, 1, 2);
            exact_ready_ = true;
        }
        Dyadic sum;
        for (unsigned b = 0; b < 4; ++b) sum = sum + exact_row(m, b) * exact_at_[b];
        return sum.sign();
    }

    const Frustum& frustum_;
    const Box& box_;
    std::array<std::array<double, 4>, kMaxRows> value_{};
    std::array<std::array<double, 4>, kMaxRows> size_{};
    std::array<Dyadic, 4> exact_at_;
    std::uint32_t count_ = 0;
    bool exact_ready_ = false;
};

}  // namespace

template <class Box>
bool meets(const Frustum& frustum, const Box& box, const Constraint* constraints) {
    // Planes that the whole box is inside of change nothing.
    Frustum crossed;
    crossed.origin = frustum.origin;
    Constraint open[Frustum::kMaxPlanes];
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        if (constraints[i].base - constraints[i].projected_radius() > 12.0 * kUnit * constraints[i].size() + kTiny)
            continue;
        open[crossed.plane_count] = constraints[i];
        crossed.planes[crossed.plane_count++] = frustum.planes[i];
    }
    const std::uint32_t count = crossed.plane_count;
    const std::span<const Constraint> all(open, count);
    std::array<std::uint32_t, Frustum::kMaxPlanes> outside;
    std::uint32_t outside_count = 0;
    for (std::uint32_t i = 0; i < count; ++i)
        if (!(all[i].base > kRounding * kUnit * all[i].base_size + kTiny)) outside[outside_count++] = i;
    if (outside_count == 0) return true;  // the centre is inside
    if (finds_witness(all, 3)) return true;
    // Σ y_i base_i < 0 takes a plane that the centre is outside of.
    for (std::uint32_t n = 0; n < outside_count; ++n)
        for (std::uint32_t j = 0; j < count; ++j)
            if (j != outside[n] && edge_separates(all[outside[n]], all[j])) return false;
    if (finds_witness(all, 16)) return true;
    for (std::uint32_t n = 0; n < outside_count; ++n)
        for (std::uint32_t j = 0; j < count; ++j)
            for (std::uint32_t k = j + 1; k < count; ++k)
                if (j != outside[n] && k != outside[n] && vertex_separates(all[outside[n]], all[j], all[k]))
                    return false;
    return Enumeration<Box>(crossed, box, open).has_vertex();
}

template bool meets(const Frustum&, const Obb&, const Constraint*);
template bool meets(const Frustum&, const Aabb&, const Constraint*);

}  // namespace crofton::cull
