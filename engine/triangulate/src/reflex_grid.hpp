// The reflex corners that may still lie in an ear, by place.
#pragma once
#include <crofton/core/memory.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "half_edge_mesh.hpp"

namespace crofton::triangulate {

// A uniform grid of about one vertex a cell, made anew whenever half of them have gone: so a query's cells are in
// proportion to the vertices left.
class ReflexGrid {
  public:
    // Each vertex is listed once.
    void build(std::span<const glm::dvec2> points, std::span<const Index> vertices);
    // Does nothing if the vertex is not in the grid.
    void remove(Index vertex);

    // A vertex in the closed box for which admit(vertex, position) holds, or kNone.
    template <class Admit>
    [[nodiscard]] Index find(const glm::dvec2& low, const glm::dvec2& high, Admit admit) const {
        if (vertices_.empty()) return kNone;
        const Index left = column(low.x), right = column(high.x), top = row(high.y);
        for (Index y = row(low.y); y <= top; ++y) {
            for (Index i = begin_[y * columns_ + left]; i < begin_[y * columns_ + right + 1]; ++i) {
                const glm::dvec2& p = positions_[i];
                const bool in_box = (p.x >= low.x) & (p.x <= high.x) & (p.y >= low.y) & (p.y <= high.y);
                if (in_box && vertices_[i] != kNone && admit(vertices_[i], p)) return vertices_[i];
            }
        }
        return kNone;
    }

  private:
    void fill();
    // Monotonic, also in rounding, and clamped to the grid.
    [[nodiscard]] static Index cell(double x, double low, double per_unit, Index count) {
        const double c = (x - low) * per_unit;
        return c > 0.0 ? static_cast<Index>(c < count ? c : count - 1.0) : 0;
    }
    [[nodiscard]] Index column(double x) const { return cell(x, low_.x, per_unit_.x, columns_); }
    [[nodiscard]] Index row(double y) const { return cell(y, low_.y, per_unit_.y, rows_); }
    [[nodiscard]] Index cell_of(Index vertex) const {
        return row(points_[vertex].y) * columns_ + column(points_[vertex].x);
    }

    std::span<const glm::dvec2> points_;
    glm::dvec2 low_{0.0}, per_unit_{0.0};
    Index columns_ = 1, rows_ = 1;
    Vector<Index> begin_, vertices_, members_;  // vertices_: by cell, row by row; kNone where one has gone
    Vector<glm::dvec2> positions_;              // of vertices_
    std::size_t left_ = 0;
};

}  // namespace crofton::triangulate
