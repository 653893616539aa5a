// SPDX-License-Identifier: MIT
// Accessors of a document: from JSON that may say anything to elements that are there.
#include <cstring>

#include "assets/gltf_compression.hpp"
#include "assets/gltf_document.hpp"

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

Error bad(ErrorCode code, std::string why) {
    return fail(code, kNoItem, std::move(why));
}

int components_of(const Json& accessor) {
    const Json* type = member(accessor, "type");
    if (!type || !type->is_string()) return 0;
    const auto& name = type->get_ref<const std::string&>();
    constexpr std::pair<const char*, int> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                      {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    for (const auto& [known, components] : kTypes)
        if (name == known) return components;
    return 0;
}

// Fills in where `reference`'s view lies: {"bufferView", "byteOffset"} of an accessor or of a part of a sparse one.
Result<void> locate(const GltfDocument& document, const Json& reference, ElementLayout& layout) {
    const auto number = whole_number(reference, "bufferView", kNoNumber),
               offset = whole_number(reference, "byteOffset", 0);
    if (!number) return number.error();
    if (!offset) return offset.error();
    const Json* view = entry(document.root, "bufferViews", *number);
    if (!view) return bad(ErrorCode::out_of_range, "its buffer view does not exist");
    if (const Json* extensions = member(*view, "extensions"); extensions && extensions->is_object())
        for (const auto& item : extensions->items())
            if (item.key().find("compression") != std::string::npos)
                return bad(ErrorCode::unsupported, why_compressed(item.key()));
    const auto buffer = whole_number(*view, "buffer", kNoNumber), begin = whole_number(*view, "byteOffset", 0),
               length = whole_number(*view, "byteLength", 0), stride = whole_number(*view, "byteStride", 0);
    for (const auto* value : {&buffer, &begin, &length, &stride})
        if (!*value) return value->error();
    if (*buffer >= document.buffers.size()) return bad(ErrorCode::out_of_range, "its view has no buffer");
    const std::string& bytes = document.buffers[*buffer];
    layout.buffer = {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
    layout.view_offset = *begin;
    layout.view_length = *length;
    layout.view_stride = *stride;
    layout.offset = *offset;
    return {};
}

Result<int> component_type_of(const Json& object) {
    const auto type = whole_number(object, "componentType", 0);
    if (!type) return type.error();
    return *type <= kGltfDouble ? static_cast<int>(*type) : 0;
}

// Replaces elements of `packed`, `element` bytes each.
Result<void> apply_sparse(const GltfDocument& document, const Json& sparse, const ElementLayout& dense,
                          std::size_t element, std::string& packed) {
    const auto count = whole_number(sparse, "count", 0);
    const Json *indices = member(sparse, "indices"), *values = member(sparse, "values");
    if (!count || !indices || !values) return bad(ErrorCode::parse, "its sparse part is damaged");
    ElementLayout index_layout, value_layout = dense;
    const auto type = component_type_of(*indices);
    if (!type) return type.error();
    index_layout.component_type = *type;
    index_layout.components = 1;
    index_layout.count = value_layout.count = *count;
    if (auto found = locate(document, *indices, index_layout); !found) return found;
    if (auto found = locate(document, *values, value_layout); !found) return found;
    const auto placed_indices = place(index_layout), placed_values = place(value_layout);
    if (!placed_indices) return placed_indices.error();
    if (!placed_values) return placed_values.error();
    const auto numbers = to_indices(*placed_indices);
    if (!numbers) return numbers.error();
    for (std::size_t i = 0; i < numbers->size(); ++i) {
        if ((*numbers)[i] >= dense.count)
            return bad(ErrorCode::out_of_range, "its sparse part replaces element " + std::to_string((*numbers)[i]) +
                                                    " of " + std::to_string(dense.count));
        std::memcpy(packed.data() + (*numbers)[i] * element, placed_values->data + i * placed_values->stride, element);
    }
    return {};
}

// Elements that the file does not hold: zeros but for what a sparse part replaces.
Result<Elements> assemble(const GltfDocument& document, const Json& description, const ElementLayout& layout,
                          bool has_view, std::string& storage) {
    const std::size_t element = component_size(layout.component_type) * static_cast<std::size_t>(layout.components);
    if (element == 0) return bad(ErrorCode::parse, "unknown type");
    storage.assign(layout.count * element, '\0');
    if (has_view) {
        const auto base = place(layout);
        if (!base) return base;
        for (std::size_t i = 0; i < layout.count; ++i)
            std::memcpy(storage.data() + i * element, base->data + i * base->stride, element);
    }
    if (const Json* sparse = member(description, "sparse"))
        if (auto done = apply_sparse(document, *sparse, layout, element, storage); !done) return done.error();
    return Elements{reinterpret_cast<const unsigned char*>(storage.data()),
                    layout.count,
                    element,
                    layout.component_type,
                    layout.components,
                    layout.normalized};
}

Result<Elements> find(const GltfDocument& document, std::size_t accessor, std::optional<std::size_t> count,
                      std::string& storage) {
    const Json* description = entry(document.root, "accessors", accessor);
    if (!description) return bad(ErrorCode::out_of_range, "does not exist");
    ElementLayout layout;
    const auto type = component_type_of(*description);
    const auto given = whole_number(*description, "count", 0);
    if (!type) return type.error();
    if (!given) return given.error();
    if (count && *given != *count)
        return bad(ErrorCode::out_of_range,
                   std::to_string(*given) + " elements for " + std::to_string(*count) + " vertices");
    layout.component_type = *type;
    layout.components = components_of(*description);
    layout.count = *given;
    if (const Json* normalized = member(*description, "normalized"))
        layout.normalized = normalized->is_boolean() && normalized->get<bool>();
    const bool has_view = member(*description, "bufferView") != nullptr;
    if (has_view)
        if (auto found = locate(document, *description, layout); !found) return found.error();
    if (has_view && !member(*description, "sparse")) return place(layout);
    // Without a view nothing in the file bounds how many zeros it asks for.
    if (!has_view && *given > document.limits.triangles)
        return bad(ErrorCode::budget_exceeded, std::to_string(*given) + " elements without a buffer view: " +
                                                   over_limit("triangles", document.limits.triangles).message);
    if (!has_view && *given == 0) return bad(ErrorCode::empty, "holds nothing");
    if (has_view)
        if (const auto base = place(layout); !base) return base;
    return assemble(document, *description, layout, has_view, storage);
}

}  // namespace

Result<Elements> accessor_elements(const GltfDocument& document, std::size_t accessor, std::optional<std::size_t> count,
                                   std::string& storage) {
    auto found = find(document, accessor, count, storage);
    if (!found) {
        found.error().item = accessor;
        found.error().message = "accessor " + std::to_string(accessor) + ": " + found.error().message;
    }
    return found;
}

}  // namespace crofton::assets
