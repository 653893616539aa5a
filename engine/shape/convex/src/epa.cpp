// SPDX-License-Identifier: MIT
#include "epa.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crofton::convex {
namespace {

constexpr int kMaxCorners = 200, kMaxFaces = 3 * kMaxCorners;

struct Face {
    int corner[3], neighbor[3];  // neighbor k is across the edge from corner k to the next
    glm::dvec3 normal;           // unit, outward
    double distance;             // of the plane that is across `normal` and has all corners beyond it
    double determinant;          // of the corners
    bool alive, visible;
};

class Polytope {
  public:
    explicit Polytope(const Pair& pair) : pair_(pair), polytopes_(pair.has_polytope_cores()) {
        result_.upper = std::numeric_limits<double>::infinity();
    }

    // False if the difference body is flat: `result` then has an upper bound near 0.
    bool start(const Simplex& s);
    // Grows until the depth is known, or is above `enough`.
    void grow(double enough = std::numeric_limits<double>::infinity());
    [[nodiscard]] const Depth& result() const { return result_; }

  private:
    Corner support(const glm::dvec3& unit, double& along) {
        const Corner corner = pair_.support(unit, along);
        const double upper = along + pair_.error;
        if (upper < result_.upper) result_.upper = upper, result_.normal = unit;
        longest_ = std::max(longest_, glm::dot(corner.w, corner.w));
        return corner;
    }
    bool complete(glm::dvec3 (&directions)[3], int count);
    bool add_face(int a, int b, int c);
    void link(int f, int g);
    [[nodiscard]] int nearest_face() const;
    bool insert(int seen_from);
    void finish(int face);

    const Pair& pair_;
    bool polytopes_;
    Depth result_;
    Corner corner_[kMaxCorners];
    Face face_[kMaxFaces];
    int corners_ = 0, faces_ = 0;
    double longest_ = 0.0;  // squared, of the corners
};

glm::dvec3 perpendicular(const glm::dvec3& d) {
    const glm::dvec3 m = glm::abs(d);
    const glm::dvec3 axis = m.x <= m.y && m.x <= m.z ? glm::dvec3(1, 0, 0)
                            : m.y <= m.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
    return glm::normalize(glm::cross(d, axis));
}

bool Polytope::start(const Simplex& s) {
    for (int i = 0; i < s.count; ++i) {
        corner_[corners_++] = s.corner[i];
        longest_ = std::max(longest_, glm::dot(s.corner[i].w, s.corner[i].w));
    }
    const double flat = 0x1p-34 * pair_.size;
    // Each new corner is off the point, line or plane of those before; where none is, the shape is flat.
    while (corners_ < 4) {
        const glm::dvec3 origin = corner_[0].w, u = corners_ > 1 ? corner_[1].w - origin : glm::dvec3(0.0);
        glm::dvec3 directions[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        int count = 3;
        if (corners_ == 2) {
            directions[0] = perpendicular(u);
            directions[1] = glm::normalize(glm::cross(u, directions[0]));
            count = 2;
        } else if (corners_ == 3) {
            const glm::dvec3 n = glm::cross(u, corner_[2].w - origin);
            directions[0] = glm::length(n) > 0.0 ? glm::normalize(n) : perpendicular(u);
            count = 1;
        }
        bool found = false;
        for (int k = 0; k < count && !found; ++k)
            for (const glm::dvec3& d : {directions[k], -directions[k]}) {
                double along = 0.0;
                const Corner next = support(d, along);
                if (glm::dot(d, next.w - origin) <= flat) continue;
                corner_[corners_++] = next;
                found = true;
                break;
            }
        if (!found) return false;
    }
    if (glm::dot(glm::cross(corner_[1].w - corner_[0].w, corner_[2].w - corner_[0].w), corner_[3].w - corner_[0].w) > 0)
        std::swap(corner_[1], corner_[2]);
    if (!(add_face(0, 1, 2) && add_face(0, 3, 1) && add_face(1, 3, 2) && add_face(2, 3, 0))) return false;
    for (int f = 0; f < 4; ++f)
        for (int g = 0; g < 4; ++g)
            if (f != g) link(f, g);
    return true;
}

bool Polytope::add_face(int a, int b, int c) {
    if (faces_ == kMaxFaces) return false;
    Face& face = face_[faces_];
    face = {{a, b, c}, {-1, -1, -1}, {}, 0.0, 0.0, true, false};
    const glm::dvec3 &p = corner_[a].w, &q = corner_[b].w, &r = corner_[c].w;
    const glm::dvec3 n = glm::cross(q - p, r - p);
    const double length = glm::length(n);
    if (!(length > 0.0)) return false;
    face.normal = n / length;
    face.distance = std::min(glm::dot(face.normal, p), std::min(glm::dot(face.normal, q), glm::dot(face.normal, r)));
    face.determinant = glm::dot(glm::cross(p, q), r);
    ++faces_;
    return true;
}

void Polytope::link(int f, int g) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (face_[f].corner[i] == face_[g].corner[(j + 1) % 3] &&
                face_[f].corner[(i + 1) % 3] == face_[g].corner[j])
                face_[f].neighbor[i] = g;
}

int Polytope::nearest_face() const {
    int best = -1;
    for (int f = 0; f < faces_; ++f)
        if (face_[f].alive && (best < 0 || face_[f].distance < face_[best].distance)) best = f;
    return best;
}

// Replaces what the last corner sees by the cone over its rim. False where rounding has broken the surface.
bool Polytope::insert(int seen_from) {
    const glm::dvec3& w = corner_[corners_ - 1].w;
    int stack[kMaxFaces], visible[kMaxFaces], stacked = 0, seen = 0;
    stack[stacked++] = seen_from;
    face_[seen_from].visible = true;
    while (stacked > 0) {
        const int f = stack[--stacked];
        visible[seen++] = f;
        for (const int g : face_[f].neighbor) {
            Face& face = face_[g];
            if (face.visible || glm::dot(face.normal, w - corner_[face.corner[0]].w) <= pair_.error) continue;
            face.visible = true;
            stack[stacked++] = g;
        }
    }
    const int first = faces_;
    for (int i = 0; i < seen; ++i) {
        const Face& face = face_[visible[i]];
        face_[visible[i]].alive = false;
        for (int k = 0; k < 3; ++k) {
            const int beyond = face.neighbor[k];
            if (face_[beyond].visible) continue;
            const int added = faces_;
            if (!add_face(face.corner[k], face.corner[(k + 1) % 3], corners_ - 1)) return false;
            face_[added].neighbor[0] = beyond;
            for (int j = 0; j < 3; ++j)
                if (face_[beyond].neighbor[j] == visible[i] && face_[beyond].corner[j] == face.corner[(k + 1) % 3])
                    face_[beyond].neighbor[j] = added;
        }
    }
    for (int f = first; f < faces_; ++f)
        for (int g = first; g < faces_; ++g)
            if (face_[f].corner[1] == face_[g].corner[0]) {
                if (face_[f].neighbor[1] >= 0) return false;
                face_[f].neighbor[1] = g;
                face_[g].neighbor[2] = f;
            }
    for (int f = first; f < faces_; ++f)
        if (face_[f].neighbor[1] < 0 || face_[f].neighbor[2] < 0) return false;
    return true;
}

void Polytope::grow(double enough) {
    for (;;) {
        const int f = nearest_face();
        if (f < 0) return;
        double along = 0.0;
        corner_[corners_] = support(face_[f].normal, along);
        finish(f);
        if (result_.lower > enough) return;
        const Corner& next = corner_[corners_];
        bool known = along - face_[f].distance <= 4.0 * pair_.error;
        for (int i = 0; i < corners_ && !known; ++i)
            known = polytopes_ ? corner_[i].a == next.a && corner_[i].b == next.b : corner_[i].w == next.w;
        if (known || ++corners_ == kMaxCorners || !insert(f)) return;
    }
}

// The bounds as the polytope stands: the sphere of radius `distance` lies in it where the origin does. All determinants
// certainly positive: the surface, which is closed, goes around the origin at least once.
void Polytope::finish(int nearest) {
    const Face& face = face_[nearest];
    const double bound = determinant_error(pair_.size, longest_);
    bool around = true;
    for (int f = 0; f < faces_ && around; ++f) around = !face_[f].alive || face_[f].determinant > bound;
    if (around) result_.lower = std::max(result_.lower, face.distance - pair_.error);
    Simplex& s = result_.face;
    s.count = 3;
    const glm::dvec3 foot = face.distance * face.normal;
    double sum = 0.0, least = 0.0;
    for (int k = 0; k < 3; ++k) {
        s.corner[k] = corner_[face.corner[k]];
        const glm::dvec3 p = corner_[face.corner[(k + 1) % 3]].w - foot, q = corner_[face.corner[(k + 2) % 3]].w - foot;
        s.weight[k] = glm::dot(glm::cross(p, q), face.normal);
        least = std::min(least, s.weight[k]);
        sum += s.weight[k];
    }
    for (int k = 0; k < 3; ++k) s.weight[k] = std::max(0.0, s.weight[k] / sum);
    // The weights of a sliver are rounding: they need not give the foot.
    const glm::dvec3 off = witness(s) - foot;
    result_.has_face =
        result_.normal == face.normal && least >= -1e-9 * sum && glm::dot(off, off) <= 1e-22 * pair_.size * pair_.size;
}

}  // namespace

Depth expand(const Pair& pair, const Simplex& start) {
    Polytope polytope(pair);
    Depth depth;
    if (polytope.start(start)) {
        polytope.grow();
        depth = polytope.result();
    } else {
        depth = polytope.result();
        depth.face = start;
        depth.has_face = true;
    }
    return depth;
}

bool is_deeper(const Pair& pair, const Simplex& start, double limit) {
    Polytope polytope(pair);
    if (!polytope.start(start)) return false;
    polytope.grow(limit);
    return polytope.result().lower > limit;
}

}  // namespace crofton::convex
