#include "fit_points.hpp"

#include <charconv>
#include <string_view>

#include "report.hpp"

namespace crofton::cli {
namespace {

// Reads one number and moves past it; false if there is none.
bool take_number(std::string_view& text, double& value) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() && error != std::errc::result_out_of_range) return false;
    if (error == std::errc::result_out_of_range) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return text.empty() || text.front() == ' ' || text.front() == '\t' || text.front() == '\r';
}

}  // namespace

Result<std::vector<glm::dvec3>> read_obj_vertices(const std::string& path) {
    const Result<std::string> contents = read_file(path);
    if (!contents) return tl::unexpected(contents.error());
    std::vector<glm::dvec3> points;
    std::string_view rest = *contents;
    for (std::size_t line = 1; !rest.empty(); ++line) {
        const std::size_t end = rest.find('\n');
        std::string_view text = rest.substr(0, end);
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
        while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
        if (text.size() < 2 || text[0] != 'v' || (text[1] != ' ' && text[1] != '\t')) continue;
        text.remove_prefix(1);
        glm::dvec3 p;
        if (!take_number(text, p.x) || !take_number(text, p.y) || !take_number(text, p.z))
            return fail(ErrorCode::parse, kNoItem,
                        path + ": line " + std::to_string(line) + ": a vertex needs three numbers");
        points.push_back(p);
    }
    if (points.empty()) return fail(ErrorCode::parse, kNoItem, path + ": no vertices (is this a Wavefront OBJ file?)");
    return points;
}

}  // namespace crofton::cli
