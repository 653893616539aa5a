// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/planar_support.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "sinusoid.hpp"

namespace crofton::study {

using std::numbers::pi;

PlanarSupport::PlanarSupport(const Disc& disc) {
    append(0.0, {0.0, disc.center, disc.radius});
}

PlanarSupport::PlanarSupport(const Rectangle& rectangle) {
    const glm::dvec2 x = rectangle.half_extents.x * rectangle.axis;
    const glm::dvec2 y = rectangle.half_extents.y * glm::dvec2(-rectangle.axis.y, rectangle.axis.x);
    const glm::dvec2 corners[4] = {rectangle.center + x + y, rectangle.center - x + y, rectangle.center - x - y,
                                   rectangle.center + x - y};
    // Corner k supports the quarter of directions that begins k quarters after the axis.
    const double turn = arc_tangent(rectangle.axis.y, rectangle.axis.x);
    const double quarters = std::floor(turn / (0.5 * pi));
    const double first = turn - quarters * (0.5 * pi);  // in [0, π/2): the first change of corner
    const auto corner = [&](int k) { return corners[static_cast<std::size_t>((k - static_cast<int>(quarters)) & 3)]; };
    append(0.0, {0.0, corner(-1), 0.0});
    for (int k = 0; k < 4; ++k) append(first + k * 0.5 * pi, {0.0, corner(k), 0.0});
}

Result<PlanarSupport> PlanarSupport::of_hull(std::span<const glm::dvec2> points) {
    const auto hull = measure::convex_hull(points);
    if (!hull) return hull.error();
    return of_convex_polygon(*hull);
}

PlanarSupport PlanarSupport::of_convex_polygon(std::span<const glm::dvec2> corners) {
    const std::size_t n = corners.size();
    const auto side = [&](std::size_t i) { return corners[(i + 1) % n] - corners[i % n]; };
    // Whether the outward normal of a side lies in [0, π). By signs, which a difference has exactly: where the order of
    // the sides begins must not hang on rounded angles.
    const auto in_first_half = [](const glm::dvec2& d) { return d.x < 0.0 || (d.x == 0.0 && d.y > 0.0); };
    std::size_t first = 0;
    for (std::size_t i = 0; i < n; ++i)
        if (in_first_half(side(i)) && !in_first_half(side(i + n - 1))) first = i;
    // Corner i + 1 takes over from corner i at the outward normal of the side between them.
    Vector<Piece> changes;
    changes.reserve(n);
    for (std::size_t i = first; i < first + n && n > 1; ++i) {
        double angle = arc_tangent(-side(i).x, side(i).y);
        if (angle <= 0.0 && !in_first_half(side(i))) angle += 2.0 * pi;
        changes.push_back({std::min(angle, 2.0 * pi), corners[(i + 1) % n], 0.0});
    }
    PlanarSupport result;
    if (changes.empty()) {
        result.append(0.0, {0.0, corners[0], 0.0});
        return result;
    }
    result.append(0.0, changes.back());
    for (const Piece& change : changes) result.append(change.begin, change);
    return result;
}

void PlanarSupport::append(double begin, const Piece& piece) {
    if (!pieces_.empty()) {
        begin = std::max(begin, pieces_.back().begin);  // rounding must not turn the order
        if (pieces_.back().point == piece.point && pieces_.back().radius == piece.radius) return;
        if (pieces_.back().begin == begin) pieces_.pop_back();
    }
    pieces_.push_back({begin, piece.point, piece.radius});
}

double PlanarSupport::operator()(double phi) const {
    phi -= 2.0 * pi * std::floor(phi / (2.0 * pi));
    const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), phi,
                                        [](double value, const Piece& piece) { return value < piece.begin; });
    return Sinusoid(*(after - 1))(phi);
}

double PlanarSupport::breadth(double phi) const {
    return (*this)(phi) + (*this)(phi + pi);
}

double PlanarSupport::integral() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
        sum +=
            Sinusoid(pieces_[i]).integral(pieces_[i].begin, i + 1 < pieces_.size() ? pieces_[i + 1].begin : 2.0 * pi);
    return sum;
}

PlanarSupport PlanarSupport::envelope(const PlanarSupport& a, const PlanarSupport& b, double sign) {
    PlanarSupport result;
    for_common_pieces(a.pieces(), b.pieces(), [&](const Piece& p, const Piece& q, double begin, double end) {
        // Where sign·(p − q) is negative p is taken; both equal, p.
        for_signs(Sinusoid(p) - Sinusoid(q), begin, end, [&](double from, double, double difference) {
            result.append(from, sign * difference <= 0.0 ? p : q);
        });
    });
    return result;
}

PlanarSupport min(const PlanarSupport& a, const PlanarSupport& b) {
    return PlanarSupport::envelope(a, b, 1.0);
}
PlanarSupport max(const PlanarSupport& a, const PlanarSupport& b) {
    return PlanarSupport::envelope(a, b, -1.0);
}

PlanarSupport lower_envelope(std::span<const PlanarSupport> figures) {
    // Pairs, then pairs of pairs: log n rounds over at most O(n) pieces each.
    Vector<PlanarSupport> level(figures.begin(), figures.end());
    while (level.size() > 1) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < level.size(); i += 2)
            level[kept++] = i + 1 < level.size() ? min(level[i], level[i + 1]) : level[i];
        level.erase(level.begin() + static_cast<std::ptrdiff_t>(kept), level.end());
    }
    return level.front();
}

double integral_of_min(const PlanarSupport& a, const PlanarSupport& b) {
    double sum = 0.0;
    for_common_pieces(a.pieces(), b.pieces(),
                      [&](const PlanarSupport::Piece& p, const PlanarSupport::Piece& q, double begin, double end) {
                          for_signs(Sinusoid(p) - Sinusoid(q), begin, end,
                                    [&](double from, double to, double difference) {
                                        sum += Sinusoid(difference <= 0.0 ? p : q).integral(from, to);
                                    });
                      });
    return sum;
}

double integral_of_min(const PlanarSupport& a, const Disc& b) {
    const PlanarSupport::Piece disc[] = {{0.0, b.center, b.radius}};
    double sum = 0.0;
    for_common_pieces(
        a.pieces(), disc, [&](const PlanarSupport::Piece& p, const PlanarSupport::Piece& q, double begin, double end) {
            for_signs(Sinusoid(p) - Sinusoid(q), begin, end, [&](double from, double to, double difference) {
                sum += Sinusoid(difference <= 0.0 ? p : q).integral(from, to);
            });
        });
    return sum;
}

}  // namespace crofton::study
