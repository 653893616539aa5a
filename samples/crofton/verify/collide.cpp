// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "topics.hpp"

namespace crofton::cli {
namespace {

__extension__ typedef __int128 Int128;
using Engine = std::mt19937_64;

// Boxes on a lattice, so that the separating-axis theorem can be put into integers of 128 bits: axes in steps of 2^-22,
// extents of 2^-24, offsets of 2^-52. Reaches are then multiples of 2^-90, distances of 2^-96, both below 2^8.
constexpr int kAxisBits = 22, kExtentBits = 24, kOffsetBits = 52;
constexpr int kRadiusToDistance = kOffsetBits - kAxisBits - kExtentBits;

double on_lattice(double value, int bits) {
    return std::ldexp(std::nearbyint(std::ldexp(value, bits)), -bits);
}
Int128 integer(double value, int bits) {
    return static_cast<Int128>(std::ldexp(value, bits));
}
Int128 magnitude(Int128 value) {
    return value < 0 ? -value : value;
}

bool meet_in_integers(const Obb& a, const Obb& b) {
    Int128 edge[6][3], half[6], offset[3];
    for (int k = 0; k < 6; ++k) {
        const Obb& box = k < 3 ? a : b;
        half[k] = integer(static_cast<double>(box.half_extents[k % 3]), kExtentBits);
        for (int i = 0; i < 3; ++i) edge[k][i] = integer(static_cast<double>(box.axes[k % 3][i]), kAxisBits);
    }
    for (int i = 0; i < 3; ++i) offset[i] = integer(b.center[i] - a.center[i], kOffsetBits);
    for (int p = 0; p < 6; ++p)
        for (int q = p + 1; q < 6; ++q) {
            Int128 n[3], distance = 0, projected_radius = 0;
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                n[i] = edge[p][j] * edge[q][k] - edge[p][k] * edge[q][j];
                distance += n[i] * offset[i];
            }
            for (int g = 0; g < 6; ++g)
                if (g != p && g != q)
                    projected_radius += half[g] * magnitude(edge[g][0] * n[0] + edge[g][1] * n[1] + edge[g][2] * n[2]);
            if (magnitude(distance) > projected_radius << kRadiusToDistance) return false;
        }
    return true;
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

Obb lattice_box(Engine& random, const glm::dquat& frame) {
    Obb box;
    const glm::dmat3 rotation = glm::mat3_cast(frame);
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) box.axes[k][i] = static_cast<float>(on_lattice(rotation[k][i], kAxisBits));
    for (int k = 0; k < 3; ++k)
        box.half_extents[k] = static_cast<float>(on_lattice(0.55 + 0.45 * random_vector(random).x, 16));
    return box;
}

// Where b, starting at a's centre, leaves a along `direction`, by bisection with the integers themselves.
double touching_distance(const Obb& a, Obb b, const glm::dvec3& direction) {
    double meeting = 0.0, apart = 8.0;
    for (int step = 0; step < 52; ++step) {
        const double middle = 0.5 * (meeting + apart);
        for (int i = 0; i < 3; ++i) b.center[i] = on_lattice(middle * direction[i], kOffsetBits);
        (meet_in_integers(a, b) ? meeting : apart) = middle;
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
    const Obb a = lattice_box(random, frame);
    Obb b = lattice_box(random, kind.parallel ? turn * frame : random_rotation(random));
    const glm::dvec3 direction =
        trial % 2 ? glm::normalize(random_vector(random)) : glm::dvec3(a.axes[static_cast<int>(trial % 3)]);
    const double gap = std::pow(10.0, -1.0 - static_cast<double>(trial % 15)) * (random() % 2 ? 1.0 : -1.0);
    const double distance = touching_distance(a, b, direction) + gap;
    for (int i = 0; i < 3; ++i) b.center[i] = on_lattice(distance * direction[i], kOffsetBits);
    // Floats of this size lie on the lattice, or are small enough to be put there.
    if (kind.float_centers)
        for (int i = 0; i < 3; ++i)
            b.center[i] = on_lattice(static_cast<double>(static_cast<float>(b.center[i])), kOffsetBits);
    pairs.first.push_back(a);
    pairs.second.push_back(b);
    pairs.truth.push_back(meet_in_integers(a, b));
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
                    "separating axes in 128-bit integers", trials, wrong);
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
