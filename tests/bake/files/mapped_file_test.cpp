// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/baked_scene.hpp>
#include <error_of.hpp>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "temporary_file.hpp"

using crofton::bake::MappedFile;

TEST_SUITE("bake/mapped_file") {
    TEST_CASE("a missing file and a folder are errors that name them") {
        const auto missing = MappedFile::open("no such file");
        REQUIRE_FALSE(missing);
        CHECK(error_of(missing).code == crofton::ErrorCode::io);
        CHECK(error_of(missing).message.find("no such file") != std::string::npos);
        CHECK_FALSE(MappedFile::open("."));
    }

    TEST_CASE("a path that goes on after a zero byte is refused, not cut there") {
        const crofton::bake_test::TemporaryFile file({});
        REQUIRE(MappedFile::open(file.path()));
        const auto cut = MappedFile::open(file.path() + std::string("\0.other", 7));
        REQUIRE_FALSE(cut);
        CHECK(error_of(cut).code == crofton::ErrorCode::invalid_argument);
    }

    TEST_CASE("an empty file is empty, another one is its bytes, moves included") {
        const crofton::bake_test::TemporaryFile empty({});
        REQUIRE(MappedFile::open(empty.path()));
        CHECK(MappedFile::open(empty.path())->bytes().empty());
        const std::vector<std::byte> contents(100'000, std::byte{7});
        const crofton::bake_test::TemporaryFile file(contents);
        auto mapped = MappedFile::open(file.path()).value();
        MappedFile moved = std::move(mapped);
        CHECK(mapped.bytes().empty());
        MappedFile again = std::move(moved);
        moved = std::move(again);
        REQUIRE(moved.bytes().size() == contents.size());
        CHECK(moved.bytes()[99'999] == std::byte{7});
    }

    TEST_CASE("a file read into memory outlives a cut of the file") {
        const std::vector<std::byte> contents(100'000, std::byte{7});
        const crofton::bake_test::TemporaryFile file(contents);
        auto read = MappedFile::open(file.path(), {.access = crofton::bake::FileAccess::read}).value();
        std::filesystem::resize_file(file.path(), 10);
        REQUIRE(read.bytes().size() == contents.size());
        CHECK(std::equal(contents.begin(), contents.end(), read.bytes().begin()));
        CHECK(reinterpret_cast<std::uintptr_t>(read.bytes().data()) % 64 == 0);
        const MappedFile moved = std::move(read);
        CHECK(moved.bytes()[99'999] == std::byte{7});
    }

    TEST_CASE("a file that is cut while it is mapped ends the program that reads it, and one that was read does not") {
        const std::vector<std::byte> contents(100'000, std::byte{7});
        for (const auto access : {crofton::bake::FileAccess::map, crofton::bake::FileAccess::read}) {
            const crofton::bake_test::TemporaryFile file(contents);
            const auto opened = MappedFile::open(file.path(), {.access = access}).value();
            std::filesystem::resize_file(file.path(), 0);
            const pid_t child = fork();
            REQUIRE(child >= 0);
            if (child == 0) {
                std::signal(SIGBUS, SIG_DFL);
                std::signal(SIGSEGV, SIG_DFL);
                _exit(opened.bytes()[50'000] == std::byte{7} ? 0 : 1);
            }
            int status = 0;
            REQUIRE(waitpid(child, &status, 0) == child);
            if (access == crofton::bake::FileAccess::map)
                CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGBUS));
            else
                CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
        }
    }

    TEST_CASE("a file beyond the limit and a pipe are refused at once, whichever way they are opened") {
        const std::vector<std::byte> contents(1000, std::byte{7});
        const crofton::bake_test::TemporaryFile file(contents);
        const std::string pipe = file.path() + ".pipe";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        for (const auto access : {crofton::bake::FileAccess::map, crofton::bake::FileAccess::read}) {
            CHECK(MappedFile::open(file.path(), {.access = access, .largest = 1000}));
            const auto large = MappedFile::open(file.path(), {.access = access, .largest = 999});
            REQUIRE_FALSE(large);
            CHECK(error_of(large).code == crofton::ErrorCode::out_of_range);
            CHECK(error_of(large).message.find("1000 bytes, where the limit is 999") != std::string::npos);
            const auto waiting = MappedFile::open(pipe, {.access = access});
            REQUIRE_FALSE(waiting);
            CHECK(error_of(waiting).message.find("not a regular file") != std::string::npos);
        }
        std::filesystem::remove(pipe);
    }

    TEST_CASE("a mapping ends with its owner") {
        const std::vector<std::byte> contents(100'000, std::byte{7});
        const crofton::bake_test::TemporaryFile file(contents);
        const auto is_mapped = [&] {
            std::ifstream maps("/proc/self/maps");
            const std::string all(std::istreambuf_iterator<char>(maps), {});
            return all.find(std::filesystem::path(file.path()).filename().string()) != std::string::npos;
        };
        if (!std::filesystem::exists("/proc/self/maps")) return;
        {
            const auto mapped = MappedFile::open(file.path());
            REQUIRE(mapped);
            CHECK(is_mapped());
        }
        CHECK_FALSE(is_mapped());
    }

    // Files of the kernel say that they have 4096 bytes, and end earlier.
    TEST_CASE("a file that ends before its size is said to have been cut") {
        const char* const name = "/sys/kernel/uevent_seqnum";
        std::error_code none;
        if (std::filesystem::file_size(name, none) < 100 || none) return;
        const auto read = MappedFile::open(name, {.access = crofton::bake::FileAccess::read});
        REQUIRE_FALSE(read);
        CHECK(error_of(read).code == crofton::ErrorCode::io);
        CHECK(error_of(read).message.find("was cut while it was read") != std::string::npos);
    }

    // The loopback interface has no speed: reading it is an error.
    TEST_CASE("a file that the system cannot read is an error that names it and the reason") {
        const char* const name = "/sys/class/net/lo/speed";
        std::error_code none;
        if (std::filesystem::file_size(name, none) < 1 || none) return;
        const auto read = MappedFile::open(name, {.access = crofton::bake::FileAccess::read});
        REQUIRE_FALSE(read);
        CHECK(error_of(read).code == crofton::ErrorCode::io);
        CHECK(error_of(read).message.find(name) != std::string::npos);
        CHECK(error_of(read).message.find("cannot read") != std::string::npos);
        const auto mapped = MappedFile::open(name);  // nor can it be mapped
        REQUIRE_FALSE(mapped);
        CHECK(error_of(mapped).message.find("cannot map") != std::string::npos);
    }
}
