// SPDX-License-Identifier: MIT
#include "assets/gltf_document.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assets/data_uri.hpp"
#include "assets/file.hpp"
#include "assets/gltf_compression.hpp"
#include "assets/gltf_files.hpp"
#include "assets/json_syntax.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

// The binary container.
constexpr std::string_view kMagic = "glTF", kJsonChunk = "JSON", kBinaryChunk{"BIN\0", 4};
constexpr const char* kVersion1 = "is glTF version 1.0, where 2.0 is needed; convert it, for example by gltf-pipeline";

std::uint32_t read_u32(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < 4; ++b)
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + b])) << (8 * b);
    return value;
}

void append_u32(std::string& bytes, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFu));
}

struct Container {
    std::string_view json;
    std::optional<std::string_view> binary;
    std::string other_chunks;
};

Result<Container> open_container(std::string_view file) {
    const auto bad = [](const std::string& why) { return fail(ErrorCode::parse, kNoItem, why); };
    if (file.size() < 20) return bad("too short for a binary glTF file");
    if (read_u32(file, 4) == 1) return fail(ErrorCode::unsupported, kNoItem, kVersion1);
    if (read_u32(file, 4) != 2)
        return bad("binary glTF version " + std::to_string(read_u32(file, 4)) + ", where 2 is needed");
    if (read_u32(file, 8) > file.size())
        return bad("its header speaks of " + std::to_string(read_u32(file, 8)) + " bytes, there are " +
                   std::to_string(file.size()));
    file = file.substr(0, read_u32(file, 8));
    if (file.size() < 20) return bad("its header speaks of fewer bytes than it needs");
    Container container;
    std::size_t chunk = 0;
    for (std::size_t at = 12; at < file.size(); ++chunk) {
        const std::string name = "chunk " + std::to_string(chunk);
        if (file.size() - at < 8) return bad(name + ": its header is cut off");
        const std::size_t length = read_u32(file, at);
        if (length > file.size() - at - 8)
            return bad(name + ": " + std::to_string(length) + " bytes, of which there are " +
                       std::to_string(file.size() - at - 8));
        const std::string_view kind = file.substr(at + 4, 4), contents = file.substr(at + 8, length);
        if ((chunk == 0) != (kind == kJsonChunk))
            return bad(chunk == 0 ? "its first chunk is not JSON" : name + ": a second one of JSON");
        if (chunk == 0)
            container.json = contents;
        else if (kind == kBinaryChunk && !container.binary)
            container.binary = contents;
        else
            container.other_chunks += file.substr(at, 8 + length);
        at += 8 + length;
    }
    return container;
}

Result<Json> parse_json(std::string_view text) {
    Json root = Json::parse(text.begin(), text.end(), nullptr, false);
    if (root.is_discarded()) {
        const SyntaxError error = syntax_error(text).value_or(SyntaxError{text.size()});
        const std::string place = "at byte " + std::to_string(error.position);
        if (error.number_too_large)
            return fail(ErrorCode::out_of_range, kNoItem, "its JSON has a number beyond the range of double, " + place);
        const bool is_cut = error.position == text.size();
        return fail(ErrorCode::parse, kNoItem,
                    "its JSON is damaged " + (is_cut ? "or cut off: it ends too early" : place));
    }
    const Json* asset = member(root, "asset");
    const Json* version = asset ? member(*asset, "version") : nullptr;
    // glTF 1.0 has objects where 2.0 has arrays, and may go without a version.
    const Json* meshes = member(root, "meshes");
    if ((version && version->is_string() && version->get_ref<const std::string&>().substr(0, 2) == "1.") ||
        (meshes && meshes->is_object()))
        return fail(ErrorCode::unsupported, kNoItem, kVersion1);
    if (!version || !version->is_string()) return fail(ErrorCode::parse, kNoItem, "no glTF: asset.version is missing");
    if (version->get_ref<const std::string&>().substr(0, 2) != "2.")
        return fail(ErrorCode::unsupported, kNoItem,
                    "glTF version " + version->get_ref<const std::string&>() + ", where 2 is needed");
    const Json* least = member(*asset, "minVersion");
    if (least && least->is_string() && least->get_ref<const std::string&>() != "2.0")
        return fail(ErrorCode::unsupported, kNoItem,
                    "needs a reader of glTF version " + least->get_ref<const std::string&>() + "; this one reads 2.0");
    return root;
}

Result<Container> open_file(std::string_view file, const std::string& path) {
    if (file.substr(0, kMagic.size()) == kMagic) return open_container(file);
    if (extension(path) == "glb")
        return fail(ErrorCode::parse, kNoItem, "is no binary glTF file: it does not begin with glTF");
    Container container;
    container.json = file;
    return container;
}

// An accessor's elements; 0 where there cannot be so many, which whoever reads them says.
std::uint64_t count_of(const GltfDocument& document, const Json* accessor) {
    const auto number = accessor ? as_whole_number(*accessor) : std::nullopt;
    const Json* found = number ? entry(document.root, "accessors", *number) : nullptr;
    const Json* value = found ? member(*found, "count") : nullptr;
    const auto count = value ? as_whole_number(*value) : std::nullopt;
    if (!count) return 0;
    std::uint64_t most = document.limits.triangles;
    if (member(*found, "bufferView")) {
        most = 0;
        for (const std::string& buffer : document.buffers) most = std::max<std::uint64_t>(most, buffer.size());
    }
    return *count <= most ? *count : 0;
}

// Checks the sum over all primitives: they may share accessors, so that a small file asks for much memory.
Result<void> check_counts(const GltfDocument& document) {
    const Json& root = document.root;
    const ReadLimits& limits = document.limits;
    if (entry_count(root, "nodes") > limits.nodes) return over_limit("nodes", limits.nodes);
    std::uint64_t triangles = 0, vertices = 0;
    for (std::size_t m = 0; const Json* mesh = entry(root, "meshes", m); ++m)
        for (std::size_t p = 0; const Json* primitive = entry(*mesh, "primitives", p); ++p) {
            const Json* attributes = member(*primitive, "attributes");
            const std::uint64_t count = count_of(document, attributes ? member(*attributes, "POSITION") : nullptr);
            const Json* indices = member(*primitive, "indices");
            const auto mode = whole_number(*primitive, "mode", kGltfTriangles);
            const std::uint64_t corners = indices ? count_of(document, indices) : count;
            vertices += count;
            triangles += mode && *mode > kGltfTriangles ? corners : corners / 3;
            if (triangles > limits.triangles || vertices / 3 > limits.triangles)
                return over_limit("triangles", limits.triangles);
        }
    return {};
}

Result<GltfDocument> read_document(std::string_view file, const std::string& path, const DocumentOptions& options) {
    const auto opened = open_file(file, path);
    if (!opened) return opened.error();
    const Container& container = *opened;
    if (auto shape = check_json_shape(container.json, options.limits); !shape) return shape.error();
    auto root = parse_json(container.json);
    if (!root) return root.error();
    GltfDocument document;
    document.root = std::move(*root);
    document.other_chunks = container.other_chunks;
    document.limits = options.limits;
    document.bytes_read = file.size();
    if (auto read = read_buffers(document, folder(path), container.binary, options.whole_buffers); !read)
        return read.error();
    if (auto plain = decompress(document, options.plain_copies); !plain) return plain.error();
    if (auto counts = check_counts(document); !counts) return counts.error();
    if (options.images) take_in_images(document, folder(path));
    return document;
}

Json& list(Json& root, const char* key) {
    if (!root.contains(key) || !root[key].is_array()) root[key] = Json::array();
    return root[key];
}

}  // namespace

const Json* member(const Json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

const Json* entry(const Json& object, const char* key, std::size_t index) {
    return index < entry_count(object, key) ? &object.find(key)->at(index) : nullptr;
}

std::size_t entry_count(const Json& object, const char* key) {
    const Json* list = member(object, key);
    return list && list->is_array() ? list->size() : 0;
}

std::string label(const char* what, std::size_t index, const Json& object) {
    const Json* name = member(object, "name");
    const bool named = name && name->is_string() && !name->get_ref<const std::string&>().empty();
    return what + (" " + std::to_string(index)) + (named ? " '" + name->get<std::string>() + "'" : "");
}

std::optional<std::size_t> as_whole_number(const Json& value) {
    if (value.is_number_float()) {  // 2.0 is a whole number as well
        const auto number = value.get<double>();
        const double most = std::min(0x1p53, static_cast<double>(std::numeric_limits<std::size_t>::max() / 2));
        if (!(number >= 0.0 && number <= most) || number != std::floor(number)) return std::nullopt;
        return static_cast<std::size_t>(number);
    }
    // On 32-bit targets a larger one would come out as another.
    if (!value.is_number_integer() || value < 0 || value > std::numeric_limits<std::size_t>::max() / 2)
        return std::nullopt;
    return value.get<std::size_t>();
}

Result<std::size_t> whole_number(const Json& object, const char* key, std::size_t otherwise) {
    const Json* value = member(object, key);
    if (!value) return otherwise;
    if (const auto number = as_whole_number(*value)) return *number;
    return fail(ErrorCode::parse, kNoItem, std::string(key) + " is no whole number of at least 0");
}

Result<GltfDocument> read_gltf_document(const std::string& path, const DocumentOptions& options) {
    const auto file = read_file(path, options.limits.bytes);
    if (!file) return file.error();
    auto document = read_document(*file, path, options);
    if (!document) return in_file(path, "", document.error());
    return document;
}

Result<std::string> write_glb(const GltfDocument& document) {
    Json root = document.root;
    for (std::size_t i = 0; i < document.buffers.size(); ++i) {
        if (document.buffers[i].empty()) continue;
        Json& buffer = root["buffers"][i];
        if (i == 0) {
            buffer.erase("uri");
            buffer["byteLength"] = document.buffers[i].size();
        } else {
            buffer["uri"] = make_data_uri("application/octet-stream", document.buffers[i]);
        }
    }
    std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = document.buffers.empty() ? std::string() : document.buffers[0];
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const std::size_t binary_chunk = binary.empty() ? 0 : 8 + binary.size();
    const std::size_t total = 12 + 8 + text.size() + binary_chunk + document.other_chunks.size();
    if (total > std::numeric_limits<std::uint32_t>::max())
        return fail(ErrorCode::out_of_range, kNoItem, "larger than binary glTF's limit of 4 GiB");
    std::string glb(kMagic);
    glb.reserve(total);
    append_u32(glb, 2);
    append_u32(glb, total);
    append_u32(glb, text.size());
    glb += kJsonChunk;
    glb += text;
    if (binary_chunk != 0) {
        append_u32(glb, binary.size());
        glb += kBinaryChunk;
        glb += binary;
    }
    return glb + document.other_chunks;
}

std::size_t append_view(GltfDocument& document, std::string_view bytes, int target) {
    Json& buffers = list(document.root, "buffers");
    std::size_t home = 0;
    // The bytes of a first buffer that the file leaves empty are told elsewhere.
    if (document.buffers.empty() || document.buffers[0].empty()) {
        home = document.buffers.size();
        document.buffers.emplace_back();
        buffers.push_back(Json::object());
    }
    std::string& buffer = document.buffers[home];
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    Json view{{"buffer", home}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    buffer += bytes;
    buffers[home]["byteLength"] = buffer.size();
    Json& views = list(document.root, "bufferViews");
    views.push_back(std::move(view));
    return views.size() - 1;
}

std::size_t append_accessor(GltfDocument& document, std::string_view bytes, std::size_t count, int component_type,
                            const char* type, int target) {
    const std::size_t view = append_view(document, bytes, target);
    Json& accessors = list(document.root, "accessors");
    accessors.push_back({{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
}

}  // namespace crofton::assets
