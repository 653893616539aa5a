// SPDX-License-Identifier: MIT
// Times updates in which one object changes, or a thousand at once, in Worlds of 5,000 to 100,000 objects, and queries
// while objects move.
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <random>
#include <vector>

#include "world_frames.hpp"

namespace crofton::bench {
namespace {

enum class Change {
    nothing,
    move,
    add,
    remove,
    replace,
    layers,
    user,
    hide,
    collides_with,
    add_many,
    remove_many,
    hide_many
};

struct ChangeRow {
    const char* name;
    Change change;
};
constexpr ChangeRow kChanges[] = {{"nothing changes", Change::nothing},
                                  {"one moves far", Change::move},
                                  {"one comes", Change::add},
                                  {"one goes", Change::remove},
                                  {"one comes and one goes", Change::replace},
                                  {"one gets other layers", Change::layers},
                                  {"one gets other user data", Change::user},
                                  {"one is hidden or shown", Change::hide},
                                  {"one collides with others", Change::collides_with},
                                  {"1000 come", Change::add_many},
                                  {"1000 go", Change::remove_many},
                                  {"1000 are hidden", Change::hide_many}};

constexpr bool is_of_many(Change change) {
    return change >= Change::add_many;
}

// Spheres of radius 1, one in a cube of side 20: few touch.
class Spheres {
  public:
    Spheres(std::size_t count, const WorldOptions& options) : world(options), side_(20.0 * std::cbrt(double(count))) {
        for (std::size_t i = 0; i < count; ++i) add();
        for (int update = 0; update < 30; ++update) require_ok(world.update().has_value(), "loading");
    }
    void add() { objects.push_back(world.add({.bound = sphere()}).value()); }
    void remove(std::size_t which) {
        require_ok(world.remove(objects[which]).has_value(), "removing");
        objects[which] = objects.back();
        objects.pop_back();
    }
    [[nodiscard]] Sphere sphere() {
        return {side_ * glm::dvec3(number_(random_), number_(random_), number_(random_)), 1.0};
    }
    [[nodiscard]] std::size_t any() { return random_() % objects.size(); }

    World world;
    std::vector<ObjectHandle> objects;

  private:
    double side_;
    std::mt19937_64 random_{1};
    std::uniform_real_distribution<double> number_{0.0, 1.0};
};

void change(Spheres& spheres, Change kind, int frame) {
    World& world = spheres.world;
    const ObjectHandle one = spheres.objects[static_cast<std::size_t>(frame / 2) % spheres.objects.size()];
    const bool odd = frame % 2 != 0;
    bool done = true;
    switch (kind) {
        case Change::nothing:
            break;
        case Change::move:
            done = world.set_bound(spheres.objects[0], spheres.sphere()).has_value();
            break;
        case Change::remove:
            spheres.remove(spheres.any());
            break;
        case Change::replace:
            spheres.remove(spheres.any());
            [[fallthrough]];
        case Change::add:
            spheres.add();
            break;
        case Change::layers:
            done = world.set_layers(one, odd ? ~0u : 1u).has_value();
            break;
        case Change::user:
            done = world.set_user(one, static_cast<std::uint64_t>(frame)).has_value();
            break;
        case Change::hide:
            done = world.set_hidden(one, !odd).has_value();
            break;
        case Change::collides_with:
            done = world.set_collides_with(one, odd ? ~0u : 0u).has_value();
            break;
        case Change::add_many:
            for (int n = 0; n < 1000; ++n) spheres.add();
            break;
        case Change::remove_many:
            for (int n = 0; n < 1000; ++n) spheres.remove(spheres.any());
            break;
        case Change::hide_many:
            for (std::size_t n = 0; n < 1000; ++n)
                done = done && world.set_hidden(spheres.objects[5 * n], true).has_value();
            break;
    }
    require_ok(done, "a change");
}

// Runs the same updates several times and takes the least of each, as other work on the machine lengthens some: then
// the worst is the World's own. Many things change in the first update alone.
std::vector<double> update_times(std::size_t count, const WorldOptions& options, Change kind, int frames) {
    constexpr int kRuns = 5;
    std::vector<double> times(static_cast<std::size_t>(frames), 1e30);
    for (int run = 0; run < kRuns; ++run) {
        Spheres spheres(count, options);
        for (int frame = 0; frame < frames; ++frame) {
            if (frame == 0 || !is_of_many(kind)) change(spheres, kind, frame);
            double& time = times[static_cast<std::size_t>(frame)];
            time = std::min(time, microseconds([&] { require_ok(spheres.world.update().has_value(), "an update"); }));
        }
    }
    return times;
}

// Median, worst of all but the first two, and worst: the first change after loading finds nothing in the caches. Where
// many change, in the first update alone, the worst.
void print_cell(std::vector<double> times, Change change) {
    const double later = *std::max_element(times.begin() + 2, times.end());
    std::sort(times.begin(), times.end());
    if (is_of_many(change))
        std::printf(",%.0f", times.back());
    else
        std::printf(",%.1f / %.1f / %.1f", times[times.size() / 2], later, times.back());
    std::fflush(stdout);
}

// Of `count` spheres the first so many move in each update, and some of these are replaced.
void queries(std::size_t count, std::size_t moving, std::size_t replaced) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> number(-200.0, 200.0);
    const auto place = [&] { return glm::dvec3(number(random), number(random), number(random)); };
    World world({.pairs = false, .contacts = false});
    std::vector<ObjectHandle> objects;
    std::vector<glm::dvec3> places;
    for (std::size_t i = 0; i < count; ++i) {
        places.push_back(place());
        objects.push_back(world.add({.bound = Sphere{places[i], 1.0}}).value());
    }
    const auto point = convex::Shape::sphere(0.5).value();
    constexpr int kFrames = 30, kQueries = 1000;
    std::size_t found = 0;
    Vector<ObjectRef> near;
    double update = 1e30;
    std::vector<double> first;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (std::size_t i = 0; i < moving; ++i) {
            places[i].x += 0.01;
            require_ok(world.set_bound(objects[i], Sphere{places[i], 1.0}).has_value(), "a move");
        }
        for (std::size_t n = 0; n < replaced; ++n) {
            const std::size_t i = random() % moving;
            require_ok(world.remove(objects[i]).has_value(), "removing");
            places[i] = place();
            objects[i] = world.add({.bound = Sphere{places[i], 1.0}}).value();
        }
        update = std::min(update, microseconds([&] { require_ok(world.update().has_value(), "an update"); }));
        first.push_back(microseconds([&] { found += world.raycast({place(), place()}).has_value(); }));
    }
    std::nth_element(first.begin(), first.begin() + kFrames / 2, first.end());
    std::printf("%8zu %8zu %8zu %9.2f %9.2f", count, moving, replaced, update, first[kFrames / 2]);
    const auto print = [&](auto&& ask) {
        const double all = microseconds([&] {
            for (int n = 0; n < kQueries; ++n) ask();
        });
        std::printf(" %9.2f", all / kQueries);
    };
    print([&] { found += world.raycast({place(), place()}).has_value(); });
    print([&] { world.overlap(Sphere{place(), 2.0}, near), found += near.size(); });
    print([&] { found += world.closest(Sphere{place(), 2.0}, 20.0).has_value(); });
    print([&] { found += world.closest(Sphere{place(), 2.0}, 1e9).has_value(); });
    print([&] {
        const glm::dvec3 from = place();
        found += world.cast(point, {glm::dmat3(1.0), from}, {.velocity = place() - from}, {}).value().has_value();
    });
    std::printf("   (%zu found)\n", found);
    std::fflush(stdout);
}

}  // namespace

void changes(int frames) {
    std::printf(
        "# µs, median / worst but for the first two / worst of %d updates; of 1,000 changes at once, the worst of 16\n",
        frames);
    std::printf("an update in which,among 5000,among 20000,among 100000\n");
    for (const ChangeRow& row : kChanges) {
        std::printf("%s", row.name);
        for (const std::size_t count : {std::size_t{5000}, std::size_t{20000}, std::size_t{100000}})
            print_cell(update_times(count, {}, row.change, is_of_many(row.change) ? 16 : frames), row.change);
        std::printf("\n");
    }
}

void queries_among_movers() {
    std::printf("queries among spheres of which some move, and some of these are replaced in each update, µs\n");
    std::printf("%8s %8s %8s %9s %9s %9s %9s %9s %9s %9s\n", "objects", "moving", "replaced", "update", "first ray",
                "ray", "overlap", "closest", "anywhere", "far cast");
    for (const unsigned moving : {0u, 100u, 1000u, 10000u}) queries(10000, moving, 0);
    for (const unsigned count : {1000u, 10000u}) queries(count, count, count / 100);
}

}  // namespace crofton::bench
