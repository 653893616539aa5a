// SPDX-License-Identifier: MIT
// What every function of the C API does first and last: look at its handles and structs, and leave word of a failure.
#pragma once
#include <crofton/capi/base.h>

#include <atomic>
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/recovery.hpp>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

namespace crofton::capi {

// Keeps `message` and `item` for this thread's crofton_last_error; returns `status`.
crofton_status report(crofton_status status, const char* function, const char* message, std::uint64_t item = kNoItem);
crofton_status report(const Error& error, const char* function);
// "argument fault", such as "radius is negative".
crofton_status report_argument(crofton_status status, const char* function, const char* argument, const char* fault);

// `status`, which has just been reported if it is a failure: that of item number `item`.
[[nodiscard]] crofton_status of_item(crofton_status status, std::uint64_t item);

[[nodiscard]] inline crofton_status status_of(const Result<void>& result, const char* function) {
    return result ? CROFTON_OK : report(result.error(), function);
}

extern std::atomic<bool> thread_checks;

// The first member of every handle's struct. `kind` is a constant of the type while the handle lives, and 0 afterwards.
struct Header {
    std::uint32_t kind;
    mutable std::atomic<std::int32_t> users{0};  // −1: one that writes; counted only with thread checks on
};

// How a call may share a handle.
enum class Access : std::uint8_t { shared, exclusive };

// Holds a handle for the length of a call, if it may be used now.
template <Access kAccess>
class Use {
  public:
    template <class Handle>
    Use(Handle* handle, const char* function) {
        if (!handle)
            status_ = report(CROFTON_BAD_HANDLE, function, "the handle is NULL");
        else if (handle->header.kind != Handle::kKind)
            status_ = report(CROFTON_BAD_HANDLE, function, "not a handle of this kind, or destroyed already");
        else if (thread_checks.load(std::memory_order_relaxed))
            enter(handle->header, function);
    }
    ~Use() {
        if (entered_) leave();
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    [[nodiscard]] bool failed() const { return status_ != CROFTON_OK; }
    [[nodiscard]] crofton_status status() const { return status_; }

  private:
    void enter(const Header& header, const char* function) {
        std::int32_t before = 0;
        const bool exclusive = kAccess == Access::exclusive;
        while (!header.users.compare_exchange_weak(before, exclusive ? -1 : before + 1, std::memory_order_acquire))
            if (before < 0 || (exclusive && before > 0)) {
                status_ = report(CROFTON_BUSY, function, "another thread is using this handle");
                return;
            }
        entered_ = &header;
    }
    void leave() {
        if (kAccess == Access::exclusive)
            entered_->users.store(0, std::memory_order_release);
        else
            entered_->users.fetch_sub(1, std::memory_order_release);
    }

    crofton_status status_ = CROFTON_OK;
    const Header* entered_ = nullptr;
};
using SharedUse = Use<Access::shared>;
using ExclusiveUse = Use<Access::exclusive>;

// The struct is there and of the size that this library knows.
template <class Struct>
[[nodiscard]] crofton_status check_struct(const Struct* argument, const char* function) {
    if (!argument) return report(CROFTON_INVALID_ARGUMENT, function, "a struct is NULL");
    if (argument->size != sizeof(Struct))
        return report(CROFTON_WRONG_SIZE, function, "a struct's `size` is not that of this version of the library");
    return CROFTON_OK;
}
template <class Struct>
[[nodiscard]] crofton_status check_optional(const Struct* argument, const char* function) {
    return argument ? check_struct(argument, function) : CROFTON_OK;
}

[[nodiscard]] inline crofton_status check_pointer(const void* pointer, const char* function) {
    return pointer ? CROFTON_OK : report(CROFTON_INVALID_ARGUMENT, function, "a pointer is NULL");
}
// `count` items of `width` elements, to be read. More than memory can hold are a mistake in the count.
template <class T>
[[nodiscard]] crofton_status check_array(const T* pointer, std::size_t count, const char* function,
                                         std::size_t width = 1) {
    if (!pointer && count > 0) return report(CROFTON_INVALID_ARGUMENT, function, "an array is NULL");
    if (count > PTRDIFF_MAX / (width * sizeof(T)))
        return report(CROFTON_OUT_OF_RANGE, function, "a count is larger than any array");
    return CROFTON_OK;
}
// Room for up to `capacity` items, to be written.
[[nodiscard]] inline crofton_status check_room(const void* pointer, std::size_t capacity, const char* function) {
    return pointer || capacity == 0 ? CROFTON_OK : report(CROFTON_INVALID_ARGUMENT, function, "an array is NULL");
}

// Where memory ends in `call`, the status says so; what the call had built is destroyed by then.
template <class Call>
[[nodiscard]] crofton_status recover(const char* function, Call&& call) {
    const detail::Recovery recovery;
    try {
        return call();
    } catch (const std::bad_alloc&) {
        return report(CROFTON_OUT_OF_MEMORY, function, "out of memory");
    }
}

// Handles live in the host's memory. Where there is none, `*handle` stays as it was.
template <class Handle, class... Arguments>
[[nodiscard]] crofton_status create(Handle** handle, const char* function, Arguments&&... arguments) {
    const detail::Recovery recovery;
    void* memory = detail::try_allocate(sizeof(Handle), alignof(Handle));
    try {
        if (!memory) throw std::bad_alloc();
        *handle = new (memory) Handle{{Handle::kKind}, std::forward<Arguments>(arguments)...};
        return CROFTON_OK;
    } catch (const std::bad_alloc&) {
        detail::release(memory, sizeof(Handle), alignof(Handle));
        return report(CROFTON_OUT_OF_MEMORY, function, "out of memory");
    }
}
template <class Handle>
[[nodiscard]] crofton_status destroy(Handle* handle, const char* function) {
    {
        const ExclusiveUse use(handle, function);
        if (use.failed()) return use.status();
        handle->header.kind = 0;
    }
    handle->~Handle();
    detail::release(handle, sizeof(Handle), alignof(Handle));
    return CROFTON_OK;
}

}  // namespace crofton::capi

// Returns from the calling function unless the check holds.
#define CROFTON_CHECK(check)                                                \
    do {                                                                    \
        if (const crofton_status s_ = (check); s_ != CROFTON_OK) return s_; \
    } while (false)

// Takes a handle to the end of the block, together with other readers or alone; returns from the calling function where
// that cannot be.
#define CROFTON_READ(handle)                                            \
    const ::crofton::capi::SharedUse use_of_##handle(handle, __func__); \
    CROFTON_CHECK(use_of_##handle.status())
#define CROFTON_CHANGE(handle)                                             \
    const ::crofton::capi::ExclusiveUse use_of_##handle(handle, __func__); \
    CROFTON_CHECK(use_of_##handle.status())
