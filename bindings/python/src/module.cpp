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

// Objects of the library are not pickled, and what has no constructor is made by calls alone. Left to itself, pybind11
// ends the interpreter for pickle's protocols 0 and 1, and __new__ gives an object of uninitialised memory.
void refuse_copies(const py::module_& module) {
    for (const auto& [key, value] : module.attr("__dict__").cast<py::dict>()) {
        if (!PyType_Check(value.ptr()) || PyExceptionClass_Check(value.ptr())) continue;
        const std::string name = py::str(key);
        for (const char* const reduce : {"__reduce__", "__reduce_ex__"})
            value.attr(reduce) =
                py::cpp_function([name](const py::object&,
                                        const py::args&) { raise_type("cannot pickle 'crofton." + name + "' object"); },
                                 py::is_method(value));
        // Where __new__ alone made an object, pybind11 calls this for its memory, and would then read that.
        py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr()))->operator_new =
            [](std::size_t) -> void* { raise_type("the object has no value: its __init__ was not called"); };
        // Where there is no py::init, __init__ is the slot of pybind11's base.
        if (Py_TYPE(value.attr("__init__").ptr()) == &PyWrapperDescr_Type)
            value.attr("__new__") = py::cpp_function([name](const py::args&, const py::kwargs&) {
                raise_type("crofton." + name + " has no constructor: calls return it");
            });
    }
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
    refuse_copies(module);
    // Translates the exception of an argument that pybind11 shares, such as a mesh.
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const py::cast_error&) {
            PyErr_SetString(PyExc_TypeError, "an argument is of another type, or its __init__ was not called");
        }
    });
}
