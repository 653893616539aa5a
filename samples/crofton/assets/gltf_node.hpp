// SPDX-License-Identifier: MIT
// Placement of a glTF node: its transform, the instances of its mesh, its visibility.
#pragma once
#include <crofton/geometry/transform.hpp>
#include <string>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// `matrix`, or translation, rotation and scale. Errors: as from_matrix and from_trs; of another length than they have;
// not numbers.
[[nodiscard]] Result<Transform> transform_of(const nlohmann::ordered_json& node);

// False where KHR_node_visibility hides the node and all below it. Errors: `visible` is no boolean.
[[nodiscard]] Result<bool> is_visible(const nlohmann::ordered_json& node);

// The instances of EXT_mesh_gpu_instancing, in the node's frame.
struct Placements {
    std::vector<Transform> transforms;
    std::size_t left_out = 0;  // whose numbers make no sense
    std::string why;           // the first of them
};

// The node's extension EXT_mesh_gpu_instancing, or null where it has none.
[[nodiscard]] const nlohmann::ordered_json* instancing_of(const nlohmann::ordered_json& node);

// Errors: no attributes; accessors that cannot be read, or of different counts; more instances than the limit of nodes.
[[nodiscard]] Result<Placements> placements(const GltfDocument& document, const nlohmann::ordered_json& instancing);

}  // namespace crofton::assets
