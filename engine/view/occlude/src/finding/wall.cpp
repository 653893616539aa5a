// SPDX-License-Identifier: MIT
#include "finding/wall.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <numeric>
#include <tuple>

namespace crofton::occlude {
namespace {

// A side of a triangle, or a part of one: a stretch of a line. Lines along an axis are known by their other
// coordinates, so that stretches of them can be compared. Any other edge is a line by itself, known by both its ends.
struct Stretch {
    int axis = kNoAxis;
    std::array<float, 6> line{};
    float low = 0.0f, high = 1.0f;
    int sign = 1;
    std::uint32_t triangle = 0;

    static constexpr int kNoAxis = 3;
    [[nodiscard]] bool same_line(const Stretch& other) const { return axis == other.axis && line == other.line; }
};

Stretch stretch_of(const glm::vec3& a, const glm::vec3& b, std::uint32_t triangle) {
    Stretch s;
    s.triangle = triangle;
    for (int axis = 0; axis < 3; ++axis) {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        if (a[i] != b[i] || a[j] != b[j]) continue;
        s.axis = axis;
        s.line = {a[i], a[j]};
        s.low = std::min(a[axis], b[axis]);
        s.high = std::max(a[axis], b[axis]);
        s.sign = a[axis] < b[axis] ? 1 : -1;
        return s;
    }
    const bool upward = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    const glm::vec3 &first = upward ? a : b, &last = upward ? b : a;
    s.line = {first.x, first.y, first.z, last.x, last.y, last.z};
    s.sign = upward ? 1 : -1;
    return s;
}

// The coordinate `axis` at both ends of the part [low, high] of a line.
std::array<float, 2> ends_along(const Stretch& s, float low, float high, int axis) {
    const auto k = static_cast<std::size_t>(axis);
    if (s.axis == Stretch::kNoAxis) return {s.line[k], s.line[k + 3]};
    if (s.axis == axis) return {low, high};
    const float fixed = s.line[axis == (s.axis + 1) % 3 ? 0 : 1];
    return {fixed, fixed};
}

// Groups of triangles that are connected across sides that cancel.
class Groups {
  public:
    explicit Groups(std::size_t count) : parent_(count), open_(count, 0) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    [[nodiscard]] std::uint32_t find(std::uint32_t t) {
        while (parent_[t] != t) t = parent_[t] = parent_[parent_[t]];
        return t;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    void set_open(std::uint32_t t) { open_[find(t)] = 1; }
    [[nodiscard]] bool is_open(std::uint32_t t) { return open_[find(t)] != 0; }

  private:
    Vector<std::uint32_t> parent_;
    Vector<std::uint8_t> open_;
};

class WallTest {
  public:
    WallTest(const PieceMesh& slab, Sides sides, const WallBox& box, std::size_t face)
        : mesh_(slab),
          sides_(sides),
          box_(box),
          axis_(static_cast<int>(face / 2)),
          is_upper_(face % 2 == 0),
          groups_(slab.triangles.size()) {}

    [[nodiscard]] bool run();

  private:
    void collect_boundaries();
    // Calls visit(stretches over the part) for all parts between ends of stretches.
    template <class Visit>
    void for_each_part(const Visit& visit);
    [[nodiscard]] bool cancels(int sum) const { return sides_ == Sides::front ? sum == 0 : sum % 2 == 0; }
    // Returns the sum over the group's stretches.
    [[nodiscard]] int sum_of(std::uint32_t group, const Vector<Stretch>& over);
    [[nodiscard]] bool may_meet(const Stretch& s, float low, float high) const;
    [[nodiscard]] int degree();

    const PieceMesh& mesh_;
    Sides sides_;
    const WallBox& box_;
    int axis_;
    bool is_upper_;
    Groups groups_;
    Vector<Stretch> boundary_;
};

// Sides within the box that no single other triangle shares; those that one shares hold both together. What is left may
// cancel with other groups, or with parts of longer sides. Sides that touch the box at most join nothing.
void WallTest::collect_boundaries() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 &a = mesh_.positions[mesh_.triangles[t][k]],
                            &b = mesh_.positions[mesh_.triangles[t][(k + 1) % 3]];
            if (a == b) continue;
            const Stretch s = stretch_of(a, b, t);
            if (!may_meet(s, s.low, s.high)) continue;
            if (mesh_.neighbors[t][k] != kNoNeighbor)
                groups_.unite(t, mesh_.neighbors[t][k]);
            else
                boundary_.push_back(s);
        }
    std::sort(boundary_.begin(), boundary_.end(), [](const Stretch& a, const Stretch& b) {
        return std::tie(a.axis, a.line, a.low, a.high, a.triangle, a.sign) <
               std::tie(b.axis, b.line, b.low, b.high, b.triangle, b.sign);
    });
}

template <class Visit>
void WallTest::for_each_part(const Visit& visit) {
    Vector<float> ends;
    Vector<Stretch> over;
    for (std::size_t i = 0, next = 0; i < boundary_.size(); i = next) {
        ends.clear();
        for (next = i; next < boundary_.size() && boundary_[next].same_line(boundary_[i]); ++next) {
            ends.push_back(boundary_[next].low);
            ends.push_back(boundary_[next].high);
        }
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        for (std::size_t e = 1; e < ends.size(); ++e) {
            over.clear();
            for (std::size_t s = i; s < next; ++s)
                if (boundary_[s].low <= ends[e - 1] && ends[e] <= boundary_[s].high) over.push_back(boundary_[s]);
            if (!over.empty() && may_meet(boundary_[i], ends[e - 1], ends[e])) visit(over);
        }
    }
}

int WallTest::sum_of(std::uint32_t group, const Vector<Stretch>& over) {
    int sum = 0;
    for (const Stretch& s : over)
        if (groups_.find(s.triangle) == group) sum += sides_ == Sides::front ? s.sign : 1;
    return sum;
}

// Unless both ends lie beyond one side of the box, across the face's axis: touching its boundary is allowed.
bool WallTest::may_meet(const Stretch& s, float low, float high) const {
    for (const int k : {(axis_ + 1) % 3, (axis_ + 2) % 3}) {
        const auto [p, q] = ends_along(s, low, high, k);
        if ((p <= box_.low[k] && q <= box_.low[k]) || (p >= box_.high[k] && q >= box_.high[k])) return false;
    }
    return true;
}

// Signed crossings of a line through the face with the groups that are not open. Axes are permuted so that the face's
// is the last, and turned so that it faces up: both keep orientations.
int WallTest::degree() {
    const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
    const double turn = is_upper_ ? 1.0 : -1.0;
    const auto flat = [&](const glm::vec3& p) {
        return glm::dvec2(static_cast<double>(p[i]), turn * static_cast<double>(p[j]));
    };
    const glm::dvec2 low = flat(box_.low), high = flat(box_.high);
    const glm::dvec2 at = low + glm::dvec2(0.37246, 0.61803) * (high - low);
    int sum = 0;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (groups_.is_open(t)) continue;
        bool covers = false;
        glm::dvec2 c[3];
        for (std::size_t k = 0; k < 3; ++k) c[k] = flat(mesh_.positions[mesh_.triangles[t][k]]);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 &a = c[k], &b = c[(k + 1) % 3];
            if ((a.y > at.y) == (b.y > at.y)) continue;
            covers ^= orientation(a.y < b.y ? a : b, a.y < b.y ? b : a, at) > 0;
        }
        if (covers) sum += orientation(c[0], c[1], c[2]);
    }
    return sum;
}

bool WallTest::run() {
    collect_boundaries();
    // Joins groups that are open along a part, but cancel there together.
    for_each_part([&](const Vector<Stretch>& over) {
        int sum = 0;
        for (const Stretch& s : over) sum += sides_ == Sides::front ? s.sign : 1;
        if (!cancels(sum)) return;
        std::uint32_t first = kNoNeighbor;
        for (const Stretch& s : over) {
            const std::uint32_t group = groups_.find(s.triangle);
            if (cancels(sum_of(group, over)) || group == first) continue;
            if (first != kNoNeighbor) groups_.unite(first, group);
            first = groups_.find(group);
        }
    });
    for_each_part([&](const Vector<Stretch>& over) {
        for (const Stretch& s : over)
            if (!cancels(sum_of(groups_.find(s.triangle), over))) groups_.set_open(s.triangle);
    });
    const int sum = degree();
    return sides_ == Sides::front ? sum > 0 : sum % 2 != 0;
}

}  // namespace

bool is_walled(const PieceMesh& mesh, Sides sides, const WallBox& box, std::size_t face, float inner) {
    const int axis = static_cast<int>(face / 2);
    const float outer = face_of(box, face), low = std::min(inner, outer), high = std::max(inner, outer);
    TriangleMesh slab;
    for (const auto& triangle : mesh.triangles) {
        const auto is_between = [&](std::uint32_t v) {
            return low <= mesh.positions[v][axis] && mesh.positions[v][axis] <= high;
        };
        if (!std::all_of(triangle.begin(), triangle.end(), is_between)) continue;
        for (const std::uint32_t v : triangle) {
            slab.indices.push_back(static_cast<std::uint32_t>(slab.positions.size()));
            slab.positions.push_back(mesh.positions[v]);
        }
    }
    return !slab.indices.empty() && WallTest(split_into_pieces(slab), sides, box, face).run();
}

}  // namespace crofton::occlude
