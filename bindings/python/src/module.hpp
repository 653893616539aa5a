// SPDX-License-Identifier: MIT
// The parts of the extension module.
#pragma once
#include <pybind11/pybind11.h>

namespace crofton::python {

void bind_geometry(pybind11::module_& module);  // Box, Camera, Frustum
void bind_measure(pybind11::module_& module);
void bind_fit(pybind11::module_& module);
void bind_triangulate(pybind11::module_& module);
void bind_cull(pybind11::module_& module);
void bind_depth(pybind11::module_& module);
void bind_collide(pybind11::module_& module);
void bind_mesh(pybind11::module_& module);
void bind_shape(pybind11::module_& module);
void bind_load(pybind11::module_& module);
void bind_view_requests(pybind11::module_& module);  // ViewRequest and its parts
void bind_world(pybind11::module_& module);
void bind_pvs(pybind11::module_& module);

}  // namespace crofton::python
