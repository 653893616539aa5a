// SPDX-License-Identifier: MIT
#include "assets/gltf_elements.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

namespace crofton::assets {
namespace {

template <class T>
float decode(const unsigned char* from, bool normalized) {
    T value;
    std::memcpy(&value, from, sizeof value);
    const float number = static_cast<float>(value);
    if (!normalized) return number;
    return std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float component(const Elements& e, std::size_t element, int k) {
    const unsigned char* at =
        e.data + element * e.stride + static_cast<std::size_t>(k) * component_size(e.component_type);
    switch (e.component_type) {
        case kGltfFloat:
            return decode<float>(at, false);
        case kGltfDouble:
            return decode<double>(at, false);
        case kGltfUnsignedInt:
            return decode<std::uint32_t>(at, false);
        case kGltfUnsignedShort:
            return decode<std::uint16_t>(at, e.normalized);
        case kGltfShort:
            return decode<std::int16_t>(at, e.normalized);
        case kGltfUnsignedByte:
            return decode<std::uint8_t>(at, e.normalized);
        case kGltfByte:
            return decode<std::int8_t>(at, e.normalized);
        default:
            return decode<std::int32_t>(at, false);
    }
}

}  // namespace

std::size_t component_size(int component_type) {
    switch (component_type) {
        case kGltfByte:
        case kGltfUnsignedByte:
            return 1;
        case kGltfShort:
        case kGltfUnsignedShort:
            return 2;
        case kGltfInt:
        case kGltfUnsignedInt:
        case kGltfFloat:
            return 4;
        case kGltfDouble:
            return 8;
        default:
            return 0;
    }
}

Result<Elements> place(const ElementLayout& l) {
    const auto bad = [](ErrorCode code, const std::string& why) { return fail(code, kNoItem, why); };
    if (l.view_offset > l.buffer.size() || l.view_length > l.buffer.size() - l.view_offset)
        return bad(ErrorCode::out_of_range,
                   "its view ends beyond its buffer of " + std::to_string(l.buffer.size()) + " bytes");
    const std::size_t element = component_size(l.component_type) * static_cast<std::size_t>(std::max(l.components, 0));
    if (element == 0) return bad(ErrorCode::parse, "unknown type");
    const std::size_t stride = l.view_stride == 0 ? element : l.view_stride;
    if (stride < element) return bad(ErrorCode::parse, "elements overlap");
    if (l.count == 0) return bad(ErrorCode::empty, "holds nothing");
    const std::size_t room = l.offset <= l.view_length ? l.view_length - l.offset : 0;
    if (room < element || l.count - 1 > (room - element) / stride)
        return bad(ErrorCode::out_of_range, std::to_string(l.count) + " elements do not fit its view");
    return Elements{
        l.buffer.data() + l.view_offset + l.offset, l.count, stride, l.component_type, l.components, l.normalized};
}

std::vector<float> to_floats(const Elements& elements, int components) {
    const auto width = static_cast<std::size_t>(components);
    std::vector<float> result(elements.count * width, 1.0f);
    const int given = std::min(components, elements.components);
    for (std::size_t i = 0; i < elements.count; ++i)
        for (int k = 0; k < given; ++k) result[i * width + static_cast<std::size_t>(k)] = component(elements, i, k);
    return result;
}

Result<std::vector<std::uint32_t>> to_indices(const Elements& elements) {
    const int type = elements.component_type;
    if (elements.components != 1 ||
        (type != kGltfUnsignedByte && type != kGltfUnsignedShort && type != kGltfUnsignedInt))
        return fail(ErrorCode::parse, kNoItem, "indices must be unsigned scalars");
    std::vector<std::uint32_t> result(elements.count, 0);
    for (std::size_t i = 0; i < elements.count; ++i) {
        const unsigned char* from = elements.data + i * elements.stride;
        for (std::size_t b = 0; b < component_size(type); ++b)
            result[i] |= static_cast<std::uint32_t>(from[b]) << (8 * b);
    }
    return result;
}

std::vector<std::uint32_t> triangle_list(int mode, std::vector<std::uint32_t> in) {
    if (mode == kGltfTriangles) return in;
    std::vector<std::uint32_t> out;
    const bool fan = mode == kGltfTriangleFan;
    if (!fan && mode != kGltfTriangleStrip) return out;
    for (std::size_t i = 2; i < in.size(); ++i)
        out.insert(out.end(), {fan ? in[0] : in[i - 2 + i % 2], in[i - 1 - (fan ? 0 : i % 2)], in[i]});
    return out;
}

}  // namespace crofton::assets
