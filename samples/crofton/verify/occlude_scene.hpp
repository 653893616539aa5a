// SPDX-License-Identifier: MIT
// crofton verify occlude --scene: a World of a whole scene, looked at from many places.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "assets/scene_source.hpp"

#include "rows.hpp"

namespace crofton::cli {

// Occluders are found in the scene's meshes. At each offset from 0 to 1e7 `trials` rays through random points of
// pictures are cast; the first object that one meets must be in World's answer for that view. Small boxes that move are
// among the objects. Errors: as assets::load_scene.
[[nodiscard]] Result<std::vector<VerifyRow>> verify_occluded_scene(const std::string& source,
                                                                   const assets::LoadOptions& which,
                                                                   const VerifyOptions& options);

}  // namespace crofton::cli
