// SPDX-License-Identifier: MIT
// Regions: parts of a world that are prepared on any thread.
#include <pybind11/stl.h>

#include <crofton/bake/region_files.hpp>

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

std::string path_of(const py::object& given) {
    return py::module_::import("os").attr("fsencode")(given).cast<py::bytes>();
}

bake::BakedRegionOptions options_of(bool triangles, bool occluders, std::uint32_t collides_with, double max_origin,
                                    bool trust_contents) {
    bake::BakedRegionOptions options;
    options.triangles = triangles;
    options.occluders = occluders;
    options.collides_with = collides_with;
    options.region.max_origin = max_origin;
    options.trust_contents = trust_contents;
    return options;
}

Region open(const py::object& given, bool triangles, bool occluders, std::uint32_t collides_with, double max_origin,
            bool trust_contents) {
    const std::string path = path_of(given);
    const auto options = options_of(triangles, occluders, collides_with, max_origin, trust_contents);
    const auto threads = executor();
    return value_of(unlocked([&]() -> Result<Region> {
        auto scene = bake::BakedScene::open(path, *threads);
        if (!scene) return scene.error();
        return bake::prepare_region(std::move(*scene), options, *threads);
    }));
}

// One of a folder's regions.
struct PyRegionFile {
    std::string folder;
    bake::RegionFile file;
};

std::vector<PyRegionFile> region_files(const py::object& given) {
    const std::string folder = path_of(given);
    std::vector<PyRegionFile> result;
    for (auto& file : value_of(unlocked([&] { return bake::open_region_index(folder); })))
        result.push_back({folder, std::move(file)});
    return result;
}

py::array corners_of(const Aabb& bounds) {
    py::array_t<double> result({2, 3});
    for (int k = 0; k < 3; ++k) result.mutable_at(0, k) = bounds.min[k], result.mutable_at(1, k) = bounds.max[k];
    return result;
}

void bind_region_files(py::module_& module) {
    const auto keywords = [](auto define) {
        const bake::BakedRegionOptions defaults;
        return define(py::kw_only(), py::arg("triangles") = defaults.triangles,
                      py::arg("occluders") = defaults.occluders, py::arg("collides_with") = defaults.collides_with,
                      py::arg("max_origin") = defaults.region.max_origin, py::arg("trust_contents") = false);
    };
    auto type = py::class_<PyRegionFile>(module, "RegionFile", "One region of a folder; region_files() lists them.");
    type.def_property_readonly("name", [](const PyRegionFile& f) { return f.file.name; })
        .def_property_readonly(
            "origin", [](const PyRegionFile& f) { return tuple_of(f.file.origin); }, "where to attach it")
        .def_property_readonly(
            "bounds", [](const PyRegionFile& f) { return corners_of(f.file.bounds); },
            "two corners of a box around its objects, relative to the origin")
        .def_property_readonly("objects", [](const PyRegionFile& f) { return f.file.objects; })
        .def_property_readonly("bytes", [](const PyRegionFile& f) { return f.file.bytes; })
        .def("__repr__", [](const PyRegionFile& f) {
            return format("RegionFile(%s, %llu objects)", f.file.name.c_str(),
                          static_cast<unsigned long long>(f.file.objects));
        });
    keywords([&](auto... options) {
        type.def(
            "open",
            [](const PyRegionFile& f, bool triangles, bool occluders, std::uint32_t collides_with, double max_origin,
               bool trust_contents) {
                const auto given = options_of(triangles, occluders, collides_with, max_origin, trust_contents);
                const auto threads = executor();
                return value_of(unlocked([&] { return bake::open_region(f.folder, f.file, given, {}, *threads); }));
            },
            options..., "Its Region, as Region.open. Also an error: the file is not that of the index.");
    });
    module.def("region_files", &region_files, py::arg("folder"),
               "The regions of a folder that `crofton bake --regions` has written.");
}

}  // namespace

void bind_world_regions(py::module_& module, py::class_<PyWorld>& type) {
    bind_region_files(module);
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
        .def_static("open", &open, py::arg("path"), py::kw_only(), py::arg("triangles") = true,
                    py::arg("occluders") = true, py::arg("collides_with") = ~0u,
                    py::arg("max_origin") = RegionOptions{}.max_origin, py::arg("trust_contents") = false,
                    "A region of a baked file. The object at place i is instance i, with the user number i; meshes "
                    "have the file's numbers. Without `occluders` its objects hide nothing, and it takes half of the "
                    "time. `trust_contents` does not check the file's bounds: for files of your own.")
        .def_property_readonly("bytes", &Region::bytes)
        .def_property_readonly(
            "bounds", [](const Region& region) { return corners_of(region.bounds()); },
            "two corners of a box around all objects, relative to the origin")
        .def(
            "mesh_of",
            [](const Region& region, std::uint32_t place) -> py::object {
                if (place >= region.object_count())
                    raise({ErrorCode::out_of_range, place, "the region has no object at that place"});
                const std::uint32_t mesh = region.mesh_of(place);
                return mesh == kNoIndex ? py::none() : py::object(py::int_(mesh));
            },
            py::arg("place"), "The number of an object's mesh; None if it has none.")
        .def(
            "clusters_of",
            [](const Region& region, std::uint32_t mesh) -> std::shared_ptr<depth::ClusteredMesh> {
                const depth::ClusteredMesh* const cut = region.clusters_of(mesh);
                if (cut == nullptr) return nullptr;
                auto copy = std::make_shared<depth::ClusteredMesh>(*cut);
                copy->keep_copy();
                return copy;
            },
            py::arg("mesh"), "The clusters of a mesh, to which a view's triangles refer; None: no such mesh, or none.")
        .def("__len__", &Region::object_count)
        .def("__repr__", [](const Region& region) { return format("Region(%zu objects)", region.object_count()); });
    type.def(
            "attach",
            [](PyWorld& world, const Region& region, const py::handle& origin) {
                const glm::dvec3 at = vector_of(origin, "origin");
                return value_of(world.change([&](World& w) { return w.attach(region, at); }));
            },
            py::arg("region"), py::arg("origin") = py::make_tuple(0, 0, 0),
            "Its objects are in all answers from the next update() on.")
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
