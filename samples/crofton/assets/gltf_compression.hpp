// SPDX-License-Identifier: MIT
// Compressed geometry of glTF as plain buffers: KHR_draco_mesh_compression, EXT_meshopt_compression and its successor
// KHR_meshopt_compression, each where its library was found when this was configured.
#pragma once
#include <string>
#include <string_view>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// Whether this program decodes the extension.
[[nodiscard]] bool decodes(std::string_view extension);

// Debian's package with the decoder that a build needs for the extension; null where there is none.
[[nodiscard]] const char* decoder_package(std::string_view extension);

// Why what the extension has compressed is still compressed: damaged, no decoder and what to install, unknown.
[[nodiscard]] std::string why_compressed(std::string_view extension);

// Replaces compressed views and primitives by plain ones, and removes the extensions' names where nothing is left of
// them. With `plain_copies`, what cannot be decoded is replaced by the uncompressed copy that the file holds for such
// readers. Otherwise it stays; what is damaged gets a warning that names it. Errors: more bytes than the document's
// limit.
[[nodiscard]] Result<void> decompress(GltfDocument& document, bool plain_copies);

}  // namespace crofton::assets
