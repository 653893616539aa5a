#include "mesh_file.hpp"

#include <charconv>
#include <string_view>

#include "../assets/file.hpp"
#include "../assets/scene_source.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

std::string_view next_word(std::string_view& line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return line = {};
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

template <class Number>
bool parse(std::string_view word, Number& number) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size();
}

// A face's corner: "7", "7/1", "7//3"; negative counts back from the last vertex.
bool parse_corner(std::string_view word, std::size_t vertex_count, std::uint32_t& index) {
    long long number = 0;
    if (!parse(word.substr(0, word.find('/')), number) || number == 0) return false;
    const long long at = number > 0 ? number - 1 : static_cast<long long>(vertex_count) + number;
    if (at < 0 || at >= static_cast<long long>(vertex_count)) return false;
    index = static_cast<std::uint32_t>(at);
    return true;
}

Result<TriangleMesh> load_obj_mesh(const std::string& path) {
    const auto text = read_file(path);
    if (!text) return tl::unexpected<Error>(text.error());
    TriangleMesh mesh;
    std::string_view rest = *text;
    const auto bad = [&](std::uint64_t line, const char* why) {
        return fail(ErrorCode::parse, line, path + ": line " + std::to_string(line) + ": " + why);
    };
    for (std::uint64_t number = 1; !rest.empty(); ++number) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        const std::string_view keyword = next_word(line);
        if (keyword == "v") {
            glm::vec3 p;
            for (int i = 0; i < 3; ++i)
                if (!parse(next_word(line), p[i])) return bad(number, "a vertex needs three numbers");
            mesh.positions.push_back(p);
        } else if (keyword == "f") {
            std::uint32_t first = 0, before = 0, index = 0;
            int corners = 0;
            for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++corners) {
                if (!parse_corner(word, mesh.positions.size(), index))
                    return bad(number, "a face refers to a vertex that is not there");
                if (corners >= 2)
                    for (const std::uint32_t corner : {first, before, index}) mesh.indices.push_back(corner);
                if (corners == 0) first = index;
                before = index;
            }
            if (corners < 3) return bad(number, "a face needs three corners");
        }
    }
    if (mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, path + ": no triangles");
    return mesh;
}

}  // namespace

Result<TriangleMesh> load_mesh(const std::string& path) {
    if (assets::extension(path) == "obj") return load_obj_mesh(path);
    auto source = assets::load_scene(path);
    if (!source) return tl::unexpected<Error>(source.error());
    source->scene.update();
    TriangleMesh all;
    for (scene::InstanceId i = 0; i < source->scene.instance_count(); ++i) {
        const TriangleMesh& mesh = source->scene.mesh(source->scene.mesh_of(i));
        const scene::Transform& world = source->scene.world(source->scene.node_of(i));
        const auto base = static_cast<std::uint32_t>(all.positions.size());
        for (const glm::vec3& p : mesh.positions) all.positions.push_back(glm::vec3(world * glm::dvec3(p)));
        for (const std::uint32_t index : mesh.indices) all.indices.push_back(base + index);
    }
    if (all.indices.empty()) return fail(ErrorCode::empty, kNoItem, path + ": no triangles");
    return all;
}

}  // namespace crofton::cli
