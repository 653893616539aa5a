// SPDX-License-Identifier: MIT
#include "cut.hpp"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

namespace crofton::depth {
namespace {

struct Box {
    glm::vec3 min{std::numeric_limits<float>::max()}, max{-std::numeric_limits<float>::max()};

    void include(const Box& other) {
        min = (glm::min)(min, other.min);
        max = (glm::max)(max, other.max);
    }
    // Half of the surface area; 0 for the empty box.
    [[nodiscard]] double area() const {
        const glm::dvec3 size = (glm::max)(glm::dvec3(max) - glm::dvec3(min), glm::dvec3(0.0));
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

// Where to cut a run of triangles: the first `count` along `axis`.
struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    std::uint32_t count = 0;
};

class Cutter {
  public:
    Cutter(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, std::uint32_t most)
        : most_(most), boxes_(indices.size() / 3), middles_(indices.size() / 3) {
        for (std::size_t t = 0; t < boxes_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::vec3& p = positions[indices[3 * t + k]];
                boxes_[t].include({p, p});
            }
            middles_[t] = 0.5f * boxes_[t].min + 0.5f * boxes_[t].max;
        }
        groups_.order.resize(boxes_.size());
        std::iota(groups_.order.begin(), groups_.order.end(), 0u);
        left_areas_.resize(std::max<std::size_t>(kSortedSize, kBins));
    }

    Groups run() {
        struct Run {
            std::uint32_t begin, end;
        };
        Vector<Run> runs{{0, static_cast<std::uint32_t>(boxes_.size())}};
        while (!runs.empty()) {
            const Run run = runs.back();
            runs.pop_back();
            const std::uint32_t count = run.end - run.begin;
            if (count <= most_) {
                groups_.ends.push_back(run.end);
                continue;
            }
            const std::uint32_t middle =
                run.begin + (count <= kSortedSize ? cut_sorted(run.begin, run.end) : cut_binned(run.begin, run.end));
            runs.push_back({middle, run.end});
            runs.push_back({run.begin, middle});
        }
        return std::move(groups_);
    }

  private:
    static constexpr std::uint32_t kSortedSize = 512, kBins = 32;

    // Triangles as whole groups: a cut that leaves groups half empty pays for it.
    [[nodiscard]] double cost_of(double area, std::uint32_t count) const {
        return area * ((count + most_ - 1) / most_);
    }

    void sort(std::uint32_t begin, std::uint32_t end, int axis) {
        std::sort(groups_.order.begin() + begin, groups_.order.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
            const float x = middles_[a][axis], y = middles_[b][axis];
            return x != y ? x < y : a < b;
        });
    }

    // Every cut along every axis. Leaves the run sorted along the best.
    std::uint32_t cut_sorted(std::uint32_t begin, std::uint32_t end) {
        const std::uint32_t count = end - begin;
        Cut best;
        int sorted_by = 0;
        for (int axis = 0; axis < 3; ++axis) {
            sort(begin, end, axis);
            sorted_by = axis;
            Box box;
            for (std::uint32_t i = 0; i < count; ++i) {
                box.include(boxes_[groups_.order[begin + i]]);
                left_areas_[i] = box.area();
            }
            box = {};
            for (std::uint32_t i = count; i-- > 1;) {
                box.include(boxes_[groups_.order[begin + i]]);
                const double cost = cost_of(left_areas_[i - 1], i) + cost_of(box.area(), count - i);
                if (cost < best.cost) best = {cost, axis, i};
            }
        }
        if (best.axis != sorted_by) sort(begin, end, best.axis);
        return best.count;
    }

    // Cuts between bins of equal width.
    std::uint32_t cut_binned(std::uint32_t begin, std::uint32_t end) {
        Box middles;
        for (std::uint32_t i = begin; i < end; ++i) {
            const glm::vec3& m = middles_[groups_.order[i]];
            middles.include({m, m});
        }
        Cut best;
        float best_limit = 0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const float low = middles.min[axis], width = middles.max[axis] - low;
            if (!(width > 0.0f)) continue;
            std::array<Box, kBins> boxes{};
            std::array<std::uint32_t, kBins> counts{};
            for (std::uint32_t i = begin; i < end; ++i) {
                const std::uint32_t t = groups_.order[i];
                const std::uint32_t bin = bin_of(middles_[t][axis], low, width);
                boxes[bin].include(boxes_[t]);
                ++counts[bin];
            }
            Box box;
            for (std::uint32_t b = 0; b < kBins; ++b) {
                box.include(boxes[b]);
                left_areas_[b] = box.area();
            }
            box = {};
            std::uint32_t right = 0;
            for (std::uint32_t b = kBins - 1; b > 0; --b) {
                box.include(boxes[b]);
                right += counts[b];
                const std::uint32_t left = end - begin - right;
                if (right == 0 || left == 0) continue;
                const double cost = cost_of(left_areas_[b - 1], left) + cost_of(box.area(), right);
                if (cost < best.cost) best = {cost, axis, left}, best_limit = static_cast<float>(b);
            }
        }
        if (best.count == 0) return (end - begin) / 2;  // all in one place
        const float low = middles.min[best.axis], width = middles.max[best.axis] - low;
        std::stable_partition(groups_.order.begin() + begin, groups_.order.begin() + end, [&](std::uint32_t t) {
            return static_cast<float>(bin_of(middles_[t][best.axis], low, width)) < best_limit;
        });
        return best.count;
    }

    static std::uint32_t bin_of(float middle, float low, float width) {
        return std::min(static_cast<std::uint32_t>((middle - low) / width * static_cast<float>(kBins)), kBins - 1);
    }

    std::uint32_t most_;
    Vector<Box> boxes_;
    Vector<glm::vec3> middles_;
    Vector<double> left_areas_;
    Groups groups_;
};

}  // namespace

Groups cut_into_groups(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                       std::uint32_t most) {
    return Cutter(positions, indices, most).run();
}

}  // namespace crofton::depth
