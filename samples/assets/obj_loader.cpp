// Wavefront OBJ: v (with optional colours), f (any polygon, as a fan), o, g, usemtl with Kd of a material library.
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "assets/file.hpp"
#include "assets/scene_source.hpp"
#include "assets/split_mesh.hpp"

namespace crofton::assets {
namespace {

// A file is one frozen mesh as often as not; pieces of this size make it a scene that culling can work on.
constexpr std::size_t kTrianglesPerPiece = 512;

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

std::string_view next_word(std::string_view& line) {
    while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
    std::size_t end = 0;
    while (end < line.size() && !is_space(line[end])) ++end;
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

std::string_view next_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

// Finite numbers only.
bool parse(std::string_view word, float& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc{} && end == word.data() + word.size() && std::isfinite(value);
}

float linear_from_srgb(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

using Materials = std::map<std::string, glm::vec3, std::less<>>;

// Kd by material name; lines that make no sense are skipped, a material is not worth losing the shape for.
void read_materials(std::string_view text, Materials& materials) {
    std::string name;
    while (!text.empty()) {
        std::string_view line = next_line(text);
        const std::string_view key = next_word(line);
        if (key == "newmtl") name = std::string(next_word(line));
        glm::vec3 color;
        if (key == "Kd" && parse(next_word(line), color.x) && parse(next_word(line), color.y) &&
            parse(next_word(line), color.z))
            materials[name] =
                glm::vec3(linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z));
    }
}

class ObjReader {
  public:
    ObjReader(std::string path, std::string_view text) : path_(std::move(path)), text_(text) {}

    // One mesh per o, g or usemtl that has faces.
    struct Part {
        std::string name;
        glm::vec3 color{0.62f, 0.6f, 0.56f};
        std::vector<std::uint32_t> indices;
    };
    std::vector<glm::vec3> positions, colors;  // colours: negative red where the file gives none
    std::vector<Part> parts;
    std::vector<std::string> warnings;

    Result<void> read() {
        parts.emplace_back();
        while (!text_.empty()) {
            ++line_;
            std::string_view line = next_line(text_);
            const std::string_view key = next_word(line);
            Result<void> done;
            if (key == "v")
                done = read_vertex(line);
            else if (key == "f")
                done = read_face(line);
            else if (key == "o" || key == "g")
                start_part(std::string(next_word(line)), parts.back().color);
            else if (key == "usemtl")
                use_material(next_word(line));
            else if (key == "mtllib")
                load_library(next_word(line));
            if (!done) return done;
        }
        return {};
    }

  private:
    Result<void> bad(ErrorCode code, const std::string& why) const {
        return fail(code, line_, path_ + ": line " + std::to_string(line_) + ": " + why);
    }

    Result<void> read_vertex(std::string_view line) {
        glm::vec3 p, c(-1.0f);
        for (int i = 0; i < 3; ++i) {
            const std::string_view word = next_word(line);
            if (!parse(word, p[i]))
                return bad(ErrorCode::parse, "vertex " + std::to_string(positions.size() + 1) + ": '" +
                                                 std::string(word.substr(0, 40)) + "' is not a finite number");
        }
        // "v x y z r g b" is common; "v x y z w" is legal and w is ignored.
        glm::vec3 given;
        if (parse(next_word(line), given.x) && parse(next_word(line), given.y) && parse(next_word(line), given.z))
            c = given;
        positions.push_back(p);
        colors.push_back(c);
        return {};
    }

    Result<void> read_face(std::string_view line) {
        std::uint32_t first = 0, previous = 0;
        std::size_t count = 0;
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++count) {
            const std::string_view number = word.substr(0, word.find('/'));
            long long index = 0;
            const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
            if (error != std::errc{} || end != number.data() + number.size())
                return bad(ErrorCode::parse, "face: '" + std::string(word.substr(0, 40)) + "' is not a vertex");
            const auto total = static_cast<long long>(positions.size());
            const long long position = index < 0 ? total + index : index - 1;
            if (position < 0 || position >= total)
                return bad(ErrorCode::out_of_range,
                           "face: vertex " + std::to_string(index) + " of " + std::to_string(total));
            const auto current = static_cast<std::uint32_t>(position);
            if (count == 0) first = current;
            if (count >= 2) parts.back().indices.insert(parts.back().indices.end(), {first, previous, current});
            previous = current;
        }
        if (count < 3) return bad(ErrorCode::parse, "face: fewer than three vertices");
        return {};
    }

    void start_part(std::string name, glm::vec3 color) {
        if (!parts.back().indices.empty()) parts.emplace_back();
        parts.back().name = std::move(name);
        parts.back().color = color;
    }

    void use_material(std::string_view name) {
        const auto found = materials_.find(name);
        start_part(parts.back().name, found == materials_.end() ? Part{}.color : found->second);
    }

    void load_library(std::string_view name) {
        const auto text = read_file(folder(path_) + std::string(name));
        if (text)
            read_materials(*text, materials_);
        else
            warnings.push_back("line " + std::to_string(line_) + ": " + text.error().message);
    }

    std::string path_;
    std::string_view text_;
    std::size_t line_ = 0;
    Materials materials_;
};

// The part's own vertices only, in order of first use.
TriangleMesh mesh_of(const ObjReader& reader, const ObjReader::Part& part, std::vector<std::uint32_t>& new_index) {
    constexpr std::uint32_t kUnused = ~std::uint32_t{0};
    TriangleMesh mesh;
    for (const std::uint32_t old : part.indices) {
        if (new_index[old] == kUnused) {
            new_index[old] = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(reader.positions[old]);
            mesh.colors.push_back(reader.colors[old].x < 0.0f ? part.color : reader.colors[old]);
        }
        mesh.indices.push_back(new_index[old]);
    }
    for (const std::uint32_t old : part.indices) new_index[old] = kUnused;
    return mesh;
}

}  // namespace

Result<SceneSource> load_obj(const std::string& path, const LoadOptions& options) {
    const auto text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    ObjReader reader(path, *text);
    if (auto read = reader.read(); !read) return tl::unexpected(read.error());
    SceneSource source{file_name(path), scene::Scene({options.criterion}), {}, {}, std::move(reader.warnings), {}};
    const auto root = source.scene.add_node(scene::kNone, {}, ~0u, source.name);
    if (!root) return in_file(path, "", root.error());
    std::vector<std::uint32_t> new_index(reader.positions.size(), ~std::uint32_t{0});
    for (const ObjReader::Part& part : reader.parts) {
        if (part.indices.empty()) continue;
        for (TriangleMesh& piece : split_mesh(mesh_of(reader, part, new_index), kTrianglesPerPiece)) {
            const auto mesh = source.scene.add_mesh(std::move(piece), part.name);
            if (!mesh) return in_file(path, "object '" + part.name + "'", mesh.error());
            if (auto added = source.scene.add_instance(*root, *mesh); !added) return in_file(path, "", added.error());
        }
    }
    if (source.scene.instance_count() == 0)
        return fail(ErrorCode::empty, kNoItem, path + ": holds no faces, so there is nothing to draw");
    return source;
}

}  // namespace crofton::assets
