// SPDX-License-Identifier: MIT
#include "world.hpp"

#include <pybind11/stl.h>

#include <cmath>

#include "module.hpp"

namespace crofton::python {
namespace {

template <class Tag>
void bind_handle(py::module_& module, const char* name) {
    using H = Handle<Tag>;
    py::class_<H>(module, name, "Names an object, node or mesh of a World. It is stale once that has been removed.")
        .def(py::init([](std::uint32_t index, std::uint32_t generation) {
                 return H{index, generation};
             }),
             py::arg("index"), py::arg("generation"))
        .def_readonly("index", &H::index)
        .def_readonly("generation", &H::generation)
        .def("__eq__", [](const H& a, const H& b) { return a == b; })
        .def("__eq__", [](const H&, const py::object&) { return false; })
        .def("__hash__", [](const H& h) { return py::hash(py::make_tuple(h.index, h.generation)); })
        .def("__repr__", [name = std::string(name)](const H& h) {
            return name + "(index=" + std::to_string(h.index) + ", generation=" + std::to_string(h.generation) + ")";
        });
}

boxtree::Orientation orientation_of(const std::string& name) {
    using boxtree::Orientation;
    return choice_of<Orientation>("tree", name,
                                  {{"aligned", Orientation::aligned},
                                   {"oriented", Orientation::oriented},
                                   {"automatic", Orientation::automatic}});
}

}  // namespace

void bind_world(py::module_& module) {
    bind_handle<ObjectTag>(module, "ObjectHandle");
    bind_handle<NodeTag>(module, "NodeHandle");
    bind_handle<MeshTag>(module, "MeshHandle");
    bind_handle<RegionTag>(module, "RegionHandle");
    py::class_<PyWorld> type(
        module, "World",
        "A set of objects. Add and move them, call update() once a frame, then ask what a camera sees, what a ray hits "
        "and what touches what. Changes take effect at the next update(). May be used from several threads.");
    type.def(
        py::init([](bool pairs, bool contacts, bool containment, double contact_margin, bool mesh_depth,
                    std::size_t max_pairs, std::uint32_t updates_to_rest, const std::string& tree,
                    std::optional<std::size_t> rebuild_budget) {
            if (!(contact_margin >= 0.0 && std::isfinite(contact_margin)))
                raise({ErrorCode::out_of_range, kNoItem, "contact_margin: a finite number from 0 on is expected"});
            return std::make_unique<PyWorld>(WorldOptions{.pairs = pairs,
                                                          .contacts = contacts,
                                                          .containment = containment,
                                                          .contact_margin = contact_margin,
                                                          .mesh_depth = mesh_depth,
                                                          .max_pairs = max_pairs,
                                                          .rebuild_budget = rebuild_budget.value_or(kAutomatic),
                                                          .updates_to_rest = updates_to_rest,
                                                          .tree = orientation_of(tree)});
        }),
        py::kw_only(), py::arg("pairs") = true, py::arg("contacts") = true, py::arg("containment") = true,
        py::arg("contact_margin") = 0.0, py::arg("mesh_depth") = false, py::arg("max_pairs") = WorldOptions{}.max_pairs,
        py::arg("updates_to_rest") = 16, py::arg("tree") = "aligned", py::arg("rebuild_budget") = py::none(),
        "`contact_margin`: gaps up to this between shapes are contacts. `mesh_depth`: contacts between meshes have "
        "a depth, which takes longer than finding them. `rebuild_budget`: items' worth of background work on the tree "
        "in each update, None for as many as are good.");
    type.def("__repr__", [](const PyWorld& world) {
        return format("World(%zu objects)", world.ask([](const World& w) { return w.object_count(); }));
    });
    bind_world_changes(module, type);
    bind_world_views(module, type);
    bind_world_queries(module, type);
    bind_world_contacts(module, type);
    bind_world_regions(module, type);
}

}  // namespace crofton::python
