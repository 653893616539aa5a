// SPDX-License-Identifier: MIT
// Measures the lines that meet all of several bodies.
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <numbers>

#include "direction_cells.hpp"

namespace crofton::study {
namespace {

using std::numbers::pi;
constexpr int kSphereSides = 32;

using Polygon2 = Vector<glm::dvec2>;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

// Keeps what lies left of the line through `a` along `d`, moved to the left by `inset` (Sutherland and Hodgman).
void clip(Polygon2& polygon, Polygon2& scratch, const glm::dvec2& a, const glm::dvec2& d, double inset) {
    const double offset = inset * glm::length(d);
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
        const double s = cross(d, p - a) - offset, t = cross(d, q - a) - offset;
        if (s >= 0.0) scratch.push_back(p);
        if ((s < 0.0) != (t < 0.0)) scratch.push_back(p + s / (s - t) * (q - p));
    }
    polygon.swap(scratch);
}

double area(const Polygon2& polygon) {
    return polygon.size() < 3 ? 0.0 : measure::planar_measures_of_convex_polygon(polygon).area;
}

// The plane of a cell's shadows: along `axis`, with the shears by which the cell's corners look at it.
struct View {
    glm::dvec3 axis, right, up;
    std::array<glm::dvec2, 3> shears;
    double largest_shear = 0.0, least_cosine = 1.0;

    explicit View(const DirectionTriangle& corners) : axis(glm::normalize(corners[0] + corners[1] + corners[2])) {
        const auto frame = sampling::orthonormal_frame(axis);
        right = frame[0], up = frame[1];
        for (std::size_t k = 0; k < 3; ++k) {
            const double cosine = glm::dot(corners[k], axis);
            shears[k] = -glm::dvec2(glm::dot(corners[k], right), glm::dot(corners[k], up)) / cosine;
            largest_shear = std::max(largest_shear, glm::length(shears[k]));
            least_cosine = std::min(least_cosine, cosine);
        }
    }
};

class Shadows {
  public:
    Shadows(std::span<const ConvexBody> bodies) : bodies_(bodies) {
        // Heights are taken from a point amid the bodies, so that shears move little.
        std::size_t count = 0;
        for (const ConvexBody& body : bodies)
            for (const glm::dvec3& p : body.points) center_ += p, ++count;
        center_ /= static_cast<double>(count);
    }

    CellBounds operator()(const DirectionTriangle& corners) {
        const View view(corners);
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            cast(bodies_[i], view);
            const bool first = i == 0;
            intersect(inner_, middle_, first, margin_ + sphere_gap_);
            intersect(low_middle_, middle_, first, 0.0);
            intersect(outer_, swept_, first, 0.0);
        }
        // Along n the orthogonal shadow is the sheared one times dot(n, axis).
        const double angle = solid_angle(corners), value = area(low_middle_);
        return {angle * view.least_cosine * area(inner_), angle_weighted(corners, view) * value, angle * area(outer_)};
    }

  private:
    // ∫ dot(n, axis) dω over the cell.
    static double angle_weighted(const DirectionTriangle& corners, const View& view) {
        const auto w = linear_weights(corners);
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) sum += w[k] * glm::dot(corners[k], view.axis);
        return sum;
    }

    // middle_: the shadow along the axis, a sphere's outline as a polygon of its area; swept_: holds all shadows of the
    // cell.
    void cast(const ConvexBody& body, const View& view) {
        points_.clear(), swept_points_.clear();
        margin_ = sphere_gap_ = 0.0;
        const int sides = body.radius > 0.0 ? kSphereSides : 1;
        const double step = 2.0 * pi / kSphereSides;
        // A sheared sphere's outline is an ellipse of radii r and r/cos; the polygon around it reaches
        // r/(cos·cos(step/2)).
        const double around = body.radius / (view.least_cosine * cosine(0.5 * step));
        const double same_area = body.radius * std::sqrt(step / sine(step));
        if (body.radius > 0.0) sphere_gap_ = same_area - body.radius * cosine(0.5 * step);
        for (const glm::dvec3& p : body.points) {
            const glm::dvec3 d = p - center_;
            const glm::dvec2 flat(glm::dot(d, view.right), glm::dot(d, view.up));
            const double height = glm::dot(d, view.axis);
            margin_ = std::max(margin_, std::abs(height) * view.largest_shear);
            for (int s = 0; s < sides; ++s) {
                const glm::dvec2 spoke =
                    sides == 1 ? glm::dvec2(0.0) : sampling::circle_point(static_cast<double>(s) / kSphereSides);
                points_.push_back(flat + same_area * spoke);
                for (const glm::dvec2& shear : view.shears)
                    swept_points_.push_back(flat + height * shear + around * spoke);
            }
        }
        middle_ = *measure::convex_hull(points_);
        swept_ = *measure::convex_hull(swept_points_);
    }

    void intersect(Polygon2& common, const Polygon2& shadow, bool first, double inset) {
        if (first) common = shadow;
        if (first && inset == 0.0) return;
        if (shadow.size() < 3) return common.clear();
        for (std::size_t k = 0; k < shadow.size() && !common.empty(); ++k)
            clip(common, scratch_, shadow[k], shadow[(k + 1) % shadow.size()] - shadow[k], inset);
    }

    std::span<const ConvexBody> bodies_;
    glm::dvec3 center_{0.0};
    Polygon2 points_, swept_points_, middle_, swept_, inner_, low_middle_, outer_, scratch_;
    double margin_ = 0.0, sphere_gap_ = 0.0;
};

}  // namespace

Result<Enclosure> measure_of_lines_hitting_all(std::span<const ConvexBody> bodies, const QuadratureOptions& options) {
    if (auto valid = validate_bodies(bodies); !valid) return valid.error();
    return integrate_directions(options, Shadows(bodies));
}

Result<Enclosure> cauchy_area(const ConvexBody& body, const QuadratureOptions& options) {
    const auto lines = measure_of_lines_hitting_all({&body, 1}, options);
    if (!lines) return lines.error();
    const double scale = 2.0 / pi;
    return Enclosure{scale * lines->value, scale * lines->error, lines->cells};
}

}  // namespace crofton::study
