// SPDX-License-Identifier: MIT
#include "box_pair.hpp"

#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace crofton::convex {
namespace {

constexpr int kNext[3] = {1, 2, 0}, kLast[3] = {2, 0, 1};
constexpr double kParallel = 1e-8;  // squared: below, edges count as nearly parallel

// a b − c d within 2 u of its size.
double difference_of_products(double a, double b, double c, double d) {
    const auto p = detail::two_product(a, b), q = detail::two_product(c, d);
    return (p.high - q.high) + (p.low - q.low);
}

glm::dvec3 careful_cross(const glm::dvec3& u, const glm::dvec3& v) {
    return {difference_of_products(u.y, v.z, u.z, v.y), difference_of_products(u.z, v.x, u.x, v.z),
            difference_of_products(u.x, v.y, u.y, v.x)};
}

}  // namespace

BoxPair::BoxPair(const Pair& pair)
    : pair_(pair),
      half_a_(pair.a.half_extents()),
      half_b_(pair.b.half_extents()),
      slack_(kSameDepth * pair.size),
      error_(4.0 * pair.error) {
    const glm::dmat3& r = pair.pose_a.rotation;
    const glm::dvec3 x = glm::cross(r[1], r[2]), y = glm::cross(r[2], r[0]), z = glm::cross(r[0], r[1]);
    const double share = 1.0 / glm::dot(r[0], x);
    to_a_ = glm::transpose(glm::dmat3(share * x, share * y, share * z));
    at_ = to_a_ * pair.offset;
}

bool BoxPair::try_faces(double far, BoxAxis& least) {
    for (int k = 0; k < 3; ++k) {
        for (int l = 0; l <= k; ++l)
            metric_[k][l] = metric_[l][k] =
                to_a_[0][k] * to_a_[0][l] + to_a_[1][k] * to_a_[1][l] + to_a_[2][k] * to_a_[2][l];
        const double length = std::sqrt(metric_[k][k]);
        const double radius = std::abs(edges_[0][k]) * half_b_.x + std::abs(edges_[1][k]) * half_b_.y +
                              std::abs(edges_[2][k]) * half_b_.z;
        reach_[0][k] = (half_a_[k] + radius) / length;
        along_[0][k] = at_[k] / length;
        const double extent = reach_[0][k] - std::abs(along_[0][k]);
        if (extent < least.extent - (k > 0 ? slack_ : 0.0)) least = {k, extent};
        if (extent < far) return false;
    }
    for (int j = 0; j < 3; ++j) {
        const glm::dvec3 n = normals_[j] = glm::cross(edges_[kNext[j]], edges_[kLast[j]]);
        const double length = std::sqrt(glm::dot(n, metric_ * n));
        const double radius = glm::dot(half_a_, glm::abs(n));
        reach_[1][j] = (std::abs(glm::dot(n, edges_[j])) * half_b_[j] + radius) / length;
        along_[1][j] = glm::dot(n, at_) / length;
        const double extent = reach_[1][j] - std::abs(along_[1][j]);
        if (extent < least.extent - slack_) least = {3 + j, extent};
        if (extent < far) return false;
    }
    return true;
}

// The product of edge i of a with edge j of b has m_u = −e_v, m_v = e_u, where e is b's edge; its product with another
// edge of b is a component of the normal across both.
void BoxPair::try_edges(BoxAxis& least) const {
    for (int i = 0; i < 3; ++i) {
        const int u = kNext[i], v = kLast[i];
        const double uu = metric_[u][u], uv = 2.0 * metric_[u][v], vv = metric_[v][v];
        for (int j = 0; j < 3; ++j) {
            const double mu = -edges_[j][v], mv = edges_[j][u];
            const double squared = (uu * mu * mu + vv * mv * mv) + uv * mu * mv;
            const double best = least.extent - slack_;
            if (!(squared > kParallel)) {
                const glm::dvec3 n = careful_cross(pair_.pose_a.rotation[i], pair_.pose_b.rotation[j]);
                const double length = glm::length(n);
                if (!(length > 0.0)) continue;
                const double careful = std::min(pair_.extent(n), pair_.extent(-n)) / length;
                if (careful < best) least = {6 + 3 * i + j, careful};
                continue;
            }
            const double radius_a = half_a_[u] * std::abs(mu) + half_a_[v] * std::abs(mv);
            const double radius_b = half_b_[kNext[j]] * std::abs(normals_[kLast[j]][i]) +
                                    half_b_[kLast[j]] * std::abs(normals_[kNext[j]][i]);
            const double extent = (radius_a + radius_b) - std::abs(mu * at_[u] + mv * at_[v]);
            // Most axes are deeper, which needs no root to be seen.
            if (best >= 0.0 && extent >= 0.0 && extent * extent >= best * best * squared) continue;
            if (const double world = extent / std::sqrt(squared); world < best) least = {6 + 3 * i + j, world};
        }
    }
}

BoxAxis BoxPair::least(double far) {
    edges_ = to_a_ * pair_.pose_b.rotation;
    BoxAxis least{-1, std::numeric_limits<double>::infinity()};
    if (try_faces(far, least)) try_edges(least);
    return least;
}

double BoxPair::face_extent(bool of_a, int face) const {
    const int side = of_a ? 0 : 1, k = face / 2;
    // b's face looks back at a where a's looks on at b.
    const double sign = ((face & 1) != 0) == of_a ? 1.0 : -1.0;
    return reach_[side][k] - sign * along_[side][k];
}

glm::dvec3 BoxPair::normal(int axis) const {
    const glm::dmat3 &ra = pair_.pose_a.rotation, &rb = pair_.pose_b.rotation;
    const glm::dvec3 n = axis < 3   ? glm::cross(ra[kNext[axis]], ra[kLast[axis]])
                         : axis < 6 ? glm::cross(rb[kNext[axis - 3]], rb[kLast[axis - 3]])
                                    : careful_cross(ra[(axis - 6) / 3], rb[(axis - 6) % 3]);
    return (glm::dot(n, pair_.offset) < 0.0 ? -1.0 : 1.0) / glm::length(n) * n;
}

}  // namespace crofton::convex
