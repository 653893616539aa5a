// SPDX-License-Identifier: MIT
#include "fit_planar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/measure/measure.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "assets/file.hpp"
#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "polygon_files.hpp"
#include "report.hpp"
#include "svg_panel.hpp"

namespace crofton::cli {
namespace {

using fit::PlanarCriterion;

struct PlanarShape {
    const char* name;
    std::vector<glm::dvec2> outline;  // empty: a disc
    Disc disc;
    std::vector<glm::dvec2> contacts;  // where a best one must touch, or does
    double value = 0.0;
    const char* certificate = "";
    double off = 0.0;  // how far contacts that must be are missed, over the hull's perimeter
};

struct PlanarFit {
    std::string name;
    std::vector<glm::dvec2> ring, hull;
    double hull_area = 0.0, hull_perimeter = 0.0;
    std::vector<PlanarShape> shapes;  // rectangles by perimeter and area, disc, triangles by perimeter and area
};

constexpr double kPlanarPanel = 300.0, kPlanarHeading = 22.0, kPlanarMargin = 14.0;
constexpr const char* kPlanarColors[] = {"#0a58ca", "#c8553d"};  // by perimeter, by area

void draw(const PlanarFit& fit, std::size_t first, std::size_t count, const glm::dvec2& corner, std::string& svg) {
    const std::span shapes = std::span(fit.shapes).subspan(first, count);
    SvgPanel panel(corner + 0.5 * kPlanarPanel, kPlanarPanel - 2.0 * kPlanarMargin, svg);
    for (const glm::dvec2& p : fit.hull) panel.include(p);
    for (const PlanarShape& shape : shapes) {
        for (const glm::dvec2& p : shape.outline) panel.include(p);
        if (shape.outline.empty()) panel.include_disc(shape.disc.center, shape.disc.radius);
    }
    panel.path(fit.ring, "fill='#dfe6ee' stroke='none'");
    panel.path(fit.hull, "fill='none' stroke='#555' stroke-width='1' stroke-dasharray='3 2'");
    for (std::size_t s = 0; s < count; ++s) {
        const std::string color = kPlanarColors[s];
        const std::string style = "fill='none' stroke-width='1.5' stroke='" + color + "'";
        if (shapes[s].outline.empty())
            panel.disc(shapes[s].disc.center, shapes[s].disc.radius, style);
        else
            panel.path(shapes[s].outline, style);
        for (const glm::dvec2& p : shapes[s].contacts) panel.dot(p, "fill='" + color + "'");
    }
}

// A row of three panels for each of the `most` polygons with the most corners on the hull: rectangles, disc, triangles;
// contacts as dots.
std::string planar_fits_svg(const std::vector<PlanarFit>& fits, std::size_t most) {
    std::vector<const PlanarFit*> shown;
    for (const PlanarFit& fit : fits) shown.push_back(&fit);
    std::stable_sort(shown.begin(), shown.end(),
                     [](const PlanarFit* a, const PlanarFit* b) { return a->hull.size() > b->hull.size(); });
    shown.resize(std::min(most, shown.size()));
    std::string svg = svg_head(3.0 * kPlanarPanel,
                               static_cast<double>(shown.size()) * (kPlanarPanel + kPlanarHeading) + kPlanarHeading);
    svg_text(svg, kPlanarMargin, 15.0, kPlanarColors[0], "least perimeter; least disc");
    svg_text(svg, kPlanarMargin + 200.0, 15.0, kPlanarColors[1], "least area");
    svg_text(svg, kPlanarMargin + 320.0, 15.0, "#555", "hull dashed; dots: where a best bound touches");
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double top = kPlanarHeading + static_cast<double>(i) * (kPlanarPanel + kPlanarHeading);
        svg_text(svg, kPlanarMargin, top + 15.0, "#000", shown[i]->name);
        constexpr std::size_t first[] = {0, 2, 3}, count[] = {2, 1, 2};
        for (std::size_t k = 0; k < 3; ++k)
            draw(*shown[i], first[k], count[k], {static_cast<double>(k) * kPlanarPanel, top + kPlanarHeading}, svg);
    }
    return svg + "</svg>\n";
}

double cross_product(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

std::vector<glm::dvec2> corners_of(const Rectangle& r) {
    const glm::dvec2 x = r.half_extents.x * r.axis, y = r.half_extents.y * glm::dvec2(-r.axis.y, r.axis.x);
    return {r.center - x - y, r.center + x - y, r.center + x + y, r.center - x + y};
}

double distance_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 d = b - a;
    const double square = glm::dot(d, d), t = square > 0.0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0.0;
    return glm::distance(p, a + t * d);
}

double distance_to_outline(const glm::dvec2& p, const std::vector<glm::dvec2>& hull) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < hull.size(); ++i)
        least = std::min(least, distance_to_segment(p, hull[i], hull[(i + 1) % hull.size()]));
    return least;
}

// How far the outline's sides are from holding a side of the hull, at best: 0 where one is flush.
double flushness(const std::vector<glm::dvec2>& outline, const std::vector<glm::dvec2>& hull) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 side = outline[(i + 1) % outline.size()] - outline[i];
        const double length = glm::length(side);
        if (!(length > 0.0)) continue;
        for (std::size_t k = 0; k < hull.size(); ++k)
            least = std::min(least, std::max(std::abs(cross_product(side, hull[k] - outline[i])),
                                             std::abs(cross_product(side, hull[(k + 1) % hull.size()] - outline[i]))) /
                                        length);
    }
    return least;
}

// The points in which a best triangle must touch the hull: by area the middles of its sides, by perimeter where the
// excircles touch them, at s − b from one end (s half the perimeter).
std::vector<glm::dvec2> contacts_of(const std::vector<glm::dvec2>& t, bool area) {
    std::vector<glm::dvec2> contacts;
    double half = 0.0;
    for (std::size_t k = 0; k < 3; ++k) half += 0.5 * glm::distance(t[k], t[(k + 1) % 3]);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 &a = t[k], &b = t[(k + 1) % 3], &c = t[(k + 2) % 3];
        const double length = glm::distance(a, b);
        const double part = area || !(length > 0.0) ? 0.5 : (half - glm::distance(c, a)) / length;
        contacts.push_back(a + part * (b - a));
    }
    return contacts;
}

PlanarShape rectangle_shape(const std::vector<glm::dvec2>& hull, PlanarCriterion criterion) {
    const bool area = criterion == PlanarCriterion::area;
    PlanarShape shape{
        area ? "rectangle by area" : "rectangle by perimeter", {}, {}, {}, 0.0, "a side is flush", HUGE_VAL};
    const auto best = fit::minimal_rectangle(hull, criterion);
    if (!best) return shape;
    shape.outline = corners_of(*best);
    shape.value = area ? crofton::area(*best) : perimeter(*best);
    shape.off = hull.size() < 3 ? 0.0 : flushness(shape.outline, hull);
    return shape;
}

PlanarShape triangle_shape(const std::vector<glm::dvec2>& hull, PlanarCriterion criterion) {
    const bool area = criterion == PlanarCriterion::area;
    PlanarShape shape{
        area ? "triangle by area" : "triangle by perimeter",
        {},
        {},
        {},
        0.0,
        area ? "a side is flush, all touch in their middles" : "a side is flush, all touch where excircles do",
        HUGE_VAL};
    const auto best = fit::minimal_triangle(hull, criterion);
    if (!best) return shape;
    shape.outline.assign(best->begin(), best->end());
    const auto measures = measure::planar_measures_of_convex_polygon(*best);
    shape.value = area ? measures.area : measures.perimeter;
    shape.contacts = contacts_of(shape.outline, area);
    shape.off = hull.size() < 3 ? 0.0 : flushness(shape.outline, hull);
    for (const glm::dvec2& p : shape.contacts)
        if (hull.size() > 2) shape.off = std::max(shape.off, distance_to_outline(p, hull));
    return shape;
}

// Corners on the circle that do not all lie on one side of a diameter prove that no disc is smaller.
PlanarShape disc_shape(const std::vector<glm::dvec2>& hull) {
    PlanarShape shape{"disc", {}, {}, {}, 0.0, "touched on no half circle's side alone", HUGE_VAL};
    const auto best = fit::minimal_disc(hull);
    if (!best) return shape;
    shape.disc = *best;
    shape.value = best->radius;
    std::vector<double> angles;
    for (const glm::dvec2& p : hull) {
        const glm::dvec2 d = p - best->center;
        if (glm::length(d) < best->radius * (1.0 - 1e-9)) continue;
        shape.contacts.push_back(p);
        angles.push_back(std::atan2(d.y, d.x));
    }
    std::sort(angles.begin(), angles.end());
    double gap = angles.empty() ? HUGE_VAL : angles.front() + 2.0 * std::numbers::pi - angles.back();
    for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
    shape.off = hull.size() < 2 ? 0.0 : best->radius * std::max(0.0, gap - std::numbers::pi);
    return shape;
}

Result<PlanarFit> fit_polygon(const NamedPolygon& named) {
    PlanarFit result;
    result.name = named.name;
    if (named.polygon.ring_count() == 0) return fail(ErrorCode::empty, kNoItem, "no outer ring");
    const auto ring = named.polygon.ring(0);
    result.ring.assign(ring.begin(), ring.end());
    // Coordinates that are too large, or no numbers, are refused here.
    if (const auto checked = fit::minimal_disc(ring); !checked) return checked.error();
    const auto hull = measure::convex_hull(ring);
    if (!hull) return hull.error();
    result.hull.assign(hull->begin(), hull->end());
    const auto own = measure::planar_measures_of_convex_polygon(*hull);
    result.hull_area = own.area;
    result.hull_perimeter = own.perimeter;
    result.shapes = {rectangle_shape(result.hull, PlanarCriterion::perimeter),
                     rectangle_shape(result.hull, PlanarCriterion::area), disc_shape(result.hull),
                     triangle_shape(result.hull, PlanarCriterion::perimeter),
                     triangle_shape(result.hull, PlanarCriterion::area)};
    // Relative to the hull's size.
    for (PlanarShape& shape : result.shapes)
        shape.off = own.perimeter > 0.0 ? shape.off / own.perimeter : (shape.off > 0.0 ? HUGE_VAL : 0.0);
    return result;
}

Json to_json(const PlanarFit& fitted) {
    Json shapes = Json::array();
    for (const PlanarShape& shape : fitted.shapes) {
        Json corners = Json::array(), contacts = Json::array();
        for (const glm::dvec2& p : shape.outline) corners.push_back({p.x, p.y});
        for (const glm::dvec2& p : shape.contacts) contacts.push_back({p.x, p.y});
        Json entry{{"shape", shape.name},
                   {"value", shape.value},
                   {"certificate", shape.certificate},
                   {"off", std::isfinite(shape.off) ? Json(shape.off) : Json(nullptr)},
                   {"contacts", std::move(contacts)}};
        if (shape.outline.empty()) {
            entry["center"] = {shape.disc.center.x, shape.disc.center.y};
            entry["radius"] = shape.disc.radius;
        } else {
            entry["corners"] = std::move(corners);
        }
        shapes.push_back(std::move(entry));
    }
    return {{"name", fitted.name},
            {"hull_vertices", fitted.hull.size()},
            {"hull_area", fitted.hull_area},
            {"hull_perimeter", fitted.hull_perimeter},
            {"shapes", std::move(shapes)}};
}

void print(const std::vector<PlanarFit>& fits, std::size_t refused) {
    if (fits.size() == 1) {
        print_to(stdout, "%s: %zu corners on the hull, area %.9g, perimeter %.9g\n", printable(fits[0].name).c_str(),
                 fits[0].hull.size(), fits[0].hull_area, fits[0].hull_perimeter);
        for (const PlanarShape& shape : fits[0].shapes)
            print_to(stdout, "  %-22s %14.9g   %s, to %.1e of the perimeter\n", shape.name, shape.value,
                     shape.certificate, shape.off);
        return;
    }
    // Means of what each bound exceeds the hull by.
    print_to(stdout, "%zu polygons, %zu refused\n%-24s %14s %14s %12s\n", fits.size(), refused, "bound", "mean excess",
             "worst excess", "worst proof");
    for (std::size_t s = 0; !fits.empty() && s < fits[0].shapes.size(); ++s) {
        double sum = 0.0, worst = 0.0, off = 0.0;
        std::size_t count = 0;
        for (const PlanarFit& f : fits) {
            off = std::max(off, f.shapes[s].off);
            if (!(f.hull_area > 0.0)) continue;
            const PlanarShape& shape = f.shapes[s];
            const bool by_area = shape.name[std::char_traits<char>::length(shape.name) - 4] == 'a';
            const double own = by_area ? f.hull_area : f.hull_perimeter;
            const double value = shape.outline.empty() ? 2.0 * std::numbers::pi * shape.value : shape.value;
            sum += value / own - 1.0;
            worst = std::max(worst, value / own - 1.0);
            ++count;
        }
        print_to(stdout, "%-24s %13.2f%% %13.2f%% %12.1e\n", fits[0].shapes[s].name,
                 100.0 * sum / static_cast<double>(std::max<std::size_t>(1, count)), 100.0 * worst, off);
    }
    print_to(stdout,
             "excess: over the hull, in area where the bound is by area, else in perimeter; proof: how far contacts "
             "that must be are off, over the perimeter\n");
}

}  // namespace

Result<int> run_fit_planar(const PlanarFitRun& run) {
    std::vector<PlanarFit> fits;
    std::size_t refused = 0;
    for (const std::string& path : run.files) {
        if (!is_polygon_file(path))
            return fail(ErrorCode::unsupported, kNoItem,
                        path + ": --planar takes polygons: .poly, .json, .geojson, .wad");
        const auto file = read_polygons(path, "", run.read.limits);
        if (!file) return file.error();
        for (const std::string& warning : file->warnings)
            print_to(stderr, "crofton: warning: %s\n", printable(warning).c_str());
        for (const NamedPolygon& named : file->polygons) {
            auto fitted = fit_polygon(named);
            if (fitted) {
                fits.push_back(std::move(*fitted));
                continue;
            }
            ++refused;
            report_error(path + ": " + named.name, fitted.error());
        }
    }
    if (fits.empty() && refused == 0) return fail(ErrorCode::empty, kNoItem, "no polygons");
    if (!run.json_path.empty()) {
        Json list = Json::array();
        for (const PlanarFit& fitted : fits) list.push_back(to_json(fitted));
        if (auto written = write_json(run.json_path, {{"polygons", std::move(list)}, {"refused", refused}}); !written)
            return written.error();
    }
    if (!run.svg_path.empty())
        if (auto written = write_file(run.svg_path, planar_fits_svg(fits, run.drawn)); !written) return written.error();
    if (run.json_path != "-" && run.svg_path != "-") print(fits, refused);
    return refused > 0 ? kBadInput : kSuccess;
}

}  // namespace crofton::cli
