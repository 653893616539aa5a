// SPDX-License-Identifier: MIT
#include "assets/gltf_document.hpp"

#include <filesystem>
#include <limits>
#include <map>

#include "assets/data_uri.hpp"
#include "assets/file.hpp"
#include "assets/json_syntax.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

// Of the binary container.
constexpr std::string_view kMagic = "glTF", kJsonChunk = "JSON", kBinaryChunk{"BIN\0", 4};
// Of arrays and objects: what walks a document recurses this deep.
constexpr int kDeepest = 200;

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

bool nested_too_deeply(std::string_view text) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\') ++i;
        if (c == '"') in_string = !in_string;
        if (in_string) continue;
        if ((c == '{' || c == '[') && ++depth > kDeepest) return true;
        if (c == '}' || c == ']') --depth;
    }
    return false;
}

Result<Json> parse_json(std::string_view text) {
    Json root = Json::parse(text.begin(), text.end(), nullptr, false);
    if (root.is_discarded()) {
        const std::size_t end = syntax_error_position(text).value_or(text.size());
        return fail(ErrorCode::parse, kNoItem,
                    "its JSON is damaged " + (end == text.size() ? std::string("or cut off: it ends too early")
                                                                 : "at byte " + std::to_string(end)));
    }
    const Json* asset = member(root, "asset");
    const Json* version = asset ? member(*asset, "version") : nullptr;
    if (!version || !version->is_string()) return fail(ErrorCode::parse, kNoItem, "no glTF: asset.version is missing");
    if (version->get_ref<const std::string&>().substr(0, 2) != "2.")
        return fail(ErrorCode::unsupported, kNoItem,
                    "glTF version " + version->get_ref<const std::string&>() + ", where 2 is needed");
    return root;
}

const std::string* uri_of(const Json& object) {
    const Json* uri = member(object, "uri");
    return uri && uri->is_string() ? &uri->get_ref<const std::string&>() : nullptr;
}

std::size_t length_of(const Json& object, const char* key) {
    const Json* list = member(object, key);
    return list && list->is_array() ? list->size() : 0;
}

// What a document refers to in files beside it.
class FilesBeside {
  public:
    FilesBeside(std::string folder, GltfDocument& document) : folder_(std::move(folder)), document_(document) {}

    Result<void> read_buffers(const std::optional<std::string_view>& binary) {
        const std::size_t count = length_of(document_.root, "buffers");
        for (std::size_t i = 0; i < count; ++i) {
            auto bytes = buffer(document_.root["buffers"][i], i == 0 ? binary : std::nullopt);
            if (!bytes) {
                bytes.error().item = i;
                bytes.error().message = "buffer " + std::to_string(i) + ": " + bytes.error().message;
                return tl::unexpected(bytes.error());
            }
            document_.buffers.push_back(std::move(*bytes));
        }
        return {};
    }

    void take_in_images() {
        const std::size_t count = length_of(document_.root, "images");
        for (std::size_t i = 0; i < count; ++i) {
            const std::string* uri = uri_of(document_.root["images"][i]);
            if (uri && !has_scheme(*uri)) take_in_image(document_.root["images"][i], i, *uri);
        }
    }

  private:
    [[nodiscard]] std::string path_of(const std::string& uri) const {
        const std::string name = decode_percent(uri);
        return name.substr(0, 1) == "/" ? name : folder_ + name;
    }

    // A file's name comes from whoever made the asset: devices and pipes are not opened.
    [[nodiscard]] Result<std::string> read_beside(const std::string& uri) const {
        const std::string path = path_of(uri);
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(path, ignored))
            return fail(ErrorCode::io, kNoItem, path + ": there is no such file");
        return read_file(path);
    }

    // Without a URI and a chunk (the place of what is compressed elsewhere) it holds nothing.
    Result<std::string> buffer(Json& description, const std::optional<std::string_view>& binary) {
        if (!description.is_object()) return fail(ErrorCode::parse, kNoItem, "is no object");
        const auto length = whole_number(description, "byteLength", 0);
        if (!length) return tl::unexpected(length.error());
        const std::string* uri = uri_of(description);
        if (!uri && !binary) return std::string();
        Result<std::string> bytes;
        if (!uri)
            bytes = std::string(*binary);
        else if (is_data_uri(*uri))
            bytes = decode_data_uri(*uri);
        else if (has_scheme(*uri))
            bytes = fail(ErrorCode::unsupported, kNoItem, "'" + uri->substr(0, 80) + "' is not a file");
        else
            bytes = read_beside(*uri);
        if (!bytes) return bytes;
        if (bytes->size() < *length)
            return fail(ErrorCode::out_of_range, kNoItem,
                        std::to_string(bytes->size()) + " bytes, where byteLength is " + std::to_string(*length));
        bytes->resize(*length);
        return bytes;
    }

    static const char* type_of(std::string_view bytes) {
        const auto begins = [&](std::string_view magic) { return bytes.substr(0, magic.size()) == magic; };
        if (begins("\x89PNG")) return "image/png";
        if (begins("\xFF\xD8\xFF")) return "image/jpeg";
        if (begins("\xABKTX 20")) return "image/ktx2";
        if (begins("RIFF") && bytes.substr(8, 4) == "WEBP") return "image/webp";
        if (begins("DDS ")) return "image/vnd-ms.dds";
        return nullptr;
    }

    void take_in_image(Json& image, std::size_t number, const std::string& uri) {
        const auto warn = [&](const std::string& why) {
            document_.warnings.push_back("image " + std::to_string(number) + ": " + why + "; its URI stays as it is");
        };
        const std::string path = path_of(uri);
        if (!views_.contains(path)) {
            const auto bytes = read_beside(uri);
            if (!bytes) return warn(bytes.error().message);
            const char* type = type_of(*bytes);
            if (!type) return warn(path + ": of unknown type");
            views_[path] = {append_view(document_, *bytes), type};
        }
        const auto& [view, type] = views_[path];
        image.erase("uri");
        image["bufferView"] = view;
        image["mimeType"] = type;
    }

    struct ImageView {
        std::size_t view = 0;
        const char* type = "";
    };
    std::string folder_;
    GltfDocument& document_;
    std::map<std::string, ImageView> views_;
};

Result<Container> open_file(std::string_view file, const std::string& path) {
    Container container;
    if (file.substr(0, kMagic.size()) == kMagic) {
        auto opened = open_container(file);
        if (!opened) return opened;
        container = std::move(*opened);
    } else if (extension(path) == "glb") {
        return fail(ErrorCode::parse, kNoItem, "is no binary glTF file: it does not begin with glTF");
    } else {
        container.json = file;
    }
    if (nested_too_deeply(container.json))
        return fail(ErrorCode::parse, kNoItem, "its JSON is nested deeper than " + std::to_string(kDeepest));
    return container;
}

Result<GltfDocument> read_document(std::string_view file, const std::string& path) {
    const auto opened = open_file(file, path);
    if (!opened) return tl::unexpected(opened.error());
    const Container& container = *opened;
    auto root = parse_json(container.json);
    if (!root) return tl::unexpected(root.error());
    GltfDocument document;
    document.root = std::move(*root);
    document.other_chunks = container.other_chunks;
    FilesBeside files(folder(path), document);
    if (auto read = files.read_buffers(container.binary); !read) return tl::unexpected(read.error());
    files.take_in_images();
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
    return index < length_of(object, key) ? &object.find(key)->at(index) : nullptr;
}

std::optional<std::size_t> as_whole_number(const Json& value) {
    if (!value.is_number_integer() || value < 0) return std::nullopt;
    return value.get<std::size_t>();
}

Result<std::size_t> whole_number(const Json& object, const char* key, std::size_t otherwise) {
    const Json* value = member(object, key);
    if (!value) return otherwise;
    if (const auto number = as_whole_number(*value)) return *number;
    return fail(ErrorCode::parse, kNoItem, std::string(key) + " is no whole number of at least 0");
}

Result<std::string_view> gltf_json(std::string_view file, const std::string& path) {
    const auto opened = open_file(file, path);
    if (!opened) return tl::unexpected(opened.error());
    return opened->json;
}

Result<GltfDocument> read_gltf_document(const std::string& path) {
    const auto file = read_file(path);
    if (!file) return tl::unexpected(file.error());
    auto document = read_document(*file, path);
    if (!document) return in_file(path, "", document.error());
    return document;
}

void take_in_images(GltfDocument& document, const std::string& folder) {
    FilesBeside(folder, document).take_in_images();
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
