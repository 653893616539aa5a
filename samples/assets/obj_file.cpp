#include "assets/obj_file.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "assets/file.hpp"

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

float linear_from_srgb(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

struct Surface {
    glm::vec3 color = ObjFile::Part{}.color, emission{0.0f};
};
using Materials = std::map<std::string, Surface, std::less<>>;

// Kd and Ke by material name; lines that make no sense are skipped, a material is not worth losing the shape for.
void read_materials(std::string_view text, Materials& materials) {
    std::string name;
    while (!text.empty()) {
        std::string_view line = next_line(text);
        const std::string_view key = next_word(line);
        if (key == "newmtl") name = std::string(next_word(line));
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
            else if (key == "f")
                done = read_face(line);
            else if (key == "o" || key == "g")
                start_part(std::string(next_word(line)), {file_.parts.back().color, file_.parts.back().emission});
            else if (key == "usemtl")
                use_material(next_word(line));
            else if (key == "mtllib")
                load_library(next_word(line));
            if (!done) return tl::unexpected(done.error());
        }
        return std::move(file_);
    }

  private:
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

    Result<void> read_face(std::string_view line) {
        std::uint32_t first = 0, previous = 0;
        std::size_t count = 0;
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++count) {
            const std::string_view number = word.substr(0, word.find('/'));
            long long index = 0;
            const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
            if (error != std::errc{} || end != number.data() + number.size())
                return bad(ErrorCode::parse, "face: '" + std::string(word.substr(0, 40)) + "' is not a vertex");
            const auto total = static_cast<long long>(file_.positions.size());
            const long long position = index < 0 ? total + index : index - 1;
            if (position < 0 || position >= total)
                return bad(ErrorCode::out_of_range,
                           "face: vertex " + std::to_string(index) + " of " + std::to_string(total));
            const auto current = static_cast<std::uint32_t>(position);
            if (count == 0) first = current;
            if (count >= 2)
                file_.parts.back().indices.insert(file_.parts.back().indices.end(), {first, previous, current});
            previous = current;
        }
        if (count < 3) return bad(ErrorCode::parse, "face: fewer than three vertices");
        return {};
    }

    void start_part(std::string name, const Surface& surface) {
        if (!file_.parts.back().indices.empty()) file_.parts.emplace_back();
        file_.parts.back().name = std::move(name);
        file_.parts.back().color = surface.color;
        file_.parts.back().emission = surface.emission;
    }

    void use_material(std::string_view name) {
        const auto found = materials_.find(name);
        start_part(file_.parts.back().name, found == materials_.end() ? Surface{} : found->second);
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
    std::size_t line_ = 0;
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
