// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/study/planar_lines.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "sinusoid.hpp"

namespace crofton::study {

using std::numbers::pi;

double measure_of_lines_hitting_all(std::span<const PlanarSupport> figures) {
    if (figures.empty()) return std::numeric_limits<double>::infinity();
    return figures.size() == 1 ? figures[0].integral() : measure_of_lines_hitting_all(lower_envelope(figures));
}

double measure_of_lines_hitting_all(const PlanarSupport& envelope) {
    // The envelope turned by half a turn, cut at 0.
    Vector<PlanarSupport::Piece> opposite;
    const auto pieces = envelope.pieces();
    const auto after =
        std::upper_bound(pieces.begin() + 1, pieces.end(), pi,
                         [](double value, const PlanarSupport::Piece& piece) { return value < piece.begin; });
    opposite.push_back({0.0, (after - 1)->point, (after - 1)->radius});
    for (auto p = after; p != pieces.end(); ++p) opposite.push_back({p->begin - pi, p->point, p->radius});
    for (auto p = pieces.begin(); p != after; ++p) opposite.push_back({p->begin + pi, p->point, p->radius});
    double sum = 0.0;
    for_common_pieces(pieces, opposite,
                      [&](const PlanarSupport::Piece& p, const PlanarSupport::Piece& q, double begin, double end) {
                          if (begin >= pi) return;
                          const Sinusoid extent(p.point.x - q.point.x, p.point.y - q.point.y, p.radius + q.radius);
                          for_signs(extent, begin, std::min(end, pi), [&](double from, double to, double value) {
                              if (value > 0.0) sum += extent.integral(from, to);
                          });
                      });
    return sum;
}

namespace {

glm::dvec2 unit(double phi) {
    return cosine_sine(phi);
}

// The angles at which dot(d, u(φ)) = r: outer tangents of two discs (d, r differences), inner ones (r minus their sum).
void append_tangents(const glm::dvec2& d, double r, Vector<double>& angles) {
    const double distance = glm::length(d);
    if (distance <= std::abs(r)) return;
    const double phase = arc_tangent(d.y, d.x), offset = arc_cosine(r / distance);
    for (const double angle : {phase - offset, phase + offset})
        angles.push_back(angle - 2.0 * pi * std::floor(angle / (2.0 * pi)));
}

std::size_t lowest(std::span<const Disc> discs, double phi) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const double h = glm::dot(discs[i].center, unit(phi)) + discs[i].radius;
        if (h < least) least = h, best = i;
    }
    return best;
}

}  // namespace

double measure_of_lines_by_tangents(std::span<const Disc> discs) {
    if (discs.empty()) return std::numeric_limits<double>::infinity();
    Vector<double> angles;
    for (std::size_t i = 0; i < discs.size(); ++i)
        for (std::size_t j = i + 1; j < discs.size(); ++j) {
            append_tangents(discs[j].center - discs[i].center, discs[i].radius - discs[j].radius, angles);
            append_tangents(discs[j].center - discs[i].center, discs[i].radius + discs[j].radius, angles);
            append_tangents(discs[i].center - discs[j].center, discs[i].radius + discs[j].radius, angles);
        }
    angles.push_back(0.0);
    std::sort(angles.begin(), angles.end());
    angles.push_back(2.0 * pi + angles.front());
    // A line of normal u(φ) exists where the lowest disc on its one side reaches beyond that on the other. Between
    // common tangents nothing changes. An arc of disc i from α to β has length r·(β − α). What the tangents at its two
    // ends add is the part of them up to the foot of the origin's perpendicular, and two such parts make one whole
    // tangent.
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < angles.size(); ++k) {
        const double alpha = angles[k], beta = angles[k + 1], middle = 0.5 * (alpha + beta);
        if (alpha == beta) continue;
        const Disc& near = discs[lowest(discs, middle)];
        const Disc& far = discs[lowest(discs, middle + pi)];
        if (glm::dot(near.center - far.center, unit(middle)) + near.radius + far.radius <= 0.0) continue;
        const auto along = [&](double phi) {
            const glm::dvec2 u = unit(phi);
            return glm::dot(near.center, glm::dvec2(-u.y, u.x));
        };
        sum += near.radius * (beta - alpha) + along(alpha) - along(beta);
    }
    return sum;
}

}  // namespace crofton::study
