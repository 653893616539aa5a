#include "glb_writer.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

namespace crofton::cli {
namespace {

using nlohmann::json;

// Constants of the glTF 2.0 specification.
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

void append(std::string& bytes, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFu));
}

class GlbWriter {
  public:
    std::string write(const scene::Scene& scene, std::span<const TriangleMesh> meshes) {
        document_ = {{"asset", {{"version", "2.0"}, {"generator", "crofton"}}}, {"scene", 0}};
        for (std::size_t m = 0; m < meshes.size(); ++m)
            add_mesh(meshes[m], scene.mesh_name(static_cast<scene::MeshId>(m)));
        json roots = json::array();
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
            if (scene.is_removed(i)) continue;
            roots.push_back(document_["nodes"].size());
            document_["nodes"].push_back(node(scene.world(scene.node_of(i)), scene.mesh_of(i)));
        }
        document_["scenes"] = {{{"nodes", roots}}};
        document_["buffers"] = {{{"byteLength", binary_.size()}}};
        return assemble();
    }

  private:
    static json node(const scene::Transform& t, scene::MeshId mesh) {
        json matrix = json::array();
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) matrix.push_back(t.linear[column][row]);
            matrix.push_back(0);
        }
        for (int row = 0; row < 3; ++row) matrix.push_back(t.translation[row]);
        matrix.push_back(1);
        return {{"mesh", mesh}, {"matrix", matrix}};
    }

    std::size_t accessor(const void* data, std::size_t bytes, std::size_t count, int component, const char* type,
                         int target) {
        document_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}, {"target", target}});
        binary_.append(static_cast<const char*>(data), bytes);
        const std::size_t view = document_["bufferViews"].size() - 1;
        document_["accessors"].push_back(
            {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
        return document_["accessors"].size() - 1;
    }

    void add_mesh(const TriangleMesh& mesh, const std::string& name) {
        glm::vec3 low = mesh.positions[0], high = low;
        for (const auto& p : mesh.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        const std::size_t bytes = mesh.positions.size() * sizeof(glm::vec3);
        const std::size_t position =
            accessor(mesh.positions.data(), bytes, mesh.positions.size(), kFloat, "VEC3", kArrayBuffer);
        document_["accessors"][position]["min"] = {low.x, low.y, low.z};
        document_["accessors"][position]["max"] = {high.x, high.y, high.z};
        json attributes{{"POSITION", position}};
        if (!mesh.colors.empty())
            attributes["COLOR_0"] =
                accessor(mesh.colors.data(), bytes, mesh.colors.size(), kFloat, "VEC3", kArrayBuffer);
        const std::size_t indices = accessor(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t),
                                             mesh.indices.size(), kUnsignedInt, "SCALAR", kElementArrayBuffer);
        document_["meshes"].push_back(
            {{"name", name}, {"primitives", {{{"attributes", attributes}, {"indices", indices}}}}});
    }

    std::string assemble() {
        std::string text = document_.dump(-1, ' ', false, json::error_handler_t::replace);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
        std::string glb;
        append(glb, kMagic);
        append(glb, 2);
        append(glb, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + binary_.size()));
        append(glb, static_cast<std::uint32_t>(text.size()));
        append(glb, kJsonChunk);
        glb += text;
        append(glb, static_cast<std::uint32_t>(binary_.size()));
        append(glb, kBinaryChunk);
        return glb + binary_;
    }

    json document_;
    std::string binary_;
};

}  // namespace

std::string make_glb(const scene::Scene& scene, std::span<const TriangleMesh> meshes) {
    return GlbWriter().write(scene, meshes);
}

}  // namespace crofton::cli
