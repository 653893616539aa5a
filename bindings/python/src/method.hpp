// SPDX-License-Identifier: MIT
// Methods that Python calls by vectorcall: pybind11's dispatcher would take most of a small query's time.
#pragma once
#include <array>
#include <new>
#include <string>

#include "convert.hpp"

namespace crofton::python {

// The arguments of a call in the order of `names`, None for those that are left out. The first `by_place` may come by
// place.
template <std::size_t N>
[[nodiscard]] std::array<py::handle, N> arguments_of(const char* function, const std::array<const char*, N>& names,
                                                     Py_ssize_t by_place, PyObject* const* values, Py_ssize_t count,
                                                     PyObject* keywords) {
    if (count > by_place)
        raise_type(std::string(function) + ": at most " + std::to_string(by_place) + " arguments come without a name");
    std::array<py::handle, N> all;
    all.fill(Py_None);
    for (Py_ssize_t i = 0; i < count; ++i) all[static_cast<std::size_t>(i)] = values[i];
    const Py_ssize_t named = keywords ? PyTuple_GET_SIZE(keywords) : 0;
    for (Py_ssize_t i = 0; i < named; ++i) {
        PyObject* const name = PyTuple_GET_ITEM(keywords, i);
        std::size_t k = 0;
        while (k < N && PyUnicode_CompareWithASCIIString(name, names[k]) != 0) ++k;
        if (k == N) raise_type(std::string(function) + ": unknown argument " + py::cast<std::string>(py::handle(name)));
        if (k < static_cast<std::size_t>(count))
            raise_type(std::string(function) + ": the " + names[k] + " is given twice");
        all[k] = values[count + i];
    }
    return all;
}

// Calls f with the C++ object of `self`; exceptions become Python's.
template <class T, class F>
PyObject* call_method(PyObject* self, F&& f) {
    try {
        const T* const object = as<T>(self);
        if (!object) raise_type("another object is expected");
        return f(*object).release().ptr();
    } catch (py::error_already_set& error) {
        error.restore();
    } catch (const py::builtin_exception& error) {
        error.set_error();
    } catch (const std::bad_alloc&) {
        PyErr_NoMemory();
    } catch (const std::exception& error) {
        PyErr_SetString(PyExc_RuntimeError, error.what());
    }
    return nullptr;
}

using Method = PyObject* (*)(PyObject* self, PyObject* const* values, Py_ssize_t count, PyObject* keywords);
// `text` begins with the signature, as Python's own methods have it. Texts are to live as long as the program.
inline void add_method(const py::object& type, const char* name, Method method, const char* text) {
    // Never freed: the class refers to it.
    auto* const made = new PyMethodDef{name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(method)),
                                       METH_FASTCALL | METH_KEYWORDS, text};
    type.attr(name) =
        py::reinterpret_steal<py::object>(PyDescr_NewMethod(reinterpret_cast<PyTypeObject*>(type.ptr()), made));
}

}  // namespace crofton::python
