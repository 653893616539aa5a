// SPDX-License-Identifier: MIT
// Regions: parts of a world that are prepared on any thread.
#include <pybind11/stl.h>

#include "world.hpp"

namespace crofton::python {
namespace {

// A mesh, and where it stands.
using Instances = std::pair<std::shared_ptr<PyMesh>, py::object>;

struct Contents {
    std::vector<RegionObject> objects;
    std::vector<RegionMesh> meshes;
    std::vector<std::shared_ptr<PyMesh>> held;  // while the region is prepared
};

void add_instances(const Instances& given, const RegionMesh& like, Contents& contents) {
    const auto& [mesh, matrices] = given;
    if (!mesh) raise_type("instances: a Mesh is expected");
    const auto place = static_cast<std::uint32_t>(contents.meshes.size());
    RegionMesh& added = contents.meshes.emplace_back(like);
    added.mesh.positions = std::span<const glm::vec3>(mesh->triangles().positions);
    added.mesh.indices = std::span<const std::uint32_t>(mesh->triangles().indices);
    contents.held.push_back(mesh);
    for (const Transform& transform : transforms_of(matrices, "transforms"))
        contents.objects.push_back({.mesh = place, .transform = transform});
}

void set_users(const py::object& users, std::vector<RegionObject>& objects) {
    if (users.is_none()) return;
    const auto held = integers<std::uint64_t>(users, "users");
    if (static_cast<std::size_t>(held.size()) != objects.size())
        raise({ErrorCode::invalid_argument, kNoItem, "users: as many as objects are expected"});
    for (std::size_t i = 0; i < objects.size(); ++i) objects[i].user = held.data()[i];
}

Region prepare(const py::object& boxes, const std::vector<Instances>& instances, const py::object& users,
               std::uint32_t layers, std::uint32_t collides_with, bool triangles, bool occluders, bool clusters,
               double max_origin) {
    Contents contents;
    if (!boxes.is_none())
        for (const Obb& box : Boxes(boxes, "boxes").span()) contents.objects.push_back({.bound = box});
    RegionMesh like;
    like.mesh.triangles = triangles;
    like.mesh.occluders = occluders;
    like.mesh.clusters = clusters;
    for (const Instances& one : instances) add_instances(one, like, contents);
    set_users(users, contents.objects);
    for (RegionObject& object : contents.objects) {
        object.layers = layers;
        object.collides_with = collides_with;
    }
    const auto threads = executor();
    return value_of(unlocked([&] {
        return Region::prepare(contents.objects, {.meshes = contents.meshes, .max_origin = max_origin}, *threads);
    }));
}

}  // namespace

void bind_world_regions(py::module_& module, py::class_<PyWorld>& type) {
    py::class_<Region>(module, "Region",
                       "Many objects that do not move, with all that is built over them. Prepare it on any thread and "
                       "attach it to a World, at one origin or several.")
        .def_static("prepare", &prepare, py::arg("boxes") = py::none(), py::arg("instances") = std::vector<Instances>(),
                    py::kw_only(), py::arg("users") = py::none(), py::arg("layers") = ~0u,
                    py::arg("collides_with") = ~0u, py::arg("triangles") = true, py::arg("occluders") = false,
                    py::arg("clusters") = false, py::arg("max_origin") = RegionOptions{}.max_origin,
                    "Objects: the boxes, then for each pair (Mesh, matrices of shape (n, 4, 4)) of `instances` one an "
                    "instance. Coordinates are relative to the region's origin. Error.item is the object's place, or "
                    "the pair's.")
        .def_property_readonly("bytes", &Region::bytes)
        .def("__len__", &Region::object_count)
        .def("__repr__", [](const Region& region) { return format("Region(%zu objects)", region.object_count()); });
    type.def(
            "attach",
            [](PyWorld& world, const Region& region, const py::handle& origin) {
                const glm::dvec3 at = vector_of(origin, "origin");
                return value_of(world.change([&](World& w) { return w.attach(region, at); }));
            },
            py::arg("region"), py::arg("origin"), "Its objects are in all answers from the next update() on.")
        .def(
            "detach",
            [](PyWorld& world, RegionHandle region) {
                value_of(world.change([&](World& w) { return w.detach(region); }));
            },
            py::arg("region"), "Handles of its objects are stale at once; views follow with the next update().")
        .def(
            "object_in",
            [](const PyWorld& world, RegionHandle region, std::uint32_t place) {
                return value_of(world.ask([&](const World& w) { return w.object_in(region, place); }));
            },
            py::arg("region"), py::arg("place"), "The object at a place of Region.prepare().")
        .def(
            "place_of",
            [](const PyWorld& world, ObjectHandle object) {
                const RegionPlace place = value_of(world.ask([&](const World& w) { return w.place_of(object); }));
                return std::make_pair(place.region, place.index);
            },
            py::arg("object"), "The region of an object, and its place there.");
}

}  // namespace crofton::python
