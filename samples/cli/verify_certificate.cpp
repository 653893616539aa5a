#include "verify_certificate.hpp"

#include <array>
#include <cmath>
#include <crofton/geometry/dyadic.hpp>
#include <vector>

namespace crofton::cli {
namespace {

// The half-space as a function of t on the box: slope · t + base ≥ 0.
struct Row {
    std::array<double, 3> slope;
    double base;
};

std::vector<Row> rows_of(const Frustum& frustum, const Obb& box) {
    std::vector<Row> rows;
    for (const Plane& plane : frustum.view()) {
        Row row{};
        row.base = plane.offset;
        for (int j = 0; j < 3; ++j) row.base += plane.normal[j] * (box.center[j] - frustum.origin[j]);
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                row.slope[std::size_t(k)] += plane.normal[j] * double{box.axes[k][j]} * double{box.half_extents[k]};
        rows.push_back(row);
    }
    return rows;
}

Dyadic exact_slope(const Plane& plane, const Obb& box, int k) {
    Dyadic sum;
    for (int j = 0; j < 3; ++j)
        sum = sum + Dyadic(plane.normal[j]) * (Dyadic(double{box.axes[k][j]}) * Dyadic(double{box.half_extents[k]}));
    return sum;
}

Dyadic exact_base(const Frustum& frustum, const Plane& plane, const Obb& box) {
    Dyadic sum(plane.offset);
    for (int j = 0; j < 3; ++j)
        sum = sum + Dyadic(plane.normal[j]) * (Dyadic(box.center[j]) - Dyadic(frustum.origin[j]));
    return sum;
}

bool is_common_point(const Frustum& frustum, const Obb& box, const std::array<double, 3>& t) {
    for (const double coordinate : t)
        if (!(std::fabs(coordinate) <= 1.0)) return false;
    for (const Plane& plane : frustum.view()) {
        Dyadic value = exact_base(frustum, plane, box);
        for (int k = 0; k < 3; ++k) value = value + exact_slope(plane, box, k) * Dyadic(t[std::size_t(k)]);
        if (value.sign() < 0) return false;
    }
    return true;
}

bool excludes(const Frustum& frustum, const Obb& box, const std::vector<double>& factors) {
    Dyadic largest;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (factors[i] < 0.0) return false;
        if (factors[i] > 0.0) largest = largest + Dyadic(factors[i]) * exact_base(frustum, frustum.planes[i], box);
    }
    for (int k = 0; k < 3; ++k) {
        Dyadic slope;
        for (std::size_t i = 0; i < factors.size(); ++i)
            if (factors[i] > 0.0) slope = slope + Dyadic(factors[i]) * exact_slope(frustum.planes[i], box, k);
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
bool guess_point(std::vector<Row> rows, std::array<double, 3>& middle) {
    for (std::size_t k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            Row face{};
            face.slope[k] = side;
            face.base = 1.0;
            rows.push_back(face);
        }
    middle = {};
    int found = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = i + 1; j < rows.size(); ++j)
            for (std::size_t k = j + 1; k < rows.size(); ++k) {
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
                for (const Row& row : rows)
                    inside =
                        inside && row.base + row.slope[0] * t[0] + row.slope[1] * t[1] + row.slope[2] * t[2] >= -1e-10;
                if (!inside) continue;
                ++found;
                for (std::size_t c = 0; c < 3; ++c) middle[c] += t[c];
            }
    for (double& coordinate : middle) coordinate = std::fmax(-1.0, std::fmin(1.0, coordinate / std::fmax(1, found)));
    return found > 0;
}

// The factors, of one to three half-spaces, whose sum over the box is most negative: at the best ones, as many slopes
// as there are half-spaces less one vanish.
std::vector<double> guess_factors(const std::vector<Row>& rows) {
    std::vector<double> best(rows.size(), 0.0), factors(rows.size());
    double best_value = 0.0;
    const auto consider = [&] {
        double sum = 0.0, value = 0.0;
        std::array<double, 3> slope{};
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (factors[i] < 0.0) return;
            sum += factors[i];
            value += factors[i] * rows[i].base;
            for (std::size_t k = 0; k < 3; ++k) slope[k] += factors[i] * rows[i].slope[k];
        }
        value += std::fabs(slope[0]) + std::fabs(slope[1]) + std::fabs(slope[2]);
        if (sum > 0.0 && value / sum < best_value) {
            best_value = value / sum;
            best = factors;
        }
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        factors.assign(rows.size(), 0.0);
        factors[i] = 1.0;
        consider();
        for (std::size_t j = i + 1; j < rows.size(); ++j)
            for (std::size_t k = 0; k < 3; ++k) {
                factors.assign(rows.size(), 0.0);
                factors[i] = std::fabs(rows[j].slope[k]);
                factors[j] = std::fabs(rows[i].slope[k]);
                if (rows[i].slope[k] * rows[j].slope[k] < 0.0) consider();
                for (std::size_t l = j + 1; l < rows.size(); ++l) {
                    const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
                    const auto cross = [&](std::size_t a, std::size_t b) {
                        return rows[a].slope[p] * rows[b].slope[q] - rows[a].slope[q] * rows[b].slope[p];
                    };
                    const double x = cross(j, l), y = cross(l, i), z = cross(i, j);
                    const double sign = x + y + z < 0.0 ? -1.0 : 1.0;
                    factors.assign(rows.size(), 0.0);
                    factors[i] = sign * x;
                    factors[j] = sign * y;
                    factors[l] = sign * z;
                    consider();
                }
            }
    }
    return best;
}

}  // namespace

Proof prove(const Frustum& frustum, const Obb& box) {
    const std::vector<Row> rows = rows_of(frustum, box);
    if (excludes(frustum, box, guess_factors(rows))) return Proof::disjoint;
    std::array<double, 3> point;
    if (guess_point(rows, point) && is_common_point(frustum, box, point)) return Proof::meets;
    return Proof::none;
}

}  // namespace crofton::cli
