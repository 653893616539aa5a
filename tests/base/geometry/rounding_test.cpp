// SPDX-License-Identifier: MIT
// That the compiler rounds where the source says so: g++ 12 does not, unless told (cmake/CroftonTargets.cmake).
#include <doctest/doctest.h>
#include <bit>
#include <crofton/sampling/sampling.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace {

[[gnu::noinline]] void round_two(const double* from, double* to) {
    const float first = static_cast<float>(from[0]), second = static_cast<float>(from[1]);
    to[0] = static_cast<double>(first);
    to[1] = static_cast<double>(second);
}
[[gnu::noinline]] glm::dvec2 rounded(const glm::dvec2& v) {
    return glm::dvec2(glm::vec2(v));
}
[[gnu::noinline]] glm::dvec3 rounded(const glm::dvec3& v) {
    return glm::dvec3(glm::vec3(v));
}

bool is_float(double x) {
    return (std::bit_cast<std::uint64_t>(x) & 0x1fffffffu) == 0;  // of 52 bits 23 are left
}

}  // namespace

TEST_SUITE("geometry/rounding") {
    TEST_CASE("doubles that become floats, side by side, are rounded") {
        crofton::sampling::Random random(1);
        for (int i = 0; i < 100; ++i) {
            const double numbers[2] = {random.uniform(), random.uniform()};
            double two[2];
            round_two(numbers, two);
            CHECK(is_float(two[0]));
            CHECK(is_float(two[1]));
            const glm::dvec2 pair = rounded(glm::dvec2(numbers[0], numbers[1]));
            CHECK(is_float(pair.x));
            CHECK(is_float(pair.y));
            const glm::dvec3 triple = rounded(glm::dvec3(numbers[0], numbers[1], random.uniform()));
            for (int k = 0; k < 3; ++k) CHECK(is_float(triple[k]));
        }
    }
}
