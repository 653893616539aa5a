// SPDX-License-Identifier: MIT
// Where shapes touch, found anew only when they have moved.
#pragma once
#include <span>
#include <vector>

#include "instance_shapes.hpp"

namespace crofton::viewer {

class FoundContacts {
  public:
    // Finds contacts among pairs whose boxes overlap, in this frame of the scene's motion. Computes only what is shown.
    void update(InstanceShapes& shapes, std::uint32_t scene_frame, std::span<const InstancePair> pairs, bool triangles,
                bool hulls);
    [[nodiscard]] std::span<const TriangleContacts> triangles() const { return triangles_.found; }
    [[nodiscard]] std::span<const HullContacts> hulls() const { return hulls_.found; }

  private:
    template <class Contacts>
    struct Found {
        std::vector<Contacts> found;
        std::vector<InstancePair> pairs;
        std::uint32_t scene_frame = ~0u;
        // True where what is found is of another moment.
        [[nodiscard]] bool is_old(bool wanted, std::uint32_t frame, std::span<const InstancePair> now);
    };
    Found<TriangleContacts> triangles_;
    Found<HullContacts> hulls_;
};

}  // namespace crofton::viewer
