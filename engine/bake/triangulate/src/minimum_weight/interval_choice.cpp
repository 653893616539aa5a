// SPDX-License-Identifier: MIT
#include "minimum_weight/interval_choice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace crofton::triangulate {
namespace {

// Per rounded operation on values to 100 bits, with room; a root errs by 2^-101 of it (double_double.hpp).
constexpr double kFineError = 0x1p-101;

// Returns the absolute difference as two terms, which is equal for equal lengths along one axis.
std::array<std::uint64_t, 2> exact_extent(double a, double b) {
    const auto d = detail::two_sum(a, -b);
    const double sign = d.high < 0.0 ? -1.0 : 1.0;
    return {std::bit_cast<std::uint64_t>(sign * d.high + 0.0), std::bit_cast<std::uint64_t>(sign * d.low + 0.0)};
}

}  // namespace

bool IntervalChoice::run(const IntervalTable& table, Watch& watch, double fraction) {
    table_ = &table;
    nodes_.clear();
    alternatives_.clear();
    has_classes_ = false;
    node_of_slot_.assign(table.target.size(), kNone);
    (void)node_of(0, table.corner_count() - 1, table.first[1] - 1);
    for (Index node = 0; node < nodes_.size(); ++node) {
        const std::size_t steps = expand(node);
        if (watch.stopped(fraction, steps)) return false;
    }
    sort_by_width();
    for (std::size_t i = 0; i < order_.size(); ++i) {
        const Node& node = nodes_[order_[i]];
        if (watch.stopped(fraction, 10u * (node.end - node.begin))) return false;
        decide(i);
    }
    return true;
}

// The node of the interval whose edge is the low corner's slot; a new one if there is none. None for a side.
Index IntervalChoice::node_of(Index low, Index high, Index slot) {
    if (high == low + 1) return kNone;
    Index& node = node_of_slot_[slot];
    if (node == kNone) {
        node = static_cast<Index>(nodes_.size());
        nodes_.push_back({low, high, slot, 0, 0, kNone, kNone, kNone, 0, {}});
    }
    return node;
}

// Lists the alternatives within the error bound: the corners that are targets of both ends.
std::size_t IntervalChoice::expand(Index index) {
    const IntervalTable& t = *table_;
    const Node node = nodes_[index];
    const Index begin = static_cast<Index>(alternatives_.size());
    Index a = t.first[node.low], b = t.twin[node.slot] + 1;
    const Index a_begin = a, b_begin = b, b_end = t.first[node.high + 1];
    double least = std::numeric_limits<double>::infinity();
    while (a < node.slot && b < b_end) {
        const Index at = t.target[a], bt = t.target[b];
        if (at == bt) {
            const double value = t.value[a] + t.value[b];
            if (value <= least * (1.0 + t.error_bound) && value < std::numeric_limits<double>::infinity()) {
                least = std::min(least, value);
                alternatives_.push_back({at, a, t.twin[b], value});
            }
        }
        a += at <= bt;
        b += bt <= at;
    }
    const double most = least * (1.0 + t.error_bound);
    const auto too_heavy = [&](const Alternative& alternative) { return alternative.value > most; };
    alternatives_.erase(std::remove_if(alternatives_.begin() + begin, alternatives_.end(), too_heavy),
                        alternatives_.end());
    for (Index i = begin; i < alternatives_.size(); ++i) {
        Alternative& alternative = alternatives_[i];
        alternative.left = node_of(node.low, alternative.middle, alternative.left);
        alternative.right = node_of(alternative.middle, node.high, alternative.right);
    }
    nodes_[index].begin = begin;
    nodes_[index].end = static_cast<Index>(alternatives_.size());
    return (a - a_begin) + (b - b_begin);
}

// Short intervals before those that hold them.
void IntervalChoice::sort_by_width() {
    width_begin_.assign(table_->corner_count() + 1, 0);
    for (const Node& node : nodes_) ++width_begin_[node.high - node.low + 1];
    for (std::size_t w = 1; w < width_begin_.size(); ++w) width_begin_[w] += width_begin_[w - 1];
    order_.resize(nodes_.size());
    for (Index i = 0; i < nodes_.size(); ++i) order_[width_begin_[nodes_[i].high - nodes_[i].low]++] = i;
}

DoubleDouble IntervalChoice::value_of(const Alternative& a) const {
    DoubleDouble value = a.left == kNone ? DoubleDouble{} : nodes_[a.left].value;
    if (a.right != kNone) value.add(nodes_[a.right].value.high, nodes_[a.right].value.low);
    return value;
}

// Keeps the least alternative of the node at this place of the order.
void IntervalChoice::decide(std::size_t place) {
    const IntervalTable& t = *table_;
    Node& node = nodes_[order_[place]];
    // A sum of m lengths in any order takes m additions: each of the two compared errs by less than this.
    const double error = (2.0 * (node.high - node.low) + 16.0) * kFineError;
    Index best = node.begin;
    DoubleDouble least = value_of(alternatives_[best]);
    for (Index i = node.begin + 1; i < node.end; ++i) {
        const DoubleDouble value = value_of(alternatives_[i]);
        const double difference = (value.high - least.high) + (value.low - least.low);
        const bool certain = std::fabs(difference) > error * (value.high + least.high);
        if (certain ? difference < 0.0 : lighter(place, alternatives_[i], alternatives_[best])) {
            best = i;
            least = value;
        }
    }
    const Alternative& chosen = alternatives_[best];
    node.middle = chosen.middle;
    node.left = chosen.left;
    node.right = chosen.right;
    const DoubleDouble edge = root(squared_length(t.points[t.vertices[node.low]], t.points[t.vertices[node.high]]));
    least.add(edge.high, edge.low);
    node.value = least;
    if (has_classes_) classify(node);
}

bool IntervalChoice::lighter(std::size_t place, const Alternative& a, const Alternative& b) {
    if (!has_classes_) {
        has_classes_ = true;
        for (PairTable* table : {&pairs_, &weights_, &lengths_, &extents_}) table->clear();
        equal_pairs_.clear();
        for (std::size_t i = 0; i < place; ++i) classify(nodes_[order_[i]]);
    }
    const Index a_class = pair_class(a.left, a.right), b_class = pair_class(b.left, b.right);
    if (a_class == b_class) return false;
    for (auto [edges, alternative] : {std::pair{&left_edges_, &a}, std::pair{&right_edges_, &b}}) {
        edges->clear();
        collect_edges(*alternative, *edges);
    }
    const int sign = sums_.compare(table_->points, left_edges_, right_edges_);
    if (sign == 0) equal_pairs_[std::max(a_class, b_class)] = std::min(a_class, b_class);
    return sign < 0;
}

void IntervalChoice::classify(Node& node) {
    const IntervalTable& t = *table_;
    const Index inside = pair_class(node.left, node.right);
    const Index edge = length_class(t.points[t.vertices[node.low]], t.points[t.vertices[node.high]]);
    // Class 0 is that of sides, which weigh nothing.
    node.weight_class = weights_.number(inside, edge) + 1;
}

// The same for two pairs of intervals only if they are proven to weigh the same.
Index IntervalChoice::pair_class(Index left, Index right) {
    const auto class_of = [&](Index node) { return node == kNone ? 0 : nodes_[node].weight_class; };
    const auto [low, high] = std::minmax({class_of(left), class_of(right)});
    Index pair = pairs_.number(low, high);
    while (equal_pairs_.size() <= pair) equal_pairs_.push_back(static_cast<Index>(equal_pairs_.size()));
    while (equal_pairs_[pair] != pair) pair = equal_pairs_[pair] = equal_pairs_[equal_pairs_[pair]];
    return pair;
}

// The same only for equal lengths: of one square, or across and up as far in either order.
Index IntervalChoice::length_class(const glm::dvec2& a, const glm::dvec2& b) {
    const SquaredLength square = squared_length(a, b);
    // The square's bits exceed all numbers of extents.
    if (square.exact)
        return lengths_.number(std::bit_cast<std::uint64_t>(square.high), std::bit_cast<std::uint64_t>(square.rest));
    const auto x = exact_extent(a.x, b.x), y = exact_extent(a.y, b.y);
    const auto [low, high] = std::minmax({extents_.number(x[0], x[1]), extents_.number(y[0], y[1])});
    return lengths_.number(low, high);
}

void IntervalChoice::collect_edges(const Alternative& alternative, Vector<Segment>& edges) const {
    stack_.clear();
    const auto push = [&](Index child) {
        if (child != kNone) stack_.push_back(child);
    };
    push(alternative.left);
    push(alternative.right);
    while (!stack_.empty()) {
        const Node& node = nodes_[stack_.back()];
        stack_.pop_back();
        edges.push_back({table_->vertices[node.low], table_->vertices[node.high]});
        push(node.left);
        push(node.right);
    }
}

}  // namespace crofton::triangulate
