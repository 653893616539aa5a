// SPDX-License-Identifier: MIT
#include "manifold_list.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

namespace crofton::convex {
namespace {

constexpr double kSameNormalCosine = 0.99619469809174555;  // the cosine of 5 degrees
constexpr std::uint32_t kUnnumbered = ~std::uint32_t{0};

}  // namespace

void ManifoldList::clear() {
    parts_.clear();
    points_.clear();
}

void ManifoldList::rewind(const Mark& mark) {
    parts_.resize(mark.parts);
    points_.resize(mark.points);
}

void ManifoldList::add(const glm::dvec3& normal, std::span<const ContactPoint> points) {
    if (points.empty()) return;
    double depth = points[0].depth;
    for (const ContactPoint& p : points) depth = std::max(depth, p.depth);
    parts_.push_back(
        {normal, depth, static_cast<std::uint32_t>(points_.size()), static_cast<std::uint32_t>(points.size()), 0});
    points_.insert(points_.end(), points.begin(), points.end());
}

void ManifoldList::assign_manifolds() {
    normals_.clear();
    by_depth_.resize(parts_.size());
    std::iota(by_depth_.begin(), by_depth_.end(), 0u);
    std::sort(by_depth_.begin(), by_depth_.end(), [&](std::uint32_t i, std::uint32_t j) {
        return parts_[i].depth != parts_[j].depth ? parts_[i].depth > parts_[j].depth : i < j;
    });
    for (const std::uint32_t i : by_depth_) {
        Touching& part = parts_[i];
        double most = kSameNormalCosine;
        part.manifold = kUnnumbered;
        for (std::size_t k = 0; k < normals_.size(); ++k) {
            const double agreement = glm::dot(normals_[k], part.normal);
            if (agreement < most || (agreement == most && part.manifold != kUnnumbered)) continue;
            most = agreement;
            part.manifold = static_cast<std::uint32_t>(k);
        }
        if (part.manifold != kUnnumbered) continue;
        part.manifold = static_cast<std::uint32_t>(normals_.size());
        normals_.push_back(part.normal);
    }
}

// In the order in which their first parts came, which changes less from frame to frame than depths do.
void ManifoldList::number_by_first_part(std::size_t count) {
    number_.assign(count, kUnnumbered);
    std::uint32_t next = 0;
    for (Touching& part : parts_) {
        std::uint32_t& number = number_[part.manifold];
        if (number == kUnnumbered) number = next++;
        part.manifold = number;
    }
}

void ManifoldList::finish(int most, Vector<Manifold>& manifolds) {
    assign_manifolds();
    const std::size_t count = normals_.size();
    number_by_first_part(count);
    manifolds.resize(count);
    for (std::size_t k = 0; k < count; ++k) manifolds[number_[k]].normal = normals_[k];
    first_.assign(count + 1, 0);
    for (const Touching& part : parts_) first_[part.manifold + std::size_t{1}] += part.count;
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    sorted_.resize(points_.size());
    for (const Touching& part : parts_) {
        std::copy_n(points_.begin() + part.first, part.count, sorted_.begin() + first_[part.manifold]);
        first_[part.manifold] += part.count;
    }
    std::uint32_t begin = 0;
    for (std::size_t k = 0; k < count; ++k) {  // first_ is where each ends, by now
        thin_out(manifolds[k], sorted_.data() + begin, static_cast<int>(first_[k] - begin), most);
        begin = first_[k];
    }
}

}  // namespace crofton::convex
