// SPDX-License-Identifier: MIT
// A plausible colour for a thing of which only the name is known.
#pragma once
#include <glm/vec3.hpp>
#include <string>

namespace crofton::assets {

// Linear RGB: of the first word known in `name` ("tree", "rock", …), else a muted colour of its own, the same each
// time.
[[nodiscard]] glm::vec3 color_for_name(const std::string& name);

}  // namespace crofton::assets
