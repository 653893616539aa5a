// SPDX-License-Identifier: MIT
#include "search/polish.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>

namespace crofton::fit {
namespace {

constexpr double kLongestSlide = 0.04;  // radians a slide may go
constexpr double kFlush = 1e-10;        // points this near a face lie on it (normalised coordinates)

// The frames whose axis `first.axis` is perpendicular to one edge and axis `second.axis` to another, by the angle of
// the first from its place in `frame`.
struct Slide {
    glm::dmat3 frame;
    FlushEdge first, second;

    [[nodiscard]] bool at(double angle, glm::dmat3& out) const {
        const glm::dvec3 start = frame[first.axis];
        const glm::dvec2 turn = cosine_sine(angle);
        const glm::dvec3 n = glm::normalize(turn.x * start + turn.y * glm::cross(first.direction, start));
        const glm::dvec3 across = glm::cross(second.direction, n);
        const double length = glm::length(across);
        if (!(length > 1e-6)) return false;
        const glm::dvec3 m = across * ((glm::dot(across, frame[second.axis]) >= 0.0 ? 1.0 : -1.0) / length);
        const int third = 3 - first.axis - second.axis;
        out[first.axis] = n;
        out[second.axis] = m;
        const glm::dvec3 last = glm::cross(n, m);
        out[third] = glm::dot(last, frame[third]) >= 0.0 ? last : -last;
        return true;
    }
};

// Writes to `near` the points that may lie on a face for a frame within about kLongestSlide of this one.
void collect_near(std::span<const glm::dvec3> points, const glm::dmat3& frame, Vector<glm::dvec3>& near) {
    near.clear();
    std::array<glm::dvec3, 6> top;
    std::array<double, 6> height;
    height.fill(-1e300);
    for (const glm::dvec3& p : points)
        for (std::size_t side = 0; side < 6; ++side) {
            const double t = (side % 2 == 0 ? 1.0 : -1.0) * glm::dot(p, frame[static_cast<int>(side / 2)]);
            if (t > height[side]) {
                height[side] = t;
                top[side] = p;
            }
        }
    for (const glm::dvec3& p : points)
        for (std::size_t side = 0; side < 6; ++side) {
            const double t = (side % 2 == 0 ? 1.0 : -1.0) * glm::dot(p, frame[static_cast<int>(side / 2)]);
            if (height[side] - t <= 3.0 * kLongestSlide * glm::distance(p, top[side])) {
                near.push_back(p);
                break;
            }
        }
}

void collect_edges(std::span<const glm::dvec3> points, const glm::dmat3& frame, Vector<FlushEdge>& edges) {
    edges.clear();
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const glm::dvec3 normal = side % 2 == 0 ? frame[axis] : -frame[axis];
        double height = -1e300;
        for (const glm::dvec3& p : points) height = std::max(height, glm::dot(p, normal));
        std::array<glm::dvec3, 4> flush;
        std::size_t count = 0;
        for (const glm::dvec3& p : points)
            if (count < flush.size() && height - glm::dot(p, normal) <= kFlush) flush[count++] = p;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = i + 1; j < count; ++j) {
                // Made perpendicular to the axis, so that the slide starts at the frame.
                glm::dvec3 d = flush[j] - flush[i];
                d -= glm::dot(d, frame[axis]) * frame[axis];
                if (const double length = glm::length(d); length > 1e-6) edges.push_back({axis, d / length});
            }
    }
}

// Sets `best` to the frame of least value along a slide in the direction of `sign`, found by doubling steps and golden
// section. Returns false if none is lower.
bool minimise(const Weights& weights, std::span<const glm::dvec3> points, const Slide& slide, double sign,
              const Steps& steps, Candidate& best) {
    glm::dmat3 frame;
    const auto value = [&](double angle) {
        return slide.at(sign * angle, frame) ? value_of(weights, points, frame) : 1e300;
    };
    const double enough = best.value * (1.0 - 1e-12);
    double a = 0.0, b = steps.first, at_b = value(b);
    if (!(at_b < enough)) return false;
    double c = 2.0 * b, at_c = value(c);
    while (at_c < at_b && c < kLongestSlide) {
        a = b;
        b = c;
        at_b = at_c;
        c *= 2.0;
        at_c = value(c);
    }
    constexpr double kGolden = 0.3819660112501051;
    for (int step = 0; step < 60 && c - a > steps.last; ++step) {
        const bool right = c - b > b - a;
        const double x = right ? b + kGolden * (c - b) : b - kGolden * (b - a);
        const double at_x = value(x);
        if (at_x < at_b) {
            (right ? a : c) = b;
            b = x;
            at_b = at_x;
        } else {
            (right ? c : a) = x;
        }
    }
    if (!(value(b) < enough)) return false;
    best = {frame, at_b};
    return true;
}

}  // namespace

void polish(const Weights& weights, std::span<const glm::dvec3> points, Candidate& candidate, SearchBuffers& buffers,
            const Steps& steps) {
    for (int round = 0; round < 12; ++round) {
        collect_near(points, candidate.axes, buffers.near);
        collect_edges(buffers.near, candidate.axes, buffers.edges);
        Candidate best{candidate.axes, value_of(weights, buffers.near, candidate.axes)};
        const double start = best.value;
        for (const FlushEdge& first : buffers.edges)
            for (const FlushEdge& second : buffers.edges) {
                if (first.axis >= second.axis) continue;
                const Slide slide{candidate.axes, first, second};
                if (!minimise(weights, buffers.near, slide, 1.0, steps, best))
                    (void)minimise(weights, buffers.near, slide, -1.0, steps, best);
            }
        if (!(best.value < start)) return;
        const double value = value_of(weights, points, best.axes);
        if (!(value < candidate.value)) return;
        candidate = {best.axes, value};
    }
}

}  // namespace crofton::fit
