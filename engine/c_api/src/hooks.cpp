// SPDX-License-Identifier: MIT
// Forwards messages, jobs and memory to the host's functions.
#include <crofton/capi/base.h>

#include <crofton/core/error.hpp>
#include <crofton/core/no_recovery.hpp>
#include <mutex>
#include <string>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>

namespace crofton::capi {

#if defined(CROFTON_ASSERTS)
std::atomic<bool> thread_checks{true};
#else
std::atomic<bool> thread_checks{false};
#endif

namespace {

struct LogHook {
    std::mutex mutex;
    crofton_log_hook hook = nullptr;
    void* user = nullptr;
};
LogHook& log_hook() {
    static LogHook hook;
    return hook;
}

void forward_log(void*, LogLevel level, std::string_view message) {
    crofton_log_hook hook;
    void* user;
    {
        const std::lock_guard lock(log_hook().mutex);
        hook = log_hook().hook;
        user = log_hook().user;
    }
    if (hook) hook(user, static_cast<std::uint32_t>(level), std::string(message).c_str());
}

}  // namespace

unsigned HostJobs::concurrency() const {
    return jobs_ ? jobs_->concurrency : 1;
}

void HostJobs::parallel_for(std::size_t count, std::size_t grain, RangeTask shape) {
    if (!jobs_) return serial_executor().parallel_for(count, grain, shape);
    const detail::NoRecovery host;
    jobs_->parallel_for(
        jobs_->user, count, grain,
        [](void* data, std::size_t begin, std::size_t end, std::uint32_t worker) {
            (*static_cast<const RangeTask*>(data))(begin, end, worker);
        },
        &shape);
}

crofton_status check_jobs(const crofton_jobs* jobs, const char* function) {
    CROFTON_CHECK(check_optional(jobs, function));
    if (jobs && (jobs->concurrency == 0 || !jobs->parallel_for))
        return report(CROFTON_INVALID_ARGUMENT, function, "jobs need a parallel_for and a concurrency of 1 or more");
    // Each worker may get memory of its own: a number that was never set would ask for all there is.
    if (jobs && jobs->concurrency > 65536)
        return report(CROFTON_OUT_OF_RANGE, function, "the concurrency of jobs is more than 65536");
    return CROFTON_OK;
}

}  // namespace crofton::capi

using namespace crofton;
using namespace crofton::capi;

crofton_status crofton_set_memory_hooks(const crofton_memory_hooks* hooks) {
    if (!hooks) {
        reset_memory_hooks();
        return CROFTON_OK;
    }
    CROFTON_CHECK(check_struct(hooks, __func__));
    if (!hooks->allocate || !hooks->release)
        return report(CROFTON_INVALID_ARGUMENT, __func__, "both allocate and release are needed");
    set_memory_hooks({hooks->allocate, hooks->release, hooks->user});
    return CROFTON_OK;
}

crofton_status crofton_set_log_hook(crofton_log_hook hook, void* user) {
    {
        const std::lock_guard lock(log_hook().mutex);
        log_hook().hook = hook;
        log_hook().user = user;
    }
    set_log_handler(hook ? forward_log : nullptr, nullptr);
    return CROFTON_OK;
}

crofton_status crofton_log(uint32_t level, const char* message) {
    CROFTON_CHECK(check_pointer(message, __func__));
    if (level > CROFTON_LOG_ERROR) return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown level");
    log(static_cast<LogLevel>(level), message);
    return CROFTON_OK;
}

crofton_status crofton_set_assert_hook(crofton_assert_hook hook) {
    set_assert_handler(hook);
    return CROFTON_OK;
}

crofton_status crofton_set_thread_checks(int on) {
    thread_checks = on != 0;
    return CROFTON_OK;
}
