// SPDX-License-Identifier: MIT
#include "certificate.hpp"

#include <array>
#include <cmath>
#include <crofton/geometry/dyadic.hpp>

namespace crofton::cli {
namespace {

// The half-space as a function of t on the box: slope · t + base ≥ 0. `size`: the sum of the magnitudes of all products
// that base and slopes are made of; in double a sum of them with factors of at most 1 is off by less than kRounding of
// it (a difference, two products and fewer than twenty additions: 24 · 2^-53).
struct Row {
    std::array<double, 3> slope{};
    double base = 0.0, size = 0.0;
};
constexpr double kRounding = 0x1p-48;

// base, and slope k, by their terms: calls add(term) for each, all of which are sums of products of T(stored numbers).
template <class T, class Add>
void base_terms(const Frustum& frustum, const Plane& plane, const Obb& box, const Add& add) {
    for (int j = 0; j < 3; ++j) add(T(plane.normal[j]) * (T(box.center[j]) - T(frustum.origin[j])));
}
template <class T, class Add>
void slope_terms(const Plane& plane, const Obb& box, int k, const Add& add) {
    for (int j = 0; j < 3; ++j) add(T(plane.normal[j]) * (T(double{box.axes[k][j]}) * T(double{box.half_extents[k]})));
}
template <class T, class Add>
void base_terms(const Frustum& frustum, const Plane& plane, const Aabb& box, const Add& add) {
    for (int j = 0; j < 3; ++j) {
        add(T(0.5 * plane.normal[j]) * (T(box.min[j]) - T(frustum.origin[j])));
        add(T(0.5 * plane.normal[j]) * (T(box.max[j]) - T(frustum.origin[j])));
    }
}
template <class T, class Add>
void slope_terms(const Plane& plane, const Aabb& box, int k, const Add& add) {
    add(T(0.5 * plane.normal[k]) * (T(box.max[k]) - T(box.min[k])));
}

struct Rows {
    std::array<Row, Frustum::kMaxPlanes + 6> rows;
    std::size_t count = 0;  // one a plane

    template <class Box>
    Rows(const Frustum& frustum, const Box& box) {
        for (const Plane& plane : frustum.view()) {
            Row& row = rows[count++];
            row.base = plane.offset;
            row.size = std::fabs(plane.offset);
            base_terms<double>(frustum, plane, box, [&](double term) {
                row.base += term;
                row.size += std::fabs(term);
            });
            for (int k = 0; k < 3; ++k)
                slope_terms<double>(plane, box, k, [&](double term) {
                    row.slope[std::size_t(k)] += term;
                    row.size += std::fabs(term);
                });
        }
    }
    [[nodiscard]] double value(std::size_t i, const std::array<double, 3>& t) const {
        const Row& row = rows[i];
        return row.base + row.slope[0] * t[0] + row.slope[1] * t[1] + row.slope[2] * t[2];
    }
};

template <class Box>
Dyadic exact_slope(const Plane& plane, const Box& box, int k) {
    Dyadic sum;
    slope_terms<Dyadic>(plane, box, k, [&](const Dyadic& term) { sum = sum + term; });
    return sum;
}

template <class Box>
Dyadic exact_base(const Frustum& frustum, const Plane& plane, const Box& box) {
    Dyadic sum(plane.offset);
    base_terms<Dyadic>(frustum, plane, box, [&](const Dyadic& term) { sum = sum + term; });
    return sum;
}

template <class Box>
bool is_common_point(const Frustum& frustum, const Box& box, const Rows& rows, const std::array<double, 3>& t) {
    for (const double coordinate : t)
        if (!(std::fabs(coordinate) <= 1.0)) return false;
    for (std::size_t i = 0; i < rows.count; ++i) {
        const double rough = rows.value(i, t), bound = kRounding * rows.rows[i].size;
        if (rough > bound) continue;
        if (rough < -bound) return false;
        const Plane& plane = frustum.planes[i];
        Dyadic value = exact_base(frustum, plane, box);
        for (int k = 0; k < 3; ++k) value = value + exact_slope(plane, box, k) * Dyadic(t[std::size_t(k)]);
        if (value.sign() < 0) return false;
    }
    return true;
}

// Up to three half-spaces, and what each is multiplied by.
struct Factors {
    std::array<std::size_t, 3> plane{};
    std::array<double, 3> factor{};
    std::size_t count = 0;
};

template <class Box>
bool excludes(const Frustum& frustum, const Box& box, const Rows& rows, const Factors& factors) {
    double rough = 0.0, size = 0.0;
    std::array<double, 3> sum{};
    for (std::size_t n = 0; n < factors.count; ++n) {
        const Row& row = rows.rows[factors.plane[n]];
        if (factors.factor[n] < 0.0) return false;
        rough += factors.factor[n] * row.base;
        size += factors.factor[n] * row.size;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += factors.factor[n] * row.slope[k];
    }
    rough += std::fabs(sum[0]) + std::fabs(sum[1]) + std::fabs(sum[2]);
    if (rough < -kRounding * size) return true;
    if (rough > kRounding * size) return false;
    Dyadic largest;
    for (std::size_t n = 0; n < factors.count; ++n)
        largest = largest + Dyadic(factors.factor[n]) * exact_base(frustum, frustum.planes[factors.plane[n]], box);
    for (int k = 0; k < 3; ++k) {
        Dyadic slope;
        for (std::size_t n = 0; n < factors.count; ++n)
            slope = slope + Dyadic(factors.factor[n]) * exact_slope(frustum.planes[factors.plane[n]], box, k);
        largest = largest + abs(slope);
    }
    return largest.sign() < 0;
}

double determinant(const Row& a, const Row& b, const Row& c) {
    return a.slope[0] * (b.slope[1] * c.slope[2] - b.slope[2] * c.slope[1]) -
           a.slope[1] * (b.slope[0] * c.slope[2] - b.slope[2] * c.slope[0]) +
           a.slope[2] * (b.slope[0] * c.slope[1] - b.slope[1] * c.slope[0]);
}

// The middle of all vertices of the common polytope, as far as floating point can tell them.
bool guess_point(Rows all, std::array<double, 3>& middle) {
    auto& rows = all.rows;
    std::size_t count = all.count;
    for (std::size_t k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            Row face{};
            face.slope[k] = side;
            face.base = 1.0;
            rows[count++] = face;
        }
    middle = {};
    int found = 0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
            for (std::size_t k = j + 1; k < count; ++k) {
                const double det = determinant(rows[i], rows[j], rows[k]);
                if (std::fabs(det) < 1e-12) continue;
                std::array<double, 3> t{};
                for (std::size_t c = 0; c < 3; ++c) {
                    Row a = rows[i], b = rows[j], d = rows[k];
                    a.slope[c] = -a.base;
                    b.slope[c] = -b.base;
                    d.slope[c] = -d.base;
                    t[c] = determinant(a, b, d) / det;
                }
                bool inside = true;
                for (std::size_t r = 0; r < count && inside; ++r) inside = all.value(r, t) >= -1e-10;
                if (!inside) continue;
                ++found;
                for (std::size_t c = 0; c < 3; ++c) middle[c] += t[c];
            }
    for (double& coordinate : middle) coordinate = std::fmax(-1.0, std::fmin(1.0, coordinate / std::fmax(1, found)));
    return found > 0;
}

// From the box's centre onto the half-space that is missed by most, again and again.
std::array<double, 3> walk_inside(const Rows& rows) {
    std::array<double, 3> t{};
    for (int step = 0; step < 12; ++step) {
        std::size_t worst = 0;
        double least = 0.0;
        for (std::size_t i = 0; i < rows.count; ++i)
            if (const double value = rows.value(i, t); value < least) {
                least = value;
                worst = i;
            }
        if (least >= 0.0) break;
        const auto& slope = rows.rows[worst].slope;
        double square = 0.0, projected_radius = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            projected_radius += std::fabs(slope[k]);
            if (t[k] * slope[k] < std::fabs(slope[k])) square += slope[k] * slope[k];
        }
        if (!(square > 0.0)) break;
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = std::fmax(-1.0, std::fmin(1.0, t[k] + (0.02 * projected_radius - least) / square * slope[k]));
    }
    return t;
}

// The factors, of one to three half-spaces, whose sum over the box is most negative: at the best ones, as many slopes
// as there are half-spaces less one vanish.
Factors guess_factors(const Rows& all) {
    const auto& rows = all.rows;
    Factors best;
    double best_value = 0.0;
    const auto consider = [&](const Factors& guess) {
        double sum = 0.0, value = 0.0;
        std::array<double, 3> slope{};
        for (std::size_t n = 0; n < guess.count; ++n) {
            if (guess.factor[n] < 0.0) return;
            const Row& row = rows[guess.plane[n]];
            sum += guess.factor[n];
            value += guess.factor[n] * row.base;
            for (std::size_t k = 0; k < 3; ++k) slope[k] += guess.factor[n] * row.slope[k];
        }
        value += std::fabs(slope[0]) + std::fabs(slope[1]) + std::fabs(slope[2]);
        if (sum > 0.0 && value < best_value * sum) {
            best_value = value / sum;
            best = guess;
        }
    };
    for (std::size_t i = 0; i < all.count; ++i) {
        consider({{i}, {1.0}, 1});
        for (std::size_t j = i + 1; j < all.count; ++j)
            for (std::size_t k = 0; k < 3; ++k) {
                if (rows[i].slope[k] * rows[j].slope[k] < 0.0)
                    consider({{i, j}, {std::fabs(rows[j].slope[k]), std::fabs(rows[i].slope[k])}, 2});
                for (std::size_t l = j + 1; l < all.count; ++l) {
                    const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
                    const auto cross = [&](std::size_t a, std::size_t b) {
                        return rows[a].slope[p] * rows[b].slope[q] - rows[a].slope[q] * rows[b].slope[p];
                    };
                    const double x = cross(j, l), y = cross(l, i), z = cross(i, j);
                    const double sign = x + y + z < 0.0 ? -1.0 : 1.0;
                    consider({{i, j, l}, {sign * x, sign * y, sign * z}, 3});
                }
            }
    }
    return best;
}

template <class Box>
Proof prove_box(const Frustum& frustum, const Box& box) {
    const Rows rows(frustum, box);
    if (is_common_point(frustum, box, rows, walk_inside(rows))) return Proof::meets;
    if (excludes(frustum, box, rows, guess_factors(rows))) return Proof::disjoint;
    std::array<double, 3> point;
    if (guess_point(rows, point) && is_common_point(frustum, box, rows, point)) return Proof::meets;
    return Proof::none;
}

}  // namespace

Proof prove(const Frustum& frustum, const Obb& box) {
    return prove_box(frustum, box);
}
Proof prove(const Frustum& frustum, const Aabb& box) {
    return prove_box(frustum, box);
}

}  // namespace crofton::cli
