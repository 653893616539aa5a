// SPDX-License-Identifier: MIT
// Traces bundles of parallel lines: triangles are drawn into a grid of lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/lines/lines.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "draw_kernels.hpp"
#include "trace_kernels.hpp"

namespace crofton::lines {
namespace {

// Triangles over more cells than this are cut into rows, so that long thin ones do not name all cells of their box.
constexpr std::int32_t kFewCells = 8;
constexpr std::size_t kCandidates = 2048;
// A grid of more cells than that is turned along the shadow: a thin box across its diagonal would leave most empty.
constexpr double kMostCellsOfLine = 16.0, kFewCellsOfGrid = 0x1p16;

std::uint32_t short_seed(std::uint64_t seed) {
    return static_cast<std::uint32_t>(seed ^ seed >> 32);
}

detail::GridFrame grid_frame(const Bundle& bundle, const glm::dvec3& origin) {
    detail::GridFrame grid;
    const glm::dvec3 right = bundle.right / bundle.cell, up = bundle.up / bundle.cell;
    for (int k = 0; k < 3; ++k) {
        grid.right[k] = static_cast<float>(right[k]);
        grid.up[k] = static_cast<float>(up[k]);
        grid.forward[k] = static_cast<float>(bundle.direction[k]);
    }
    grid.shift[0] = static_cast<float>(glm::dot(right, origin - bundle.corner));
    grid.shift[1] = static_cast<float>(glm::dot(up, origin - bundle.corner));
    grid.shift[2] = static_cast<float>(glm::dot(bundle.direction, origin - bundle.corner));
    grid.columns = static_cast<float>(bundle.columns);
    grid.rows = static_cast<float>(bundle.rows);
    return grid;
}

// Candidates waiting for the test, and the fragments that passed it.
struct Candidates {
    const detail::Projected* chunk = nullptr;
    std::uint32_t first_triangle = 0;
    BundleTracer::Scratch* scratch = nullptr;
    std::size_t count = 0;
    std::array<std::uint32_t, kCandidates + 8> triangles{}, cells{};

    void add(std::uint32_t triangle, std::uint32_t first_cell, std::uint32_t number) {
        for (std::uint32_t i = 0; i < number; ++i) {
            triangles[count] = triangle;
            cells[count] = first_cell + i;
            if (++count == kCandidates) flush();
        }
    }

    void flush() {
        std::array<std::uint32_t, kCandidates + 8> cell, triangle;
        std::array<float, kCandidates + 8> t;
        const std::size_t found =
            detail::covered(*chunk, triangles.data(), cells.data(), count, scratch->sample_x.data(),
                            scratch->sample_y.data(), cell.data(), triangle.data(), t.data());
        count = 0;
        scratch->cells.insert(scratch->cells.end(), cell.data(), cell.data() + found);
        for (std::size_t i = 0; i < found; ++i) {
            const std::uint32_t which = triangle[i];
            scratch->fragments.push_back(
                {t[i], first_triangle + (which & ~detail::kFront), (which & detail::kFront) != 0});
        }
    }
};

// Columns that a triangle touches between row and row + 1, with a margin far above rounding.
std::array<std::int32_t, 2> columns_in_row(const detail::Projected& p, std::size_t i, std::int32_t row) {
    constexpr float kMargin = 0.01f;
    const float low = static_cast<float>(row) - kMargin, high = static_cast<float>(row + 1) + kMargin;
    float least = std::numeric_limits<float>::infinity(), most = -least;
    const auto include = [&](float x) {
        least = std::min(least, x);
        most = std::max(most, x);
    };
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        const float xa = p.x[a][i], ya = p.y[a][i], xb = p.x[b][i], yb = p.y[b][i];
        if (ya >= low && ya <= high) include(xa);
        for (const float y : {low, high})
            if ((ya < y) != (yb < y)) include(xa + (xb - xa) * ((y - ya) / (yb - ya)));
    }
    const auto column = [&](float x) { return static_cast<std::int32_t>(std::floor(x)); };
    if (!(least <= most)) return {0, 0};
    return {std::max(p.column_low[i], column(std::max(least - kMargin, -1.0f))),
            std::min(p.column_high[i], column(std::min(most + kMargin, 2e9f)) + 1)};
}

void add_candidates(const detail::Projected& p, std::uint32_t i, std::uint32_t columns, Candidates& out) {
    const std::int32_t c0 = p.column_low[i], c1 = p.column_high[i], r0 = p.row_low[i], r1 = p.row_high[i];
    if (c0 >= c1 || r0 >= r1) return;
    const bool few = (c1 - c0) <= kFewCells || r1 - r0 == 1;
    for (std::int32_t row = r0; row < r1; ++row) {
        const auto [first, last] = few ? std::array<std::int32_t, 2>{c0, c1} : columns_in_row(p, i, row);
        if (first < last)
            out.add(i, static_cast<std::uint32_t>(row) * columns + static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(last - first));
    }
}

// As in LineTracer: where two faces back to back coincide, rounding must not put the back one in front.
bool is_before(const Hit& a, const Hit& b, float tie) {
    const float x = a.front ? a.t : a.t + tie, y = b.front ? b.t : b.t + tie;
    return x != y ? x < y : a.triangle < b.triangle;
}

// How many cells the shadow of a box takes along each side of a bundle's grid. One to spare: shadows of corners are
// rounded.
glm::dvec2 cells_across(const Bundle& bundle, const glm::dvec3& half) {
    const glm::dvec2 reach(glm::dot(glm::abs(bundle.right), half), glm::dot(glm::abs(bundle.up), half));
    return glm::ceil(2.0 * reach / bundle.cell) + 1.0;
}

// Turns the grid along the longest of the shadows of the box's half edges. Let p be that and w half the shadow's width
// across it. The grid is at most 6·|p| long and 2·w wide. The shadow has an area of 4·|p|·w at least, the sum of the
// parallelograms of each two. So the grid has at most three times that, and the cells to spare.
void turn_along_shadow(const glm::dvec3& half, Bundle& bundle) {
    glm::dvec2 longest(0.0);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec2 p = half[k] * glm::dvec2(bundle.right[k], bundle.up[k]);
        if (glm::dot(p, p) > glm::dot(longest, longest)) longest = p;
    }
    longest /= glm::length(longest);
    const glm::dvec3 right = bundle.right;
    bundle.right = longest.x * right + longest.y * bundle.up;
    bundle.up = longest.x * bundle.up - longest.y * right;
}

}  // namespace

Bundle make_bundle(const Aabb& bounds, double cell_area, const std::array<double, 2>& u, std::uint64_t seed) {
    CROFTON_ASSERT(cell_area > 0.0, "a bundle's cells need an area");
    Bundle bundle;
    bundle.direction = sampling::direction(u);
    const auto frame = sampling::orthonormal_frame(bundle.direction);
    bundle.right = frame[0], bundle.up = frame[1];
    bundle.cell = std::sqrt(cell_area);
    bundle.seed = seed;
    const glm::dvec3 half = bounds.half_extents(), d = glm::abs(bundle.direction);
    bundle.lines = 4.0 * (d.x * half.y * half.z + d.y * half.z * half.x + d.z * half.x * half.y) / cell_area;
    glm::dvec2 across = cells_across(bundle, half);
    if (across.x * across.y > kMostCellsOfLine * bundle.lines + kFewCellsOfGrid) {
        turn_along_shadow(half, bundle);
        across = cells_across(bundle, half);
    }
    CROFTON_ASSERT(across.x * across.y <= 0x1p24, "a bundle of too many cells");
    bundle.columns = static_cast<std::uint32_t>(across.x);
    bundle.rows = static_cast<std::uint32_t>(across.y);
    bundle.corner = bounds.center() - 0.5 * bundle.cell *
                                          (static_cast<double>(bundle.columns) * bundle.right +
                                           static_cast<double>(bundle.rows) * bundle.up);
    return bundle;
}

Line Bundle::line(std::size_t cell_number) const {
    const auto row = static_cast<std::uint32_t>(cell_number / columns);
    Vector<float> x(columns + 8), y(columns + 8);
    detail::jitter_row(short_seed(seed), row * columns, columns, row, x.data(), y.data());
    const std::size_t column = cell_number % columns;
    return {corner + cell * (static_cast<double>(x[column]) * right + static_cast<double>(y[column]) * up), direction};
}

BundleTracer::BundleTracer() = default;
BundleTracer::~BundleTracer() = default;
BundleTracer::BundleTracer(BundleTracer&&) noexcept = default;
BundleTracer& BundleTracer::operator=(BundleTracer&&) noexcept = default;

Result<BundleTracer> BundleTracer::build(const TriangleMesh& mesh) {
    return crofton::detail::recover([&]() -> Result<BundleTracer> {
        if (auto valid = validate(mesh); !valid) return valid.error();
        if (mesh.indices.empty()) return fail(ErrorCode::empty, kNoItem, "bundle tracer: there are no triangles");
        if (mesh.triangle_count() >= std::size_t{1} << 30)
            return fail(ErrorCode::out_of_range, mesh.triangle_count(), "bundle tracer: 2^30 triangles or more");
        BundleTracer tracer;
        for (const std::uint32_t i : mesh.indices) tracer.bounds_.include(glm::dvec3(mesh.positions[i]));
        tracer.origin_ = tracer.bounds_.center();
        tracer.tie_ = static_cast<float>(1e-6 * glm::length(tracer.bounds_.half_extents()));
        tracer.triangles_ = mesh.triangle_count();
        tracer.blocks_.assign((tracer.triangles_ + detail::kDrawLanes - 1) / detail::kDrawLanes, {});
        for (std::size_t t = 0; t < tracer.triangles_; ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                const glm::dvec3 p = glm::dvec3(mesh.positions[mesh.indices[3 * t + c]]) - tracer.origin_;
                for (int k = 0; k < 3; ++k)
                    tracer.blocks_[t / detail::kDrawLanes].corner[c][k][t % detail::kDrawLanes] =
                        static_cast<float>(p[k]);
            }
        return tracer;
    });
}

std::size_t BundleTracer::bytes() const {
    return blocks_.capacity() * sizeof(detail::DrawnTriangles);
}

void BundleTracer::place_samples(const Bundle& bundle, Scratch& scratch) const {
    scratch.sample_x.resize(bundle.cells() + 8);
    scratch.sample_y.resize(bundle.cells() + 8);
    for (std::uint32_t row = 0; row < bundle.rows; ++row)
        detail::jitter_row(short_seed(bundle.seed), row * bundle.columns, bundle.columns, row,
                           scratch.sample_x.data() + std::size_t{row} * bundle.columns,
                           scratch.sample_y.data() + std::size_t{row} * bundle.columns);
}

void BundleTracer::draw(const Bundle& bundle, Scratch& scratch) const {
    const detail::GridFrame grid = grid_frame(bundle, origin_);
    detail::Projected projected;
    Candidates candidates;
    candidates.chunk = &projected;
    candidates.scratch = &scratch;
    scratch.cells.clear();
    scratch.fragments.clear();
    for (std::size_t block = 0; block < blocks_.size(); block += detail::kChunkBlocks) {
        const std::size_t count = std::min(detail::kChunkBlocks, blocks_.size() - block);
        detail::project(blocks_.data() + block, count, grid, projected);
        candidates.first_triangle = static_cast<std::uint32_t>(block * detail::kDrawLanes);
        const std::size_t end = std::min(count * detail::kDrawLanes, triangles_ - block * detail::kDrawLanes);
        for (std::uint32_t i = 0; i < end; ++i) add_candidates(projected, i, bundle.columns, candidates);
        candidates.flush();
    }
}

void BundleTracer::sort_by_cell(const Bundle& bundle, Scratch& scratch, LineHits& result) const {
    const std::size_t cells = bundle.cells();
    scratch.starts.assign(cells + 1, 0);
    for (const std::uint32_t cell : scratch.cells) ++scratch.starts[cell + 1];
    for (std::size_t c = 0; c < cells; ++c) scratch.starts[c + 1] += scratch.starts[c];
    result.hits.resize(scratch.fragments.size());
    result.ends.assign(scratch.starts.begin(), scratch.starts.end() - 1);
    // Each fragment is put in its place among those of its cell that are there already.
    for (std::size_t f = 0; f < scratch.fragments.size(); ++f) {
        const std::uint32_t cell = scratch.cells[f], begin = scratch.starts[cell];
        const Hit& hit = scratch.fragments[f];
        std::uint32_t at = result.ends[cell]++;
        for (; at > begin && is_before(hit, result.hits[at - 1], tie_); --at) result.hits[at] = result.hits[at - 1];
        result.hits[at] = hit;
    }
}

void BundleTracer::all_hits(const Bundle& bundle, Scratch& scratch, LineHits& result) const {
    place_samples(bundle, scratch);
    draw(bundle, scratch);
    sort_by_cell(bundle, scratch, result);
}

}  // namespace crofton::lines
