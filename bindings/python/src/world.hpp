// SPDX-License-Identifier: MIT
// A World as Python has it, and the parts of its class.
#pragma once
#include <crofton/crofton.hpp>
#include <cstdio>
#include <mutex>
#include <shared_mutex>
#include <string>

#include "convert.hpp"
#include "views.hpp"

namespace crofton::python {

// A World and a lock: changes need it for themselves, questions share it. Taken without the interpreter's lock.
class PyWorld {
  public:
    explicit PyWorld(const WorldOptions& options) : world_(options) {}

    template <class F>
    auto change(F&& f) {
        return unlocked([&] {
            const std::unique_lock lock(mutex_);
            return f(world_);
        });
    }
    template <class F>
    auto ask(F&& f) const {
        return unlocked([&] {
            const std::shared_lock lock(mutex_);
            return f(world_);
        });
    }

    [[nodiscard]] const std::shared_ptr<AnswerPools>& pools() const { return pools_; }

  private:
    World world_;
    mutable std::shared_mutex mutex_;
    std::shared_ptr<AnswerPools> pools_ = std::make_shared<AnswerPools>();
};

// A short text, for __repr__.
template <class... Values>
std::string format(const char* text, Values... values) {
    char line[200];
    std::snprintf(line, sizeof line, text, values...);
    return line;
}

// Each adds to the class what it is named after, and to the module the types of its answers.
void bind_world_changes(py::class_<PyWorld>& type);
void bind_world_views(py::module_& module, py::class_<PyWorld>& type);
void bind_world_queries(py::module_& module, py::class_<PyWorld>& type);
void bind_world_contacts(py::module_& module, py::class_<PyWorld>& type);

}  // namespace crofton::python
