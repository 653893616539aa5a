// SPDX-License-Identifier: MIT
// A World as Python has it, and the parts of its class.
#pragma once
#include <crofton/crofton.hpp>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <vector>

#include "convert.hpp"
#include "mesh.hpp"
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

    // Keeps an object's shape alive while the World refers to it. Called within change().
    void keep(ObjectHandle object, std::shared_ptr<const PyShape> shape) {
        if (object.index >= shapes_.size()) {
            if (!shape) return;
            shapes_.resize(object.index + 1);
        }
        shapes_[object.index].swap(shape);
        if (shape) replaced_.push_back(std::move(shape));
    }
    // After an update: shapes that were replaced are not referred to any more.
    void forget_replaced() { replaced_.clear(); }

    [[nodiscard]] const std::shared_ptr<AnswerPools>& pools() const { return pools_; }

  private:
    std::vector<std::shared_ptr<const PyShape>> shapes_;  // by the object's index; outlive the World
    std::vector<std::shared_ptr<const PyShape>> replaced_;
    World world_;
    mutable std::shared_mutex mutex_;
    std::shared_ptr<AnswerPools> pools_ = std::make_shared<AnswerPools>();
};

// Each adds to the class what it is named after, and to the module the types of its answers.
void bind_world_changes(py::module_& module, py::class_<PyWorld>& type);
void bind_world_views(py::module_& module, py::class_<PyWorld>& type);
void bind_world_queries(py::module_& module, py::class_<PyWorld>& type);
void bind_world_regions(py::module_& module, py::class_<PyWorld>& type);
void bind_world_contacts(py::module_& module, py::class_<PyWorld>& type);

}  // namespace crofton::python
