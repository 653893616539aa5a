// SPDX-License-Identifier: MIT
// What views of a World see.
#include <pybind11/stl.h>

#include <array>
#include <utility>

#include "method.hpp"
#include "views.hpp"
#include "world.hpp"

namespace crofton::python {
namespace {

struct TriangleRecord {
    std::uint32_t object, cluster;
    std::uint64_t triangles;
};
static_assert(sizeof(TriangleRecord) == sizeof(depth::VisibleCluster));

// An array over memory of `owner`.
py::array array_in(const py::object& owner, const py::dtype& dtype, const void* first, std::size_t count,
                   std::size_t stride) {
    return py::array(dtype, py::array::ShapeContainer{static_cast<py::ssize_t>(count)},
                     py::array::StridesContainer{static_cast<py::ssize_t>(stride)}, first, owner);
}
template <class T, class Values>
py::array array_in(const py::object& owner, const Values& values) {
    return array_in(owner, py::dtype::of<T>(), values.data(), values.size(), sizeof(T));
}

template <class Result>
py::array ids_of(const py::object& self) {
    return array_in<std::uint32_t>(self, self.cast<const Seen<Result>&>().found().ids());
}
template <class Result>
py::array handles_seen(const py::object& self) {
    const auto& objects = self.cast<const Seen<Result>&>().answer().objects;
    static_assert(offsetof(ObjectRef, object) == 0);
    return array_in(self, handle_dtype(), objects.data(), objects.size(), sizeof(ObjectRef));
}
template <class Result>
py::array users_seen(const py::object& self) {
    const auto& objects = self.cast<const Seen<Result>&>().answer().objects;
    const void* const first = objects.empty() ? nullptr : &objects.data()->user;
    return array_in(self, py::dtype::of<std::uint64_t>(), first, objects.size(), sizeof(ObjectRef));
}

py::object depth_of(const occlude::OcclusionBuffer* buffer) {
    if (!buffer) return py::none();
    py::array_t<float> result({py::ssize_t{buffer->size().height}, py::ssize_t{buffer->size().width}});
    buffer->read({result.mutable_data(), static_cast<std::size_t>(result.size())});
    return std::move(result);
}

void check_view(const SeenByMany& seen, std::size_t view) {
    if (view >= seen.found().view_count()) raise({ErrorCode::out_of_range, view, "view: there are fewer views"});
}

py::dict statistics_of(const SeenByOne& seen) {
    const cull::Statistics& s = seen.found().statistics();
    const OcclusionStatistics o = seen.found().occlusion_statistics();
    const depth::DepthStatistics p = seen.found().picture_statistics();
    py::dict d;
    d["nodes_tested"] = s.nodes_tested;
    d["boxes_tested"] = s.boxes_tested;
    d["straddling"] = s.straddling;
    d["occluders_drawn"] = o.occluders_drawn;
    d["triangles_drawn"] = p.triangles_drawn;
    d["triangles_listed"] = p.triangles_listed;
    return d;
}

SeenByOne view_one(const PyWorld& python_world, const ViewRequest& request) {
    SeenByOne seen(python_world.pools(), python_world.pools()->one);
    const auto threads = executor();
    value_of(python_world.ask([&](const World& world) -> Result<void> {
        if (auto found = world.view(request, seen.answer().found, *threads); !found) return found;
        seen.look_up();
        return {};
    }));
    return seen;
}

SeenByMany view_many(const PyWorld& python_world, const py::sequence& given) {
    std::vector<std::shared_ptr<HeldRequest>> held;
    std::vector<ViewRequest> requests;
    for (const py::object one : given) {  // held: reading a request may change the list
        if (py::isinstance<HeldRequest>(one)) {
            held.push_back(one.cast<std::shared_ptr<HeldRequest>>());
        } else {
            const py::none none;
            held.push_back(std::make_shared<HeldRequest>());
            read_request({one, none, none, none, none, none, none, none, none, none, none}, *held.back());
        }
        requests.push_back(held.back()->request);
    }
    SeenByMany seen(python_world.pools(), python_world.pools()->many);
    const auto threads = executor();
    value_of(python_world.ask([&](const World& world) -> Result<void> {
        Answer<MultiViewResult>& answer = seen.answer();
        if (auto found = world.view(std::span<const ViewRequest>(requests), answer.found, *threads); !found)
            return found;
        seen.look_up();
        answer.view_masks.clear();
        for (std::size_t i = 0; i < answer.found.size(); ++i) answer.view_masks.push_back(answer.found.view_mask(i));
        return {};
    }));
    return seen;
}

py::object view(const PyWorld& world, const RequestArguments& given) {
    PyObject* const camera = given.camera.ptr();
    if (exactly<Camera>(camera) == nullptr) {  // the usual case
        const bool is_list = PyList_Check(camera) || PyTuple_Check(camera);
        const HeldRequest* const request = is_list ? nullptr : as<HeldRequest>(given.camera);
        if (is_list || request)
            if (const char* name = given.first_given())
                raise_type(std::string(name) + ": a ViewRequest holds its own options; set it there");
        if (is_list) return py::cast(view_many(world, py::reinterpret_borrow<py::sequence>(given.camera)));
        if (request) return py::cast(view_one(world, request->request));
    }
    HeldRequest held;
    read_request(given, held);
    return py::cast(view_one(world, held.request));
}

constexpr std::array kArguments = {"camera",    "matrix", "volume",     "layers", "occlusion",   "picture",
                                   "receivers", "limits", "candidates", "order",  "conservative"};

PyObject* view_method(PyObject* self, PyObject* const* values, Py_ssize_t count, PyObject* names) {
    return call_method<PyWorld>(self, [&](const PyWorld& world) {
        const auto all = arguments_of("view", kArguments, 1, values, count, names);
        return view(world, {all[0], all[1], all[2], all[3], all[4], all[5], all[6], all[7], all[8], all[9], all[10]});
    });
}

constexpr const char* kViewText =
    "view($self, camera=None, *, matrix=None, volume=None, layers=None, occlusion=None, picture=None, "
    "receivers=None, limits=None, candidates=None, order=None, conservative=None)\n--\n\n"
    "Returns what a Camera, a ViewMatrix or any Frustum (`volume`) sees of the objects in `layers`. `occlusion` "
    "(OcclusionOptions or True) leaves out what other objects hide. `picture` (a PictureView) lists the triangles that "
    "the picture needs; with `receivers` (ShadowReceivers) it is a light's shadow map, and only the triangles are "
    "listed "
    "whose shadows the camera could see. `limits` (DrawLimits) leaves out objects that are small or far. `candidates` "
    "(bools by object "
    "index) leaves out all others, except those that are new or have moved. `order` is 'ascending' or 'tree', which is "
    "faster. `conservative` tests planes only. Pass a ViewRequest alone, or a list of up to 32 for a MultiViewResult. "
    "Arguments that cannot be obeyed are refused.";

void bind_one(py::module_& module) {
    py::class_<SeenByOne>(module, "ViewResult", "The result of World.view.")
        .def_property_readonly("ids", &ids_of<ViewResult>, "the objects' indices, in the order of the request")
        .def_property_readonly("handles", &handles_seen<ViewResult>, "their handles, an array of handle_dtype")
        .def_property_readonly("users", &users_seen<ViewResult>, "their user numbers")
        .def_property_readonly(
            "verdicts",
            [](const py::object& self) {
                return array_in<std::uint8_t>(self, self.cast<const SeenByOne&>().found().verdicts());
            },
            "STRADDLING or INSIDE for each; empty in tree order")
        .def_property_readonly(
            "inside_count", [](const SeenByOne& seen) { return seen.found().inside_count(); },
            "how many are INSIDE; in tree order they come first")
        .def_property_readonly(
            "occluded_ids",
            [](const py::object& self) {
                return array_in<std::uint32_t>(self, self.cast<const SeenByOne&>().found().occluded_ids());
            },
            "indices of objects in the view's frustum that others hide; with OcclusionOptions(list_occluded=True)")
        .def_property_readonly(
            "depth", [](const SeenByOne& seen) { return depth_of(seen.found().occlusion_buffer()); },
            "the depth buffer, (height, width), the bottom row first, larger is nearer; None without occlusion")
        .def_property_readonly(
            "triangles",
            [](const py::object& self) {
                return array_in<TriangleRecord>(self, self.cast<const SeenByOne&>().found().triangles());
            },
            "what to draw, for a view with a picture: an array of records. Bit k of `triangles` stands for triangle "
            "first_triangle + k of cluster `cluster` (World.clusters_of) of object index `object`")
        .def_property_readonly("statistics", &statistics_of)
        .def("__len__", [](const SeenByOne& seen) { return seen.found().size(); })
        .def("__repr__", [](const SeenByOne& seen) {
            return format("ViewResult(%d objects)", static_cast<int>(seen.found().size()));
        });
}

void bind_many(py::module_& module) {
    py::class_<SeenByMany>(module, "MultiViewResult",
                           "The result of World.view for several views. It lists each object once.")
        .def_property_readonly("ids", &ids_of<MultiViewResult>, "the objects' indices")
        .def_property_readonly("handles", &handles_seen<MultiViewResult>, "their handles, an array of handle_dtype")
        .def_property_readonly("users", &users_seen<MultiViewResult>, "their user numbers")
        .def_property_readonly(
            "view_masks",
            [](const py::object& self) {
                return array_in<std::uint32_t>(self, self.cast<const SeenByMany&>().answer().view_masks);
            },
            "one mask per object; bit v is set if view v sees it")
        .def_property_readonly("view_count", [](const SeenByMany& seen) { return seen.found().view_count(); })
        .def(
            "depth",
            [](const SeenByMany& seen, std::size_t view) {
                check_view(seen, view);
                return depth_of(seen.found().occlusion_buffer(view));
            },
            py::arg("view"), "Returns the depth buffer of one view, or None without occlusion.")
        .def(
            "triangles",
            [](const py::object& self, std::size_t view) {
                const auto& seen = self.cast<const SeenByMany&>();
                check_view(seen, view);
                return array_in<TriangleRecord>(self, seen.found().triangles(view));
            },
            py::arg("view"),
            "Returns the triangles to draw in one view, as ViewResult.triangles; empty without a picture.")
        .def(
            "occluded_ids",
            [](const py::object& self, std::size_t view) {
                const auto& seen = self.cast<const SeenByMany&>();
                check_view(seen, view);
                return array_in<std::uint32_t>(self, seen.found().occluded_ids(view));
            },
            py::arg("view"), "Returns the occluded objects of one view, as ViewResult.occluded_ids.")
        .def(
            "occluders_drawn",
            [](const SeenByMany& seen, std::size_t view) {
                check_view(seen, view);
                return seen.found().occlusion_statistics(view).occluders_drawn;
            },
            py::arg("view"), "Returns how many occluders one view drew.")
        .def("__len__", [](const SeenByMany& seen) { return seen.found().size(); })
        .def("__repr__", [](const SeenByMany& seen) {
            return format("MultiViewResult(%d objects, %d views)", static_cast<int>(seen.found().size()),
                          static_cast<int>(seen.found().view_count()));
        });
}

}  // namespace

void bind_world_views(py::module_& module, py::class_<PyWorld>& type) {
    PYBIND11_NUMPY_DTYPE(TriangleRecord, object, cluster, triangles);
    bind_one(module);
    bind_many(module);
    add_method(type, "view", &view_method, kViewText);
    py::class_<OccluderRef>(module, "OccluderRef", "An object that hides others.")
        .def_readonly("object", &OccluderRef::object)
        .def_readonly("user", &OccluderRef::user)
        .def_readonly("place", &OccluderRef::place, "which of its mesh's occluders")
        .def("__repr__", [](const OccluderRef& r) {
            return format("OccluderRef(user=%llu, place=%u)", static_cast<unsigned long long>(r.user), r.place);
        });
    type.def(
        "hidden_by",
        [](const PyWorld& world, const SeenByOne& seen, const std::optional<ObjectHandle>& object) {
            Vector<OccluderRef> occluders;
            value_of(world.ask([&](const World& w) {
                return object ? w.hidden_by(*object, seen.found(), occluders)
                              : w.drawn_occluders(seen.found(), occluders);
            }));
            py::list result;
            for (const OccluderRef& one : occluders) result.append(one);
            return result;
        },
        py::arg("seen"), py::arg("object") = py::none(),
        "Returns the occluders that hide an object in a view with occlusion; without an object all that it drew. Call "
        "it "
        "before the next update.");
    type.def(
        "clusters_of",
        [](const PyWorld& world, MeshHandle mesh) {
            return world.ask([&](const World& w) -> std::shared_ptr<depth::ClusteredMesh> {
                if (!w.contains(mesh))
                    raise({ErrorCode::stale_handle, mesh.index,
                           "mesh: the handle is stale: the mesh was removed, or is of another World"});
                const depth::ClusteredMesh* const cut = w.clusters_of(mesh);
                if (cut == nullptr) return nullptr;
                // Copies the positions: the World that owns them may be destroyed before the clusters.
                auto copy = std::make_shared<depth::ClusteredMesh>(*cut);
                copy->keep_copy();
                return copy;
            });
        },
        py::arg("mesh"),
        "Returns the clusters of a mesh as of the last update: a ClusteredMesh, or None for a mesh without clusters.");
}

}  // namespace crofton::python
