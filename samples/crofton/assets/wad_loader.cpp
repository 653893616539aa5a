// SPDX-License-Identifier: MIT
// A level as a scene: floors and ceilings as polygons with holes, lines as walls.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "assets/convex_pieces.hpp"
#include "assets/file.hpp"
#include "assets/name_color.hpp"
#include "assets/scene_source.hpp"
#include "assets/sector_polygons.hpp"
#include "assets/wad_file.hpp"

namespace crofton::assets {
namespace {

// A marine is 56 units tall, so 32 units are a metre; 1/32 keeps every coordinate exact in float.
constexpr double kMetresPerUnit = 1.0 / 32.0;
constexpr double kPlayerEyeHeight = 41.0 * kMetresPerUnit;

bool is_sky(const std::string& texture) {
    return texture.rfind("F_SKY", 0) == 0;
}

// Lit as the sector is; steeply, as the game does it.
glm::vec3 lit(const std::string& texture, int light) {
    const float level = static_cast<float>(light) / 255.0f;
    return color_for_name(texture) * (0.25f + 1.35f * level * level);
}

class LevelBuilder {
  public:
    LevelBuilder(const WadLevel& level, const LoadOptions& options)
        : level_(level), limits_(options.limits), deadline_(options.limits), source_{level.name,
                                                                                     scene::Scene({options.criterion}),
                                                                                     {},
                                                                                     {},
                                                                                     {},
                                                                                     {}} {}

    Result<SceneSource> build() {
        const auto root = source_.scene.add_node(scene::kNone, {}, ~0u, level_.name);
        if (!root) return root.error();
        root_ = *root;
        for (const WadLevel::Line& line : level_.lines) {
            const glm::dvec2 a = level_.position(line.from), b = level_.position(line.to);
            lines_[{a.x, a.y, b.x, b.y}] = line.right;
            lines_[{b.x, b.y, a.x, a.y}] = line.left;
        }
        const auto sectors = sector_polygons(level_);
        for (std::size_t s = 0; s < sectors.size(); ++s) {
            if (auto good = check_limits(); !good) return good.error();
            add_sector(s, sectors[s]);
        }
        for (std::size_t l = 0; l < level_.lines.size(); ++l) {
            if (auto good = check_limits(); !good) return good.error();
            add_walls(l);
        }
        order_walk();
        if (source_.scene.instance_count() == 0)
            return fail(ErrorCode::empty, kNoItem,
                        "its sectors and lines show nothing" +
                            (source_.warnings.empty() ? "" : ": " + source_.warnings.front()));
        return std::move(source_);
    }

  private:
    [[nodiscard]] Result<void> check_limits() const {
        if (source_.scene.instance_count() >= limits_.nodes) return over_limit("nodes", limits_.nodes);
        if (triangles_ > limits_.triangles) return over_limit("triangles", limits_.triangles);
        return deadline_.check();
    }

    void warn(const std::string& what, std::size_t number, const std::string& why) {
        source_.warnings.push_back(what + " " + std::to_string(number) + ": " + why + "; left out");
    }

    void add_sector(std::size_t number, const SectorPolygons& sector) {
        if (!sector.problem.empty()) warn("sector", number, sector.problem);
        const WadLevel::Sector& s = level_.sectors[number];
        for (const Polygon& polygon : sector.polygons) {
            const auto triangulation = triangulate::triangulate(polygon, {.seconds = limits_.seconds});
            if (!triangulation) {
                warn("sector", number, triangulation.error().message);
                continue;
            }
            triangles_ += triangulation->triangles.size();
            if (!is_sky(s.floor_texture))
                add_flat(number, polygon, *triangulation, s.floor, lit(s.floor_texture, s.light), true);
            if (!is_sky(s.ceiling_texture) && s.ceiling > s.floor)
                add_flat(number, polygon, *triangulation, s.ceiling, lit(s.ceiling_texture, s.light), false);
            add_rooms(polygon, *triangulation, s);
            add_waypoint(polygon, *triangulation, s);
        }
    }

    void add_flat(std::size_t number, const Polygon& polygon, const triangulate::Triangulation& triangulation,
                  int height, const glm::vec3& color, bool floor) {
        scene::PlanarPolygon flat;
        flat.polygon = polygon;
        flat.color = color;
        flat.origin.y = height * kMetresPerUnit;
        // Map (x, y) is north-up seen from above: (x, −z) here. A ceiling is the same map seen from below.
        flat.u = {kMetresPerUnit, 0.0, 0.0};
        flat.v = {0.0, 0.0, -kMetresPerUnit};
        Vector<std::array<std::uint32_t, 3>> triangles = triangulation.triangles;
        if (!floor)
            for (auto& t : triangles) std::swap(t[1], t[2]);
        const std::string name = (floor ? "floor " : "ceiling ") + std::to_string(number);
        const auto mesh = source_.scene.add_polygon(std::move(flat), triangles, name);
        if (!mesh)
            warn("sector", number, mesh.error().message);
        else if (auto added = source_.scene.add_instance(root_, *mesh); !added)
            warn("sector", number, added.error().message);
    }

    void add_rooms(const Polygon& polygon, const triangulate::Triangulation& triangulation, const WadLevel::Sector& s) {
        if (s.ceiling <= s.floor) return;
        for (const auto& piece : convex_pieces(polygon, triangulation.triangles)) {
            Room& room = source_.rooms.emplace_back();
            room.floor = s.floor * kMetresPerUnit;
            room.ceiling = s.ceiling * kMetresPerUnit;
            room.has_floor = !is_sky(s.floor_texture);
            room.has_ceiling = !is_sky(s.ceiling_texture);
            for (std::size_t k = 0; k < 4; ++k) {
                const glm::dvec2 &p = polygon.points[piece[k]], &q = polygon.points[piece[(k + 1) % 4]];
                room.corners[k] = kMetresPerUnit * glm::dvec2(p.x, -p.y);
                const auto line = lines_.find({p.x, p.y, q.x, q.y});
                room.is_wall[k] = line != lines_.end() && is_wall(s, line->second);
            }
        }
    }

    // Whether nothing but the wall is seen from a sector through a side of a line.
    [[nodiscard]] bool is_wall(const WadLevel::Sector& here, std::uint32_t other) const {
        const WadLevel::Sector* there = sector_of(other);
        if (there == nullptr || there->floor >= here.ceiling) return true;
        return there->ceiling <= here.floor && !(is_sky(here.ceiling_texture) && is_sky(there->ceiling_texture));
    }

    // A point in the middle of the sector's largest triangle, if one can stand there.
    void add_waypoint(const Polygon& polygon, const triangulate::Triangulation& triangulation,
                      const WadLevel::Sector& s) {
        constexpr double kLeastArea = 96.0 * 96.0;
        if (s.ceiling - s.floor < 72 || source_.walk.size() >= 64) return;
        double best = kLeastArea;
        glm::dvec2 middle(0.0);
        for (const auto& t : triangulation.triangles) {
            const glm::dvec2 &a = polygon.points[t[0]], &b = polygon.points[t[1]], &c = polygon.points[t[2]];
            const double area = 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
            if (area <= best) continue;
            best = area;
            middle = (a + b + c) / 3.0;
        }
        if (best > kLeastArea)
            source_.walk.emplace_back(middle.x * kMetresPerUnit, s.floor * kMetresPerUnit + kPlayerEyeHeight,
                                      -middle.y * kMetresPerUnit);
    }

    // Each waypoint followed by the nearest one left.
    void order_walk() {
        auto& walk = source_.walk;
        for (std::size_t i = 1; i < walk.size(); ++i) {
            const auto distance = [&](const glm::dvec3& p) { return glm::distance(p, walk[i - 1]); };
            std::swap(walk[i],
                      *std::min_element(walk.begin() + static_cast<std::ptrdiff_t>(i), walk.end(),
                                        [&](const auto& p, const auto& q) { return distance(p) < distance(q); }));
        }
    }

    const WadLevel::Sector* sector_of(std::uint32_t side) const {
        return side == kNoSide ? nullptr : &level_.sectors[level_.sides[side].sector];
    }

    void add_walls(std::size_t number) {
        const WadLevel::Line& line = level_.lines[number];
        add_wall_of_side(number, line.from, line.to, line.right, line.left);
        add_wall_of_side(number, line.to, line.from, line.left, line.right);
    }

    // Adds the wall that `side` shows to its own sector, which is to the right of from → to.
    void add_wall_of_side(std::size_t number, std::uint32_t from, std::uint32_t to, std::uint32_t side,
                          std::uint32_t other) {
        const WadLevel::Sector* here = sector_of(side);
        if (!here) return;
        const WadLevel::Sector* there = sector_of(other);
        const WadLevel::Side& faces = level_.sides[side];
        if (!there) {
            add_quad(number, from, to, here->floor, here->ceiling, lit(faces.middle, here->light));
            return;
        }
        add_quad(number, from, to, here->floor, std::min(there->floor, here->ceiling), lit(faces.lower, here->light));
        if (is_sky(here->ceiling_texture) && is_sky(there->ceiling_texture)) return;
        add_quad(number, from, to, std::max(there->ceiling, here->floor), here->ceiling, lit(faces.upper, here->light));
    }

    void add_quad(std::size_t number, std::uint32_t from, std::uint32_t to, int bottom, int top,
                  const glm::vec3& color) {
        const glm::dvec2 a = level_.position(from), b = level_.position(to);
        if (top <= bottom || a == b) return;
        const auto corner = [](const glm::dvec2& v, int height) {
            return glm::vec3(static_cast<float>(v.x), static_cast<float>(height), static_cast<float>(-v.y)) *
                   static_cast<float>(kMetresPerUnit);
        };
        // Seen from the right of a → b, b is to the right of a.
        TriangleMesh mesh;
        mesh.positions = {corner(a, bottom), corner(b, bottom), corner(b, top), corner(a, top)};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        mesh.colors.assign(4, color);
        const auto id = source_.scene.add_mesh(std::move(mesh), "wall " + std::to_string(number));
        if (!id)
            warn("line", number, id.error().message);
        else if (auto added = source_.scene.add_instance(root_, *id); !added)
            warn("line", number, added.error().message);
    }

    const WadLevel& level_;
    std::map<std::array<double, 4>, std::uint32_t> lines_;  // from, to: the side to the right
    ReadLimits limits_;
    Deadline deadline_;
    std::uint64_t triangles_ = 0;
    SceneSource source_;
    scene::NodeId root_ = scene::kNone;
};

}  // namespace

Result<SceneSource> load_wad(const std::string& path, const LoadOptions& options) {
    const auto bytes = read_file(path, options.limits.bytes);
    if (!bytes) return bytes.error();
    const auto level = read_level(*bytes, options.map);
    if (!level) return in_file(path, "", level.error());
    auto source = LevelBuilder(*level, options).build();
    if (!source) return in_file(path, level->name, source.error());
    source->name = file_name(path) + " " + level->name;
    return source;
}

}  // namespace crofton::assets
