// SPDX-License-Identifier: MIT
// Faces of OBJ files that no fan fills: concave ones, keyholes, warped ones, and those that make no polygon.
#include <doctest/doctest.h>
#include <assets/face_triangles.hpp>
#include <assets/obj_file.hpp>
#include <assets/scene_source.hpp>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "messages.hpp"
#include "test_files.hpp"

using namespace crofton;
using test_files::says;
using test_files::TemporaryFile;

namespace {

using Ring = std::vector<glm::dvec2>;

double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

double shoelace(const Ring& ring) {
    double twice = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::dvec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

// Corners at random distances around the origin, in order of their angles: concave as often as not.
Ring star(std::mt19937& random, int corners) {
    Ring ring;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + uniform(random, 0.1, 0.9)) / corners,
                     radius = uniform(random, 0.3, 2.0);
        ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return ring;
}

// A back with teeth of random lengths, some of its corners in one line.
Ring comb(std::mt19937& random, int teeth) {
    Ring ring{{0.0, -1.0}, {2.0 * teeth, -1.0}};
    for (int i = teeth; i-- > 0;) {
        const double height = uniform(random, 0.1, 3.0);
        ring.insert(ring.end(),
                    {{2.0 * i + 2.0, 0.0}, {2.0 * i + 1.5, height}, {2.0 * i + 1.0, height}, {2.0 * i + 1.0, 0.0}});
    }
    return ring;
}

// A band of width 0.4 that winds outwards, with so many corners a turn that its turns stay apart.
Ring spiral(std::mt19937& random, int more_corners) {
    const double turns = uniform(random, 0.5, 3.0);
    const int corners = static_cast<int>(16.0 * turns) + more_corners;
    Ring ring, inner;
    for (int i = 0; i <= corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * turns * i / corners, radius = 1.0 + angle / std::numbers::pi;
        ring.emplace_back((radius + 0.4) * std::cos(angle), (radius + 0.4) * std::sin(angle));
        inner.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    ring.insert(ring.end(), inner.rbegin(), inner.rend());
    return ring;
}

struct Keyhole {
    Ring ring;
    double area = 0.0;
};

// A rectangle with rows of holes, reached one from the other by bridges from its left side: one ring that goes along
// each bridge twice.
Keyhole keyhole(std::mt19937& random) {
    // The lower half first or, as keyholes should be, the upper one: what is inside is the same.
    const double side = random() % 2 == 0 ? 1.0 : -1.0;
    const int rows = 1 + static_cast<int>(random() % 3), columns = 1 + static_cast<int>(random() % 3);
    Keyhole result{{{0.0, 0.0}, {4.0 * columns, 0.0}, {4.0 * columns, 4.0 * rows}, {0.0, 4.0 * rows}},
                   16.0 * rows * columns};
    for (int row = rows; row-- > 0;) {
        const double y = 4.0 * row + 2.0;
        Ring below{{0.0, y}}, above;
        for (int column = 0; column < columns; ++column) {
            const int sides = 1 + static_cast<int>(random() % 4);  // of each half, from the left corner to the right
            const double x = 4.0 * column + 2.0, radius = uniform(random, 0.3, 1.8);
            Ring hole;
            for (int half = 0; half < 2; ++half)
                for (int i = 0; i < sides; ++i) {
                    const double angle = std::numbers::pi * (1.0 + half + static_cast<double>(i) / sides);
                    hole.emplace_back(i == 0 ? x + (half == 0 ? -radius : radius) : x + radius * std::cos(angle),
                                      i == 0 ? y : y + side * radius * std::sin(angle));
                }
            if (sides == 1) {
                hole.insert(hole.begin() + 1, {x, y - side * radius});
                hole.emplace_back(x, y + side * radius);
            }
            result.area -= std::abs(shoelace(hole));
            // Along one half to the right, back along the other.
            const std::size_t half = hole.size() / 2;
            below.insert(below.end(), hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(half) + 1);
            above.insert(above.begin(), hole.begin() + static_cast<std::ptrdiff_t>(half), hole.end());
            above.insert(above.begin() + static_cast<std::ptrdiff_t>(hole.size() - half), hole[0]);
        }
        above.erase(above.begin());  // the last hole's right corner is no bridge
        result.ring.insert(result.ring.end(), below.begin(), below.end());
        result.ring.insert(result.ring.end(), above.begin(), above.end());
        result.ring.emplace_back(0.0, y);
    }
    return result;
}

// A plane in space: ring coordinates go to origin + size · (x u + y v).
struct FacePlane {
    glm::dvec3 origin{0.0}, u{1.0, 0.0, 0.0}, v{0.0, 1.0, 0.0};
    double size = 1.0;
    [[nodiscard]] glm::dvec3 at(const glm::dvec2& p) const { return origin + size * (p.x * u + p.y * v); }
};

FacePlane random_plane(std::mt19937& random) {
    FacePlane plane;
    plane.size = std::exp(uniform(random, -20.0, 20.0));
    if (random() % 4 == 0) return plane;
    const glm::dquat turn = glm::normalize(glm::dquat(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0),
                                                      uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)));
    plane.u = turn * plane.u;
    plane.v = turn * plane.v;
    plane.origin = plane.size * glm::dvec3(uniform(random, -9.0, 9.0), uniform(random, -9.0, 9.0), 3.0);
    return plane;
}

// One face; every corner a vertex of its own, or those at one place the same one.
std::string face_text(std::span<const glm::dvec3> corners, bool shared = false) {
    std::string text, face = "f";
    std::map<std::array<double, 3>, std::size_t> known;
    std::size_t count = 0;
    for (const glm::dvec3& p : corners) {
        const auto [entry, added] = known.try_emplace({p.x, p.y, p.z}, count + 1);
        if (!shared) entry->second = count + 1;
        if (added || !shared) {
            char line[128];
            std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\nvt %.9g %.9g\n", p.x, p.y, p.z, p.x, p.y);
            text += line;
            ++count;
        }
        face += " " + std::to_string(entry->second) + "/" + std::to_string(entry->second);
    }
    return text + face + "\n";
}

assets::ObjFile read_face(const std::string& text) {
    const TemporaryFile file("face.obj", text);
    auto obj = assets::read_obj(file.path());
    REQUIRE_MESSAGE(obj.has_value(), obj.error().message);
    return std::move(*obj);
}

// The area of triangles that all face along `normal`; NaN if one does not.
double area_along(const assets::ObjFile& obj, const glm::dvec3& normal) {
    double area = 0.0;
    for (const assets::ObjFile::Part& part : obj.parts)
        for (std::size_t i = 0; i < part.indices.size(); i += 3) {
            const glm::dvec3 &a = obj.positions[part.indices[i]], &b = obj.positions[part.indices[i + 1]],
                             &c = obj.positions[part.indices[i + 2]];
            const glm::dvec3 twice = glm::cross(b - a, c - a);
            if (glm::dot(twice, normal) < -1e-9 * glm::dot(c - a, c - a)) return std::nan("");
            area += 0.5 * glm::dot(twice, normal);
        }
    return area;
}

// The face as it is, from another corner on, and the other way round.
void check_area(std::mt19937& random, Ring ring, double area, std::size_t most_triangles) {
    const FacePlane plane = random_plane(random);
    const glm::dvec3 normal = glm::cross(plane.u, plane.v);
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(random() % ring.size()), ring.end());
    for (const bool backwards : {false, true}) {
        if (backwards) std::reverse(ring.begin(), ring.end());
        std::vector<glm::dvec3> corners;
        for (const glm::dvec2& p : ring) corners.push_back(plane.at(p));
        const auto obj = read_face(face_text(corners, random() % 2 == 0));
        CHECK(obj.odd_lines.empty());
        CHECK(area_along(obj, backwards ? -normal : normal) ==
              doctest::Approx(area * plane.size * plane.size).epsilon(1e-9));
        CHECK(obj.parts[0].indices.size() <= 3 * most_triangles);
        CHECK(obj.parts[0].indices == obj.parts[0].texcoord_indices);
    }
}

using Point = std::array<int, 2>;

long side_of(const Point& a, const Point& b, const Point& c) {
    return static_cast<long>(b[0] - a[0]) * (c[1] - a[1]) - static_cast<long>(b[1] - a[1]) * (c[0] - a[0]);
}

enum class Meeting { apart, touch, cross };
Meeting meeting(const Point& a, const Point& b, const Point& c, const Point& d) {
    const long p = side_of(a, b, c), q = side_of(a, b, d), r = side_of(c, d, a), s = side_of(c, d, b);
    if (((p > 0 && q < 0) || (p < 0 && q > 0)) && ((r > 0 && s < 0) || (r < 0 && s > 0))) return Meeting::cross;
    const auto on = [](const Point& x, const Point& y, const Point& z, long side) {
        return side == 0 && std::min(x[0], y[0]) <= z[0] && z[0] <= std::max(x[0], y[0]) &&
               std::min(x[1], y[1]) <= z[1] && z[1] <= std::max(x[1], y[1]);
    };
    return on(a, b, c, p) || on(a, b, d, q) || on(c, d, a, r) || on(c, d, b, s) ? Meeting::touch : Meeting::apart;
}

}  // namespace

TEST_SUITE("assets/obj_faces") {
    TEST_CASE("concave faces have the area of their outline, from every corner, in every plane, either way round") {
        std::mt19937 random(4601);
        for (int trial = 0; trial < 400; ++trial) {
            CAPTURE(trial);
            const int corners = 4 + static_cast<int>(random() % 40);
            const Ring ring = trial % 3 == 0   ? star(random, corners)
                              : trial % 3 == 1 ? comb(random, 1 + corners / 4)
                                               : spiral(random, corners);
            check_area(random, ring, std::abs(shoelace(ring)), ring.size() - 2);
        }
    }

    TEST_CASE("keyholes have the area of their outline less that of their holes") {
        std::mt19937 random(4602);
        for (int trial = 0; trial < 300; ++trial) {
            CAPTURE(trial);
            const Keyhole made = keyhole(random);
            check_area(random, made.ring, made.area, made.ring.size() - 2);
        }
    }

    TEST_CASE("a keyhole with more corners on one side of its bridges is cut, rounded to doubles or to floats") {
        std::mt19937 random(4605);
        for (int trial = 0; trial < 600; ++trial) {
            CAPTURE(trial);
            const Keyhole made = keyhole(random);
            Ring ring;
            for (std::size_t i = 0; i < made.ring.size(); ++i) {
                const glm::dvec2 &a = made.ring[i], &b = made.ring[(i + 1) % made.ring.size()];
                ring.push_back(a);
                if (random() % 2 == 0) ring.push_back(glm::mix(a, b, uniform(random, 0.1, 0.9)));
            }
            if (trial % 2 == 0) {
                check_area(random, ring, made.area, 2 * ring.size());
                continue;
            }
            FacePlane plane = random_plane(random);
            plane.origin *= 0.1;
            std::vector<glm::dvec3> corners;
            for (const glm::dvec2& p : ring) corners.emplace_back(glm::vec3(plane.at(p)));
            const auto obj = read_face(face_text(corners));
            CHECK(obj.odd_lines.empty());
            double area = 0.0;
            for (std::size_t i = 0; i < obj.parts[0].indices.size(); i += 3) {
                const auto at = [&](std::size_t k) { return obj.positions[obj.parts[0].indices[i + k]]; };
                area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
            }
            CHECK(area == doctest::Approx(made.area * plane.size * plane.size).epsilon(1e-5));
        }
    }

    TEST_CASE("a warped face is cut in its projection along its Newell normal") {
        std::mt19937 random(4603);
        for (int trial = 0; trial < 200; ++trial) {
            CAPTURE(trial);
            const Ring ring = star(random, 4 + static_cast<int>(random() % 12));
            const FacePlane plane = random_plane(random);
            const glm::dvec3 up = glm::cross(plane.u, plane.v);
            std::vector<glm::dvec3> corners;
            for (const glm::dvec2& p : ring)
                corners.push_back(plane.at(p) + uniform(random, -0.05, 0.05) * plane.size * up);
            glm::dvec3 newell(0.0);
            for (std::size_t i = 0; i < corners.size(); ++i)
                newell += glm::cross(corners[i] - plane.origin, corners[(i + 1) % corners.size()] - plane.origin);
            const auto obj = read_face(face_text(corners));
            if (!obj.odd_lines.empty()) continue;  // the warp made it cross itself
            CHECK(area_along(obj, glm::normalize(newell)) == doctest::Approx(0.5 * glm::length(newell)).epsilon(1e-9));
            CHECK(obj.parts[0].indices.size() == 3 * (corners.size() - 2));
        }
    }

    TEST_CASE("an outline that crosses itself is a fan with a warning, one that does not is cut exactly") {
        std::mt19937 random(4604);
        int crossing = 0, simple = 0;
        for (int trial = 0; trial < 20'000; ++trial) {
            const std::size_t n = 4 + random() % 5;
            std::vector<Point> points(n);
            for (Point& p : points) p = {static_cast<int>(random() % 12), static_cast<int>(random() % 12)};
            bool crosses = false, touches = false;
            Ring ring;
            std::vector<glm::dvec3> corners;
            for (std::size_t i = 0; i < n; ++i) {
                ring.emplace_back(points[i][0], points[i][1]);
                corners.emplace_back(0.0, points[i][0], points[i][1]);
                for (std::size_t j = i + 1; j < n; ++j) {
                    const Point &a = points[i], &b = points[(i + 1) % n], &c = points[j], &d = points[(j + 1) % n];
                    const bool neighbours = j == i + 1 || (i == 0 && j == n - 1);
                    if (!neighbours) {
                        crosses = crosses || meeting(a, b, c, d) == Meeting::cross;
                        touches = touches || meeting(a, b, c, d) == Meeting::touch;
                    }
                }
                touches = touches || side_of(points[i], points[(i + 1) % n], points[(i + 2) % n]) == 0;
            }
            if (touches) continue;
            assets::FaceTriangulator triangulator;
            const assets::FaceCut cut = triangulator.cut(corners);
            CAPTURE(trial);
            CHECK(triangulator.triangles().size() == n - 2);
            if (crosses) {
                ++crossing;
                CHECK(cut == assets::FaceCut::no_polygon);
                continue;
            }
            ++simple;
            CHECK((cut == assets::FaceCut::convex || cut == assets::FaceCut::triangulated));
            double area = 0.0;
            for (const auto& t : triangulator.triangles()) {
                const glm::dvec2 a = ring[t[0]], b = ring[t[1]], c = ring[t[2]];
                const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
                CHECK(twice * shoelace(ring) > 0.0);
                area += 0.5 * std::abs(twice);
            }
            CHECK(area == std::abs(shoelace(ring)));
        }
        CHECK(crossing > 3000);
        CHECK(simple > 3000);
    }

    TEST_CASE("faces that make no polygon are named by line, as fans") {
        const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\n";
        const auto warning = [&](const std::string& face) {
            const auto obj = read_face(square + face);
            REQUIRE(obj.odd_lines.size() == 1);
            CHECK(obj.warnings.empty());
            return obj.odd_lines[0];
        };
        for (const char* face : {"f 1 3 2 4\n", "f 1 2 5 6\n", "f 1 1 1 1\n", "f 1 2 3 2\n"})
            CHECK(warning(face) == "line 7: face: crosses itself or has no area: cut as a fan from its first corner");
        CHECK(read_face(square + "f 1 2 3 3 4 4\n").odd_lines.empty());  // corners named twice
        std::string many = square;
        for (int i = 0; i < 100; ++i) many += "f 1 3 2 4\n";
        const auto obj = read_face(many);
        REQUIRE(obj.odd_lines.size() == 21);
        CHECK(obj.odd_lines[20] == "80 more faces cross themselves or have no area: cut as fans");
        const TemporaryFile file("bow_tie.obj", square + "f 1 3 2 4\nf 1 2 3 4\n");
        const auto source = assets::load_scene(file.path());
        REQUIRE(source.has_value());
        REQUIRE(source->warnings.size() == 1);
        CHECK(says(source->warnings[0], "line 7: face: crosses itself or has no area"));
        CHECK(says(test_files::message(assets::load_scene(file.path(), {.strict = true})), "line 7: face"));
    }

    TEST_CASE("coordinates of any size are cut alike: beyond what squares can hold, and denormal ones") {
        const Ring ring{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
        for (const double size :
             {1e300, 1e154, 1e38, 1e-38, 1e-160, 1e-300, std::numeric_limits<double>::denorm_min()}) {
            CAPTURE(size);
            std::vector<glm::dvec3> corners;
            for (const glm::dvec2& p : ring) corners.emplace_back(p.y * size, 0.0, p.x * size);
            assets::FaceTriangulator triangulator;
            CHECK(triangulator.cut(corners) == assets::FaceCut::triangulated);
            double area = 0.0;
            for (const auto& t : triangulator.triangles()) area += shoelace({ring[t[0]], ring[t[1]], ring[t[2]]});
            CHECK(area == shoelace(ring));
        }
    }

    TEST_CASE("a face of 20,000 corners takes no more than a second, and counts as its triangles do") {
        std::mt19937 random(4605);
        const Ring ring = star(random, 20'000);
        std::vector<glm::dvec3> corners;
        for (const glm::dvec2& p : ring) corners.emplace_back(p.x, 0.0, p.y);
        const std::string text = face_text(corners);
        CHECK(area_along(read_face(text), {0.0, -1.0, 0.0}) == doctest::Approx(shoelace(ring)).epsilon(1e-9));
        const TemporaryFile file("long.obj", text);
        assets::LoadOptions options;
        options.limits.triangles = 19'997;
        CHECK(says(test_files::message(assets::load_scene(file.path(), options)), "--max-triangles"));
    }
}
