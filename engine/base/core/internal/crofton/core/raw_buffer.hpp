// SPDX-License-Identifier: MIT
// Memory for results whose number is known only afterwards.
#pragma once
#include <algorithm>
#include <crofton/core/memory.hpp>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace crofton {

// Room for values that are written before they are read. It is not filled, so that taking much more than is used costs
// nothing: the system gives a page when it is first written.
template <class T>
class RawBuffer {
  public:
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

    RawBuffer() = default;
    ~RawBuffer() { release(); }
    RawBuffer(RawBuffer&& other) noexcept
        : values_(std::exchange(other.values_, nullptr)), size_(std::exchange(other.size_, 0)) {}
    RawBuffer& operator=(RawBuffer&& other) noexcept {
        std::swap(values_, other.values_);
        std::swap(size_, other.size_);
        return *this;
    }

    [[nodiscard]] T* data() const { return values_; }
    [[nodiscard]] std::size_t size() const { return size_; }
    // Returns room for at least so many, of which the first `kept` stay as they are. Others are not set.
    T* room(std::size_t size, std::size_t kept = 0) {
        if (size <= size_) return values_;
        const std::size_t larger = std::max(size, size_ + size_ / 2);
        T* const values = Allocator<T>().allocate(larger);
        std::copy_n(values_, kept, values);
        release();
        values_ = values;
        size_ = larger;
        return values_;
    }

  private:
    void release() {
        if (values_ != nullptr) Allocator<T>().deallocate(values_, size_);
    }

    T* values_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace crofton
