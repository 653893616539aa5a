// SPDX-License-Identifier: MIT
// Which glTF extensions a scene can be shown without.
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

// What a scene lacks because extensions are not read, one warning an extension: those that the file requires but which
// touch no geometry, and unknown ones on what has to do with geometry (scenes, nodes, meshes, skins, accessors),
// wherever the file lists them. Errors: the file requires one that is unknown or has no decoder here, with its name.
[[nodiscard]] Result<std::vector<std::string>> check_extensions(const GltfDocument& document);

}  // namespace crofton::assets
