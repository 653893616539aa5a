// SPDX-License-Identifier: MIT
// A hierarchy of aligned boxes, eight to a node, over items with aligned boxes: for rays and lines.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton::mesh {

struct FloatBox {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    void include(const glm::vec3& point) { include({point, point}); }
    void include(const FloatBox& box) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
    }
};

void set_bounds(BoxNode& node, std::uint32_t lane, const FloatBox& box);

struct BoxHierarchy {
    static constexpr int kMaxDepth = 64;  // nodes from the root to a leaf, for 2^30 items
    struct Leaf {
        std::uint32_t begin, end;  // of `order`
    };
    Vector<BoxNode> nodes;  // the root is the first; children stand behind their parents
    Vector<Leaf> leaves;
    Vector<std::uint32_t> order;  // items
};

// Splits by surface area in sixteen bins. The chance that a uniform line meets a box inside another is exactly the
// ratio of their surface areas (theory.md, section 2). So this is the one criterion that fits, also for which of the
// splits share a node. Leaves hold up to `leaf_size` items; they mostly hold a multiple of `granule`, a power of two up
// to 16. The same hierarchy on every machine and for any executor. Requires 1 to 2^30 items, none of their boxes empty.
using BoxOfItem = FunctionRef<FloatBox(std::size_t item)>;
[[nodiscard]] BoxHierarchy build_box_hierarchy(std::size_t count, BoxOfItem box_of, std::uint32_t leaf_size,
                                               std::uint32_t granule = 1, Executor& executor = serial_executor());

}  // namespace crofton::mesh
