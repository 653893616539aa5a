// SPDX-License-Identifier: MIT
// A character's capsule that walks through a World: it slides along walls, climbs steps, stands on slopes, and is
// pushed out of what moves into it.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <crofton/world/object_manifold.hpp>
#include <optional>

namespace crofton::sample {

struct CharacterOptions {
    float radius = 0.4f, half_height = 0.5f;  // of the capsule's segment; metres
    double step_height = 0.35;                // what it climbs without a jump
    double skin = 0.01;                       // kept between the capsule and all else
    double least_up = 0.7;                    // of a normal: steeper ground is a wall (0.7: 45 degrees)
    std::uint32_t layers = ~0u;               // what it meets: a contact filter
};

// y is up. `position` is the capsule's middle.
class Character {
  public:
    Character(const glm::dvec3& position, const CharacterOptions& options = {});

    // Comes out of what has moved into it since the last call. Then walks by `way`, whose y counts too (a jump, a
    // fall), as far as nothing is there. Never into anything.
    void move(const World& world, const glm::dvec3& way);

    [[nodiscard]] const glm::dvec3& position() const { return position_; }
    [[nodiscard]] double feet() const;  // the height of its lowest point
    [[nodiscard]] bool is_on_ground() const { return on_ground_; }

  private:
    struct Hit {
        double share;       // of the way that is free
        glm::dvec3 normal;  // away from what was hit
    };
    void come_out(const World& world);
    std::optional<Hit> sweep(const World& world, const glm::dvec3& way);
    glm::dvec3 slide(const World& world, glm::dvec3 way, bool walls_are_upright);
    void step(const World& world, const glm::dvec3& start, const glm::dvec3& across);

    CharacterOptions options_;
    convex::Shape shape_;
    glm::dvec3 position_;
    bool on_ground_ = false;
    Vector<ObjectManifold> touched_;
};

}  // namespace crofton::sample
