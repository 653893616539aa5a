// SPDX-License-Identifier: MIT
// Where one could stand and walk in a scene that does not say so itself, found by lines.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/pvs/pvs.hpp>
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

struct FreeSpaceOptions {
    // Metres that a length of 1 is. 0: unknown; then lengths are metres where the scene's rooms and houses are as high
    // as a person's, else what makes them so.
    double unit = 0.0;
    Aabb within = {};  // where eyes may be; empty: anywhere
};

// Places of an eye over floors, with ways between neighbours. Eyes are kPersonEye metres above the floor. Where no
// person fits in, they are at such a share of the rooms' height as a person's, or, in the open, at a share of the
// scene's size. A floor is what a vertical line meets with room above it to stand. A way follows the floor, and is
// free where lines at eye height, at each side and at half the height meet nothing. y is up. Lines are single
// precision: see lines::LineTracer.
//
// Keeps the connected places that are worth the most. Places under a roof are worth the most, then
// those under the sky. Closed things whose faces look outward only have an inside as well, which is worth less, and
// their bare roofs are worth the least.
class FreeSpace {
  public:
    static constexpr double kPersonEye = 1.7;

    // Vertical lines over `focus`, kColumns to kMostColumns along its longer side. Nothing where no line meets a floor,
    // and of more than 2^23 triangles. The scene has been updated; all its instances are solid.
    [[nodiscard]] static std::optional<FreeSpace> find(const scene::Scene& scene, const Aabb& focus,
                                                       const FreeSpaceOptions& options = {});
    static constexpr std::uint32_t kColumns = 128, kMostColumns = 256;

    [[nodiscard]] std::span<const glm::dvec3> places() const { return places_; }
    [[nodiscard]] double eye_height() const { return eye_height_; }  // of a place over its floor
    // Returns the height of the rooms that the eye's height is a share of; 0 if it is no share.
    [[nodiscard]] double room_height() const { return room_height_; }
    [[nodiscard]] double spacing() const { return spacing_; }  // of neighbouring places
    // Metres that a length of 1 is, by the options or as guessed; 0: no person fits in.
    [[nodiscard]] double unit() const { return unit_; }
    // A long way through them, as a polyline along free ways; the place alone where there is but one.
    [[nodiscard]] std::vector<glm::dvec3> walk() const;
    // The eye moved up or down to eye height above what is below it, but not through what is above.
    [[nodiscard]] glm::dvec3 over_floor(const glm::dvec3& eye) const;
    // The place from which the most objects are seen, looking to where most are. Nothing where the scene does not
    // surround most places, or its floors are not level: it is a thing, better looked at from outside.
    [[nodiscard]] std::optional<Stand> best_stand() const;

  private:
    FreeSpace(pvs::BakeGeometry geometry, lines::LineTracer tracer, const Aabb& focus);
    // Places for this height; false where there are none, or they are of no use.
    bool find_places(const Aabb& focus, const FreeSpaceOptions& options, double eye_height);
    // The same for a person's, if a length of 1 is so many metres.
    bool find_places_of_a_person(const Aabb& focus, const FreeSpaceOptions& options, double unit);
    struct Column;
    void add_places(const Column& column, const Aabb& focus, const FreeSpaceOptions& options);
    void connect_places();
    void find_edges_of_roofs();
    void keep_best_region();
    [[nodiscard]] bool is_indoors() const;     // most places are under a roof
    [[nodiscard]] double median_room() const;  // half of the rooms are lower; 0 without any
    [[nodiscard]] bool fits_a_person(const Aabb& focus, const FreeSpaceOptions& options) const;
    [[nodiscard]] double surrounded_share(const glm::dvec3& eye) const;  // of a few level lines
    [[nodiscard]] std::vector<std::uint32_t> neighbours_of(std::uint32_t place) const;
    // Steps from a place to each; the last of the list is a farthest one. ~0u: not reached.
    std::vector<std::uint32_t> steps_from(std::uint32_t place, std::vector<std::uint32_t>& order) const;
    [[nodiscard]] bool is_free(const glm::dvec3& from, const glm::dvec3& to) const;
    // Whether one gets from a place to its neighbour; appends what lies between them, over the floor.
    bool follow_floor(const glm::dvec3& from, const glm::dvec3& to, std::vector<glm::dvec3>& between) const;
    // Along a direction, to the first thing; infinite where there is none.
    [[nodiscard]] double distance_to_thing(const glm::dvec3& eye, const glm::dvec3& direction) const;
    // Whether places of a way may be left out: the straight way is free and as high.
    [[nodiscard]] bool is_straight(std::span<const std::uint32_t> way) const;
    // The hits of lines in all directions.
    struct Sight {
        std::vector<lines::Hit> hits;          // by direction
        double surrounded = 0.0, backs = 0.0;  // shares: of level lines that meet something, of lines that meet a back
        std::uint32_t objects = 0;
    };
    [[nodiscard]] Sight look_around(const glm::dvec3& eye) const;
    [[nodiscard]] glm::dvec3 best_heading(const Sight& sight) const;
    [[nodiscard]] double level_share() const;  // of ways that hardly rise or fall

    pvs::BakeGeometry geometry_;
    lines::LineTracer tracer_;
    double house_height_ = 0.0;  // as median_room(), of all places that were found
    double unit_ = 0.0, eye_height_ = 0.0, room_height_ = 0.0, spacing_ = 0.0, size_ = 0.0;
    glm::uvec2 columns_{0};
    std::vector<glm::dvec3> places_;              // ascending by column, then by height
    std::vector<float> worth_;                    // by place
    std::vector<float> room_;                     // by place, above its floor; infinite under the sky
    std::vector<std::uint32_t> column_of_;        // by place
    std::vector<std::uint32_t> first_of_column_;  // and the end
    std::vector<std::vector<std::uint32_t>> ways_;
};

}  // namespace crofton::pipeline
