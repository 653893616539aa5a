// SPDX-License-Identifier: MIT
// Formulas that no theorem's row calls: criteria of queries, figures of the plane, k-DOPs, preferred directions,
// visibility in bits, light fields and random cameras, against sums, integrals and cases by hand.
#include <algorithm>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/k_dop.hpp>
#include <crofton/study/light_field.hpp>
#include <crofton/study/mutual_information.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <crofton/study/query_distribution.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "bodies.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using measure::IntrinsicVolumes;
using std::numbers::pi;

// The mean of f over all directions, by the midpoints of a grid that is uniform by area.
template <class Function>
double mean_over_directions(Function f, int steps = 400) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) sum += f(sampling::direction({(i + 0.5) / steps, (j + 0.5) / steps}));
    return sum / (static_cast<double>(steps) * steps);
}

// The integral over an angle from 0 to 2π.
template <class Function>
double around(Function f, int steps = 1 << 18) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) sum += f(2.0 * pi * (i + 0.5) / steps);
    return sum * 2.0 * pi / steps;
}

void figure_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 1";
    const double radius = 1.7, a = 2.5, b = 0.75;
    const auto disc = measure::planar_measures_of_disc(radius), rectangle = measure::planar_measures_of_rectangle(a, b);
    // ∫ h is the perimeter (Cauchy), ∫ (h² − h'²) / 2 the area.
    rows.push_back(computed_row("a disc's perimeter: its breadths", source, disc.perimeter,
                                around([&](double) { return radius; }), 1e-6));
    rows.push_back(computed_row("a disc's area: its sectors", source, disc.area,
                                around([&](double) { return 0.5 * radius * radius; }), 1e-6));
    const auto h = [&](double t) { return 0.5 * (a * std::fabs(std::cos(t)) + b * std::fabs(std::sin(t))); };
    rows.push_back(computed_row("a rectangle's perimeter: its breadths", source, rectangle.perimeter, around(h), 1e-6));
    const double strips = around([&](double t) {  // r² / 2 from the middle
        const double c = std::fabs(std::cos(t)), s = std::fabs(std::sin(t));
        const double r = std::min(0.5 * a / std::max(c, 1e-300), 0.5 * b / std::max(s, 1e-300));
        return 0.5 * r * r;
    });
    rows.push_back(computed_row("a rectangle's area: its sectors", source, rectangle.area, strips, 1e-5));
    // The tight box around a triangle within a disc: ∫ min of both support functions.
    const std::vector<glm::dvec2> object = {{-0.5, -0.2}, {0.6, -0.1}, {0.1, 0.4}};
    const auto best = study::optimal_box(object, study::PlanarSupport(Disc{{0.0, 0.0}, 0.7}));
    if (!best) return rows.push_back(untried_row("the tight box given an ancestor", source));
    const double lines = around([](double t) {
        const double x = std::cos(t), y = std::sin(t);
        return std::min(0.7, (x > 0.0 ? 0.6 : -0.5) * x + (y > 0.0 ? 0.4 : -0.2) * y);
    });
    rows.push_back(
        computed_row("lines that meet the tight box and its ancestor, a disc", source, best->measure, lines, 1e-6));
}

void query_rows(std::vector<VerifyRow>& rows) {
    // Segments of length l at uniform places meet a box K where K drawn out along them is hit: V + l · shadow.
    const double l = 1.3, edges[3] = {0.8, 1.1, 0.4};
    const double drawn_out = mean_over_directions([&](const glm::dvec3& d) {
        double volume = edges[0] * edges[1] * edges[2];
        for (int k = 0; k < 3; ++k) volume += l * std::fabs(d[k]) * edges[(k + 1) % 3] * edges[(k + 2) % 3];
        return volume;
    });
    const IntrinsicVolumes box = measure::intrinsic_volumes_of_box(edges[0], edges[1], edges[2]);
    rows.push_back(computed_row("criterion for rays: segments that meet a box", "theory.md (2)",
                                measure::for_rays(l)(box), drawn_out, 1e-4));
    // A view's F from its faces and M from its edges, by hand: V + (M F' + F M') / 4π without its own volume.
    Camera camera;
    camera.fov_y = 0.9;
    camera.aspect = 1.4;
    camera.near_distance = 0.3;
    camera.far_distance = 4.0;
    const auto criterion = measure::for_frustum(camera);
    if (!criterion) return rows.push_back(untried_row("criterion for a frustum", "theory.md (2)"));
    const double tan_y = std::tan(0.5 * camera.fov_y), tan_x = tan_y * camera.aspect;
    const Body view = frustum_body(tan_x, tan_y, camera.near_distance, camera.far_distance, true);
    double area = 0.0, mean_curvature = 0.0;
    for (std::size_t f = 0; f < view.faces.size(); ++f) {
        const auto& face = view.faces[f];
        const auto at = [&](std::size_t i) { return view.corners[face[i % face.size()]]; };
        for (std::size_t i = 2; i < face.size(); ++i)
            area += 0.5 * glm::length(glm::cross(at(i - 1) - at(0), at(i) - at(0)));
        for (std::size_t g = f + 1; g < view.faces.size(); ++g) {
            std::vector<glm::dvec3> shared;
            for (const std::uint32_t c : face)
                if (std::find(view.faces[g].begin(), view.faces[g].end(), c) != view.faces[g].end())
                    shared.push_back(view.corners[c]);
            if (shared.size() == 2)
                mean_curvature +=
                    0.5 * glm::distance(shared[0], shared[1]) *
                    std::acos(std::clamp(glm::dot(glm::normalize(view.normals[f]), glm::normalize(view.normals[g])),
                                         -1.0, 1.0));
        }
    }
    rows.push_back(computed_row("criterion for a frustum: its faces and edges", "theory.md (2)", (*criterion)(box),
                                box.volume + (mean_curvature * box.area + area * box.mean_curvature) / (4.0 * pi),
                                1e-9));
}

double volume_of(const study::KDop& dop) {
    const auto volumes = measure::intrinsic_volumes_of_hull(dop.corners);
    return volumes ? volumes->volume : std::nan("");
}

void k_dop_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "docs/notes/measure.md, k-DOPs";
    std::vector<glm::dvec3> octahedron, cube;
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            octahedron.emplace_back(0.0);
            octahedron.back()[k] = side;
        }
    for (unsigned i = 0; i < 8; ++i) cube.emplace_back(i & 1u ? 1.0 : -1.0, i & 2u ? 1.0 : -1.0, i & 4u ? 1.0 : -1.0);
    // Around an octahedron: a cube, itself, a rhombic dodecahedron, itself. Around a cube: itself.
    const struct {
        std::uint32_t k;
        double volume;
    } known[] = {{6, 8.0}, {14, 4.0 / 3.0}, {18, 2.0}, {26, 4.0 / 3.0}};
    for (const auto& [k, volume] : known) {
        const std::string name = std::to_string(k) + "-DOP around ";
        const auto directions = study::k_dop_directions(k);
        if (!directions) {
            rows.push_back(untried_row(name + "an octahedron", source));
            continue;
        }
        const auto first = study::k_dop_around(octahedron, *directions),
                   second = study::k_dop_around(cube, *directions);
        rows.push_back(computed_row(name + "an octahedron: its volume", source,
                                    first ? volume_of(*first) : std::nan(""), volume, 1e-9));
        rows.push_back(
            computed_row(name + "a cube: the cube's", source, second ? volume_of(*second) : std::nan(""), 8.0, 1e-9));
    }
}

void direction_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "paper, section 3.4";
    const glm::dvec3 up(0.0, 0.0, 1.0);
    const double width = 0.4;
    const auto band = study::QueryDistribution::band(up, width);
    Obb box;
    box.half_extents = {0.5f, 0.25f, 1.0f};
    if (!band) return rows.push_back(untried_row("directions near a horizon", source));
    // Heights are uniform in ±sin(width): along the horizon the mean of √(1 − z²) · 2/π.
    double along = 0.0;
    const int steps = 100'000;
    for (int i = 0; i < steps; ++i) {
        const double z = std::sin(width) * (i + 0.5) / steps;
        along += 2.0 / pi * std::sqrt(1.0 - z * z) / steps;
    }
    const double upward = 0.5 * std::sin(width);
    rows.push_back(computed_row("uniform directions: the mean cosine is 1/2", source,
                                study::QueryDistribution().mean_cosine(glm::normalize(glm::dvec3(1.0, 2.0, 3.0))), 0.5,
                                1e-9));
    rows.push_back(computed_row("directions near a horizon: mean cosine with its axis", source, band->mean_cosine(up),
                                upward, 1e-3 * upward));
    rows.push_back(computed_row("directions near a horizon: mean cosine with a direction in it", source,
                                band->mean_cosine({1.0, 0.0, 0.0}), along, 1e-3 * along));
    const double planes = 2.0 * pi * (1.0 * along + 0.5 * along + 2.0 * upward),
                 lines = 2.0 * pi * (0.5 * 2.0 * along + 1.0 * 2.0 * along + 1.0 * 0.5 * upward);
    rows.push_back(computed_row("directions near a horizon: planes that hit a box", source,
                                band->measure_of_planes(box), planes, 1e-3 * planes));
    rows.push_back(computed_row("directions near a horizon: lines that hit a box", source, band->measure_of_lines(box),
                                lines, 1e-3 * lines));
    // One direction: the best box has the points' breadth along it, which no box can have less of.
    const glm::dvec3 only = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
    const auto one = study::QueryDistribution::samples({&only, 1});
    std::vector<glm::dvec3> points;
    sampling::Random random(7, 3);
    double low = 1e300, high = -1e300;
    for (int i = 0; i < 40; ++i) {
        points.push_back(glm::dvec3(1.0, 0.6, 0.3) *
                         (2.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - 1.0));
        low = std::min(low, glm::dot(points.back(), only));
        high = std::max(high, glm::dot(points.back(), only));
    }
    const auto fit = study::fit_box_for(points, *one, study::QueryKind::planes);
    const double breadth = 2.0 * pi * (high - low);
    rows.push_back(computed_row("the best box for planes of one direction is as broad as the points", source,
                                fit ? fit->value : std::nan(""), breadth, 5e-3 * breadth));
    rows.push_back(computed_row("its lower bound is the hull's measure", source, fit ? fit->lower_bound : std::nan(""),
                                breadth, 1e-9 * breadth));
    rows.push_back(at_most_row("it is no worse than the plain box", source, fit ? fit->plain_value : std::nan(""),
                               fit ? fit->value : std::nan(""), 0.0));
}

void information_rows(std::vector<VerifyRow>& rows) {
    const char* const source = "Feixas et al. 1999";
    // Two patches see each other, two others each itself and the other: p is 1/4 each, and what is told H(p) − H(p |
    // i).
    radiosity::FactorMatrix counted;
    counted.size = 4;
    counted.transfers = {0, 1000, 0, 0, 1000, 0, 0, 0, 0, 0, 500, 500, 0, 0, 500, 500};
    counted.rays = {1000, 1000, 1000, 1000};
    counted.escaped = {0, 0, 0, 0};
    const auto found = study::mutual_information(counted);
    if (!found) return rows.push_back(untried_row("mutual information of a ray's start and end", source));
    rows.push_back(computed_row("mutual information of a ray's start and end: two pairs of patches", source,
                                found->bits + found->bias, 1.5, 1e-9));
    rows.push_back(computed_row("entropy of four equal patches: two bits", source, found->entropy_bits, 2.0, 1e-9));
}

// A cuboid seen from within, lit alike everywhere.
void light_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 6";
    TriangleMesh room;
    const glm::vec3 size(4.0f, 3.0f, 5.0f);
    for (unsigned i = 0; i < 8; ++i)
        room.positions.push_back({i & 1u ? size.x : 0.0f, i & 2u ? size.y : 0.0f, i & 4u ? size.z : 0.0f});
    for (const auto& f : {std::array{0u, 4u, 6u, 2u},
                          {1u, 3u, 7u, 5u},
                          {0u, 1u, 5u, 4u},
                          {2u, 6u, 7u, 3u},
                          {0u, 2u, 3u, 1u},
                          {4u, 5u, 7u, 6u}})
        for (const std::uint32_t k : {f[0], f[2], f[1], f[0], f[3], f[2]}) room.indices.push_back(k);
    const auto tracer = lines::LineTracer::build(room);
    const auto normal = [&](std::uint32_t t) {
        const auto at = [&](std::size_t k) { return room.positions[room.indices[3 * std::size_t{t} + k]]; };
        return glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
    };
    const auto light = [&](std::uint32_t t, const glm::dvec3&) {
        return study::Leaving{{0.5f, 1.0f, 2.0f}, normal(t)};
    };
    const std::uint64_t lines = 1'600'000;
    if (!tracer) return rows.push_back(untried_row("a light field", source));
    const auto field = study::LightField::record(*tracer, light, {.lines = lines, .seed = options.seed});
    if (!field) return rows.push_back(untried_row("a light field", source));
    Camera camera;
    camera.position = {1.0, 1.5, 4.5};
    const auto drawn = field->draw(camera, 48, 32, {});
    rows.push_back(computed_row("lines of a light field that meet the scene's box: the requested number", source,
                                static_cast<double>(lines), static_cast<double>(field->lines()),
                                0.005 * static_cast<double>(lines)));
    rows.push_back(computed_row("each crosses a closed convex room twice, but for lines through its edges", source,
                                2.0 * static_cast<double>(field->lines()), static_cast<double>(field->crossings()),
                                1e-5 * static_cast<double>(lines)));
    double sum = 0.0;
    std::size_t pixels = 0;
    if (drawn)
        for (const glm::vec3& pixel : drawn->picture.pixels) {
            sum += static_cast<double>(pixel.z);
            ++pixels;
        }
    rows.push_back(computed_row("a room that glows alike everywhere: the light of each pixel", source, 2.0,
                                sum / static_cast<double>(pixels), 1e-6));
    // Arrivals are relative to the eye: a coordinate of each is a wall's.
    std::uint64_t off = 0;
    const auto arrivals = field->arrivals(camera.position, 0.3);
    for (const study::LightField::Arrival& arrival : arrivals) {
        double nearest = 1e300;
        for (int k = 0; k < 3; ++k) {
            const double x = camera.position[k] + arrival.point[k];
            nearest = std::min({nearest, std::fabs(x), std::fabs(x - static_cast<double>(size[k]))});
        }
        off += arrival.sky || nearest > 1e-3 || arrival.offset > 0.3;
    }
    rows.push_back(
        none_row("arrivals near the eye that are not on a wall, or pass too far away", source, arrivals.size(), off));
}

void camera_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 2, uniform motions";
    const Aabb places{{-1.0, 2.0, 0.0}, {3.0, 5.0, 0.5}};
    const sampling::UnitPoints points(options.seed * 1000 + 610);
    Mean forward, up, square, position;
    std::uint64_t crooked = 0;
    const std::uint64_t trials = std::max<std::uint64_t>(4 * options.trials, 400'000);
    for (std::uint64_t i = 0; i < trials; ++i) {
        const Camera camera = sampling::random_camera(Camera{}, places, points.at<6>(i));
        forward.add(std::fabs(camera.forward.z));
        up.add(std::fabs(camera.up.y));
        square.add(camera.forward.x * camera.forward.x);
        position.add(camera.position.y);
        crooked += std::fabs(glm::dot(camera.forward, camera.up)) > 1e-12 ||
                   std::fabs(glm::length(camera.forward) - 1.0) > 1e-12;
    }
    rows.push_back(measured_row("random cameras: mean |cosine| of where they look", source, 0.5, forward.value(),
                                forward.standard_error()));
    rows.push_back(
        measured_row("random cameras: mean |cosine| of the up vector", source, 0.5, up.value(), up.standard_error()));
    rows.push_back(measured_row("random cameras: mean squared cosine", source, 1.0 / 3.0, square.value(),
                                square.standard_error()));
    rows.push_back(measured_row("random cameras: the middle of their places", source, 3.5, position.value(),
                                position.standard_error()));
    rows.push_back(none_row("random cameras whose frames are not orthonormal", source, trials, crooked));
}

}  // namespace

std::vector<VerifyRow> formula_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    figure_rows(rows);
    query_rows(rows);
    k_dop_rows(rows);
    direction_rows(rows);
    information_rows(rows);
    light_rows(options, rows);
    camera_rows(options, rows);
    return rows;
}

}  // namespace crofton::cli
