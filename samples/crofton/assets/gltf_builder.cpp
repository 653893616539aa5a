// SPDX-License-Identifier: MIT
#include "assets/gltf_builder.hpp"

#include <glm/common.hpp>

namespace crofton::assets {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
std::string_view bytes_of(std::span<const T> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

Json node_of(const Transform& t, scene::MeshId mesh) {
    Json matrix = Json::array();
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) matrix.push_back(t.linear[column][row]);
        matrix.push_back(0);
    }
    for (int row = 0; row < 3; ++row) matrix.push_back(t.translation[row]);
    matrix.push_back(1);
    return {{"mesh", mesh}, {"matrix", std::move(matrix)}};
}

}  // namespace

std::size_t append_positions(GltfDocument& document, std::span<const glm::vec3> positions) {
    const std::size_t accessor = append_vectors(document, positions);
    glm::vec3 low = positions[0], high = low;
    for (const glm::vec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    document.root["accessors"][accessor]["min"] = {low.x, low.y, low.z};
    document.root["accessors"][accessor]["max"] = {high.x, high.y, high.z};
    return accessor;
}

std::size_t append_vectors(GltfDocument& document, std::span<const glm::vec3> vectors) {
    return append_accessor(document, bytes_of(vectors), vectors.size(), kGltfFloat, "VEC3", kGltfVertexTarget);
}

std::size_t append_vectors(GltfDocument& document, std::span<const glm::vec2> vectors) {
    return append_accessor(document, bytes_of(vectors), vectors.size(), kGltfFloat, "VEC2", kGltfVertexTarget);
}

std::size_t append_indices(GltfDocument& document, std::span<const std::uint32_t> indices) {
    return append_accessor(document, bytes_of(indices), indices.size(), kGltfUnsignedInt, "SCALAR", kGltfIndexTarget);
}

GltfDocument gltf_from_scene(const scene::Scene& scene) {
    GltfDocument document;
    Json meshes = Json::array(), nodes = Json::array(), roots = Json::array();
    for (scene::MeshId m = 0; m < scene.mesh_count(); ++m) {
        const TriangleMesh& mesh = scene.mesh(m);
        Json attributes{{"POSITION", append_positions(document, mesh.positions)}};
        if (!mesh.colors.empty()) attributes["COLOR_0"] = append_vectors(document, mesh.colors);
        const std::size_t indices = append_indices(document, mesh.indices);
        Json primitives = Json::array();
        primitives.push_back({{"attributes", std::move(attributes)}, {"indices", indices}});
        meshes.push_back({{"name", std::string(scene.mesh_name(m))}, {"primitives", std::move(primitives)}});
    }
    for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
        if (scene.is_removed(i)) continue;
        roots.push_back(nodes.size());
        nodes.push_back(node_of(scene.world(scene.node_of(i)), scene.mesh_of(i)));
    }
    document.root["asset"] = {{"version", "2.0"}, {"generator", "crofton"}};
    document.root["scene"] = 0;
    document.root["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
    document.root["nodes"] = std::move(nodes);
    document.root["meshes"] = std::move(meshes);
    return document;
}

}  // namespace crofton::assets
