// SPDX-License-Identifier: MIT
// Compressed geometry of glTF as plain buffers: KHR_draco_mesh_compression and EXT_meshopt_compression, each where its
// library was found when this was configured.
#pragma once
#include <string_view>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// Whether this program decodes the extension.
[[nodiscard]] bool decodes(std::string_view extension);

// Replaces compressed views and primitives by plain ones, and removes the extensions' names where nothing is left of
// them. What cannot be decoded stays, with a warning that names it. Errors: more bytes than the document's limit.
[[nodiscard]] Result<void> decompress(GltfDocument& document);

}  // namespace crofton::assets
