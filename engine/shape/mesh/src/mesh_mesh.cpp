// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include <crofton/geometry/closest_points.hpp>
#include "contact_segment.hpp"
#include "mesh_pair.hpp"
#include "pair_sort.hpp"
#include "posed_mesh.hpp"

namespace crofton::mesh {
namespace {

// A point carried to the other frame in float. Entries of the matrix, three products, three sums and the translation
// are each rounded by 2^-24. In all that is below 7.2e-7 of the mesh's extent and 2.4e-7 of the translation. The way
// back takes the transpose for the inverse, which is off by the rotation's own deviation.
float error_bound_of(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& pose) {
    double deviation = 0.0, shift = 0.0;
    for (int i = 0; i < 3; ++i) {
        shift = std::max(shift, std::abs(pose.translation[i]));
        for (int j = i; j < 3; ++j)
            deviation =
                std::max(deviation, std::abs(glm::dot(pose.rotation[i], pose.rotation[j]) - (i == j ? 1.0 : 0.0)));
    }
    const double size = static_cast<double>(a.extent()) + static_cast<double>(b.extent()) + shift;
    return static_cast<float>((1e-6 + 4.0 * deviation) * size);
}

MeshPair make_pair(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& pose,
                   double tolerance = 0.0) {
    CROFTON_ASSERT(validate(pose).has_value(), "the pose is to be checked by the caller");
    MeshPair pair{};
    const mesh::MeshTree* const trees[2] = {&a, &b};
    for (int side = 0; side < 2; ++side) {
        const MeshParts& parts = trees[side]->parts();
        pair.nodes[side] = parts.nodes.data();
        pair.leaves[side] = parts.leaves.data();
        pair.root[side] = &parts.root_box;
    }
    const glm::dvec3 back = -(glm::transpose(pose.rotation) * pose.translation);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            pair.exact_rotation[i][j] = pose.rotation[j][i];
            pair.to_a.column[j][i] = static_cast<float>(pose.rotation[j][i]);
            pair.to_b.column[j][i] = static_cast<float>(pose.rotation[i][j]);
        }
        pair.exact_translation[i] = pose.translation[i];
        pair.to_a.offset[i] = static_cast<float>(pose.translation[i]);
        pair.to_b.offset[i] = static_cast<float>(back[i]);
    }
    pair.error_bound = error_bound_of(a, b, pose);
    pair.tolerance = static_cast<float>(tolerance * (1.0 + 1e-6));
    return pair;
}

// A pair of triangles that meet.
struct Hit {
    const mesh::MeshLeaf &in_a, &in_b;
    std::uint32_t lane_a, lane_b;
    PairOfPlaces places;
    std::uint32_t edges;  // as PairVisitor's; 0: not known

    [[nodiscard]] TrianglePair indices() const { return {in_a.triangle[lane_a], in_b.triangle[lane_b]}; }
};

bool is_empty(const MeshTree& tree) {
    return tree.triangle_count() == 0;
}

// Runs the traversal; `found(Hit)` returns true to stop.
template <class Found>
void for_each_hit(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& pose, bool at_once,
                  MeshStatistics* statistics, Found found) {
    if (is_empty(a) || is_empty(b)) return;
    std::uint64_t exact_tests = 0;
    const auto visit = [&](LeafTriangle of_a, LeafTriangle of_b, std::uint32_t edges) {
        const Hit hit{
            a.parts().leaves[of_a.leaf], b.parts().leaves[of_b.leaf], of_a.lane, of_b.lane, {of_a, of_b}, edges};
        exact_tests += edges == 0;
        if (edges == 0 && !intersects(triangle_of(hit.in_a, hit.lane_a), triangle_of(hit.in_b, hit.lane_b, pose)))
            return false;
        return found(hit);
    };
    TraversalCounts counts;
    visit_overlaps(make_pair(a, b, pose), at_once, visit, counts);
    if (statistics == nullptr) return;
    statistics->box_tests += counts.box_tests;
    statistics->triangle_tests += counts.triangle_tests;
    statistics->exact_tests += exact_tests;
}

glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

}  // namespace

bool intersects(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                MeshStatistics* statistics, PairOfPlaces* where) {
    bool hit = false;
    for_each_hit(a, b, b_to_a, true, statistics, [&](const Hit& found) {
        if (where != nullptr) *where = found.places;
        return hit = true;
    });
    return hit;
}

void intersecting_triangles(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                            Vector<TrianglePair>& pairs, MeshStatistics* statistics) {
    pairs.clear();
    for_each_hit(a, b, b_to_a, false, statistics, [&](const Hit& hit) {
        pairs.push_back(hit.indices());
        return false;
    });
    sort_pairs(pairs);
}

void contacts(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
              Vector<MeshContact>& found, MeshStatistics* statistics) {
    found.clear();
    // A pose that mirrors turns b's triangles round; their outer sides stay the outer ones.
    const double side = glm::determinant(b_to_a.rotation) < 0.0 ? -1.0 : 1.0;
    for_each_hit(a, b, b_to_a, false, statistics, [&](const Hit& hit) {
        const Triangle first = triangle_of(hit.in_a, hit.lane_a), second = triangle_of(hit.in_b, hit.lane_b, b_to_a);
        const glm::dvec3 normals[2] = {scaled_normal(first), side * scaled_normal(second)};
        MeshContact contact{hit.indices(), contact_segment(first, second, hit.edges), unit(normals[1])};
        SegmentOfContact& segment = contact.segment;
        if (glm::dot(glm::cross(normals[0], normals[1]), segment.end - segment.begin) < 0.0)
            std::swap(segment.begin, segment.end);
        if (contact.normal == glm::dvec3(0.0)) contact.normal = unit(normals[0]);
        found.push_back(contact);
        return false;
    });
    sort_by_triangles(found);
}

namespace {

constexpr double kLeastSquaredDistance = 1e-300;

Nearest towards(const glm::dvec3& from, const glm::dvec3& to, double squared) {
    const glm::dvec3 way = to - from;
    const double length = glm::length(way);
    Nearest nearest{squared, {}};
    for (int i = 0; i < 3 && length > 1e-100; ++i) nearest.direction[i] = static_cast<float>(way[i] / length);
    return nearest;
}

glm::dvec3 center_of(const mesh::MeshBox& box) {
    return {static_cast<double>(box.center[0]), static_cast<double>(box.center[1]), static_cast<double>(box.center[2])};
}

}  // namespace

MeshDistance distance(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a, double limit,
                      MeshStatistics* statistics) {
    MeshDistance result;
    if (is_empty(a) || is_empty(b) || !(limit > 0.0)) return result;
    ClosestPoints best;
    best.squared = limit * limit;
    Nearest nearest =
        towards(center_of(a.parts().root_box), transform(b_to_a, center_of(b.parts().root_box)), best.squared);
    const auto visit = [&](LeafTriangle of_a, LeafTriangle of_b, std::uint32_t) {
        const mesh::MeshLeaf &in_a = a.parts().leaves[of_a.leaf], &in_b = b.parts().leaves[of_b.leaf];
        const Triangle first = triangle_of(in_a, of_a.lane), second = triangle_of(in_b, of_b.lane, b_to_a);
        const TrianglePair indices{in_a.triangle[of_a.lane], in_b.triangle[of_b.lane]};
        if (statistics != nullptr) ++statistics->exact_tests;
        if (intersects(first, second)) {
            const SegmentOfContact segment = contact_segment(first, second);
            result = {0.0, segment.begin, segment.begin, indices, {of_a, of_b}};
            return true;
        }
        const double before = best.squared;
        closest_of_triangles(first, second, best);
        best.squared = std::max(best.squared, kLeastSquaredDistance);  // they do not meet, though by less than rounding
        if (best.squared < before) {
            result = {std::sqrt(best.squared), best.on_a, best.on_b, indices, {of_a, of_b}};
            nearest = towards(best.on_a, best.on_b, best.squared);
        }
        return false;
    };
    TraversalCounts counts;
    visit_nearest(make_pair(a, b, b_to_a), nearest, visit, counts);
    if (statistics != nullptr) {
        statistics->box_tests += counts.box_tests;
        statistics->triangle_tests += counts.triangle_tests;
    }
    return result;
}

bool closer_than(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a, double tolerance,
                 MeshStatistics* statistics) {
    if (is_empty(a) || is_empty(b)) return false;
    bool close = false;
    const auto visit = [&](LeafTriangle of_a, LeafTriangle of_b, std::uint32_t) {
        const Triangle first = triangle_of(a.parts().leaves[of_a.leaf], of_a.lane),
                       second = triangle_of(b.parts().leaves[of_b.leaf], of_b.lane, b_to_a);
        if (statistics != nullptr) ++statistics->exact_tests;
        ClosestPoints best;
        close = intersects(first, second);
        if (!close) closest_of_triangles(first, second, best);
        close = close || best.squared < tolerance * tolerance;
        return close;
    };
    const MeshPair pair = make_pair(a, b, b_to_a, tolerance);
    const Nearest nearest =
        towards(center_of(a.parts().root_box), transform(b_to_a, center_of(b.parts().root_box)), tolerance * tolerance);
    TraversalCounts counts;
    visit_nearest(pair, nearest, visit, counts);
    if (statistics != nullptr) {
        statistics->box_tests += counts.box_tests;
        statistics->triangle_tests += counts.triangle_tests;
    }
    return close;
}

}  // namespace crofton::mesh
