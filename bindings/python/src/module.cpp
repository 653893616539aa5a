// SPDX-License-Identifier: MIT
// The extension module behind the package `crofton`.
#include "module.hpp"

#include <crofton/core/version.hpp>
#include <mutex>
#include <string>
#include <thread>

#include "convert.hpp"

namespace crofton::python {
namespace {

std::mutex pool_mutex;
std::shared_ptr<Executor> pool;

void set_threads(unsigned threads) {
    if (threads == 0) threads = (std::max)(1u, std::thread::hardware_concurrency());
    std::shared_ptr<Executor> made = threads == 1 ? nullptr : std::make_shared<ThreadPool>(threads);
    const py::gil_scoped_release release;  // the old pool may have work
    const std::lock_guard lock(pool_mutex);
    pool.swap(made);
}

}  // namespace

std::shared_ptr<Executor> executor() {
    const std::lock_guard lock(pool_mutex);
    return pool ? pool : std::shared_ptr<Executor>(&serial_executor(), [](Executor*) {});
}

}  // namespace crofton::python

PYBIND11_MODULE(_crofton, module) {
    using namespace crofton::python;
    module.attr("__version__") = std::to_string(CROFTON_VERSION_MAJOR) + "." + std::to_string(CROFTON_VERSION_MINOR) +
                                 "." + std::to_string(CROFTON_VERSION_PATCH);
    module.attr("Error") = py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc("crofton.Error",
                                  "Raised for bad data. `code` is a short name such as 'not_finite'; `item` is the "
                                  "index of the offending input, or None.",
                                  PyExc_ValueError, nullptr));
    module.attr("box_dtype") = box_dtype();
    module.attr("handle_dtype") = handle_dtype();
    module.def("set_threads", &set_threads, py::arg("threads"),
               "Sets how many threads calls may use; 0 means one for each of the machine's. The default is 1.");
    bind_geometry(module);
    bind_measure(module);
    bind_fit(module);
    bind_triangulate(module);
    bind_cull(module);
    bind_depth(module);
    bind_collide(module);
    bind_mesh(module);
    bind_shape(module);
    bind_load(module);
    bind_view_requests(module);
    bind_world(module);
    bind_pvs(module);
}
