// SPDX-License-Identifier: MIT
// Extensions of glTF that can be ignored, and those that cannot.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

enum class ExtensionUse : std::uint8_t {
    read,        // obeyed
    decoded,     // geometry that this build decodes
    no_decoder,  // geometry that it could, with a library that it lacks
    appearance,  // textures, materials, lights, metadata, sound, behaviour: triangles stay where they are without it
    unknown      // may change what is where
};
[[nodiscard]] ExtensionUse use_of(std::string_view extension);

// Returns a warning for each extension that is not read: those that the file requires but that touch no geometry, and
// unknown ones on geometry (scenes, nodes, meshes, skins, accessors), wherever the file lists them. Errors: the file
// requires an extension that is unknown or has no decoder in this build.
[[nodiscard]] Result<std::vector<std::string>> check_extensions(const GltfDocument& document);

}  // namespace crofton::assets
