// SPDX-License-Identifier: MIT
#include "deep_core.hpp"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "features.hpp"

namespace crofton::convex {
namespace {

// The way out is that of the least extent of the difference body. With a point, this is the solid itself: the nearest
// of its faces. With a segment and a box, the faces of both across the box's faces, and across each of its edges and
// the segment. All is told in the solid's frame, where directions are covectors m, of length √(mᵀ G m) in the world, G
// = R⁻¹ R⁻ᵀ: a pose is rigid to 1e-6 alone. A coordinate in that frame is off by 60 roundings of 2^-53 of the size,
// which is below `error`.
class DeepCore {
  public:
    DeepCore(const Pair& pair, bool solid_is_a, Depth& depth)
        : pair_(pair),
          solid_is_a_(solid_is_a),
          solid_(solid_is_a ? pair.a : pair.b),
          thin_(solid_is_a ? pair.b : pair.a),
          rotation_((solid_is_a ? pair.pose_a : pair.pose_b).rotation),
          depth_(depth) {
        const glm::dmat3& turn = (solid_is_a ? pair.pose_b : pair.pose_a).rotation;
        to_local_ = glm::inverse(rotation_);
        error_ = 4.0 * pair.error;
        ends_ = thin_.vertex_count();
        for (int i = 0; i < 2; ++i) {
            const glm::dvec3 from_solid = solid_is_a ? pair.offset : -pair.offset;
            end_[i] = to_local_ * (turn * thin_.vertex(std::min(i, ends_ - 1)) + from_solid);
        }
    }

    [[nodiscard]] bool ask() {
        if (solid_.kind() == Kind::box) return in_box();
        if (ends_ != 1) return false;
        if (solid_.kind() == Kind::hull) return in_hull();
        return in_round();
    }

  private:
    // A way out: along the covector m, of length `length` in the world.
    struct Way {
        glm::dvec3 m{0.0};
        double extent = HUGE_VAL, length = 1.0;
        int axis = -1;  // of a box: across its faces 0 to 2, across its edges 3 to 5
    };

    [[nodiscard]] glm::dvec3 to_world(const glm::dvec3& m) const { return m.x * row(0) + m.y * row(1) + m.z * row(2); }
    [[nodiscard]] glm::dvec3 row(int k) const { return {to_local_[0][k], to_local_[1][k], to_local_[2][k]}; }
    // The motion along the way, in the solid's frame.
    [[nodiscard]] glm::dvec3 motion(const Way& way) const {
        return way.extent / way.length * (to_local_ * to_world(way.m));
    }

    [[nodiscard]] bool in_box();
    [[nodiscard]] bool try_edges(Way& least) const;
    [[nodiscard]] bool set_face_points(const Way& way);
    [[nodiscard]] bool set_edge_points(const Way& way);
    void set_face_corners(int k, int side, const glm::dvec3& foot, int end);
    void set_edge_corners(int k, int corner, const glm::dvec3& foot, double t);
    [[nodiscard]] bool in_hull();
    [[nodiscard]] bool set_triangle(std::size_t triangle, const glm::dvec3& foot);
    [[nodiscard]] bool in_round();

    void add(int of_solid, int of_thin, double weight) {
        Simplex& s = depth_.face;
        s.weight[s.count] = weight;
        s.add(solid_is_a_ ? pair_.corner(of_solid, of_thin) : pair_.corner(of_thin, of_solid));
    }
    // `slack` is how far the least extent may be off.
    [[nodiscard]] bool finish(const Way& way, double slack) {
        const glm::dvec3 out = to_world(way.m) / way.length;
        depth_.normal = solid_is_a_ ? out : -out;
        depth_.normal /= glm::length(depth_.normal);
        depth_.upper = pair_.extent(depth_.normal) + pair_.error;
        depth_.lower = std::max(0.0, way.extent - slack);
        depth_.has_face = true;
        return depth_.upper <= way.extent + slack + 2.0 * pair_.error;
    }

    const Pair& pair_;
    bool solid_is_a_;
    const Shape &solid_, &thin_;
    const glm::dmat3& rotation_;
    Depth& depth_;
    glm::dmat3 to_local_{1.0};
    glm::dvec3 end_[2];
    int ends_ = 1;
    double error_ = 0.0;
};

// An axis across two edges is off by 8u · size / |m| in direction, so its extent by 1e-10 of the size where |m| is a
// hundred-thousandth of the size. Edges that are parallel to 1e-10 of the size make no face wider than that. False for
// those between.
bool DeepCore::try_edges(Way& least) const {
    const glm::dvec3 s = end_[1] - end_[0], &half = solid_.half_extents();
    for (int k = 0; k < 3; ++k) {
        const int u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1;
        glm::dvec3 m(0.0);
        m[u] = -s[v];
        m[v] = s[u];
        const double length = glm::length(to_world(m));
        if (length < 1e-5 * pair_.size) {
            if (length > 1e-10 * pair_.size) return false;
            continue;
        }
        const double along = m[u] * end_[0][u] + m[v] * end_[0][v],
                     extent = (half[u] * std::abs(m[u]) + half[v] * std::abs(m[v]) - std::abs(along)) / length;
        if (!(extent < least.extent - 1e-12 * pair_.size)) continue;
        least = {along < 0.0 ? -m : m, extent, length, 3 + k};
    }
    return true;
}

bool DeepCore::in_box() {
    const glm::dvec3& half = solid_.half_extents();
    Way least;
    for (int k = 0; k < 3; ++k) {
        const double low = std::min(end_[0][k], end_[1][k]), high = std::max(end_[0][k], end_[1][k]);
        const double above = half[k] - low, below = half[k] + high, length = glm::length(row(k));
        const double extent = std::min(above, below) / length;
        if (!(extent < least.extent - 1e-12 * pair_.size)) continue;
        least = {glm::dvec3(0.0), extent, length, k};
        least.m[k] = above <= below ? 1.0 : -1.0;
    }
    if (ends_ == 2 && !try_edges(least)) return false;
    const double slack = ends_ == 2 ? 4e-10 * pair_.size : 1e-12 * pair_.size + error_;
    if (!(least.extent > slack)) return false;
    return (least.axis < 3 ? set_face_points(least) : set_edge_points(least)) && finish(least, slack);
}

// The foot on face 2k + side, between three of its corners, of one end.
void DeepCore::set_face_corners(int k, int side, const glm::dvec3& foot, int end) {
    const glm::dvec3& half = solid_.half_extents();
    const int u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1, corner = side << k;
    const double x = std::clamp(0.5 + 0.5 * foot[u] / half[u], 0.0, 1.0),
                 y = std::clamp(0.5 + 0.5 * foot[v] / half[v], 0.0, 1.0);
    const bool far = x + y > 1.0;
    add(corner | 1 << u, end, far ? 1.0 - y : x);
    add(corner | 1 << v, end, far ? 1.0 - x : y);
    add(far ? corner | 1 << u | 1 << v : corner, end, far ? x + y - 1.0 : 1.0 - x - y);
}

// The foot on the edge along axis k from a corner, and a point within the segment.
void DeepCore::set_edge_corners(int k, int corner, const glm::dvec3& foot, double t) {
    const double x = std::clamp(0.5 + 0.5 * foot[k] / solid_.half_extents()[k], 0.0, 1.0);
    add(corner, 0, (1.0 - x) * (1.0 - t));
    add(corner | 1 << k, 0, x * (1.0 - t));
    add(corner, 1, (1.0 - x) * t);
    add(corner | 1 << k, 1, x * t);
}

// The deepest end's foot, where it is on the face. Else the segment lies along the face, and leaves it at an edge.
bool DeepCore::set_face_points(const Way& way) {
    const glm::dvec3 &half = solid_.half_extents(), moved = motion(way), s = end_[1] - end_[0];
    const int k = way.axis, side = way.m[k] > 0.0 ? 1 : 0;
    const int deepest = way.m[k] * end_[1][k] < way.m[k] * end_[0][k] ? 1 : 0;
    if (!(half.x > 0.0 && half.y > 0.0 && half.z > 0.0)) return false;
    double from = 0.0, to = 1.0;
    int edge[2] = {-1, -1}, corner[2] = {0, 0};  // where it enters the face, and leaves it: the axis along that edge
    for (int j = 0; j < 3; ++j) {
        if (j == k) continue;
        for (const double sign : {-1.0, 1.0}) {
            const double at = sign * (end_[0][j] + moved[j]) - half[j], rate = sign * s[j];
            const int along = 3 - j - k, start = (side << k) | ((sign > 0.0 ? 1 : 0) << j);
            if (at <= error_ && at + rate <= error_) continue;
            if (rate == 0.0) return false;
            if (rate < 0.0 && -at / rate > from) from = -at / rate, edge[0] = along, corner[0] = start;
            if (rate > 0.0 && -at / rate < to) to = -at / rate, edge[1] = along, corner[1] = start;
        }
    }
    if (from > to) return false;
    const double t = deepest == 0 ? from : to;
    const glm::dvec3 foot = end_[0] + t * s + moved;
    if (edge[deepest] < 0) {
        set_face_corners(k, side, foot, deepest);
        return true;
    }
    if (std::abs((t - static_cast<double>(deepest)) * s[k]) > 1e-10 * pair_.size) return false;
    set_edge_corners(edge[deepest], corner[deepest], foot, t);
    return true;
}

// Where the box's edge and the segment cross, seen along the way.
bool DeepCore::set_edge_points(const Way& way) {
    const glm::dvec3 &half = solid_.half_extents(), moved = motion(way), s = end_[1] - end_[0];
    const int k = way.axis - 3, u = k == 2 ? 0 : k + 1, v = k == 0 ? 2 : k - 1;
    const int corner = (way.m[u] > 0.0 ? 1 << u : 0) | (way.m[v] > 0.0 ? 1 << v : 0);
    const int j = std::abs(s[u]) > std::abs(s[v]) ? u : v;
    const double t = ((way.m[j] > 0.0 ? half[j] : -half[j]) - moved[j] - end_[0][j]) / s[j];
    const glm::dvec3 foot = end_[0] + t * s + moved;
    if (!(t >= -1e-9 && t <= 1.0 + 1e-9 && std::abs(foot[k]) <= half[k] + 1e-9 * pair_.size && half[k] > 0.0))
        return false;
    set_edge_corners(k, corner, foot, std::clamp(t, 0.0, 1.0));
    return true;
}

// The least over the planes of the hull's triangles. Lengths in the world differ by 1e-6 from those in the frame: what
// is nearly the least is measured there.
bool DeepCore::in_hull() {
    const Hull& hull = *solid_.hull();
    if (hull.plane_error() > 1e-12) return false;
    const double *x = hull.plane_column(0), *y = hull.plane_column(1), *z = hull.plane_column(2),
                 *level = hull.plane_column(3);
    const glm::dvec3 c = end_[0];
    const std::size_t count = hull.triangles().size() / 3;
    const auto height = [&](std::size_t i) { return level[i] - ((x[i] * c.x + y[i] * c.y) + z[i] * c.z); };
    double lowest = HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i) lowest = std::min(lowest, height(i));
    const double slack = 1e-11 * pair_.size, near = lowest * (1.0 + 1e-5) + slack;
    const auto way_at = [&](std::size_t i) {
        const glm::dvec3 m(x[i], y[i], z[i]);
        const double length = glm::length(to_world(m));
        return Way{m, height(i) / length, length, 0};
    };
    Way least;
    for (std::size_t i = 0; i < count; ++i)
        if (height(i) <= near)
            if (const Way way = way_at(i); way.extent < least.extent) least = way;
    if (!(least.extent > slack)) return false;
    // Of triangles in one plane that which holds the foot.
    for (std::size_t i = 0; i < count; ++i) {
        if (height(i) > near) continue;
        const Way way = way_at(i);
        if (way.extent > least.extent + 1e-12 * pair_.size) continue;
        if (set_triangle(i, c + motion(way))) return finish(way, slack);
    }
    return false;
}

bool DeepCore::set_triangle(std::size_t triangle, const glm::dvec3& foot) {
    const Hull& hull = *solid_.hull();
    const auto corners = hull.triangles().subspan(3 * triangle, 3);
    const glm::dvec3 n(hull.plane_column(0)[triangle], hull.plane_column(1)[triangle], hull.plane_column(2)[triangle]);
    double weight[3], sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 p = solid_.vertex(corners[(k + 1) % 3]) - foot, q = solid_.vertex(corners[(k + 2) % 3]) - foot;
        weight[k] = glm::dot(glm::cross(p, q), n);
        sum += weight[k];
    }
    for (const double w : weight)
        if (!(w >= -1e-9 * sum)) return false;
    for (std::size_t k = 0; k < 3; ++k) add(corners[k], 0, std::max(0.0, weight[k]) / sum);
    return true;
}

// A disc, or the side: along the radius, or across the cone's lines. A pose changes lengths by no more than its columns
// deviate from a rotation's.
bool DeepCore::in_round() {
    const double radius = solid_.half_extents().x, half = solid_.half_extents().y;
    const glm::dvec3 c = end_[0];
    const double off_axis = std::sqrt(c.x * c.x + c.z * c.z);
    const glm::dvec3 radial = off_axis > 0.0 ? glm::dvec3(c.x / off_axis, 0.0, c.z / off_axis) : glm::dvec3(1, 0, 0);
    Way way;
    if (solid_.kind() == Kind::cylinder) {
        way = {{0.0, c.y < 0.0 ? -1.0 : 1.0, 0.0}, half - std::abs(c.y), 1.0, 0};
        if (radius - off_axis < way.extent) way = {radial, radius - off_axis, 1.0, 1};
    } else {
        const double slant = std::sqrt(4.0 * half * half + radius * radius);
        way = {{0.0, -1.0, 0.0}, c.y + half, 1.0, 0};
        const double side = (radius * (half - c.y) - 2.0 * half * off_axis) / slant;
        if (side < way.extent) way = {2.0 * half / slant * radial + glm::dvec3(0.0, radius / slant, 0.0), side, 1.0, 1};
    }
    double deviation = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            deviation = std::max(deviation, std::abs(glm::dot(rotation_[i], rotation_[j]) - (i == j ? 1.0 : 0.0)));
    if (!(way.extent > 1e-7 * pair_.size)) return false;
    const glm::dvec3 origin = solid_is_a_ ? glm::dvec3(0.0) : pair_.offset,
                     other = solid_is_a_ ? pair_.offset : glm::dvec3(0.0);
    const glm::dvec3 foot = origin + rotation_ * (c + way.extent * way.m);
    Simplex& s = depth_.face;
    s.weight[0] = 1.0;
    s.add(solid_is_a_ ? Corner{foot, other, foot - other, 0, 0} : Corner{other, foot, other - foot, 0, 0});
    way.length = glm::length(to_world(way.m));
    way.extent /= way.length;
    return finish(way, 8.0 * deviation * way.extent + error_);
}

bool is_solid(const Shape& shape) {
    return shape.kind() == Kind::box || shape.kind() == Kind::hull || shape.kind() == Kind::cylinder ||
           shape.kind() == Kind::cone;
}
bool is_thin(const Shape& shape) {
    return shape.kind() == Kind::sphere || shape.kind() == Kind::capsule;
}

// Whether the thin one surely lies on the outer side of a face of the solid's box: most pairs that are not deep do.
bool is_beyond_a_face(const Pair& pair, bool solid_is_a) {
    const Shape &solid = solid_is_a ? pair.a : pair.b, &thin = solid_is_a ? pair.b : pair.a;
    const RigidTransform &pose = solid_is_a ? pair.pose_a : pair.pose_b,
                         &thin_pose = solid_is_a ? pair.pose_b : pair.pose_a;
    const glm::dvec3 offset = solid_is_a ? pair.offset : -pair.offset, &low = solid.bounds().min,
                     &high = solid.bounds().max;
    const double slack = 1e-5 * pair.size - solid.radius();
    glm::dvec3 end[2];
    for (int i = 0; i < 2; ++i)
        end[i] =
            Pair::local(pose.rotation, thin_pose.rotation * thin.vertex(std::min(i, thin.vertex_count() - 1)) + offset);
    for (int k = 0; k < 3; ++k)
        if (std::min(end[0][k], end[1][k]) > high[k] + slack || std::max(end[0][k], end[1][k]) < low[k] - slack)
            return true;
    return false;
}

}  // namespace

bool deep_in_closed_form(const Pair& pair, Depth& depth) {
    const bool solid_is_a = is_solid(pair.a);
    if (!(solid_is_a ? is_thin(pair.b) : is_thin(pair.a) && is_solid(pair.b))) return false;
    if (is_beyond_a_face(pair, solid_is_a)) return false;
    DeepCore core(pair, solid_is_a, depth);
    // The points that the faces name must be the way apart from each other.
    return core.ask() && glm::length(witness(depth.face) - depth.upper * depth.normal) <=
                             (pair.has_polytope_cores() ? 5e-10 : 1e-5) * pair.size;
}

}  // namespace crofton::convex
