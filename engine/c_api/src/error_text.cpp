// SPDX-License-Identifier: MIT
// Keeps each thread's last error message.
#include <crofton/capi/crofton.h>

#include <crofton/core/version.hpp>
#include <cstdio>
#include <string>

#include <crofton/capi/call.hpp>

namespace crofton::capi {
namespace {

// Fixed room: reporting a failure must not fail.
struct LastError {
    char text[512] = "";
    std::uint64_t item = kNoItem;
};
thread_local LastError last_error;

}  // namespace

crofton_status report(crofton_status status, const char* function, const char* message, std::uint64_t item) {
    std::snprintf(last_error.text, sizeof last_error.text, "%s: %s", function, message);
    last_error.item = item;
    return status;
}

crofton_status report_argument(crofton_status status, const char* function, const char* argument, const char* fault) {
    char message[128];
    std::snprintf(message, sizeof message, "%s %s", argument, fault);
    return report(status, function, message);
}

crofton_status report(const Error& error, const char* function) {
    // Statuses 1 to 13 are the codes, in their order.
    static_assert(static_cast<int>(ErrorCode::internal) + 1 == CROFTON_INTERNAL);
    static_assert(static_cast<int>(ErrorCode::parse) + 1 == CROFTON_PARSE);
    const auto status = error.code == ErrorCode::out_of_memory
                            ? CROFTON_OUT_OF_MEMORY
                            : static_cast<crofton_status>(static_cast<int>(error.code) + 1);
    return report(status, function, error.message.c_str(), error.item);
}

crofton_status of_item(crofton_status status, std::uint64_t item) {
    if (status != CROFTON_OK) last_error.item = item;
    return status;
}

}  // namespace crofton::capi

const char* crofton_last_error() {
    return crofton::capi::last_error.text;
}
std::uint64_t crofton_last_error_item() {
    return crofton::capi::last_error.item;
}
std::uint32_t crofton_api_version() {
    return CROFTON_API_VERSION;
}
const char* crofton_version_string() {
    return crofton::version_string();
}

const char* crofton_status_name(int status) {
    switch (status) {
        case CROFTON_OK:
            return "ok";
        case CROFTON_BAD_HANDLE:
            return "bad handle";
        case CROFTON_WRONG_SIZE:
            return "wrong struct size";
        case CROFTON_BUSY:
            return "busy";
        case CROFTON_OUT_OF_MEMORY:
            return crofton::to_string(crofton::ErrorCode::out_of_memory);
        default:
            break;
    }
    if (status < 1 || status > CROFTON_INTERNAL) return "unknown status";
    return crofton::to_string(static_cast<crofton::ErrorCode>(status - 1));
}
