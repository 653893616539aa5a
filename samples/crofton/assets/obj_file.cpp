// SPDX-License-Identifier: MIT
#include "assets/obj_file.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "assets/file.hpp"
#include "srgb.hpp"

namespace crofton::assets {
namespace {

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
template <class Number>
bool parse(std::string_view word, Number& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc{} && end == word.data() + word.size() && std::isfinite(value);
}

struct Surface {
    glm::vec3 color = ObjFile::Part{}.color, emission{0.0f};
    std::string texture = {};
};
using Materials = std::map<std::string, Surface, std::less<>>;

// The last word of a line, behind options that begin with "-".
std::string last_word(std::string_view line) {
    std::string_view last;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) last = word;
    return std::string(last);
}

// Kd, Ke and map_Kd by material name; lines that make no sense are skipped, a material is not worth losing the shape
// for.
void read_materials(std::string_view text, Materials& materials) {
    std::string name;
    while (!text.empty()) {
        std::string_view line = next_line(text);
        const std::string_view key = next_word(line);
        if (key == "newmtl") materials[name = std::string(next_word(line))];
        if (key == "map_Kd") materials[name].texture = last_word(line);
        glm::vec3 color;
        if ((key != "Kd" && key != "Ke") || !parse(next_word(line), color.x) || !parse(next_word(line), color.y) ||
            !parse(next_word(line), color.z))
            continue;
        if (key == "Ke")
            materials[name].emission = color;
        else
            materials[name].color = {linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z)};
    }
}

class ObjReader {
  public:
    ObjReader(std::string path, std::string_view text, double largest)
        : path_(std::move(path)), text_(text), largest_(largest) {}

    Result<ObjFile> read() {
        file_.parts.emplace_back();
        while (!text_.empty()) {
            ++line_;
            std::string_view line = next_line(text_);
            const std::string_view key = next_word(line);
            Result<void> done;
            if (key == "v")
                done = read_vertex(line);
            else if (key == "vt")
                read_texcoord(line);
            else if (key == "vn")
                read_normal(line);
            else if (key == "f")
                done = read_face(line);
            else if (key == "o" || key == "g")
                start_part(std::string(next_word(line)));
            else if (key == "usemtl")
                use_material(next_word(line));
            else if (key == "mtllib")
                load_library(next_word(line));
            if (!done) return tl::unexpected(done.error());
        }
        if (dangling_ > 0)
            file_.warnings.push_back(std::to_string(dangling_) +
                                     " corners of faces name texture coordinates or normals that are not there");
        return std::move(file_);
    }

  private:
    struct Corner {
        std::uint32_t position = 0, texcoord = ObjFile::kNone, normal = ObjFile::kNone;
    };

    Result<void> bad(ErrorCode code, const std::string& why) const {
        return fail(code, line_, path_ + ": line " + std::to_string(line_) + ": " + why);
    }

    Result<void> read_vertex(std::string_view line) {
        glm::dvec3 p;
        glm::vec3 c(-1.0f);
        for (int i = 0; i < 3; ++i) {
            const std::string_view word = next_word(line);
            if (!parse(word, p[i]) || std::abs(p[i]) > largest_)
                return bad(ErrorCode::parse, "vertex " + std::to_string(file_.positions.size() + 1) + ": '" +
                                                 std::string(word.substr(0, 40)) + "' is not a finite number");
        }
        // "v x y z r g b" is common; "v x y z w" is legal and w is ignored.
        glm::vec3 given;
        if (parse(next_word(line), given.x) && parse(next_word(line), given.y) && parse(next_word(line), given.z))
            c = given;
        file_.positions.push_back(p);
        file_.colors.push_back(c);
        return {};
    }

    // What is no finite number counts as 0: drawing lives without.
    void read_texcoord(std::string_view line) {
        glm::vec2 uv(0.0f);
        for (int i = 0; i < 2; ++i)
            if (!parse(next_word(line), uv[i])) uv[i] = 0.0f;
        file_.texcoords.push_back(uv);
    }

    void read_normal(std::string_view line) {
        glm::vec3 normal(0.0f);
        for (int i = 0; i < 3; ++i)
            if (!parse(next_word(line), normal[i])) normal[i] = 0.0f;
        file_.normals.push_back(normal);
    }

    // 1, 2, … from the first, −1, −2, … from the last so far; kNone for what is not there.
    static std::uint32_t resolve(long long index, std::size_t count) {
        const auto total = static_cast<long long>(count);
        const long long position = index < 0 ? total + index : index - 1;
        return position < 0 || position >= total ? ObjFile::kNone : static_cast<std::uint32_t>(position);
    }

    std::uint32_t optional_index(std::string_view& word, std::size_t count) {
        if (word.empty()) return ObjFile::kNone;
        word.remove_prefix(1);
        const std::string_view number = word.substr(0, word.find('/'));
        word.remove_prefix(number.size());
        if (number.empty()) return ObjFile::kNone;
        long long index = 0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
        const bool valid = error == std::errc{} && end == number.data() + number.size();
        const std::uint32_t found = valid ? resolve(index, count) : ObjFile::kNone;
        dangling_ += found == ObjFile::kNone;
        return found;
    }

    Result<Corner> read_corner(std::string_view word) {
        const std::string_view number = word.substr(0, word.find('/'));
        long long index = 0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
        if (error != std::errc{} || end != number.data() + number.size())
            return tl::unexpected(
                bad(ErrorCode::parse, "face: '" + std::string(word.substr(0, 40)) + "' is not a vertex").error());
        Corner corner{resolve(index, file_.positions.size())};
        if (corner.position == ObjFile::kNone)
            return tl::unexpected(bad(ErrorCode::out_of_range, "face: vertex " + std::to_string(index) + " of " +
                                                                   std::to_string(file_.positions.size()))
                                      .error());
        std::string_view rest = word.substr(number.size());
        corner.texcoord = optional_index(rest, file_.texcoords.size());
        corner.normal = optional_index(rest, file_.normals.size());
        return corner;
    }

    Result<void> read_face(std::string_view line) {
        Corner first, previous;
        std::size_t count = 0;
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++count) {
            const auto corner = read_corner(word);
            if (!corner) return tl::unexpected(corner.error());
            if (count == 0) first = *corner;
            if (count >= 2)
                for (const Corner& c : {first, previous, *corner}) add_corner(file_.parts.back(), c);
            previous = *corner;
        }
        if (count < 3) return bad(ErrorCode::parse, "face: fewer than three vertices");
        return {};
    }

    static void add_corner(ObjFile::Part& part, const Corner& corner) {
        const auto add = [&](std::vector<std::uint32_t>& list, std::uint32_t index) {
            if (list.empty() && index == ObjFile::kNone) return;
            list.resize(part.indices.size(), ObjFile::kNone);
            list.push_back(index);
        };
        add(part.texcoord_indices, corner.texcoord);
        add(part.normal_indices, corner.normal);
        part.indices.push_back(corner.position);
    }

    // With the material of the one before.
    void start_part(std::string name) {
        ObjFile::Part part;
        const ObjFile::Part& last = file_.parts.back();
        part.name = std::move(name);
        part.color = last.color;
        part.emission = last.emission;
        part.material = last.material;
        part.texture = last.texture;
        if (last.indices.empty()) file_.parts.pop_back();
        file_.parts.push_back(std::move(part));
    }

    void use_material(std::string_view name) {
        start_part(file_.parts.back().name);
        const auto found = materials_.find(name);
        const Surface surface = found == materials_.end() ? Surface{} : found->second;
        ObjFile::Part& part = file_.parts.back();
        part.color = surface.color;
        part.emission = surface.emission;
        part.texture = surface.texture;
        part.material = std::string(name);
    }

    void load_library(std::string_view name) {
        const auto text = read_file(folder(path_) + std::string(name));
        if (text)
            read_materials(*text, materials_);
        else
            file_.warnings.push_back("line " + std::to_string(line_) + ": " + text.error().message);
    }

    std::string path_;
    std::string_view text_;
    double largest_;
    std::size_t line_ = 0, dangling_ = 0;
    Materials materials_;
    ObjFile file_;
};

}  // namespace

Result<ObjFile> read_obj(const std::string& path, double largest) {
    const auto text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    return ObjReader(path, *text, largest).read();
}

}  // namespace crofton::assets
