// SPDX-License-Identifier: MIT
// What a view of a World sees.
#include <pybind11/stl.h>

#include "view.hpp"
#include "world.hpp"

namespace crofton::python {
namespace {

// What a view saw. Its arrays are made when the view is, so that the World may change afterwards.
struct Seen {
    py::array_t<std::uint32_t> ids, occluded_ids;
    py::array_t<std::uint64_t> users;
    py::array_t<std::uint8_t> verdicts;
    py::array handles;
    py::object depth = py::none();
    cull::Statistics statistics;
    OcclusionStatistics occlusion;
};

Seen view(const PyWorld& python_world, const py::handle& given, std::uint32_t layers, bool conservative, bool occlusion,
          std::pair<std::uint32_t, std::uint32_t> size) {
    const bool is_camera = py::isinstance<Camera>(given);
    if (occlusion && !is_camera) raise_type("view: with occlusion a Camera is expected");
    ViewRequest request{.layers = layers, .mode = conservative ? cull::CullMode::conservative : cull::CullMode::exact};
    if (occlusion) {
        request.camera = given.cast<Camera>();
        request.occlusion = OcclusionOptions{.size = {size.first, size.second}, .list_occluded = true};
    } else {
        request.volume = view_of(given, layers).frustum;
    }
    ViewResult visible;
    std::vector<ObjectHandle> handles;
    std::vector<std::uint64_t> users;
    std::vector<float> nearness;
    const auto threads = executor();
    value_of(python_world.ask([&](const World& world) -> Result<void> {
        if (auto found = world.view(request, visible, *threads); !found) return found;
        if (occlusion) {
            if (const auto* buffer = visible.occlusion_buffer()) {
                nearness.resize(std::size_t{buffer->size().width} * buffer->size().height);
                buffer->read(nearness);
            }
        }
        for (std::size_t i = 0; i < visible.size(); ++i) {
            handles.push_back(visible[i].object);
            users.push_back(visible[i].user);
        }
        return {};
    }));
    Seen result;
    result.ids = array_of<std::uint32_t>(visible.ids());
    result.occluded_ids = array_of<std::uint32_t>(visible.occluded_ids());
    result.users = array_of<std::uint64_t>(users);
    result.verdicts = array_of<std::uint8_t>(visible.verdicts());
    result.handles = handles_of(handles);
    result.statistics = visible.statistics();
    result.occlusion = visible.occlusion_statistics();
    if (!nearness.empty())
        result.depth = array_of<float>(nearness).reshape({py::ssize_t{size.second}, py::ssize_t{size.first}});
    return result;
}

}  // namespace

void bind_world_views(py::module_& module, py::class_<PyWorld>& type) {
    py::class_<Seen>(module, "Visible", "What a view saw, as of the update before.")
        .def_readonly("ids", &Seen::ids, "the objects' indices, ascending")
        .def_readonly("handles", &Seen::handles, "their handles, an array of handle_dtype")
        .def_readonly("users", &Seen::users, "their user numbers")
        .def_readonly("verdicts", &Seen::verdicts, "STRADDLING or INSIDE for each")
        .def_readonly("occluded_ids", &Seen::occluded_ids, "in the view's frustum, and hidden by others")
        .def_readonly("depth", &Seen::depth,
                      "the depth buffer, (height, width), the bottom row first, larger is nearer; or None")
        .def_property_readonly("statistics",
                               [](const Seen& s) {
                                   py::dict d;
                                   d["nodes_tested"] = s.statistics.nodes_tested;
                                   d["boxes_tested"] = s.statistics.boxes_tested;
                                   d["straddling"] = s.statistics.straddling;
                                   d["occluders_drawn"] = s.occlusion.occluders_drawn;
                                   return d;
                               })
        .def("__len__", [](const Seen& s) { return s.ids.size(); })
        .def("__repr__", [](const Seen& s) { return format("Visible(%d objects)", static_cast<int>(s.ids.size())); });
    type.def("view", &view, py::arg("view"), py::kw_only(), py::arg("layers") = ~0u, py::arg("conservative") = false,
             py::arg("occlusion") = false, py::arg("size") = std::pair<std::uint32_t, std::uint32_t>(480, 270),
             "What a Camera or a Frustum sees. With occlusion, what others hide is left out; `size` is that of its "
             "depth "
             "buffer, (width, height).");
}

}  // namespace crofton::python
