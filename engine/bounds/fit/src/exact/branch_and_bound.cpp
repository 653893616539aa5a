// SPDX-License-Identifier: MIT
#include "exact/branch_and_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "exact/cell_kernels.hpp"
#include "search/polish.hpp"
#include "search/root_cell.hpp"

namespace crofton::fit {
namespace {

using kernels::kBatch;

// The host is asked after so many points of cells: some 0.1 ms.
constexpr std::size_t kWorkBetween = 8192;

struct Cell {
    glm::dvec3 center, half, spread;
    double bound;
    std::size_t begin;  // of its lists in the arena: for each side all x, then all y, then all z
    std::array<std::uint32_t, 6> count;
    std::size_t known;  // size of the subset when the lists were made
};

glm::dmat3 rotation(const glm::dvec3& c) {
    const double x = c.x, y = c.y, z = c.z, s = 1.0 / (1.0 + x * x + y * y + z * z);
    return glm::dmat3(glm::dvec3(1.0 + x * x - y * y - z * z, 2.0 * (x * y + z), 2.0 * (z * x - y)) * s,
                      glm::dvec3(2.0 * (x * y - z), 1.0 + y * y - x * x - z * z, 2.0 * (y * z + x)) * s,
                      glm::dvec3(2.0 * (z * x + y), 2.0 * (y * z - x), 1.0 + z * z - x * x - y * y) * s);
}

class Search {
  public:
    Search(PointCloud& cloud, const Weights& weights, std::span<const glm::dvec3> subset, const glm::dmat3& start,
           const SearchLimits& limits, SearchBuffers& buffers)
        : cloud_(cloud), weights_(weights), limits_(limits), buffers_(buffers), root_(start) {
        for (const glm::dvec3& p : subset) add(p);
    }

    SearchResult run() {
        result_.best.value = std::numeric_limits<double>::infinity();
        search_from(root_);
        Cell root{glm::dvec3(0.0), glm::dvec3(kRootCellHalfSize), glm::dvec3(1.0), 0.0, 0, {}, 0};
        cells_.push_back(root);
        while (!cells_.empty()) {
            const Cell cell = cells_.back();
            cells_.pop_back();
            load_lists(cell);
            if (cell.bound >= target()) continue;
            if (result_.cells >= limits_.cells || is_stopped(cell.bound)) {
                cells_.push_back(cell);
                break;
            }
            split(cell);
        }
        result_.complete = cells_.empty();
        result_.lower_bound = target();
        for (const Cell& cell : cells_) result_.lower_bound = std::min(result_.lower_bound, cell.bound);
        result_.subset = subset_.size();
        return result_;
    }

  private:
    [[nodiscard]] double target() const { return target_; }

    void set_best(const glm::dmat3& axes, double value, const glm::dvec3& w) {
        result_.best = {axes, value};
        // Widths below 1e-13 of the size are rounding of the coordinates: no cell's bound comes nearer to the value
        // than what they may change. The proof leaves that out, but for what half the gap has room for.
        const double slopes = weights_.product * (w.x * w.y + w.y * w.z + w.z * w.x) +
                              2.0 * weights_.pairs * (w.x + w.y + w.z) + 3.0 * weights_.sum;
        double left_out = 1e-13 * slopes;
        if (left_out > 1e-12 * value) left_out = std::max(0.0, left_out - 0.5 * limits_.gap * value);
        // It never rises, since cells were left out for what it was.
        target_ = std::min(target_, std::max(0.0, value * (1.0 - limits_.gap) - left_out));
    }

    // Asks the host now and then. `bound` is that of the cell which is about to be split.
    bool is_stopped(double bound) {
        if (limits_.should_stop == nullptr) return false;
        work_ += 64;
        for (const std::size_t count : count_) work_ += count;
        if (work_ < kWorkBetween) return false;
        work_ = 0;
        bound = std::min(bound, target());
        for (const Cell& cell : cells_) bound = std::min(bound, cell.bound);
        return (*limits_.should_stop)(result_.best.value, bound, result_.cells);
    }

    // Adds a point to the subset and, in the root frame's coordinates, to the current lists.
    void add(const glm::dvec3& p) {
        subset_.push_back(p);
        append(glm::transpose(root_) * p);
        local_.push_back(glm::transpose(root_) * p);
    }

    void append(const glm::dvec3& local) {
        for (std::size_t side = 0; side < 6; ++side)
            for (std::size_t k = 0; k < 3; ++k) {
                Vector<double>& list = lists_[side][k];
                if (list.size() < count_[side] + 17) list.resize(2 * count_[side] + 32);
                list[count_[side]] = local[static_cast<int>(k)];
            }
        for (std::size_t side = 0; side < 6; ++side) ++count_[side];
    }

    // Makes the last cell's lists the current ones. The arena is a stack like cells_: they lie at its end.
    void load_lists(const Cell& cell) {
        const double* from = arena_.data() + cell.begin;
        for (std::size_t side = 0; side < 6; ++side) {
            const std::size_t count = cell.count[side];
            for (Vector<double>& list : lists_[side]) {
                if (list.size() < count + 16) list.resize(2 * count + 32);
                std::copy_n(from, count, list.begin());
                from += count;
            }
            count_[side] = count;
        }
        arena_.resize(cell.begin);
        for (std::size_t i = cell.known; i < local_.size(); ++i) append(local_[i]);
    }

    [[nodiscard]] kernels::SideLists side_lists() const {
        kernels::SideLists lists;
        for (std::size_t side = 0; side < 6; ++side) {
            lists.x[side] = lists_[side][0].data();
            lists.y[side] = lists_[side][1].data();
            lists.z[side] = lists_[side][2].data();
            lists.count[side] = count_[side];
        }
        return lists;
    }

    // Improves a frame (in the cloud's coordinates) on the subset and evaluates the result on the cloud. This is
    // repeated while the cloud's value is higher, which adds points to the subset.
    void search_from(const glm::dmat3& axes) {
        Candidate candidate{axes, 0.0};
        for (int round = 0; round < 8; ++round) {
            descend(weights_, subset_, candidate, buffers_);
            polish(weights_, subset_, candidate, buffers_);
            if (evaluate_on_cloud(candidate.axes) <= candidate.value * (1.0 + 1e-12)) break;
        }
    }

    // The frame's value for the whole cloud; the best is updated. Support points that the subset lacks join it.
    double evaluate_on_cloud(const glm::dmat3& axes) {
        const Supports supports = cloud_.supports(axes);
        const glm::dvec3 extent = widths(supports, axes);
        const double value = weights_(extent.x, extent.y, extent.z);
        for (std::size_t side = 0; side < 6; ++side) {
            const int k = static_cast<int>(side / 2);
            const double sign = side % 2 == 0 ? 1.0 : -1.0, height = sign * glm::dot(supports[side], axes[k]);
            bool known = false;
            for (const glm::dvec3& p : subset_) known = known || sign * glm::dot(p, axes[k]) >= height - 1e-14;
            if (!known) add(supports[side]);
        }
        if (value < result_.best.value) set_best(axes, value, extent);
        return value;
    }

    void split(const Cell& cell) {
        // Eight equal parts, by three halvings, each along the coordinate that changes the value most.
        std::array<int, 3> parts = {1, 1, 1};
        glm::dvec3 half = cell.half;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 change = half * cell.spread;
            const int k = change.x >= change.y ? (change.x >= change.z ? 0 : 2) : (change.y >= change.z ? 1 : 2);
            parts[static_cast<std::size_t>(k)] *= 2;
            half[k] *= 0.5;
        }
        batch_.half = half;
        for (int i = 0; i < 8; ++i) {
            const glm::ivec3 at(i % parts[0], i / parts[0] % parts[1], i / (parts[0] * parts[1]));
            const glm::dvec3 center = cell.center - cell.half + half * (2.0 * glm::dvec3(at) + 1.0);
            for (int k = 0; k < 3; ++k) batch_.center[k][i] = center[k];
        }
        std::size_t known;
        do {
            known = subset_.size();
            kernels::evaluate_cells(weights_, side_lists(), target(), batch_);
            for (std::size_t i = 0; i < kBatch && subset_.size() == known; ++i)
                if (batch_.bound[i] < target() && batch_.value[i] < result_.best.value && in_domain(i))
                    try_cell_center(i);
        } while (subset_.size() != known);
        result_.cells += kBatch;
        std::array<std::size_t, kBatch> remaining;
        std::size_t remaining_count = 0;
        for (std::size_t i = 0; i < kBatch; ++i)
            if (batch_.bound[i] < target() && in_domain(i)) remaining[remaining_count++] = i;
        // The child with the lowest bound is pushed last, to be taken next.
        std::stable_sort(remaining.begin(), remaining.begin() + static_cast<std::ptrdiff_t>(remaining_count),
                         [&](std::size_t a, std::size_t b) { return batch_.bound[a] > batch_.bound[b]; });
        for (std::size_t i = 0; i < remaining_count; ++i) push(remaining[i], cell.bound);
    }

    [[nodiscard]] glm::dvec3 center(std::size_t i) const {
        return {batch_.center[0][i], batch_.center[1][i], batch_.center[2][i]};
    }

    [[nodiscard]] bool in_domain(std::size_t i) const {
        const glm::dvec3 least = glm::max(glm::dvec3(0.0), glm::abs(center(i)) - batch_.half);
        return least.x + least.y + least.z <= 1.0 + 1e-12;
    }

    // For the subset the centre of cell i is better than the best frame. If it is for the cloud too, searches from it.
    void try_cell_center(std::size_t i) {
        const glm::dmat3 axes = root_ * rotation(center(i));
        const double before = result_.best.value;
        if (evaluate_on_cloud(axes) < before) search_from(axes);
    }

    void push(std::size_t i, double parent_bound) {
        Cell cell;
        cell.center = center(i);
        cell.half = batch_.half;
        for (int k = 0; k < 3; ++k) cell.spread[k] = batch_.spread[k][i];
        cell.bound = std::max(parent_bound, batch_.bound[i]);
        cell.begin = arena_.size();
        cell.known = subset_.size();
        const kernels::SideLists lists = side_lists();
        for (std::size_t side = 0; side < 6; ++side) {
            const std::size_t room = lists.count[side] + kBatch;
            for (Vector<double>& list : filtered_)
                if (list.size() < room) list.resize(room);
            const std::size_t count = kernels::filter_list(
                lists, side, batch_, i, {filtered_[0].data(), filtered_[1].data(), filtered_[2].data()});
            for (const Vector<double>& list : filtered_)
                arena_.insert(arena_.end(), list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count));
            cell.count[side] = static_cast<std::uint32_t>(count);
        }
        cells_.push_back(cell);
    }

    PointCloud& cloud_;
    const Weights weights_;
    const SearchLimits& limits_;
    SearchBuffers& buffers_;
    const glm::dmat3 root_;
    SearchResult result_;
    double target_ = std::numeric_limits<double>::infinity();
    std::size_t work_ = 0;               // since the host was asked
    Vector<glm::dvec3> subset_, local_;  // in the cloud's coordinates and in the root frame's
    std::array<std::array<Vector<double>, 3>, 6> lists_;
    std::array<std::size_t, 6> count_{};
    std::array<Vector<double>, 3> filtered_;
    Vector<double> arena_;
    Vector<Cell> cells_;
    kernels::CellBatch batch_;
};

}  // namespace

SearchResult branch_and_bound(PointCloud& cloud, const Weights& weights, std::span<const glm::dvec3> subset,
                              const glm::dmat3& start, const SearchLimits& limits, SearchBuffers& buffers) {
    return Search(cloud, weights, subset, start, limits, buffers).run();
}

}  // namespace crofton::fit
