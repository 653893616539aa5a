// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/geometry/cut_at_vertices.hpp>

namespace crofton {
namespace {

using CornerNumbers = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = ~std::uint32_t{0};

// The vertices of triangles, sorted along the lines parallel to each axis that they lie on.
class AxisLines {
  public:
    AxisLines(std::span<const glm::vec3> positions, std::span<const CornerNumbers> triangles) : positions_(positions) {
        Vector<std::uint32_t> used;
        for (const CornerNumbers& t : triangles) used.insert(used.end(), t.begin(), t.end());
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        for (int k = 0; k < 3; ++k) {
            Vector<std::uint32_t>& order = order_[static_cast<std::size_t>(k)];
            order = used;
            std::sort(order.begin(), order.end(),
                      [&](std::uint32_t i, std::uint32_t j) { return is_before(k, positions_[i], positions_[j]); });
        }
    }

    // A vertex strictly between two others of a line along an axis, or kNone. Exact: coordinates are equal.
    [[nodiscard]] std::uint32_t between(std::uint32_t a, std::uint32_t b) const {
        const glm::vec3 &p = positions_[a], &q = positions_[b];
        for (int k = 0; k < 3; ++k) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            if (p[u] != q[u] || p[v] != q[v] || p[k] == q[k]) continue;
            const glm::vec3 &low = p[k] < q[k] ? p : q, &high = p[k] < q[k] ? q : p;
            const Vector<std::uint32_t>& order = order_[static_cast<std::size_t>(k)];
            const auto next =
                std::upper_bound(order.begin(), order.end(), low,
                                 [&](const glm::vec3& at, std::uint32_t i) { return is_before(k, at, positions_[i]); });
            return next != order.end() && is_before(k, positions_[*next], high) ? *next : kNone;
        }
        return kNone;
    }

  private:
    static bool is_before(int k, const glm::vec3& p, const glm::vec3& q) {
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        if (p[u] != q[u]) return p[u] < q[u];
        if (p[v] != q[v]) return p[v] < q[v];
        return p[k] < q[k];
    }

    std::span<const glm::vec3> positions_;
    std::array<Vector<std::uint32_t>, 3> order_;
};

// Whether all corners lie on a line along an axis, exactly. Such a triangle covers no point, and cuts of it would be
// counted by none.
bool is_on_axis_line(std::span<const glm::vec3> positions, const CornerNumbers& t) {
    const glm::vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    int equal = 0;
    for (int k = 0; k < 3; ++k) equal += a[k] == b[k] && b[k] == c[k];
    return equal >= 2;
}

}  // namespace

Vector<CornerNumbers> cut_at_vertices(std::span<const glm::vec3> positions, std::span<const CornerNumbers> triangles) {
    const AxisLines lines(positions, triangles);
    const std::size_t most = 4 * triangles.size();
    Vector<CornerNumbers> cut, open(triangles.rbegin(), triangles.rend());
    while (!open.empty()) {
        const CornerNumbers t = open.back();
        open.pop_back();
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || is_on_axis_line(positions, t)) continue;
        bool whole = true;
        for (std::size_t s = 0; s < 3 && whole && cut.size() + open.size() < most; ++s) {
            const std::uint32_t a = t[s], b = t[(s + 1) % 3], c = t[(s + 2) % 3], m = lines.between(a, b);
            if (m == kNone) continue;
            open.push_back({m, b, c});
            open.push_back({a, m, c});
            whole = false;
        }
        if (whole) cut.push_back(t);
    }
    return cut;
}

}  // namespace crofton
