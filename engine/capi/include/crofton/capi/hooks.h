/* SPDX-License-Identifier: MIT */
/* The host's allocator, job system, log and assert handler. */
#ifndef CROFTON_CAPI_HOOKS_H
#define CROFTON_CAPI_HOOKS_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* From any thread. `allocate` returns memory aligned to `alignment`, a power of two; NULL ends the program. */
typedef struct crofton_memory_hooks {
    size_t size;
    void* user;
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*release)(void* user, void* memory, size_t bytes, size_t alignment);
} crofton_memory_hooks;

/* Call it before anything is created: memory is released through the hooks in force. NULL restores the default. */
CROFTON_API crofton_status crofton_set_memory_hooks(const crofton_memory_hooks* hooks);

/* Does the items [begin, end); `worker` < concurrency, and no two run at once for one worker. */
typedef void (*crofton_range_task)(void* task_data, size_t begin, size_t end, uint32_t worker);

/* The host's job system, given to each call that can use one (or NULL: on the calling thread alone). `parallel_for`
 * calls task(task_data, …) for the ranges [0, grain), [grain, 2 grain), … of [0, count), the last one cut short, in any
 * order and on any threads, and returns when all are done. Results do not depend on it. */
typedef struct crofton_jobs {
    size_t size;
    void* user;
    uint32_t concurrency; /* at least 1 */
    void (*parallel_for)(void* user, size_t count, size_t grain, crofton_range_task task, void* task_data);
} crofton_jobs;

typedef enum crofton_log_level {
    CROFTON_LOG_DEBUG = 0,
    CROFTON_LOG_INFO = 1,
    CROFTON_LOG_WARNING = 2,
    CROFTON_LOG_ERROR = 3
} crofton_log_level;

typedef void (*crofton_log_hook)(void* user, uint32_t level, const char* message);
/* NULL restores the default: warnings and errors to stderr. */
CROFTON_API crofton_status crofton_set_log_hook(crofton_log_hook hook, void* user);
/* `level` is a crofton_log_level. Through the hook in force, as the library's own messages go. */
CROFTON_API crofton_status crofton_log(uint32_t level, const char* message);

typedef void (*crofton_assert_hook)(const char* condition, const char* message, const char* file, int line);
/* Called for callers' mistakes in builds with CROFTON_ASSERTS. NULL restores the default: print and abort. */
CROFTON_API crofton_status crofton_set_assert_hook(crofton_assert_hook hook);

/* With checks on, using a handle from two threads where that is forbidden gives CROFTON_BUSY. On by default in builds
 * with CROFTON_ASSERTS, off in others. Switch it while no other call is running. */
CROFTON_API crofton_status crofton_set_thread_checks(int on);

#ifdef __cplusplus
}
#endif
#endif
