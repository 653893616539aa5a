// A dynamic hierarchy of oriented boxes over items, for views and for collisions alike.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/measure/criterion.hpp>
#include <cstdint>
#include <span>

namespace crofton::tree {

using ItemId = std::uint32_t;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

struct BuildOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
};

// Every node's bound contains (exactly) all boxes of the items below it. Item i's box is boxes()[i].
class BoxTree {
  public:
    // Errors: a box that fails validate(Obb), named by its index; more than 2^30 boxes.
    [[nodiscard]] static Result<BoxTree> build(std::span<const Obb> boxes, const BuildOptions& options = {},
                                               Executor& executor = serial_executor());
    // … insert, remove, move, refit, validate, serialise, node access: the module's owner fills these in.
};

}  // namespace crofton::tree
