// SPDX-License-Identifier: MIT
// `crofton study hierarchy`: chains of bounds of the plane, each the best given the ones before it: section 4 of the
// paper.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <crofton/study/planar_lines.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "polygon_files.hpp"
#include "progress_bar.hpp"
#include "report.hpp"
#include "svg_panel.hpp"
#include "verify/rows.hpp"

namespace crofton::cli {
namespace {

using std::numbers::pi;
using study::PlanarSupport;

struct ChainLevel {
    std::optional<Disc> disc;
    std::optional<Rectangle> rectangle;  // one of both
    double measure = 0.0;                // of the lines that hit this bound and all before it
    double gap = 0.0;                    // proved: no bound of its kind has less than measure − gap
};

struct Chain {
    std::string name;
    std::vector<glm::dvec2> object;
    double own = 0.0;  // the measure of the lines that hit the object
    std::vector<ChainLevel> levels;
};

constexpr double kChainPanel = 320.0, kChainHeading = 24.0, kChainMargin = 14.0;
constexpr const char* kChainColors[] = {"#1b2a41", "#0a58ca", "#c8553d", "#2a9d8f",
                                        "#8e6bbf", "#b08900", "#777777", "#aaaaaa"};

const char* color_of(std::size_t level) {
    return kChainColors[level % std::size(kChainColors)];
}

std::array<glm::dvec2, 4> outline_of(const Rectangle& r) {
    const glm::dvec2 x = r.half_extents.x * r.axis, y = r.half_extents.y * glm::dvec2(-r.axis.y, r.axis.x);
    return {r.center - x - y, r.center + x - y, r.center + x + y, r.center - x + y};
}

void draw(const Chain& chain, const glm::dvec2& corner, std::string& svg) {
    SvgPanel panel(corner + glm::dvec2(0.5 * kChainPanel, kChainHeading + 0.5 * kChainPanel),
                   kChainPanel - 2.0 * kChainMargin, svg);
    for (const ChainLevel& level : chain.levels) {
        if (level.disc) {
            panel.include_disc(level.disc->center, level.disc->radius);
            continue;
        }
        for (const glm::dvec2& p : outline_of(*level.rectangle)) panel.include(p);
    }
    panel.path(chain.object, "fill='#dfe6ee' stroke='#555' stroke-width='2'");
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
        const ChainLevel& level = chain.levels[k];
        const std::string style = std::string("fill='none' stroke-width='1.5' stroke='") + color_of(k) + "'";
        if (level.disc)
            panel.disc(level.disc->center, level.disc->radius, style);
        else
            panel.path(outline_of(*level.rectangle), style);
    }
}

// Draws a line with the meaning of each colour.
void draw_legend(std::size_t levels, double y, std::string& svg) {
    svg_text(svg, kChainMargin, y, "", "filled: the object");
    for (std::size_t k = 0; k < levels; ++k)
        svg_text(svg, kChainMargin + 130.0 + 80.0 * static_cast<double>(k), y, color_of(k),
                 "level " + std::to_string(k + 1));
}

// A panel a chain, three in a row, and a line that says which level has which colour.
std::string hierarchy_svg(const std::vector<Chain>& chains) {
    const std::size_t rows = (chains.size() + 2) / 3;
    const double legend = static_cast<double>(rows) * (kChainPanel + kChainHeading);
    std::string svg = svg_head(3.0 * kChainPanel, legend + kChainHeading);
    for (std::size_t i = 0; i < chains.size(); ++i) {
        const glm::dvec2 corner(static_cast<double>(i % 3) * kChainPanel,
                                static_cast<double>(i / 3) * (kChainPanel + kChainHeading));
        svg_text(svg, corner.x + kChainMargin, corner.y + 16.0, "", chains[i].name);
        draw(chains[i], corner, svg);
    }
    std::size_t levels = 0;
    for (const Chain& chain : chains) levels = std::max(levels, chain.levels.size());
    draw_legend(levels, legend + 8.0, svg);
    return svg + "</svg>\n";
}

struct HierarchyOptions {
    std::string file, json, svg;
    std::uint64_t levels = 3, lines = 1'000'000, seed = 1;
};

struct Object {
    std::string name;
    std::vector<glm::dvec2> points;
};

// The paper's degenerate triangle, l = 1, and one that is none; or the polygons of a file.
Result<std::vector<Object>> objects_of(const HierarchyOptions& options) {
    if (options.file.empty())
        return std::vector<Object>{{"the paper's triangle, l = 1", {{-1.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}}},
                                   {"a triangle", {{-1.0, -0.4}, {1.0, -0.3}, {0.3, 0.5}}}};
    if (!is_polygon_file(options.file))
        return fail(ErrorCode::unsupported, kNoItem, options.file + ": takes polygons: .poly, .json, .geojson, .wad");
    const auto file = read_polygons(options.file, "");
    if (!file) return file.error();
    std::vector<Object> objects;
    for (const NamedPolygon& named : file->polygons) {
        if (objects.size() == 4) break;
        if (named.polygon.ring_count() == 0) continue;
        const auto ring = named.polygon.ring(0);
        objects.push_back({named.name, {ring.begin(), ring.end()}});
    }
    if (objects.empty()) return fail(ErrorCode::empty, kNoItem, options.file + ": no polygons");
    return objects;
}

enum class Kind { circles, rectangles, boxes };

// A circle first, then bounds of one kind, each the best given all before it.
Result<Chain> chain_of(const Object& object, Kind kind, std::uint64_t levels) {
    Chain chain;
    chain.object = object.points;
    const auto first = fit::minimal_disc(object.points);
    if (!first) return first.error();
    const auto hull = measure::convex_hull(object.points);
    if (!hull) return hull.error();
    chain.own = PlanarSupport::of_convex_polygon(*hull).integral();
    chain.levels.push_back({*first, std::nullopt, PlanarSupport(*first).integral(), 0.0});
    std::vector<PlanarSupport> figures = {PlanarSupport(*first)};
    for (std::uint64_t level = 1; level < levels; ++level) {
        const PlanarSupport ancestors = study::lower_envelope(figures);
        if (kind == Kind::circles) {
            const auto best = study::optimal_disc(object.points, ancestors);
            if (!best) return best.error();
            chain.levels.push_back({best->bound, std::nullopt, best->measure, best->measure - best->lower_bound});
            figures.emplace_back(best->bound);
        } else {
            const auto best = kind == Kind::rectangles ? study::optimal_rectangle(object.points, ancestors)
                                                       : study::optimal_box(object.points, ancestors);
            if (!best) return best.error();
            chain.levels.push_back({std::nullopt, best->bound, best->measure, best->measure - best->lower_bound});
            figures.emplace_back(best->bound);
        }
    }
    return chain;
}

double support_of(const ChainLevel& level, const glm::dvec2& n) {
    if (level.disc) return glm::dot(level.disc->center, n) + level.disc->radius;
    const Rectangle& r = *level.rectangle;
    return glm::dot(r.center, n) + r.half_extents.x * std::abs(glm::dot(r.axis, n)) +
           r.half_extents.y * std::abs(r.axis.x * n.y - r.axis.y * n.x);
}

// For every level the measure of the lines that hit it and all before it, by uniform lines of a circle around the
// first.
std::vector<VerifyRow> trials(const Chain& chain, const std::string& name, const HierarchyOptions& options) {
    const Disc& first = *chain.levels[0].disc;
    const double radius = 1.25 * first.radius;
    const sampling::UnitPoints points(options.seed);
    std::vector<std::uint64_t> hits(chain.levels.size(), 0);
    for (std::uint64_t i = 0; i < options.lines; ++i) {
        const auto u = points.at<2>(i);
        const glm::dvec2 n(std::cos(pi * u[0]), std::sin(pi * u[0]));
        const double at = glm::dot(first.center, n) + radius * (2.0 * u[1] - 1.0);
        for (std::size_t k = 0; k < chain.levels.size(); ++k) {
            if (!(-support_of(chain.levels[k], -n) <= at && at <= support_of(chain.levels[k], n))) break;
            ++hits[k];
        }
    }
    std::vector<VerifyRow> rows;
    std::vector<Disc> discs;
    const double all = 2.0 * pi * radius;
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
        const ChainLevel& level = chain.levels[k];
        if (level.disc) discs.push_back(*level.disc);
        const Share share = share_of(hits[k], options.lines);
        const bool circles = discs.size() == k + 1;
        // (9) where it applies: an implementation of its own.
        const double predicted = (circles ? study::measure_of_lines_by_tangents(discs) : level.measure) - chain.own;
        std::string claim =
            name + ", level " + std::to_string(k + 1) + (level.disc ? ": circle, radius " : ": rectangle, perimeter ");
        char size[32];
        std::snprintf(size, sizeof size, "%.5g", level.disc ? level.disc->radius : perimeter(*level.rectangle));
        rows.push_back(measured_row(claim + size, circles ? (k == 0 ? "paper (8)" : "paper (9)") : "theory.md (3)",
                                    predicted, all * share.value - chain.own,
                                    std::max(all * share.standard_error, 1e-12 * all)));
    }
    return rows;
}

Result<int> run_hierarchy(const HierarchyOptions& options) {
    const auto objects = objects_of(options);
    if (!objects) return objects.error();
    std::vector<VerifyRow> rows;
    std::vector<Chain> chains;
    Json list = Json::array();
    ProgressBar bar("hierarchy", 3 * objects->size());
    for (const Object& object : *objects)
        for (const auto& [name, kind] : {std::pair("circles", Kind::circles), std::pair("rectangles", Kind::rectangles),
                                         std::pair("boxes", Kind::boxes)}) {
            auto chain = chain_of(object, kind, options.levels);
            if (!chain) return fail(chain.error().code, chain.error().item, object.name + ": " + chain.error().message);
            chain->name = object.name + ": " + name;
            for (VerifyRow& row : trials(*chain, chain->name, options)) rows.push_back(std::move(row));
            Json levels = Json::array();
            for (const ChainLevel& level : chain->levels)
                levels.push_back(
                    {{"measure", level.measure},
                     {"improper", level.measure - chain->own},
                     {"gain", 1.0 - (level.measure - chain->own) / (chain->levels[0].measure - chain->own)},
                     {"gap", level.gap}});
            list.push_back({{"chain", chain->name}, {"levels", std::move(levels)}});
            chains.push_back(std::move(*chain));
            bar.set(chains.size());
        }
    if (options.json != "-" && options.svg != "-") {
        print_to(stdout, "Lines that hit all bounds down to a level and miss the object: improper tests.\n\n");
        print_text_to(stdout, table_of(rows));
        print_to(stdout, "\n%-44s %s\n", "chain",
                 "part of the first circle's improper tests that is saved, level by level");
        for (const Chain& chain : chains) {
            print_to(stdout, "%-44s", printable(chain.name).c_str());
            for (const ChainLevel& level : chain.levels)
                print_to(stdout, " %6.2f%%",
                         100.0 * (1.0 - (level.measure - chain.own) / (chain.levels[0].measure - chain.own)));
            print_to(stdout, "\n");
        }
    }
    if (!options.json.empty())
        if (const auto written = write_json(options.json, {{"chains", std::move(list)}, {"rows", json_of(rows)}});
            !written)
            return written.error();
    if (!options.svg.empty())
        if (const auto written = write_file(options.svg, hierarchy_svg(chains)); !written) return written.error();
    return std::all_of(rows.begin(), rows.end(), [](const VerifyRow& row) { return row.holds; }) ? kSuccess
                                                                                                 : kCheckFailed;
}

}  // namespace

void add_hierarchy_command(CommandLine& line) {
    auto options = std::make_shared<HierarchyOptions>();
    Command command = kHierarchy.add_to(line);
    command.footer(
        "A bound is tested only by lines that hit all its ancestors. The best bound under them is not the tightest: in "
        "the\n"
        "paper's example (a flat triangle, in fact a segment, in a circle) the best second circle is larger and saves\n"
        "40 % of the improper tests. Each object gets three chains: circles; a circle, then rectangles; a circle, then "
        "boxes\n"
        "with sides along the axes. Results are predicted by (8), (9) or (3) of docs/theory.md and measured by random "
        "lines.\n"
        "\n"
        "Examples:\n"
        "  crofton study hierarchy --svg chains.svg\n"
        "  crofton study hierarchy counties.poly --levels 4\n");
    command.option("file", options->file, "Polygons, of which the first four are used; the paper's example by default");
    command.option("--levels", options->levels, "Number of bounds in a chain").whole_between(1, 8).show_default();
    command.option("--lines", options->lines, "Number of random lines per chain")
        .whole_between(1000, std::uint64_t{1} << 36)
        .show_default();
    command.option("--seed", options->seed, "The same seed gives the same lines").show_default();
    command.option("--json", options->json, "Write the chains as JSON; - for stdout").writable_file_or_stdout();
    command.option("--svg", options->svg, "Draw the chains; - for stdout").writable_file_or_stdout();
    command.action([options] {
        const auto status = run_hierarchy(*options);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
