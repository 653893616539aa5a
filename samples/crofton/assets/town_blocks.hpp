// SPDX-License-Identifier: MIT
// Buildings and gardens in the blocks between the streets.
#pragma once
#include <map>
#include <utility>
#include <vector>

#include "assets/town_library.hpp"
#include "assets/town_traffic.hpp"

namespace crofton::assets::town {

inline constexpr double kCarriageway = 7.6;
inline constexpr double kSidewalk = 2.2;
inline constexpr double kKerb = 0.12;                              // height of blocks above streets
inline constexpr double kStreet = kCarriageway + 2.0 * kSidewalk;  // from house to house

// Inside of the sidewalks, in the town's frame.
struct Block {
    double x0 = 0.0, x1 = 0.0, z0 = 0.0, z1 = 0.0;

    [[nodiscard]] double width() const { return x1 - x0; }
    [[nodiscard]] double depth() const { return z1 - z0; }
    [[nodiscard]] glm::dvec3 center() const { return {0.5 * (x0 + x1), kKerb, 0.5 * (z0 + z1)}; }
};

// Puts things of a library into a scene under one root.
class Builder {
  public:
    Builder(scene::Scene& scene, Library& library, scene::NodeId root);

    void add_terraces(const Block& block);
    void add_park(const Block& block);
    void add_building_site(const Block& block);
    void add_market(const Block& block);
    void add_street_furniture(const Block& block);  // lamps, trees, cables along its sidewalks
    void add_streets(const Grid& grid);
    void add_countryside(const Grid& grid);

    // A node of the root with an instance of each part; kNone after the first error, which status() holds.
    scene::NodeId place(const Parts& parts, const Transform& transform, scene::NodeId parent = scene::kNone);
    scene::NodeId place(scene::MeshId mesh, double x, double z, double turn, double scale = 1.0);
    [[nodiscard]] const Result<void>& status() const { return status_; }
    [[nodiscard]] const std::vector<scene::NodeId>& jibs() const { return jibs_; }

  private:
    struct Ground {
        scene::MeshId paving, lawn, setts, gravel, kerb;
    };
    const Ground& ground(const Block& block, bool courtyard);
    void add_row(double length, const Transform& frame);
    void place_tree(double x, double z, double least_scale, double most_scale);
    scene::MeshId any(const std::vector<scene::MeshId>& list);

    scene::Scene& scene_;
    Library& library_;
    scene::NodeId root_;
    Result<void> status_;
    std::map<int, std::vector<Parts>> houses_;  // by width
    std::vector<scene::MeshId> trees_, conifers_, fences_, hedges_, stalls_, sheds_, poles_, people_, signs_;
    scene::MeshId lamp_, bench_, ladder_, cable_, scaffold_, fountain_, tower_, jib_;
    Parts church_;
    std::map<std::pair<int, int>, Ground> grounds_;  // by size in decimetres, negative with courtyard
    std::vector<scene::NodeId> jibs_;
};

}  // namespace crofton::assets::town
