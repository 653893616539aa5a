// SPDX-License-Identifier: MIT
// The rows of `crofton verify`: a claim, its prediction, the measurement, and the verdict.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "json/json.hpp"

namespace crofton::cli {

// A value may miss its prediction by this many standard errors. For a normal error that happens once in 16,000 rows.
inline constexpr double kMaxZ = 4.0;

struct VerifyRow {
    std::string claim;   // a sentence; of a claim that is wrong on purpose it says that it must be rejected
    std::string source;  // where it is made: "paper, Theorem 1", "theory.md (1)"
    double predicted = 0.0;
    double measured = 0.0;
    double standard_error =
        0.0;  // of `measured`; for computed values the allowed error / kMaxZ, so that one rule judges both
    double z = 0.0;
    bool holds = false;       // is `claim` borne out? For a wrong claim: was it rejected?
    std::uint64_t cases = 0;  // that the claim was tried on, where they were counted
    // The smallest relative error of `predicted` that this row would see: kMaxZ + 2 standard errors, so that 39 of 40
    // seeds reject it; of a computed row the tolerance; of a bound how far `measured` would have to rise. Infinite
    // where the prediction is 0 or the claim is wrong on purpose.
    double resolution = std::numeric_limits<double>::infinity();
};

struct VerifyOptions {
    std::uint64_t trials = 200'000;  // random queries per row; dearer rows take a fixed fraction of it
    std::uint64_t seed = 1;
};

// A sampled value: z = (measured − predicted)/standard_error, holds while |z| ≤ kMaxZ.
[[nodiscard]] VerifyRow measured_row(std::string claim, std::string source, double predicted, double measured,
                                     double standard_error);

// A computed value, with no chance in it: holds while |measured − predicted| ≤ tolerance.
[[nodiscard]] VerifyRow computed_row(std::string claim, std::string source, double predicted, double measured,
                                     double tolerance);

// A sampled value that must not exceed `bound`; z is 0 below it.
[[nodiscard]] VerifyRow at_most_row(std::string claim, std::string source, double bound, double measured,
                                    double standard_error);

// A claim known to be wrong: as measured_row, but holds (that is: the test has teeth) only where |z| > kMaxZ.
// The claim's text is prefixed with "wrong, must be rejected: ".
[[nodiscard]] VerifyRow wrong_row(std::string claim, std::string source, double predicted, double measured,
                                  double standard_error);

// A row for something that must never happen: it holds if `wrong` is 0 and at least one case was tried.
[[nodiscard]] VerifyRow none_row(std::string claim, std::string source, std::uint64_t cases, std::uint64_t wrong);

// A row that could not be tried, because the engine returned an error or nothing to count. It does not hold.
[[nodiscard]] VerifyRow untried_row(std::string claim, std::string source);

// The share of `trials` that were hits, with its binomial standard error.
struct Share {
    double value = 0.0;
    double standard_error = 0.0;
};
[[nodiscard]] Share share_of(std::uint64_t hits, std::uint64_t trials);

// An aligned table for people, and an array of {claim, source, predicted, measured, standard_error, z, resolution,
// holds}, and cases where they were counted; z and resolution are null where they are not finite.
[[nodiscard]] std::string table_of(const std::vector<VerifyRow>& rows);
[[nodiscard]] Json json_of(const std::vector<VerifyRow>& rows);

}  // namespace crofton::cli
