// SPDX-License-Identifier: MIT
// Terraced houses: façades with window and door holes, gables, roofs.
#include <array>
#include <cmath>
#include <numbers>

#include "assets/town_library.hpp"

namespace crofton::assets::town {
namespace {

constexpr double kPlinth = 0.35;
constexpr double kReveal = 0.22;
constexpr double kStorey = 3.0;

struct Style {
    int width = 6, floors = 3;
    double roof_rise = 3.5;
    bool shop = false, dormer = false, lintels = false;
    double window_width = 1.1, window_height = 1.5;
    glm::vec3 wall, trim, roof, door;

    [[nodiscard]] double eaves() const { return kPlinth + kStorey * floors + (shop ? 0.4 : 0.0) + 0.25; }
};

Style make_style(Library& library, int width) {
    static const std::array walls = {srgb(222, 204, 170), srgb(196, 120, 86),  srgb(168, 88, 66),
                                     srgb(232, 224, 208), srgb(214, 168, 110), srgb(154, 164, 150),
                                     srgb(198, 190, 178), srgb(226, 186, 158), srgb(146, 74, 58),
                                     srgb(176, 184, 196), srgb(236, 214, 150), srgb(188, 140, 120)};
    static const std::array roofs = {srgb(146, 68, 48), srgb(120, 58, 44), srgb(74, 76, 84), srgb(98, 62, 50),
                                     srgb(158, 86, 58)};
    static const std::array doors = {srgb(40, 72, 56), srgb(110, 34, 30), srgb(34, 52, 88), srgb(86, 58, 36),
                                     srgb(32, 34, 38)};
    static const std::array trims = {srgb(244, 242, 236), srgb(236, 228, 210), srgb(70, 74, 70), srgb(210, 206, 198)};
    Style s;
    s.width = width;
    s.floors = 2;
    s.floors += library.chance(0.5) ? 1 : 0;
    s.floors += library.chance(0.2) ? 1 : 0;
    s.roof_rise = library.random.uniform(2.4, 4.4);
    s.shop = library.chance(0.3);
    s.dormer = library.chance(0.4);
    s.lintels = library.chance(0.6);
    s.window_width = library.random.uniform(0.9, 1.25);
    s.window_height = library.random.uniform(1.4, 1.8);
    const auto any = [&](const auto& list) {
        return list[static_cast<std::size_t>(library.pick(static_cast<int>(list.size())))];
    };
    const double wall = library.random.uniform(0.88, 1.04);
    s.wall = scaled(any(walls), wall);
    const double roof = library.random.uniform(0.85, 1.1);
    s.roof = scaled(any(roofs), roof);
    s.trim = any(trims);
    s.door = any(doors);
    return s;
}

std::vector<Opening> front_openings(Library& library, const Style& s) {
    std::vector<Opening> result;
    const int columns = s.width < 6 ? 2 : 3;
    const double pitch = static_cast<double>(s.width) / columns;
    const int door_column = library.chance(0.5) ? 0 : columns - 1;
    const double upper = s.shop ? 0.4 : 0.0;
    for (int floor = 0; floor < s.floors; ++floor)
        for (int c = 0; c < columns; ++c) {
            const double middle = (c + 0.5) * pitch;
            const double base = kPlinth + kStorey * floor + (floor > 0 ? upper : 0.0);
            if (floor == 0 && c == door_column) {
                result.push_back({Opening::Kind::door, middle - 0.55, 0.2, 1.1, 2.35});
            } else if (floor == 0 && s.shop) {
                result.push_back({Opening::Kind::shop, middle - 0.5 * pitch + 0.18, 0.55, pitch - 0.36, 2.2});
            } else {
                result.push_back({Opening::Kind::window, middle - 0.5 * s.window_width, base + 0.85, s.window_width,
                                  s.window_height});
            }
        }
    return result;
}

std::vector<Opening> back_openings(Library& library, const Style& s) {
    std::vector<Opening> result;
    const double pitch = 0.5 * s.width;
    for (int floor = 0; floor < s.floors; ++floor)
        for (int c = 0; c < 2; ++c) {
            const double middle = (c + 0.5) * pitch, base = kPlinth + kStorey * floor;
            if (floor == 0 && c == 0)
                result.push_back({Opening::Kind::door, middle - 0.5, 0.2, 1.0, 2.2});
            else if (library.chance(0.9))
                result.push_back({Opening::Kind::window, middle - 0.5, base + 0.9, 1.0, 1.3});
        }
    return result;
}

// A slab of tiles between the eaves line z_eaves and the ridge, in courses of slightly different colour.
void add_roof_slope(MeshBuilder& b, Library& library, const Style& s, double z_eaves, double y_eaves, double z_ridge,
                    double y_ridge) {
    constexpr int kCourses = 5;
    constexpr double kThickness = 0.16;
    const double left = -0.12, right = s.width + 0.12;
    const auto at = [&](double t, double lift, double x) {
        return glm::dvec3(x, y_eaves + t * (y_ridge - y_eaves) + lift, z_eaves + t * (z_ridge - z_eaves));
    };
    const bool front = z_eaves > z_ridge;
    const auto face = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r, const glm::dvec3& t,
                          const glm::vec3& c) {
        if (front)
            b.quad(p, q, r, t, c);
        else
            b.quad(q, p, t, r, c);
    };
    for (int k = 0; k < kCourses; ++k) {
        const double t0 = static_cast<double>(k) / kCourses, t1 = (k + 1.0) / kCourses;
        const glm::vec3 color = scaled(s.roof, library.random.uniform(0.88, 1.08));
        face(at(t0, kThickness, left), at(t0, kThickness, right), at(t1, kThickness, right), at(t1, kThickness, left),
             color);
    }
    const glm::vec3 edge = scaled(s.roof, 0.6);
    face(at(0, 0, left), at(0, 0, right), at(0, kThickness, right), at(0, kThickness, left), s.trim);
    face(at(0, 0, right), at(1, 0, right), at(1, kThickness, right), at(0, kThickness, right), edge);
    face(at(1, 0, left), at(0, 0, left), at(0, kThickness, left), at(1, kThickness, left), edge);
    face(at(1, 0, left), at(1, 0, right), at(0, 0, right), at(0, 0, left), edge);
}

void add_dormer(MeshBuilder& b, const Style& s, double x, double y, double z) {
    const double w = 0.75, h = 1.3, back = 2.2;
    b.quad({x - w, y, z}, {x + w, y, z}, {x + w, y + h, z}, {x - w, y + h, z}, s.wall);
    b.quad({x - 0.45, y + 0.25, z + 0.02}, {x + 0.45, y + 0.25, z + 0.02}, {x + 0.45, y + 1.15, z + 0.02},
           {x - 0.45, y + 1.15, z + 0.02}, srgb(60, 74, 88));
    b.triangle({x - w, y + h, z}, {x + w, y + h, z}, {x, y + h + 0.6, z}, s.wall);
    b.quad({x + w, y, z}, {x + w, y, z - back}, {x + w, y + h, z - back}, {x + w, y + h, z}, s.wall);
    b.quad({x - w, y, z - back}, {x - w, y, z}, {x - w, y + h, z}, {x - w, y + h, z - back}, s.wall);
    const double o = 0.12;
    b.quad({x + w + o, y + h - 0.1, z + o}, {x + w + o, y + h - 0.1, z - back}, {x, y + h + 0.68, z - back},
           {x, y + h + 0.68, z + o}, s.roof);
    b.quad({x - w - o, y + h - 0.1, z - back}, {x - w - o, y + h - 0.1, z + o}, {x, y + h + 0.68, z + o},
           {x, y + h + 0.68, z - back}, s.roof);
}

scene::MeshId make_roof(Library& library, const Style& s) {
    MeshBuilder b;
    const double ridge_y = s.eaves() + s.roof_rise, ridge_z = -0.5 * kHouseDepth;
    const double slope = s.roof_rise / (0.5 * kHouseDepth), overhang = 0.45;
    add_roof_slope(b, library, s, overhang, s.eaves() - slope * overhang, ridge_z, ridge_y);
    add_roof_slope(b, library, s, -kHouseDepth - overhang, s.eaves() - slope * overhang, ridge_z, ridge_y);
    b.box({-0.12, ridge_y + 0.08, ridge_z - 0.14}, {s.width + 0.12, ridge_y + 0.24, ridge_z + 0.14},
          scaled(s.roof, 0.8));
    const double cx = library.random.uniform(0.8, s.width - 0.8), cz = ridge_z - 1.2;
    b.box({cx - 0.35, ridge_y - 1.6, cz - 0.3}, {cx + 0.35, ridge_y + 0.9, cz + 0.3}, scaled(s.wall, 0.72), true);
    b.box({cx - 0.42, ridge_y + 0.9, cz - 0.37}, {cx + 0.42, ridge_y + 1.02, cz + 0.37}, scaled(s.wall, 0.5));
    for (const double dx : {-0.17, 0.17})
        b.tube({cx + dx, ridge_y + 1.0, cz}, {cx + dx, ridge_y + 1.4, cz}, 0.11, 0.09, 5, srgb(168, 92, 66));
    if (s.dormer)
        for (int k = 0; k < (s.width < 6 ? 1 : 2); ++k) {
            const double x = s.width < 6 ? 0.5 * s.width : s.width * (0.28 + 0.44 * k);
            add_dormer(b, s, x, s.eaves() + 0.35, -1.0);
        }
    // A gutter and its pipe.
    const double gutter = s.eaves() - slope * overhang + 0.02;
    b.bar({0.0, gutter, overhang + 0.06}, {static_cast<double>(s.width), gutter, overhang + 0.06}, 0.12,
          srgb(110, 112, 114));
    b.tube({s.width - 0.12, 0.1, 0.07}, {s.width - 0.12, gutter, 0.07}, 0.05, 0.05, 6, srgb(120, 122, 124), true);
    return library.add(b, "roof");
}

void add_awning(MeshBuilder& b, const Style& s, const Opening& o, const glm::vec3& color) {
    const double y = o.y + o.height + 0.3, stripe = o.width / 6.0;
    for (int k = 0; k < 6; ++k) {
        const double x0 = o.x + k * stripe, x1 = x0 + stripe;
        const glm::vec3 c = k % 2 == 0 ? color : s.trim;
        b.quad({x0, y - 0.65, 1.1}, {x1, y - 0.65, 1.1}, {x1, y, 0.03}, {x0, y, 0.03}, c);
        b.quad({x1, y - 0.68, 1.1}, {x0, y - 0.68, 1.1}, {x0, y - 0.03, 0.03}, {x1, y - 0.03, 0.03}, scaled(c, 0.5));
        b.quad({x0, y - 0.9, 1.1}, {x1, y - 0.9, 1.1}, {x1, y - 0.65, 1.1}, {x0, y - 0.65, 1.1}, c);
    }
}

}  // namespace

void add_joinery(MeshBuilder& b, Library& library, const std::vector<Opening>& openings, const glm::vec3& frame,
                 const glm::vec3& door, const glm::vec3& sill, bool plain) {
    static const std::array panes = {srgb(58, 74, 92), srgb(72, 90, 108), srgb(44, 58, 72), srgb(196, 190, 176),
                                     srgb(120, 128, 132)};
    constexpr std::size_t kFirstLit = 3;
    for (const Opening& o : openings) {
        const double x0 = o.x, x1 = o.x + o.width, y0 = o.y, y1 = o.y + o.height, z = -kReveal;
        const glm::vec3 reveal = scaled(sill, 0.75);
        b.quad({x0, y0, 0}, {x0, y0, z}, {x0, y1, z}, {x0, y1, 0}, reveal);
        b.quad({x1, y0, z}, {x1, y0, 0}, {x1, y1, 0}, {x1, y1, z}, reveal);
        b.quad({x0, y0, 0}, {x1, y0, 0}, {x1, y0, z}, {x0, y0, z}, reveal);
        b.quad({x0, y1, z}, {x1, y1, z}, {x1, y1, 0}, {x0, y1, 0}, scaled(reveal, 0.6));
        if (o.kind == Opening::Kind::door) {
            const double light = y1 - 0.45;  // a small window over the door
            b.quad({x0, y0, z}, {x1, y0, z}, {x1, light, z}, {x0, light, z}, door);
            b.quad({x0, light, z}, {x1, light, z}, {x1, y1, z}, {x0, y1, z}, panes[0]);
            b.box({x0, light - 0.04, z}, {x1, light + 0.04, z + 0.06}, frame);
            for (const double py : {y0 + 0.2, y0 + 1.1})
                b.box({x0 + 0.18, py, z}, {x1 - 0.18, py + 0.7, z + 0.03}, scaled(door, 0.8));
            b.box({x1 - 0.2, y0 + 0.95, z}, {x1 - 0.12, y0 + 1.05, z + 0.08}, srgb(200, 170, 90));
            b.box({x0 - 0.2, 0.0, 0.0}, {x1 + 0.2, y0, 0.5}, sill);
            continue;
        }
        // The frame shows around a pane that lies a little before it.
        const double f = 0.07, zp = z + 0.02, zf = z + 0.05;
        b.quad({x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}, frame);
        const auto pane = static_cast<std::size_t>(library.pick(panes.size()));
        if (pane >= kFirstLit) b.glow({0.9f, 0.6f, 0.3f});  // someone is at home
        b.quad({x0 + f, y0 + f, zp}, {x1 - f, y0 + f, zp}, {x1 - f, y1 - f, zp}, {x0 + f, y1 - f, zp}, panes[pane]);
        b.glow(glm::vec3(0.0f));
        const double mx = 0.5 * (x0 + x1);
        b.quad({mx - 0.035, y0, zf}, {mx + 0.035, y0, zf}, {mx + 0.035, y1, zf}, {mx - 0.035, y1, zf}, frame);
        if (o.kind == Opening::Kind::window) {
            const double my = y0 + 0.64 * o.height;
            b.quad({x0, my - 0.03, zf}, {x1, my - 0.03, zf}, {x1, my + 0.03, zf}, {x0, my + 0.03, zf}, frame);
            if (!plain) {  // a sill that is seen from in front and above
                b.quad({x0 - 0.08, y0 - 0.1, 0.12}, {x1 + 0.08, y0 - 0.1, 0.12}, {x1 + 0.08, y0, 0.12},
                       {x0 - 0.08, y0, 0.12}, sill);
                b.quad({x0 - 0.08, y0, 0.12}, {x1 + 0.08, y0, 0.12}, {x1 + 0.08, y0, 0.0}, {x0 - 0.08, y0, 0.0}, sill);
            }
        }
    }
}

Parts make_house(Library& library, int width) {
    const Style s = make_style(library, width);
    const double w = s.width, h = s.eaves(), d = kHouseDepth;
    const auto front = front_openings(library, s), back = back_openings(library, s);
    const std::vector<glm::dvec2> outline{{0, 0}, {w, 0}, {w, h}, {0, h}};
    Parts parts;
    parts.push_back(
        library.add_polygon(facade_rings(outline, front), {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, s.wall, "facade"));
    parts.push_back(
        library.add_polygon(facade_rings(outline, back), {w, 0, -d}, {-1, 0, 0}, {0, 1, 0}, s.wall, "back facade"));
    const std::vector<glm::dvec2> gable{{0, 0}, {d, 0}, {d, h}, {0.5 * d, h + s.roof_rise}, {0, h}};
    std::vector<Opening> attic;
    if (library.chance(0.7)) attic.push_back({Opening::Kind::window, 0.5 * d - 0.5, h + 0.3, 1.0, 1.2});
    const glm::vec3 side = scaled(s.wall, 0.92);
    parts.push_back(library.add_polygon(facade_rings(gable, attic), {0, 0, -d}, {0, 0, 1}, {0, 1, 0}, side, "gable"));
    parts.push_back(library.add_polygon(facade_rings(gable, attic), {w, 0, 0}, {0, 0, -1}, {0, 1, 0}, side, "gable"));

    MeshBuilder b;
    add_joinery(b, library, front, s.trim, s.door, scaled(s.trim, 0.85), false);
    b.box({0.0, 0.0, 0.0}, {w, 0.18, 0.06}, scaled(s.wall, 0.55));
    b.box({0.0, h - 0.3, 0.0}, {w, h - 0.12, 0.12}, s.trim);
    if (s.lintels)
        for (const Opening& o : front)
            if (o.kind == Opening::Kind::window)
                b.box({o.x - 0.1, o.y + o.height, 0.0}, {o.x + o.width + 0.1, o.y + o.height + 0.2, 0.06}, s.trim,
                      true);
    if (s.shop) {
        const glm::vec3 awning = std::array{srgb(176, 48, 44), srgb(40, 98, 72), srgb(46, 78, 130),
                                            srgb(204, 150, 52)}[static_cast<std::size_t>(library.pick(4))];
        b.box({0.1, kPlinth + 2.75, 0.0}, {w - 0.1, kPlinth + 3.25, 0.1}, scaled(awning, 0.8));
        for (const Opening& o : front)
            if (o.kind == Opening::Kind::shop) add_awning(b, s, o, awning);
    }
    parts.push_back(library.add(b, "front joinery"));
    MeshBuilder rear;
    rear.frame = Transform{glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1), {w, 0, -d}};
    add_joinery(rear, library, back, s.trim, scaled(s.door, 0.8), scaled(s.trim, 0.8), true);
    if (!attic.empty()) {
        const Opening& o = attic[0];
        for (const bool left : {true, false}) {
            rear.frame = left ? Transform{glm::dmat3(0, 0, 1, 0, 1, 0, -1, 0, 0), {0, 0, -d}}
                              : Transform{glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0), {w, 0, 0}};
            add_joinery(rear, library, {o}, s.trim, s.door, scaled(s.trim, 0.8), true);
        }
    }
    parts.push_back(library.add(rear, "back joinery"));
    parts.push_back(make_roof(library, s));
    return parts;
}

}  // namespace crofton::assets::town
