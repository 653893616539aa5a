// SPDX-License-Identifier: MIT
#include "pvs_views.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "camera_path.hpp"
#include "free_space.hpp"

namespace crofton::pipeline {
namespace {

constexpr std::uint32_t kTile = 4;  // rays of a tile go through the tree together
constexpr std::uint32_t kTries = 1000;
constexpr double kFarthestNear = 0.1, kNearestNear = 1e-4;

// What all views share.
struct Looked {
    const pvs::Subject& subject;
    const pvs::Pvs& sets;
    const PvsViewOptions& options;
    mesh::MeshTree tree;
    Vector<std::uint32_t> triangles_of;  // by object
    double near = 0.0;
    double reach = 0.0;  // of the near plane: its farthest point in a picture
};

// Of one view.
struct Counts {
    std::uint64_t wrong_conservative = 0, wrong_statistical = 0;               // pixels
    std::uint64_t frustum = 0, owners = 0, conservative = 0, statistical = 0;  // triangles
};

// Whether a camera at `eye` could turn all around, and its near plane would cut nothing.
bool has_room(const Looked& all, const glm::dvec3& eye) {
    const auto ball = convex::Body::ball(all.reach);
    const auto mesh = convex::Body::mesh(all.tree);
    return ball && mesh && !convex::intersects({*mesh, {}}, {*ball, {glm::dmat3(1.0), eye - all.subject.origin}});
}

// A place, moved sideways by up to half the distance of two, if nothing lies between. Cells and places are both
// regular, so places alone would always be at the same spots of cells.
std::optional<Camera> random_view(const Looked& all, std::span<const glm::dvec3> places, double spacing,
                                  std::uint32_t number) {
    sampling::Random random(all.options.seed, number);
    for (std::uint32_t i = 0; i < kTries; ++i) {
        const glm::dvec3 place = places[random.bits() % places.size()];
        // One after the other: in which order arguments are computed is left to the compiler.
        const double z = random.uniform(-0.5, 0.5), x = random.uniform(-0.5, 0.5);
        const glm::dvec3 move = spacing * glm::dvec3(x, 0.0, z);
        const glm::dvec2 ahead = sampling::circle_point(random.uniform());
        const glm::dvec3 eye = place + move;
        const Aabb& cells = all.sets.cells().bounds();
        if (glm::any(glm::lessThan(eye, cells.min)) || glm::any(glm::greaterThan(eye, cells.max))) continue;
        if (mesh::hits_any({place - all.subject.origin, move, 1.0}, all.tree) || !has_room(all, eye)) continue;
        Camera camera;
        camera.position = eye;
        camera.forward = {ahead.x, 0.0, ahead.y};
        camera.aspect = static_cast<double>(all.options.width) / static_cast<double>(all.options.height);
        camera.near_distance = std::max(all.near, kNearestNear);
        return camera;
    }
    return std::nullopt;
}

// How many pixels each object owns.
Vector<std::uint32_t> owned_pixels(const Looked& all, const Camera& camera) {
    const auto [width, height] = std::pair(all.options.width, all.options.height);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
    const double half_height = std::tan(0.5 * camera.fov_y), half_width = half_height * camera.aspect;
    const glm::dvec3 eye = camera.position - all.subject.origin;
    Vector<std::uint32_t> pixels(all.subject.boxes.size(), 0);
    Vector<Ray> rays;
    Vector<std::optional<mesh::RayHit>> hits(std::size_t{kTile} * width);
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
            if (hits[i]) ++pixels[all.subject.object_of[hits[i]->triangle]];
    }
    return pixels;
}

Counts look(const Looked& all, const Camera& camera, std::uint32_t cell) {
    const Vector<std::uint32_t> pixels = owned_pixels(all, camera);
    const auto frustum = frustum_of(camera);
    Counts counts;
    for (std::uint32_t o = 0; o < pixels.size(); ++o) {
        if (all.triangles_of[o] == 0) continue;
        const auto state = cell == pvs::kNoCell ? pvs::PairState::seen : all.sets.state(cell, o);
        const bool conservative = state != pvs::PairState::hidden, statistical = state == pvs::PairState::seen;
        counts.wrong_conservative += conservative ? 0 : pixels[o];
        counts.wrong_statistical += statistical ? 0 : pixels[o];
        counts.owners += pixels[o] > 0 ? all.triangles_of[o] : 0;
        if (frustum && cull::classify(*frustum, all.subject.boxes[o]) == cull::Verdict::outside) continue;
        counts.frustum += all.triangles_of[o];
        counts.conservative += conservative ? all.triangles_of[o] : 0;
        counts.statistical += statistical ? all.triangles_of[o] : 0;
    }
    return counts;
}

// Sums first, so that what is the same in all views is exactly their mean.
PvsViewFigures figures_of(const Looked& all, std::span<const Camera> cameras, std::span<const Counts> counts) {
    PvsViewFigures figures;
    figures.views = all.options.views;
    Counts sum;
    std::uint64_t worst_conservative = 0, worst_statistical = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const Counts& each = counts[i];
        figures.in_no_cell += all.sets.find_cell(cameras[i].position) == pvs::kNoCell;
        worst_conservative = std::max(worst_conservative, each.wrong_conservative);
        worst_statistical = std::max(worst_statistical, each.wrong_statistical);
        sum.wrong_conservative += each.wrong_conservative;
        sum.wrong_statistical += each.wrong_statistical;
        sum.frustum += each.frustum;
        sum.owners += each.owners;
        sum.conservative += each.conservative;
        sum.statistical += each.statistical;
    }
    const double pixels = static_cast<double>(all.options.width) * all.options.height;
    const auto mean = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(cameras.size()); };
    figures.frustum_triangles = mean(sum.frustum);
    figures.owner_triangles = mean(sum.owners);
    figures.conservative = {mean(sum.wrong_conservative) / pixels, static_cast<double>(worst_conservative) / pixels,
                            mean(sum.conservative)};
    figures.statistical = {mean(sum.wrong_statistical) / pixels, static_cast<double>(worst_statistical) / pixels,
                           mean(sum.statistical)};
    return figures;
}

}  // namespace

Result<PvsViewFigures> look_at_views(const scene::Scene& scene, const pvs::Subject& subject, const pvs::Pvs& sets,
                                     const PvsViewOptions& options, Executor& executor) {
    if (options.views == 0 || options.width == 0 || options.height == 0)
        return fail(ErrorCode::invalid_argument, kNoItem, "views: their number and their sizes must be positive");
    const Aabb focus = focus_of(scene);
    const auto space = FreeSpace::find(scene, focus);
    const auto no_place = [] {
        return fail(ErrorCode::empty, kNoItem, "views: no place to stand was found within the cells");
    };
    if (!space || space->places().empty()) return no_place();
    auto tree = mesh::MeshTree::build(subject.mesh, {.boxes = mesh::MeshBoxes::principal_axes, .rays = true});
    if (!tree) return tl::unexpected(tree.error());
    Looked all{subject, sets, options, std::move(*tree), {}};
    all.triangles_of.assign(subject.boxes.size(), 0);
    for (const std::uint32_t object : subject.object_of) ++all.triangles_of[object];
    const double half = std::tan(0.5 * Camera{}.fov_y), aspect = static_cast<double>(options.width) / options.height;
    const double farthest = std::hypot(1.0, half, half * aspect);
    all.near = std::min({kFarthestNear, options.near_radius / farthest, 0.5 * space->eye_height() / farthest});
    all.reach = all.near * farthest;
    const double spacing = std::max(focus.max.x - focus.min.x, focus.max.z - focus.min.z) / FreeSpace::kColumns;

    Vector<Camera> cameras;
    for (std::uint32_t i = 0; i < options.views; ++i) {
        const auto camera = random_view(all, space->places(), spacing, i);
        if (!camera) return no_place();
        cameras.push_back(*camera);
    }
    Vector<Counts> counts(cameras.size());
    executor.parallel_for(cameras.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i)
            counts[i] = look(all, cameras[i], sets.find_cell(cameras[i].position));
    });
    return figures_of(all, cameras, counts);
}

}  // namespace crofton::pipeline
