// SPDX-License-Identifier: MIT
#include "search/calipers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

namespace crofton::fit {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

bool comes_before(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

}  // namespace

std::size_t convex_hull(std::span<glm::dvec2> points, std::span<glm::dvec2> hull) {
    std::sort(points.begin(), points.end(), comes_before);
    std::size_t size = 0;
    const auto push = [&](const glm::dvec2& p, std::size_t floor) {
        while (size >= floor + 2 && cross(hull[size - 1] - hull[size - 2], p - hull[size - 1]) <= 0.0) --size;
        if (size == 0 || hull[size - 1] != p) hull[size++] = p;
    };
    for (const glm::dvec2& p : points) push(p, 0);
    const std::size_t lower = size - 1;
    for (std::size_t i = points.size() - 1; i-- > 0;) push(points[i], lower);
    return size > 1 && hull[size - 1] == hull[0] ? size - 1 : size;
}

Calipers minimal_rectangle(std::span<const glm::dvec2> hull, double product_weight, double sum_weight) {
    Calipers best;
    const std::size_t n = hull.size();
    if (n < 2) return best;
    const auto next = [n](std::size_t i) { return i + 1 == n ? 0 : i + 1; };
    bool found = false;
    std::size_t right = 1, top = 1, left = 1;
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec2 edge = hull[next(i)] - hull[i];
        const double length = std::sqrt(glm::dot(edge, edge));
        if (length == 0.0) continue;
        const glm::dvec2 along = edge / length, up(-along.y, along.x);
        const auto advance = [&](std::size_t& k, const glm::dvec2& direction) {
            for (std::size_t steps = 0; steps < n && glm::dot(hull[next(k)] - hull[k], direction) > 0.0; ++steps)
                k = next(k);
        };
        if (!found) {
            right = next(i);
            top = right;
        }
        advance(right, along);
        if (!found) top = right;
        advance(top, up);
        if (!found) left = top;
        advance(left, -along);
        const double width = glm::dot(hull[right] - hull[left], along);
        const double height = std::max(0.0, glm::dot(hull[top] - hull[i], up));
        const double value = product_weight * width * height + sum_weight * (width + height);
        if (!found || value < best.value) best = {along, width, height, value};
        found = true;
    }
    return best;
}

}  // namespace crofton::fit
