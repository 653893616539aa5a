// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/study/bound_given_ancestors.hpp>
#include <glm/geometric.hpp>

#include "count_search.hpp"

namespace crofton::study {
namespace {

glm::mat3 turned(const glm::mat3& axes, int around, double angle) {
    const glm::dvec2 turn = cosine_sine(angle);
    const double c = turn.x, s = turn.y;
    const int i = (around + 1) % 3, j = (around + 2) % 3;
    glm::dmat3 result(axes);
    result[i] = c * glm::dvec3(axes[i]) + s * glm::dvec3(axes[j]);
    result[j] = -s * glm::dvec3(axes[i]) + c * glm::dvec3(axes[j]);
    // Orthonormal again: small turns add up.
    result[0] = glm::normalize(result[0]);
    result[1] = glm::normalize(result[1] - glm::dot(result[1], result[0]) * result[0]);
    result[2] = glm::cross(result[0], result[1]);
    return glm::mat3(result);
}

class Search {
  public:
    Search(std::span<const glm::dvec3> points, const study::QuerySample& queries, const measure::Criterion& criterion,
           Vector<std::uint32_t> candidates)
        : points_(points), queries_(queries), criterion_(criterion), candidates_(std::move(candidates)) {}

    // True where the box is the best so far: fewer hits, or as many and less by the criterion.
    bool consider(const Obb& box) {
        std::uint32_t hits = 0;
        for (const std::uint32_t q : candidates_) hits += queries_.hits(q, box);
        const double value = criterion_(measure::intrinsic_volumes_of_box(box));
        if (has_best_ && (hits > hits_ || (hits == hits_ && value >= value_))) return false;
        has_best_ = true;
        best_ = box, hits_ = hits, value_ = value;
        return true;
    }
    bool consider(const glm::mat3& axes) {
        const auto box = fit::fit_oriented(points_, axes);
        return box && consider(*box);
    }
    void descend() {
        for (double angle = 0.4; angle > 1e-3; angle *= 0.5)
            for (bool better = true; better;) {
                better = false;
                for (int around = 0; around < 3; ++around)
                    for (const double sign : {1.0, -1.0})
                        better = consider(turned(best_.axes, around, sign * angle)) || better;
            }
    }

    [[nodiscard]] const Obb& best() const { return best_; }
    [[nodiscard]] std::uint32_t hits() const { return hits_; }

  private:
    std::span<const glm::dvec3> points_;
    const study::QuerySample& queries_;
    const measure::Criterion& criterion_;
    Vector<std::uint32_t> candidates_;
    Obb best_;
    std::uint32_t hits_ = 0;
    double value_ = 0.0;
    bool has_best_ = false;
};

}  // namespace

Result<BoundGivenAncestors> bound_given_ancestors(std::span<const glm::dvec3> points, std::span<const Obb> ancestors,
                                                  const study::QuerySample& queries,
                                                  const measure::Criterion& criterion,
                                                  const BoundGivenAncestorsOptions& options) {
    if (auto valid = measure::validate(criterion); !valid) return valid.error();
    if (!(options.tolerance >= 0.0 && options.tolerance < 1.0))
        return fail(ErrorCode::invalid_argument, kNoItem, "bound given ancestors: `tolerance` must lie in [0, 1)");
    for (std::size_t i = 0; i < ancestors.size(); ++i)
        if (auto valid = validate(ancestors[i], i); !valid) return valid.error();
    const auto plain = fit::fit_obb(points, {.criterion = criterion});
    if (!plain) return plain.error();
    const auto hull = convex_hull(points);
    if (!hull) return hull.error();
    Vector<std::uint32_t> candidates = queries.all();
    for (const Obb& ancestor : ancestors) candidates = queries.hitting(candidates, ancestor);
    BoundGivenAncestors result;
    result.ancestor_hits = static_cast<std::uint32_t>(candidates.size());
    Search search(points, queries, criterion, candidates);
    search.consider(*plain);
    result.plain_hits = search.hits();
    for (const measure::Criterion& other : {measure::minimal_area(), measure::minimal_perimeter()})
        if (const auto box = fit::fit_obb(points, {.criterion = other})) search.consider(*box);
    for (const Obb& ancestor : ancestors) search.consider(ancestor.axes);
    search.consider(glm::mat3(1.0f));
    search.descend();
    const auto consider = [&](const glm::dmat3& axes) {
        search.consider(glm::mat3(axes));
        return search.hits();
    };
    const CountProof proof = prove_count(points, hull->triangles, queries, candidates, search.hits(), options.tolerance,
                                         options.max_cells, consider);
    result.lower_bound = proof.lower_bound;
    result.cells = proof.cells;
    result.bound = search.best();
    result.hits = search.hits();
    return result;
}

}  // namespace crofton::study
