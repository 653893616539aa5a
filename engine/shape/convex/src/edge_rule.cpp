// SPDX-License-Identifier: MIT
#include "edge_rule.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>

#include "pair.hpp"
#include "parts.hpp"

namespace crofton::convex {
namespace {

constexpr std::uint32_t kNoCorner = ~std::uint32_t{0};
constexpr std::int8_t kUnknownSide = 2;

// V, the vertices of a triangle that are farthest along a direction: from the farthest on, each that is not below one
// of V. Vertices that are equally far but for rounding come in any order: V is the same.
struct FarthestCorners {
    std::size_t corner[3];
    int count = 0;
};
bool rises(const glm::dvec3& d, const glm::dvec3& way, double sine) {
    const double along = glm::dot(d, way);
    return along > 0.0 && along * along > sine * sine * glm::dot(way, way);
}
FarthestCorners farthest_along(const Triangle& t, const glm::dvec3& d) {
    const double along[3] = {0.0, glm::dot(d, t[1] - t[0]), glm::dot(d, t[2] - t[0])};
    std::size_t order[3] = {0, 1, 2};
    const auto sort = [&](std::size_t i, std::size_t j) {
        if (along[order[i]] < along[order[j]]) std::swap(order[i], order[j]);
    };
    sort(0, 1), sort(1, 2), sort(0, 1);
    FarthestCorners result;
    for (const std::size_t k : order) {
        bool is_below = false;
        for (int i = 0; i < result.count; ++i) is_below = is_below || rises(d, t[result.corner[i]] - t[k], kFlatSine);
        if (!is_below) result.corner[result.count++] = k;
    }
    return result;
}

// V, as a neighbor knows them.
struct Stand {
    const Triangle& own;
    FarthestCorners on;
    glm::dvec3 direction;

    [[nodiscard]] const glm::dvec3& vertex(int k = 0) const { return own[on.corner[k]]; }
    [[nodiscard]] bool is_shared_by(const Triangle& t) const {
        for (int k = 0; k < on.count; ++k)
            if (std::find(t.begin(), t.end(), vertex(k)) == t.end()) return false;
        return true;
    }
    // Measured from each of V: from one end of a long edge a corner may seem flat that rises as seen from the other.
    [[nodiscard]] bool is_below(const Triangle& t) const {
        return std::any_of(t.begin(), t.end(), [&](const glm::dvec3& p) {
            return rises(direction, p - vertex(), kFlatSine) ||
                   (on.count > 1 && rises(direction, p - vertex(1), kFlatSine));
        });
    }
};

// Whether a triangle of the surface around the vertex is one of those.
bool any_around(const NearSurface& surface, const glm::dvec3& vertex, FunctionRef<bool(const Triangle&)> is_one) {
    QueryBox place;
    place.center = vertex;
    place.rounding = 1e-12 * surface.shape->core_radius();
    const auto triangle = [&](const PartSearch&, const Triangle& corners, std::uint32_t) { return is_one(corners); };
    return visit_parts(
        {*surface.shape, surface.pose}, place, 0.0, [](const Part&) { return false; }, triangle);
}

// How a triangle sees a point. Of triangles that are equally near the one whose plane is farther tells the side.
struct View {
    double squared, height;  // of the distance; above the plane

    View(const Triangle& t, const glm::dvec3& point) {
        const glm::dvec3 way = point - closest_on_triangle(point, t);
        const glm::dvec3 normal = triangle_normal(glm::dmat3(1.0), t);
        squared = glm::dot(way, way);
        height = glm::dot(normal, point - t[0]);
    }
    [[nodiscard]] bool tells_more(const View& other) const {
        constexpr double kSame = 1e-9;
        if (squared < other.squared * (1.0 - kSame)) return true;
        return squared <= other.squared * (1.0 + kSame) && std::abs(height) > std::abs(other.height) * (1.0 + kSame);
    }
};

}  // namespace

void EdgeRule::start(std::span<const NearTriangle> triangles, const ShapeAtPose& shape) {
    triangles_ = triangles;
    shape_ = &shape;
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

bool EdgeRule::is_within_search(const glm::dvec3& point) const {
    const QueryBox core = core_box(shape_->shape);
    const glm::dvec3 offset = Pair::local(shape_->pose.rotation, point - shape_->pose.translation) - core.center;
    const glm::dvec3 way = offset - (glm::clamp)(offset, -core.half, core.half);
    return glm::dot(way, way) <= core.radius * core.radius;
}

bool EdgeRule::points_into_neighbor(std::uint32_t index, const NearSurface& surface, const glm::dvec3& normal,
                                    const glm::dvec3& touch) {
    const NearTriangle& own = triangles_[index];
    const glm::dvec3 d = Pair::local(surface.pose.rotation, normal);
    const Stand stand{own.corners, farthest_along(own.corners, d), d};
    if (stand.on.count == 3) return false;
    const auto rises_beside = [&](const Triangle& t) { return stand.is_shared_by(t) && stand.is_below(t); };
    if (!listed_) list_corners();
    for (std::uint32_t c = first_[slot_of(stand.vertex())]; c != kNoCorner; c = next_[c]) {
        const NearTriangle& other = triangles_[c / 3];
        if (other.surface == own.surface && rises_beside(other.corners)) return true;
    }
    const glm::dvec3 on = stand.on.count == 1 ? surface.pose.rotation * stand.vertex() : touch;
    return !is_within_search(on + surface.pose.translation) && any_around(surface, stand.vertex(), rises_beside);
}

namespace {

// Twice what the rule asks for, so that what is told here holds for normals that are off by 1e-6.
constexpr double kSurelySteep = 4.0 * kFlatSine * kFlatSine;

bool surely_rises(double along, double squares) {
    return along > 0.0 && along * along > kSurelySteep * squares;
}

// Where a triangle is nearest to a point: at a vertex, or at the edge from that to the next.
struct NearestRim {
    int vertex = -1;
    bool is_edge = false;
    glm::dvec3 way{0.0};  // to the point
    double squared = 0.0;
};
// With way w, all of the triangle is behind the plane across w at that place: so it is the nearest. Each other corner
// is behind by a surely more than flat angle; then w is not across the face either. -1: not surely so.
NearestRim surely_nearest_rim(const Triangle& t, const glm::dvec3& point) {
    const glm::dvec3 edge[3] = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
    double along[3], length2[3];
    for (std::size_t k = 0; k < 3; ++k) {
        along[k] = glm::dot(point - t[k], edge[k]);
        length2[k] = glm::dot(edge[k], edge[k]);
    }
    NearestRim rim;
    const double turn = glm::dot(edge[0], edge[1]);
    if (!(length2[0] * length2[1] - turn * turn > 1e-6 * length2[0] * length2[1])) return rim;  // a sliver
    for (int k = 0; k < 3; ++k) {
        const int before = k == 0 ? 2 : k - 1, after = k == 2 ? 0 : k + 1;
        const glm::dvec3 way = point - t[static_cast<std::size_t>(k)];
        if (along[k] <= 0.0 && along[before] >= length2[before]) {
            const double squared = glm::dot(way, way);
            if (surely_rises(-along[k], squared * length2[k]) &&
                surely_rises(along[before] - length2[before], squared * length2[before]))
                rim = {k, false, way, squared};
            return rim;
        }
        if (!(along[k] > 0.0 && along[k] < length2[k])) continue;
        const glm::dvec3 across = way - along[k] / length2[k] * edge[k];
        const double squared = glm::dot(across, across), rise = glm::dot(across, edge[after]);
        if (surely_rises(-rise, squared * length2[after]) && surely_rises(-rise, squared * length2[before]))
            return {k, true, across, squared};
    }
    return rim;
}

}  // namespace

bool EdgeRule::surely_leaves_out(std::uint32_t index, const Ball& ball) {
    const NearTriangle& own = triangles_[index];
    const NearestRim rim = surely_nearest_rim(own.corners, ball.center);
    if (rim.vertex < 0) return false;
    const double distance = std::sqrt(rim.squared);
    if (!(distance > ball.doubt && std::abs(distance - ball.radius) > ball.doubt)) return false;
    const glm::dvec3 &from = own.corners[static_cast<std::size_t>(rim.vertex)],
                     &to = own.corners[rim.vertex == 2 ? 0 : static_cast<std::size_t>(rim.vertex) + 1];
    if (!listed_) list_corners();
    for (std::uint32_t c = first_[slot_of(from)]; c != kNoCorner; c = next_[c]) {
        const NearTriangle& other = triangles_[c / 3];
        const Triangle& t = other.corners;
        if (c / 3 == index || other.surface != own.surface || t[c % 3] != from) continue;
        if (rim.is_edge && t[(c + 1) % 3] != to && t[(c + 2) % 3] != to) continue;
        for (std::size_t more = 1; more < 3; ++more) {
            const glm::dvec3 rise = t[(c + more) % 3] - from;
            double far2 = glm::dot(rise, rise);
            if (rim.is_edge) {  // from either end
                const glm::dvec3 other_rise = rise - (to - from);
                far2 = std::max(far2, glm::dot(other_rise, other_rise));
            }
            if (surely_rises(glm::dot(rim.way, rise), rim.squared * far2)) return true;
        }
    }
    return false;
}

void EdgeRule::find_sides(std::uint32_t begin, std::uint32_t end, const glm::dvec3& point) {
    if (!listed_) list_corners();
    side_.resize(triangles_.size());
    std::fill(side_.begin() + begin, side_.begin() + end, kUnknownSide);
    for (std::uint32_t i = begin; i < end; ++i)
        if (side_[i] == kUnknownSide) find_side_of_piece(i, point);
}

void EdgeRule::find_side_of_piece(std::uint32_t first, const glm::dvec3& point) {
    side_[first] = 1;  // that of the first one's front, until the side is known
    piece_.assign(1, first);
    View nearest(triangles_[first].corners, point);
    std::uint32_t teller = first;
    for (std::size_t i = 0; i < piece_.size(); ++i) {
        const View view(triangles_[piece_[i]].corners, point);
        if (view.tells_more(nearest)) nearest = view, teller = piece_[i];
        add_neighbors_to_piece(piece_[i]);
    }
    const int front = piece_.size() == 1 ? 0 : nearest.height >= 0.0 ? side_[teller] : -side_[teller];
    for (const std::uint32_t i : piece_) side_[i] = static_cast<std::int8_t>(front * side_[i]);
}

// A neighbor that passes their edge in the same direction is wound the other way.
void EdgeRule::add_neighbors_to_piece(std::uint32_t index) {
    const NearTriangle& own = triangles_[index];
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &from = own.corners[k], &to = own.corners[(k + 1) % 3];
        for (std::uint32_t c = first_[slot_of(from)]; c != kNoCorner; c = next_[c]) {
            const NearTriangle& other = triangles_[c / 3];
            const Triangle& t = other.corners;
            if (other.surface != own.surface || side_[c / 3] != kUnknownSide || t[c % 3] != from) continue;
            const bool same_way = t[(c + 1) % 3] == to;
            if (!same_way && t[(c + 2) % 3] != to) continue;
            side_[c / 3] = static_cast<std::int8_t>(same_way ? -side_[index] : side_[index]);
            piece_.push_back(c / 3);
        }
    }
}

}  // namespace crofton::convex
