// SPDX-License-Identifier: MIT
#include "finding/inscribed_box.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace crofton::occlude {
namespace {

// How far the face on side `sign` may move along `axis` before it meets the triangle's part of the box's open prism:
// the coordinate where that part begins, or `limit` if it is not in the way.
double nearest_in_way(const Triangle& t, const FrameBox& box, int axis, int sign, double limit) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const glm::dvec3 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
    for (const int k : {i, j})
        if (high[k] <= box.low[k] || low[k] >= box.high[k]) return limit;
    const double middle = 0.5 * (box.low[axis] + box.high[axis]);
    if (sign > 0 ? (high[axis] <= middle || low[axis] >= limit) : (low[axis] >= middle || high[axis] <= limit))
        return limit;
    CutPolygon part(t);
    for (const int k : {i, j}) {
        part.keep(k, box.high[k], 1);
        part.keep(k, box.low[k], -1);
    }
    for (const glm::dvec3& p : part.corners()) {
        if (sign > 0 && p[axis] >= middle) limit = std::min(limit, p[axis]);
        if (sign < 0 && p[axis] <= middle) limit = std::max(limit, p[axis]);
    }
    return limit;
}

double farthest(const FramedPiece& piece, const FrameBox& box, int axis, int sign) {
    double limit = sign > 0 ? piece.high[axis] : piece.low[axis];
    for (const Triangle& t : piece.triangles) limit = nearest_in_way(t, box, axis, sign, limit);
    return sign > 0 ? std::max(limit, box.high[axis]) : std::min(limit, box.low[axis]);
}

float float_at_most(double value) {
    const float rounded = static_cast<float>(value);
    return static_cast<double>(rounded) > value ? std::nextafter(rounded, -1.0f) : rounded;
}

StoredBox stored_box(const FramedPiece& piece, const FrameBox& box, double margin) {
    StoredBox result;
    result.box.axes = piece.axes;
    result.box.center = piece.origin;
    for (int k = 0; k < 3; ++k) {
        result.box.center += 0.5 * (box.low[k] + box.high[k]) * glm::dvec3(piece.axes[k]);
        result.box.half_extents[k] = std::max(0.0f, float_at_most(0.5 * (box.high[k] - box.low[k]) - margin));
    }
    const auto exact = corners(result.box);
    std::transform(exact.begin(), exact.end(), result.corners.begin(),
                   [](const glm::dvec3& p) { return glm::vec3(p); });
    return result;
}

struct BoxShape {
    glm::dvec3 center;
    std::array<glm::dvec3, 3> edge;    // half edges: exact, products of floats
    std::array<glm::dvec3, 8> corner;  // rounded to float, relative to the center
    glm::dvec3 size;                   // magnitudes of what enters a dot product, by component

    explicit BoxShape(const StoredBox& stored) : center(stored.box.center), size(0.0) {
        for (int k = 0; k < 3; ++k) {
            const std::size_t i = static_cast<std::size_t>(k);
            edge[i] = glm::dvec3(stored.box.axes[k]) * static_cast<double>(stored.box.half_extents[k]);
            size += glm::abs(edge[i]);
        }
        for (std::size_t i = 0; i < 8; ++i) {
            corner[i] = glm::dvec3(stored.corners[i]) - center;
            size = glm::max(size, glm::abs(glm::dvec3(stored.corners[i])));
        }
        size += glm::abs(center);
    }
};

// Whether direction n separates: the triangle's extent along n begins where those of the box and of the hull end, or
// ends where they begin. n itself is exact: any direction may serve. With u = 2^-53, offsets d = v − center are off by
// u (|v| + |c|), a dot product with n by 3u Σ|n_i||d_i| more, the sum of three products with edges by 6u Σ|n_i|
// |edge|_i, the comparison by 2u of both. All are below 12u Σ|n_i| size_i, with the sizes of both bodies added. 32u
// also covers that the bound is rounded itself.
bool separates(const glm::dvec3& n, const BoxShape& box, const Triangle& t, const std::array<glm::dvec3, 3>& offset) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec3& d : offset) {
        const double at = glm::dot(n, d);
        low = std::min(low, at);
        high = std::max(high, at);
    }
    const double radius =
        std::abs(glm::dot(n, box.edge[0])) + std::abs(glm::dot(n, box.edge[1])) + std::abs(glm::dot(n, box.edge[2]));
    if (!(low > radius || high < -radius)) return false;
    double box_low = -radius, box_high = radius;
    for (const glm::dvec3& d : box.corner) {
        const double at = glm::dot(n, d);
        box_low = std::min(box_low, at);
        box_high = std::max(box_high, at);
    }
    const glm::dvec3 size = glm::max(glm::abs(t[0]), glm::max(glm::abs(t[1]), glm::abs(t[2])));
    return std::max(low - box_high, box_low - high) > 0x1p-48 * glm::dot(glm::abs(n), size + box.size);
}

bool is_apart(const BoxShape& box, const Triangle& t) {
    const std::array<glm::dvec3, 3> offset{t[0] - box.center, t[1] - box.center, t[2] - box.center};
    for (std::size_t k = 0; k < 3; ++k)
        if (separates(glm::cross(box.edge[(k + 1) % 3], box.edge[(k + 2) % 3]), box, t, offset)) return true;
    const std::array<glm::dvec3, 3> side{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
    if (separates(glm::cross(side[0], side[1]), box, t, offset)) return true;
    for (const glm::dvec3& s : side)
        for (const glm::dvec3& e : box.edge)
            if (separates(glm::cross(s, e), box, t, offset)) return true;
    return false;
}

}  // namespace

void CutPolygon::keep(int axis, double value, int sign) {
    const auto is_kept = [&](const glm::dvec3& p) { return sign > 0 ? p[axis] <= value : p[axis] >= value; };
    const auto before = corners_;
    if (count_ + 2 > corners_.size()) return;  // never for a convex polygon; keeps what rounding made within the array
    const std::size_t count = count_;
    count_ = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const glm::dvec3 &p = before[k], &q = before[(k + 1) % count];
        if (is_kept(p)) corners_[count_++] = p;
        if (is_kept(p) != is_kept(q)) {
            glm::dvec3 cut = p + (q - p) * ((value - p[axis]) / (q[axis] - p[axis]));
            cut[axis] = value;
            corners_[count_++] = cut;
        }
    }
}

FramedPiece frame_piece(Vector<Triangle> triangles, const glm::mat3& axes) {
    FramedPiece piece;
    piece.axes = axes;
    glm::dvec3 low = triangles[0][0], high = low;
    for (const Triangle& t : triangles)
        for (const glm::dvec3& p : t) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    piece.origin = 0.5 * (low + high);
    // The stored axes are orthonormal only to float rounding; their inverse makes the coordinates those of the box.
    const glm::dmat3 to_frame = glm::inverse(glm::dmat3(axes));
    piece.low = piece.high = to_frame * (triangles[0][0] - piece.origin);
    piece.triangles.reserve(triangles.size());
    for (const Triangle& t : triangles) {
        Triangle& framed = piece.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            framed[k] = to_frame * (t[k] - piece.origin);
            piece.low = glm::min(piece.low, framed[k]);
            piece.high = glm::max(piece.high, framed[k]);
        }
    }
    piece.positions = std::move(triangles);
    return piece;
}

void push_faces(const FramedPiece& piece, FrameBox& box) {
    std::array<bool, 6> done{};
    for (int round = 0; round < 6; ++round) {
        double best = -1.0, to = 0.0;
        std::size_t face = 0;
        for (std::size_t f = 0; f < 6; ++f) {
            if (done[f]) continue;
            const int axis = static_cast<int>(f / 2), sign = f % 2 == 0 ? 1 : -1;
            const double limit = farthest(piece, box, axis, sign);
            FrameBox pushed = box;
            (sign > 0 ? pushed.high : pushed.low)[axis] = limit;
            if (pushed.mean_shadow() > best) {
                best = pushed.mean_shadow();
                to = limit;
                face = f;
            }
        }
        done[face] = true;
        (face % 2 == 0 ? box.high : box.low)[static_cast<int>(face / 2)] = to;
    }
}

bool surely_apart(const StoredBox& box, const Triangle& triangle) {
    return is_apart(BoxShape(box), triangle);
}

std::optional<StoredBox> certify(const FramedPiece& piece, const FrameBox& box) {
    const glm::dvec3 size = piece.high - piece.low, origin = glm::abs(piece.origin);
    const double extent = std::max({size.x, size.y, size.z});
    // Rounding to float moves a corner by 2^-24 of its coordinates, each.
    double margin = 0x1.2p-23 * (0.5 * extent + std::max({origin.x, origin.y, origin.z}));
    for (int attempt = 0; attempt < 8; ++attempt, margin *= 2.0) {
        const StoredBox stored = stored_box(piece, box, margin);
        const glm::vec3& half = stored.box.half_extents;
        if (!(half.x > 0.0f && half.y > 0.0f && half.z > 0.0f)) return std::nullopt;
        const BoxShape shape(stored);
        const auto apart = [&](const Triangle& t) { return is_apart(shape, t); };
        if (std::all_of(piece.positions.begin(), piece.positions.end(), apart)) return stored;
    }
    return std::nullopt;
}

}  // namespace crofton::occlude
