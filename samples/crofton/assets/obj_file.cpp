// SPDX-License-Identifier: MIT
#include "assets/obj_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "assets/face_triangles.hpp"
#include "assets/file.hpp"
#include "assets/float_origin.hpp"
#include "assets/text_lines.hpp"
#include "srgb.hpp"

namespace crofton::assets {
namespace {

// Finite numbers only. What is too small for a Number is 0.
template <class Number>
bool parse(std::string_view word, Number& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size()) return false;
    if constexpr (std::is_floating_point_v<Number>)
        if (error == std::errc::result_out_of_range &&
            std::abs(std::strtod(std::string(word).c_str(), nullptr)) < 1.0) {
            value = 0;
            return true;
        }
    return error == std::errc{} && std::isfinite(static_cast<double>(value));
}

struct Surface {
    glm::vec3 color = ObjFile::Part{}.color, emission{0.0f};
    std::string texture = {};
};
using Materials = std::map<std::string, Surface, std::less<>>;

// Returns a line without its comment.
std::string_view without_comment(std::string_view line) {
    return line.substr(0, line.find('#'));
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

// Returns a name, which may have blanks, without what a comment would be. "Material #25" is a name, too.
std::string_view short_name(std::string_view name) {
    for (std::size_t i = name.find('#'); i != std::string_view::npos; i = name.find('#', i + 1))
        if (i == 0 || is_blank(name[i - 1])) return trimmed(name.substr(0, i));
    return trimmed(name);
}

// A texture's file, whose name may have blanks; behind options, which begin with "-", the last word.
std::string_view texture_file(std::string_view line) {
    line = trimmed(line);
    if (line.empty() || line.front() != '-') return line;
    std::string_view last;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) last = word;
    return last;
}

// Kd, Ke and map_Kd by material name; lines that make no sense are skipped, a material is not worth losing the shape
// for. A material is also known by its short name, unless another one has that.
void read_materials(std::string_view text, Materials& materials) {
    std::vector<Surface*> named{&materials[""]};
    TextLines lines(text);
    for (std::string_view line; lines.next(line);) {
        const std::string_view key = next_word(line);
        if (key == "newmtl") {
            const std::string whole(trimmed(line));
            named = {&materials[whole]};
            const auto [entry, added] = materials.try_emplace(std::string(short_name(whole)));
            if (added) named.push_back(&entry->second);
        }
        if (key == "map_Kd")
            for (Surface* surface : named) surface->texture = texture_file(line);
        glm::vec3 color;
        if ((key != "Kd" && key != "Ke") || !parse(next_word(line), color.x) || !parse(next_word(line), color.y) ||
            !parse(next_word(line), color.z))
            continue;
        const glm::vec3 linear(linear_from_srgb(color.x), linear_from_srgb(color.y), linear_from_srgb(color.z));
        for (Surface* surface : named)
            (key == "Ke" ? surface->emission : surface->color) = key == "Ke" ? color : linear;
    }
}

// Refuses files that are not UTF-8 before a line of them makes no sense.
Result<void> check_encoding(std::string_view text) {
    const auto begins = [&](std::string_view mark) { return text.substr(0, mark.size()) == mark; };
    if (begins("\xFF\xFE") || begins("\xFE\xFF"))
        return fail(ErrorCode::unsupported, kNoItem, "is UTF-16 text; save it as UTF-8");
    const std::size_t zero = text.find('\0');
    if (zero == std::string_view::npos) return {};
    return fail(ErrorCode::parse, zero, "is no text: byte " + std::to_string(zero) + " is 0");
}

// Keywords that are not read, old ones too, and comments.
bool is_other_keyword(std::string_view word) {
    static constexpr std::string_view kOther[] = {
        "vp",     "deg",    "bmat",     "step",     "cstype", "p",          "l",         "curv",  "curv2",
        "surf",   "parm",   "trim",     "hole",     "scrv",   "sp",         "end",       "con",   "s",
        "mg",     "bevel",  "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech", "stech",
        "usemap", "maplib", "bsp",      "bzp",      "cdc",    "cdp",        "res",       "call",  "csh"};
    return word.empty() || word.front() == '#' ||
           std::find(std::begin(kOther), std::end(kOther), word) != std::end(kOther);
}

constexpr std::size_t kMostWarnings = 20;
constexpr std::size_t kLinesPerLook = 1 << 14;  // at the clock
constexpr std::size_t kLongFace = 32;           // whose corners may take milliseconds

class ObjReader {
  public:
    ObjReader(std::string path, std::string_view text, const ObjOptions& options)
        : path_(std::move(path)), bytes_(text.size()), lines_(text), options_(options), deadline_(options.limits) {}

    Result<ObjFile> read() {
        file_.parts.emplace_back();
        file_.limits = options_.limits;
        file_.bytes_read = bytes_;
        std::size_t lines_read = 0;
        for (std::string_view line; lines_.next(line);) {
            if (++lines_read % kLinesPerLook == 0)
                if (auto in_time = deadline_.check(); !in_time) return in_file(path_, "", in_time.error());
            line_number_ = lines_.number();
            const std::string_view key = next_word(line);
            Result<void> done;
            if (key == "v")
                done = read_vertex(without_comment(line));
            else if (key == "vt")
                read_texcoord(without_comment(line));
            else if (key == "vn")
                read_normal(without_comment(line));
            else if (key == "f" || key == "fo")  // an old name of it
                done = read_face_or_keep(without_comment(line));
            else if (key == "o" || key == "g")
                start_part(std::string(short_name(line)));
            else if (key == "usemtl")
                use_material(trimmed(line));
            else if (key == "mtllib")
                done = load_libraries(line);
            else if (!is_other_keyword(key) && unknown_lines_++ == 0)
                file_.unknown_line =
                    "; " + line_name() + " begins with '" + std::string(key.substr(0, 40)) + "', which is no keyword";
            if (auto goes_on = leave_out(std::move(done)); !goes_on) return in_file(path_, "", goes_on.error());
        }
        if (auto done = read_kept_faces(); !done) return in_file(path_, "", done.error());
        if (!bad_vertices_.empty()) drop_bad_vertices();
        find_origin();
        if (unnamed_ > 0) file_.warnings.push_back(std::to_string(unnamed_) + " more lines make no sense: left out");
        if (unknown_lines_ > 0)
            file_.odd_lines.push_back(
                file_.unknown_line.substr(2) + ": left out" +
                (unknown_lines_ > 1 ? ", and " + std::to_string(unknown_lines_ - 1) + " more" : std::string()));
        if (unnamed_fans_ > 0)
            file_.odd_lines.push_back(std::to_string(unnamed_fans_) +
                                      " more faces cross themselves or have no area: cut as fans");
        if (dangling_ > 0)
            file_.warnings.push_back(std::to_string(dangling_) +
                                     " corners of faces name texture coordinates or normals that are not there");
        return std::move(file_);
    }

  private:
    struct Corner {
        std::uint32_t position = 0, texcoord = ObjFile::kNone, normal = ObjFile::kNone;
    };
    struct Counts {
        std::size_t positions = 0, texcoords = 0, normals = 0;
    };
    // A face that names what comes later, or that comes after such a face.
    struct KeptFace {
        std::string line;
        std::size_t line_number = 0, part = 0;
        Counts before;  // it
    };

    Result<void> bad(ErrorCode code, const std::string& why) const {
        return fail(code, line_number_, line_name() + ": " + why);
    }

    [[nodiscard]] std::string line_name() const { return "line " + std::to_string(line_number_); }

    // Returns the errors that end the reading; others become warnings.
    Result<void> leave_out(Result<void> done) {
        if (done) return done;
        if (!options_.leave_out || done.error().code == ErrorCode::budget_exceeded) return done;
        const Error& why = done.error();
        if (file_.warnings.size() < kMostWarnings)
            file_.warnings.push_back(why.message + ": left out");
        else
            ++unnamed_;
        return {};
    }

    // A bad one keeps its number until the end, and faces that name it are left out.
    Result<void> read_vertex(std::string_view line) {
        if (file_.positions.size() / 3 >= options_.limits.triangles)
            return over_limit("triangles", options_.limits.triangles);
        auto read = read_good_vertex(line);
        if (read || !options_.leave_out) return read;
        bad_vertices_.push_back(static_cast<std::uint32_t>(file_.positions.size()));
        file_.positions.emplace_back(0.0);
        file_.colors.emplace_back(-1.0f);
        return read;
    }

    Result<void> read_good_vertex(std::string_view line) {
        glm::dvec3 p;
        glm::vec3 c(-1.0f);
        for (int i = 0; i < 3; ++i) {
            const std::string_view word = next_word(line);
            if (!parse(word, p[i]) || std::abs(p[i]) > options_.largest)
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

    // Takes numbers that are not finite as 0: texture coordinates are not needed for drawing.
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

    // 1, 2, … from the first, −1, −2, … from the last before the face; kNone for what is not there.
    std::uint32_t resolve(long long index, std::size_t before, std::size_t count) {
        const long long position = index < 0 ? static_cast<long long>(before) + index : index - 1;
        if (position >= 0 && position < static_cast<long long>(count)) return static_cast<std::uint32_t>(position);
        names_later_ = names_later_ || position >= 0;
        return ObjFile::kNone;
    }

    std::uint32_t optional_index(std::string_view& word, std::size_t before, std::size_t count) {
        if (word.empty()) return ObjFile::kNone;
        word.remove_prefix(1);
        const std::string_view number = word.substr(0, word.find('/'));
        word.remove_prefix(number.size());
        if (number.empty()) return ObjFile::kNone;
        long long index = 0;
        const std::uint32_t found = parse(number, index) ? resolve(index, before, count) : ObjFile::kNone;
        dangling_ += found == ObjFile::kNone;
        return found;
    }

    Result<Corner> read_corner(std::string_view word) {
        const std::string_view number = word.substr(0, word.find('/'));
        long long index = 0;
        if (!parse(number, index))
            return bad(ErrorCode::parse, "face: '" + std::string(word.substr(0, 40)) + "' is not a vertex").error();
        Corner corner{resolve(index, before_.positions, file_.positions.size())};
        if (corner.position == ObjFile::kNone)
            return bad(ErrorCode::out_of_range, "face: vertex " + std::to_string(index) + " of " +
                                                    std::to_string(file_.positions.size()) + file_.unknown_line)
                .error();
        if (std::binary_search(bad_vertices_.begin(), bad_vertices_.end(), corner.position))
            return bad(ErrorCode::parse, "face: vertex " + std::to_string(index) + " makes no sense").error();
        std::string_view rest = word.substr(number.size());
        corner.texcoord = optional_index(rest, before_.texcoords, file_.texcoords.size());
        corner.normal = optional_index(rest, before_.normals, file_.normals.size());
        return corner;
    }

    // A face may name vertices that come later. It is kept until the end, and so are all faces after it, which keeps
    // their order.
    Result<void> read_face_or_keep(std::string_view line) {
        before_ = {file_.positions.size(), file_.texcoords.size(), file_.normals.size()};
        part_ = file_.parts.size() - 1;
        if (kept_faces_.empty()) {
            const std::size_t dangling = dangling_;
            names_later_ = false;
            auto done = read_face(line);
            if (!names_later_) return done;
            dangling_ = dangling;
        }
        kept_faces_.push_back({std::string(line), line_number_, part_, before_});
        return {};
    }

    Result<void> read_kept_faces() {
        for (std::size_t i = 0; i < kept_faces_.size(); ++i) {
            if (i % kLinesPerLook == 0)
                if (auto in_time = deadline_.check(); !in_time) return in_time;
            line_number_ = kept_faces_[i].line_number;
            part_ = kept_faces_[i].part;
            before_ = kept_faces_[i].before;
            if (auto goes_on = leave_out(read_face(kept_faces_[i].line)); !goes_on) return goes_on;
        }
        kept_faces_.clear();
        return {};
    }

    // Adds the triangles of a face unless it names what is not there yet.
    Result<void> read_face(std::string_view line) {
        face_.clear();
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            const auto corner = read_corner(word);
            if (!corner) return corner.error();
            face_.push_back(*corner);
        }
        if (names_later_ && kept_faces_.empty()) return {};
        if (face_.size() < 3) return bad(ErrorCode::parse, "face: fewer than three vertices");
        if (face_.size() - 2 > options_.limits.triangles - triangles_)
            return over_limit("triangles", options_.limits.triangles);
        if (face_.size() > kLongFace)
            if (auto in_time = deadline_.check(); !in_time) return in_time;
        outline_.clear();
        for (const Corner& corner : face_) outline_.push_back(file_.positions[corner.position]);
        const FaceCut cut = triangulator_.cut(outline_);
        if (triangulator_.triangles().size() > options_.limits.triangles - triangles_)
            return over_limit("triangles", options_.limits.triangles);
        triangles_ += triangulator_.triangles().size();
        for (const auto& triangle : triangulator_.triangles())
            for (const std::uint32_t corner : triangle) add_corner(file_.parts[part_], face_[corner]);
        if (cut == FaceCut::no_polygon) note_fan();
        return {};
    }

    void note_fan() {
        if (file_.odd_lines.size() < kMostWarnings)
            file_.odd_lines.push_back(line_name() +
                                      ": face: crosses itself or has no area: cut as a fan from its first corner");
        else
            ++unnamed_fans_;
    }

    // No face names them.
    void drop_bad_vertices() {
        std::vector<std::uint32_t> number(file_.positions.size());
        std::uint32_t kept = 0;
        for (std::uint32_t v = 0; v < number.size(); ++v) {
            if (std::binary_search(bad_vertices_.begin(), bad_vertices_.end(), v)) continue;
            file_.positions[kept] = file_.positions[v];
            file_.colors[kept] = file_.colors[v];
            number[v] = kept++;
        }
        file_.positions.resize(kept);
        file_.colors.resize(kept);
        for (ObjFile::Part& part : file_.parts)
            for (std::uint32_t& index : part.indices) index = number[index];
    }

    void find_origin() {
        glm::dvec3 low(std::numeric_limits<double>::max()), high = -low;
        for (const ObjFile::Part& part : file_.parts)
            for (const std::uint32_t index : part.indices) {
                low = glm::min(low, file_.positions[index]);
                high = glm::max(high, file_.positions[index]);
            }
        if (triangles_ > 0) file_.origin = float_origin(low, high);
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
        const bool gets_faces = !kept_faces_.empty() && kept_faces_.back().part + 1 == file_.parts.size();
        if (last.indices.empty() && !gets_faces) file_.parts.pop_back();
        file_.parts.push_back(std::move(part));
    }

    void use_material(std::string_view name) {
        start_part(file_.parts.back().name);
        auto found = materials_.find(name);
        if (found == materials_.end()) found = materials_.find(name = short_name(name));
        const Surface surface = found == materials_.end() ? Surface{} : found->second;
        ObjFile::Part& part = file_.parts.back();
        part.color = surface.color;
        part.emission = surface.emission;
        part.texture = surface.texture;
        part.material = std::string(name);
    }

    // One file whose name may have blanks, or several.
    Result<void> load_libraries(std::string_view line) {
        std::string_view rest = line;
        const std::string_view first = next_word(rest);
        std::string_view whole = line.substr(static_cast<std::size_t>(first.data() - line.data()));
        while (!whole.empty() && is_blank(whole.back())) whole.remove_suffix(1);
        if (whole == first) return load_library(first, true);
        const std::size_t libraries = libraries_;
        if (auto done = load_library(whole, false); !done || libraries_ > libraries) return done;
        for (std::string_view name = next_word(line); !name.empty(); name = next_word(line))
            if (auto done = load_library(name, true); !done) return done;
        return {};
    }

    // Skips a library that cannot be read, with a warning if `warn` is set.
    Result<void> load_library(std::string_view name, bool warn) {
        if (auto in_time = deadline_.check(); !in_time) return in_time;
        const std::uint64_t limit = options_.limits.bytes;
        const auto text = read_file_below(folder(path_), std::string(name), limit - std::min(limit, file_.bytes_read));
        if (text) {
            ++libraries_;
            file_.bytes_read += text->size();
            read_materials(*text, materials_);
        } else if (text.error().code == ErrorCode::budget_exceeded) {
            return over_limit("bytes", limit);
        } else if (warn && file_.warnings.size() < kMostWarnings) {
            file_.warnings.push_back(line_name() + ": " + text.error().message);
        }
        return {};
    }

    std::string path_;
    std::size_t bytes_;
    TextLines lines_;
    ObjOptions options_;
    Deadline deadline_;
    std::size_t dangling_ = 0, unnamed_ = 0, unnamed_fans_ = 0, unknown_lines_ = 0, libraries_ = 0;
    std::uint64_t triangles_ = 0;
    std::size_t line_number_ = 0;
    std::vector<std::uint32_t> bad_vertices_;  // ascending
    std::vector<KeptFace> kept_faces_;
    std::size_t part_ = 0;  // of the face that is read
    Counts before_;         // it
    bool names_later_ = false;
    std::vector<Corner> face_;
    std::vector<glm::dvec3> outline_;
    FaceTriangulator triangulator_;
    Materials materials_;
    ObjFile file_;
};

}  // namespace

Result<ObjFile> read_obj(const std::string& path, const ObjOptions& options) {
    const auto file = read_file(path, options.limits.bytes);
    if (!file) return file.error();
    if (auto readable = check_encoding(*file); !readable) return in_file(path, "", readable.error());
    return ObjReader(path, *file, options).read();
}

}  // namespace crofton::assets
