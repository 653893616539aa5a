// SPDX-License-Identifier: MIT
#include "convert.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace crofton::python {
namespace {

// An array of numbers (bool, complex and objects are not), whatever its layout and byte order.
py::array numbers(const py::handle& given, const char* name) {
    const py::array array = py::array::ensure(given);
    if (!array) PyErr_Clear();
    const char kind = array ? array.dtype().kind() : 'O';
    if (kind != 'f' && kind != 'i' && kind != 'u')
        raise_type(std::string(name) + ": an array of real numbers is expected");
    return array;
}

template <class T>
py::array contiguous(const py::array& array) {
    constexpr int kLayout = py::array::c_style | py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
    const auto result = py::array_t<T, kLayout>::ensure(array);
    if (!result) throw py::error_already_set();
    return result;
}

bool has_layout(const py::array& array, const py::dtype& dtype) {
    const py::dtype own = array.dtype();
    return (own.is(dtype) || own.equal(dtype)) && (array.flags() & py::array::c_style) != 0 &&
           (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

// A copy of `values` as records of `dtype`.
template <class T>
py::array record_array(const py::dtype& dtype, std::span<const T> values) {
    py::array result(dtype, py::array::ShapeContainer{static_cast<py::ssize_t>(values.size())});
    if (!values.empty()) std::memcpy(result.mutable_data(), values.data(), values.size_bytes());
    return result;
}

// A float, or an int that NumPy holds as one: what a conversion by NumPy yields, without the conversion.
bool read_number(PyObject* given, double& value) {
    if (PyFloat_Check(given)) {
        value = PyFloat_AS_DOUBLE(given);
        return true;
    }
    if (!PyLong_CheckExact(given)) return false;
    int overflow = 0;
    value = static_cast<double>(PyLong_AsLongLongAndOverflow(given, &overflow));
    return overflow == 0;
}

// Three numbers in a tuple, a list or an array of doubles: the usual ways. False for any other, which NumPy judges.
bool read_vector(const py::handle& given, glm::dvec3& vector) {
    PyObject* const p = given.ptr();
    if (PyTuple_CheckExact(p) && PyTuple_GET_SIZE(p) == 3)
        return read_number(PyTuple_GET_ITEM(p, 0), vector.x) && read_number(PyTuple_GET_ITEM(p, 1), vector.y) &&
               read_number(PyTuple_GET_ITEM(p, 2), vector.z);
    if (PyList_CheckExact(p) && PyList_GET_SIZE(p) == 3)
        return read_number(PyList_GET_ITEM(p, 0), vector.x) && read_number(PyList_GET_ITEM(p, 1), vector.y) &&
               read_number(PyList_GET_ITEM(p, 2), vector.z);
    if (!py::isinstance<py::array>(given)) return false;
    const auto array = py::reinterpret_borrow<py::array>(given);
    if (array.ndim() != 1 || array.size() != 3 || !has_layout(array, py::dtype::of<double>())) return false;
    const auto* const values = static_cast<const double*>(array.data());
    vector = {values[0], values[1], values[2]};
    return true;
}

py::array records(const py::handle& given, const py::dtype& dtype, const char* name, const char* what) {
    if (py::isinstance<py::array>(given))
        if (auto array = py::reinterpret_borrow<py::array>(given); has_layout(array, dtype)) return array;
    const py::array array = py::array::ensure(given);
    if (!array) PyErr_Clear();
    if (array && has_layout(array, dtype)) return array;
    if (!array || array.dtype().kind() != 'V' || !array.dtype().attr("newbyteorder")("=").equal(dtype))
        raise_type(std::string(name) + ": " + what + " is expected");
    return array.attr("astype")(dtype, py::arg("order") = "C", py::arg("copy") = true);
}

template <class T>
[[noreturn]] void raise_size(const char* name) {
    raise({ErrorCode::out_of_range, kNoItem,
           std::string(name) + ": a number is negative or too large for " + std::to_string(8 * sizeof(T)) + " bits"});
}

// A list of ints that NumPy takes for doubles, as some are beyond 2^63 and others are not.
template <class T>
py::array_t<T, py::array::c_style> integers_of_list(const py::handle& given, const char* name) {
    const bool is_list = py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given);
    std::vector<T> values;
    for (const py::handle one : is_list ? py::reinterpret_borrow<py::object>(given) : py::list()) {
        if (!PyLong_Check(one.ptr())) raise_type(std::string(name) + ": an array of integers is expected");
        const unsigned long long value = PyLong_AsUnsignedLongLong(one.ptr());
        if (PyErr_Occurred()) {
            PyErr_Clear();
            raise_size<T>(name);
        }
        if (value > std::numeric_limits<T>::max()) raise_size<T>(name);
        values.push_back(static_cast<T>(value));
    }
    if (values.empty()) raise_type(std::string(name) + ": an array of integers is expected");
    return array_of<T>(values);
}

void replace_all(std::string& text, std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
}

// The library's messages name C++ functions and options: in Python these have other names, or none.
std::string in_python(std::string_view message) {
    std::string text(message);
    constexpr std::pair<std::string_view, std::string_view> kNames[] = {
        {"the object is a bound: set_bound moves it", "the object is a box: set_boxes moves it"},
        {"the time budget is negative", "seconds is negative"},
        {"; holes are a material of cells", ""},
        {"; replace_mesh takes any number", "; for another number add another mesh"},
        {"convex_hull: ", "hull: "},
        {"find_occluders: ", "occluders: "},
        {"mass_properties: ", "mass: "},
        {"RegionOptions::", ""},
        {" (FileOptions::largest)", ""},
        {" (ReadLimits::pairs)", ""},
        {"World::", "World."},
        {"::", "."}};
    for (const auto& [what, by] : kNames) replace_all(text, what, by);
    return text;
}

}  // namespace

// Both also work within calls that have released the lock.
void raise(const Error& error) {
    const py::gil_scoped_acquire lock;
    if (error.code == ErrorCode::out_of_memory) {
        PyErr_SetString(PyExc_MemoryError, error.message.c_str());
        throw py::error_already_set();
    }
    const py::object type = py::module_::import("crofton._crofton").attr("Error");
    const std::string text = in_python(error.message);
    // A path in it may be no UTF-8.
    const auto message = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace"));
    if (!message) throw py::error_already_set();
    py::object instance = type(message);
    std::string code = to_string(error.code);
    std::replace(code.begin(), code.end(), ' ', '_');
    instance.attr("code") = code;
    instance.attr("item") = error.item == kNoItem ? py::object(py::none()) : py::object(py::int_(error.item));
    PyErr_SetObject(type.ptr(), instance.ptr());
    throw py::error_already_set();
}

void raise_type(const std::string& message) {
    const py::gil_scoped_acquire lock;
    PyErr_SetString(PyExc_TypeError, message.c_str());
    throw py::error_already_set();
}

template <int N>
Points<N>::Points(const py::handle& given, const char* name) : array_(numbers(given, name)) {
    if (array_.ndim() != 2 || array_.shape(1) != N)
        raise_type(std::string(name) + ": an array of shape (n, " + std::to_string(N) + ") is expected");
    is_float_ = array_.dtype().kind() == 'f' && array_.itemsize() == 4;
    const py::dtype wanted = is_float_ ? py::dtype::of<float>() : py::dtype::of<double>();
    if (!has_layout(array_, wanted)) array_ = is_float_ ? contiguous<float>(array_) : contiguous<double>(array_);
}
template class Points<2>;
template class Points<3>;

template <class T>
py::array_t<T, py::array::c_style> integers(const py::handle& given, const char* name) {
    const py::array array = numbers(given, name);
    if (array.dtype().kind() == 'f' && array.size() > 0) return integers_of_list<T>(given, name);
    const py::array flat = array.attr("ravel")();
    if (flat.dtype().equal(py::dtype::of<T>()) && has_layout(flat, py::dtype::of<T>()))
        return py::reinterpret_borrow<py::array_t<T, py::array::c_style>>(flat);
    py::array result = contiguous<T>(flat);
    if (!py::module_::import("numpy").attr("array_equal")(result, flat).cast<bool>()) raise_size<T>(name);
    return result;
}
template py::array_t<std::uint16_t, py::array::c_style> integers(const py::handle&, const char*);
template py::array_t<std::uint32_t, py::array::c_style> integers(const py::handle&, const char*);
template py::array_t<std::uint64_t, py::array::c_style> integers(const py::handle&, const char*);

const py::dtype& box_dtype() {
    static_assert(sizeof(Obb) == 72);
    static const py::dtype* const dtype = [] {  // never freed: the interpreter may end first
        const py::object make = py::module_::import("numpy").attr("dtype");
        return new py::dtype(
            py::list(py::make_tuple("center", "axes", "half_extents")),
            py::list(py::make_tuple(make(py::make_tuple("f8", 3)), make(py::make_tuple("f4", py::make_tuple(3, 3))),
                                    make(py::make_tuple("f4", 3)))),
            py::list(py::make_tuple(0, 24, 60)), 72);
    }();
    return *dtype;
}

const py::dtype& handle_dtype() {
    static_assert(sizeof(ObjectHandle) == 8);
    static const py::dtype* const dtype =
        new py::dtype(py::list(py::make_tuple("index", "generation")),
                      py::list(py::make_tuple(py::dtype::of<std::uint32_t>(), py::dtype::of<std::uint32_t>())),
                      py::list(py::make_tuple(0, 4)), 8);
    return *dtype;
}

Boxes::Boxes(const py::handle& given, const char* name) {
    if (!py::isinstance<py::array>(given) && py::isinstance<Obb>(given)) {
        owner_ = py::reinterpret_borrow<py::object>(given);
        span_ = {given.cast<const Obb*>(), 1};
        return;
    }
    if ((py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given)) && py::len(given) > 0 &&
        py::isinstance<Obb>(given[py::int_(0)])) {
        std::vector<Obb> boxes;
        for (const py::handle one : given) {
            if (!py::isinstance<Obb>(one)) raise_type(std::string(name) + ": not all are a Box");
            boxes.push_back(one.cast<const Obb&>());
        }
        const py::array copy = boxes_of(boxes);
        span_ = {static_cast<const Obb*>(copy.data()), boxes.size()};
        owner_ = copy;
        return;
    }
    const py::array array =
        records(given, box_dtype(), name,
                "a Box, a list of them or an array of crofton.box_dtype, as crofton.boxes() makes it,");
    span_ = {static_cast<const Obb*>(array.data()), static_cast<std::size_t>(array.size())};
    owner_ = array;
}

py::array boxes_of(std::span<const Obb> boxes) {
    return record_array(box_dtype(), boxes);
}

template <class H>
Handles<H>::Handles(const py::handle& given, const char* name) {
    std::vector<H> handles;
    if (py::isinstance<H>(given)) {
        handles.push_back(given.cast<H>());
    } else if (py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given)) {
        for (const py::handle one : given) {
            if (!py::isinstance<H>(one)) raise_type(std::string(name) + ": handles of one kind are expected");
            handles.push_back(one.cast<H>());
        }
    } else {
        array_ =
            records(given, handle_dtype(), name, "a handle, a list of handles or an array of crofton.handle_dtype");
        return;
    }
    array_ = record_array(handle_dtype(), std::span<const H>(handles));
}
template class Handles<ObjectHandle>;
template class Handles<NodeHandle>;

py::array handles_of(std::span<const ObjectHandle> handles) {
    return record_array(handle_dtype(), handles);
}

glm::dvec3 vector_of(const py::handle& given, const char* name) {
    if (glm::dvec3 vector; read_vector(given, vector)) return vector;
    const py::array array = numbers(given, name);
    if (array.ndim() != 1 || array.size() != 3) raise_type(std::string(name) + ": three numbers are expected");
    const py::array_t<double> values = contiguous<double>(array);
    return {values.at(0), values.at(1), values.at(2)};
}

py::tuple tuple_of(const glm::dvec3& v) {
    return py::make_tuple(v.x, v.y, v.z);
}

std::vector<Transform> transforms_of(const py::handle& given, const char* name) {
    py::array array = numbers(given, name);
    if (array.ndim() == 2) array = array.attr("reshape")(1, array.shape(0), array.shape(1));
    if (array.ndim() != 3 || array.shape(2) != 4 || (array.shape(1) != 3 && array.shape(1) != 4))
        raise_type(std::string(name) + ": matrices of shape (4, 4) or (3, 4) are expected");
    const py::array_t<double> values = contiguous<double>(array);
    const auto at = values.unchecked<3>();
    std::vector<Transform> result(static_cast<std::size_t>(at.shape(0)));
    for (py::ssize_t i = 0; i < at.shape(0); ++i) {
        glm::dmat4 matrix(1.0);
        for (int row = 0; row < at.shape(1); ++row)
            for (int column = 0; column < 4; ++column) matrix[column][row] = at(i, row, column);
        auto transform = from_matrix(matrix);
        if (!transform) {
            if (at.shape(0) > 1) transform.error().item = static_cast<std::uint64_t>(i);
            raise(transform.error());
        }
        result[static_cast<std::size_t>(i)] = *transform;
    }
    return result;
}

Transform transform_of(const py::handle& given, const char* name) {
    const auto all = transforms_of(given, name);
    if (all.size() != 1) raise_type(std::string(name) + ": one matrix is expected");
    return all[0];
}

py::array matrix_of(const Transform& transform) {
    py::array_t<double> result({4, 4});
    auto at = result.mutable_unchecked<2>();
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 3; ++column) at(row, column) = row < 3 ? transform.linear[column][row] : 0.0;
        at(row, 3) = row < 3 ? transform.translation[row] : 1.0;
    }
    return result;
}

glm::dmat4 projection_of(const py::handle& given, const char* name) {
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!values || values.ndim() != 2 || values.shape(0) != 4 || values.shape(1) != 4) {
        PyErr_Clear();
        raise_type(std::string(name) + ": an array of shape (4, 4) is expected");
    }
    glm::dmat4 to_clip;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) to_clip[column][row] = values.at(row, column);
    return to_clip;
}

DepthRange depth_range(const std::string& name) {
    return choice_of<DepthRange>("depth", name,
                                 {{"reversed_zero_to_one", DepthRange::reversed_zero_to_one},
                                  {"zero_to_one", DepthRange::zero_to_one},
                                  {"minus_one_to_one", DepthRange::minus_one_to_one}});
}

measure::Criterion criterion_of(const py::handle& given) {
    if (py::isinstance<measure::Criterion>(given)) return given.cast<measure::Criterion>();
    if (!py::isinstance<py::str>(given)) raise_type("criterion: a Criterion or its name is expected");
    return choice_of<measure::Criterion>("criterion", given.cast<std::string>(),
                                         {{"perimeter", measure::minimal_perimeter()},
                                          {"area", measure::minimal_area()},
                                          {"volume", measure::minimal_volume()}});
}

namespace {

// True every 50 ms.
bool is_time(std::int64_t& next) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const std::int64_t milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
    if (milliseconds < next) return false;
    next = milliseconds + 50;
    return true;
}

}  // namespace

bool Interrupt::is_pending() {
    if (!is_time(next_)) return false;
    const py::gil_scoped_acquire lock;
    if (PyOS_InterruptOccurred() == 0) return false;
    PyErr_SetInterrupt();
    return true;
}

void Interrupt::raise() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

bool Watch::should_stop(double first, double second) {
    if (!is_time(next_)) return false;
    const py::gil_scoped_acquire lock;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (progress_.is_none()) return false;
        const py::object answer = progress_(first, second);
        return !answer.is_none() && !answer.cast<bool>();
    } catch (py::error_already_set& raised) {
        raised_ = std::make_unique<py::error_already_set>(std::move(raised));
    } catch (const py::cast_error&) {
        PyErr_SetString(PyExc_TypeError, "progress: None or a bool is expected as its answer");
        raised_ = std::make_unique<py::error_already_set>();
    }
    return true;
}

void Watch::raise_if_stopped() {
    if (raised_) throw py::error_already_set(std::move(*raised_));
}

}  // namespace crofton::python
