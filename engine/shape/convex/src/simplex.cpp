// SPDX-License-Identifier: MIT
#include "simplex.hpp"

#include <algorithm>
#include <limits>

namespace crofton::convex {
namespace {

struct Candidate {
    double squared = std::numeric_limits<double>::infinity();
    glm::dvec3 point{0.0};
    int index[4] = {};
    double weight[4] = {};
    int count = 0;
};

void offer(Candidate& best, const glm::dvec3& point, std::initializer_list<int> index,
           std::initializer_list<double> weight) {
    const double squared = glm::dot(point, point);
    if (!(squared < best.squared)) return;
    best.squared = squared;
    best.point = point;
    best.count = static_cast<int>(index.size());
    std::copy(index.begin(), index.end(), best.index);
    std::copy(weight.begin(), weight.end(), best.weight);
}

void offer_segment(Candidate& best, const Simplex& s, int i, int j) {
    const glm::dvec3 &p = s.corner[i].w, &q = s.corner[j].w, u = q - p;
    const double length2 = glm::dot(u, u), along = -glm::dot(p, u);
    if (!(along > 0.0 && along < length2)) return;
    const double t = along / length2;
    offer(best, p + t * u, {i, j}, {1.0 - t, t});
}

void offer_triangle(Candidate& best, const Simplex& s, int i, int j, int k) {
    const glm::dvec3 &p = s.corner[i].w, &q = s.corner[j].w, &r = s.corner[k].w;
    const glm::dvec3 n = glm::cross(q - p, r - p);
    const double whole = glm::dot(n, n);
    const double wp = glm::dot(glm::cross(q, r), n), wq = glm::dot(glm::cross(r, p), n),
                 wr = glm::dot(glm::cross(p, q), n);
    if (!(wp > 0.0 && wq > 0.0 && wr > 0.0 && whole > 0.0)) return;
    const double sum = wp + wq + wr;
    offer(best, glm::dot(n, p) / whole * n, {i, j, k}, {wp / sum, wq / sum, wr / sum});
}

// Four times six volumes: of the origin with each face, signed as that of the tetrahedron.
struct Parts {
    double part[4], whole;
};
Parts parts_of(const Simplex& s) {
    const glm::dvec3 &a = s.corner[0].w, &b = s.corner[1].w, &c = s.corner[2].w, &d = s.corner[3].w;
    const glm::dvec3 ab = glm::cross(a, b), cd = glm::cross(c, d);
    Parts parts{{glm::dot(b, cd), -glm::dot(a, cd), glm::dot(ab, d), -glm::dot(ab, c)}, 0.0};
    parts.whole = (parts.part[0] + parts.part[1]) + (parts.part[2] + parts.part[3]);
    if (parts.whole < 0.0) {
        for (double& part : parts.part) part = -part;
        parts.whole = -parts.whole;
    }
    return parts;
}

}  // namespace

void reduce(Simplex& s, bool all) {
    s.inside = false;
    if (s.count == 4) {
        const Parts parts = parts_of(s);
        if (parts.part[0] > 0.0 && parts.part[1] > 0.0 && parts.part[2] > 0.0 && parts.part[3] > 0.0) {
            s.inside = true;
            s.nearest = glm::dvec3(0.0);
            for (int i = 0; i < 4; ++i) s.weight[i] = parts.part[i] / parts.whole;
            return;
        }
    }
    Candidate best;
    for (int i = s.count - 1; i >= 0; --i) {
        offer(best, s.corner[i].w, {i}, {1.0});
        for (int j = 0; j < i; ++j) {
            offer_segment(best, s, j, i);
            for (int k = 0; k < j; ++k) offer_triangle(best, s, k, j, i);
        }
        if (!all) break;
    }
    // Indices ascend, so that corners move forward only.
    for (int i = 0; i < best.count; ++i) {
        if (best.index[i] != i) s.corner[i] = s.corner[best.index[i]];
        s.weight[i] = best.weight[i];
    }
    s.count = best.count;
    s.nearest = best.point;
}

bool certainly_inside(const Simplex& s, double size) {
    if (s.count != 4) return false;
    const Parts parts = parts_of(s);
    double longest = 0.0;
    for (const Corner& corner : s.corner) longest = std::max(longest, glm::dot(corner.w, corner.w));
    const double bound = determinant_error(size, longest);
    return std::all_of(parts.part, parts.part + 4, [&](double part) { return part > bound; });
}

}  // namespace crofton::convex
