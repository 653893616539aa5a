// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "json/json.hpp"

using namespace crofton;

namespace {

Json document_of(const std::string& text) {
    Json document;
    REQUIRE(parse_json(text, document));
    return document;
}

// A random document, built by both, so that nlohmann's own is the oracle.
std::pair<Json, nlohmann::json> random_document(std::mt19937_64& random, int depth) {
    switch (random() % (depth > 0 ? 8 : 6)) {
        case 0:
            return {nullptr, nullptr};
        case 1:
            return {true, true};
        case 2: {
            const auto value = static_cast<std::int64_t>(random());
            return {value, value};
        }
        case 3: {
            const std::uint64_t value = random();
            return {value, value};
        }
        case 4: {
            const double value = std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 200) - 150);
            return {value, value};
        }
        case 5: {
            std::string text;
            for (std::uint64_t i = random() % 6; i > 0; --i) text += "a\"\\\n\x7fz{"[random() % 7];
            return {text, text};
        }
        case 6: {
            std::pair<Json, nlohmann::json> list{Json::array(), nlohmann::json::array()};
            for (std::uint64_t i = random() % 5; i > 0; --i) {
                auto [ours, theirs] = random_document(random, depth - 1);
                list.first.push_back(ours);
                list.second.push_back(theirs);
            }
            return list;
        }
        default: {
            std::pair<Json, nlohmann::json> object{Json::object(), nlohmann::json::object()};
            for (std::uint64_t i = random() % 5; i > 0; --i) {
                const std::string key = "k" + std::to_string(random() % 4);
                auto [ours, theirs] = random_document(random, depth - 1);
                object.first[key] = ours;
                object.second[key] = theirs;
            }
            return object;
        }
    }
}

}  // namespace

TEST_SUITE("pipeline/json") {
    TEST_CASE("text that is not JSON, or nested too deep, is refused and leaves the document unchanged") {
        for (const std::string& text : {std::string(""), std::string("{"), std::string("[1,]"), std::string("nul"),
                                        std::string("\"\xff\""), std::string(1'000'000, '[')}) {
            Json document = 7;
            CHECK_FALSE(parse_json(text, document));
            CHECK(document.integer() == 7);
        }
        const auto nested = [](int depth) {
            return std::string(static_cast<std::size_t>(depth), '[') +
                   std::string(static_cast<std::size_t>(depth), ']');
        };
        Json document;
        CHECK(parse_json(nested(kMaxJsonDepth), document));
        CHECK_FALSE(parse_json(nested(kMaxJsonDepth + 1), document));
        CHECK(parse_json("\"" + nested(1000) + "\\\"[\"", document));  // brackets within a text nest nothing
    }

    TEST_CASE("a value read as another kind is zero, empty or absent") {
        const Json number = 3.5, text = "x", null;
        CHECK(number.text().empty());
        CHECK(number.find("a") == nullptr);
        CHECK(number.elements().empty());
        CHECK(text.number() == 0.0);
        CHECK(text.integer() == 0);
        CHECK_FALSE(text.boolean());
        CHECK(null.members().empty());
        CHECK(document_of("18446744073709551615").integer() == std::numeric_limits<std::int64_t>::max());
        CHECK(document_of("18446744073709551615").whole() == std::numeric_limits<std::uint64_t>::max());
        CHECK(document_of("-5").integer() == -5);
        CHECK_FALSE(document_of("-5").is_number_unsigned());
    }

    TEST_CASE("pairs that begin with a text make an object, everything else an array") {
        CHECK(Json{{"a", 1}, {"b", {1, 2}}}.dump() == R"({"a":1,"b":[1,2]})");
        CHECK(Json{{1, "a"}, {"b", 2}}.dump() == R"([[1,"a"],["b",2]])");
        CHECK(Json{{"list", {{{"x", 0}}}}}.dump() == R"({"list":[{"x":0}]})");
        CHECK(Json(std::vector<std::pair<unsigned, unsigned>>{{1, 2}, {3, 4}}).dump() == "[[1,2],[3,4]]");
    }

    TEST_CASE("a copy keeps what it held when the original changes") {
        Json original{{"a", {1, 2}}};
        const Json copy = original;
        original["a"].push_back(3);
        original["b"] = true;
        CHECK(copy.dump() == R"({"a":[1,2]})");
        CHECK(original.dump() == R"({"a":[1,2,3],"b":true})");
    }

    TEST_CASE("bytes that are not UTF-8 are replaced") {
        CHECK(Json("a\xff").dump() == "\"a\xEF\xBF\xBD\"");
    }

    TEST_CASE("writes and reads as nlohmann-json does, 20,000 random documents") {
        std::mt19937_64 random(1);
        std::size_t objects = 0;
        for (int i = 0; i < 20'000; ++i) {
            const auto [ours, theirs] = random_document(random, 4);
            objects += ours.is_object();
            REQUIRE(ours.dump(1) == theirs.dump(1));
            REQUIRE(document_of(theirs.dump()).dump() == theirs.dump());
        }
        CHECK(objects > 1000);
    }
}
