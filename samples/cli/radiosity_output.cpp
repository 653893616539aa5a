#include "radiosity_output.hpp"

#include <algorithm>
#include <crofton/render/device.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numeric>

#include "../pipeline/png.hpp"
#include "report.hpp"

namespace crofton::cli {

TriangleMesh baked(const radiosity::Patches& patches, std::span<const glm::vec3> radiosity, double exposure) {
    const auto corners = radiosity::corner_values(patches, radiosity);
    TriangleMesh mesh;
    mesh.indices.resize(corners.size());
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
    for (std::size_t c = 0; c < corners.size(); ++c) {
        mesh.positions.push_back(patches.mesh.positions[patches.mesh.indices[c]]);
        mesh.colors.push_back(glm::min(corners[c] * static_cast<float>(exposure), glm::vec3(1.0f)));
    }
    return mesh;
}

Result<void> write_glb(const std::string& path, const TriangleMesh& mesh) {
    const std::size_t bytes = mesh.positions.size() * sizeof(glm::vec3);
    glm::vec3 low = mesh.positions[0], high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const auto accessor = [&](int view) {
        return nlohmann::json{
            {"bufferView", view}, {"componentType", 5126}, {"count", mesh.positions.size()}, {"type", "VEC3"}};
    };
    nlohmann::json position = accessor(0);
    position["min"] = {low.x, low.y, low.z};
    position["max"] = {high.x, high.y, high.z};
    const nlohmann::json document = {
        {"asset", {{"version", "2.0"}, {"generator", "crofton radiosity"}}},
        {"extensionsUsed", {"KHR_materials_unlit"}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {{{"mesh", 0}, {"name", "lit"}}}},
        {"materials", {{{"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"material", 0}}}}}}},
        {"accessors", {position, accessor(1)}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", bytes}},
          {{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", bytes}}}},
        {"buffers", {{{"byteLength", 2 * bytes}}}}};
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string file;
    const auto word = [&](std::size_t value) {
        for (int shift = 0; shift < 32; shift += 8) file += static_cast<char>(value >> shift & 255u);
    };
    const std::size_t size = 12 + 8 + json.size() + 8 + 2 * bytes;
    if (size >> 32 != 0) return fail(ErrorCode::out_of_range, kNoItem, path + ": glTF holds 4 GiB at most");
    file += "glTF";
    word(2);
    word(size);
    word(json.size());
    file += "JSON" + json;
    word(2 * bytes);
    file += std::string("BIN\0", 4);
    file.append(reinterpret_cast<const char*>(mesh.positions.data()), bytes);
    file.append(reinterpret_cast<const char*>(mesh.colors.data()), bytes);
    return write_file(path, file);
}

Result<void> write_lit_picture(const std::string& path, const TriangleMesh& mesh, const Camera& camera,
                               std::uint32_t width, std::uint32_t height) {
    render::DeviceOptions wanted;
    wanted.kind = render::DeviceKind::any;
    auto device = render::Device::create(wanted);
    if (!device) return tl::unexpected(device.error());
    auto rasterizer = render::Rasterizer::create(*device, {.width = width, .height = height, .cull_back_faces = false});
    if (!rasterizer) return tl::unexpected(rasterizer.error());
    Vector<render::Vertex> vertices;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        vertices.push_back(
            {glm::vec3(glm::dvec3(mesh.positions[v]) - camera.position), glm::vec3(0, 1, 0), mesh.colors[v]});
    if (auto set = rasterizer->set_geometry(vertices, mesh.indices); !set) return set;
    Camera here = camera;
    here.position = glm::dvec3(0.0);
    render::DrawTransform transform = render::draw_transform(glm::mat4(world_to_clip(here)), glm::dmat3(1.0));
    transform.unlit = 1.0f;
    const render::DrawRange range{0, static_cast<std::uint32_t>(mesh.indices.size()), 0};
    render::Frame frame;
    frame.camera = here;
    frame.transforms = {&transform, 1};
    frame.ranges = {&range, 1};
    frame.environment.haze_distance = 0.0f;
    if (auto drawn = rasterizer->draw(frame); !drawn) return tl::unexpected(drawn.error());
    render::Image image;
    if (auto read = rasterizer->read_pixels(image); !read) return read;
    return write_file(path, pipeline::encode_png(image));
}

}  // namespace crofton::cli
