// SPDX-License-Identifier: MIT
// Data of a glTF asset outside its JSON: buffers in the binary chunk, in data URIs, and in other files.
#pragma once
#include <crofton/core/error.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "assets/gltf_document.hpp"

namespace crofton::assets {

// Fills document.buffers. `binary` is the chunk of a binary file. What cannot be read, or is shorter than it should
// be, is an error where `whole`; otherwise a warning, and what there is of it is kept. More bytes than the document's
// limit are an error always.
[[nodiscard]] Result<void> read_buffers(GltfDocument& document, const std::string& folder,
                                        const std::optional<std::string_view>& binary, bool whole);

}  // namespace crofton::assets
