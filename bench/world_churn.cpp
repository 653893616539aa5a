// SPDX-License-Identifier: MIT
// What spawns and despawns leave behind in a World: memory, and the time of an update and of a view.
#include <crofton/crofton.hpp>
#include <random>
#include <vector>

#include "counted_memory.hpp"
#include "cull_crowd.hpp"
#include "world_frames.hpp"

namespace crofton::bench {
namespace {

// Objects of which some are removed and others added in each update; as many live at any time.
class Churn {
  public:
    Churn(CountedMemory& counted, std::size_t live_count, std::size_t part)
        : memory(counted), boxes(crowd(live_count)), a_frame_(std::max(live_count / part, std::size_t{1})) {
        for (const Obb& box : boxes) live.push_back(world.add({.bound = box}).value());
        require_ok(world.update().has_value(), "loading");
    }
    void update() {
        for (std::size_t i = 0; i < a_frame_; ++i) {
            ObjectHandle& object = live[random_() % live.size()];
            const Obb box = boxes[random_() % live.size()];
            require_ok(world.remove(object).has_value(), "removing");
            object = world.add({.bound = box}).value();
        }
        rest();
    }
    void rest() {
        memory.most_in_use = memory.in_use;
        update_microseconds += microseconds([&] { require_ok(world.update().has_value(), "an update"); });
        most_bytes = std::max(most_bytes, memory.in_use);
        most_within_bytes = std::max(most_within_bytes, memory.most_in_use);
        sum_of_bytes += static_cast<double>(memory.in_use);
        ++updates;
    }
    [[nodiscard]] std::size_t a_frame() const { return a_frame_; }

    CountedMemory& memory;
    std::vector<Obb> boxes;
    World world{{.pairs = false}};
    std::vector<ObjectHandle> live;
    // Of the updates since these were last set to zero.
    double update_microseconds = 0.0, sum_of_bytes = 0.0;
    std::size_t most_bytes = 0, most_within_bytes = 0, updates = 0;  // bytes after an update, and while one runs

  private:
    std::size_t a_frame_;
    std::mt19937_64 random_{3};
};

struct AgainstFresh {
    double view = 0.0, fresh_view = 0.0, fresh_bytes = 0.0, fresh_within_bytes = 0.0;
};

// A view of the world against one that has just been loaded with the same objects.
AgainstFresh against_fresh(const Churn& churn, const cull::View& view) {
    CountedMemory& memory = churn.memory;
    const std::size_t before = memory.most_in_use = memory.in_use;
    World fresh({.pairs = false});
    for (const ObjectHandle object : churn.live)
        require_ok(fresh.add({.bound = churn.world.box_of(object).value()}).has_value(), "a copy");
    require_ok(fresh.update().has_value(), "loading");
    const auto fresh_bytes = static_cast<double>(memory.in_use - before),
               fresh_within_bytes = static_cast<double>(memory.most_in_use - before);
    ViewResult seen, seen_fresh;
    const FrameTimes times = compare(
        50, [&](int) { (void)fresh.view({.volume = view.frustum, .order = cull::ResultOrder::tree}, seen_fresh); },
        [&](int) { (void)churn.world.view({.volume = view.frustum, .order = cull::ResultOrder::tree}, seen); });
    require_ok(seen.size() == seen_fresh.size(), "the views differ");
    return {times.world, times.by_hand, fresh_bytes, fresh_within_bytes};
}

// A row: as of now, and of the updates since the row before. `moments`: the views are the mean of so many updates,
// since rebuilds in the background come and go.
void print_row(const char* when, std::size_t spawns, Churn& churn, const cull::View& view, bool churns) {
    const int moments = churns ? 16 : 1;
    AgainstFresh mean;
    for (int moment = 0; moment < moments; ++moment) {
        if (churns) churn.update();
        const AgainstFresh now = against_fresh(churn, view);
        mean.view += now.view / moments;
        mean.fresh_view += now.fresh_view / moments;
        mean.fresh_bytes = now.fresh_bytes;
        mean.fresh_within_bytes = now.fresh_within_bytes;
    }
    const auto count = static_cast<double>(churn.live.size()), updates = static_cast<double>(churn.updates);
    const double bytes = churn.sum_of_bytes / updates, most = static_cast<double>(churn.most_bytes),
                 most_within = static_cast<double>(churn.most_within_bytes);
    std::printf("%s,%zu,%.0f,%.2f,%.2f,%.2f,%.1f,%.2f,%.0f\n", when, spawns, bytes / count, bytes / mean.fresh_bytes,
                most / mean.fresh_bytes, most_within / mean.fresh_within_bytes, mean.view, mean.view / mean.fresh_view,
                churn.update_microseconds / updates);
    std::fflush(stdout);
    churn.update_microseconds = churn.sum_of_bytes = 0.0;
    churn.most_bytes = churn.most_within_bytes = churn.updates = 0;
}

}  // namespace

void churn(std::size_t live_count, std::size_t part, std::size_t spawns) {
    CountedMemory memory;
    Churn churn(memory, live_count, part);
    const cull::View view = view_of_share(churn.boxes, 0.2);
    std::printf("# objects: %zu live, %zu removed and as many added in an update\n", live_count, churn.a_frame());
    std::printf(
        "when,spawns,bytes an object,mean × fresh,most × fresh,most in an update × in loading,"
        "view in µs,view × fresh,update in µs\n");
    churn.rest();
    print_row("loaded", 0, churn, view, false);
    std::size_t done = 0;
    for (std::size_t next = spawns / 1000; done < spawns; next *= 10) {
        for (; done < std::min(next, spawns); done += churn.a_frame()) churn.update();
        print_row("churning", done, churn, view, true);
    }
    for (int rest = 0; rest < 600; ++rest) churn.rest();
    churn.sum_of_bytes = churn.update_microseconds = 0.0;
    churn.most_bytes = churn.most_within_bytes = churn.updates = 0;
    churn.rest();
    print_row("600 updates later", done, churn, view, false);
}

}  // namespace crofton::bench
