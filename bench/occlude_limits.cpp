// SPDX-License-Identifier: MIT
// What any occlusion culling that asks for boxes must submit: bench_occlude_limits [SCENE …]. Rays through the pixels
// of a picture find what each meets first, of all triangles. A ray that reaches an object's box before that proves that
// the box is in sight: nothing that is drawn hides it, so no occluders do, however they are chosen or drawn.
#include <algorithm>
#include <cmath>
#include <crofton/crofton.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

namespace {

using namespace crofton;

constexpr int kWidth = 320, kHeight = 180, kViews = 6;

struct Thing {
    Obb box;
    std::size_t triangles = 0;
};

struct Totals {
    double of_surface = 0;
    std::size_t of_surface_count = 0;
    double in_view = 0, boxes_in_sight = 0, own_a_pixel = 0;
    std::size_t in_view_count = 0, in_sight_count = 0, own_count = 0;
};

// Where the ray enters the box, or infinity.
double entry_of(const Ray& ray, const Obb& box) {
    double enter = 0.0, leave = HUGE_VAL;
    const glm::dvec3 from = ray.origin - box.center;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k]);
        const double at = glm::dot(axis, from), slope = glm::dot(axis, ray.direction), half = box.half_extents[k];
        const double a = (-half - at) / slope, b = (half - at) / slope;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave ? enter : HUGE_VAL;
}

Camera camera_on(const std::vector<glm::dvec3>& walk, int view) {
    const std::size_t leg = static_cast<std::size_t>(view) * walk.size() / kViews;
    const glm::dvec3 a = walk[leg], b = walk[(leg + 1) % walk.size()];
    Camera camera;
    camera.position = 0.5 * (a + b);
    camera.forward = b - a;
    camera.aspect = double{kWidth} / kHeight;
    camera.fov_y = 1.0;
    camera.near_distance = 0.1;
    camera.far_distance = 2000.0;
    return camera;
}

// Where a scene has no path to walk: through its middle along the longer side, low above its floor.
std::vector<glm::dvec3> walk_in(const Aabb& bounds) {
    std::vector<glm::dvec3> walk;
    const glm::dvec3 middle = bounds.center(), size = bounds.max - bounds.min;
    const int along = size.x >= size.z ? 0 : 2;
    for (int i = 0; i < 2 * kViews; ++i) {
        glm::dvec3 at = middle;
        at.y = bounds.min.y + std::min(0.25 * size.y, 0.01 * std::hypot(size.x, size.z));
        at[along] = bounds.min[along] + size[along] * 0.97 * i / (2 * kViews);
        walk.push_back(at);
    }
    return walk;
}

// What stays when all triangles of the scene are one occluder, whose common edges are welded.
void ask_surface(const occlude::OccluderSet& surface, const std::vector<Thing>& things, const Camera& camera,
                 std::span<const std::uint32_t> in_view, Totals& totals) {
    auto buffer = *occlude::OcclusionBuffer::create({2 * kWidth, 2 * kHeight});
    const auto view = occlude::occlusion_view_of(camera);
    if (!view) return;
    buffer.draw(surface, *view);
    for (const std::uint32_t id : in_view)
        if (!buffer.hides(things[id].box)) {
            totals.of_surface += static_cast<double>(things[id].triangles);
            ++totals.of_surface_count;
        }
}

void look(const World& world, const occlude::OccluderSet& surface, const std::vector<Thing>& things,
          const Camera& camera, Totals& totals) {
    ViewResult in_frustum;
    if (!world.view({.camera = camera}, in_frustum)) return;
    std::vector<std::uint32_t> unseen(in_frustum.ids().begin(), in_frustum.ids().end());
    ask_surface(surface, things, camera, unseen, totals);
    std::vector<bool> owns(things.size(), false);
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    const double half = std::tan(0.5 * camera.fov_y);
    for (const std::uint32_t id : unseen) totals.in_view += static_cast<double>(things[id].triangles);
    totals.in_view_count += unseen.size();
    std::size_t before = unseen.size();
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double u = (2.0 * x + 1.0) / kWidth - 1.0, v = (2.0 * y + 1.0) / kHeight - 1.0;
            const Ray ray{camera.position, to_world * glm::dvec3(u * half * camera.aspect, v * half, -1.0),
                          camera.far_distance};
            const auto hit = world.raycast(ray);
            const double end = hit ? hit->t : camera.far_distance;
            if (hit) owns[hit->object.index] = true;
            std::erase_if(unseen, [&](std::uint32_t id) {
                const bool in_sight = entry_of(ray, things[id].box) < end;
                if (in_sight) totals.boxes_in_sight += static_cast<double>(things[id].triangles);
                return in_sight;
            });
        }
    totals.in_sight_count += before - unseen.size();
    for (std::size_t id = 0; id < things.size(); ++id)
        if (owns[id]) {
            totals.own_a_pixel += static_cast<double>(things[id].triangles);
            ++totals.own_count;
        }
}

// All triangles, where they stand.
void append(TriangleMesh& to, const TriangleMesh& mesh, const Transform& transform, const glm::dvec3& middle) {
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    for (const glm::vec3& p : mesh.positions)
        to.positions.push_back(glm::vec3(transform.linear * glm::dvec3(p) + (transform.translation - middle)));
    for (const std::uint32_t i : mesh.indices) to.indices.push_back(first + i);
}

bool measure_scene(const std::string& name) {
    auto source = assets::load_scene(name);
    if (!source) {
        std::printf("%s: %s\n", name.c_str(), source.error().message.c_str());
        return false;
    }
    scene::Scene& scene = source->scene;
    scene.update();
    World world{{.pairs = false, .updates_to_rest = 1}};
    std::map<scene::MeshId, MeshHandle> meshes;
    std::vector<Thing> things;
    Aabb bounds;
    TriangleMesh all;
    const glm::dvec3 middle = scene.world_boxes()[0].center;
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i) || scene.layer_masks()[i] == 0) continue;
        MeshHandle& mesh = meshes[scene.mesh_of(i)];
        const TriangleMesh& triangles = scene.mesh(scene.mesh_of(i));
        if (mesh.is_null())
            mesh = world.add_mesh({.positions = triangles.positions, .indices = triangles.indices}).value();
        append(all, triangles, scene.world(scene.node_of(i)), middle);
        const auto object = world.add({.mesh = mesh, .transform = scene.world(scene.node_of(i))});
        if (!object) continue;
        if (things.size() <= object->index) things.resize(object->index + 1);
        bounds.include(aabb_of(scene.world_boxes()[i]));
        things[object->index] = {scene.world_boxes()[i], triangles.triangle_count()};
    }
    for (int i = 0; i < 4; ++i) (void)world.update();
    if (source->walk.empty()) source->walk = walk_in(bounds);
    occlude::OccluderSet surface;
    const auto shape = surface.add_surface(all, occlude::Sides::both);
    if (shape) (void)surface.place(*shape, {glm::dmat3(1.0), middle});
    if (!shape) std::printf("%s\n", shape.error().message.c_str());
    Totals t;
    for (int view = 0; view < kViews; ++view) look(world, surface, things, camera_on(source->walk, view), t);
    std::printf(
        "%s: in view %zu objects, %.0f triangles; boxes in sight %zu, %.0f; own a pixel %zu, %.0f: %.2f x, and of "
        "all in view %.2f x\n",
        name.c_str(), t.in_view_count / kViews, t.in_view / kViews, t.in_sight_count / kViews,
        t.boxes_in_sight / kViews, t.own_count / kViews, t.own_a_pixel / kViews, t.boxes_in_sight / t.own_a_pixel,
        t.in_view / t.own_a_pixel);
    std::printf("  all triangles as one welded surface: %zu objects, %.0f triangles stay: %.2f x\n",
                t.of_surface_count / kViews, t.of_surface / kViews, t.of_surface / t.own_a_pixel);
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    bool good = true;
    if (argc < 2) good = measure_scene("town");
    for (int i = 1; i < argc; ++i) good = measure_scene(argv[i]) && good;
    return good ? 0 : 1;
}
