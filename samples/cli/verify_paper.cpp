#include <crofton/measure/intrinsic_volumes.hpp>
#include <numbers>

#include "verify_topics.hpp"

namespace crofton::cli {

std::vector<VerifyRow> verify_paper(const VerifyOptions&) {
    const double pi = std::numbers::pi;
    std::vector<VerifyRow> rows;
    rows.push_back(computed_row("a unit ball grown by a unit ball is a ball of radius 2 (kinematic formula)",
                                "THEORY.md (1)", 32.0 / 3.0 * pi,
                                measure::kinematic_measure(measure::of_ball(1.0), measure::of_ball(1.0)), 1e-12));
    return rows;
}

}  // namespace crofton::cli
