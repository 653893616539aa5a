// SPDX-License-Identifier: MIT
// `crofton triangulate`: polygons with holes, or the planar patches of meshes, to triangles.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdio>
#include <limits>
#include <set>
#include <span>
#include <string>

#include "assets/file.hpp"
#include "assets/print.hpp"
#include "assets/scene_source.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "json/json.hpp"
#include "polygon_files.hpp"
#include "progress_bar.hpp"
#include "read_options.hpp"
#include "report.hpp"
#include "triangulate_meshes.hpp"

namespace crofton::cli {
namespace {

using triangulate::Method;
using triangulate::Triangulation;
using Clock = std::chrono::steady_clock;

constexpr double kSize = 1600.0, kMargin = 0.04;

struct Frame {
    glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    glm::dvec2 corner{0.0};
    double cell = kSize;

    void include(const Polygon& polygon) {
        for (const auto& p : polygon.points) {
            low = glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y));
            high = glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y));
        }
    }
    // y upwards; halves first, so that the largest doubles do not overflow.
    [[nodiscard]] glm::dvec2 place(const glm::dvec2& p) const {
        const double extent = std::max({high.x / 2 - low.x / 2, high.y / 2 - low.y / 2, 1e-300});
        const double scale = cell * (1.0 - 2.0 * kMargin);
        const glm::dvec2 unit((p.x / 2 - low.x / 2) / extent, (high.y / 2 - p.y / 2) / extent);
        const glm::dvec2 rest((1.0 - (high.x / 2 - low.x / 2) / extent) / 2,
                              (1.0 - (high.y / 2 - low.y / 2) / extent) / 2);
        return corner + cell * kMargin + scale * (unit + rest);
    }
};

void move_to(std::string& path, const glm::dvec2& p, char command) {
    char text[64];
    std::snprintf(text, sizeof text, "%c%.2f %.2f", command, p.x, p.y);
    path += text;
}

void draw(const Polygon& polygon, const triangulate::Triangulation& result, const Frame& frame, double width,
          std::string& svg) {
    std::string rings, diagonals;
    std::set<std::pair<std::uint32_t, std::uint32_t>> boundary, drawn;
    for (std::size_t r = 0; r < polygon.ring_count(); ++r) {
        const auto ring = polygon.ring(r);
        const std::uint32_t begin = r == 0 ? 0 : polygon.ring_ends[r - 1];
        for (std::uint32_t i = 0; i < ring.size(); ++i) {
            move_to(rings, frame.place(ring[i]), i == 0 ? 'M' : 'L');
            const std::uint32_t a = begin + i, b = i + 1 == ring.size() ? begin : a + 1;
            boundary.insert({std::min(a, b), std::max(a, b)});
        }
        if (!ring.empty()) rings += 'Z';
    }
    for (const auto& t : result.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            const std::pair side(std::min(a, b), std::max(a, b));
            if (boundary.count(side) || !drawn.insert(side).second) continue;
            move_to(diagonals, frame.place(polygon.points[a]), 'M');
            move_to(diagonals, frame.place(polygon.points[b]), 'L');
        }
    }
    char style[128];
    std::snprintf(style, sizeof style, "<path fill='#e8eef7' stroke='#1b2a41' stroke-width='%.3g' d='", 1.5 * width);
    svg += style + rings + "'/>\n";
    std::snprintf(style, sizeof style, "<path fill='none' stroke='#c8553d' stroke-width='%.3g' d='", 0.8 * width);
    if (!diagonals.empty()) svg += style + diagonals + "'/>\n";
}

// Filled polygons with their diagonals thin and their boundary thick; in one frame if they share a plane, else each in
// a cell of a grid. At most `most` polygons are drawn, in the order given. results[i] is for polygons[i]; empty ones
// are left out.
std::string draw_svg(std::span<const NamedPolygon> polygons, std::span<const triangulate::Triangulation> results,
                     bool one_plane, std::size_t most = 400) {
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < polygons.size() && shown.size() < most; ++i) {
        if (!results[i].triangles.empty()) shown.push_back(i);
    }
    const auto columns = one_plane ? 1.0 : std::max(1.0, std::ceil(std::sqrt(static_cast<double>(shown.size()))));
    const double width = std::clamp(1.6 / columns, 0.25, 1.2);
    char head[512];
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' width='%g' height='%g'>\n"
                  "<rect width='%g' height='%g' fill='white'/>\n<g stroke-linejoin='round' fill-rule='evenodd'>\n",
                  kSize, kSize, kSize, kSize, kSize, kSize);
    std::string svg = head;
    Frame frame;
    if (one_plane) {
        for (const std::size_t i : shown) frame.include(polygons[i].polygon);
    }
    for (std::size_t n = 0; n < shown.size(); ++n) {
        const auto& polygon = polygons[shown[n]].polygon;
        if (!one_plane) {
            frame = Frame{};
            frame.include(polygon);
            frame.cell = kSize / columns;
            frame.corner = frame.cell * glm::dvec2(std::fmod(static_cast<double>(n), columns),
                                                   std::floor(static_cast<double>(n) / columns));
        }
        draw(polygon, results[shown[n]], frame, width, svg);
    }
    return svg + "</g>\n</svg>\n";
}

struct TriangulateOptions {
    std::string file, method = "minimum-weight", map, json, svg, out;
    double seconds = std::numeric_limits<double>::infinity();
    double work = 0.0;       // in millions of steps, where it is given
    double memory = 2048.0;  // MiB
    double tolerance = -1.0, attribute_tolerance = 1e-4;
    bool has_tolerance = false, is_mesh_option_given = false, is_work_given = false;
    ReadOptions read;
};

Result<Method> method_from(const std::string& name) {
    if (name == "ear") return Method::ear;
    if (name == "delaunay") return Method::delaunay;
    if (name == "minimum-weight") return Method::minimum_weight;
    return fail(ErrorCode::invalid_argument, kNoItem,
                "--method must be ear, delaunay or minimum-weight, not '" + name + "'");
}

triangulate::TriangulateOptions limits_of(const TriangulateOptions& options, Method method) {
    triangulate::TriangulateOptions limits{.method = method, .seconds = options.seconds, .should_stop = should_stop};
    constexpr double kMost = 1e12;
    limits.bytes = static_cast<std::size_t>(std::min(options.memory, kMost) * 0x1p20);
    if (options.is_work_given)
        limits.work = options.work < kMost ? static_cast<std::uint64_t>(1e6 * options.work) : limits.kUnlimitedWork;
    return limits;
}

Json to_json(const NamedPolygon& named, const Triangulation& result, double microseconds) {
    Json entry{{"name", named.name},
               {"vertices", named.polygon.points.size()},
               {"holes", named.polygon.ring_count() - 1},
               {"triangle_count", result.triangles.size()},
               {"weight", result.weight},
               {"optimal", result.optimal},
               {"gap", std::isfinite(result.gap) ? Json(result.gap) : Json(nullptr)},
               {"microseconds", microseconds}};
    entry["triangles"] = result.triangles;
    return entry;
}

struct Totals {
    std::size_t polygons = 0, refused = 0, vertices = 0, holes = 0, triangles = 0, optimal = 0, out_of_memory = 0;
    double weight = 0.0, microseconds = 0.0, largest_gap = 0.0;

    void add(const Polygon& polygon, const Triangulation& result, double time) {
        ++polygons;
        vertices += polygon.points.size();
        holes += polygon.ring_count() - 1;
        triangles += result.triangles.size();
        optimal += result.optimal;
        largest_gap = std::max(largest_gap, result.gap);
        weight += result.weight;
        microseconds += time;
    }
};

void print_table(const TriangulateOptions& options, const Totals& t) {
    print_to(stdout, "%-16s %10s %10s %8s %10s %16s %10s %12s\n", "method", "polygons", "vertices", "holes",
             "triangles", "weight", "optimal", "us/vertex");
    print_to(stdout, "%-16s %10zu %10zu %8zu %10zu %16.8g %10zu %12.3f\n", options.method.c_str(), t.polygons,
             t.vertices, t.holes, t.triangles, t.weight, t.optimal,
             t.vertices ? t.microseconds / static_cast<double>(t.vertices) : 0.0);
    if (t.optimal < t.polygons && std::isfinite(t.largest_gap)) {
        const std::size_t open = t.polygons - t.optimal;
        print_to(stdout, "%zu %s not proven minimal, but at most %.2g times as heavy as the minimum\n", open,
                 open == 1 ? "polygon is" : "polygons are", 1.0 + t.largest_gap);
    }
    if (t.out_of_memory)
        print_to(stdout, "%zu %s the limit of memory before that of time: --memory-limit %.0f is more\n",
                 t.out_of_memory, t.out_of_memory == 1 ? "polygon reached" : "polygons reached",
                 4.0 * std::max(options.memory, 1.0));
    else if (t.optimal < t.polygons && options.method == "minimum-weight" && !options.is_work_given &&
             !std::isfinite(options.seconds))
        print_to(stdout, "Larger limits may prove more: --memory-limit, and --work-limit or --time-limit\n");
    if (t.refused) print_to(stdout, "%zu %s refused\n", t.refused, t.refused == 1 ? "polygon was" : "polygons were");
}

Result<int> run_polygons(const TriangulateOptions& options, Method method) {
    const auto file = read_polygons(options.file, options.map, options.read.limits);
    if (!file) return file.error();
    print_warnings(file->warnings);
    if (auto whole = refuse_if_strict(options.file, file->warnings, options.read); !whole) return whole.error();
    const auto& polygons = file->polygons;
    std::vector<Triangulation> results(polygons.size());
    Json entries = Json::array();
    Totals totals;
    triangulate::Triangulator triangulator;
    {
        ProgressBar bar("triangulate", polygons.size());
        for (std::size_t i = 0; i < polygons.size() && !interrupted(); ++i) {
            const auto start = Clock::now();
            const auto done = triangulator.triangulate(polygons[i].polygon, limits_of(options, method), results[i]);
            const double time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
            if (done) {
                totals.add(polygons[i].polygon, results[i], time);
                // With a limit of time alone, only that of memory can have ended the search before.
                totals.out_of_memory += method == Method::minimum_weight && !results[i].optimal &&
                                        !options.is_work_given && 1e-6 * time < options.seconds &&
                                        std::isfinite(options.seconds);
                entries.push_back(to_json(polygons[i], results[i], time));
            } else if (done.error().code == ErrorCode::cancelled) {
                break;
            } else {
                ++totals.refused;
                const bool named = polygons[i].name != assets::file_name(options.file);
                print_to(stderr, "crofton: %s: %s%s%s\n", printable(options.file).c_str(),
                         named ? printable(polygons[i].name).c_str() : "", named ? ": " : "",
                         printable(done.error().message).c_str());
                entries.push_back(
                    {{"name", polygons[i].name},
                     {"error", {{"code", to_string(done.error().code)}, {"message", done.error().message}}}});
            }
            bar.set(i + 1);
        }
    }
    finish_what_there_is();
    if (!options.svg.empty()) {
        if (auto written = write_file(options.svg, draw_svg(polygons, results, file->one_plane)); !written)
            return written.error();
    }
    if (!options.json.empty()) {
        const Json document{{"file", assets::file_name(options.file)},
                            {"method", options.method},
                            {"polygons", std::move(entries)},
                            {"summary",
                             {{"polygons", totals.polygons},
                              {"refused", totals.refused},
                              {"vertices", totals.vertices},
                              {"holes", totals.holes},
                              {"triangles", totals.triangles},
                              {"optimal", totals.optimal},
                              {"weight", totals.weight},
                              {"microseconds", totals.microseconds}}}};
        if (auto written = write_json(options.json, document); !written) return written.error();
    }
    if (options.json != "-" && options.svg != "-") print_table(options, totals);
    if (totals.polygons + totals.refused < polygons.size()) {
        print_to(stderr, "crofton: interrupted after %zu of %zu polygons, which are written\n",
                 totals.polygons + totals.refused, polygons.size());
        return kInterrupted;
    }
    return totals.refused ? kBadInput : kSuccess;
}

Result<int> run_triangulate(const TriangulateOptions& options) {
    const auto method = method_from(options.method);
    if (!method) return method.error();
    if (!(options.seconds >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "--time-limit must not be negative");
    if (!(options.attribute_tolerance >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "--attribute-tolerance must not be negative");
    if (options.has_tolerance && !(options.tolerance >= 0.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "--tolerance must not be negative");
    const std::string kind = assets::extension(options.file);
    const bool mesh = kind == "obj" || kind == "glb" || kind == "gltf" || assets::is_made(options.file);
    if (auto file = assets::refuse_regions(options.file); !file) return file.error();
    if (kind == "crofton")
        return fail(ErrorCode::unsupported, kNoItem,
                    options.file + ": holds triangulations that are baked; name the file that it was baked from");
    if (!mesh && !is_polygon_file(options.file)) {
        return fail(ErrorCode::unsupported, kNoItem,
                    options.file + ": unknown kind of file; known are .poly, .json, .geojson, .wad, .obj, .glb, .gltf");
    }
    if (!options.map.empty() && kind != "wad")
        return fail(ErrorCode::invalid_argument, kNoItem, "--map is for .wad files");
    catch_interrupts();
    if (is_polygon_file(options.file)) {
        if (!options.out.empty())
            return fail(ErrorCode::invalid_argument, kNoItem, "--out is for meshes: .obj, .glb, .gltf");
        if (options.is_mesh_option_given)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "--tolerance and --attribute-tolerance are for meshes: .obj, .glb, .gltf");
        return run_polygons(options, *method);
    }
    if (!options.svg.empty())
        return fail(ErrorCode::invalid_argument, kNoItem, "--svg is for polygons: .poly, .json, .geojson, .wad");
    return run_meshes({options.file, options.method, limits_of(options, *method), options.json, options.out,
                       options.tolerance, options.attribute_tolerance, options.read});
}

constexpr const char* kTriangulateExamples =
    "Polygons: .poly, .json (earcut's rings or GeoJSON), .geojson, .wad. Meshes, whose planar patches are "
    "triangulated\n"
    "again: .obj, .glb, .gltf. Indices count a polygon's points ring by ring.\n"
    "A polygon that is refused is named on stderr, has an `error` in the JSON, and makes the exit status 2; the "
    "others\n"
    "are triangulated all the same. The same holds for the parts of a mesh.\n"
    "--out keeps everything of a glTF asset except indices: materials, images, skins, animations, extensions. Images "
    "and\n"
    "buffers in other files are embedded. A patch ends at seams, and where texture coordinates, normals or colours "
    "bend.\n"
    "\n"
    "Examples:\n"
    "  crofton triangulate county.geojson --svg county.svg          # exact minimum weight, and a picture\n"
    "  crofton triangulate level.wad --map MAP01 --method delaunay  # every sector of one level\n"
    "  crofton triangulate house.glb --out lighter.glb              # the same house with shorter inner edges\n"
    "  crofton triangulate town --out town.glb                      # the built-in town as a file\n";

}  // namespace

void add_triangulate_command(CommandLine& line) {
    auto options = std::make_shared<TriangulateOptions>();
    Command command = line.command("triangulate", "Triangulate polygons with holes, or the planar patches of meshes");
    command.footer(kTriangulateExamples);
    command.option("file", options->file, "File to triangulate").required();
    command.option("--method", options->method, "ear | delaunay | minimum-weight").show_default();
    command.option("--map", options->map, "Level of a .wad file; all by default");
    const Option work = command
                            .option("--work-limit", options->work,
                                    "Millions of steps (some 10 ms each) per polygon; then the best so far is "
                                    "returned, with its proved gap, the same on every machine. By default 1000, or "
                                    "0.05 for each point, at most 10000; no limit if --time-limit is given")
                            .not_negative();
    command
        .option("--time-limit,--seconds", options->seconds,
                "Seconds of search per polygon; the result then depends on the machine. Before and after, up to 60 "
                "microseconds per point are taken to find and improve a triangulation")
        .show_default();
    command
        .option("--memory-limit", options->memory,
                "MiB for the candidates of a polygon's search, which ends when they are used up")
        .show_default()
        .not_negative();
    const Option tolerance =
        command.option("--tolerance", options->tolerance,
                       "Largest distance from a plane that counts as in it; a millionth of the mesh's size by default");
    const Option attribute_tolerance =
        command
            .option("--attribute-tolerance", options->attribute_tolerance,
                    "Largest deviation of texture coordinates, normals, colours, ... from one linear function of the "
                    "position within a patch; inf: no limit")
            .show_default();
    command.option("--json", options->json, "Write results as JSON; - for stdout").writable_file_or_stdout();
    command.option("--svg", options->svg, "Draw at most 400 of the polygons as SVG; - for stdout")
        .writable_file_or_stdout();
    command.option("--out", options->out, "Write the asset with its new triangles as .glb; - for stdout")
        .writable_file_or_stdout();
    add_read_options(command, options->read);
    command.action([=] {
        options->has_tolerance = tolerance.given();
        options->is_mesh_option_given = tolerance.given() || attribute_tolerance.given();
        options->is_work_given = work.given();
        const auto status = run_triangulate(*options);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
