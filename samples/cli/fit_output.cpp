#include "fit_output.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <nlohmann/json.hpp>

namespace crofton::cli {
namespace {

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void
append(std::string& text, const char* format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    text += line;
}

nlohmann::json optional_number(const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json box_json(const FittedBox& fitted) {
    const Obb& box = fitted.box;
    nlohmann::json axes = nlohmann::json::array();
    for (int k = 0; k < 3; ++k)
        axes.push_back({static_cast<double>(box.axes[k].x), static_cast<double>(box.axes[k].y),
                        static_cast<double>(box.axes[k].z)});
    return {{"criterion", fitted.criterion},
            {"center", {box.center.x, box.center.y, box.center.z}},
            {"axes", axes},
            {"half_extents",
             {static_cast<double>(box.half_extents.x), static_cast<double>(box.half_extents.y),
              static_cast<double>(box.half_extents.z)}},
            {"volume", volume(box)},
            {"area", surface_area(box)},
            {"edge_sum", edge_sum(box)},
            {"value", fitted.value},
            {"lower_bound", optional_number(fitted.lower_bound)},
            {"gap", optional_number(fitted.gap)},
            // The search needs no hull: 0 of its time goes there. What counting hull_vertices took stands beside them.
            {"milliseconds", {{"hull", 0.0}, {"search", fitted.milliseconds}, {"total", fitted.milliseconds}}}};
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '<')
            result += "&lt;";
        else if (c == '&')
            result += "&amp;";
        else
            result += c;
    }
    return result;
}

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

nlohmann::json fit_json(const std::vector<FittedMesh>& meshes, const std::string& quality) {
    nlohmann::json list = nlohmann::json::array();
    for (const FittedMesh& mesh : meshes) {
        nlohmann::json entry = box_json(mesh.chosen);
        entry["file"] = mesh.file;
        entry["vertices"] = mesh.vertices;
        entry["hull_vertices"] = mesh.hull_vertices;
        entry["hull_count_milliseconds"] = mesh.hull_count_milliseconds;
        if (!mesh.others.empty()) {
            nlohmann::json criteria = nlohmann::json::object();
            for (const FittedBox& other : mesh.others) criteria[other.criterion] = box_json(other);
            entry["criteria"] = std::move(criteria);
        }
        list.push_back(std::move(entry));
    }
    return {{"quality", quality},
            {"criterion", meshes.empty() ? "" : meshes[0].chosen.criterion},
            {"meshes", std::move(list)}};
}

std::string fit_text(const std::vector<FittedMesh>& meshes) {
    std::string text;
    if (meshes.size() == 1) {
        const FittedMesh& mesh = meshes[0];
        const FittedBox& fitted = mesh.chosen;
        const Obb& box = fitted.box;
        append(text, "%s: %zu vertices, %zu on the hull\n", mesh.file.c_str(), mesh.vertices, mesh.hull_vertices);
        append(text, "  center        %.9g %.9g %.9g\n", box.center.x, box.center.y, box.center.z);
        for (int k = 0; k < 3; ++k)
            append(text, "  axis %d        %.9g %.9g %.9g   half extent %.9g\n", k, static_cast<double>(box.axes[k].x),
                   static_cast<double>(box.axes[k].y), static_cast<double>(box.axes[k].z),
                   static_cast<double>(box.half_extents[k]));
        append(text, "  volume %.9g   area %.9g   edge sum %.9g\n", volume(box), surface_area(box), edge_sum(box));
        append(text, "  %s: value %.9g", fitted.criterion.c_str(), fitted.value);
        if (fitted.lower_bound) append(text, ", proved lower bound %.9g (gap %.2g)", *fitted.lower_bound, *fitted.gap);
        append(text, "\n  %.3f ms; counting the hull's vertices, which the fit does not need, %.3f ms\n",
               fitted.milliseconds, mesh.hull_count_milliseconds);
        return text;
    }
    std::size_t width = 8;
    for (const FittedMesh& mesh : meshes) width = std::max(width, file_name(mesh.file).size());
    append(text, "%-*s %9s %7s  %-12s %14s %14s %14s %14s %9s %9s\n", static_cast<int>(width), "mesh", "vertices",
           "hull", "criterion", "volume", "area", "edge sum", "value", "gap", "ms");
    for (const FittedMesh& mesh : meshes) {
        const auto row = [&](const FittedBox& fitted) {
            append(text, "%-*s %9zu %7zu  %-12s %14.9g %14.9g %14.9g %14.9g ", static_cast<int>(width),
                   file_name(mesh.file).c_str(), mesh.vertices, mesh.hull_vertices, fitted.criterion.c_str(),
                   volume(fitted.box), surface_area(fitted.box), edge_sum(fitted.box), fitted.value);
            if (fitted.gap)
                append(text, "%9.1e ", *fitted.gap);
            else
                append(text, "%9s ", "-");
            append(text, "%9.3f\n", fitted.milliseconds);
        };
        for (const FittedBox& other : mesh.others) row(other);
        const bool listed = std::any_of(mesh.others.begin(), mesh.others.end(), [&](const FittedBox& other) {
            return other.criterion == mesh.chosen.criterion;
        });
        if (!listed) row(mesh.chosen);
    }
    return text;
}

std::string fit_svg(const std::vector<FittedMesh>& meshes) {
    constexpr double kPanel = 420.0, kMargin = 30.0;
    // A direction of view from which no axis hides another.
    const glm::dvec3 right = glm::normalize(glm::dvec3(0.83, 0.0, -0.55));
    const glm::dvec3 up = glm::normalize(glm::cross(glm::normalize(glm::dvec3(0.5, 0.45, 0.75)), right));
    std::string text;
    append(text,
           "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" font-family=\"sans-serif\" "
           "font-size=\"12\">\n",
           kPanel * static_cast<double>(meshes.size()), kPanel);
    text += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const FittedMesh& mesh = meshes[i];
        const auto corner = corners(mesh.chosen.box);
        const glm::dvec3 middle = mesh.chosen.box.center;
        double size = 0.0;
        for (const glm::dvec3& c : corner) size = std::max(size, glm::distance(c, middle));
        const double scale = size > 0.0 ? (0.5 * kPanel - kMargin) / size : 0.0;
        const auto at = [&](const glm::dvec3& p) {
            const glm::dvec3 d = (p - middle) * scale;
            return glm::dvec2(kPanel * (static_cast<double>(i) + 0.5) + glm::dot(d, right),
                              0.5 * kPanel - glm::dot(d, up));
        };
        const auto line = [&](const glm::dvec3& a, const glm::dvec3& b, const char* style) {
            const glm::dvec2 p = at(a), q = at(b);
            append(text, "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" %s/>\n", p.x, p.y, q.x, q.y, style);
        };
        for (std::size_t e = 0; e + 1 < mesh.hull_edges.size(); e += 2)
            line(mesh.hull_edges[e], mesh.hull_edges[e + 1], "stroke=\"#999\" stroke-width=\"0.5\"");
        for (unsigned c = 0; c < 8; ++c)
            for (unsigned bit = 1; bit < 8; bit <<= 1)
                if ((c & bit) == 0) line(corner[c], corner[c | bit], "stroke=\"#06c\" stroke-width=\"1.5\"");
        append(text, "<text x=\"%.1f\" y=\"16\">%s: %s %.6g</text>\n", kPanel * static_cast<double>(i) + 8.0,
               escaped(file_name(mesh.file)).c_str(), escaped(mesh.chosen.criterion).c_str(), mesh.chosen.value);
    }
    return text + "</svg>\n";
}

}  // namespace crofton::cli
