// SPDX-License-Identifier: MIT
// What comes from Python and goes there: errors, arrays of points, boxes and handles, cameras and transforms.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/world/inputs.hpp>
#include <cstdint>
#include <cstdio>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

namespace crofton::python {

namespace py = pybind11;

// Raises crofton.Error, which has the attributes `code` and `item`.
[[noreturn]] void raise(const Error& error);
[[noreturn]] void raise_type(const std::string& message);

template <class T>
T value_of(Result<T>&& result) {
    if (!result) raise(result.error());
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// A short text, for __repr__.
template <class... Values>
std::string format(const char* text, Values... values) {
    char line[200];
    std::snprintf(line, sizeof line, text, values...);
    return line;
}

// The threads of set_threads(). Held while a call uses it.
[[nodiscard]] std::shared_ptr<Executor> executor();

// Points as rows, float or double. Contiguous arrays of these types are used as they are; all others are converted
// once. `array` keeps the memory alive.
template <int N>
class Points {
  public:
    // Raises TypeError unless `given` is an array of numbers of shape (n, N).
    Points(const py::handle& given, const char* name);
    [[nodiscard]] bool is_float() const { return is_float_; }
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(array_.shape(0)); }
    [[nodiscard]] std::span<const glm::vec<N, float>> floats() const {
        return {static_cast<const glm::vec<N, float>*>(array_.data()), size()};
    }
    [[nodiscard]] std::span<const glm::vec<N, double>> doubles() const {
        return {static_cast<const glm::vec<N, double>*>(array_.data()), size()};
    }
    // Calls with either span.
    template <class F>
    auto visit(F&& f) const {
        return is_float_ ? f(floats()) : f(doubles());
    }

  private:
    py::array array_;
    bool is_float_ = false;
};
extern template class Points<2>;
extern template class Points<3>;

// Numbers of exactly the type T, one dimension; other integer types are converted if no value is lost.
template <class T>
[[nodiscard]] py::array_t<T, py::array::c_style> integers(const py::handle& given, const char* name);
extern template py::array_t<std::uint16_t, py::array::c_style> integers(const py::handle&, const char*);
extern template py::array_t<std::uint32_t, py::array::c_style> integers(const py::handle&, const char*);
extern template py::array_t<std::uint64_t, py::array::c_style> integers(const py::handle&, const char*);

template <class T>
[[nodiscard]] std::span<const T> span_of(const py::array_t<T, py::array::c_style>& array) {
    return {array.data(), static_cast<std::size_t>(array.size())};
}

// An array that owns a copy of `values`; of shape (n) or (n, width).
template <class T, class Range>
[[nodiscard]] py::array_t<T> array_of(const Range& values, py::ssize_t width = 0) {
    static_assert(sizeof(values[0]) % sizeof(T) == 0);
    const auto n = static_cast<py::ssize_t>(values.size());
    py::array_t<T> result(width == 0 ? std::vector<py::ssize_t>{n} : std::vector<py::ssize_t>{n, width});
    if (n > 0) std::memcpy(result.mutable_data(), values.data(), static_cast<std::size_t>(result.nbytes()));
    return result;
}

// Arrays of boxes have crofton.box_dtype, an Obb to a record: `center` three doubles, `axes` three floats for each of
// three axes, `half_extents` three floats.
[[nodiscard]] const py::dtype& box_dtype();
class Boxes {
  public:
    // A Box, a list of them, or an array of box_dtype with any number of dimensions. Raises TypeError for others.
    Boxes(const py::handle& given, const char* name);
    [[nodiscard]] std::span<const Obb> span() const { return span_; }

  private:
    py::object owner_;  // of the memory
    std::span<const Obb> span_;
};
[[nodiscard]] py::array boxes_of(std::span<const Obb> boxes);

// Arrays of handles have crofton.handle_dtype: `index` and `generation`, 32 bits each.
[[nodiscard]] const py::dtype& handle_dtype();
template <class H>
class Handles {
  public:
    // One handle, a sequence of them or an array of handle_dtype.
    Handles(const py::handle& given, const char* name);
    [[nodiscard]] std::span<const H> span() const {
        return {static_cast<const H*>(array_.data()), static_cast<std::size_t>(array_.size())};
    }

  private:
    py::array array_;
};
extern template class Handles<ObjectHandle>;
extern template class Handles<NodeHandle>;
[[nodiscard]] py::array handles_of(std::span<const ObjectHandle> handles);

// The C++ object of a Python object that is of class T itself, else nullptr: without the look-ups of a cast.
template <class T>
[[nodiscard]] T* exactly(PyObject* given) {
    static PyTypeObject* const type = reinterpret_cast<PyTypeObject*>(py::type::of<T>().ptr());
    if (Py_TYPE(given) != type) return nullptr;
    auto* const instance = reinterpret_cast<py::detail::instance*>(given);
    return instance->simple_layout ? static_cast<T*>(instance->simple_value_holder[0]) : nullptr;
}
// The same for derived classes as well.
template <class T>
[[nodiscard]] T* as(const py::handle& given) {
    if (T* const found = exactly<T>(given.ptr())) return found;
    return py::isinstance<T>(given) ? given.cast<T*>() : nullptr;
}

// One number. Raises TypeError for what is none, or does not fit.
template <class T>
[[nodiscard]] T number_of(const py::handle& given, const char* name) {
    try {
        return given.cast<T>();
    } catch (const py::cast_error&) {
        raise_type(std::string(name) +
                   (std::is_integral_v<T> ? ": a whole number from 0 on is expected" : ": a number is expected"));
    }
}

[[nodiscard]] glm::dvec3 vector_of(const py::handle& given, const char* name);
[[nodiscard]] py::tuple tuple_of(const glm::dvec3& v);

// A matrix of shape (4, 4) or (3, 4), as NumPy prints it: the last column is the translation.
[[nodiscard]] Transform transform_of(const py::handle& given, const char* name);
[[nodiscard]] std::vector<Transform> transforms_of(const py::handle& given, const char* name);
[[nodiscard]] py::array matrix_of(const Transform& transform);
// A matrix of shape (4, 4) to clip space.
[[nodiscard]] glm::dmat4 projection_of(const py::handle& given, const char* name);

// A Criterion, or the name of one: "perimeter", "area", "volume".
[[nodiscard]] measure::Criterion criterion_of(const py::handle& given);

// The value of a name such as "fast". Raises Error with the names there are for any other.
template <class T>
[[nodiscard]] T choice_of(const char* argument, const std::string& name,
                          std::initializer_list<std::pair<const char*, T>> choices) {
    std::string names;
    for (const auto& [known, value] : choices) {
        if (name == known) return value;
        names += std::string(names.empty() ? "'" : ", '") + known + "'";
    }
    raise({ErrorCode::invalid_argument, kNoItem,
           std::string(argument) + ": one of " + names + " is expected, not '" + name + "'"});
}

// "reversed_zero_to_one", "zero_to_one" or "minus_one_to_one".
[[nodiscard]] DepthRange depth_range(const std::string& name);

// Runs f without the interpreter's lock.
template <class F>
auto unlocked(F&& f) {
    const py::gil_scoped_release release;
    return f();
}

// Asks now and then for Ctrl-C, and calls `progress`, a Python callable or None, with the numbers given. Used from
// within a call that has released the lock.
class Watch {
  public:
    explicit Watch(py::object progress) : progress_(std::move(progress)) {}
    // False: stop. Costs next to nothing but every 50 ms.
    bool should_stop(double first, double second = 0.0);
    // Ctrl-C, or an exception of the callable.
    [[nodiscard]] bool is_raised() const { return raised_ != nullptr; }
    // After the call, with the lock: raises what stopped it.
    void raise_if_stopped();

  private:
    py::object progress_;
    std::unique_ptr<py::error_already_set> raised_;
    std::int64_t next_ = 0;
};

// Looks now and then for Ctrl-C, without running its handler, which may use what the call has locked.
class Interrupt {
  public:
    // True: stop, release locks, and call raise(). Costs next to nothing but every 50 ms.
    [[nodiscard]] bool is_pending();
    // With the interpreter's lock: runs the handler, and raises what it raises. If it raises nothing, go on.
    static void raise();

  private:
    std::int64_t next_ = 0;
};

}  // namespace crofton::python
