/* SPDX-License-Identifier: MIT */
/* Statuses, their text, and versions. */
#ifndef CROFTON_CAPI_BASE_H
#define CROFTON_CAPI_BASE_H
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(CROFTON_SHARED)
#define CROFTON_API __declspec(dllimport)
#elif defined(__GNUC__)
#define CROFTON_API __attribute__((visibility("default")))
#else
#define CROFTON_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Counts breaking changes of these headers. Equal numbers: the binaries fit together. */
#define CROFTON_API_VERSION 2u
#define CROFTON_NO_ITEM UINT64_MAX
#define CROFTON_NONE UINT32_MAX /* no parent, no id */

typedef enum crofton_status {
    CROFTON_OK = 0,
    CROFTON_INVALID_ARGUMENT = 1, /* a parameter outside its documented range, or NULL where that is not allowed */
    CROFTON_NON_FINITE = 2,       /* NaN or infinity where a finite number is needed */
    CROFTON_OUT_OF_RANGE = 3,     /* an index or a size beyond its limit */
    CROFTON_DEGENERATE = 4,       /* geometry without the extent or rank the operation needs */
    CROFTON_EMPTY = 5,            /* nothing to work on */
    CROFTON_UNSUPPORTED = 6,      /* well-formed, but not something we handle */
    CROFTON_IO = 7,               /* a file could not be read or written */
    CROFTON_PARSE = 8,            /* a file's contents are damaged or not of its format */
    CROFTON_CANCELLED = 9,        /* a callback asked to stop */
    CROFTON_BUDGET_EXCEEDED = 10, /* a time or memory budget ran out before any usable result */
    CROFTON_UNAVAILABLE = 11,     /* a device or driver is missing */
    CROFTON_STALE_HANDLE = 12,    /* an id of something that has been removed */
    CROFTON_INTERNAL = 13,        /* our mistake: please report it */
    CROFTON_BAD_HANDLE = 14,      /* NULL, of another kind, or destroyed already */
    CROFTON_WRONG_SIZE = 15,      /* a struct's `size` is not what this library knows */
    CROFTON_BUSY = 16,            /* another thread is using the handle (with thread checks on) */
    CROFTON_OUT_OF_MEMORY = 17    /* the memory hook had none; the call changed nothing */
} crofton_status;

/* What went wrong in this thread's last failed call, and which item of its input (CROFTON_NO_ITEM: none in particular).
 * The text stays valid until the thread's next failed call. */
CROFTON_API const char* crofton_last_error(void);
CROFTON_API uint64_t crofton_last_error_item(void);
CROFTON_API const char* crofton_status_name(int status); /* "unknown status" for numbers that are none */

/* Of the library that is linked, as opposed to the headers. */
CROFTON_API uint32_t crofton_api_version(void);
CROFTON_API const char* crofton_version_string(void); /* "major.minor.patch" */

#ifdef __cplusplus
}
#endif
#endif
