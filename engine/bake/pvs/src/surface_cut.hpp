// SPDX-License-Identifier: MIT
// Does the surface of a scene cut a shaft in two, so that nothing is seen through it?
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/occlude/occluder.hpp>
#include <cstdint>

#include "shaft.hpp"
#include "surface.hpp"

namespace crofton::pvs {

struct CutOptions {
    occlude::Sides sides = occlude::Sides::both;
    double near_radius = 0.0;  // faces that are not farther from the eyes block nothing
    double gap = 0.0;          // nearer than this is touching: above all rounding
    std::uint32_t steps = 0;   // sides of faces that one question may visit
};

// One thread's memory for such questions.
//
// C, O: convex hulls of eyes and of an object; H: that of both. Faces near C or O are left out. The cut begins with
// the side of a face that looks to C. It goes on over each edge in H to the side that is next around the edge, until no
// more are new. X is the chain of faces with one side among them. Around an edge sides are next to each other in pairs,
// so X has no boundary in H. So the sum of signs of the crossings is the same for all segments from C to O. If it is
// not 0 for one, each meets X. docs/notes/pvs.md has the proof.
class SurfaceCut {
  public:
    SurfaceCut(const Surface& surface, const CutOptions& options);

    enum class Answer : std::uint8_t {
        cut,     // all segments from one hull to the other meet the surface, from fronts with Sides::front
        partly,  // one from the middle to the middle does
        open,    // it does not: no halving can help
    };
    [[nodiscard]] Answer ask(const Corners& eyes, const Corners& object);

  private:
    enum class Seen : std::uint8_t { front, back };
    struct Crossing {
        double t = 0.0;
        std::uint32_t face = 0;
        Seen near_side = Seen::front;
    };
    struct SideOf {
        std::uint32_t face = 0;
        Seen side = Seen::front;
    };

    // The sum of signs is surely 0: both sides of all faces that were crossed are visited.
    [[nodiscard]] bool is_lost() const;
    bool find_crossings(const glm::dvec3& p, const glm::dvec3& q);  // false: through an edge or a corner
    bool cuts_from(std::uint32_t face, Seen side);
    void visit(std::uint32_t face, Seen side);
    void pass_edges(std::uint32_t face, Seen side);
    [[nodiscard]] int sum_of_signs() const;
    [[nodiscard]] bool is_left_out(std::uint32_t face);
    [[nodiscard]] bool is_in_shaft(std::uint32_t edge);
    void support_hull();
    [[nodiscard]] bool was_visited(std::uint32_t face, Seen side) const {
        return visited_[2 * face + static_cast<std::size_t>(side)] == flood_;
    }

    const Surface& surface_;
    CutOptions options_;
    std::array<glm::dvec3, 16> hull_{};  // eyes, object
    Aabb eyes_bounds_, object_bounds_, hull_bounds_;
    struct Support {
        glm::dvec3 normal{0.0};  // outward
        double most = 0.0;       // of the hull along it
    };
    std::array<Support, 12> supports_{};  // along its length, as of two boxes
    glm::dvec3 eyes_axis_{0.0}, object_axis_{0.0}, hull_axis_{0.0};
    std::uint64_t question_ = 0, flood_ = 0;
    std::uint32_t steps_ = 0;
    Vector<std::uint64_t> left_out_, in_shaft_;  // by face, by edge: 2 · question + answer
    Vector<std::uint64_t> visited_;              // by side: the flood
    Vector<Crossing> crossings_;
    Vector<SideOf> open_;
    Vector<std::uint32_t> stack_;
};

}  // namespace crofton::pvs
