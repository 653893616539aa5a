// SPDX-License-Identifier: MIT
// Checks of the numbers that a call is given. The message names the argument: "max_distance is negative".
#pragma once
#include <cmath>

#include <crofton/capi/call.hpp>

namespace crofton::capi {

// Finite. `name` is the argument's.
[[nodiscard]] inline crofton_status check_finite(double value, const char* name, const char* function) {
    return std::isfinite(value) ? CROFTON_OK
                                : report_argument(CROFTON_NON_FINITE, function, name, "is NaN or infinite");
}

// A limit of a length, which may be infinite: not NaN and not negative.
[[nodiscard]] inline crofton_status check_limit(double value, const char* name, const char* function) {
    if (std::isnan(value)) return report_argument(CROFTON_NON_FINITE, function, name, "is NaN");
    return value < 0.0 ? report_argument(CROFTON_INVALID_ARGUMENT, function, name, "is negative") : CROFTON_OK;
}

// A length, radius or margin: finite and not negative.
[[nodiscard]] inline crofton_status check_length(double value, const char* name, const char* function) {
    CROFTON_CHECK(check_finite(value, name, function));
    return check_limit(value, name, function);
}

// Three coordinates.
[[nodiscard]] inline crofton_status check_place(const double* place, const char* name, const char* function) {
    CROFTON_CHECK(check_pointer(place, function));
    for (int k = 0; k < 3; ++k) CROFTON_CHECK(check_finite(place[k], name, function));
    return CROFTON_OK;
}

}  // namespace crofton::capi
