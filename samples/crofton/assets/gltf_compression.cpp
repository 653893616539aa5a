// SPDX-License-Identifier: MIT
#include "assets/gltf_compression.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#if defined(CROFTON_MESHOPT)
#include <meshoptimizer.h>
#endif
#if defined(CROFTON_DRACO)
#include <draco/compression/decode.h>
#endif

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDraco = "KHR_draco_mesh_compression", kMeshopt = "EXT_meshopt_compression",
                           kNewMeshopt = "KHR_meshopt_compression";

Error bad(const char* why) {
    return fail(ErrorCode::parse, kNoItem, why);
}

Json* extension_of(Json& object, std::string_view name) {
    if (!object.is_object() || !object.contains("extensions")) return nullptr;
    Json& extensions = object["extensions"];
    if (!extensions.is_object() || !extensions.contains(std::string(name))) return nullptr;
    return &extensions[std::string(name)];
}

void remove_extension(Json& object, std::string_view name) {
    Json& extensions = object["extensions"];
    extensions.erase(std::string(name));
    if (extensions.empty()) object.erase("extensions");
}

// {"buffer", "byteOffset", "byteLength"} of a view or of a compressed one.
Result<std::string_view> bytes_at(const GltfDocument& document, const Json& place) {
    const auto buffer = whole_number(place, "buffer", kNoNumber), begin = whole_number(place, "byteOffset", 0),
               length = whole_number(place, "byteLength", 0);
    if (!buffer || !begin || !length || *buffer >= document.buffers.size()) return bad("its buffer does not exist");
    const std::string_view bytes = document.buffers[*buffer];
    if (*begin > bytes.size() || *length > bytes.size() - *begin) return bad("ends beyond its buffer");
    return bytes.substr(*begin, *length);
}

[[maybe_unused]] std::string text_of(const Json& object, const char* key) {
    const Json* value = member(object, key);
    return value && value->is_string() ? value->get<std::string>() : "";
}

// Whether a view that is compressed elsewhere, or a primitive, has its bytes in plain form as well.
bool has_plain_view(const GltfDocument& document, const Json& view) {
    const auto bytes = bytes_at(document, view);
    return bytes && !bytes->empty();
}
bool has_plain_accessors(const GltfDocument& document, const Json& primitive) {
    const auto in_view = [&](const Json& number) {
        const auto index = as_whole_number(number);
        const Json* accessor = index ? entry(document.root, "accessors", *index) : nullptr;
        return accessor && member(*accessor, "bufferView");
    };
    const Json *attributes = member(primitive, "attributes"), *indices = member(primitive, "indices");
    const Json* positions = attributes ? member(*attributes, "POSITION") : nullptr;
    return positions && in_view(*positions) && (!indices || in_view(*indices));
}

#if defined(CROFTON_MESHOPT)

// The library asserts what it needs: everything is checked here first.
Result<std::string> decode_meshopt(const GltfDocument& document, const Json& view) {
    const auto from = bytes_at(document, view);
    if (!from) return from.error();
    const auto count = whole_number(view, "count", 0), stride = whole_number(view, "byteStride", 0);
    if (!count || !stride || *stride == 0 || *stride > 256) return bad("its count or stride is damaged");
    if (*count > document.limits.bytes / *stride) return over_limit("bytes", document.limits.bytes);
    const std::string mode = text_of(view, "mode"), filter = text_of(view, "filter");
    std::string bytes(*count * *stride, '\0');
    const auto* data = reinterpret_cast<const unsigned char*>(from->data());
    const bool index_size = *stride == 2 || *stride == 4;
    int failed = -1;
    if (mode == "ATTRIBUTES" && *stride % 4 == 0)
        failed = meshopt_decodeVertexBuffer(bytes.data(), *count, *stride, data, from->size());
    else if (mode == "TRIANGLES" && index_size && *count % 3 == 0)
        failed = meshopt_decodeIndexBuffer(bytes.data(), *count, *stride, data, from->size());
    else if (mode == "INDICES" && index_size)
        failed = meshopt_decodeIndexSequence(bytes.data(), *count, *stride, data, from->size());
    if (failed != 0 && mode == "ATTRIBUTES" && !from->empty() && data[0] == 0xA1)
        return bad("is of version 1, which the installed libmeshoptimizer does not read");
    if (failed != 0) return bad("is damaged");
    if (filter.empty() || filter == "NONE") return bytes;
    if (filter == "OCTAHEDRAL" && (*stride == 4 || *stride == 8))
        meshopt_decodeFilterOct(bytes.data(), *count, *stride);
    else if (filter == "QUATERNION" && *stride == 8)
        meshopt_decodeFilterQuat(bytes.data(), *count, *stride);
    else if (filter == "EXPONENTIAL" && *stride % 4 == 0)
        meshopt_decodeFilterExp(bytes.data(), *count, *stride);
    else
        return bad("has an unknown filter");
    return bytes;
}

#endif
#if defined(CROFTON_DRACO)

template <class T>
void append_values(std::string& bytes, const draco::PointAttribute& attribute, std::uint32_t points, int components) {
    T value[16] = {};
    // Attributes of glTF begin at multiples of four bytes.
    const std::size_t size = static_cast<std::size_t>(components) * sizeof(T);
    for (std::uint32_t p = 0; p < points; ++p) {
        attribute.ConvertValue<T>(attribute.mapped_index(draco::PointIndex(p)), static_cast<std::int8_t>(components),
                                  value);
        bytes.append(reinterpret_cast<const char*>(value), size);
        bytes.append((4 - size % 4) % 4, '\0');
    }
}

int components_named(const std::string& type) {
    return type == "SCALAR" ? 1 : type.size() == 4 && type.rfind("VEC", 0) == 0 ? std::clamp(type[3] - '0', 0, 4) : 0;
}

// A plain accessor with the values of a decoded attribute, described as `old` is.
Result<std::size_t> plain_accessor(GltfDocument& document, const draco::PointAttribute& attribute, std::uint32_t points,
                                   const Json& old) {
    const auto type = whole_number(old, "componentType", 0);
    const int components = components_named(text_of(old, "type"));
    if (!type || components == 0) return bad("an attribute is of unknown type");
    std::string bytes;
    if (*type == kGltfFloat)
        append_values<float>(bytes, attribute, points, components);
    else if (*type == kGltfUnsignedByte)
        append_values<std::uint8_t>(bytes, attribute, points, components);
    else if (*type == kGltfByte)
        append_values<std::int8_t>(bytes, attribute, points, components);
    else if (*type == kGltfUnsignedShort)
        append_values<std::uint16_t>(bytes, attribute, points, components);
    else if (*type == kGltfShort)
        append_values<std::int16_t>(bytes, attribute, points, components);
    else
        return bad("an attribute is of unknown type");
    const std::size_t stride = points > 0 ? bytes.size() / points : 0;
    const std::size_t view = append_view(document, bytes, kGltfVertexTarget);
    document.root["bufferViews"][view]["byteStride"] = stride;
    Json accessor = old;
    accessor.erase("byteOffset");
    accessor.erase("sparse");
    accessor["bufferView"] = view;
    accessor["count"] = points;
    document.root["accessors"].push_back(std::move(accessor));
    return document.root["accessors"].size() - 1;
}

Result<void> decode_draco(GltfDocument& document, Json& primitive, const Json& compressed) {
    const auto view = whole_number(compressed, "bufferView", kNoNumber);
    const Json* place = view ? entry(document.root, "bufferViews", *view) : nullptr;
    if (!place) return bad("its buffer view does not exist");
    const auto from = bytes_at(document, *place);
    if (!from) return from.error();
    draco::DecoderBuffer buffer;
    buffer.Init(from->data(), from->size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return bad("is damaged");
    const draco::Mesh& mesh = *decoded.value();
    const std::uint32_t faces = mesh.num_faces(), points = mesh.num_points();
    if (faces > document.limits.triangles || points / 3 > document.limits.triangles)
        return over_limit("triangles", document.limits.triangles);
    const Json* ids = member(compressed, "attributes");
    const Json* attributes = member(primitive, "attributes");
    if (!ids || !ids->is_object() || !attributes) return bad("has no attributes");
    Json plain = *attributes;
    for (const auto& item : ids->items()) {
        const auto id = as_whole_number(item.value());
        const auto* attribute =
            id ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(std::min<std::size_t>(*id, ~0u))) : nullptr;
        const Json* named = member(*attributes, item.key().c_str());
        const auto number = named ? as_whole_number(*named) : std::nullopt;
        const Json* old = number ? entry(document.root, "accessors", *number) : nullptr;
        if (!attribute || !old) return bad("an attribute does not exist");
        const auto made = plain_accessor(document, *attribute, points, Json(*old));
        if (!made) return made.error();
        plain[item.key()] = *made;
    }
    std::string indices;
    for (std::uint32_t f = 0; f < faces; ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t index = mesh.face(draco::FaceIndex(f))[k].value();
            indices.append(reinterpret_cast<const char*>(&index), sizeof index);
        }
    primitive["indices"] =
        append_accessor(document, indices, std::size_t{3} * faces, kGltfUnsignedInt, "SCALAR", kGltfIndexTarget);
    primitive["attributes"] = std::move(plain);
    // A strip is decoded as plain triangles.
    if (const auto mode = whole_number(primitive, "mode", kGltfTriangles); mode && *mode > kGltfTriangles)
        primitive.erase("mode");
    return {};
}

#endif

class Decompressor {
  public:
    Decompressor(GltfDocument& document, bool plain_copies) : document_(document), plain_copies_(plain_copies) {}

    Result<void> views(std::string_view extension) {
        for (std::size_t v = 0; v < entry_count(document_.root, "bufferViews"); ++v) {
            const Json* compressed = extension_of(document_.root["bufferViews"][v], extension);
            if (!compressed) continue;
            const bool has_plain = plain_copies_ && has_plain_view(document_, document_.root["bufferViews"][v]);
            bool decoded = false;
#if defined(CROFTON_MESHOPT)
            const auto bytes = decode_meshopt(document_, *compressed);
            if (auto done = note("buffer view " + std::to_string(v), extension, bytes, has_plain); !done) return done;
            decoded = bytes.has_value();
            if (decoded) {
                const std::size_t stride = *whole_number(*compressed, "byteStride", 0);
                const std::size_t plain = append_view(document_, *bytes);
                Json& view = document_.root["bufferViews"][v];
                for (const char* key : {"buffer", "byteOffset", "byteLength"})
                    view[key] = document_.root["bufferViews"][plain][key];
                document_.root["bufferViews"].erase(plain);
                if (view.contains("byteStride")) view["byteStride"] = stride;
            }
#endif
            if (decoded || has_plain)
                remove_extension(document_.root["bufferViews"][v], extension);
            else
                ++left_;
        }
        return finish(extension);
    }

    Result<void> primitives() {
        for (std::size_t m = 0; m < entry_count(document_.root, "meshes"); ++m)
            for (std::size_t p = 0; p < entry_count(document_.root["meshes"][m], "primitives"); ++p) {
                Json primitive = document_.root["meshes"][m]["primitives"][p];
                const Json* compressed = extension_of(primitive, kDraco);
                if (!compressed) continue;
                const bool has_plain = plain_copies_ && has_plain_accessors(document_, primitive);
                bool decoded = false;
#if defined(CROFTON_DRACO)
                const auto done = decode_draco(document_, primitive, Json(*compressed));
                const std::string name = "mesh " + std::to_string(m) + ": primitive " + std::to_string(p);
                if (auto noted = note(name, kDraco, done, has_plain); !noted) return noted;
                decoded = done.has_value();
#endif
                if (decoded || has_plain) {
                    remove_extension(primitive, kDraco);
                    document_.root["meshes"][m]["primitives"][p] = std::move(primitive);
                } else {
                    ++left_;
                }
            }
        return finish(kDraco);
    }

  private:
    template <class T>
    [[maybe_unused]] Result<void> note(const std::string& what, std::string_view extension, const Result<T>& decoded,
                                       bool has_plain) {
        std::size_t bytes = 0;
        for (const std::string& buffer : document_.buffers) bytes += buffer.size();
        if (bytes > document_.limits.bytes) return over_limit("bytes", document_.limits.bytes);
        if (decoded) return {};
        document_.warnings.push_back(what + ": " + std::string(extension) + ": " + decoded.error().message +
                                     (has_plain ? "; its uncompressed copy is read" : ""));
        return {};
    }

    // The names of what no longer occurs.
    Result<void> finish(std::string_view extension) {
        if (std::exchange(left_, 0) > 0) return {};
        for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
            if (!document_.root.contains(list) || !document_.root[list].is_array()) continue;
            Json kept = Json::array();
            for (const Json& name : document_.root[list])
                if (name != Json(std::string(extension))) kept.push_back(name);
            if (kept.empty())
                document_.root.erase(list);
            else
                document_.root[list] = std::move(kept);
        }
        return {};
    }

    GltfDocument& document_;
    bool plain_copies_;
    std::size_t left_ = 0;
};

}  // namespace

bool decodes(std::string_view extension) {
#if defined(CROFTON_DRACO)
    if (extension == kDraco) return true;
#endif
#if defined(CROFTON_MESHOPT)
    if (extension == kMeshopt || extension == kNewMeshopt) return true;
#endif
    static_cast<void>(extension);
    return false;
}

const char* decoder_package(std::string_view extension) {
    if (extension == kDraco) return "libdraco-dev";
    return extension == kMeshopt || extension == kNewMeshopt ? "libmeshoptimizer-dev" : nullptr;
}

std::string why_compressed(std::string_view extension) {
    const std::string name(extension);
    if (decodes(extension)) return "compressed by " + name + ", and could not be decoded";
    if (const char* package = decoder_package(extension))
        return "this build has no decoder for " + name + ": install " + package + " and configure again";
    return "compressed by " + name + ", which is not supported";
}

Result<void> decompress(GltfDocument& document, bool plain_copies) {
    Decompressor run(document, plain_copies);
    for (const std::string_view extension : {kMeshopt, kNewMeshopt})
        if (auto done = run.views(extension); !done) return done;
    return run.primitives();
}

}  // namespace crofton::assets
