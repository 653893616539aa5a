// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <crofton/core/error.hpp>
#include <cstdio>
#include <limits>

#include "domain/domain.hpp"

namespace crofton::triangulate {
namespace {

constexpr std::uint32_t kMostDigitBits = 11;
constexpr double kLastCell = 65535.0;
constexpr double kCellsPerPoint = 16.0;
// So few are sorted lexicographically at once.
constexpr std::size_t kFew = 16;

std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 8) & 0x00FF00FFu;
    bits = (bits | bits << 4) & 0x0F0F0F0Fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}

// Predicates are exact for magnitudes from 1e-65 to 1e70; the caller's may lie anywhere. So they are scaled by a power
// of two to at most 2, and must not be smaller than this unless 0.
constexpr double kSmallest = 0x1p-200;
constexpr double kLargest = std::numeric_limits<double>::max();

}  // namespace

std::span<const SpatialOrder::Entry> SpatialOrder::sort(std::span<const glm::dvec2> points) {
    encode(points);
    sort_by_code();
    const auto before = [&](const Entry& a, const Entry& b) {
        const auto &p = points[a.index], &q = points[b.index];
        if (p.x != q.x) return p.x < q.x;
        return p.y != q.y ? p.y < q.y : a.index < b.index;
    };
    for (std::size_t begin = 0; begin < entries_.size();) {
        std::size_t end = begin + 1;
        while (end < entries_.size() && entries_[end].code == entries_[begin].code) ++end;
        if (end - begin > 1) {
            std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(begin),
                      entries_.begin() + static_cast<std::ptrdiff_t>(end), before);
        }
        begin = end;
    }
    return entries_;
}

// Rounded differences, products and their truncation are monotone in the coordinate, so cells separate strictly.
void SpatialOrder::encode(std::span<const glm::dvec2> points) {
    entries_.resize(points.size());
    double cells_per_unit = 0.0;
    glm::dvec2 low(0.0);
    if (points.size() > kFew) {
        glm::dvec2 high = low = points[0];
        for (const auto& p : points) {
            low = glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y));
            high = glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y));
        }
        const double width = high.x - low.x, height = high.y - low.y;
        const double side = std::sqrt(width / static_cast<double>(points.size()) * height / kCellsPerPoint);
        const double scale = 1.0 / std::max(side, std::max(width, height) / kLastCell);
        if (std::isfinite(scale)) cells_per_unit = scale;
    }
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto x = static_cast<std::uint32_t>(std::min((points[i].x - low.x) * cells_per_unit, kLastCell));
        const auto y = static_cast<std::uint32_t>(std::min((points[i].y - low.y) * cells_per_unit, kLastCell));
        entries_[i] = {spread(x) << 1 | spread(y), i};
    }
}

// Least digit first, with about as many digits as points; the order of equal codes does not matter.
void SpatialOrder::sort_by_code() {
    std::uint32_t used = 0;
    for (const Entry& e : entries_) used |= e.code;
    if (used == 0) return;
    buffer_.resize(entries_.size());
    const auto digit_bits =
        static_cast<std::uint32_t>(std::min<std::size_t>(kMostDigitBits, std::bit_width(entries_.size())));
    const std::uint32_t digits = 1u << digit_bits;
    std::array<std::uint32_t, (1u << kMostDigitBits) + 1> begin;
    for (std::uint32_t shift = 0; shift < 32 && used >> shift != 0; shift += digit_bits) {
        std::fill_n(begin.begin(), digits + 1, 0u);
        for (const Entry& e : entries_) ++begin[(e.code >> shift & (digits - 1)) + 1];
        for (std::size_t d = 0; d < digits; ++d) begin[d + 1] += begin[d];
        for (const Entry& e : entries_) buffer_[begin[e.code >> shift & (digits - 1)]++] = e;
        std::swap(entries_, buffer_);
    }
}

Result<void> Domain::build(const Polygon& polygon) {
    if (auto result = check(polygon); !result) return result;
    merge_vertices(polygon);
    delaunay(mesh_, codes_, scratch_);
    if (mesh_.triangle_count() == 0)
        return fail(ErrorCode::degenerate, 0, {name_of(0).text, ": zero area: all points are collinear"});
    if (auto result = insert_rings(); !result) return result;
    return find_inside();
}

Result<void> Domain::check(const Polygon& polygon) {
    polygon_ = &polygon;
    std::uint32_t begin = 0;
    for (std::size_t r = 0; r < polygon.ring_ends.size(); ++r) {
        if (polygon.ring_ends[r] < begin || polygon.ring_ends[r] > polygon.points.size()) {
            return fail(ErrorCode::invalid_argument, r, "ring_ends must ascend up to the number of points");
        }
        begin = polygon.ring_ends[r];
    }
    if (begin != polygon.points.size()) {
        return fail(ErrorCode::invalid_argument, polygon.ring_ends.size(),
                    "the last of ring_ends is not the number of points");
    }
    if (polygon.points.size() >= (1u << 29))
        return fail(ErrorCode::out_of_range, polygon.points.size(), "more than 2^29 points");
    if (polygon.ring_ends.empty() || polygon.ring_ends[0] < 3) {
        return fail(ErrorCode::empty, 0, "ring 0 has fewer than three points");
    }
    double largest = 0.0, smallest = kLargest;
    bool finite = true;
    for (const auto& p : polygon.points) {
        for (const double magnitude : {std::fabs(p.x), std::fabs(p.y)}) {
            finite &= magnitude <= kLargest;
            largest = std::max(largest, magnitude);
            smallest = std::min(smallest, magnitude == 0.0 ? kLargest : magnitude);
        }
    }
    const auto find = [&](auto condition) {
        const auto& points = polygon.points;
        const auto holds = [&](const glm::dvec2& p) { return condition(std::fabs(p.x)) || condition(std::fabs(p.y)); };
        return static_cast<Index>(std::find_if(points.begin(), points.end(), holds) - points.begin());
    };
    if (!finite) {
        const Index culprit = find([](double m) { return !(m <= kLargest); });
        return fail(ErrorCode::non_finite, culprit, {name_of(culprit).text, ": not a finite position"});
    }
    scale_ = 1.0;
    if (largest > 1e60 || (largest < 1e-20 && largest > 0.0) || smallest < kSmallest) {
        int exponent = 0;
        std::frexp(largest, &exponent);
        if (std::ldexp(smallest, -exponent) < kSmallest) {
            const Index culprit = find([&](double m) { return m == smallest; });
            return fail(ErrorCode::out_of_range, culprit,
                        {name_of(culprit).text, ": coordinates differ by more than 2^200 in size"});
        }
        scale_ = std::ldexp(1.0, std::min(exponent, 1023));  // 2^1024 is no double
    }
    return {};
}

void Domain::merge_vertices(const Polygon& polygon) {
    std::span<const glm::dvec2> positions = polygon.points;
    if (scale_ != 1.0) {
        scaled_.assign(positions.begin(), positions.end());
        for (auto& p : scaled_) p /= scale_;
        positions = scaled_;
    }
    points_.clear();
    codes_.clear();
    input_of_.clear();
    shared_.clear();
    vertex_of_.resize(positions.size());
    for (const auto& entry : order_.sort(positions)) {
        if (points_.empty() || points_.back() != positions[entry.index]) {
            points_.push_back(positions[entry.index]);
            codes_.push_back(entry.code);
            input_of_.push_back(entry.index);
            shared_.push_back(0);
        } else {
            shared_.back() = 1;
        }
        vertex_of_[entry.index] = static_cast<Index>(points_.size() - 1);
    }
    mesh_.points = points_;
}

// A ring of two points is one edge, not one edge there and back.
Index Domain::edge_count(Index begin, Index end) const {
    return end - begin == 2 ? 1 : end - begin;
}

void Domain::find_next_vertices() {
    next_vertex_.assign(points_.size(), kNone);
    left_inside_.resize(points_.size());
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        for (Index i = begin; i < begin + edge_count(begin, end); ++i) {
            const Index v = vertex_of_[i];
            if (input_of_[v] == i) next_vertex_[v] = vertex_of_[i + 1 == end ? begin : i + 1];
        }
        find_side(begin, end);
        begin = end;
    }
    for (Index v = 0; v < next_vertex_.size(); ++v) {
        const Index w = next_vertex_[v];
        if (w != kNone && next_vertex_[w] == v) next_vertex_[v] = next_vertex_[w] = kNone;
    }
}

// In one pass over the mesh, without a branch that is hard to predict: most edges of most rings are Delaunay.
void Domain::mark_present_edges() {
    find_next_vertices();
    present_.assign(points_.size(), 0);
    mesh_.mark.resize(mesh_.origin.size());
    mesh_.vertex_edge.resize(points_.size());
    queue_.clear();
    inside_.resize(mesh_.triangle_count());
    for (Index e = 0; e < mesh_.origin.size(); e += 4) {
        const Index corners[] = {mesh_.origin[e], mesh_.origin[e + 1], mesh_.origin[e + 2]};
        const Index after[] = {next_vertex_[corners[0]], next_vertex_[corners[1]], next_vertex_[corners[2]]};
        Index marks[3];
        std::uint8_t label = kUnreached;
        for (Index k = 0; k < 3; ++k) {
            const Index m = k == 2 ? 0 : k + 1, u = corners[k], w = corners[m];
            const bool forth = after[k] == w, back = after[m] == u;
            const Index from = forth ? u : w;
            marks[k] = forth || back ? input_of_[from] + 1 : 0;
            label = forth || back ? left_inside_[from] ^ static_cast<std::uint8_t>(back) : label;
            present_[from] |= static_cast<std::uint8_t>(forth || back);
            mesh_.vertex_edge[u] = e + k;
            if (mesh_.twin[e + k] == kNone) queue_.push_back(e + k);
        }
        for (Index k = 0; k < 3; ++k) mesh_.mark[e + k] = marks[k];
        mesh_.mark[e + 3] = 0;
        inside_[e / 4] = label;
    }
    for (const Index e : queue_) mesh_.vertex_edge[mesh_.origin[e]] = e;
}

Result<void> Domain::insert_rings() {
    mark_present_edges();
    records_.clear();
    has_split_edges_ = false;
    Index begin = 0;
    for (const Index end : polygon_->ring_ends) {
        for (Index i = begin; i < begin + edge_count(begin, end); ++i) {
            const Index v = vertex_of_[i];
            if (present_[v] != 0 && input_of_[v] == i) continue;
            if (auto result = insert_edge(i, i + 1 == end ? begin : i + 1); !result) return result;
        }
        begin = end;
    }
    return {};
}

Result<void> Domain::insert_edge(Index input, Index successor) {
    ConstraintInserter inserter(mesh_, scratch_);
    const Index end = vertex_of_[successor];
    for (Index at = vertex_of_[input]; at != end;) {
        Crossing crossing;
        scratch_.cavity.clear();
        const Index e = inserter.advance(at, end, crossing);
        if (crossing.found) {
            return fail(ErrorCode::degenerate, input,
                        {name_of(input).text, ": the edge from here crosses the one from ",
                         name_of(record(crossing.mark - 1).input).text});
        }
        claim(e, input);
        for (const Index triangle : scratch_.cavity) inside_[triangle / 4] = kUnreached;
        at = mesh_.origin[e] == at ? mesh_.destination(e) : mesh_.origin[e];
        has_split_edges_ |= at != end;
    }
    return {};
}

void Domain::insert_diagonals(std::span<const Segment> segments) {
    ConstraintInserter inserter(mesh_, scratch_);
    for (const Segment& s : segments) {
        Crossing crossing;
        (void)inserter.advance(s.from, s.to, crossing);
        CROFTON_ASSERT(!crossing.found, "a diagonal crosses the boundary");
    }
}

void Domain::claim(Index half_edge, Index input) {
    Index mark = input + 1;
    if (mesh_.mark[half_edge] != 0) {
        records_.push_back({input, mesh_.mark[half_edge] - 1});
        mark = static_cast<Index>(vertex_of_.size() + records_.size());
    }
    mesh_.mark[half_edge] = mark;
    if (mesh_.twin[half_edge] != kNone) mesh_.mark[mesh_.twin[half_edge]] = mark;
}

Domain::Name Domain::name_of(Index input) const {
    const auto& p = polygon_->points[input];
    const Index r = ring_of(input);
    Name name;
    std::snprintf(name.text, sizeof name.text, "ring %u, point %u (%.17g, %.17g)", r,
                  r == 0 ? input : input - polygon_->ring_ends[r - 1], p.x, p.y);
    return name;
}

}  // namespace crofton::triangulate
