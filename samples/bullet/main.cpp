// SPDX-License-Identifier: MIT
// crofton_bullet: Bullet steps stacks and piles of bodies, on its own collision detection and on Crofton's. It prints
// the time of the whole step and how still the bodies are. No display needed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numeric>
#include <string>

#include "check.hpp"
#include "scene.hpp"

namespace {

using namespace crofton::bullet;

struct Measured {
    double milliseconds = 0.0;  // of processor time a step, median of the last `timed`
    Stillness stillness;
    int pairs = 0;          // of boxes
    double drift = 0.0;     // the farthest that any body has moved in the last `timed` steps
    double kept_ids = 1.0;  // share of contact points whose id was there in the step before; with Crofton
};

Measured run(const SceneOptions& options, int settling, int timed) {
    Scene scene(options);
    for (int i = 0; i < settling; ++i) scene.step();
    const std::vector<btVector3> before = scene.positions();
    if (options.with_crofton) scene.counts() = {};
    std::vector<double> times;
    Measured result;
    for (int i = 0; i < timed; ++i) {
        const std::clock_t start = std::clock();
        scene.step();
        times.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    std::nth_element(times.begin(), times.begin() + timed / 2, times.end());
    result.milliseconds = times[static_cast<std::size_t>(timed / 2)];
    const std::vector<btVector3> after = scene.positions();
    for (std::size_t i = 0; i < after.size(); ++i)
        result.drift = std::max(result.drift, static_cast<double>((after[i] - before[i]).length()));
    result.pairs = scene.world().getPairCache()->getNumOverlappingPairs();
    result.stillness = scene.stillness();
    if (options.with_crofton) {
        const PointCounts& counts = scene.counts();
        const double all = static_cast<double>(counts.kept + counts.begun);
        result.kept_ids = all > 0.0 ? static_cast<double>(counts.kept) / all : 1.0;
    }
    return result;
}

// Pairs and queries beside a plain loop, while a pile falls and bodies come and go.
bool broadphase_is_right() {
    Scene scene({.arrangement = Arrangement::pile, .count = 300});
    for (unsigned step = 0; step < 120; ++step) {
        if (step % 3 == 1)
            for (std::size_t i = step % 7 + 1; i < 300; i += 7) scene.replace(i);
        scene.step();
        // Boxes are found before bodies move: those of the next step belong to where they are now.
        scene.world().performDiscreteCollisionDetection();
        if (const std::string fault = find_fault(scene, step); !fault.empty()) {
            std::printf("step %u: %s\n", step, fault.c_str());
            return false;
        }
    }
    return true;
}

void print(const char* name, const Measured& m) {
    std::printf(
        "%-8s %8.2f ms a step  speed mean %.2e max %.2e m/s  drift %.2e m  deepest %.2e m  %zu points of %d pairs",
        name, m.milliseconds, m.stillness.mean_speed, m.stillness.max_speed, m.drift, m.stillness.deepest,
        m.stillness.points, m.pairs);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Bullet's step on its own collision detection and on Crofton's.");
    std::string arrangement = "stack", with = "both";
    SceneOptions options;
    int settling = 240, timed = 60;
    bool check = false;
    app.add_option("--scene", arrangement, "stack or pile")->check(CLI::IsMember({"stack", "pile"}));
    app.add_option("--bodies", options.count, "How many")->check(CLI::Range(1, 1000000));
    app.add_flag("--hulls", options.hulls, "Hulls of sixteen vertices instead of boxes");
    app.add_flag("--sleep", options.may_sleep, "Bullet may put bodies to sleep");
    app.add_option("--iterations", options.iterations, "Of Bullet's solver a step");
    app.add_option("--settle", settling, "Steps before those that are measured");
    app.add_option("--steps", timed, "Steps that are measured")->check(CLI::Range(1, 1000000));
    app.add_option("--with", with, "bullet, crofton or both")->check(CLI::IsMember({"bullet", "crofton", "both"}));
    app.add_flag("--check", check, "Fail unless bodies rest as still as with Bullet's own and 99 % of the ids stay");
    CLI11_PARSE(app, argc, argv);
    options.arrangement = arrangement == "pile" ? Arrangement::pile : Arrangement::stack;
    Measured bullet, crofton;
    if (with != "crofton") {
        options.with_crofton = false;
        bullet = run(options, settling, timed);
        print("Bullet", bullet);
        std::printf("\n");
    }
    if (with != "bullet") {
        options.with_crofton = true;
        crofton = run(options, settling, timed);
        print("Crofton", crofton);
        std::printf("  %.3f %% of ids kept\n", 100.0 * crofton.kept_ids);
    }
    if (with != "both") return 0;
    std::printf("Bullet's step is %.2f x as fast with Crofton\n", bullet.milliseconds / crofton.milliseconds);
    if (!check) return 0;
    const bool still = crofton.stillness.mean_speed <= 1.5 * bullet.stillness.mean_speed + 1e-3 &&
                       crofton.drift <= 1.5 * bullet.drift + 1e-3;
    if (!still) std::printf("less still than with Bullet's own\n");
    if (crofton.kept_ids < 0.99) std::printf("ids change\n");
    return broadphase_is_right() && still && crofton.kept_ids >= 0.99 ? 0 : 1;
}
