// SPDX-License-Identifier: MIT
#include "line_plan.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::pvs {
namespace {

double surface(const Aabb& box) {
    const glm::dvec3 e = box.max - box.min;
    return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

std::uint64_t blocks_for(double lines) {
    return static_cast<std::uint64_t>(std::ceil(lines / static_cast<double>(LinePlan::kBlock)));
}

}  // namespace

double epsilon_after(double lines, std::uint64_t pairs, double confidence) {
    return std::log(static_cast<double>(pairs) / (1.0 - confidence)) / lines;
}

Result<LinePlan> plan_lines(const Cells& cells, std::uint64_t pairs, const BakeOptions& options) {
    LinePlan plan;
    plan.seed = options.seed;
    plan.for_a_cell = std::ceil(epsilon_after(options.epsilon, pairs, options.confidence));
    double least = surface(cells.box(0));
    for (std::size_t i = 1; i < cells.size(); ++i) least = (std::min)(least, surface(cells.box(i)));
    plan.least_share = least / surface(cells.bounds());
    const double whole = plan.for_a_cell / plan.least_share;
    plan.per_cell = (std::max)(std::uint64_t{1}, blocks_for(plan.for_a_cell));
    const double each = static_cast<double>(cells.size() * LinePlan::kBlock) * static_cast<double>(plan.per_cell);
    if (!((std::min)(whole, each) <= 0x1p44))
        return fail(ErrorCode::out_of_range, kNoItem,
                    "pvs: this epsilon needs more than 2^44 lines: ask for a larger one, or for larger cells");
    plan.whole = whole <= each;
    plan.blocks = plan.whole ? (std::max)(std::uint64_t{1}, blocks_for(whole)) : plan.per_cell * cells.size();
    return plan;
}

void LinePlan::draw(std::uint64_t block, const Cells& cells, const glm::dvec3& origin, Vector<Line>& lines) const {
    const Aabb body = whole ? cells.bounds() : cells.box(block / per_cell);
    const Aabb relative{body.min - origin, body.max - origin};
    sampling::Random random(seed, block);
    lines.clear();
    for (std::uint64_t i = 0; i < kBlock; ++i) lines.push_back(sampling::line_from_box(relative, random.point<5>()));
}

}  // namespace crofton::pvs
