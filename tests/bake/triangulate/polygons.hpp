// SPDX-License-Identifier: MIT
// Polygons for the tests: by hand, at random, and from the shared data.
#pragma once
#include <crofton/geometry/mesh.hpp>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace crofton::test {

inline Polygon polygon(std::initializer_list<std::initializer_list<glm::dvec2>> rings) {
    Polygon result;
    for (const auto& ring : rings) {
        result.points.insert(result.points.end(), ring);
        result.ring_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
    }
    return result;
}

struct NamedPolygon {
    std::string name;
    Polygon polygon;
};

// "P name rings", then a line "n x y x y …" for each ring. Empty where the file is absent.
inline std::vector<NamedPolygon> read_poly_file(const std::string& path) {
    std::vector<NamedPolygon> result;
    std::ifstream file(path);
    std::string tag, name;
    for (std::size_t rings = 0; file >> tag >> name >> rings;) {
        NamedPolygon named{name, {}};
        for (std::size_t r = 0, count = 0; r < rings && file >> count; ++r) {
            for (std::size_t i = 0; i < count; ++i) {
                glm::dvec2 p;
                file >> p.x >> p.y;
                named.polygon.points.push_back(p);
            }
            named.polygon.ring_ends.push_back(static_cast<std::uint32_t>(named.polygon.points.size()));
        }
        result.push_back(std::move(named));
    }
    return result;
}

inline Polygon read_json_rings(const std::string& path) {
    Polygon result;
    std::ifstream file(path);
    const auto document = nlohmann::json::parse(file, nullptr, false);
    if (document.is_discarded()) return result;
    for (const auto& ring : document) {
        for (const auto& p : ring) result.points.emplace_back(p[0].get<double>(), p[1].get<double>());
        result.ring_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
    }
    return result;
}

// A star-shaped ring about `centre` with random radii, rounded to multiples of 1 / `grid` (0: not rounded).
inline void add_star(Polygon& polygon, std::mt19937_64& random, glm::dvec2 centre, double inner, double outer,
                     int count, double grid) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double turn = unit(random);
    for (int i = 0; i < count; ++i) {
        const double angle = 6.283185307179586 * (i + turn) / count, radius = inner + (outer - inner) * unit(random);
        glm::dvec2 p = centre + radius * glm::dvec2(std::cos(angle), std::sin(angle));
        if (grid > 0.0) p = glm::dvec2(std::round(p.x * grid), std::round(p.y * grid)) / grid;
        polygon.points.push_back(p);
    }
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
}

}  // namespace crofton::test
