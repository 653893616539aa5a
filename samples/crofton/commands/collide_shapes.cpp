// SPDX-License-Identifier: MIT
#include "collide_shapes.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "assets/float_origin.hpp"
#include "mesh_file.hpp"

namespace crofton::cli {
namespace {

Json numbers(const glm::dvec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json feature_of(const convex::Feature& feature) {
    constexpr const char* kNames[] = {"vertex", "edge", "face"};
    return {{"kind", kNames[static_cast<int>(feature.kind)]}, {"index", feature.index}};
}

std::string text_of(const char* format, double a, double b = 0.0, double c = 0.0, double d = 0.0) {
    char text[160];
    std::snprintf(text, sizeof text, format, a, b, c, d);
    return text;
}

}  // namespace

Result<FileShape> load_shape(const std::string& path, bool as_hull, int max_vertices, const ReadOptions& options) {
    FileShape made;
    const auto named = [&](const Error& e) { return fail(e.code, e.item, path + ": " + e.message); };
    if (as_hull) {
        const auto points = load_points(path, options);
        if (!points) return points.error();
        glm::dvec3 low = (*points)[0], high = low;
        for (const glm::dvec3& p : *points) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        made.origin = assets::float_origin(low, high);
        std::vector<glm::vec3> floats;
        for (const glm::dvec3& p : *points) floats.emplace_back(p - made.origin);
        auto hull = convex::Hull::build(floats, {.max_vertices = max_vertices});
        if (!hull) return named(hull.error());
        made.hull = std::move(*hull);
        return made;
    }
    const auto loaded = load_mesh(path, options);
    if (!loaded) return loaded.error();
    made.origin = loaded->origin;
    auto tree = mesh::MeshTree::build(loaded->mesh);
    if (!tree) return named(tree.error());
    made.mesh = std::move(*tree);
    if (auto shape = convex::Shape::mesh(*made.mesh); !shape) return named(shape.error());
    return made;
}

Result<glm::dvec3> vector_of(const std::string& option, const std::string& text) {
    glm::dvec3 value(0.0);
    if (text.empty()) return value;
    const char *at = text.data(), *const end = at + text.size();
    for (int k = 0; k < 3; ++k) {
        const auto [next, error] = std::from_chars(at, end, value[k]);
        const bool last = k == 2;
        if (error != std::errc() || (last ? next != end : next == end || *next != ',') || !std::isfinite(value[k]))
            return fail(ErrorCode::parse, static_cast<std::uint64_t>(k), option + " " + text + ": give x,y,z");
        at = next + 1;
    }
    return value;
}

ShapeAnswer ask_hulls(const std::string& mode, const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                      const glm::dvec3& origin) {
    ShapeAnswer answer;
    const bool hit = convex::intersects(a, b);
    answer.document["hit"] = hit;
    answer.sentence = hit ? "hit" : "no hit";
    if (mode == "distance") {
        const convex::Distance d = convex::distance(a, b);
        answer.document["distance"] = d.distance;
        answer.document["bounds"] = {d.lower, d.upper};
        answer.document["nearest"] = {{"on_a", numbers(origin + d.on_a)}, {"on_b", numbers(origin + d.on_b)}};
        answer.sentence += text_of(", distance %.9g, proven between %.17g and %.17g", d.distance, d.lower, d.upper);
    }
    if (mode == "all") {
        const convex::Penetration p = convex::penetration(a, b);
        const convex::Manifold m = convex::contact_manifold(a, b);
        answer.document["depth"] = p.depth;
        answer.document["bounds"] = {p.lower, p.upper};
        answer.document["normal"] = numbers(p.normal);
        Json contacts = Json::array();
        for (int i = 0; i < m.count; ++i)
            contacts.push_back({{"position", numbers(origin + m.points[i].position)},
                                {"depth", m.points[i].depth},
                                {"on_a", feature_of(m.points[i].on_a)},
                                {"on_b", feature_of(m.points[i].on_b)}});
        answer.document["contacts"] = contacts;
        answer.sentence += text_of(", depth %.9g, proven between %.17g and %.17g", p.depth, p.lower, p.upper);
        answer.sentence += ", " + std::to_string(m.count) + " contact points";
    }
    return answer;
}

Result<ShapeAnswer> ask_cast(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b, const convex::Motion& motion,
                             double duration, const glm::dvec3& origin) {
    const auto impact = convex::cast(a, {}, b, motion, {.duration = duration});
    if (!impact) return impact.error();
    constexpr const char* kNames[] = {"miss", "hit", "unresolved"};
    ShapeAnswer answer;
    answer.document = {{"hit", impact->result == convex::CastResult::hit},
                       {"result", kNames[static_cast<int>(impact->result)]},
                       {"time", impact->time},
                       {"steps", impact->steps}};
    if (impact->result == convex::CastResult::miss) {
        answer.sentence = text_of("no hit within a time of %.9g, proven", impact->time);
        return answer;
    }
    answer.document["normal"] = numbers(impact->normal);
    answer.document["on_a"] = numbers(origin + impact->on_a);
    answer.document["on_b"] = numbers(origin + impact->on_b);
    answer.document["distance"] = impact->distance;
    answer.sentence = impact->result == convex::CastResult::hit
                          ? text_of("hit at %.9g, at (%.9g, %.9g, %.9g)", impact->time, origin.x + impact->on_a.x,
                                    origin.y + impact->on_a.y, origin.z + impact->on_a.z)
                          : text_of("no hit before %.9g; later is not known", impact->time);
    return answer;
}

}  // namespace crofton::cli
