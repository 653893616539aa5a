#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/obb_obb.hpp>
#include <string>

namespace crofton::collide {
namespace {

struct Bound {
    Aabb box;
    std::uint32_t item;
};

}  // namespace

struct Broadphase::State {
    BroadphaseOptions options;
    BroadphaseStatistics statistics;
    Vector<Bound> bounds;
    Vector<Pair> pairs, previous, began, stayed, ended;
    Vector<std::uint32_t> rejected;

    void compare_with_previous();
};

Broadphase::Broadphase(const BroadphaseOptions& options) : state_(std::make_unique<State>()) {
    state_->options = options;
}
Broadphase::~Broadphase() = default;
Broadphase::Broadphase(Broadphase&&) noexcept = default;
Broadphase& Broadphase::operator=(Broadphase&&) noexcept = default;

std::span<const Pair> Broadphase::pairs() const {
    return state_->pairs;
}
std::span<const Pair> Broadphase::began() const {
    return state_->began;
}
std::span<const Pair> Broadphase::stayed() const {
    return state_->stayed;
}
std::span<const Pair> Broadphase::ended() const {
    return state_->ended;
}
std::span<const std::uint32_t> Broadphase::rejected() const {
    return state_->rejected;
}
const BroadphaseStatistics& Broadphase::statistics() const {
    return state_->statistics;
}

// Both lists are sorted: one merge tells what is new, what stayed and what is gone.
void Broadphase::State::compare_with_previous() {
    began.clear();
    stayed.clear();
    ended.clear();
    std::size_t i = 0, j = 0;
    while (i < pairs.size() || j < previous.size()) {
        if (j == previous.size() || (i < pairs.size() && pairs[i] < previous[j]))
            began.push_back(pairs[i++]);
        else if (i == pairs.size() || previous[j] < pairs[i])
            ended.push_back(previous[j++]);
        else
            stayed.push_back(pairs[i++]), ++j;
    }
}

Result<void> Broadphase::update(std::span<const Obb> boxes, std::span<const Filter> filters, Executor&) {
    State& s = *state_;
    if (!filters.empty() && filters.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, filters.size(), "broadphase: filters and boxes differ in number");
    if (boxes.size() >= 0xffffffffu)
        return fail(ErrorCode::out_of_range, boxes.size(), "broadphase: at most 2^32 - 2 boxes");
    s.statistics = {};
    s.bounds.clear();
    s.rejected.clear();
    std::swap(s.pairs, s.previous);
    s.pairs.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (validate(boxes[i]).has_value())
            s.bounds.push_back({aabb_of(boxes[i]), static_cast<std::uint32_t>(i)});
        else
            s.rejected.push_back(static_cast<std::uint32_t>(i));
    }
    std::sort(s.bounds.begin(), s.bounds.end(), [](const Bound& a, const Bound& b) {
        return a.box.min.x < b.box.min.x || (a.box.min.x == b.box.min.x && a.item < b.item);
    });
    for (std::size_t i = 0; i < s.bounds.size(); ++i)
        for (std::size_t j = i + 1; j < s.bounds.size() && s.bounds[j].box.min.x <= s.bounds[i].box.max.x; ++j) {
            ++s.statistics.nodes_tested;
            if (!crofton::intersects(s.bounds[i].box, s.bounds[j].box)) continue;
            const auto [first, second] = std::minmax(s.bounds[i].item, s.bounds[j].item);
            if (!filters.empty() && !passes(filters[first], filters[second])) continue;
            if (++s.statistics.bound_pairs > s.options.max_pairs) {
                s.pairs.clear();
                return fail(ErrorCode::budget_exceeded, kNoItem,
                            "broadphase: more than " + std::to_string(s.options.max_pairs) + " pairs of bounds meet");
            }
            if (!s.options.exact_boxes || intersects(boxes[first], boxes[second])) s.pairs.push_back({first, second});
        }
    std::sort(s.pairs.begin(), s.pairs.end());
    s.statistics.box_pairs = s.pairs.size();
    s.statistics.rejected = static_cast<std::uint32_t>(s.rejected.size());
    s.compare_with_previous();
    return {};
}

}  // namespace crofton::collide
