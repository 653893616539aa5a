// SPDX-License-Identifier: MIT
// `crofton study measure`: Crofton's formula on one's own mesh. What random lines count, beside what the mesh's
// geometry says.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/convex_body.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>

#include "assets/print.hpp"
#include "commands.hpp"
#include "json/json.hpp"
#include "mesh_file.hpp"
#include "report.hpp"
#include "verify/bodies.hpp"
#include "verify/rows.hpp"

namespace crofton::cli {
namespace {

struct MeasureOptions {
    std::string file, json;
    std::uint64_t lines = 100'000, seed = 1;
    ReadOptions read;
};

// A convex solid as the half-spaces { x : dot(normal, x) ≤ offset } of its faces.
class HalfSpaces {
  public:
    HalfSpaces(std::span<const glm::dvec3> points, const ConvexHull& hull) {
        for (std::size_t i = 0; i < hull.triangles.size(); i += 3) {
            const glm::dvec3 a = points[hull.triangles[i]], b = points[hull.triangles[i + 1]],
                             c = points[hull.triangles[i + 2]];
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            if (glm::dot(normal, normal) > 0.0) faces_.push_back({normal, glm::dot(normal, a)});
        }
    }

    // The length of the line's part inside; 0 where it misses.
    [[nodiscard]] double chord(const Line& line) const {
        double enter = -HUGE_VAL, leave = HUGE_VAL;
        for (const Face& face : faces_) {
            const double speed = glm::dot(face.normal, line.direction);
            const double room = face.offset - glm::dot(face.normal, line.point);
            if (speed > 0.0)
                leave = std::min(leave, room / speed);
            else if (speed < 0.0)
                enter = std::max(enter, room / speed);
            else if (room < 0.0)
                return 0.0;
        }
        return std::max(0.0, leave - enter);
    }

  private:
    struct Face {
        glm::dvec3 normal;
        double offset;
    };
    std::vector<Face> faces_;
};

double area_of(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
            c(mesh.positions[mesh.indices[i + 2]]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

VerifyRow row(const char* claim, const char* formula, double exact, double factor, const Mean& mean) {
    return measured_row(claim, formula, exact, factor * mean.value(), factor * mean.standard_error());
}

// The hull's F and V by the lines that the mesh's own area was counted with, and M by as many breadths.
void hull_rows(std::span<const glm::dvec3> points, const ConvexHull& hull, const measure::IntrinsicVolumes& exact,
               const lines::LineSource& source, const MeasureOptions& options, std::vector<VerifyRow>& rows) {
    const std::uint64_t blocks = options.lines / lines::LineSource::kBlock + 1;
    const double sphere_area = source.surface_area();
    if (hull.rank == 3) {
        const HalfSpaces solid(points, hull);
        Mean hits, chords;
        Vector<Line> lines;
        for (std::uint64_t block = 0; block < blocks; ++block) {
            source.draw(block, lines);
            for (const Line& line : lines) {
                const double chord = solid.chord(line);
                hits.add(chord > 0.0 ? 1.0 : 0.0);
                chords.add(chord);
            }
        }
        rows.push_back(row("its hull's surface area F", "share of lines that hit · F0", exact.area, sphere_area, hits));
        rows.push_back(
            row("its hull's volume V", "mean chord, 0 for a miss · F0 / 4", exact.volume, 0.25 * sphere_area, chords));
    }
    study::ConvexBody body;
    for (const std::uint32_t v : hull.vertices) body.points.push_back(points[v]);
    Mean breadths;
    const sampling::UnitPoints numbers(options.seed);
    for (std::uint64_t i = 0; i < blocks * lines::LineSource::kBlock; ++i)
        breadths.add(study::breadth(body, sampling::direction(numbers.at<2>(i))));
    rows.push_back(row("its hull's integral of mean curvature M", "mean breadth · 2 pi", exact.mean_curvature,
                       2.0 * std::numbers::pi, breadths));
}

Result<void> run_measure(const MeasureOptions& options) {
    const auto loaded = load_mesh(options.file, options.read);
    if (!loaded) return loaded.error();
    const TriangleMesh* const mesh = &loaded->mesh;  // measures are the same anywhere
    const std::vector<glm::dvec3> points(mesh->positions.begin(), mesh->positions.end());
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    const auto exact = measure::intrinsic_volumes_of_hull(points);
    if (!exact) return exact.error();
    const auto tracer = lines::LineTracer::build(*mesh);
    if (!tracer) return tracer.error();
    if (hull->rank < 2)
        return fail(ErrorCode::empty, kNoItem, options.file + ": all vertices lie on one line, which no line hits");

    const lines::LineSource source(tracer->bounds(), lines::LineMethod::disc, options.seed);
    const auto seen = lines::visibility_complexity(*tracer, source, options.lines / lines::LineSource::kBlock + 1);
    std::vector<VerifyRow> rows;
    const double error = seen.deviation / std::sqrt(static_cast<double>(seen.lines));
    rows.push_back(measured_row("the triangles' area S", "crossings a line · F0 / 2", area_of(*mesh),
                                0.5 * source.surface_area() * seen.mean_crossings,
                                0.5 * source.surface_area() * error));
    hull_rows(points, *hull, *exact, source, options, rows);
    if (!options.json.empty())
        return write_json(options.json, {{"file", options.file},
                                         {"triangles", mesh->triangle_count()},
                                         {"lines", seen.lines},
                                         {"F0", source.surface_area()},
                                         {"mean_crossings", seen.mean_crossings},
                                         {"rows", json_of(rows)}});
    print_to(stdout,
             "%s: %zu triangles; %llu uniform lines through a sphere around it, whose surface area is F0 = %.6g\n\n",
             printable(options.file).c_str(), mesh->triangle_count(), static_cast<unsigned long long>(seen.lines),
             source.surface_area());
    print_text_to(stdout, table_of(rows));
    return {};
}

}  // namespace

void add_measure_command(CommandLine& line) {
    auto options = std::make_shared<MeasureOptions>();
    Command command = kMeasure.add_to(line);
    command.footer(std::string("Columns: the measure; the count that estimates it; the value predicted from the "
                               "triangles; the estimate; its\n"
                               "standard error; the difference in standard errors (z). docs/theory.md derives the "
                               "formulas. Lengths are in the\n"
                               "file's unit.\n"
                               "\n"
                               "Examples:\n"
                               "  crofton study measure bunny.obj\n"
                               "  crofton study measure room --lines 1000000\n"
                               "  crofton study measure level.wad --json -\n\n") +
                   kSceneFormats);
    command
        .option("file", options->file,
                "town, room, office, valley, hall, a folder of city parts, or a .glb, .gltf, .obj, .wad or .crofton "
                "file; of a .wad the first level")
        .required();
    command.option("--lines", options->lines, "Number of lines, rounded up to blocks of 1024")
        .whole_between(1000, std::uint64_t{1} << 40)
        .show_default();
    command.option("--seed", options->seed, "The same seed gives the same lines").show_default();
    command.option("--json", options->json, "Write the table as JSON; - for stdout").writable_file_or_stdout();
    add_read_options(command, options->read);
    command.action([options] {
        const auto done = run_measure(*options);
        return done ? kSuccess : report_error("", done.error());
    });
}

}  // namespace crofton::cli
