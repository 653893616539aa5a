// SPDX-License-Identifier: MIT
// Is there a point where all of some linear inequalities in three unknowns hold? A linear programme in doubles guesses
// a proof. Numbers that cannot be wrong (tracked_numbers.hpp, or exact ones) check it. The proof is a vertex where all
// hold, or four inequalities of which a positive combination is 0 ≥ 1 (Farkas 1902). Four are enough by Helly's
// theorem.
#pragma once
#include <cmath>
#include <limits>
#include <optional>
#include <oracle/tracked_numbers.hpp>
#include <vector>

namespace crofton::oracle {

// normal · x + offset ≥ 0
template <class Number>
struct Row {
    Vec3<Number> normal;
    Number offset;
};

namespace detail {

// Seidel's incremental linear programme in at most three unknowns: which inequalities stop it, or hold its optimum.
// Nothing depends on its answer but how often a proof is found.
class Programme {
  public:
    struct Answer {
        bool feasible = true;
        int count = 0;
        std::array<int, 4> rows{};
        std::array<double, 3> at{};
    };
    struct Line {
        std::array<double, 3> normal;
        double offset;
        int row;  // -1: of the large cube that keeps all in reach
    };

    // Each inequality is loosened by `slack` of its size.
    template <class Number>
    static Answer solve(const std::vector<Row<Number>>& rows, double slack) {
        std::array<Line, kMost> lines;
        int count = 0;
        for (std::size_t i = 0; i < rows.size() && count < kMost; ++i) {
            Line line{{rows[i].normal[0].value(), rows[i].normal[1].value(), rows[i].normal[2].value()},
                      rows[i].offset.value(),
                      static_cast<int>(i)};
            double size = 0.0;
            for (const double n : line.normal) size = std::fmax(size, std::fabs(n));
            if (size > 0.0) {
                for (double& n : line.normal) n /= size;
                line.offset /= size;
            }
            line.offset += slack * (1.0 + std::fabs(line.offset));
            lines[std::size_t(count++)] = line;
        }
        return solve(3, lines.data(), count);
    }

  private:
    static constexpr int kMost = 24;
    static constexpr double kCube = 1e9;

    static Answer solve_line(const Line* lines, int count) {
        double low = -kCube, high = kCube;
        int of_low = -1, of_high = -1;
        for (int i = 0; i < count; ++i) {
            const double n = lines[i].normal[0], at = -lines[i].offset / n;
            if (std::fabs(n) < 1e-14) {
                if (lines[i].offset < -1e-14) return {false, 1, {lines[i].row}, {}};
            } else if (n > 0.0 && at > low) {
                low = at;
                of_low = lines[i].row;
            } else if (n < 0.0 && at < high) {
                high = at;
                of_high = lines[i].row;
            }
        }
        if (low > high) return {false, 2, {of_low, of_high}, {}};
        return {true, 1, {of_high}, {high}};
    }

    // The largest sum of the unknowns, roughly.
    static Answer solve(int unknowns, const Line* lines, int count) {
        if (unknowns == 1) return solve_line(lines, count);
        Answer best{true, unknowns, {-1, -1, -1}, {kCube, kCube, kCube}};
        std::array<Line, kMost> below;
        for (int i = 0; i < count; ++i) {
            double value = lines[i].offset;
            for (int k = 0; k < unknowns; ++k) value += lines[i].normal[std::size_t(k)] * best.at[std::size_t(k)];
            if (value >= 0.0) continue;
            // On this plane; the unknown with the largest slope is eliminated.
            int out = 0;
            for (int k = 1; k < unknowns; ++k)
                if (std::fabs(lines[i].normal[std::size_t(k)]) > std::fabs(lines[i].normal[std::size_t(out)])) out = k;
            const double pivot = lines[i].normal[std::size_t(out)];
            if (std::fabs(pivot) < 1e-14) return {false, 1, {lines[i].row}, {}};
            for (int j = 0; j < i; ++j) below[std::size_t(j)] = project(lines[j], lines[i], out, unknowns);
            const Answer rest = solve(unknowns - 1, below.data(), i);
            best = {rest.feasible, rest.count, rest.rows, {}};
            best.rows[std::size_t(best.count++)] = lines[i].row;
            if (!rest.feasible) return best;
            double eliminated = -lines[i].offset;
            for (int k = 0, from = 0; k < unknowns; ++k) {
                if (k == out) continue;
                best.at[std::size_t(k)] = rest.at[std::size_t(from++)];
                eliminated -= lines[i].normal[std::size_t(k)] * best.at[std::size_t(k)];
            }
            best.at[std::size_t(out)] = eliminated / pivot;
        }
        return best;
    }
    static Line project(const Line& line, const Line& plane, int out, int unknowns) {
        const double share = line.normal[std::size_t(out)] / plane.normal[std::size_t(out)];
        Line result{{}, line.offset - share * plane.offset, line.row};
        for (int k = 0, to = 0; k < unknowns; ++k)
            if (k != out)
                result.normal[std::size_t(to++)] = line.normal[std::size_t(k)] - share * plane.normal[std::size_t(k)];
        return result;
    }
};

template <class Number>
Number determinant(const Vec3<Number>& a, const Vec3<Number>& b, const Vec3<Number>& c) {
    return dot(cross(a, b), c);
}

// Whether the point where these three hold with equality is one, and lies where all others hold.
template <class Number>
bool proves_feasible(const std::vector<Row<Number>>& rows, const Programme::Answer& answer) {
    const auto index = [&](std::size_t k) { return std::size_t(answer.rows[k]); };
    const Row<Number>&a = rows[index(0)], &b = rows[index(1)], &c = rows[index(2)];
    const Vec3<Number> ab = cross(a.normal, b.normal), bc = cross(b.normal, c.normal), ca = cross(c.normal, a.normal);
    Number scale = dot(ab, c.normal);
    const int side = told(scale);
    if (side == 0 || side == kUnknown) return false;
    Vec3<Number> at;  // times scale, by Cramer's rule
    for (std::size_t k = 0; k < 3; ++k) {
        at[k] = -(a.offset * bc[k] + b.offset * ca[k] + c.offset * ab[k]);
        if (side < 0) at[k] = -at[k];
    }
    if (side < 0) scale = -scale;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i == index(0) || i == index(1) || i == index(2)) continue;
        const int s = told(Number(dot(rows[i].normal, at) + rows[i].offset * scale));
        if (s < 0 || s == kUnknown) return false;
    }
    return true;
}

// Whether weights of one sign make the four normals vanish and the offsets negative. The weights are determinants,
// with which that combination of any four vectors vanishes.
template <class Number>
bool proves_infeasible(const std::vector<Row<Number>>& rows, const std::array<int, 4>& four) {
    const auto row = [&](std::size_t k) -> const Row<Number>& { return rows[std::size_t(four[k])]; };
    Number sum(0.0);
    int side = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        Number weight = determinant(row((k + 1) % 4).normal, row((k + 2) % 4).normal, row((k + 3) % 4).normal);
        if (k % 2 == 1) weight = -weight;
        const int s = told(weight);
        if (s == kUnknown || s * side < 0) return false;
        if (s != 0) side = s;
        sum = sum + weight * row(k).offset;
    }
    const int s = told(sum);
    return s != kUnknown && side * s < 0;
}

// What this guess proves, if anything.
template <class Number>
std::optional<bool> proven(const std::vector<Row<Number>>& rows, const Programme::Answer& answer) {
    for (int k = 0; k < answer.count; ++k)
        if (answer.rows[std::size_t(k)] < 0) return std::nullopt;
    if (answer.feasible) {
        if (answer.count == 3 && proves_feasible(rows, answer)) return true;
        return std::nullopt;
    }
    // Fewer than four: with any others whose weights are then 0.
    std::array<int, 4> four = answer.rows;
    const int last = static_cast<int>(rows.size());
    const auto is_in = [&](int count, int row) {
        for (int k = 0; k < count; ++k)
            if (four[std::size_t(k)] == row) return true;
        return false;
    };
    if (answer.count == 4) return proves_infeasible(rows, four) ? std::optional(false) : std::nullopt;
    for (int i = 0; i < last; ++i) {
        if (is_in(answer.count, i)) continue;
        four[std::size_t(answer.count)] = i;
        if (answer.count == 3) {
            if (proves_infeasible(rows, four)) return false;
            continue;
        }
        if (answer.count != 2) return std::nullopt;
        for (int j = i + 1; j < last; ++j) {
            if (is_in(3, j)) continue;
            four[3] = j;
            if (proves_infeasible(rows, four)) return false;
        }
    }
    return std::nullopt;
}

}  // namespace detail

// How many systems were decided by a proof, and how many by elimination.
struct Feasibilities {
    std::uint64_t proven = 0, eliminated = 0;
};
inline Feasibilities feasibilities;

// rows.operator()<Number>(): the inequalities, by that kind of number; Exact is one that never rounds, whose sgn() is
// declared. Nothing if no proof is found.
template <class Exact, class Rows>
std::optional<bool> proven_feasible(const Rows& rows_of) {
    const auto rows = rows_of.template operator()<Tracked>();
    // As they are; then as if what touches met; then as if it did not.
    for (const double slack : {0.0, 1e-12, -1e-12}) {
        const auto guess = detail::Programme::solve(rows, slack);
        std::optional<bool> answer = detail::proven(rows, guess);
        if (!answer) answer = detail::proven(rows_of.template operator()<TrackedPair>(), guess);
        if (answer) return ++feasibilities.proven, answer;
    }
    for (const double slack : {1e-12, -1e-12})
        if (const auto answer =
                detail::proven(rows_of.template operator()<Exact>(), detail::Programme::solve(rows, slack)))
            return ++feasibilities.proven, answer;
    ++feasibilities.eliminated;
    return std::nullopt;
}

}  // namespace crofton::oracle
