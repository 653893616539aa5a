// SPDX-License-Identifier: MIT
// The frames that a search begins with: orthonormal, also where the points are nearly on one line.
#include <doctest/doctest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "search/local_search.hpp"

using namespace crofton;

TEST_SUITE("fit/local_search") {
    TEST_CASE("frames of nearly straight points are orthonormal, however much rounding tilts the normals of slivers") {
        std::mt19937 random(48);
        std::uniform_real_distribution<double> unit(-0.5, 0.5);
        std::size_t found = 0;
        for (const double thickness : {1.0, 1e-6, 1e-9, 1e-11, 1e-12, 1e-13, 1e-14, 3e-15, 1e-15})
            for (int run = 0; run < 300; ++run) {
                const glm::dvec3 along = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
                Vector<glm::dvec3> points;
                for (int i = 0; i < 20; ++i)
                    points.push_back(unit(random) * along +
                                     thickness * glm::dvec3(unit(random), unit(random), unit(random)));
                Vector<glm::dmat3> frames;
                fit::tetrahedral_frames(points, frames);
                found += frames.size();
                double deviation = 0.0;
                for (const glm::dmat3& frame : frames)
                    for (int i = 0; i < 3; ++i)
                        for (int j = i; j < 3; ++j)
                            deviation =
                                std::max(deviation, std::abs(glm::dot(frame[i], frame[j]) - (i == j ? 1.0 : 0.0)));
                CHECK(deviation < 2e-12);
            }
        CHECK(found > 9 * 300);
    }
}
