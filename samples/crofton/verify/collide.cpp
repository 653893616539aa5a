// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/gtc/quaternion.hpp>
#include <oracle/box_axes.hpp>
#include <random>

#include "exact_numbers.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using Engine = std::mt19937_64;

bool boxes_meet(const Obb& a, const Obb& b) {
    return oracle::decide_by<Dyadic>([&]<class Number>() { return oracle::boxes_meet_by_axes<Number>(a, b); });
}

glm::dvec3 random_vector(Engine& random) {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const double x = number(random), y = number(random), z = number(random);
    return {x, y, z};
}

glm::dquat random_rotation(Engine& random) {
    std::normal_distribution<double> normal;
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    return glm::normalize(glm::dquat(w, x, y, z));
}

Obb random_box(Engine& random, const glm::dquat& frame) {
    Obb box;
    box.axes = glm::mat3(glm::mat3_cast(frame));
    box.half_extents = glm::vec3(0.55 + 0.45 * random_vector(random));
    return box;
}

// Where b, starting at a's centre, leaves a along `direction`, by bisection with the oracle itself.
double touching_distance(const Obb& a, Obb b, const glm::dvec3& direction) {
    double meeting = 0.0, apart = 8.0;
    for (int step = 0; step < 52; ++step) {
        const double middle = 0.5 * (meeting + apart);
        b.center = middle * direction;
        (boxes_meet(a, b) ? meeting : apart) = middle;
    }
    return meeting;
}

struct Class {
    const char* name;
    bool parallel, float_centers;
};

// Pairs that are asked together: memory does not grow with the number of trials.
constexpr std::uint64_t kPairsAtOnce = 1 << 14;

struct PairsToAsk {
    std::vector<Obb> first, second;
    std::vector<std::uint8_t> truth;
};

void add_pair(const Class& kind, std::uint64_t trial, Engine& random, PairsToAsk& pairs) {
    const glm::dquat frame = random_rotation(random);
    // All decades in turn.
    const double angle = std::pow(10.0, -1.0 - static_cast<double>(trial / 15 % 12));
    const glm::dquat turn = glm::angleAxis(angle, glm::normalize(random_vector(random)));
    const Obb a = random_box(random, frame);
    Obb b = random_box(random, kind.parallel ? turn * frame : random_rotation(random));
    const glm::dvec3 direction =
        trial % 2 ? glm::normalize(random_vector(random)) : glm::dvec3(a.axes[static_cast<int>(trial % 3)]);
    const double gap = std::pow(10.0, -1.0 - static_cast<double>(trial % 15)) * (random() % 2 ? 1.0 : -1.0);
    const double distance = touching_distance(a, b, direction) + gap;
    b.center = distance * direction;
    if (kind.float_centers) b.center = glm::dvec3(glm::vec3(b.center));
    pairs.first.push_back(a);
    pairs.second.push_back(b);
    pairs.truth.push_back(boxes_meet(a, b));
}

std::uint64_t count_wrong(const PairsToAsk& pairs, bool batch) {
    std::vector<std::uint8_t> answers(pairs.truth.size());
    if (batch)
        collide::intersects(pairs.first, pairs.second, answers);
    else
        for (std::size_t i = 0; i < answers.size(); ++i)
            answers[i] = collide::intersects(pairs.first[i], pairs.second[i]);
    std::uint64_t wrong = 0;
    for (std::size_t i = 0; i < answers.size(); ++i) wrong += pairs.truth[i] != answers[i];
    return wrong;
}

VerifyRow wrong_answers(const Class& kind, const VerifyOptions& options, bool batch) {
    Engine random(options.seed);
    const std::uint64_t trials = std::max<std::uint64_t>(100, options.trials / 20);
    std::uint64_t wrong = 0;
    for (std::uint64_t begin = 0; begin < trials; begin += kPairsAtOnce) {
        PairsToAsk pairs;
        for (std::uint64_t trial = begin; trial < std::min(trials, begin + kPairsAtOnce); ++trial)
            add_pair(kind, trial, random, pairs);
        wrong += count_wrong(pairs, batch);
    }
    return none_row("boxes, " + std::string(kind.name) + (batch ? ", in batches" : ", one by one") +
                        ", gaps of 1e-1 to 1e-15: " + std::to_string(trials) + " answers, none wrong",
                    "separating axes in exact numbers", trials, wrong);
}

}  // namespace

std::vector<VerifyRow> verify_collide(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    for (const Class& kind : {Class{"generic", false, false}, Class{"generic, centres in float", false, true},
                              Class{"nearly parallel (1e-1 to 1e-12 rad)", true, false},
                              Class{"nearly parallel (1e-1 to 1e-12 rad), centres in float", true, true}})
        for (const bool batch : {false, true}) rows.push_back(wrong_answers(kind, options, batch));
    for (VerifyRow& row : verify_convex(options)) rows.push_back(std::move(row));
    return rows;
}

}  // namespace crofton::cli
