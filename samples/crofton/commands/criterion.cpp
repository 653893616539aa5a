// SPDX-License-Identifier: MIT
#include "criterion.hpp"

#include <charconv>
#include <crofton/geometry/mesh.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "mesh_file.hpp"

namespace crofton::cli {
namespace {

Error bad(const std::string& text, const std::string& why) {
    return fail(ErrorCode::invalid_argument, kNoItem, "--criterion " + text + ": " + why);
}

// Exactly `count` numbers with commas between them; empty if the text is anything else.
std::vector<double> numbers(const std::string& text, std::size_t count) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (values.size() < count) {
        double value = 0.0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) return {};
        values.push_back(value);
        at = next;
        if (values.size() == count) break;
        if (at == end || *at != ',') return {};
        ++at;
    }
    if (at != end) return {};
    return values;
}

Result<measure::Criterion> partner(const std::string& path, const ReadOptions& options) {
    const auto points = load_points(path, options);
    if (!points) return points.error();
    const std::span<const glm::dvec3> span(*points);
    const auto hull = convex_hull(span);
    if (!hull) return fail(hull.error().code, hull.error().item, path + ": " + hull.error().message);
    if (hull->rank == 3) {
        const auto body = measure::intrinsic_volumes_of_polytope(span, hull->triangles);
        if (!body) return body.error();
        return measure::for_partner(*body);
    }
    if (hull->rank == 2) {
        glm::dvec3 twice_area(0.0);
        double perimeter = 0.0;
        const auto at = [&](std::size_t i) { return span[hull->vertices[i % hull->vertices.size()]]; };
        for (std::size_t i = 0; i < hull->vertices.size(); ++i) {
            perimeter += glm::distance(at(i), at(i + 1));
            twice_area += glm::cross(at(i) - at(0), at(i + 1) - at(0));
        }
        return measure::for_partner(
            measure::intrinsic_volumes_of_flat_polygon(0.5 * glm::length(twice_area), perimeter));
    }
    const double length = hull->rank == 1 ? glm::distance(span[hull->vertices[0]], span[hull->vertices[1]]) : 0.0;
    return measure::for_partner(measure::intrinsic_volumes_of_segment(length));
}

}  // namespace

Result<measure::Criterion> parse_criterion(const std::string& text, const ReadOptions& options) {
    const std::size_t colon = text.find(':');
    const std::string name = text.substr(0, colon), rest = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (colon == std::string::npos) {
        if (name == "volume") return measure::minimal_volume();
        if (name == "area") return measure::minimal_area();
        if (name == "perimeter") return measure::minimal_perimeter();
    }
    Result<measure::Criterion> criterion = bad(text, std::string("expected ") + kCriterionSyntax);
    if (name == "rays") {
        const auto v = numbers(rest, 1);
        if (v.empty() || !(v[0] >= 0.0)) return bad(text, "rays need one length, not negative");
        criterion = measure::for_rays(v[0]);
    } else if (name == "frustum") {
        const auto v = numbers(rest, 4);
        if (v.empty()) return bad(text, "a frustum needs four numbers: FOVY (radians), ASPECT, NEAR, FAR");
        Camera camera;
        camera.fov_y = v[0];
        camera.aspect = v[1];
        camera.near_distance = v[2];
        camera.far_distance = v[3];
        criterion = measure::for_frustum(camera);
    } else if (name == "weights") {
        const auto v = numbers(rest, 3);
        if (v.empty()) return bad(text, "weights are three numbers, of volume, area and mean curvature");
        criterion = measure::Criterion{v[0], v[1], v[2]};
    } else if (name == "partner") {
        if (rest.empty()) return bad(text, "a partner needs a mesh file: partner:FILE");
        criterion = partner(rest, options);
    }
    if (!criterion)
        return criterion.error().message.starts_with("--criterion") ? criterion : bad(text, criterion.error().message);
    if (const auto valid = measure::validate(*criterion); !valid) return bad(text, valid.error().message);
    return criterion;
}

}  // namespace crofton::cli
