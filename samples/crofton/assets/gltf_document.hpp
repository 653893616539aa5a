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
#include "assets/read_limits.hpp"

namespace crofton::assets {

struct GltfDocument {
    nlohmann::ordered_json root = nlohmann::ordered_json::object();  // the whole JSON, members in the file's order
    std::vector<std::string> buffers;   // by number, of byteLength bytes; empty where the file has none for it
    std::string other_chunks;           // of a binary file, behind those the specification knows
    std::vector<std::string> warnings;  // what an output will lack
    ReadLimits limits;                  // that it was read with
    std::uint64_t bytes_read = 0;       // of its file and those that it refers to, within limits.bytes
};

struct DocumentOptions {
    ReadLimits limits;
    // Images in files beside are taken into the first buffer, so that the document no longer depends on its place; one
    // that cannot be read keeps its URI, with a warning.
    bool images = true;
    // A buffer that is missing or too short is an error; without, a warning, and what there is of it is kept.
    bool whole_buffers = true;
    // Replaces compressed data that cannot be decoded by its uncompressed copy, if the file has one.
    bool plain_copies = false;
};

// .glb or .gltf with its buffers; other URIs stay as they are. Bytes behind the length that a binary file's header
// gives are no part of it. Errors name the file, the item and the reason: wrong lengths, damaged JSON, another version
// than 2, buffers that cannot be read, whatever is beyond a limit.
[[nodiscard]] Result<GltfDocument> read_gltf_document(const std::string& path, const DocumentOptions& options = {});

// Images named by URIs of files in `folder` into the first buffer, as read_gltf_document does it.
void take_in_images(GltfDocument& document, const std::string& folder);

// The bytes of an image's file, wherever they are: in a buffer, in its URI, in a file in `folder`. Those of a file are
// added to `bytes_read`, which begins as the document's and stays within its limit. Errors: no such image, a view
// beyond its buffer, a file that cannot be read.
[[nodiscard]] Result<std::string> image_bytes(const GltfDocument& document, std::size_t image,
                                              const std::string& folder, std::uint64_t& bytes_read);

// One binary file: the first buffer as its binary chunk, others as data URIs. Errors: more than the 4 GiB that the
// format can hold.
[[nodiscard]] Result<std::string> write_glb(const GltfDocument& document);

// Member `key`, or null where `object` is no object or lacks it; entry `index` of the array `key`, likewise.
[[nodiscard]] const nlohmann::ordered_json* member(const nlohmann::ordered_json& object, const char* key);
[[nodiscard]] const nlohmann::ordered_json* entry(const nlohmann::ordered_json& object, const char* key,
                                                  std::size_t index);
// How many entries the array `key` has; 0 where there is none.
[[nodiscard]] std::size_t entry_count(const nlohmann::ordered_json& object, const char* key);
// "what index 'name'", for messages.
[[nodiscard]] std::string label(const char* what, std::size_t index, const nlohmann::ordered_json& object);
// `value` as a whole number ≥ 0, or nothing. 2.0 and 2e0 are whole, as glTF allows; so written, at most 2^53.
[[nodiscard]] std::optional<std::size_t> as_whole_number(const nlohmann::ordered_json& value);
// A number that counts or names something; `otherwise` where there is none. Errors: not a whole number ≥ 0.
[[nodiscard]] Result<std::size_t> whole_number(const nlohmann::ordered_json& object, const char* key,
                                               std::size_t otherwise);
inline constexpr std::size_t kNoNumber = ~std::size_t{0};

// An accessor's elements; those of a sparse one, or the zeros of one without a view, are put together in `storage`,
// which must outlive them. Where `count` is given, an accessor of another count is an error. Other errors: as place();
// no such accessor, view or buffer; compressed views; more zeros than the limit of triangles.
[[nodiscard]] Result<Elements> accessor_elements(const GltfDocument& document, std::size_t accessor,
                                                 std::optional<std::size_t> count, std::string& storage);

// Appends to the first buffer (to a new one where there is none or it holds nothing) and returns the new view's or
// accessor's number.
[[nodiscard]] std::size_t append_view(GltfDocument& document, std::string_view bytes, int target = 0);
[[nodiscard]] std::size_t append_accessor(GltfDocument& document, std::string_view bytes, std::size_t count,
                                          int component_type, const char* type, int target);
inline constexpr int kGltfVertexTarget = 34962, kGltfIndexTarget = 34963;

}  // namespace crofton::assets
