// SPDX-License-Identifier: MIT
#include "assets/gltf_accessor.hpp"

#include <tiny_gltf.h>

#include <string>

#include "assets/gltf_elements.hpp"

namespace crofton::assets {
namespace {

tl::unexpected<Error> in_accessor(int index, Error error) {
    error.item = static_cast<std::uint64_t>(index);
    error.message = "accessor " + std::to_string(index) + ": " + error.message;
    return tl::unexpected<Error>(std::move(error));
}

Result<Elements> find(const tinygltf::Model& model, int index) {
    const auto bad = [&](ErrorCode code, const std::string& why) {
        return in_accessor(index, Error{code, kNoItem, why});
    };
    const auto exists = [](int i, const auto& list) { return i >= 0 && static_cast<std::size_t>(i) < list.size(); };
    if (!exists(index, model.accessors)) return bad(ErrorCode::out_of_range, "does not exist");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.sparse.isSparse) return bad(ErrorCode::unsupported, "sparse accessors are not supported");
    if (!exists(accessor.bufferView, model.bufferViews)) return bad(ErrorCode::out_of_range, "has no buffer view");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (!exists(view.buffer, model.buffers)) return bad(ErrorCode::out_of_range, "its view has no buffer");
    const auto placed =
        place({model.buffers[static_cast<std::size_t>(view.buffer)].data, view.byteOffset, view.byteLength,
               view.byteStride, accessor.byteOffset, accessor.count, accessor.componentType,
               tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)), accessor.normalized});
    if (!placed) return in_accessor(index, placed.error());
    return placed;
}

}  // namespace

Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components) {
    const auto found = find(model, accessor);
    if (!found) return tl::unexpected(found.error());
    return to_floats(*found, components);
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor) {
    const auto found = find(model, accessor);
    if (!found) return tl::unexpected(found.error());
    auto indices = to_indices(*found);
    if (!indices) return in_accessor(accessor, indices.error());
    return indices;
}

}  // namespace crofton::assets
