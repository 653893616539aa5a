// SPDX-License-Identifier: MIT
#include "street.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>

namespace crofton::pipeline {
namespace {

// In plain digits, as few as tell the length.
std::string in_digits(double length) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3g", length);
    return text;
}

std::string remark_on(const FreeSpace& space, const assets::SceneSource& source, const Aabb& focus) {
    if (space.unit() == 1.0 || (space.unit() > 0.0 && space.unit() == source.unit)) return {};
    if (space.unit() > 0.0)
        return source.name + ": the street is " + in_digits(space.eye_height()) +
               " above the ground, as if lengths were " + (space.unit() == 0.01 ? "centimetres" : "millimetres") +
               ": houses would be too high in metres. --unit sets it";
    const double longer = std::max(focus.max.x - focus.min.x, focus.max.z - focus.min.z);
    return source.name + ": no place for a person of 1.8 m" + (source.unit > 0.0 ? "" : ", if lengths are metres") +
           ": the street is " + in_digits(space.eye_height()) + " above the ground, " +
           (space.room_height() > 0.0 ? "by its rooms' height of " + in_digits(space.room_height())
                                      : "by the scene's size of " + in_digits(longer));
}

// The regions around the middle of all objects, nearest first: as many as have kMostObjects, at least one.
std::vector<const bake::RegionFile*> regions_in_the_middle(std::span<const bake::RegionFile> index) {
    constexpr std::uint64_t kMostObjects = 4'000;
    glm::dvec3 middle(0.0);
    double objects = 0.0;
    for (const bake::RegionFile& region : index) objects += static_cast<double>(region.objects);
    const auto center = [](const bake::RegionFile& region) {
        return region.origin + 0.5 * (region.bounds.min + region.bounds.max);
    };
    for (const bake::RegionFile& region : index)
        middle += static_cast<double>(region.objects) / std::max(objects, 1.0) * center(region);
    const auto distance = [&](const bake::RegionFile* region) { return glm::distance(center(*region), middle); };
    std::vector<const bake::RegionFile*> nearest;
    for (const bake::RegionFile& region : index)
        if (region.objects > 0) nearest.push_back(&region);
    std::stable_sort(nearest.begin(), nearest.end(), [&](auto* a, auto* b) { return distance(a) < distance(b); });
    std::uint64_t sum = 0;
    std::size_t count = 0;
    while (count < nearest.size() && (count == 0 || sum + nearest[count]->objects <= kMostObjects))
        sum += nearest[count++]->objects;
    nearest.resize(count);
    return nearest;
}

Result<void> add_moved(const scene::Scene& from, const glm::dvec3& by, scene::Scene& to) {
    std::vector<scene::MeshId> meshes;
    for (scene::MeshId mesh = 0; mesh < from.mesh_count(); ++mesh) {
        const auto added = to.add_mesh(from.mesh(mesh));
        if (!added) return added.error();
        meshes.push_back(*added);
    }
    for (scene::InstanceId instance = 0; instance < from.instance_count(); ++instance) {
        Transform transform = from.world(from.node_of(instance));
        transform.translation += by;
        const auto node = to.add_node(scene::kNone, transform);
        if (!node) return node.error();
        if (auto added = to.add_instance(*node, meshes[from.mesh_of(instance)]); !added) return added.error();
    }
    return {};
}

}  // namespace

void Street::set(PathOptions& options) const {
    if (!space) return;
    options.eye_height = space->eye_height();
    options.over_floor = [this](const glm::dvec3& eye) { return origin + space->over_floor(eye - origin); };
}

Street street_of(const assets::SceneSource& source, const Aabb& focus) {
    // A level's waypoints do not say how to get from one to the next.
    const bool has_own = !source.walk.empty() && source.rooms.empty();
    Street street;
    if (has_own) {
        street.walk = source.walk;
        return street;
    }
    street.space = FreeSpace::find(source.scene, focus, {.unit = source.unit});
    if (street.space) {
        street.walk = street.space->walk();
        street.remark = remark_on(*street.space, source, focus);
        return street;
    }
    street.walk = source.walk;
    street.remark = source.name + ": no floor to walk on was found: the street leads " +
                    (source.walk.empty() ? "along the longer side of the scene" : "from waypoint to waypoint");
    return street;
}

Result<Street> street_of_regions(const std::string& folder, std::span<const bake::RegionFile> index,
                                 const assets::ReadLimits& limits) {
    const std::vector<const bake::RegionFile*> regions = regions_in_the_middle(index);
    if (regions.empty()) return Street();
    const glm::dvec3 origin = regions.front()->origin;
    assets::SceneSource middle;
    middle.name = std::filesystem::path(folder).lexically_normal().string();
    for (const bake::RegionFile* region : regions) {
        auto source = assets::load_scene((std::filesystem::path(folder) / region->name).string(), {.limits = limits});
        if (!source) return source.error();
        source->scene.update();
        if (auto added = add_moved(source->scene, region->origin - origin, middle.scene); !added) return added.error();
        middle.unit = source->unit;
    }
    middle.scene.update();
    Street street = street_of(middle, focus_of(middle.scene));
    street.origin = origin;
    for (glm::dvec3& place : street.walk) place += origin;
    return street;
}

}  // namespace crofton::pipeline
