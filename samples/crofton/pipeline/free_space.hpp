// SPDX-License-Identifier: MIT
// Where one could stand and walk in a scene that does not say so itself, found by lines.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/scene/scene.hpp>
#include <optional>
#include <span>
#include <vector>

namespace crofton::pipeline {

// An eye and where it looks, level.
struct Stand {
    glm::dvec3 eye{0.0}, forward{0.0, 0.0, -1.0};
    std::uint32_t objects = 0;  // that lines from the eye meet, in any direction
};

// Places of an eye over floors, with ways between neighbours. A floor faces up, with room above to stand. A way is free
// where lines at eye height, at each side and at half the height meet nothing. Of places that ways connect the most are
// kept, of two such regions the lower one. y is up. Lines are single precision: see lines::LineTracer.
class FreeSpace {
  public:
    // Vertical lines over `focus`, kColumns along its longer side. Nothing where no line meets a floor, and of
    // more than 2^23 triangles. The scene has been updated; all its instances are solid.
    [[nodiscard]] static std::optional<FreeSpace> find(const scene::Scene& scene, const Aabb& focus);
    static constexpr std::uint32_t kColumns = 128;

    [[nodiscard]] std::span<const glm::dvec3> places() const { return places_; }
    [[nodiscard]] double eye_height() const { return eye_height_; }  // of a place over its floor
    // A long way through them, as a polyline along free ways; empty for a single place.
    [[nodiscard]] std::vector<glm::dvec3> walk() const;
    // The place from which the most objects are seen, looking to where most are. Nothing where the scene does not
    // surround most places, or its floors are not level: it is a thing, better looked at from outside.
    [[nodiscard]] std::optional<Stand> best_stand() const;

  private:
    FreeSpace(pvs::Subject subject, lines::LineTracer tracer, const Aabb& focus);
    void find_places(const Aabb& focus);
    void keep_largest_region();
    [[nodiscard]] std::vector<std::uint32_t> neighbours_of(std::uint32_t place) const;
    // Steps from a place to each; the last of the list is a farthest one. ~0u: not reached.
    std::vector<std::uint32_t> steps_from(std::uint32_t place, std::vector<std::uint32_t>& order) const;
    [[nodiscard]] bool is_free(const glm::dvec3& from, const glm::dvec3& to) const;
    // Whether places of a way may be left out: the straight way is free and as high.
    [[nodiscard]] bool is_straight(std::span<const std::uint32_t> way) const;
    // What lines in all directions meet.
    struct Sight {
        std::vector<lines::Hit> hits;      // by direction
        double surrounded = 0.0, backs = 0.0;  // shares: of level lines that meet something, of lines that meet a back
        std::uint32_t objects = 0;
    };
    [[nodiscard]] Sight look_around(const glm::dvec3& eye) const;
    [[nodiscard]] glm::dvec3 best_heading(const Sight& sight) const;
    [[nodiscard]] double level_share() const;  // of ways that hardly rise or fall

    pvs::Subject subject_;
    lines::LineTracer tracer_;
    double eye_height_ = 0.0, spacing_ = 0.0, size_ = 0.0;
    glm::uvec2 columns_{0};
    std::vector<glm::dvec3> places_;              // ascending by column, then by height
    std::vector<std::uint32_t> column_of_;        // by place
    std::vector<std::uint32_t> first_of_column_;  // and the end
    std::vector<std::vector<std::uint32_t>> ways_;
};

}  // namespace crofton::pipeline
