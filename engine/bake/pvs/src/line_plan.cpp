// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/pvs/line_plan.hpp>
#include <numbers>

#include "stratum_kernels.hpp"

namespace crofton::pvs {
namespace {

// Rounds double: after each the guarantee stands for half of the lines drawn so far at least.
constexpr double kFirstRound = 0x1p18;  // lines
constexpr int kMaxRounds = 8;

double surface(const Aabb& box) {
    const glm::dvec3 e = box.max - box.min;
    return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

std::uint64_t blocks_for(double lines) {
    return static_cast<std::uint64_t>(std::ceil(lines / static_cast<double>(LinePlan::kBlock)));
}

// Lines that enter a box through one face: a point (s, t) of the face. The direction's shadow on the face is a point of
// the unit disc with squared radius u and angle 2πv. Uniform in all four, the lines are uniform.
struct Stratum {
    std::array<double, 4> low{0.0, 0.0, 0.0, 0.0}, high{1.0, 1.0, 1.0, 1.0};

    [[nodiscard]] double length(std::size_t k) const { return high[k] - low[k]; }
};

// Halves the dimension that spreads lines most. `sides`: of the face; `length`: how far along a line its neighbours
// should be near.
class Division {
  public:
    Division(const std::array<double, 2>& sides, double length) : sides_(sides), length_(length) {}

    // Number i of n equal parts, and on to number i of n of that, and so on.
    void take(std::uint64_t i, std::uint64_t n, Stratum& part) const {
        while (n > 1) {
            const std::size_t k = widest(part);
            const std::uint64_t first = n / 2;
            const double at = part.low[k] + part.length(k) * (static_cast<double>(first) / static_cast<double>(n));
            if (i < first) {
                part.high[k] = at, n = first;
            } else {
                part.low[k] = at, i -= first, n -= first;
            }
        }
    }

  private:
    [[nodiscard]] std::size_t widest(const Stratum& part) const {
        const double r = std::sqrt(part.high[2]);
        const double widths[4] = {sides_[0] * part.length(0), sides_[1] * part.length(1),
                                  length_ * (r - std::sqrt(part.low[2])),
                                  length_ * r * 2.0 * std::numbers::pi * part.length(3)};
        std::size_t k = 0;
        for (std::size_t i = 1; i < 4; ++i)
            if (widths[i] > widths[k]) k = i;
        return k;
    }

    std::array<double, 2> sides_;
    double length_;
};

void plan_rounds(LinePlan& plan, const Aabb& box, double lines) {
    double left = std::ceil(lines);
    int rounds = 1;
    while (rounds < kMaxRounds && left * std::exp2(-rounds) >= kFirstRound) ++rounds;
    const glm::dvec3 e = box.max - box.min;
    const std::array<double, 3> areas = {e.y * e.z, e.z * e.x, e.x * e.y};
    for (int r = 0; r < rounds; ++r) {
        const double round = r + 1 == rounds ? left : std::floor(lines * std::exp2((std::max)(r, 1) - rounds));
        left -= round;
        plan.rounds.push_back(round);
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const double share = areas[static_cast<std::size_t>(axis)] / surface(box);
                const std::uint64_t blocks = blocks_for(round * share * (1.0 + 1e-12));
                plan.parts.push_back({plan.blocks, blocks, axis, side});
                plan.blocks += blocks;
            }
    }
}

}  // namespace

double epsilon_after(double lines, std::uint64_t pairs, double confidence) {
    return std::log(static_cast<double>(pairs) / (1.0 - confidence)) / lines;
}

Result<LinePlan> plan_lines(const Cells& cells, std::uint64_t pairs, const BakeOptions& options) {
    LinePlan plan;
    plan.seed = options.seed;
    plan.for_a_cell = std::ceil(epsilon_after(options.epsilon, pairs, options.confidence));
    double least = cells.surface(0);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        least = (std::min)(least, cells.surface(i));
        if (cells.is_convex()) plan.own_share = (std::min)(plan.own_share, cells.surface(i) / surface(cells.box(i)));
    }
    plan.least_share = least / surface(cells.bounds());
    const double whole = plan.for_a_cell / plan.least_share;
    plan.per_cell = (std::max)(std::uint64_t{1}, blocks_for(plan.for_a_cell / plan.own_share));
    const double each = static_cast<double>(cells.size() * LinePlan::kBlock) * static_cast<double>(plan.per_cell);
    if (!((std::min)(whole, each) <= 0x1p44))
        return fail(ErrorCode::out_of_range, kNoItem,
                    "pvs: this epsilon needs more than 2^44 lines: choose a larger one, or larger cells");
    plan.whole = whole <= each;
    if (plan.whole)
        plan_rounds(plan, cells.bounds(), whole);
    else
        plan.blocks = plan.per_cell * cells.size();
    return plan;
}

void LinePlan::draw(std::uint64_t block, const Cells& cells, const glm::dvec3& origin, Vector<Line>& lines) const {
    sampling::Random random(seed, block);
    lines.clear();
    if (!whole) {
        const Aabb body = cells.box(block / per_cell);
        const Aabb relative{body.min - origin, body.max - origin};
        for (std::uint64_t i = 0; i < kBlock; ++i)
            lines.push_back(sampling::line_from_box(relative, random.point<5>()));
        return;
    }
    const auto next = std::upper_bound(parts.begin(), parts.end(), block,
                                       [](std::uint64_t b, const Part& part) { return b < part.first; });
    const Part& part = *(next - 1);  // those without blocks begin where the next does, and come before it
    const int s = (part.axis + 1) % 3, t = (part.axis + 2) % 3;
    const glm::dvec3 e = cells.bounds().max - cells.bounds().min;
    const Division division({e[s], e[t]}, 2.0 * (std::min)({e.x, e.y, e.z}));
    Stratum of_block;
    division.take(block - part.first, part.blocks, of_block);
    const glm::dvec3 corner = cells.bounds().min - origin;
    kernels::LineStratum of_lines;
    of_lines.corner[0] = corner[s], of_lines.corner[1] = corner[t];
    of_lines.sides[0] = e[s], of_lines.sides[1] = e[t];
    of_lines.plane = (part.side < 0.0 ? cells.bounds().min : cells.bounds().max)[part.axis] - origin[part.axis];
    of_lines.inward = -part.side;
    of_lines.axis = static_cast<unsigned>(part.axis);
    static_assert(sizeof(Line) == 6 * sizeof(double) && kStratum == kernels::kStratumLines);
    lines.resize(kBlock);
    for (std::uint64_t i = 0; i < kBlock / kStratum; ++i) {
        Stratum stratum = of_block;
        division.take(i, kBlock / kStratum, stratum);
        for (std::size_t k = 0; k < 4; ++k) of_lines.low[k] = stratum.low[k], of_lines.length[k] = stratum.length(k);
        // 2^32 places along each side of a stratum.
        std::array<std::uint64_t, 2 * kStratum> bits;
        random.fill(bits);
        kernels::draw_stratum(of_lines, bits.data(), &lines[i * kStratum].point.x);
    }
}

}  // namespace crofton::pvs
