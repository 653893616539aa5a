// SPDX-License-Identifier: MIT
#include "search/local_search.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/finite.hpp>
#include <glm/geometric.hpp>

#include "search/calipers.hpp"

namespace crofton::fit {
namespace {

// Turns about axes[k] to the best angle; true if the value fell by more than rounding.
bool turn(const Weights& weights, std::span<const glm::dvec3> points, int k, Candidate& candidate,
          SearchBuffers& buffers) {
    const glm::dvec3 axis = candidate.axes[k], x = candidate.axes[(k + 1) % 3], y = candidate.axes[(k + 2) % 3];
    buffers.flat.resize(points.size());
    buffers.hull.resize(points.size() + 1);
    double low = kInfinity, high = -kInfinity;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = glm::dot(points[i], axis);
        low = std::min(low, t);
        high = std::max(high, t);
        buffers.flat[i] = {glm::dot(points[i], x), glm::dot(points[i], y)};
    }
    const double c = high - low;
    const std::size_t size = convex_hull(buffers.flat, buffers.hull);
    const Calipers best = minimal_rectangle(std::span<const glm::dvec2>(buffers.hull).first(size),
                                            weights.product * c + weights.pairs, weights.pairs * c + weights.sum);
    const double value = weights(best.width, best.height, c);
    if (!(value < candidate.value * (1.0 - 1e-14))) return false;
    const glm::dvec3 along = glm::normalize(best.direction.x * x + best.direction.y * y);
    candidate.axes[(k + 1) % 3] = along;
    candidate.axes[(k + 2) % 3] = glm::normalize(glm::cross(axis, along));
    candidate.value = value;
    return true;
}

}  // namespace

glm::dvec3 widths(std::span<const glm::dvec3> points, const glm::dmat3& axes) {
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (const glm::dvec3& p : points) {
        const glm::dvec3 t(glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2]));
        low = glm::min(low, t);
        high = glm::max(high, t);
    }
    return high - low;
}

double value_of(const Weights& weights, std::span<const glm::dvec3> points, const glm::dmat3& axes) {
    const glm::dvec3 w = widths(points, axes);
    return weights(w.x, w.y, w.z);
}

void descend(const Weights& weights, std::span<const glm::dvec3> points, Candidate& candidate, SearchBuffers& buffers) {
    candidate.value = value_of(weights, points, candidate.axes);
    // Each turn ends at one of finitely many flush angles with a lower value. The limit of 60 is for slow zigzags.
    for (int step = 0, idle = 0; idle < 3 && step < 60; ++step)
        idle = turn(weights, points, step % 3, candidate, buffers) ? 0 : idle + 1;
}

glm::dmat3 frame_along(const glm::dvec3& first) {
    const glm::dvec3 size = glm::abs(first);
    glm::dvec3 other(0.0);
    other[size.x <= size.y ? (size.x <= size.z ? 0 : 2) : (size.y <= size.z ? 1 : 2)] = 1.0;
    const glm::dvec3 second = glm::normalize(glm::cross(first, other));
    return {first, second, glm::cross(first, second)};
}

void tetrahedral_frames(std::span<const glm::dvec3> points, Vector<glm::dmat3>& frames) {
    // The widest pair.
    glm::dvec3 a = points[0], b = points[0];
    double widest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            const glm::dvec3 d = points[i] - points[j];
            if (const double length = glm::dot(d, d); length > widest) {
                widest = length;
                a = points[i];
                b = points[j];
            }
        }
    if (widest == 0.0) return;
    const glm::dvec3 line = glm::normalize(b - a);
    glm::dvec3 c = a;
    double farthest = 0.0;
    for (const glm::dvec3& p : points) {
        const glm::dvec3 away = glm::cross(p - a, line);
        if (const double distance = glm::dot(away, away); distance > farthest) {
            farthest = distance;
            c = p;
        }
    }
    const auto add_triangle = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
        const glm::dvec3 edges[3] = {q - p, r - q, p - r};
        const glm::dvec3 normal = glm::cross(edges[0], edges[1]);
        const double size = glm::length(normal);
        if (!(size > 0.0)) return;
        for (const glm::dvec3& edge : edges) {
            const glm::dvec3 along = glm::normalize(edge), up = normal / size, across = glm::cross(up, along);
            if (!(glm::dot(across, across) > 0.25)) continue;  // the triangle is flat but for rounding
            const glm::dvec3 second = glm::normalize(across);
            // Rounding tilts the normal of a sliver along it. The proof of the exact search turns one of these frames,
            // as if it were orthonormal.
            const bool tilted = std::abs(glm::dot(up, along)) > 1e-12;
            frames.push_back({along, second, tilted ? glm::cross(along, second) : up});
        }
    };
    if (!(farthest > 1e-30)) {
        frames.push_back(frame_along(line));
        return;
    }
    add_triangle(a, b, c);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    glm::dvec3 top = a, bottom = a;
    double high = 0.0, low = 0.0;
    for (const glm::dvec3& p : points) {
        const double t = glm::dot(p - a, normal);
        if (t > high) {
            high = t;
            top = p;
        }
        if (t < low) {
            low = t;
            bottom = p;
        }
    }
    for (const glm::dvec3& apex : {top, bottom}) {
        if (apex == a) continue;
        add_triangle(a, b, apex);
        add_triangle(b, c, apex);
        add_triangle(c, a, apex);
    }
}

}  // namespace crofton::fit
