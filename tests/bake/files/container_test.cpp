// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/container.hpp>
#include <error_of.hpp>

#include <array>
#include <string>

using namespace crofton;
using namespace crofton::bake;

namespace {

Vector<std::byte> sample_file() {
    Writer writer;
    const std::array<std::uint32_t, 5> numbers{1, 2, 3, 4, 5};
    const std::array<char, 3> letters{'a', 'b', 'c'};
    writer.add("numbers", std::span<const std::uint32_t>(numbers));
    writer.add("letters8", std::span<const char>(letters));
    writer.add("nothing", std::span<const double>());
    return writer.finish();
}

void check_refused(const Vector<std::byte>& file, ErrorCode code, const char* part) {
    const auto reader = Reader::open(file);
    REQUIRE_FALSE(reader);
    CHECK(error_of(reader).code == code);
    CHECK(error_of(reader).message.find(part) != std::string::npos);
}

template <class T>
void overwrite(Vector<std::byte>& file, std::size_t offset, T value) {
    std::memcpy(file.data() + offset, &value, sizeof value);
}

}  // namespace

TEST_SUITE("bake/container") {
    TEST_CASE("files that are empty, too short or something else are refused with a reason") {
        check_refused({}, ErrorCode::parse, "too short");
        Vector<std::byte> file = sample_file();
        file.resize(63);
        check_refused(file, ErrorCode::parse, "too short");
        file = sample_file();
        file[0] = std::byte{'P'};
        check_refused(file, ErrorCode::parse, "not a .crofton file");
    }

    TEST_CASE("another version, another byte order, a cut file: each has its own words") {
        Vector<std::byte> file = sample_file();
        overwrite(file, offsetof(Header, version), std::uint32_t{2});
        check_refused(file, ErrorCode::unsupported, "version 2");
        file = sample_file();
        overwrite(file, offsetof(Header, byte_order), std::uint32_t{0x04030201});
        check_refused(file, ErrorCode::unsupported, "byte order");
        file = sample_file();
        file.resize(file.size() - 64);
        check_refused(file, ErrorCode::parse, "cut off");
        file = sample_file();
        file.resize(file.size() + 64);
        check_refused(file, ErrorCode::parse, "appended");
        file = sample_file();
        overwrite(file, offsetof(Header, section_count), std::uint32_t{0xffffffff});
        check_refused(file, ErrorCode::parse, "section count");
    }

    TEST_CASE("every flipped bit of a file is seen") {
        Vector<std::byte> file = sample_file();
        REQUIRE(Reader::open(file));
        for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
            const auto mask = static_cast<std::byte>(1u << bit % 8);
            file[bit / 8] ^= mask;
            CHECK_FALSE(Reader::open(file));
            file[bit / 8] ^= mask;
        }
        CHECK(Reader::open(file));
    }

    TEST_CASE("every shorter file is refused") {
        const Vector<std::byte> file = sample_file();
        for (std::size_t size = 0; size < file.size(); ++size) CHECK_FALSE(Reader::open(std::span(file).first(size)));
    }

    TEST_CASE("sections come back, by name and element size only") {
        const Vector<std::byte> file = sample_file();
        const auto reader = Reader::open(file).value();
        const auto numbers = reader.section<std::uint32_t>("numbers").value();
        CHECK(numbers.size() == 5);
        CHECK(numbers[4] == 5);
        CHECK(reinterpret_cast<std::uintptr_t>(numbers.data()) % kAlignment == 0);
        REQUIRE(reader.section<char>("letters8"));
        CHECK((*reader.section<char>("letters8"))[2] == 'c');
        CHECK(reader.section<double>("nothing")->empty());
        CHECK_FALSE(reader.section<std::uint64_t>("numbers"));
        CHECK_FALSE(reader.section<char>("letters"));
        CHECK(error_of(reader.section<char>("letters")).message.find("missing") != std::string::npos);
    }

    TEST_CASE("a file of no sections is a file") {
        Writer writer;
        const auto file = writer.finish();
        CHECK(file.size() == sizeof(Header));
        CHECK(Reader::open(file));
    }
}
