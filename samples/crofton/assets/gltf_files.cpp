// SPDX-License-Identifier: MIT
#include "assets/gltf_files.hpp"

#include <algorithm>
#include <map>

#include "assets/data_uri.hpp"
#include "assets/file.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

const std::string* uri_of(const Json& object) {
    const Json* uri = member(object, "uri");
    return uri && uri->is_string() ? &uri->get_ref<const std::string&>() : nullptr;
}

// Returns the contents of a URI. The asset's author chose the name, so only files below the asset's folder are opened.
// The bytes of files count towards the limit; those of data URIs are part of the document.
Result<std::string> bytes_of(const std::string& uri, const std::string& folder, std::uint64_t limit,
                             std::uint64_t& bytes_read) {
    if (is_data_uri(uri)) return decode_data_uri(uri);
    if (has_scheme(uri)) return fail(ErrorCode::unsupported, kNoItem, "'" + uri.substr(0, 80) + "' is not a file");
    const std::string name = decode_percent(uri);
    auto bytes = read_file_below(folder, name, limit - std::min(limit, bytes_read));
    if (bytes)
        bytes_read += bytes->size();
    else if (bytes.error().code == ErrorCode::budget_exceeded)
        return in_file(folder + name, "with the files read before", over_limit("bytes", limit));
    return bytes;
}

// Collects the files that a document refers to.
class FilesBeside {
  public:
    FilesBeside(std::string folder, GltfDocument& document) : folder_(std::move(folder)), document_(document) {}

    Result<void> read_buffers(const std::optional<std::string_view>& binary, bool whole) {
        const std::size_t count = entry_count(document_.root, "buffers");
        for (std::size_t i = 0; i < count; ++i) {
            std::string bytes;
            auto read = read_buffer(document_.root["buffers"][i], i == 0 ? binary : std::nullopt, bytes);
            if (!read) {
                Error error = read.error();
                error.item = i;
                error.message = "buffer " + std::to_string(i) + ": " + error.message;
                if (whole || error.code == ErrorCode::budget_exceeded) return error;
                document_.warnings.push_back(error.message);
            }
            document_.buffers.push_back(std::move(bytes));
        }
        return {};
    }

    void take_in_images() {
        const std::size_t count = entry_count(document_.root, "images");
        for (std::size_t i = 0; i < count; ++i) {
            const std::string* uri = uri_of(document_.root["images"][i]);
            if (uri && !has_scheme(*uri)) take_in_image(document_.root["images"][i], i, *uri);
        }
    }

  private:
    // Without a URI and a chunk (the place of what is compressed elsewhere) it holds nothing. Of one that is too short
    // there is what there is.
    Result<void> read_buffer(const Json& description, const std::optional<std::string_view>& binary,
                             std::string& bytes) {
        if (!description.is_object()) return fail(ErrorCode::parse, kNoItem, "is no object");
        const auto length = whole_number(description, "byteLength", 0);
        if (!length) return length.error();
        const std::string* uri = uri_of(description);
        if (!uri && !binary) return {};
        auto read =
            uri ? bytes_of(*uri, folder_, document_.limits.bytes, document_.bytes_read) : Result<std::string>(*binary);
        if (!read) return read.error();
        bytes = std::move(*read);
        if (bytes.size() < *length)
            return fail(ErrorCode::out_of_range, kNoItem,
                        std::to_string(bytes.size()) + " bytes, where byteLength is " + std::to_string(*length));
        bytes.resize(*length);
        return {};
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
        if (!views_.contains(uri)) {
            const auto bytes = bytes_of(uri, folder_, document_.limits.bytes, document_.bytes_read);
            if (!bytes) return warn(bytes.error().message);
            const char* type = type_of(*bytes);
            if (!type) return warn(folder_ + decode_percent(uri) + ": of unknown type");
            views_[uri] = {append_view(document_, *bytes), type};
        }
        const auto& [view, type] = views_[uri];
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

}  // namespace

Result<void> read_buffers(GltfDocument& document, const std::string& folder,
                          const std::optional<std::string_view>& binary, bool whole) {
    return FilesBeside(folder, document).read_buffers(binary, whole);
}

void take_in_images(GltfDocument& document, const std::string& folder) {
    FilesBeside(folder, document).take_in_images();
}

Result<std::string> image_bytes(const GltfDocument& document, std::size_t image, const std::string& folder,
                                std::uint64_t& bytes_read) {
    const Json* description = entry(document.root, "images", image);
    if (!description) return fail(ErrorCode::out_of_range, image, "does not exist");
    if (const std::string* uri = uri_of(*description)) return bytes_of(*uri, folder, document.limits.bytes, bytes_read);
    const auto number = whole_number(*description, "bufferView", kNoNumber);
    const Json* view = number ? entry(document.root, "bufferViews", *number) : nullptr;
    if (!view) return fail(ErrorCode::out_of_range, image, "has neither a URI nor a buffer view");
    const auto buffer = whole_number(*view, "buffer", kNoNumber), begin = whole_number(*view, "byteOffset", 0),
               length = whole_number(*view, "byteLength", 0);
    if (!buffer || !begin || !length || *buffer >= document.buffers.size())
        return fail(ErrorCode::parse, image, "its buffer view is damaged");
    const std::string& bytes = document.buffers[*buffer];
    if (*begin > bytes.size() || *length > bytes.size() - *begin)
        return fail(ErrorCode::out_of_range, image, "its view ends beyond its buffer");
    return bytes.substr(*begin, *length);
}

}  // namespace crofton::assets
