// SPDX-License-Identifier: MIT
// crofton study views: boxes for the directions in which a recorded camera path looks, and what they save.
#include <algorithm>
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/query_distribution.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <memory>

#include "commands.hpp"
#include "json/json.hpp"
#include "mesh_file.hpp"
#include "pipeline/camera_path.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

constexpr std::uint64_t kPlaces = 200'000;

// Uniform points of the faces of a path's view volumes.
class Faces {
  public:
    explicit Faces(const std::vector<Camera>& cameras) {
        constexpr unsigned quads[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
        for (const Camera& camera : cameras) {
            const auto frustum = frustum_of(camera);
            if (!frustum) continue;
            const auto corners = frustum_corners(*frustum);
            if (!corners) continue;
            for (const auto& q : quads)
                for (const auto& [b, c] : {std::pair(q[1], q[2]), std::pair(q[2], q[3])}) {
                    const glm::dvec3 p = frustum->origin + (*corners)[q[0]];
                    const Triangle t{p, (*corners)[b] - (*corners)[q[0]], (*corners)[c] - (*corners)[q[0]],
                                     frusta_.size()};
                    triangles_.push_back(t);
                    area_ += 0.5 * glm::length(glm::cross(t.x, t.y));
                    cumulative_.push_back(area_);
                }
            frusta_.push_back(*frustum);
        }
    }
    struct Place {
        glm::dvec3 point;
        const Frustum* frustum;
    };
    [[nodiscard]] Place at(double which, double s, double t) const {
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), which * area_);
        const auto i = std::min(static_cast<std::size_t>(found - cumulative_.begin()), triangles_.size() - 1);
        if (s + t > 1.0) s = 1.0 - s, t = 1.0 - t;
        return {triangles_[i].corner + s * triangles_[i].x + t * triangles_[i].y, &frusta_[triangles_[i].frustum]};
    }

  private:
    struct Triangle {
        glm::dvec3 corner, x, y;
        std::size_t frustum;
    };
    std::vector<Frustum> frusta_;
    std::vector<Triangle> triangles_;
    std::vector<double> cumulative_;
    double area_ = 0.0;
};

// Classifies the hull of these corners, which may be many or flat, by the view's planes. Works in double: a plane
// neither rejects nor contains a corner within 1e-9 of it, relative to the distance from the view's origin.
cull::Verdict by_planes(const Frustum& frustum, std::span<const glm::dvec3> corners) {
    bool inside = true;
    for (const Plane& plane : frustum.view()) {
        bool all_out = true;
        for (const glm::dvec3& p : corners) {
            const glm::dvec3 d = p - frustum.origin;
            const double value = glm::dot(plane.normal, d) + plane.offset;
            const double margin = 1e-9 * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z) + std::abs(plane.offset));
            all_out = all_out && value < -margin;
            inside = inside && value > margin;
        }
        if (all_out) return cull::Verdict::outside;
    }
    return inside ? cull::Verdict::inside : cull::Verdict::straddling;
}

struct ViewsRequest {
    std::string path;  // as pipeline::load_camera_path takes it
    std::vector<std::string> files;
    std::string json_path;
    ReadOptions read;
};

struct Counted {
    std::uint64_t plain = 0, directed = 0;
};

// Where the bound says less than the mesh's hull would.
Counted count(const std::vector<glm::dvec3>& hull, const study::DirectedFit& directed, const Obb& plain,
              const Faces& faces) {
    double radius = 0.0;
    for (const Obb* box : {&directed.box, &plain})
        for (const glm::dvec3& c : corners(*box)) radius = std::max(radius, glm::distance(c, directed.box.center));
    const sampling::UnitPoints points(29);
    Counted counted;
    std::vector<glm::dvec3> moved(hull.size());
    for (std::uint64_t i = 0; i < kPlaces; ++i) {
        const auto u = points.at<6>(i);
        const Faces::Place place = faces.at(u[0], u[1], u[2]);
        const glm::dvec3 shift = place.point + radius * sampling::ball_point({u[3], u[4], u[5]}) - directed.box.center;
        for (std::size_t k = 0; k < hull.size(); ++k) moved[k] = hull[k] + shift;
        const cull::Verdict truth = by_planes(*place.frustum, moved);
        const auto misled = [&](Obb box) {
            box.center += shift;
            return cull::classify(*place.frustum, box, cull::CullMode::conservative) != truth;
        };
        counted.plain += misled(plain);
        counted.directed += misled(directed.box);
    }
    return counted;
}

// For each mesh as it stands in its file: the box that uniform directions ask for beside the one that the path's do;
// the ratio of their measures, by the formula for boxes; and of their improper tests, counted: the mesh is put at
// random near the faces of the path's view volumes.
Result<int> run_views(const ViewsRequest& run) {
    const auto path = pipeline::load_camera_path(run.path);
    if (!path) return tl::unexpected(path.error());
    const auto distribution = study::QueryDistribution::of_views(path->cameras);
    if (!distribution)
        return fail(distribution.error().code, distribution.error().item,
                    run.path + ": " + distribution.error().message);
    const Faces faces(path->cameras);
    Json list = Json::array();
    const glm::dvec3 mean(distribution->mean_cosine({1, 0, 0}), distribution->mean_cosine({0, 1, 0}),
                          distribution->mean_cosine({0, 0, 1}));
    if (run.json_path != "-")
        std::printf(
            "%s: %zu views; mean |cosine| of their faces' normals with x %.4f, y %.4f, z %.4f (uniform: 0.5)\n"
            "%-24s %14s %14s %11s %11s %11s %11s\n",
            run.path.c_str(), path->cameras.size(), mean.x, mean.y, mean.z, "mesh", "plain", "directed", "predicted",
            "improper", "improper", "saved");
    for (const std::string& file : run.files) {
        const auto points = load_points(file, run.read);
        if (!points) return tl::unexpected(points.error());
        const auto hull = convex_hull(std::span<const glm::dvec3>(*points));
        const auto directed = study::fit_box_for(*points, *distribution, study::QueryKind::planes);
        if (!hull || !directed) {
            const Error& error = hull ? directed.error() : hull.error();
            return fail(error.code, error.item, file + ": " + error.message);
        }
        std::vector<glm::dvec3> corners;
        for (const std::uint32_t v : hull->vertices) corners.push_back((*points)[v]);
        const Counted counted = count(corners, *directed, directed->plain, faces);
        const double saved =
            counted.plain == 0 ? 0.0 : 1.0 - static_cast<double>(counted.directed) / static_cast<double>(counted.plain);
        const double room = directed->plain_value - directed->lower_bound;
        const double predicted = room > 0.0 ? (directed->plain_value - directed->value) / room : 0.0;
        if (run.json_path != "-")
            std::printf("%-24s %14.7g %14.7g %10.2f%% %11llu %11llu %10.2f%%\n",
                        file.substr(file.find_last_of('/') + 1).c_str(), directed->plain_value, directed->value,
                        100.0 * predicted, static_cast<unsigned long long>(counted.plain),
                        static_cast<unsigned long long>(counted.directed), 100.0 * saved);
        list.push_back({{"file", file},
                        {"plain_measure", directed->plain_value},
                        {"directed_measure", directed->value},
                        {"hull_measure", directed->lower_bound},
                        {"predicted_saving", predicted},
                        {"plain_improper", counted.plain},
                        {"directed_improper", counted.directed},
                        {"saving", saved}});
    }
    if (!run.json_path.empty())
        if (const auto written = write_json(run.json_path, {{"views", path->cameras.size()},
                                                            {"mean_cosines", {mean.x, mean.y, mean.z}},
                                                            {"meshes", std::move(list)}});
            !written)
            return tl::unexpected(written.error());
    return kSuccess;
}

}  // namespace

void add_views_command(CommandLine& line) {
    auto request = std::make_shared<ViewsRequest>();
    Command command = kViews.add_to(line);
    command.option("path", request->path, "A recorded camera path, the JSON of 'crofton frames'").required();
    command.option("files", request->files, "Meshes").required();
    command.option("--json", request->json_path, "Write the table as JSON; - for stdout, instead of the text")
        .writable_file_or_stdout();
    command.footer(
        "Fits boxes for the directions of the path, and compares their false positives with those of boxes for uniform "
        "directions.\n"
        "\n"
        "Example:\n"
        "  crofton study views flight.json bunny.obj");
    add_read_options(command, request->read);
    command.action([request] {
        const auto status = run_views(*request);
        return status ? *status : report_error("", status.error());
    });
}

}  // namespace crofton::cli
