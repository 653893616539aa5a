// SPDX-License-Identifier: MIT
#include "pvs_views.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/core/stop_signal.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "camera_path.hpp"
#include "free_space.hpp"
#include "pipeline.hpp"

namespace crofton::pipeline {
namespace {

constexpr std::uint32_t kTile = 4;  // rays of a tile go through the tree together
constexpr std::uint32_t kTries = 1000;
constexpr double kFarthestNear = 0.1, kNearestNear = 1e-4;

// Data shared by all views.
struct Looked {
    const pvs::BakeGeometry& geometry;
    const pvs::Pvs& sets;
    const PvsViewOptions& options;
    mesh::MeshTree tree;
    std::optional<Pipeline> occluding;
    Vector<std::uint32_t> triangles_of;  // by object
    double near = 0.0;
    double reach = 0.0;  // of the near plane: its farthest point in a picture
    Vector<glm::dvec3> places;
    double spacing = 0.0;  // of them, along x and z
};

// Ways to choose what is drawn: the sets' modes, occlusion at run time, both.
enum Way : std::size_t { kConservative, kStatistical, kOcclusion, kConservativeToo, kStatisticalToo, kWays };

// Counts of one view.
struct Counts {
    std::uint64_t frustum = 0, owners = 0;                  // triangles
    std::array<std::uint64_t, kWays> wrong{}, triangles{};  // pixels; triangles
};

// Whether a camera at `eye` could turn all around, and its near plane would cut nothing.
bool has_room(const Looked& all, const glm::dvec3& eye) {
    const auto ball = convex::Shape::sphere(all.reach);
    const auto mesh = convex::Shape::mesh(all.tree);
    return ball && mesh && !convex::intersects({*mesh, {}}, {*ball, {glm::dmat3(1.0), eye - all.geometry.origin}});
}

// A place, moved sideways by up to half the distance of two, if nothing lies between. Cells and places are both
// regular, so places alone would always be at the same spots of cells.
std::optional<Camera> random_view(const Looked& all, std::uint32_t number, crofton::detail::StopSignal& stop) {
    sampling::Random random(all.options.seed, number);
    for (std::uint32_t i = 0; i < kTries && !stop.is_raised(0.0); ++i) {
        const glm::dvec3 place = all.places[random.bits() % all.places.size()];
        // One after the other: in which order arguments are computed is left to the compiler.
        const double z = random.uniform(-0.5, 0.5), x = random.uniform(-0.5, 0.5);
        const glm::dvec3 move = all.spacing * glm::dvec3(x, 0.0, z);
        const glm::dvec2 ahead = sampling::circle_point(random.uniform());
        const glm::dvec3 eye = place + move;
        const Aabb& cells = all.sets.cells().bounds();
        if (glm::any(glm::lessThan(eye, cells.min)) || glm::any(glm::greaterThan(eye, cells.max))) continue;
        if (mesh::hits_any({place - all.geometry.origin, move, 1.0}, all.tree) || !has_room(all, eye)) continue;
        Camera camera;
        camera.position = eye;
        camera.forward = {ahead.x, 0.0, ahead.y};
        camera.aspect = static_cast<double>(all.options.width) / static_cast<double>(all.options.height);
        camera.near_distance = std::max(all.near, kNearestNear);
        return camera;
    }
    return std::nullopt;
}

// Where one could stand; else the middles of the cells that eyes may be in.
void find_places(const std::optional<FreeSpace>& space, Looked& all) {
    if (space) {
        all.places.assign(space->places().begin(), space->places().end());
        all.spacing = space->spacing();
        return;
    }
    for (std::uint32_t c = 0; c < all.sets.cells().size(); ++c)
        if (all.sets.kind(c) == pvs::CellKind::inner || all.sets.kind(c) == pvs::CellKind::open)
            all.places.push_back(all.sets.cells().box(c).center());
}

// How many pixels each object owns.
Vector<std::uint32_t> owned_pixels(const Looked& all, const Camera& camera) {
    const auto [width, height] = std::pair(all.options.width, all.options.height);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
    const double half_height = std::tan(0.5 * camera.fov_y), half_width = half_height * camera.aspect;
    const glm::dvec3 eye = camera.position - all.geometry.origin;
    Vector<std::uint32_t> pixels(all.geometry.boxes.size(), 0);
    Vector<Ray> rays;
    Vector<std::optional<mesh::TriangleHit>> hits(std::size_t{kTile} * width);
    for (std::uint32_t y = 0; y < height; y += kTile) {
        rays.clear();
        for (std::uint32_t x = 0; x < width; x += kTile)
            for (std::uint32_t j = y; j < std::min(y + kTile, height); ++j)
                for (std::uint32_t i = x; i < std::min(x + kTile, width); ++i) {
                    const double u = (2.0 * (i + 0.5) / width - 1.0) * half_width;
                    const double v = (1.0 - 2.0 * (j + 0.5) / height) * half_height;
                    const glm::dvec3 direction = camera.forward + u * right + v * camera.up;
                    rays.push_back({eye + all.near * direction, direction});
                }
        mesh::raycast(rays, all.tree, hits);
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (hits[i]) ++pixels[all.geometry.object_of[hits[i]->triangle]];
    }
    return pixels;
}

// By object: whether the view finds it, occlusion considered.
Vector<bool> not_occluded(const Looked& all, const Camera& camera, ViewResult& visible) {
    Vector<bool> found(all.geometry.boxes.size(), !all.occluding);
    if (!all.occluding) return found;
    if (!all.occluding->world().view({.camera = camera, .layers = kSeenLayer, .occlusion = OcclusionOptions{}},
                                     visible)) {
        found.assign(found.size(), true);
        return found;
    }
    for (const std::uint32_t id : visible.ids())
        if (id < found.size()) found[id] = true;
    return found;
}

Counts look(const Looked& all, const Camera& camera, std::uint32_t cell, ViewResult& visible) {
    const Vector<std::uint32_t> pixels = owned_pixels(all, camera);
    const Vector<bool> open = not_occluded(all, camera, visible);
    const auto frustum = frustum_of(camera);
    Counts counts;
    for (std::uint32_t o = 0; o < pixels.size(); ++o) {
        if (all.triangles_of[o] == 0) continue;
        const auto state = cell == pvs::kNoCell ? pvs::PairState::seen : all.sets.state(cell, o);
        const bool conservative = state != pvs::PairState::hidden, statistical = state == pvs::PairState::seen;
        const std::array<bool, kWays> drawn{conservative, statistical, open[o], conservative && open[o],
                                            statistical && open[o]};
        counts.owners += pixels[o] > 0 ? all.triangles_of[o] : 0;
        for (std::size_t w = 0; w < kWays; ++w) counts.wrong[w] += drawn[w] ? 0 : pixels[o];
        if (frustum && cull::classify(*frustum, all.geometry.boxes[o]) == cull::Verdict::outside) continue;
        counts.frustum += all.triangles_of[o];
        for (std::size_t w = 0; w < kWays; ++w) counts.triangles[w] += drawn[w] ? all.triangles_of[o] : 0;
    }
    return counts;
}

// Sums first, so that what is the same in all views is exactly their mean.
PvsViewFigures figures_of(const Looked& all, std::span<const Camera> cameras, std::span<const Counts> counts) {
    PvsViewFigures figures;
    figures.views = all.options.views;
    Counts sum, worst;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        figures.in_no_cell += all.sets.find_cell(cameras[i].position) == pvs::kNoCell;
        sum.frustum += counts[i].frustum;
        sum.owners += counts[i].owners;
        for (std::size_t w = 0; w < kWays; ++w) {
            sum.wrong[w] += counts[i].wrong[w];
            worst.wrong[w] = std::max(worst.wrong[w], counts[i].wrong[w]);
            sum.triangles[w] += counts[i].triangles[w];
        }
    }
    const double pixels = static_cast<double>(all.options.width) * all.options.height;
    const auto mean = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(cameras.size()); };
    const auto way = [&](Way w) {
        return PvsModeFigures{mean(sum.wrong[w]) / pixels, static_cast<double>(worst.wrong[w]) / pixels,
                              mean(sum.triangles[w])};
    };
    figures.frustum_triangles = mean(sum.frustum);
    figures.owner_triangles = mean(sum.owners);
    figures.conservative = way(kConservative);
    figures.statistical = way(kStatistical);
    figures.has_occlusion = all.occluding.has_value();
    if (!figures.has_occlusion) return figures;
    figures.occlusion = way(kOcclusion);
    figures.conservative_and_occlusion = way(kConservativeToo);
    figures.statistical_and_occlusion = way(kStatisticalToo);
    return figures;
}

}  // namespace

Result<PvsViewFigures> look_at_views(const scene::Scene& scene, const pvs::BakeGeometry& geometry, const pvs::Pvs& sets,
                                     const PvsViewOptions& options, Executor& executor) {
    if (options.views == 0 || options.width == 0 || options.height == 0)
        return fail(ErrorCode::invalid_argument, kNoItem, "views: their number and their sizes must be positive");
    crofton::detail::StopSignal stop(options.should_stop, options.user);
    const auto stopped = [] { return fail(ErrorCode::cancelled, kNoItem, "views: stopped"); };
    const auto space = FreeSpace::find(scene, focus_of(scene), {.unit = options.unit, .within = sets.cells().bounds()});
    if (stop.is_raised(0.0)) return stopped();
    auto tree = mesh::MeshTree::build(geometry.mesh, {.boxes = mesh::MeshBoxes::principal_axes, .rays = true});
    if (!tree) return tree.error();
    Looked all{geometry, sets, options, std::move(*tree), {}, {}, 0.0, 0.0, {}, 0.0};
    find_places(space, all);
    const auto no_place = [] {
        return fail(ErrorCode::empty, kNoItem,
                    "views: no place for an eye was found within the cells that are not solid");
    };
    if (all.places.empty()) return no_place();
    if (options.occluders) {
        auto occluding = Pipeline::create(scene, {}, {.collide = false, .occlusion = OcclusionOptions{}},
                                          serial_executor(), options.occluders);
        if (!occluding) return occluding.error();
        all.occluding = std::move(*occluding);
    }
    all.triangles_of.assign(geometry.boxes.size(), 0);
    for (const std::uint32_t object : geometry.object_of) ++all.triangles_of[object];
    const double half = std::tan(0.5 * Camera{}.fov_y), aspect = static_cast<double>(options.width) / options.height;
    const double farthest = std::hypot(1.0, half, half * aspect);
    all.near = std::min(kFarthestNear, options.near_radius / farthest);
    if (space) all.near = std::min(all.near, 0.5 * space->eye_height() / farthest);
    all.reach = all.near * farthest;

    Vector<Camera> cameras;
    for (std::uint32_t i = 0; i < options.views; ++i) {
        const auto camera = random_view(all, i, stop);
        if (stop.was_raised()) return stopped();
        if (!camera) return no_place();
        cameras.push_back(*camera);
    }
    Vector<Counts> counts(cameras.size());
    Vector<ViewResult> visible(executor.concurrency());
    std::atomic<std::size_t> done{0};
    executor.parallel_for(cameras.size(), 1, [&](std::size_t begin, std::size_t end, unsigned worker) {
        const double share = static_cast<double>(done += end - begin) / static_cast<double>(cameras.size());
        if (stop.is_raised(share)) return;
        for (std::size_t i = begin; i < end; ++i)
            counts[i] = look(all, cameras[i], sets.find_cell(cameras[i].position), visible[worker]);
    });
    if (stop.was_raised()) return stopped();
    return figures_of(all, cameras, counts);
}

}  // namespace crofton::pipeline
