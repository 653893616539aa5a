// SPDX-License-Identifier: MIT
#include "character.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace crofton::sample {

constexpr int kMostSlides = 4;  // walls that one move may slide along
constexpr int kMostPushes = 8;
constexpr glm::dvec3 kUp(0.0, 1.0, 0.0);

Character::Character(const glm::dvec3& position, const CharacterOptions& options)
    : options_(options),
      shape_(convex::Shape::capsule(options.half_height, options.radius).value()),
      position_(position) {}

double Character::feet() const {
    return position_.y - static_cast<double>(options_.half_height) - static_cast<double>(options_.radius);
}

// Pushes out of the deepest object first, as another push may be needless then.
void Character::come_out(const World& world) {
    for (int push = 0; push < kMostPushes; ++push) {
        const RigidTransform pose{glm::dmat3(1.0), position_};
        if (!world.contact_manifolds(shape_, pose, {}, touched_, {options_.layers})) return;
        const convex::Manifold* deepest = nullptr;
        for (const ObjectManifold& touched : touched_)
            if (deepest == nullptr || touched.manifold.depth > deepest->depth) deepest = &touched.manifold;
        if (deepest == nullptr) return;
        position_ -= (deepest->depth + options_.skin) * deepest->normal;
    }
}

// Moves along the way until something is `skin` away. So nothing is ever touched, and the next sweep starts free.
std::optional<Character::Hit> Character::sweep(const World& world, const glm::dvec3& way) {
    if (way == glm::dvec3(0.0)) return std::nullopt;
    const RigidTransform pose{glm::dmat3(1.0), position_};
    // The time is the share of the way.
    const double length = glm::length(way), duration = 1.0 + 4.0 * options_.skin / length;
    const convex::CastOptions cast_options{.duration = duration, .tolerance = 0.01 * options_.skin};
    const auto found = world.cast(shape_, pose, {.velocity = way}, cast_options, {options_.layers});
    if (!found) return Hit{0.0, glm::dvec3(0.0)};
    if (!*found) {
        position_ += way;
        return std::nullopt;
    }
    const glm::dvec3 away = -(*found)->normal;
    const double closing = -glm::dot(way, away);
    const double share = (*found)->time - (closing > 0.0 ? options_.skin / closing : duration);
    if (share >= 1.0) {
        position_ += way;
        return std::nullopt;
    }
    position_ += std::max(0.0, share) * way;
    return Hit{std::max(0.0, share), away};
}

// What is left of the way goes along what was hit. Returns what was not walked.
glm::dvec3 Character::slide(const World& world, glm::dvec3 way, bool walls_are_upright) {
    glm::dvec3 walls[kMostSlides];
    for (int count = 0; count < kMostSlides; ++count) {
        const auto hit = sweep(world, way);
        if (!hit) return glm::dvec3(0.0);
        way *= 1.0 - hit->share;
        glm::dvec3 wall = hit->normal;
        if (wall.y >= options_.least_up)
            on_ground_ = true;
        else if (walls_are_upright && wall.y > 0.0)
            wall = glm::normalize(wall * glm::dvec3(1, 0, 1));
        if (glm::dot(wall, wall) == 0.0) return way;
        walls[count] = wall;
        // Not into this wall, nor into those before: along the crease of two, and not at all into a corner of three.
        way -= std::min(0.0, glm::dot(way, wall)) * wall;
        for (int i = 0; i < count; ++i)
            if (glm::dot(way, walls[i]) < 0.0) {
                const glm::dvec3 crease = glm::cross(walls[i], wall);
                const double size = glm::dot(crease, crease);
                way = size > 1e-12 ? glm::dot(way, crease) / size * crease : glm::dvec3(0.0);
            }
    }
    return way;
}

// Where a wall was in the way: the same from a step higher, and down again, if that leads farther, and if there is
// ground a radius ahead. On the way up the capsule rests on the step's edge.
void Character::step(const World& world, const glm::dvec3& start, const glm::dvec3& across) {
    const glm::dvec3 flat = position_;
    const auto rise = [&] {
        position_ = start;
        sweep(world, options_.step_height * kUp);
        return -(position_.y - start.y + 2.0 * options_.skin) * kUp;
    };
    const glm::dvec3 down = rise();
    const double length = glm::length(across), ahead = std::max(length, static_cast<double>(options_.radius));
    sweep(world, ahead / length * across);
    const auto ground = sweep(world, down);
    if (ground && ground->normal.y >= options_.least_up) {
        rise();
        slide(world, across, true);
        sweep(world, down);
        const auto gone = [&](const glm::dvec3& to) { return glm::length((to - start) * glm::dvec3(1, 0, 1)); };
        if (gone(position_) > gone(flat) + 1e-6) {
            on_ground_ = true;
            return;
        }
    }
    position_ = flat;
}

void Character::move(const World& world, const glm::dvec3& way) {
    come_out(world);
    const glm::dvec3 across(way.x, 0.0, way.z), start = position_;
    const bool walked = on_ground_ && way.y <= 0.0;
    on_ground_ = false;
    slide(world, across, true);
    if (walked && glm::distance(position_, start + across) > 1e-6) step(world, start, across);
    // Down, or up; and down to the ground of a slope or a step that it has just walked off.
    const double down = walked ? std::min(way.y, -options_.step_height) : way.y;
    const glm::dvec3 before = position_;
    const auto hit = sweep(world, down * kUp);
    if (hit && hit->normal.y >= options_.least_up)
        on_ground_ = true;
    else if (walked && !hit)
        position_ = before + way.y * kUp;
}

}  // namespace crofton::sample
