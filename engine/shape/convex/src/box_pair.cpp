// SPDX-License-Identifier: MIT
#include "box_pair.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <cstring>
#include <limits>

namespace crofton::convex {
namespace {

constexpr double kParallel = 1e-9;  // squared: below, two edges make a sliver

// a b − c d within 2 u of its size, or 2^-104 of the products where they cancel.
double difference_of_products(double a, double b, double c, double d) {
    const auto p = detail::two_product(a, b), q = detail::two_product(c, d);
    return (p.high - q.high) + (p.low - q.low);
}

glm::dvec3 careful_cross(const glm::dvec3& u, const glm::dvec3& v) {
    return {difference_of_products(u.y, v.z, u.z, v.y), difference_of_products(u.z, v.x, u.x, v.z),
            difference_of_products(u.x, v.y, u.y, v.x)};
}

// Σ half_k |n_k|.
double radius_along(const glm::dvec3& half, const glm::dvec3& n) {
    return half.x * std::abs(n.x) + half.y * std::abs(n.y) + half.z * std::abs(n.z);
}

constexpr double kWorldAxes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

bool is_world_frame(const glm::dmat3& rotation) {
    return std::memcmp(&rotation, kWorldAxes, sizeof kWorldAxes) == 0;
}

}  // namespace

int upright_edge(const glm::dmat3& edges, int k) {
    int upright = -1;
    for (int i = 0; i < 3; ++i) {
        const double along = coordinate(edges[i], k);
        if (along == 0.0) continue;
        const bool is_axis =
            std::abs(along) == 1.0 && coordinate(edges[i], kNext[k]) == 0.0 && coordinate(edges[i], kLast[k]) == 0.0;
        if (upright >= 0 || !is_axis) return -1;
        upright = i;
    }
    return upright;
}

Upright upright_of(const glm::dmat3& edges_a, const glm::dmat3& edges_b) {
    for (int k = 2; k >= 0; --k) {
        const int i = upright_edge(edges_a, k), j = i < 0 ? i : upright_edge(edges_b, k);
        if (j >= 0) return {k, i, j};
    }
    return {};
}

BoxPair::BoxPair(const Pair& pair)
    : pair_(pair),
      half_a_(pair.a.half_extents()),
      half_b_(pair.b.half_extents()),
      straight_(is_world_frame(pair.pose_a.rotation) && is_world_frame(pair.pose_b.rotation)),
      common_frame_(straight_ || pair.pose_a.rotation == pair.pose_b.rotation),
      depth_margin_(kSameDepth * pair.size),
      error_(4.0 * pair.error) {
    if (straight_) {
        for (int k = 0; k < 3; ++k) to_a_[k] = glm::dvec3(k == 0, k == 1, k == 2);
        at_ = pair.offset;
        return;
    }
    if (!common_frame_) upright_ = upright_of(pair.pose_a.rotation, pair.pose_b.rotation);
    const glm::dmat3& r = pair.pose_a.rotation;
    const glm::dvec3 x = glm::cross(r[1], r[2]), y = glm::cross(r[2], r[0]), z = glm::cross(r[0], r[1]);
    const double share = 1.0 / glm::dot(r[0], x);
    to_a_[0] = share * x, to_a_[1] = share * y, to_a_[2] = share * z;
    for (int k = 0; k < 3; ++k) at_[k] = glm::dot(to_a_[k], pair.offset);
}

void BoxPair::find_products() {
    for (int j = 0; j < 3; ++j) across_[j] = glm::cross(edge_[kNext[j]], edge_[kLast[j]]);
    determinant_ = glm::dot(across_[0], edge_[0]);
    share_ = 1.0 / determinant_;
}

// The extent across a face of a. Its row of the edges is known.
double BoxPair::face_of_a(int k) {
    const double share = row_share_[k] = 1.0 / std::sqrt(glm::dot(to_a_[k], to_a_[k]));
    const double radius = half_b_.x * std::abs(coordinate(edge_[0], k)) +
                          half_b_.y * std::abs(coordinate(edge_[1], k)) + half_b_.z * std::abs(coordinate(edge_[2], k));
    radius_sum_[0][k] = (coordinate(half_a_, k) + radius) * share;
    along_[0][k] = coordinate(at_, k) * share;
    return radius_sum_[0][k] - std::abs(along_[0][k]);
}

double BoxPair::face_of_b(int j) {
    const glm::dvec3 &n = across_[j], world = n.x * to_a_[0] + n.y * to_a_[1] + n.z * to_a_[2];
    const double share = 1.0 / std::sqrt(glm::dot(world, world));
    radius_sum_[1][j] = (std::abs(determinant_) * coordinate(half_b_, j) + radius_along(half_a_, n)) * share;
    along_[1][j] = glm::dot(n, at_) * share;
    return radius_sum_[1][j] - std::abs(along_[1][j]);
}

BoxAxis BoxPair::look_along(int axis) {
    for (int k = 0; k < 3; ++k) find_edges(k);
    if (axis < 3) return {axis, face_of_a(axis)};
    find_products();
    return {axis, face_of_b(axis - 3)};
}

bool BoxPair::try_faces(double far, BoxAxis& least) {
    for (int k = 0; k < 3; ++k) {
        find_edges(k);
        const double extent = face_of_a(k);
        near_ |= (extent > error_ ? 0 : 1) << k;
        if (k == 0 || extent < far || extent < least.extent - depth_margin_) least = {k, extent};
        if (extent < far) return false;
    }
    find_products();
    for (int j = 0; j < 3; ++j) {
        const double extent = face_of_b(j);
        near_ |= (extent > error_ ? 0 : 1) << (3 + j);
        if (extent < far || extent < least.extent - depth_margin_) least = {3 + j, extent};
        if (extent < far) return false;
    }
    return true;
}

// The product of edge i of a with edge j of b has m_u = −e_v, m_v = e_u, where e is b's edge; its product with another
// edge of b is a component of the one across both.
void BoxPair::try_edges(BoxAxis& least) {
    for (int i = 0; i < 3; ++i) {
        const int u = kNext[i], v = kLast[i];
        const double uu = glm::dot(to_a_[u], to_a_[u]), uv = 2.0 * glm::dot(to_a_[u], to_a_[v]),
                     vv = glm::dot(to_a_[v], to_a_[v]);
        const double half_au = coordinate(half_a_, u), half_av = coordinate(half_a_, v), at_u = coordinate(at_, u),
                     at_v = coordinate(at_, v);
        for (int j = 0; j < 3; ++j) {
            const double mu = -coordinate(edge_[j], v), mv = coordinate(edge_[j], u);
            const double squared = (uu * mu * mu + vv * mv * mv) + uv * mu * mv;
            const double radius_a = half_au * std::abs(mu) + half_av * std::abs(mv);
            const double radius_b = coordinate(half_b_, kNext[j]) * std::abs(coordinate(across_[kLast[j]], i)) +
                                    coordinate(half_b_, kLast[j]) * std::abs(coordinate(across_[kNext[j]], i));
            const double extent = (radius_a + radius_b) - std::abs(mu * at_u + mv * at_v);
            const double best = least.extent - depth_margin_;
            near_ |= (extent > error_ ? 0 : 1) << (6 + 3 * i + j);
            if (!(squared > kParallel)) {
                slivers_ |= 1 << (3 * i + j);
                sliver_width_ = std::max(sliver_width_, 2.0 * std::min(coordinate(half_a_, i), coordinate(half_b_, j)) *
                                                            (std::sqrt(squared) + 4e-15));
                continue;
            }
            // Most axes are deeper, which needs no root to be seen.
            if (best >= 0.0 && extent >= 0.0 && extent * extent >= best * best * squared) continue;
            if (const double world = extent / std::sqrt(squared); world < best) least = {6 + 3 * i + j, world};
        }
    }
}

void BoxPair::try_slivers(BoxAxis& least) const {
    if (slivers_ == 0) return;
    for (int n = 0; n < 9; ++n) {
        if ((slivers_ >> n & 1) == 0) continue;
        const glm::dvec3 m = careful_cross(pair_.pose_a.rotation[n / 3], pair_.pose_b.rotation[n % 3]);
        const double length = glm::length(m);
        if (!(length > 0.0)) continue;
        const double extent = std::min(pair_.extent(m), pair_.extent(-m)) / length;
        if (extent < least.extent - depth_margin_) least = {6 + n, extent};
    }
}

// Each number is what least_in_common_frame() would come to.
BoxAxis BoxPair::least_of_straight(double far) {
    BoxAxis least;
    for (int k = 0; k < 3; ++k) {
        const double along = coordinate(at_, k), sum = coordinate(half_a_, k) + coordinate(half_b_, k),
                     extent = sum - std::abs(along);
        row_share_[k] = 1.0;
        radius_sum_[0][k] = radius_sum_[1][k] = sum;
        along_[0][k] = along_[1][k] = along;
        near_ |= (extent > error_ ? 0 : 1) << k;
        if (k == 0 || extent < far || extent < least.extent - depth_margin_) least = {k, extent};
        if (extent < far) return least;
    }
    return least;
}

BoxAxis BoxPair::least_in_common_frame(double far) {
    BoxAxis least;
    for (int k = 0; k < 3; ++k) edge_[k] = across_[k] = glm::dvec3(k == 0, k == 1, k == 2);
    for (int k = 0; k < 3; ++k) {
        const double extent = face_of_a(k);
        near_ |= (extent > error_ ? 0 : 1) << k;
        if (k == 0 || extent < far || extent < least.extent - depth_margin_) least = {k, extent};
        if (extent < far) return least;
        radius_sum_[1][k] = radius_sum_[0][k];
        along_[1][k] = along_[0][k];
    }
    return least;
}

BoxAxis BoxPair::least_of_upright(double far) {
    BoxAxis least;
    const auto try_face = [&](int number, double extent) {
        near_ |= (extent > error_ ? 0 : 1) << number;
        if (number == 0 || extent < far || extent < least.extent - depth_margin_) least = {number, extent};
        return extent < far;
    };
    for (int k = 0; k < 3; ++k) {
        find_edges(k);
        if (try_face(k, face_of_a(k))) return least;
    }
    find_products();
    for (int j = 0; j < 3; ++j)
        if (j != upright_.j && try_face(3 + j, face_of_b(j))) return least;
    const double turn = coordinate(pair_.pose_a.rotation[upright_.i], upright_.k) *
                        coordinate(pair_.pose_b.rotation[upright_.j], upright_.k);
    radius_sum_[1][upright_.j] = radius_sum_[0][upright_.i];
    along_[1][upright_.j] = turn * along_[0][upright_.i];
    return least;
}

BoxAxis BoxPair::least(double far) {
    if (straight_) return least_of_straight(far);
    if (common_frame_) return least_in_common_frame(far);
    if (upright_.k >= 0) return least_of_upright(far);
    BoxAxis least;
    if (try_faces(far, least)) try_edges(least);
    return least;
}

double BoxPair::face_extent(bool of_a, int face) const {
    const int side = of_a ? 0 : 1, k = face / 2;
    // b's face looks back at a where a's looks on at b.
    const double sign = ((face & 1) != 0) == of_a ? 1.0 : -1.0;
    return radius_sum_[side][k] - sign * along_[side][k];
}

glm::dvec3 BoxPair::normal(int axis) const {
    const glm::dmat3 &ra = pair_.pose_a.rotation, &rb = pair_.pose_b.rotation;
    // As face_towards_other() has it, also where rounding decides.
    if (axis < 3) return (along_[0][axis] < 0.0 ? -row_share_[axis] : row_share_[axis]) * to_a_[axis];
    const glm::dvec3 n = axis < 6 ? glm::cross(rb[kNext[axis - 3]], rb[kLast[axis - 3]])
                                  : careful_cross(ra[(axis - 6) / 3], rb[(axis - 6) % 3]);
    const double along = axis < 6 ? along_[1][axis - 3] : glm::dot(n, pair_.offset);
    return (along < 0.0 ? -1.0 : 1.0) / glm::length(n) * n;
}

BoxPair::Seen BoxPair::seen_by(bool a) const {
    if (straight_) return {a ? at_ : -at_, {to_a_[0], to_a_[1], to_a_[2]}};
    if (a) return {at_, {edge_[0], edge_[1], edge_[2]}};
    Seen seen;
    for (int j = 0; j < 3; ++j) {
        seen.center[j] = -share_ * glm::dot(across_[j], at_);
        for (int k = 0; k < 3; ++k) seen.edge[k][j] = share_ * across_[j][k];
    }
    return seen;
}

glm::dvec3 BoxPair::into_frame(bool of_a, const glm::dvec3& direction) const {
    if (straight_) return direction;
    const glm::dvec3 d(glm::dot(to_a_[0], direction), glm::dot(to_a_[1], direction), glm::dot(to_a_[2], direction));
    if (of_a) return d;
    return share_ * glm::dvec3(glm::dot(across_[0], d), glm::dot(across_[1], d), glm::dot(across_[2], d));
}

}  // namespace crofton::convex
