// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/baked_scene.hpp>

#include <vector>

#include "temporary_file.hpp"

using crofton::bake::MappedFile;

TEST_SUITE("bake/mapped_file") {
    TEST_CASE("a missing file and a folder are errors that name them") {
        const auto missing = MappedFile::open("no such file");
        REQUIRE_FALSE(missing);
        CHECK(missing.error().code == crofton::ErrorCode::io);
        CHECK(missing.error().message.find("no such file") != std::string::npos);
        CHECK_FALSE(MappedFile::open("."));
    }

    TEST_CASE("an empty file is empty, another one is its bytes, moves included") {
        const crofton::bake_test::TemporaryFile empty({});
        REQUIRE(MappedFile::open(empty.path()));
        CHECK(MappedFile::open(empty.path())->bytes().empty());
        const std::vector<std::byte> contents(100'000, std::byte{7});
        const crofton::bake_test::TemporaryFile file(contents);
        auto mapped = MappedFile::open(file.path());
        REQUIRE(mapped);
        MappedFile moved = std::move(*mapped);
        CHECK(mapped->bytes().empty());
        MappedFile again = std::move(moved);
        moved = std::move(again);
        REQUIRE(moved.bytes().size() == contents.size());
        CHECK(moved.bytes()[99'999] == std::byte{7});
    }
}
