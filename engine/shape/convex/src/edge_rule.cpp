// SPDX-License-Identifier: MIT
#include "edge_rule.hpp"

#include <bit>

#include "pair.hpp"

namespace crofton::convex {
namespace {

constexpr std::uint32_t kNoCorner = ~std::uint32_t{0};

// The vertices of a triangle that are farthest along a direction.
struct FarthestCorners {
    std::size_t corner[3];
    int count = 0;
};
bool rises(const glm::dvec3& d, const glm::dvec3& way, double sine) {
    const double along = glm::dot(d, way);
    return along > 0.0 && along * along > sine * sine * glm::dot(way, way);
}
FarthestCorners farthest_along(const Triangle& t, const glm::dvec3& d) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (glm::dot(d, t[k] - t[best]) > 0.0) best = k;
    FarthestCorners result;
    result.corner[result.count++] = best;
    for (std::size_t k = 0; k < 3; ++k)
        if (k != best && !rises(d, t[best] - t[k], kFlatSine)) result.corner[result.count++] = k;
    return result;
}

}  // namespace

void EdgeRule::start(std::span<const NearTriangle> triangles) {
    triangles_ = triangles;
    listed_ = false;
}

void EdgeRule::list_corners() {
    const std::size_t count = triangles_.size();
    first_.assign(std::bit_ceil(4 * count), kNoCorner);
    next_.resize(3 * count);
    listed_ = true;
    for (std::uint32_t i = 0; i < count; ++i)
        for (std::uint32_t k = 0; k < 3; ++k) {
            std::uint32_t& first = first_[slot_of(triangles_[i].corners[k])];
            next_[3 * i + k] = first;
            first = 3 * i + k;
        }
}

std::size_t EdgeRule::slot_of(const glm::dvec3& vertex) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k)  // -0 is 0
        hash = (hash ^ std::bit_cast<std::uint64_t>(vertex[k] + 0.0)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(hash >> 32) & (first_.size() - 1);
}

bool EdgeRule::points_into_neighbor(std::uint32_t index, const RigidTransform& pose, const glm::dvec3& normal) {
    const NearTriangle& own = triangles_[index];
    const glm::dvec3 d = Pair::local(pose.rotation, normal);
    const FarthestCorners on = farthest_along(own.corners, d);
    if (on.count == 3) return false;
    if (!listed_) list_corners();
    const glm::dvec3& vertex = own.corners[on.corner[0]];
    for (std::uint32_t c = first_[slot_of(vertex)]; c != kNoCorner; c = next_[c]) {
        const NearTriangle& other = triangles_[c / 3];
        const Triangle& t = other.corners;
        if (t[c % 3] != vertex || other.surface != own.surface) continue;
        if (on.count == 2) {
            const glm::dvec3& second = own.corners[on.corner[1]];
            if (t[0] != second && t[1] != second && t[2] != second) continue;
        }
        for (const glm::dvec3& p : t)
            if (rises(d, p - vertex, kFlatSine)) return true;
    }
    return false;
}

}  // namespace crofton::convex
