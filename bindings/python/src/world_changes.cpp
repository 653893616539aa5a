// SPDX-License-Identifier: MIT
// What a World is told.
#include <pybind11/stl.h>
#include <algorithm>

#include "shapes.hpp"
#include "world.hpp"

namespace crofton::python {
namespace {

// Points and indices that keep their arrays alive.
struct MeshArrays {
    Points<3> positions;
    py::array indices;

    MeshArrays(const py::handle& given, const py::object& given_indices) : positions(given, "positions") {
        if (given_indices.is_none()) return;
        const py::array array = py::array::ensure(given_indices);
        if (!array) PyErr_Clear();
        const bool is_short = array && array.dtype().equal(py::dtype::of<std::uint16_t>());
        indices = is_short ? py::array(integers<std::uint16_t>(array, "indices"))
                           : py::array(integers<std::uint32_t>(given_indices, "indices"));
        // The library takes no indices for "three positions are one triangle".
        if (indices.size() == 0) raise({ErrorCode::empty, kNoItem, "indices: there are none, so there is no triangle"});
    }
    [[nodiscard]] PointsView points() const {
        return positions.is_float() ? PointsView(positions.floats()) : PointsView(positions.doubles());
    }
    [[nodiscard]] MeshDescription description() const {
        MeshDescription result{.positions = points()};
        if (!indices) return result;
        const auto size = static_cast<std::size_t>(indices.size());
        result.indices = indices.itemsize() == 2 ? IndicesView(static_cast<const std::uint16_t*>(indices.data()), size)
                                                 : IndicesView(static_cast<const std::uint32_t*>(indices.data()), size);
        return result;
    }
};

MeshDescription description_of(const PyMesh& mesh) {
    const TriangleMesh& triangles = mesh.triangles();
    return {.positions = std::span<const glm::vec3>(triangles.positions),
            .indices = std::span<const std::uint32_t>(triangles.indices)};
}

// Makes the description of a mesh from the arguments of add_mesh and replace_mesh, and calls f with it.
template <class F>
auto with_mesh(const py::handle& positions, const py::object& indices, bool triangles, bool occluders, bool clusters,
               bool one_sided, const std::shared_ptr<const depth::ClusteredMesh>& precut, F&& f) {
    const PyMesh* const mesh = as<PyMesh>(positions);
    if (mesh != nullptr && !indices.is_none()) raise_type("indices: a Mesh has its own");
    std::optional<MeshArrays> arrays;
    if (mesh == nullptr) arrays.emplace(positions, indices);
    MeshDescription description = mesh != nullptr ? description_of(*mesh) : arrays->description();
    description.triangles = triangles;
    description.occluders = occluders;
    description.clusters = clusters;
    description.one_sided = one_sided;
    description.precut = precut.get();
    return f(description);
}

occlude::FoundOccluder surface_occluder(occlude::OccluderKind kind, const py::handle& given,
                                        const py::object& indices) {
    const PyMesh* const mesh = as<PyMesh>(given);
    occlude::FoundOccluder result;
    result.kind = kind;
    if (mesh != nullptr) {
        result.surface = mesh->triangles();
        return result;
    }
    const Points<3> points(given, "positions");
    points.visit([&](auto span) { result.surface.positions.assign(span.begin(), span.end()); });
    if (indices.is_none()) return result;
    const auto corners = integers<std::uint32_t>(indices, "indices");
    result.surface.indices.assign(span_of(corners).begin(), span_of(corners).end());
    return result;
}

template <class H>
H handle_or_null(const py::object& given, const char* name) {
    if (given.is_none()) return {};
    if (!py::isinstance<H>(given)) raise_type(std::string(name) + ": another kind of handle is expected");
    return given.cast<H>();
}

// All or none: what was added before an error is taken out again.
template <class F>
py::array add_all(PyWorld& to, std::size_t count, const py::object& users, F&& description) {
    py::array_t<std::uint64_t, py::array::c_style> held;
    if (!users.is_none()) {
        held = integers<std::uint64_t>(users, "users");
        if (static_cast<std::size_t>(held.size()) != count)
            raise({ErrorCode::invalid_argument, kNoItem, "users: as many as objects are expected"});
    }
    std::vector<ObjectHandle> handles(count);
    auto failed = to.change([&](World& world) -> Result<void> {
        constexpr std::size_t kAtOnce = 1024;
        std::vector<ObjectDescription> some(std::min(count, kAtOnce));
        for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
            const std::size_t size = std::min(kAtOnce, count - begin);
            for (std::size_t i = 0; i < size; ++i) {
                some[i] = description(begin + i);
                if (held.size() > 0) some[i].user = held.data()[begin + i];
            }
            auto added = world.add(std::span<const ObjectDescription>(some).first(size),
                                   std::span(handles).subspan(begin, size));
            if (added) continue;
            for (const ObjectHandle handle : handles)
                if (!handle.is_null()) (void)world.remove(handle);
            added.error().item += begin;
            return added;
        }
        return {};
    });
    value_of(std::move(failed));
    return handles_of(handles);
}

ObjectHandle add(PyWorld& to, const py::object& mesh, const py::object& node, const py::object& transform,
                 const py::object& box, const py::object& sphere, const py::object& aligned, const SharedShape& shape,
                 std::uint64_t user, std::uint32_t layers, std::uint32_t collides_with, bool occludes,
                 bool only_occludes, bool hidden) {
    ObjectDescription description;
    if (shape) description.shape = &*shape->shape;
    description.mesh = handle_or_null<MeshHandle>(mesh, "mesh");
    description.node = handle_or_null<NodeHandle>(node, "node");
    if (!transform.is_none()) description.transform = transform_of(transform, "transform");
    description.bound = bound_of(box, sphere, aligned);
    description.user = user;
    description.layers = layers;
    description.collides_with = collides_with;
    description.occludes = occludes;
    description.only_occludes = only_occludes;
    description.hidden = hidden;
    return value_of(to.change([&](World& world) {
        auto added = world.add(description);
        if (added) to.keep(*added, shape);
        return added;
    }));
}

void set_shape(PyWorld& to, ObjectHandle object, const SharedShape& shape) {
    value_of(to.change([&](World& world) {
        auto done = world.set_shape(object, shape ? &*shape->shape : nullptr);
        if (done) to.keep(object, shape);
        return done;
    }));
}

py::array add_boxes(PyWorld& to, const py::handle& given, const py::object& users, std::uint32_t layers,
                    std::uint32_t collides_with) {
    const Boxes boxes(given, "boxes");
    return add_all(to, boxes.span().size(), users, [&](std::size_t i) {
        return ObjectDescription{.bound = boxes.span()[i], .layers = layers, .collides_with = collides_with};
    });
}
py::array add_instances(PyWorld& to, MeshHandle mesh, const py::handle& given, const py::object& users,
                        std::uint32_t layers, std::uint32_t collides_with) {
    const auto transforms = transforms_of(given, "transforms");
    return add_all(to, transforms.size(), users, [&](std::size_t i) {
        return ObjectDescription{
            .mesh = mesh, .transform = transforms[i], .layers = layers, .collides_with = collides_with};
    });
}

// Changes objects, one or many: all but those refused; the error names the first.
template <class F>
void for_objects(PyWorld& world, const py::handle& given, F&& f) {
    const Handles<ObjectHandle> handles(given, "handles");
    value_of(world.change([&](World& w) -> Result<void> {
        Result<void> first;
        for (std::size_t i = 0; i < handles.span().size(); ++i)
            if (auto done = f(w, handles.span()[i]); !done && first) {
                first = done;
                first.error().item = i;
            }
        return first;
    }));
}

template <class H>
void set_transform(PyWorld& world, H handle, const py::handle& matrix) {
    const auto transform = transform_of(matrix, "transform");
    value_of(world.change([&](World& w) { return w.set_transform(handle, transform); }));
}

template <class H>
void set_transforms(PyWorld& world, const py::handle& given, const py::handle& matrices) {
    const Handles<H> handles(given, "handles");
    const auto transforms = transforms_of(matrices, "transforms");
    if (transforms.size() != handles.span().size())
        raise({ErrorCode::invalid_argument, kNoItem, "transforms: as many as handles are expected"});
    value_of(world.change([&](World& w) { return w.set_transforms(handles.span(), transforms); }));
}

void set_boxes(PyWorld& world, const py::handle& given, const py::handle& given_boxes) {
    const Handles<ObjectHandle> handles(given, "handles");
    const Boxes boxes(given_boxes, "boxes");
    if (boxes.span().size() != handles.span().size())
        raise({ErrorCode::invalid_argument, kNoItem, "boxes: as many as handles are expected"});
    value_of(world.change([&](World& w) { return w.set_bounds(handles.span(), boxes.span()); }));
}

}  // namespace

void bind_world_changes(py::module_& module, py::class_<PyWorld>& type) {
    using occlude::FoundOccluder;
    using occlude::OccluderKind;
    py::class_<FoundOccluder>(module, "Occluder",
                              "Geometry by which a mesh's objects hide others, in the mesh's frame: opaque, and within "
                              "the drawn mesh.")
        .def_static(
            "box", [](const Obb& box) { return FoundOccluder{.kind = OccluderKind::box, .box = box}; }, py::arg("box"),
            "A box inside a closed piece of the mesh.")
        .def_static(
            "walled", [](const Obb& box) { return FoundOccluder{.kind = OccluderKind::walled, .box = box}; },
            py::arg("box"), "A box behind walls of the mesh; it may be open on some sides.")
        .def_static(
            "convex",
            [](const py::handle& points) { return surface_occluder(OccluderKind::convex, points, py::none()); },
            py::arg("points"), "The convex hull of points (n, 3), or of a Mesh's.")
        .def_static(
            "patch",
            [](const py::handle& positions, const py::object& indices, bool one_sided) {
                FoundOccluder result = surface_occluder(OccluderKind::patch, positions, indices);
                result.sides = one_sided ? occlude::Sides::front : occlude::Sides::both;
                return result;
            },
            py::arg("positions"), py::arg("indices") = py::none(), py::kw_only(), py::arg("one_sided") = false,
            "Any triangles: a Mesh, or points (n, 3) and indices. `one_sided`: hides only from the side where they are "
            "counter-clockwise.")
        .def("__repr__", [](const FoundOccluder& o) {
            constexpr const char* kKinds[] = {"box", "walled", "convex", "patch"};
            return format("Occluder(%s)", kKinds[static_cast<std::size_t>(o.kind)]);
        });
    type.def(
            "add_mesh",
            [](PyWorld& world, const py::handle& positions, const py::object& indices, bool triangles, bool occluders,
               bool clusters, bool one_sided, const std::shared_ptr<const depth::ClusteredMesh>& precut) {
                return with_mesh(positions, indices, triangles, occluders, clusters, one_sided, precut,
                                 [&](const MeshDescription& description) {
                                     return value_of(world.change([&](World& w) { return w.add_mesh(description); }));
                                 });
            },
            py::arg("positions"), py::arg("indices") = py::none(), py::kw_only(), py::arg("triangles") = true,
            py::arg("occluders") = false, py::arg("clusters") = false, py::arg("one_sided") = false,
            py::arg("precut") = nullptr,
            "Adds a mesh: a Mesh, or points (n, 3) and indices, three per triangle. With occluders it hides what is "
            "behind it. With clusters, views with a picture list its triangles; `one_sided` says that back faces are "
            "not drawn; `precut` is its ClusteredMesh, if it was cut before.")
        .def(
            "replace_mesh",
            [](PyWorld& world, MeshHandle handle, const py::handle& positions, const py::object& indices,
               bool triangles, bool occluders, bool clusters, bool one_sided,
               const std::shared_ptr<const depth::ClusteredMesh>& precut) {
                with_mesh(positions, indices, triangles, occluders, clusters, one_sided, precut,
                          [&](const MeshDescription& description) {
                              value_of(world.change([&](World& w) { return w.replace_mesh(handle, description); }));
                          });
            },
            py::arg("mesh"), py::arg("positions"), py::arg("indices") = py::none(), py::kw_only(),
            py::arg("triangles") = true, py::arg("occluders") = false, py::arg("clusters") = false,
            py::arg("one_sided") = false, py::arg("precut") = nullptr,
            "Replaces a mesh in all objects that have it; the rest as in add_mesh.")
        .def(
            "set_occluders",
            [](PyWorld& world, MeshHandle mesh, const std::vector<FoundOccluder>& occluders) {
                value_of(world.change([&](World& w) { return w.set_occluders(mesh, occluders); }));
            },
            py::arg("mesh"), py::arg("occluders"),
            "Gives a mesh occluders of yours, a list of Occluder, in place of those that add_mesh finds. None: it "
            "hides "
            "nothing. Replacing the mesh or its vertices removes them.")
        .def(
            "set_vertices",
            [](PyWorld& world, MeshHandle mesh, const py::handle& positions) {
                const MeshArrays arrays(positions, py::none());
                value_of(world.change([&](World& w) { return w.set_vertices(mesh, arrays.points()); }));
            },
            py::arg("mesh"), py::arg("positions"), "Replaces the mesh's positions by as many others.")
        .def(
            "add_node",
            [](PyWorld& world, const py::object& parent, const py::object& transform, std::uint32_t layers) {
                NodeDescription description;
                description.parent = handle_or_null<NodeHandle>(parent, "parent");
                if (!transform.is_none()) description.transform = transform_of(transform, "transform");
                description.layers = layers;
                return value_of(world.change([&](World& w) { return w.add_node(description); }));
            },
            py::arg("parent") = py::none(), py::arg("transform") = py::none(), py::arg("layers") = ~0u)
        .def("add", &add, py::kw_only(), py::arg("mesh") = py::none(), py::arg("node") = py::none(),
             py::arg("transform") = py::none(), py::arg("box") = py::none(), py::arg("sphere") = py::none(),
             py::arg("aligned") = py::none(), py::arg("shape") = py::none(), py::arg("user") = 0,
             py::arg("layers") = ~0u, py::arg("collides_with") = ~0u, py::arg("occludes") = true,
             py::arg("only_occludes") = false, py::arg("hidden") = false,
             "Adds an object: a mesh, placed by `transform` under `node` or in the world; or a bound, which is a Box, "
             "a sphere (center, radius) or an aligned box (low, high); or a Shape, alone or with one of them. "
             "`only_occludes`: no answer contains it, but its mesh's occluders hide others. `hidden`: no answer "
             "contains it until set_hidden shows it.")
        .def(
            "set_bound",
            [](PyWorld& world, ObjectHandle object, const py::object& box, const py::object& sphere,
               const py::object& aligned) {
                const Bound bound = bound_of(box, sphere, aligned);
                value_of(world.change([&](World& w) { return w.set_bound(object, bound); }));
            },
            py::arg("object"), py::kw_only(), py::arg("box") = py::none(), py::arg("sphere") = py::none(),
            py::arg("aligned") = py::none(), "Sets the bound of an object that was added with one; see also set_boxes.")
        .def(
            "set_mesh",
            [](PyWorld& world, const py::object& objects, MeshHandle mesh) {
                for_objects(world, objects, [mesh](World& w, ObjectHandle handle) { return w.set_mesh(handle, mesh); });
            },
            py::arg("objects"), py::arg("mesh"),
            "Sets the mesh of objects that have one. Bad items as in set_transforms.")
        .def(
            "set_user",
            [](PyWorld& world, ObjectHandle object, std::uint64_t user) {
                value_of(world.change([&](World& w) { return w.set_user(object, user); }));
            },
            py::arg("object"), py::arg("user"), "Sets the number that answers return with the object.")
        .def(
            "set_collides_with",
            [](PyWorld& world, const py::object& objects, std::uint32_t layers) {
                for_objects(world, objects,
                            [layers](World& w, ObjectHandle handle) { return w.set_collides_with(handle, layers); });
            },
            py::arg("objects"), py::arg("layers"),
            "Sets the layers that the objects collide with. Bad items as in set_transforms.")
        .def(
            "set_occludes",
            [](PyWorld& world, const py::object& objects, bool occludes) {
                for_objects(world, objects,
                            [occludes](World& w, ObjectHandle handle) { return w.set_occludes(handle, occludes); });
            },
            py::arg("objects"), py::arg("occludes"),
            "Sets whether objects with a mesh hide others; not transparent ones. Bad items as in set_transforms.")
        .def(
            "set_parent",
            [](PyWorld& world, NodeHandle node, const py::object& parent) {
                const auto above = handle_or_null<NodeHandle>(parent, "parent");
                value_of(world.change([&](World& w) { return w.set_parent(node, above); }));
            },
            py::arg("node"), py::arg("parent"),
            "Moves a node below another, or with None to the top. Error: the parent is the node itself or one below "
            "it.")
        .def("set_shape", &set_shape, py::arg("object"), py::arg("shape"),
             "Gives an object a Shape, which queries and contacts use instead of its mesh or bound. None removes it.")
        .def(
            "reserve",
            [](PyWorld& to, std::size_t objects) {
                value_of(to.change([&](World& world) { return world.reserve(objects); }));
            },
            py::arg("objects"),
            "Takes memory for so many objects in all, so that none is copied to larger memory later.")
        .def("add_boxes", &add_boxes, py::arg("boxes"), py::kw_only(), py::arg("users") = py::none(),
             py::arg("layers") = ~0u, py::arg("collides_with") = ~0u,
             "Adds one object per box, all or none. Returns an array of handle_dtype.")
        .def("add_instances", &add_instances, py::arg("mesh"), py::arg("transforms"), py::kw_only(),
             py::arg("users") = py::none(), py::arg("layers") = ~0u, py::arg("collides_with") = ~0u,
             "Adds one object of the mesh per matrix, shape (n, 4, 4), all or none.")
        .def(
            "remove",
            [](PyWorld& world, NodeHandle node) { value_of(world.change([&](World& w) { return w.remove(node); })); },
            py::arg("node"), "Removes a node with all nodes and objects below it.")
        .def(
            "remove",
            [](PyWorld& world, MeshHandle mesh) { value_of(world.change([&](World& w) { return w.remove(mesh); })); },
            py::arg("mesh"), "Removes a mesh. Error: objects use it.")
        .def(
            "remove",
            [](PyWorld& world, const py::object& objects) {
                for_objects(world, objects, [](World& w, ObjectHandle handle) { return w.remove(handle); });
            },
            py::arg("objects"),
            "Removes one object or many. Stale handles are refused, the others are removed, and the error names the "
            "first refused.")
        .def("set_transform", &set_transform<ObjectHandle>, py::arg("handle"), py::arg("transform"))
        .def("set_transform", &set_transform<NodeHandle>, py::arg("handle"), py::arg("transform"))
        .def("set_transforms", &set_transforms<ObjectHandle>, py::arg("objects"), py::arg("transforms"),
             "Moves objects that have a mesh. Bad items are refused, the others change, and the error names the first "
             "refused.")
        .def("set_node_transforms", &set_transforms<NodeHandle>, py::arg("nodes"), py::arg("transforms"),
             "As set_transforms.")
        .def("set_boxes", &set_boxes, py::arg("objects"), py::arg("boxes"),
             "Sets the bounds of objects that were added with a bound; they become boxes. Bad items as in "
             "set_transforms.")
        .def(
            "set_hidden",
            [](PyWorld& world, const py::object& objects, bool hidden) {
                for_objects(world, objects,
                            [hidden](World& w, ObjectHandle handle) { return w.set_hidden(handle, hidden); });
            },
            py::arg("objects"), py::arg("hidden"),
            "Hides or shows objects. Hidden objects are in no answer. Bad items as in set_transforms.")
        .def(
            "set_layers",
            [](PyWorld& world, NodeHandle node, std::uint32_t layers) {
                value_of(world.change([&](World& w) { return w.set_layers(node, layers); }));
            },
            py::arg("node"), py::arg("layers"),
            "Sets a node's layers. Objects below it have only those of their layers that are also in these.")
        .def(
            "set_layers",
            [](PyWorld& world, const py::object& objects, std::uint32_t layers) {
                for_objects(world, objects,
                            [layers](World& w, ObjectHandle handle) { return w.set_layers(handle, layers); });
            },
            py::arg("objects"), py::arg("layers"),
            "Sets the objects' layers, 32 bits each. Bad items as in set_transforms.")
        .def(
            "update",
            [](PyWorld& world) {
                const auto threads = executor();
                value_of(world.change([&](World& w) {
                    auto done = w.update(*threads);
                    world.forget_replaced();
                    return done;
                }));
            },
            "Applies all changes since the last call. Call it once a frame. Error: more than `max_pairs` pairs; the "
            "World then has no pairs, and all else is up to date.")
        .def_property_readonly("statistics", [](const PyWorld& world) {
            const WorldStatistics s = world.ask([](const World& w) { return w.statistics(); });
            py::dict d;
            d["objects"] = s.objects;
            d["resting"] = s.resting;
            d["moving"] = s.moving;
            d["boxes_changed"] = s.boxes_changed;
            d["out_of_range"] = s.out_of_range;
            d["box_pairs_tested"] = s.box_pairs_tested;
            d["contact_pairs_tested"] = s.contact_pairs_tested;
            d["occluders_waiting"] = s.occluders_waiting;
            return d;
        });
}

}  // namespace crofton::python
