// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <crofton/geometry/dyadic.hpp>
#include <glm/geometric.hpp>

#include "certificate.hpp"

namespace crofton::cli {
namespace {

// Bounds the rounding in double of differences, products and fewer than forty additions, relative to the sum of all
// magnitudes.
constexpr double kBallRounding = 0x1p-46;

// Points are relative to the frustum's origin.
struct Ball {
    glm::dvec3 center;  // rounded
    std::array<Dyadic, 3> exact_center;
    double radius;

    Ball(const Frustum& frustum, const Sphere& ball) : center(ball.center - frustum.origin), radius(ball.radius) {
        for (int j = 0; j < 3; ++j) exact_center[std::size_t(j)] = Dyadic(ball.center[j]) - Dyadic(frustum.origin[j]);
    }
};

double value(const Plane& plane, const glm::dvec3& point) {
    return glm::dot(plane.normal, point) + plane.offset;
}

double size(const Plane& plane, const glm::dvec3& point) {
    return glm::dot(glm::abs(plane.normal), glm::abs(point)) + std::fabs(plane.offset);
}

Dyadic exact_value(const Plane& plane, const std::array<Dyadic, 3>& point) {
    Dyadic sum(plane.offset);
    for (int j = 0; j < 3; ++j) sum = sum + Dyadic(plane.normal[j]) * point[std::size_t(j)];
    return sum;
}

bool is_common_point(const Frustum& frustum, const Ball& ball, const glm::dvec3& point) {
    const glm::dvec3 from_center = point - ball.center;
    const double square = ball.radius * ball.radius, rough = square - glm::dot(from_center, from_center);
    const glm::dvec3 magnitude = glm::abs(point) + glm::abs(ball.center);
    const double bound = kBallRounding * (square + glm::dot(magnitude, magnitude));
    if (rough < -bound) return false;
    const std::array<Dyadic, 3> exact{Dyadic(point.x), Dyadic(point.y), Dyadic(point.z)};
    if (rough <= bound) {
        Dyadic left = Dyadic(ball.radius) * Dyadic(ball.radius);
        for (std::size_t j = 0; j < 3; ++j) {
            const Dyadic step = exact[j] - ball.exact_center[j];
            left = left - step * step;
        }
        if (left.sign() < 0) return false;
    }
    for (const Plane& plane : frustum.view()) {
        const double here = value(plane, point), error = kBallRounding * size(plane, point);
        if (here < -error || (here <= error && exact_value(plane, exact).sign() < 0)) return false;
    }
    return true;
}

// Up to three half-spaces, and what each is multiplied by.
struct BallFactors {
    std::array<std::size_t, 3> plane{};
    std::array<double, 3> factor{};
    std::size_t count = 0;
};

// The sum's largest value on the ball is Σ factor · value(centre) + radius · |Σ factor · normal|.
bool excludes(const Frustum& frustum, const Ball& ball, const BallFactors& factors) {
    double sum = 0.0, total = 0.0;
    glm::dvec3 normal(0.0);
    for (std::size_t n = 0; n < factors.count; ++n) {
        const Plane& plane = frustum.planes[factors.plane[n]];
        if (!(factors.factor[n] >= 0.0)) return false;
        sum += factors.factor[n] * value(plane, ball.center);
        total += factors.factor[n] * (size(plane, ball.center) + 2.0 * ball.radius);
        normal += factors.factor[n] * plane.normal;
    }
    const double rough = sum + ball.radius * glm::length(normal);
    if (rough < -kBallRounding * total) return true;
    if (rough > kBallRounding * total) return false;
    Dyadic at_center;
    std::array<Dyadic, 3> exact;
    for (std::size_t n = 0; n < factors.count; ++n) {
        const Plane& plane = frustum.planes[factors.plane[n]];
        at_center = at_center + Dyadic(factors.factor[n]) * exact_value(plane, ball.exact_center);
        for (int j = 0; j < 3; ++j)
            exact[std::size_t(j)] = exact[std::size_t(j)] + Dyadic(factors.factor[n]) * Dyadic(plane.normal[j]);
    }
    if (at_center.sign() >= 0) return false;
    Dyadic squared_radius;
    for (const Dyadic& component : exact) squared_radius = squared_radius + component * component;
    squared_radius = squared_radius * (Dyadic(ball.radius) * Dyadic(ball.radius));
    return (at_center * at_center - squared_radius).sign() > 0;
}

// The nearest point of the common part of some planes to the ball's centre, and how it comes about: centre + Σ factor ·
// normal. False where they have none in common, or many.
bool project(const Frustum& frustum, const glm::dvec3& center, BallFactors& factors, glm::dvec3& nearest) {
    std::array<std::array<long double, 4>, 3> rows{};
    for (std::size_t a = 0; a < factors.count; ++a) {
        const Plane& plane = frustum.planes[factors.plane[a]];
        for (std::size_t b = 0; b < factors.count; ++b)
            for (int j = 0; j < 3; ++j)
                rows[a][b] += static_cast<long double>(plane.normal[j]) *
                              static_cast<long double>(frustum.planes[factors.plane[b]].normal[j]);
        rows[a][3] = -static_cast<long double>(plane.offset);
        for (int j = 0; j < 3; ++j)
            rows[a][3] -= static_cast<long double>(plane.normal[j]) * static_cast<long double>(center[j]);
    }
    // The matrix is positive definite where the normals are independent: elimination needs no pivots.
    for (std::size_t k = 0; k < factors.count; ++k) {
        if (rows[k][k] < 1e-9L) return false;
        for (std::size_t i = 0; i < factors.count; ++i) {
            if (i == k) continue;
            const long double times = rows[i][k] / rows[k][k];
            for (std::size_t j = 0; j < 4; ++j) rows[i][j] -= times * rows[k][j];
        }
    }
    nearest = center;
    for (std::size_t n = 0; n < factors.count; ++n) {
        factors.factor[n] = static_cast<double>(rows[n][3] / rows[n][n]);
        nearest += factors.factor[n] * frustum.planes[factors.plane[n]].normal;
    }
    return true;
}

bool is_inside(const Frustum& frustum, const glm::dvec3& point) {
    for (const Plane& plane : frustum.view())
        if (value(plane, point) < -1e-9) return false;
    return true;
}

// The point of the frustum nearest to the centre has the largest distance from it among the projections onto one, two
// or three of its planes with factors ≥ 0: each of these bounds the distance from below. `middle`: of the corners.
BallFactors nearest_point(const Frustum& frustum, const glm::dvec3& center, glm::dvec3& nearest, glm::dvec3& middle) {
    BallFactors best;
    nearest = center;
    double farthest = 0.0;
    glm::dvec3 corners(0.0);
    int corner_count = 0;
    const auto consider = [&](BallFactors guess) {
        glm::dvec3 point;
        if (!project(frustum, center, guess, point)) return;
        if (guess.count == 3 && is_inside(frustum, point)) {
            corners += point;
            ++corner_count;
        }
        for (std::size_t n = 0; n < guess.count; ++n)
            if (guess.factor[n] < 0.0) return;
        const double distance = glm::dot(point - center, point - center);
        if (!(distance > farthest)) return;
        farthest = distance;
        nearest = point;
        best = guess;
    };
    for (std::size_t i = 0; i < frustum.plane_count; ++i) {
        consider({{i}, {}, 1});
        for (std::size_t j = i + 1; j < frustum.plane_count; ++j) {
            consider({{i, j}, {}, 2});
            for (std::size_t k = j + 1; k < frustum.plane_count; ++k) consider({{i, j, k}, {}, 3});
        }
    }
    middle = corner_count > 0 ? corners / static_cast<double>(corner_count) : center;
    return best;
}

}  // namespace

Proof prove(const Frustum& frustum, const Sphere& sphere) {
    const Ball ball(frustum, sphere);
    if (is_common_point(frustum, ball, ball.center)) return Proof::meets;
    glm::dvec3 nearest, middle;
    const BallFactors factors = nearest_point(frustum, ball.center, nearest, middle);
    if (excludes(frustum, ball, factors)) return Proof::disjoint;
    // From the nearest point towards the frustum's middle, as far as the ball may reach.
    const double spare = ball.radius - glm::length(nearest - ball.center), way = glm::length(middle - nearest);
    for (const double part : {0.5, 0.1, 0.9, 0.01, 1e-3}) {
        const double step = way > 0.0 ? std::fmin(0.5, part * spare / way) : 0.0;
        if (is_common_point(frustum, ball, nearest + step * (middle - nearest))) return Proof::meets;
    }
    return Proof::none;
}

}  // namespace crofton::cli
