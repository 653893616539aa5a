// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/memory.hpp>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#if defined(__unix__)
#include <sys/wait.h>
#include <unistd.h>
#endif

#include "aligned_memory.hpp"

using namespace crofton;

namespace {

struct Counts {
    std::size_t allocations = 0, releases = 0, live_bytes = 0;
};

void* counting_allocate(void* user, std::size_t bytes, std::size_t alignment) {
    auto* counts = static_cast<Counts*>(user);
    ++counts->allocations;
    counts->live_bytes += bytes;
    return testing::aligned_block(bytes, alignment);
}

void counting_release(void* user, void* memory, std::size_t bytes, std::size_t) {
    auto* counts = static_cast<Counts*>(user);
    ++counts->releases;
    counts->live_bytes -= bytes;
    testing::free_block(memory);
}

}  // namespace

TEST_SUITE("core/memory") {
    TEST_CASE("blocks of every size are aligned, usable to their last byte, and given back") {
        for (const std::size_t bytes : {std::size_t{1}, std::size_t{100}, (std::size_t{4} << 20) - 1,
                                        std::size_t{4} << 20, (std::size_t{9} << 20) + 5}) {
            auto* memory = static_cast<unsigned char*>(crofton::detail::allocate(bytes, 64));
            CHECK(reinterpret_cast<std::uintptr_t>(memory) % 64 == 0);
            memory[0] = memory[bytes - 1] = 7;
            CHECK(memory[bytes - 1] == 7);
            crofton::detail::release(memory, bytes, 64);
        }
    }

    TEST_CASE("a large block keeps an alignment that is coarser than a huge page") {
        constexpr std::size_t kBytes = std::size_t{8} << 20, kAlignment = std::size_t{4} << 20;
        auto* memory = static_cast<unsigned char*>(crofton::detail::allocate(kBytes, kAlignment));
        CHECK(reinterpret_cast<std::uintptr_t>(memory) % kAlignment == 0);
        memory[kBytes - 1] = 7;
        crofton::detail::release(memory, kBytes, kAlignment);
    }

    TEST_CASE("small blocks lie together, not each at the beginning of a huge page") {
        constexpr std::size_t kHugePage = std::size_t{2} << 20;
        void* blocks[100];
        int at_beginning = 0;
        for (void*& block : blocks) {
            block = crofton::detail::allocate(100, 64);
            at_beginning += reinterpret_cast<std::uintptr_t>(block) % kHugePage == 0;
        }
        for (void* block : blocks) crofton::detail::release(block, 100, 64);
        CHECK(at_beginning <= 1);
    }

    TEST_CASE("an owner that is moved to itself keeps its object, one that is moved to another lets go of its own") {
        struct Object {
            int& ended;
            ~Object() { ++ended; }
        };
        int first_ended = 0, second_ended = 0;
        Owner<Object> first = Owner<Object>::make(Object{first_ended}),
                      second = Owner<Object>::make(Object{second_ended});
        first_ended = second_ended = 0;  // the temporaries
        Owner<Object>& itself = first;
        first = std::move(itself);
        REQUIRE(first);
        CHECK(first_ended == 0);
        first = std::move(second);
        CHECK(first_ended == 1);
        CHECK(second_ended == 0);
        CHECK_FALSE(second);
    }
    TEST_CASE("containers take their memory from the host's hooks and give all of it back") {
        Counts counts;
        set_memory_hooks({counting_allocate, counting_release, &counts});
        {
            Vector<double> numbers;
            for (int i = 0; i < 1000; ++i) numbers.push_back(i);
            CHECK(counts.allocations > 0);
            CHECK(reinterpret_cast<std::uintptr_t>(numbers.data()) % 64 == 0);
        }
        reset_memory_hooks();
        CHECK(counts.allocations == counts.releases);
        CHECK(counts.live_bytes == 0);
    }

#if defined(__unix__) && !defined(__EMSCRIPTEN__)  // which has no other processes
    TEST_CASE("a host without memory ends the program with a message, not with a write to nowhere") {
        int ends[2];
        REQUIRE(pipe(ends) == 0);
        const pid_t child = fork();
        if (child == 0) {
            dup2(ends[1], STDERR_FILENO);
            std::signal(SIGABRT, SIG_DFL);
            set_memory_hooks(
                {[](void*, std::size_t, std::size_t) -> void* { return nullptr; }, counting_release, nullptr});
            const Vector<double> numbers(1000);
            _exit(static_cast<int>(numbers.size() % 7));
        }
        REQUIRE(child > 0);
        close(ends[1]);
        std::string said;
        char block[256];
        for (ssize_t n; (n = read(ends[0], block, sizeof block)) > 0;) said.append(block, static_cast<std::size_t>(n));
        close(ends[0]);
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        CHECK(WIFSIGNALED(status));
        CHECK(WTERMSIG(status) == SIGABRT);
        CHECK(said.find("out of memory for 8000 bytes") != std::string::npos);
    }
#endif
}
