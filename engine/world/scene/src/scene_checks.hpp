// SPDX-License-Identifier: MIT
// The errors that calls of Scene share.
#pragma once
#include <string>

#include "scene_state.hpp"

namespace crofton::scene {

inline constexpr std::size_t kMaxItems = std::size_t{1} << 31;

template <class T>
[[nodiscard]] Result<void> check_room(const Vector<T>& items, const Vector<std::uint32_t>& free, const char* what) {
    if (items.size() < kMaxItems || !free.empty()) return {};
    return fail(ErrorCode::out_of_range, items.size(), {"scene: more than 2^31 ", what});
}

[[nodiscard]] inline Result<void> check_id(std::uint32_t id, std::size_t count, bool removed, const char* what) {
    if (id >= count)
        return fail(ErrorCode::out_of_range, id, {"scene: ", what, " ", id, " does not exist, there are ", count});
    if (removed) return fail(ErrorCode::invalid_argument, id, {"scene: ", what, " ", id, " was removed"});
    return {};
}

[[nodiscard]] inline bool is_node(const Vector<Node>& nodes, NodeId id) {
    return id < nodes.size() && nodes[id].position != kRemoved;
}
[[nodiscard]] inline Result<void> check_node(const Vector<Node>& nodes, NodeId id, const char* what = "node") {
    return check_id(id, nodes.size(), !is_node(nodes, id), what);
}
[[nodiscard]] inline Result<void> check_mesh(const Vector<MeshRecord>& meshes, MeshId id) {
    return check_id(id, meshes.size(), id < meshes.size() && meshes[id].revision == 0, "mesh");
}
[[nodiscard]] inline Result<void> check_instance(const Vector<Instance>& instances, InstanceId id) {
    return check_id(id, instances.size(), id < instances.size() && instances[id].node == kRemoved, "instance");
}

}  // namespace crofton::scene
