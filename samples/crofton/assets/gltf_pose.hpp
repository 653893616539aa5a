// SPDX-License-Identifier: MIT
// Where a glTF mesh's vertices are before anything is animated: morph targets by their weights, skins by their joints.
#pragma once
#include <crofton/geometry/transform.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// The weights of a mesh's morph targets: the node's own, else the mesh's; empty where none is other than 0. Errors: not
// finite numbers.
[[nodiscard]] Result<std::vector<double>> morph_weights(const nlohmann::ordered_json& node,
                                                        const nlohmann::ordered_json& mesh);

// Moves the positions of a primitive by Σ weight · target. Does nothing where `weights` is empty. Errors: another
// number of targets than of weights; accessors that cannot be read or are of another count; too late.
[[nodiscard]] Result<void> apply_morph(const GltfDocument& document, const nlohmann::ordered_json& primitive,
                                       std::span<const double> weights, const Deadline& deadline,
                                       std::span<glm::dvec3> positions);

// The skins of a document at rest: each joint's node where the file has it.
class SkinPoses {
  public:
    explicit SkinPoses(const GltfDocument& document) : document_(document) {}

    // For each joint of a skin: its node's world transform times its inverse bind matrix. Errors: no such skin or
    // joint; nodes that are their own ancestors or whose transforms make no sense; matrices that are too few,
    // projective or not finite.
    [[nodiscard]] Result<std::span<const Transform>> joints(std::size_t skin);

  private:
    [[nodiscard]] Result<Transform> world(std::size_t node);
    [[nodiscard]] Result<Transform> below_parent(std::size_t node) const;
    [[nodiscard]] Result<std::vector<Transform>> compute(std::size_t skin);

    const GltfDocument& document_;
    std::vector<std::size_t> parents_;                      // by node; kNoNumber: a root
    std::vector<std::optional<Result<Transform>>> worlds_;  // by node, of those asked for
    std::map<std::size_t, Result<std::vector<Transform>>> joints_;
};

// Takes the positions of a primitive to the world: Σ weight · joint · position, over all sets of JOINTS_n and
// WEIGHTS_n, divided by the sum of the weights. A vertex whose weights are all 0 follows its first joint. Errors:
// accessors that cannot be read; a joint that the skin has not; weights that are not finite, negative, or of other
// counts.
[[nodiscard]] Result<void> apply_skin(const GltfDocument& document, const nlohmann::ordered_json& primitive,
                                      std::span<const Transform> joints, std::span<glm::dvec3> positions);

}  // namespace crofton::assets
