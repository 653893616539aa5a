#include "assets/gltf_accessor.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

namespace crofton::assets {
namespace {

struct Elements {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component_type = 0, components = 0;
    bool normalized = false;
};

Result<Elements> find(const tinygltf::Model& model, int index) {
    const auto bad = [&](ErrorCode code, const std::string& why) {
        return fail(code, static_cast<std::uint64_t>(index), "accessor " + std::to_string(index) + ": " + why);
    };
    const auto exists = [](int i, const auto& list) { return i >= 0 && static_cast<std::size_t>(i) < list.size(); };
    if (!exists(index, model.accessors)) return bad(ErrorCode::out_of_range, "does not exist");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.sparse.isSparse) return bad(ErrorCode::unsupported, "sparse accessors are not supported");
    if (!exists(accessor.bufferView, model.bufferViews)) return bad(ErrorCode::out_of_range, "has no buffer view");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (!exists(view.buffer, model.buffers)) return bad(ErrorCode::out_of_range, "its view has no buffer");
    const auto& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        return bad(ErrorCode::out_of_range,
                   "its view ends beyond its buffer of " + std::to_string(bytes.size()) + " bytes");
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (size <= 0 || components <= 0) return bad(ErrorCode::parse, "unknown type");
    const std::size_t element = static_cast<std::size_t>(size) * static_cast<std::size_t>(components);
    const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
    if (stride < element) return bad(ErrorCode::parse, "elements overlap");
    if (accessor.count == 0) return bad(ErrorCode::empty, "holds nothing");
    const std::size_t room = accessor.byteOffset <= view.byteLength ? view.byteLength - accessor.byteOffset : 0;
    if (room < element || accessor.count - 1 > (room - element) / stride)
        return bad(ErrorCode::out_of_range, std::to_string(accessor.count) + " elements do not fit its view");
    return Elements{bytes.data() + view.byteOffset + accessor.byteOffset,
                    accessor.count,
                    stride,
                    accessor.componentType,
                    components,
                    accessor.normalized};
}

template <class T>
float decode(const unsigned char* from, bool normalized) {
    T value;
    std::memcpy(&value, from, sizeof value);
    const float number = static_cast<float>(value);
    if (!normalized) return number;
    return std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float component(const Elements& e, std::size_t element, int k) {
    const auto at = [&](std::size_t size) { return e.data + element * e.stride + static_cast<std::size_t>(k) * size; };
    switch (e.component_type) {
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return decode<float>(at(4), false);
        case TINYGLTF_COMPONENT_TYPE_DOUBLE:
            return decode<double>(at(8), false);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return decode<std::uint32_t>(at(4), false);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return decode<std::uint16_t>(at(2), e.normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return decode<std::int16_t>(at(2), e.normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return decode<std::uint8_t>(at(1), e.normalized);
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return decode<std::int8_t>(at(1), e.normalized);
        default:
            return decode<std::int32_t>(at(4), false);
    }
}

}  // namespace

Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components) {
    const auto found = find(model, accessor);
    if (!found) return tl::unexpected(found.error());
    std::vector<float> result(found->count * static_cast<std::size_t>(components), 1.0f);
    const int given = std::min(components, found->components);
    for (std::size_t i = 0; i < found->count; ++i)
        for (int k = 0; k < given; ++k)
            result[i * static_cast<std::size_t>(components) + static_cast<std::size_t>(k)] = component(*found, i, k);
    return result;
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor) {
    const auto found = find(model, accessor);
    if (!found) return tl::unexpected(found.error());
    const int type = found->component_type;
    const std::size_t size = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                             : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                             : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? 4
                                                                              : 0;
    if (size == 0 || found->components != 1)
        return fail(ErrorCode::parse, static_cast<std::uint64_t>(accessor),
                    "accessor " + std::to_string(accessor) + ": indices must be unsigned scalars");
    std::vector<std::uint32_t> result(found->count, 0);
    for (std::size_t i = 0; i < found->count; ++i) {
        const unsigned char* from = found->data + i * found->stride;
        for (std::size_t b = 0; b < size; ++b) result[i] |= static_cast<std::uint32_t>(from[b]) << (8 * b);
    }
    return result;
}

}  // namespace crofton::assets
