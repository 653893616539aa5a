// SPDX-License-Identifier: MIT
// The town's vocabulary: every kind of thing once, as meshes and planar polygons of one scene.
#pragma once
#include <crofton/sampling/sampling.hpp>
#include <crofton/scene/scene.hpp>
#include <map>
#include <string>
#include <vector>

#include "assets/mesh_builder.hpp"

namespace crofton::assets::town {

// A thing made of several meshes that share its frame.
using Parts = std::vector<scene::MeshId>;

// A hole in a façade: lower left corner, size.
struct Opening {
    enum class Kind : std::uint8_t { window, door, shop } kind = Kind::window;
    double x = 0.0, y = 0.0, width = 1.0, height = 1.4;
};

// Adds meshes to a scene; the first error sticks, and later calls do nothing.
class Library {
  public:
    Library(scene::Scene& scene, std::uint64_t seed) : random(seed, 1), scene_(scene) {}

    scene::MeshId add(MeshBuilder& builder, std::string name);
    // Triangulated with minimum weight: a polygon in the frame origin, u, v; the first ring is the outer one.
    scene::MeshId add_polygon(const std::vector<std::vector<glm::dvec2>>& rings, const glm::dvec3& origin,
                              const glm::dvec3& u, const glm::dvec3& v, const glm::vec3& color, std::string name);
    [[nodiscard]] const Result<void>& status() const { return status_; }

    int pick(int count) { return static_cast<int>(random.uniform() * count); }  // in [0, count)
    bool chance(double probability) { return random.uniform() < probability; }
    sampling::Random random;
    std::vector<std::vector<glm::vec3>> emission;  // by mesh, as SceneSource has it

  private:
    scene::Scene& scene_;
    Result<void> status_;
};

// Houses stand on x in [0, width], front at z = 0 toward +z, back at z = −kHouseDepth, ground at y = 0.
inline constexpr double kHouseDepth = 9.0;
inline constexpr int kLeastWidth = 5;
inline constexpr int kMostWidth = 8;
[[nodiscard]] Parts make_house(Library& library, int width);
[[nodiscard]] Parts make_church(Library& library);  // centred on the origin, 14 × 26 m, door toward +z

// Panes, frames, reveals and, unless `plain`, sills that show in the openings of a façade whose frame is (x right, y
// up, z outward).
void add_joinery(MeshBuilder& builder, Library& library, const std::vector<Opening>& openings, const glm::vec3& frame,
                 const glm::vec3& door, const glm::vec3& sill, bool plain);
// The façade's rings: its outline, then one per opening.
[[nodiscard]] std::vector<std::vector<glm::dvec2>> facade_rings(std::vector<glm::dvec2> outline,
                                                                const std::vector<Opening>& openings);

// Things that stand at the origin on y = 0.
[[nodiscard]] scene::MeshId make_broadleaf(Library& library);
[[nodiscard]] scene::MeshId make_conifer(Library& library);
[[nodiscard]] scene::MeshId make_lamp(Library& library);
[[nodiscard]] scene::MeshId make_fence(Library& library, double length);  // x in [0, length]
[[nodiscard]] scene::MeshId make_hedge(Library& library, double length);
[[nodiscard]] scene::MeshId make_person(Library& library);
[[nodiscard]] scene::MeshId make_sign(Library& library);  // on a pole that someone has bent
[[nodiscard]] scene::MeshId make_bench(Library& library);
[[nodiscard]] scene::MeshId make_ladder(Library& library);                            // leans toward −z
[[nodiscard]] scene::MeshId make_poles(Library& library);                             // leaning poles and planks
[[nodiscard]] scene::MeshId make_cable(Library& library, double length, double sag);  // hangs from y = 0 along +x
[[nodiscard]] scene::MeshId make_scaffold(Library& library, double length, double height);
[[nodiscard]] scene::MeshId make_stall(Library& library);
[[nodiscard]] scene::MeshId make_fountain(Library& library);
[[nodiscard]] scene::MeshId make_shed(Library& library);
[[nodiscard]] scene::MeshId make_crane_tower(Library& library, double height);
[[nodiscard]] scene::MeshId make_crane_jib(Library& library, double length);  // at the tower's top, turns about y

// Drive toward +x.
struct Vehicle {
    scene::MeshId mesh = scene::kNone;
    scene::MeshId trailer = scene::kNone;  // or none; hinged at the vehicle's origin, its own frame `hitch` behind it
    double hitch = 0.0;
};
[[nodiscard]] std::vector<Vehicle> make_vehicles(Library& library);

// Carriageway with markings, x in [0, length], z in [−width/2, width/2]; with zebra crossings at both ends.
[[nodiscard]] scene::MeshId make_street(Library& library, double length, double width);

}  // namespace crofton::assets::town
