// SPDX-License-Identifier: MIT
// How many pairs of polytopes that nearly touch does each library tell wrong? The pairs are those of `crofton verify
// collide`, without triangles, and so is the truth: exact arithmetic. Prints a CSV: a row for each library and offset,
// a column for each decade of gap or overlap. These are proven of each pair. Sizes are about 1.
//   bench_convex_counts [PAIRS, 1000] | grep -v ^WARNING
// PAIRS are those in each decade at each offset. Libraries that Debian lacks are asked where CMake finds them
// installed: coal, Jolt, box3d (-DCMAKE_PREFIX_PATH=…). Where a hull's face is too narrow ODE writes warnings to the
// same place.
#include <cmath>
#include <crofton/convex/query.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "convex_peers.hpp"
#include "verify/convex_pairs.hpp"
#include "verify/exact_shapes.hpp"

#if defined(CROFTON_HAVE_ODE)
#include <ode/ode.h>
#endif

namespace crofton::bench {
namespace {

using convex::ShapeAtPose;

bool crofton_meets(const ShapeAtPose& a, const ShapeAtPose& b) {
    return convex::intersects(a, b);
}

struct Library {
    const char* name;
    bool (*meets)(const ShapeAtPose&, const ShapeAtPose&);
    std::string wrong;  // the row's cells
    int wrong_here = 0;
};

bool answers_wrong(const Library& library, const ShapeAtPose& a, const ShapeAtPose& b, bool truth) {
    try {
        return library.meets(a, b) != truth;
    } catch (const std::exception&) {
        return true;
    }
}

bool has_triangle(const cli::ConvexPairs::Pair& pair) {
    return pair.a.kind() == convex::Kind::triangle || pair.b.kind() == convex::Kind::triangle;
}

// Whether the gap of two shapes, or their depth, is proven to lie between a tenth of `most` and `most`. A pair that was
// pushed together by so much may slide along an edge instead and touch within rounding, or meet more deeply.
bool lies_in_decade(const ShapeAtPose& a, const ShapeAtPose& b, bool meet, double most) {
    double lower = 0.0, upper = 0.0;
    if (meet) {
        const convex::Penetration p = convex::penetration(a, b);
        lower = p.lower, upper = p.upper;
    } else {
        const convex::Distance d = convex::distance(a, b);
        lower = d.lower, upper = d.upper;
    }
    return lower >= 0.1 * most && upper <= most;
}

void count(std::vector<Library>& libraries, int decade, double offset, int pairs) {
    cli::ConvexPairs random(static_cast<std::uint64_t>(decade) * 1000 + static_cast<std::uint64_t>(offset));
    for (Library& library : libraries) library.wrong_here = 0;
    for (int i = 0; i < pairs;) {
        const double gap = std::pow(10.0, -decade) * random.number(0.1, 1.0) * (random.bits() % 2 == 0 ? 1.0 : -1.0);
        const cli::ConvexPairs::Pair pair = random.next(32, gap, offset);
        if (has_triangle(pair)) continue;
        const ShapeAtPose a = pair.placed_a(), b = pair.placed_b();
        const bool truth = cli::meet_exactly(a, b, pair.normal);
        if (!lies_in_decade(a, b, truth, std::pow(10.0, -decade))) continue;
        ++i;
        for (Library& library : libraries) library.wrong_here += answers_wrong(library, a, b, truth);
    }
    for (Library& library : libraries) library.wrong += "," + std::to_string(library.wrong_here);
}

}  // namespace
}  // namespace crofton::bench

int main(int argc, char** argv) {
    using namespace crofton::bench;
    const int pairs = argc > 1 ? std::atoi(argv[1]) : 1000;
    if (pairs < 1) {
        std::fputs("bench_convex_counts: the number of pairs is not above 0\n", stderr);
        return 2;
    }
#if defined(CROFTON_HAVE_ODE)
    dInitODE2(0);
    dSetMessageHandler([](int, const char*, va_list) {});
#endif
    std::printf("library,offset,pairs a column");
    for (int decade = 1; decade <= 12; ++decade) std::printf(",1e-%d", decade);
    std::printf("\n");
    for (const double offset : {0.0, 1e3, 1e7}) {
        std::vector<Library> libraries{{"Crofton", crofton_meets, {}}};
#if defined(CROFTON_HAVE_FCL)
        libraries.push_back({"FCL 0.7 with libccd 2.1", fcl_meets, {}});
#endif
#if defined(CROFTON_HAVE_BULLET)
        libraries.push_back({"Bullet 3.24 in float", bullet_meets, {}});
#endif
#if defined(CROFTON_HAVE_ODE)
        libraries.push_back({"ODE 0.16 in double", ode_meets, {}});
#endif
#if defined(CROFTON_HAVE_COAL)
        libraries.push_back({"Coal 3.0 in double", coal_meets, {}});
#endif
#if defined(CROFTON_HAVE_JOLT)
        libraries.push_back({"Jolt 5.5 in float", jolt_meets, {}});
#endif
#if defined(CROFTON_HAVE_BOX3D)
        libraries.push_back({"box3d 0.1 in float", box3d_meets, {}});
#endif
        for (int decade = 1; decade <= 12; ++decade) count(libraries, decade, offset, pairs);
        for (const Library& library : libraries)
            std::printf("%s,%g,%d%s\n", library.name, offset, pairs, library.wrong.c_str());
    }
#if defined(CROFTON_HAVE_ODE)
    dCloseODE();
#endif
    return 0;
}
