// SPDX-License-Identifier: MIT
#include "fit_output.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "assets/print.hpp"
#include "json/json.hpp"

namespace crofton::cli {
namespace {

Json optional_number(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json box_json(const FittedBox& fitted, double hull_milliseconds) {
    const Obb& box = fitted.box;
    Json axes = Json::array();
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
            {"rounding", optional_number(fitted.rounding)},
            {"milliseconds",
             {{"hull", hull_milliseconds},
              {"search", fitted.milliseconds},
              {"total", hull_milliseconds + fitted.milliseconds}}}};
}

std::string file_name(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

Json fit_json(const std::vector<FittedMesh>& meshes, const std::string& quality) {
    Json list = Json::array();
    for (const FittedMesh& mesh : meshes) {
        Json entry = box_json(mesh.chosen, mesh.hull_milliseconds);
        entry["file"] = mesh.file;
        entry["vertices"] = mesh.vertices;
        entry["hull_vertices"] = mesh.hull_vertices;
        if (!mesh.others.empty()) {
            Json criteria = Json::object();
            for (const FittedBox& other : mesh.others)
                criteria[other.criterion] = box_json(other, mesh.hull_milliseconds);
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
        text += formatted("%s: %zu vertices, %zu on the hull\n", printable(mesh.file).c_str(), mesh.vertices,
                          mesh.hull_vertices);
        text += formatted("  center        %.9g %.9g %.9g\n", box.center.x, box.center.y, box.center.z);
        for (int k = 0; k < 3; ++k)
            text += formatted("  axis %d        %.9g %.9g %.9g   half extent %.9g\n", k,
                              static_cast<double>(box.axes[k].x), static_cast<double>(box.axes[k].y),
                              static_cast<double>(box.axes[k].z), static_cast<double>(box.half_extents[k]));
        text += formatted("  volume %.9g   area %.9g   edge sum %.9g\n", volume(box), surface_area(box), edge_sum(box));
        text += formatted("  %s: value %.9g", fitted.criterion.c_str(), fitted.value);
        if (fitted.lower_bound)
            text += formatted(", proved lower bound %.9g (gap %.2g, of which %.2g is the rounding of the box to float)",
                              *fitted.lower_bound, *fitted.gap, *fitted.rounding);
        text += formatted("\n  %.3f ms; the hull, for its count of vertices only, %.3f ms\n", fitted.milliseconds,
                          mesh.hull_milliseconds);
        return text;
    }
    std::size_t width = 8;
    for (const FittedMesh& mesh : meshes) width = std::max(width, file_name(mesh.file).size());
    text += formatted("%-*s %9s %7s  %-12s %14s %14s %14s %14s %9s %9s\n", static_cast<int>(width), "mesh", "vertices",
                      "hull", "criterion", "volume", "area", "edge sum", "value", "gap", "ms");
    for (const FittedMesh& mesh : meshes) {
        const auto row = [&](const FittedBox& fitted) {
            text += formatted("%-*s %9zu %7zu  %-12s %14.9g %14.9g %14.9g %14.9g ", static_cast<int>(width),
                              printable(file_name(mesh.file)).c_str(), mesh.vertices, mesh.hull_vertices,
                              fitted.criterion.c_str(), volume(fitted.box), surface_area(fitted.box),
                              edge_sum(fitted.box), fitted.value);
            if (fitted.gap)
                text += formatted("%9.1e ", *fitted.gap);
            else
                text += formatted("%9s ", "-");
            text += formatted("%9.3f\n", fitted.milliseconds);
        };
        for (const FittedBox& other : mesh.others) row(other);
        const bool listed = std::any_of(mesh.others.begin(), mesh.others.end(), [&](const FittedBox& other) {
            return other.criterion == mesh.chosen.criterion;
        });
        if (!listed) row(mesh.chosen);
    }
    return text;
}

namespace {

// One mesh's panel: an orthographic view along the normal of `right` and `up`; what lies behind first.
class Panel {
  public:
    Panel(const FittedMesh& mesh, const glm::dvec2& middle, double radius, std::string& text)
        : mesh_(mesh), corners_(corners(mesh.chosen.box)), middle_(middle), text_(text) {
        double size = 0.0;
        for (const glm::dvec3& c : corners_) size = std::max(size, glm::distance(c, mesh.chosen.box.center));
        scale_ = size > 0.0 ? radius / size : 0.0;
    }

    void draw() {
        unsigned nearest = 0;
        for (unsigned c = 1; c < 8; ++c)
            if (glm::dot(corners_[c] - corners_[nearest], kTowards) > 0.0) nearest = c;
        const unsigned farthest = 7 - nearest;
        edges(farthest, true, "stroke=\"#06c\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
        hull();
        edges(farthest, false, "stroke=\"#06c\" stroke-width=\"1.6\"");
    }

  private:
    // A direction of view from which no coordinate axis hides another.
    inline static const glm::dvec3 kTowards = glm::normalize(glm::dvec3(0.55, 0.42, 0.83));
    inline static const glm::dvec3 kRight = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), kTowards));
    inline static const glm::dvec3 kUp = glm::cross(kTowards, kRight);
    inline static const glm::dvec3 kLight = glm::normalize(glm::dvec3(0.1, 0.9, 0.6));

    [[nodiscard]] glm::dvec2 at(const glm::dvec3& p) const {
        const glm::dvec3 d = (p - mesh_.chosen.box.center) * scale_;
        return middle_ + glm::dvec2(glm::dot(d, kRight), -glm::dot(d, kUp));
    }

    void line(const glm::dvec3& a, const glm::dvec3& b, const char* style) {
        const glm::dvec2 p = at(a), q = at(b);
        text_ += formatted("<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" %s/>\n", p.x, p.y, q.x, q.y, style);
    }

    // The box's edges that meet in the farthest corner are hidden, the others are not.
    void edges(unsigned farthest, bool hidden, const char* style) {
        for (unsigned c = 0; c < 8; ++c)
            for (unsigned bit = 1; bit < 8; bit <<= 1)
                if ((c & bit) == 0 && (c == farthest || (c | bit) == farthest) == hidden)
                    line(corners_[c], corners_[c | bit], style);
    }

    // The hull's front faces: those of a convex body never cover each other.
    void hull() {
        glm::dvec3 inside(0.0);
        for (const glm::dvec3& p : mesh_.hull_triangles) inside += p / static_cast<double>(mesh_.hull_triangles.size());
        for (std::size_t i = 0; i + 2 < mesh_.hull_triangles.size(); i += 3) {
            const glm::dvec3* p = mesh_.hull_triangles.data() + i;
            glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
            if (glm::dot(normal, p[0] - inside) < 0.0) normal = -normal;
            const double length = glm::length(normal);
            if (!(length > 0.0) || glm::dot(normal, kTowards) <= 0.0) continue;
            const int grey = 150 + static_cast<int>(90.0 * std::max(0.0, glm::dot(normal, kLight) / length));
            const glm::dvec2 a = at(p[0]), b = at(p[1]), c = at(p[2]);
            text_ += formatted(
                "<path d=\"M%.2f %.2fL%.2f %.2fL%.2f %.2fZ\" fill=\"#%02x%02x%02x\" stroke=\"#888\" "
                "stroke-width=\"0.3\" stroke-linejoin=\"round\"/>\n",
                a.x, a.y, b.x, b.y, c.x, c.y, static_cast<unsigned>(grey), static_cast<unsigned>(grey),
                static_cast<unsigned>(grey));
        }
        for (std::size_t i = 0; i + 1 < mesh_.outline.size(); i += 2)
            line(mesh_.outline[i], mesh_.outline[i + 1], "stroke=\"#555\" stroke-width=\"1\"");
    }

    const FittedMesh& mesh_;
    const std::array<glm::dvec3, 8> corners_;
    const glm::dvec2 middle_;
    std::string& text_;
    double scale_ = 0.0;
};

}  // namespace

std::string fit_svg(const std::vector<FittedMesh>& meshes) {
    constexpr double kPanel = 360.0, kHeading = 44.0, kMargin = 12.0;
    const std::size_t columns = std::min<std::size_t>(4, meshes.size());
    const std::size_t rows = (meshes.size() + columns - 1) / std::max<std::size_t>(1, columns);
    std::string text;
    text += formatted(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n",
        kPanel * static_cast<double>(columns), (kPanel + kHeading) * static_cast<double>(rows));
    text += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const FittedMesh& mesh = meshes[i];
        const glm::dvec2 corner(kPanel * static_cast<double>(i % columns),
                                (kPanel + kHeading) * static_cast<double>(i / columns));
        const glm::dvec3 edges = 2.0 * glm::dvec3(mesh.chosen.box.half_extents);
        text += formatted("<text x=\"%g\" y=\"%g\" font-weight=\"bold\">%s</text>\n", corner.x + kMargin,
                          corner.y + 20.0, markup_text(file_name(mesh.file)).c_str());
        text += formatted("<text x=\"%g\" y=\"%g\" fill=\"#555\">%s %.6g: %.4g × %.4g × %.4g</text>\n",
                          corner.x + kMargin, corner.y + 37.0, markup_text(mesh.chosen.criterion).c_str(),
                          mesh.chosen.value, edges.x, edges.y, edges.z);
        Panel(mesh, corner + glm::dvec2(0.5 * kPanel, kHeading + 0.5 * kPanel), 0.5 * kPanel - kMargin, text).draw();
    }
    return text + "</svg>\n";
}

}  // namespace crofton::cli
