// SPDX-License-Identifier: MIT
#include "rounded_mass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "mass_integrals.hpp"

namespace crofton::convex {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

double whole_power(double base, int exponent) {
    double product = 1.0;
    for (int i = 0; i < exponent; ++i) product *= base;
    return product;
}

struct RoundFacet {
    std::array<glm::dvec3, 3> corners;  // counter-clockwise seen from outside
    std::array<int, 3> ids;
    glm::dvec3 normal;
};

glm::dmat3 outer_square(const glm::dvec3& v) {
    return glm::outerProduct(v, v);
}
glm::dmat3 symmetric_product(const glm::dvec3& u, const glm::dvec3& v) {
    return glm::outerProduct(u, v) + glm::outerProduct(v, u);
}

// A piece whose moments about `at` are known.
void add_piece(Moments& sum, const glm::dvec3& at, double volume, const glm::dvec3& first, const glm::dmat3& second) {
    sum.volume += volume;
    sum.first += first + volume * at;
    sum.second += second + symmetric_product(first, at) + volume * outer_square(at);
}

// Between the facet and its copy `radius` farther out.
void add_prism(Moments& sum, const RoundFacet& facet, double radius) {
    const auto& c = facet.corners;
    const glm::dvec3 up = radius * facet.normal;
    const auto wedge = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& d, const glm::dvec3& e) {
        Moments part;
        part.add_tetrahedron(b - a, d - a, e - a);
        add_piece(sum, a, part.volume, part.first, part.second);
    };
    wedge(c[0], c[1], c[2], c[2] + up);
    wedge(c[0], c[1], c[2] + up, c[1] + up);
    wedge(c[0], c[1] + up, c[2] + up, c[0] + up);
}

// The sector of a cylinder around the edge from p to q, between the normals n and m; c is across, out of n's facet.
// Returns the angle between the normals.
double add_sector(Moments& sum, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& n, const glm::dvec3& m,
                  double radius, glm::dvec3& middle) {
    const double length = glm::length(q - p);
    const glm::dvec3 along = length > 0.0 ? (q - p) / length : glm::dvec3(0.0);
    const glm::dvec3 c = glm::cross(along, n);
    const double angle = arc_tangent(std::max(0.0, glm::dot(m, c)), glm::dot(m, n));
    const glm::dvec2 half = cosine_sine(0.5 * angle);
    middle = half.x * n + half.y * c;
    const glm::dvec3 side = glm::cross(along, middle);
    const double r2 = radius * radius, area = 0.5 * angle * r2;
    // ∫ over the sector of x, x² along the middle and y² across it.
    const double mean = 2.0 / 3.0 * r2 * radius * half.y, bend = 0.5 * half.x * half.y * r2 * r2;
    const double inner = 0.25 * r2 * r2 * 0.5 * angle + 0.5 * bend, outer = 0.25 * r2 * r2 * 0.5 * angle - 0.5 * bend;
    const glm::dmat3 second = length * (inner * outer_square(middle) + outer * outer_square(side)) +
                              area * length * length * length / 12.0 * outer_square(along);
    add_piece(sum, 0.5 * (p + q), area * length, length * mean * middle, second);
    return angle;
}

// What corner v has of the sphere around it: the directions between its facets' normals. Sums over the edges at v of
// angle · u and u ⊗ s, where u leads along the edge and s is the integral of the directions over the edge's arc, and
// the facets' angles, say it all: ∫ n = −½ Σ angle u; 6 ∫ n nᵀ = 2 Ω I − Σ (u sᵀ + s uᵀ), Green's formula for n nᵀ, as
// its Laplacian is 2 I − 6 n nᵀ; Ω = 2π − Σ angles of facets (Gauss, Bonnet).
struct RoundCorner {
    glm::dvec3 at{0.0}, turned{0.0};
    glm::dmat3 arcs{0.0};
    double angles = 0.0;
    bool used = false;
};

void add_corner(Moments& sum, const RoundCorner& corner, double radius) {
    const double r3 = radius * radius * radius, solid = 2.0 * kHalfTurn - corner.angles;
    const glm::dmat3 directions = (2.0 * solid * glm::dmat3(1.0) - corner.arcs) / 6.0;
    add_piece(sum, corner.at, r3 / 3.0 * solid, -0.125 * r3 * radius * corner.turned,
              0.2 * r3 * radius * radius * directions);
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return arc_tangent(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Vector<RoundFacet> facets_of_box(const Shape& shape) {
    Vector<RoundFacet> facets;
    for (int k = 0; k < 3; ++k)
        for (const int sign : {-1, 1}) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            const auto corner = [&](int i, int j) {
                return (sign > 0 ? 1 << k : 0) + (i > 0 ? 1 << u : 0) + (j > 0 ? 1 << v : 0);
            };
            glm::dvec3 normal(0.0);
            normal[k] = sign;
            std::array<int, 4> loop{corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
            if (sign < 0) std::swap(loop[1], loop[3]);
            for (const int half : {1, 2}) {
                const std::array<int, 3> ids{loop[0], loop[static_cast<std::size_t>(half)],
                                             loop[static_cast<std::size_t>(half) + 1]};
                facets.push_back({{shape.vertex(ids[0]), shape.vertex(ids[1]), shape.vertex(ids[2])}, ids, normal});
            }
        }
    return facets;
}

Vector<RoundFacet> facets_of(const Shape& shape) {
    if (shape.kind() == Kind::box) return facets_of_box(shape);
    Vector<RoundFacet> facets;
    const auto add = [&](int a, int b, int c) {
        const glm::dvec3 p = shape.vertex(a), q = shape.vertex(b), r = shape.vertex(c);
        facets.push_back({{p, q, r}, {a, b, c}, glm::normalize(glm::cross(q - p, r - p))});
    };
    if (shape.hull() == nullptr) {
        add(0, 1, 2);
        add(0, 2, 1);
        return facets;
    }
    const auto t = shape.hull()->triangles();
    for (std::size_t i = 0; i < t.size(); i += 3) add(t[i], t[i + 1], t[i + 2]);
    return facets;
}

void add_edges(Moments& sum, const Vector<RoundFacet>& facets, double radius, Vector<RoundCorner>& corners) {
    struct Side {
        int from, to;
        std::size_t facet;
    };
    Vector<Side> sides;
    for (std::size_t f = 0; f < facets.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) sides.push_back({facets[f].ids[k], facets[f].ids[(k + 1) % 3], f});
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        const int low_a = std::min(a.from, a.to), low_b = std::min(b.from, b.to);
        const int high_a = std::max(a.from, a.to), high_b = std::max(b.from, b.to);
        if (low_a != low_b) return low_a < low_b;
        return high_a != high_b ? high_a < high_b : a.facet < b.facet;
    });
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
        const Side &one = sides[i], &other = sides[i + 1];
        RoundCorner &p = corners[static_cast<std::size_t>(one.from)], &q = corners[static_cast<std::size_t>(one.to)];
        glm::dvec3 middle;
        const double angle =
            add_sector(sum, p.at, q.at, facets[one.facet].normal, facets[other.facet].normal, radius, middle);
        const double length = glm::length(q.at - p.at);
        const glm::dvec3 u = length > 0.0 ? (q.at - p.at) / length : glm::dvec3(0.0);
        const glm::dvec3 arc = 2.0 * cosine_sine(0.5 * angle).y * middle;
        p.turned += angle * u;
        q.turned -= angle * u;
        p.arcs += symmetric_product(u, arc);
        q.arcs -= symmetric_product(u, arc);
    }
}

// A segment, or a point, of a core without area or breadth.
MassProperties mass_of_segment(const glm::dvec3& p, const glm::dvec3& q, double radius) {
    const double length = glm::length(q - p), r2 = radius * radius;
    const glm::dvec3 along = length > 0.0 ? (q - p) / length : glm::dvec3(0.0, 1.0, 0.0);
    const double h = 0.5 * length, cylinder = kHalfTurn * r2 * length, sphere = 4.0 / 3.0 * kHalfTurn * r2 * radius;
    const double across = cylinder * r2 / 4.0 + sphere * r2 / 5.0;
    const double lengthwise = cylinder * h * h / 3.0 + sphere * (r2 / 5.0 + h * h + 0.75 * h * radius);
    Moments moments;
    moments.volume = cylinder + sphere;
    moments.second = across * glm::dmat3(1.0) + (lengthwise - across) * outer_square(along);
    return mass_of(moments, 0.5 * (p + q));
}

}  // namespace

MassProperties mass_of_rounded_polytope(const Shape& shape) {
    const int count = shape.vertex_count();
    glm::dvec3 low = shape.vertex(0), high = low;
    for (int i = 1; i < count; ++i) low = glm::min(low, shape.vertex(i)), high = glm::max(high, shape.vertex(i));
    const glm::dvec3 size = high - low;
    if (shape.kind() == Kind::triangle) {
        const glm::dvec3 a = shape.vertex(0), b = shape.vertex(1), c = shape.vertex(2);
        if (glm::length(glm::cross(b - a, c - a)) <= 1e-14 * glm::dot(size, size)) {
            const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
            if (ab >= bc && ab >= ca) return mass_of_segment(a, b, shape.radius());
            return bc >= ca ? mass_of_segment(b, c, shape.radius()) : mass_of_segment(c, a, shape.radius());
        }
    }
    if (shape.kind() == Kind::box && (size.x > 0.0) + (size.y > 0.0) + (size.z > 0.0) < 2)
        return mass_of_segment(low, high, shape.radius());
    // About the middle, so that a shape far from its frame's origin loses nothing.
    const glm::dvec3 origin = 0.5 * (low + high);
    Vector<RoundFacet> facets = facets_of(shape);
    Vector<RoundCorner> corners(static_cast<std::size_t>(count));
    Moments sum;
    for (RoundFacet& facet : facets) {
        for (glm::dvec3& corner : facet.corners) corner -= origin;
        sum.add_tetrahedron(facet.corners[0], facet.corners[1], facet.corners[2]);
        add_prism(sum, facet, shape.radius());
        for (std::size_t k = 0; k < 3; ++k) {
            RoundCorner& corner = corners[static_cast<std::size_t>(facet.ids[k])];
            corner.at = facet.corners[k];
            corner.used = true;
            corner.angles +=
                angle_between(facet.corners[(k + 1) % 3] - corner.at, facet.corners[(k + 2) % 3] - corner.at);
        }
    }
    // Three right angles, also where a box is flat and its sides have no area.
    if (shape.kind() == Kind::box)
        for (RoundCorner& corner : corners) corner.angles = 1.5 * kHalfTurn;
    add_edges(sum, facets, shape.radius(), corners);
    for (const RoundCorner& corner : corners)
        if (corner.used) add_corner(sum, corner, shape.radius());
    return mass_of(sum, origin);
}

namespace {

// ∫ cosᵐ over [from, to].
double cosine_power(int m, const glm::dvec2& from, const glm::dvec2& to, double angle) {
    if (m == 0) return angle;
    if (m == 1) return to.y - from.y;
    const auto edge = [&](const glm::dvec2& at) { return whole_power(at.x, m - 1) * at.y / m; };
    return edge(to) - edge(from) + (m - 1.0) / m * cosine_power(m - 2, from, to, angle);
}

// Solids whose profile, the radius by height, is made of pieces: ∫ π ρ² dy, ∫ π ρ² y dy, ∫ π ρ² y² dy, ∫ π/4 ρ⁴ dy.
struct Profile {
    double volume = 0.0, first = 0.0, along = 0.0, across = 0.0;

    // From (r0, y0) straight to (r1, y1).
    void add_line(double r0, double y0, double r1, double y1) {
        const double height = y1 - y0, slope = r1 - r0;
        const auto moment = [&](int radii, int heights) {  // ∫ ρ^radii y^heights over the height, by binomials
            double sum = 0.0, choose_r = 1.0;
            for (int i = 0; i <= radii; ++i) {
                double choose_y = 1.0;
                for (int j = 0; j <= heights; ++j) {
                    sum += choose_r * choose_y * whole_power(r0, radii - i) * whole_power(slope, i) *
                           whole_power(y0, heights - j) * whole_power(height, j) / (i + j + 1);
                    choose_y = choose_y * (heights - j) / (j + 1);
                }
                choose_r = choose_r * (radii - i) / (i + 1);
            }
            return height * sum;
        };
        volume += kHalfTurn * moment(2, 0);
        first += kHalfTurn * moment(2, 1);
        along += kHalfTurn * moment(2, 2);
        across += 0.25 * kHalfTurn * moment(4, 0);
    }

    // The arc (R + r cos t, y + r sin t), from and to being cosine and sine of its ends, `angle` apart.
    void add_arc(double R, double y, double r, const glm::dvec2& from, const glm::dvec2& to, double angle) {
        const auto c = [&](int m) { return cosine_power(m, from, to, angle); };
        // ∫ cosᵐ sin = −Δ cosᵐ⁺¹ / (m + 1); sin² = 1 − cos².
        const auto cs = [&](int m) { return (whole_power(from.x, m + 1) - whole_power(to.x, m + 1)) / (m + 1); };
        const auto css = [&](int m) { return c(m) - c(m + 2); };
        const auto disc = [&](const auto& integral) {  // ∫ ρ² · (…) r cos dt
            return r * (R * R * integral(1) + 2.0 * R * r * integral(2) + r * r * integral(3));
        };
        volume += kHalfTurn * disc(c);
        first += kHalfTurn * (y * disc(c) + r * disc(cs));
        along += kHalfTurn * (y * y * disc(c) + 2.0 * y * r * disc(cs) + r * r * disc(css));
        across += 0.25 * kHalfTurn * r *
                  (R * R * R * R * c(1) + 4.0 * R * R * R * r * c(2) + 6.0 * R * R * r * r * c(3) +
                   4.0 * R * r * r * r * c(4) + r * r * r * r * c(5));
    }
};

}  // namespace

MassProperties mass_of_rounded_revolution(const Shape& shape) {
    const double R = shape.half_extents().x, h = shape.half_extents().y, r = shape.radius();
    const glm::dvec2 down(0.0, -1.0), out(1.0, 0.0), up(0.0, 1.0);
    Profile profile;
    if (shape.kind() == Kind::cylinder) {
        profile.add_arc(R, -h, r, down, out, 0.5 * kHalfTurn);
        profile.add_line(R + r, -h, R + r, h);
        profile.add_arc(R, h, r, out, up, 0.5 * kHalfTurn);
    } else {
        // The slant's normal: a cone without height is a disc, one without radius a segment.
        const double length = std::hypot(2.0 * h, R);
        const glm::dvec2 slant = length > 0.0 ? glm::dvec2(2.0 * h, R) / length : out;
        const double tilt = arc_tangent(slant.y, slant.x);
        profile.add_arc(R, -h, r, down, slant, 0.5 * kHalfTurn + tilt);
        profile.add_line(R + r * slant.x, -h + r * slant.y, r * slant.x, h + r * slant.y);
        profile.add_arc(0.0, h, r, slant, up, 0.5 * kHalfTurn - tilt);
    }
    Moments moments;
    moments.volume = profile.volume;
    moments.first = {0.0, profile.first, 0.0};
    moments.second[0][0] = moments.second[2][2] = profile.across;
    moments.second[1][1] = profile.along;
    return mass_of(moments, glm::dvec3(0.0));
}

}  // namespace crofton::convex
