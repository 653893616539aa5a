// SPDX-License-Identifier: MIT
// A glTF asset as its file has it, to change one thing in it and leave the rest as it is.
#pragma once
#include <crofton/core/error.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "assets/gltf_elements.hpp"

namespace crofton::assets {

struct GltfDocument {
    nlohmann::ordered_json root = nlohmann::ordered_json::object();  // the whole JSON, members in the file's order
    std::vector<std::string> buffers;   // by number, of byteLength bytes; empty where the file has none for it
    std::string other_chunks;           // of a binary file, behind those the specification knows
    std::vector<std::string> warnings;  // what an output will lack
};

// The JSON in the contents of a .glb or .gltf file, which `path` tells apart only where the contents do not. Bytes
// behind the length that a binary file's header gives are no part of it. Errors: lengths and kinds of chunks, arrays
// and objects nested too deeply for what walks them.
[[nodiscard]] Result<std::string_view> gltf_json(std::string_view file, const std::string& path);

// .glb or .gltf with its buffers. Images that lie in files beside are taken into the first buffer, so that the document
// no longer depends on its place; one that cannot be read keeps its URI, with a warning. Other URIs stay as they are.
// Errors name the file, the item and the reason: wrong lengths, damaged or too deeply nested JSON, another version than
// 2, buffers that are missing or too short.
[[nodiscard]] Result<GltfDocument> read_gltf_document(const std::string& path);

// Images named by URIs of files in `folder` into the first buffer, as read_gltf_document does it.
void take_in_images(GltfDocument& document, const std::string& folder);

// One binary file: the first buffer as its binary chunk, others as data URIs. Errors: more than the 4 GiB that the
// format can hold.
[[nodiscard]] Result<std::string> write_glb(const GltfDocument& document);

// Member `key`, or null where `object` is no object or lacks it; entry `index` of the array `key`, likewise.
[[nodiscard]] const nlohmann::ordered_json* member(const nlohmann::ordered_json& object, const char* key);
[[nodiscard]] const nlohmann::ordered_json* entry(const nlohmann::ordered_json& object, const char* key,
                                                  std::size_t index);
// `value` as a whole number ≥ 0, or nothing.
[[nodiscard]] std::optional<std::size_t> as_whole_number(const nlohmann::ordered_json& value);
// A number that counts or names something; `otherwise` where there is none. Errors: not a whole number ≥ 0.
[[nodiscard]] Result<std::size_t> whole_number(const nlohmann::ordered_json& object, const char* key,
                                               std::size_t otherwise);
inline constexpr std::size_t kNoNumber = ~std::size_t{0};

// An accessor's elements; those of a sparse one are put together in `storage`, which must outlive them. Where `count`
// is given, an accessor of another count is an error. Other errors: as place(); no such accessor, view or buffer;
// compressed views.
[[nodiscard]] Result<Elements> accessor_elements(const GltfDocument& document, std::size_t accessor,
                                                 std::optional<std::size_t> count, std::string& storage);

// Appends to the first buffer (to a new one where there is none or it holds nothing) and returns the new view's or
// accessor's number.
[[nodiscard]] std::size_t append_view(GltfDocument& document, std::string_view bytes, int target = 0);
[[nodiscard]] std::size_t append_accessor(GltfDocument& document, std::string_view bytes, std::size_t count,
                                          int component_type, const char* type, int target);
inline constexpr int kGltfVertexTarget = 34962, kGltfIndexTarget = 34963;

}  // namespace crofton::assets
