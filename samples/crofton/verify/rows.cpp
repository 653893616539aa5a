// SPDX-License-Identifier: MIT
#include "rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "json/json.hpp"

namespace crofton::cli {
namespace {

// Without an error any difference is infinitely significant, and a NaN anywhere never passes for agreement.
double score(double difference, double standard_error) {
    if (difference == 0.0) return 0.0;
    if (standard_error == 0.0) return std::copysign(std::numeric_limits<double>::infinity(), difference);
    return difference / standard_error;
}

VerifyRow row(std::string claim, std::string source, double predicted, double measured, double standard_error,
              double z) {
    VerifyRow result{std::move(claim), std::move(source), predicted, measured, standard_error, z, std::abs(z) <= kMaxZ};
    if (predicted != 0.0) result.resolution = (kMaxZ + 2.0) * standard_error / std::abs(predicted);
    return result;
}

std::string six_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string percent(double part, std::uint64_t cases) {
    if (!(part < 10.0)) return cases > 0 ? "1 of " + std::to_string(cases) : "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.2g %%", 100.0 * part);
    return text;
}

}  // namespace

VerifyRow measured_row(std::string claim, std::string source, double predicted, double measured,
                       double standard_error) {
    return row(std::move(claim), std::move(source), predicted, measured, standard_error,
               score(measured - predicted, standard_error));
}

VerifyRow computed_row(std::string claim, std::string source, double predicted, double measured, double tolerance) {
    VerifyRow result = measured_row(std::move(claim), std::move(source), predicted, measured, tolerance / kMaxZ);
    if (predicted != 0.0) result.resolution = tolerance / std::abs(predicted);
    return result;
}

VerifyRow at_most_row(std::string claim, std::string source, double bound, double measured, double standard_error) {
    const double excess = measured <= bound ? 0.0 : measured - bound;  // a NaN stays one
    VerifyRow result =
        row(std::move(claim), std::move(source), bound, measured, standard_error, score(excess, standard_error));
    if (bound != 0.0)
        result.resolution = (std::max(0.0, bound - measured) + (kMaxZ + 2.0) * standard_error) / std::abs(bound);
    return result;
}

VerifyRow wrong_row(std::string claim, std::string source, double predicted, double measured, double standard_error) {
    VerifyRow result =
        measured_row("wrong, must be rejected: " + claim, std::move(source), predicted, measured, standard_error);
    result.holds = std::abs(result.z) > kMaxZ;
    result.resolution = std::numeric_limits<double>::infinity();
    return result;
}

VerifyRow none_row(std::string claim, std::string source, std::uint64_t cases, std::uint64_t wrong) {
    if (cases == 0) return untried_row(std::move(claim), std::move(source));
    VerifyRow result = computed_row(std::move(claim), std::move(source), 0.0, static_cast<double>(wrong), 0.0);
    result.cases = cases;
    return result;
}

VerifyRow untried_row(std::string claim, std::string source) {
    return computed_row("could not be tried: " + claim, std::move(source), 1.0, 0.0, 0.0);
}

Share share_of(std::uint64_t hits, std::uint64_t trials) {
    if (trials == 0) return {std::nan(""), std::nan("")};
    const double n = static_cast<double>(trials), p = static_cast<double>(hits) / n;
    return {p, std::sqrt(p * (1.0 - p) / n)};
}

std::string table_of(const std::vector<VerifyRow>& rows) {
    // In characters, not bytes: continuation bytes of UTF-8 take no room.
    const auto width_of = [](const std::string& text) {
        return static_cast<std::size_t>(
            std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
    };
    std::size_t claim_width = 5, source_width = 6;
    for (const VerifyRow& r : rows) {
        claim_width = std::max(claim_width, width_of(r.claim));
        source_width = std::max(source_width, width_of(r.source));
    }
    const auto padded = [&](const std::string& text, std::size_t width) {
        return text + std::string(width - width_of(text) + 2, ' ');
    };
    const auto right = [](const std::string& text) {
        return std::string(text.size() < 14 ? 14 - text.size() : 1, ' ') + text;
    };
    std::string table = padded("claim", claim_width) + padded("source", source_width) + right("predicted") +
                        right("measured") + right("std. error") + right("z") + right("resolves") + "  holds\n";
    for (const VerifyRow& r : rows)
        table += padded(r.claim, claim_width) + padded(r.source, source_width) + right(six_digits(r.predicted)) +
                 right(six_digits(r.measured)) + right(six_digits(r.standard_error)) + right(six_digits(r.z)) +
                 right(percent(r.resolution, r.cases)) + (r.holds ? "  yes\n" : "  NO\n");
    return table;
}

Json json_of(const std::vector<VerifyRow>& rows) {
    Json result = Json::array();
    for (const VerifyRow& r : rows) {
        Json z = nullptr;
        if (std::isfinite(r.z)) z = r.z;
        Json resolution = nullptr;
        if (std::isfinite(r.resolution)) resolution = r.resolution;
        result.push_back({{"claim", r.claim},
                          {"source", r.source},
                          {"predicted", r.predicted},
                          {"measured", r.measured},
                          {"standard_error", r.standard_error},
                          {"z", z},
                          {"resolution", resolution},
                          {"holds", r.holds}});
        if (r.cases > 0) result.back()["cases"] = r.cases;
    }
    return result;
}

}  // namespace crofton::cli
