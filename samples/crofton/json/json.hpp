// SPDX-License-Identifier: MIT
// A JSON value, to build documents and to read small ones. nlohmann-json writes and parses them, in json.cpp alone,
// since its headers take longer to compile than the files that would include them.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace crofton {

// Copies are cheap: they share their elements until one of them changes. Objects are written in the order of their
// keys.
class Json {
  public:
    struct Member;

    Json() = default;  // null
    Json(std::nullptr_t) {}
    template <std::same_as<bool> Bool>
    Json(Bool value) : kind_(Kind::boolean) {
        scalar_.boolean = value;
    }
    template <std::floating_point Number>
    Json(Number value) : kind_(Kind::real) {
        scalar_.real = value;
    }
    template <std::signed_integral Number>
    Json(Number value) : kind_(Kind::integer) {
        scalar_.integer = value;
    }
    template <std::unsigned_integral Number>
    requires(!std::same_as<Number, bool>) Json(Number value) : kind_(Kind::whole) { scalar_.whole = value; }
    Json(std::string_view text);
    Json(const std::string& text) : Json(std::string_view(text)) {}
    Json(const char* text) : Json(std::string_view(text)) {}
    template <class Value, class Allocator>
    Json(const std::vector<Value, Allocator>& values) : Json(array()) {
        for (const Value& value : values) push_back(value);
    }
    template <class Value, std::size_t kCount>
    Json(const std::array<Value, kCount>& values) : Json(array()) {
        for (const Value& value : values) push_back(value);
    }
    template <class First, class Second>
    Json(const std::pair<First, Second>& values) : Json(array({values.first, values.second})) {}
    // {{"a", 1}, {"b", 2}} is an object; any other list is an array.
    Json(std::initializer_list<Json> values);

    [[nodiscard]] static Json array(std::initializer_list<Json> values = {});
    [[nodiscard]] static Json object();

    void push_back(Json value);         // makes an array of null
    Json& operator[](const char* key);  // adds what is missing; makes an object of null
    Json& operator[](const std::string& key);
    [[nodiscard]] Json& back();  // of an array that is not empty

    [[nodiscard]] bool is_null() const { return kind_ == Kind::null; }
    [[nodiscard]] bool is_boolean() const { return kind_ == Kind::boolean; }
    [[nodiscard]] bool is_number() const { return is_number_integer() || kind_ == Kind::real; }
    [[nodiscard]] bool is_number_integer() const { return kind_ == Kind::integer || kind_ == Kind::whole; }
    [[nodiscard]] bool is_number_unsigned() const { return kind_ == Kind::whole; }
    [[nodiscard]] bool is_string() const { return kind_ == Kind::text; }
    [[nodiscard]] bool is_array() const { return kind_ == Kind::array; }
    [[nodiscard]] bool is_object() const { return kind_ == Kind::object; }

    // Return the value; zero, false or empty text if it is of another kind.
    [[nodiscard]] bool boolean() const { return is_boolean() && scalar_.boolean; }
    [[nodiscard]] double number() const;
    [[nodiscard]] std::int64_t integer() const;  // clamped
    [[nodiscard]] std::uint64_t whole() const;   // of a number without sign
    [[nodiscard]] std::string text() const;

    [[nodiscard]] std::size_t size() const;  // of an array or object; 0 otherwise

    // Returns the elements of an array, or the members of an object, one for each key. Empty for other kinds.
    [[nodiscard]] std::span<const Json> elements() const;
    [[nodiscard]] std::span<const Member> members() const;
    [[nodiscard]] const Json* find(std::string_view key) const;  // nullptr where there is none

    // With an indent: a line per element. Bytes that are not UTF-8 are replaced.
    [[nodiscard]] std::string dump(int indent = -1) const;

  private:
    enum class Kind : std::uint8_t { null, boolean, integer, whole, real, text, array, object };
    struct Contents;

    Contents& own_contents(Kind kind);

    Kind kind_ = Kind::null;
    union {
        bool boolean;
        std::int64_t integer;
        std::uint64_t whole;
        double real;
    } scalar_{};
    std::shared_ptr<Contents> contents_;
};

struct Json::Member {
    std::string key;
    Json value;
};

// How deep arrays and objects may lie in each other in what is read.
inline constexpr int kMaxJsonDepth = 64;

// False, and `document` as it was, where the text is no JSON or nested deeper than kMaxJsonDepth.
[[nodiscard]] bool parse_json(const std::string& text, Json& document);

}  // namespace crofton
