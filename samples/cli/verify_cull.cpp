#include "verify_cull.hpp"

#include <array>
#include <cmath>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "verify_certificate.hpp"

namespace crofton::cli {
namespace {

constexpr std::size_t kBatch = 2048;  // boxes per view

class Straddlers {
  public:
    Straddlers(std::uint64_t seed, double offset) : random_(seed), offset_(offset) {}

    Camera camera() {
        Camera camera;
        camera.position =
            offset_ * glm::dvec3(1.0, -0.7, 0.3) + glm::dvec3(number(-5, 5), number(-5, 5), number(-5, 5));
        camera.forward = direction();
        camera.up = direction();
        camera.projection = number(0, 1) < 0.7 ? Projection::perspective : Projection::orthographic;
        camera.fov_y = number(0.2, 2.2);
        camera.height = number(1.0, 20.0);
        camera.aspect = number(0.5, 2.0);
        camera.near = number(0.05, 1.0);
        camera.far = camera.near + number(1.0, 30.0);
        return camera;
    }

    // A box that reaches 1 µm to 1 m across a point of the frustum's surface, inward or (one in two) short of it.
    Obb box(const Frustum& frustum, const std::array<glm::dvec3, 8>& corners) {
        Obb box;
        const glm::dvec3 axis = direction();
        const double half_angle = number(0.0, 3.1);
        box.axes = glm::mat3(glm::mat3_cast(glm::dquat(std::cos(half_angle), std::sin(half_angle) * axis)));
        for (int k = 0; k < 3; ++k) box.half_extents[k] = static_cast<float>(std::exp(number(-4.0, 2.0)));
        glm::dvec3 target(0.0), middle(0.0);
        const auto corner = static_cast<unsigned>(number(0, 8)), bit = static_cast<unsigned>(number(0, 3));
        target = glm::mix(corners[corner], corners[corner ^ (1u << bit)], number(0, 1) < 0.3 ? 0.0 : number(0, 1));
        if (number(0, 1) < 0.5) target = glm::mix(target, corners[corner ^ (1u << ((bit + 1) % 3))], number(0, 1));
        for (const glm::dvec3& c : corners) middle += 0.125 * c;
        const glm::dvec3 outward = glm::normalize(glm::normalize(target - middle) + number(0.0, 1.0) * direction());
        box.center = frustum.origin + target;
        const int free = number(0, 1) < 0.5 ? static_cast<int>(number(0, 3)) : 3;
        for (int k = 0; k < 3; ++k) {
            const double t = k == free ? number(-1, 1) : glm::dot(outward, glm::dvec3(box.axes[k])) > 0.0 ? -1.0 : 1.0;
            box.center -= t * double{box.half_extents[k]} * glm::dvec3(box.axes[k]);
        }
        const double depth = std::exp(number(std::log(1e-6), 0.0));
        box.center += (number(0, 1) < 0.5 ? depth : -depth) * outward;
        return box;
    }

  private:
    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 v(number(-1, 1), number(-1, 1), number(-1, 1));
            if (const double length = glm::length(v); length > 0.1 && length < 1.0) return v / length;
        }
    }
    std::mt19937_64 random_;
    double offset_;
};

struct Counts {
    std::uint64_t meeting = 0, disjoint = 0, unproved = 0, false_culls = 0, false_accepts = 0,
                  false_culls_conservative = 0, disagreements = 0;
};

// One view, many boxes: the flat vector path, the tree and the single test must agree, and the proofs judge them.
void run_batch(Straddlers& straddlers, std::size_t count, Counts& counts) {
    const auto frustum = frustum_of(straddlers.camera());
    const auto corners = frustum_corners(*frustum);
    std::vector<Obb> boxes(count);
    for (Obb& box : boxes) box = straddlers.box(*frustum, *corners);
    const cull::View view{*frustum};
    cull::BoxSet set;
    set.assign(boxes);
    cull::VerdictBits exact, conservative;
    cull::cull(set, boxes, view, exact);
    cull::cull(set, boxes, view, conservative, cull::Mode::conservative);
    const auto tree = tree::BoxTree::build(boxes);
    cull::VisibleSet from_tree;
    cull::cull(*tree, view, from_tree);
    std::vector<cull::Verdict> tree_verdicts(count, cull::Verdict::outside);
    for (std::size_t n = 0; n < from_tree.size(); ++n) tree_verdicts[from_tree.ids()[n]] = from_tree.verdicts()[n];
    for (std::size_t i = 0; i < count; ++i) {
        const cull::Verdict verdict = cull::classify(*frustum, boxes[i]);
        if (verdict != exact.verdict(i) || verdict != tree_verdicts[i] ||
            cull::classify(*frustum, boxes[i], cull::Mode::conservative) != conservative.verdict(i))
            ++counts.disagreements;
        switch (prove(*frustum, boxes[i])) {
            case Proof::meets:
                ++counts.meeting;
                counts.false_culls += verdict == cull::Verdict::outside;
                counts.false_culls_conservative += conservative.verdict(i) == cull::Verdict::outside;
                break;
            case Proof::disjoint:
                ++counts.disjoint;
                counts.false_accepts += verdict != cull::Verdict::outside;
                break;
            default:
                ++counts.unproved;
                break;
        }
    }
}

}  // namespace

std::vector<VerifyRow> verify_cull(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const double offset : {0.0, 1e4, 1e5, 1e6, 1e7}) {
        Straddlers straddlers(options.seed, offset);
        Counts counts;
        for (std::uint64_t done = 0; done < options.trials; done += kBatch)
            run_batch(straddlers, static_cast<std::size_t>(std::min<std::uint64_t>(kBatch, options.trials - done)),
                      counts);
        char where[64];
        std::snprintf(where, sizeof where, "at camera offset %g, 1 um to 1 m deep", offset);
        const auto none = [&](const std::string& what, std::uint64_t measured) {
            rows.push_back(
                computed_row(what + " " + where, "docs/cull.md", 0.0, static_cast<double>(measured), 0.0));
        };
        none("of " + std::to_string(counts.meeting) + " boxes proved visible none is culled,", counts.false_culls);
        none("of the same none is culled in the conservative mode,", counts.false_culls_conservative);
        none("of " + std::to_string(counts.disjoint) + " boxes proved invisible none is accepted in the exact mode,",
             counts.false_accepts);
        none("vectors, tree and single test give equal verdicts", counts.disagreements);
        none("every box is proved visible or invisible", counts.unproved);
    }
    return rows;
}

}  // namespace crofton::cli
