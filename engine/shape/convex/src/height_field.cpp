// SPDX-License-Identifier: MIT
// Height fields: building, and the search for cells near a box or along a ray, over levels of least and largest
// heights.
#include <algorithm>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/core/recovery.hpp>
#include <limits>
#include <string>

#include "passage.hpp"
#include "ray.hpp"

namespace crofton::convex {
namespace {

constexpr std::uint32_t kBlock = 4;        // cells, and blocks, along a side of a block
constexpr std::uint32_t kMaxLine = 32768;  // corners
constexpr double kFewCells = 8.0;          // along a side: asked without a descent

std::uint32_t blocks_of(std::uint32_t count) {
    return (count + kBlock - 1) / kBlock;
}

Result<void> check(const HeightFieldDescription& d) {
    if (d.columns < 2 || d.rows < 2 || d.columns > kMaxLine || d.rows > kMaxLine)
        return fail(ErrorCode::out_of_range, kNoItem, "height field: columns and rows must be in [2, 32768]");
    for (int k = 0; k < 2; ++k)
        if (!(d.spacing[k] >= 1e-6 && d.spacing[k] <= 1e6))
            return fail(ErrorCode::out_of_range, kNoItem, "height field: the spacing must be in [1e-6, 1e6]");
    if (d.heights.size() != std::size_t{d.columns} * d.rows)
        return fail(ErrorCode::invalid_argument, kNoItem, "height field: heights must be columns times rows");
    const std::size_t cells = std::size_t{d.columns - 1} * (d.rows - 1);
    if (!d.materials.empty() && d.materials.size() != cells)
        return fail(ErrorCode::invalid_argument, kNoItem, "height field: materials must be one a cell, or none");
    for (std::size_t i = 0; i < d.heights.size(); ++i) {
        if (!std::isfinite(d.heights[i]))
            return fail(ErrorCode::non_finite, i,
                        {"height field: height ", i, " is NaN or infinite; holes are a material of cells"});
        if (std::abs(d.heights[i]) > kMaxExtent)
            return fail(ErrorCode::out_of_range, i, {"height field: height ", i, " exceeds 1e15"});
    }
    if (!d.materials.empty() &&
        std::all_of(d.materials.begin(), d.materials.end(), [](std::uint8_t m) { return m == kHole; }))
        return fail(ErrorCode::empty, kNoItem, "height field: all cells are holes");
    return {};
}

}  // namespace

Result<HeightField> HeightField::build(const HeightFieldDescription& description) {
    if (Result<void> good = check(description); !good) return good.error();
    return detail::recover([&]() -> Result<HeightField> {
        HeightField field;
        field.columns_ = description.columns;
        field.rows_ = description.rows;
        field.spacing_ = description.spacing;
        field.heights_.assign(description.heights.begin(), description.heights.end());
        field.materials_.assign(description.materials.begin(), description.materials.end());
        field.build_levels();
        const Span all = field.spans_.back();
        const glm::dvec3 last = field.corner(field.columns_ - 1, field.rows_ - 1);
        field.bounds_ = {{0.0, static_cast<double>(all.low), 0.0}, {last.x, static_cast<double>(all.high), last.z}};
        return field;
    });
}

HeightField::Span HeightField::span_of(std::uint32_t column, std::uint32_t row) const {
    Span span{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    const std::uint32_t end_i = std::min((column + 1) * kBlock, columns_ - 1),
                        end_j = std::min((row + 1) * kBlock, rows_ - 1);
    for (std::uint32_t j = row * kBlock; j < end_j; ++j)
        for (std::uint32_t i = column * kBlock; i < end_i; ++i) {
            if (material(j * (columns_ - 1) + i) == kHole) continue;
            const float* const h = heights_.data() + std::size_t{j} * columns_ + i;
            for (const float y : {h[0], h[1], h[columns_], h[columns_ + 1]})
                span = {std::min(span.low, y), std::max(span.high, y)};
        }
    return span;
}

void HeightField::build_levels() {
    std::uint32_t columns = blocks_of(columns_ - 1), rows = blocks_of(rows_ - 1);
    levels_.push_back({columns, rows, 0});
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) spans_.push_back(span_of(i, j));
    while (columns > 1 || rows > 1) {
        const Level below = levels_.back();
        columns = blocks_of(columns);
        rows = blocks_of(rows);
        levels_.push_back({columns, rows, spans_.size()});
        for (std::uint32_t j = 0; j < rows; ++j)
            for (std::uint32_t i = 0; i < columns; ++i) {
                Span span{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
                for (std::uint32_t y = j * kBlock; y < std::min((j + 1) * kBlock, below.rows); ++y)
                    for (std::uint32_t x = i * kBlock; x < std::min((i + 1) * kBlock, below.columns); ++x) {
                        const Span& part = spans_[below.first + std::size_t{y} * below.columns + x];
                        span = {std::min(span.low, part.low), std::max(span.high, part.high)};
                    }
                spans_.push_back(span);
            }
    }
}

Triangle HeightField::triangle(std::uint32_t index) const {
    const std::uint32_t cell = index / 2, i = cell % (columns_ - 1), j = cell / (columns_ - 1);
    if (index % 2 == 0) return {corner(i, j), corner(i, j + 1), corner(i + 1, j)};
    return {corner(i + 1, j + 1), corner(i + 1, j), corner(i, j + 1)};
}

// The descent through the levels; a block of level l is 4^(l+1) cells wide.
class FieldSearch {
  public:
    FieldSearch(const HeightField& field, const Aabb& box, const PartSearch& search)
        : field_(field), box_(box), search_(search) {
        cells_ = {field.columns_ - 1, field.rows_ - 1};
    }

    bool run() const {
        std::uint32_t first[2], end[2];
        if (!search_.nearest_first && few_cells(first, end)) {
            for (std::uint32_t j = first[1]; j < end[1]; ++j)
                for (std::uint32_t i = first[0]; i < end[0]; ++i)
                    if (visit_cell(i, j)) return true;
            return false;
        }
        const std::size_t top = field_.levels_.size() - 1;
        return distance_to(top, 0, 0) <= search_.limit && descend(top, 0, 0);
    }

  private:
    // The cells below the box, grown by the limit, where they are few: false where they are many.
    bool few_cells(std::uint32_t (&first)[2], std::uint32_t (&end)[2]) const {
        const double grown = search_.limit * (1.0 + 1e-4);
        for (int k = 0; k < 2; ++k) {
            const double from = (box_.min[2 * k] - grown) / field_.spacing_[k],
                         to = (box_.max[2 * k] + grown) / field_.spacing_[k], last = static_cast<double>(cells_[k]);
            if (!(to - from <= kFewCells)) return false;
            first[k] = static_cast<std::uint32_t>(std::clamp(std::floor(from), 0.0, last));
            end[k] = static_cast<std::uint32_t>(std::clamp(std::floor(to) + 1.0, 0.0, last));
            // A box that touches a corner's line from outside meets the cells on the other side.
            if (first[k] > 0 && static_cast<double>(first[k]) == from) --first[k];
        }
        return true;
    }

    bool descend(std::size_t level, std::uint32_t column, std::uint32_t row) const {
        if (level == 0) return visit_cells(column, row);
        const HeightField::Level& below = field_.levels_[level - 1];
        Child child[kBlock * kBlock];
        int count = 0;
        for (std::uint32_t j = row * kBlock; j < std::min((row + 1) * kBlock, below.rows); ++j)
            for (std::uint32_t i = column * kBlock; i < std::min((column + 1) * kBlock, below.columns); ++i) {
                const double distance = distance_to(level - 1, i, j);
                if (distance > search_.limit) continue;
                int place = count++;
                for (; search_.nearest_first && place > 0 && child[place - 1].distance > distance; --place)
                    child[place] = child[place - 1];
                child[place] = {i, j, distance};
            }
        for (int k = 0; k < count; ++k)
            if (child[k].distance <= search_.limit && descend(level - 1, child[k].column, child[k].row)) return true;
        return false;
    }

    struct Child {
        std::uint32_t column, row;
        double distance;
    };

    [[nodiscard]] double distance_to(std::size_t level, std::uint32_t i, std::uint32_t j) const {
        const HeightField::Level& at = field_.levels_[level];
        const HeightField::Span& span = field_.spans_[at.first + std::size_t{j} * at.columns + i];
        if (span.low > span.high) return std::numeric_limits<double>::infinity();
        const std::uint32_t shift = 2 * static_cast<std::uint32_t>(level) + 2;
        return distance_between(around(i << shift, j << shift, 1u << shift, span), box_);
    }
    [[nodiscard]] Aabb around(std::uint32_t i, std::uint32_t j, std::uint32_t width,
                              const HeightField::Span& span) const {
        return {{static_cast<double>(i) * field_.spacing_.x, static_cast<double>(span.low),
                 static_cast<double>(j) * field_.spacing_.y},
                {static_cast<double>(std::min(i + width, cells_.x)) * field_.spacing_.x, static_cast<double>(span.high),
                 static_cast<double>(std::min(j + width, cells_.y)) * field_.spacing_.y}};
    }
    bool visit_cells(std::uint32_t column, std::uint32_t row) const {
        for (std::uint32_t j = row * kBlock; j < std::min((row + 1) * kBlock, cells_.y); ++j)
            for (std::uint32_t i = column * kBlock; i < std::min((column + 1) * kBlock, cells_.x); ++i)
                if (visit_cell(i, j)) return true;
        return false;
    }
    bool visit_cell(std::uint32_t i, std::uint32_t j) const {
        const std::uint32_t cell = j * cells_.x + i;
        if (field_.material(cell) == kHole) return false;
        const float* const h = field_.heights_.data() + std::size_t{j} * field_.columns_ + i;
        const float below = h[field_.columns_], beside = h[field_.columns_ + 1];
        // The triangles share two corners.
        const float low = std::min(h[1], below), high = std::max(h[1], below);
        for (std::uint32_t k = 0; k < 2; ++k) {
            const float third = k == 0 ? h[0] : beside;
            const HeightField::Span span{std::min(low, third), std::max(high, third)};
            if (distance_between(around(i, j, 1, span), box_) > search_.limit) continue;
            if (search_.offer(field_.triangle(2 * cell + k), 2 * cell + k)) return true;
        }
        return false;
    }

    const HeightField& field_;
    const Aabb& box_;
    const PartSearch& search_;
    glm::uvec2 cells_{0};
};

bool search_field(const HeightField& field, const Aabb& box, const PartSearch& search) {
    return FieldSearch(field, box, search).run();
}

// The descent along a way, the blocks that are come to first first.
class FieldDescent {
  public:
    // `passes`: whether the way passes a box in the field's frame, and from where on; `limit`: where it ends, for
    // `meet` to lessen, which is called for cells.
    FieldDescent(const HeightField& field, FunctionRef<bool(const Aabb& box, double& from)> passes, const double& limit,
                 FunctionRef<void(std::uint32_t cell)> meet)
        : field_(field), passes_box_(passes), limit_(limit), meet_(meet) {}

    void run() const {
        const auto top = static_cast<std::uint32_t>(field_.levels_.size()) - 1;
        double from = 0.0;
        if (passes(top, 0, 0, from)) descend(top, 0, 0);
    }

  private:
    struct Child {
        std::uint32_t column, row;
        double from;
    };

    // The box of `width` cells from a corner on.
    bool passes_cells(std::uint32_t i, std::uint32_t j, std::uint32_t width, float low, float high,
                      double& from) const {
        const auto end = [&](std::uint32_t k, std::uint32_t count) {
            return static_cast<double>(std::min(k + width, count - 1));
        };
        const glm::dvec2 spacing = field_.spacing_;
        const Aabb box{
            {static_cast<double>(i) * spacing.x, static_cast<double>(low), static_cast<double>(j) * spacing.y},
            {end(i, field_.columns_) * spacing.x, static_cast<double>(high), end(j, field_.rows_) * spacing.y}};
        return passes_box_(box, from);
    }
    bool passes(std::uint32_t level, std::uint32_t i, std::uint32_t j, double& from) const {
        const HeightField::Level& at = field_.levels_[level];
        const HeightField::Span& span = field_.spans_[at.first + std::size_t{j} * at.columns + i];
        if (span.low > span.high) return false;  // holes
        const std::uint32_t shift = 2 * level + 2;
        return passes_cells(i << shift, j << shift, 1u << shift, span.low, span.high, from);
    }

    void descend(std::uint32_t level, std::uint32_t column, std::uint32_t row) const {
        const bool to_cells = level == 0;
        const std::uint32_t columns = to_cells ? field_.columns_ - 1 : field_.levels_[level - 1].columns,
                            rows = to_cells ? field_.rows_ - 1 : field_.levels_[level - 1].rows;
        Child child[kBlock * kBlock];
        int count = 0;
        for (std::uint32_t j = row * kBlock; j < std::min((row + 1) * kBlock, rows); ++j)
            for (std::uint32_t i = column * kBlock; i < std::min((column + 1) * kBlock, columns); ++i) {
                double from = 0.0;
                if (!(to_cells ? passes_cell(i, j, from) : passes(level - 1, i, j, from))) continue;
                int place = count++;
                for (; place > 0 && child[place - 1].from > from; --place) child[place] = child[place - 1];
                child[place] = {i, j, from};
            }
        for (int k = 0; k < count; ++k) {
            if (child[k].from > limit_) return;
            if (to_cells)
                meet_(child[k].row * (field_.columns_ - 1) + child[k].column);
            else
                descend(level - 1, child[k].column, child[k].row);
        }
    }
    bool passes_cell(std::uint32_t i, std::uint32_t j, double& from) const {
        if (field_.material(j * (field_.columns_ - 1) + i) == kHole) return false;
        const float* const h = field_.heights_.data() + std::size_t{j} * field_.columns_ + i;
        const auto [low, high] = std::minmax({h[0], h[1], h[field_.columns_], h[field_.columns_ + 1]});
        return passes_cells(i, j, 1, low, high, from);
    }

    const HeightField& field_;
    FunctionRef<bool(const Aabb& box, double& from)> passes_box_;
    const double& limit_;
    FunctionRef<void(std::uint32_t cell)> meet_;
};

std::optional<NearHit> meet_field(const HeightField& field, Sides sides, const NearRay& ray) {
    NearRay rest = ray;  // up to the best
    std::optional<NearHit> best;
    const auto passes = [&](const Aabb& box, double& from) { return passes_box(rest, box, ray.error, from); };
    FieldDescent(field, passes, rest.max_t, [&](std::uint32_t cell) {
        for (std::uint32_t triangle = 2 * cell; triangle < 2 * cell + 2; ++triangle) {
            auto hit = meet_triangle(field.triangle(triangle), sides, ray);
            if (!hit) continue;
            hit->triangle = triangle;
            if (best && (hit->t > best->t || (hit->t == best->t && triangle > best->triangle))) continue;
            best = hit;
            rest.max_t = hit->t;
        }
    }).run();
    return best;
}

void Passage::visit_field(const HeightField& field, const double& until, TriangleInPath visit) const {
    if (!(from_ <= to_)) return;
    const auto passes = [&](const Aabb& box, double& from) {
        from = entry(box, until);
        return from <= until;
    };
    FieldDescent(field, passes, until, [&](std::uint32_t cell) {
        for (std::uint32_t triangle = 2 * cell; triangle < 2 * cell + 2; ++triangle)
            visit(field.triangle(triangle), triangle);
    }).run();
}

}  // namespace crofton::convex
