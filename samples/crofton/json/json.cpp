// SPDX-License-Identifier: MIT
#include "json.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace crofton {

struct Json::Contents {
    std::string text;
    std::vector<Json> elements;
    std::vector<Member> members;
};

namespace {

nlohmann::json written(const Json& value) {
    if (value.is_boolean()) return value.boolean();
    if (value.is_number_unsigned()) return value.whole();
    if (value.is_number_integer()) return value.integer();
    if (value.is_number()) return value.number();
    if (value.is_string()) return value.text();
    if (value.is_array()) {
        nlohmann::json result = nlohmann::json::array();
        for (const Json& element : value.elements()) result.push_back(written(element));
        return result;
    }
    if (value.is_object()) {
        nlohmann::json result = nlohmann::json::object();
        for (const Json::Member& member : value.members()) result[member.key] = written(member.value);
        return result;
    }
    return nullptr;
}

Json read(const nlohmann::json& value) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    if (value.is_number_integer()) return value.get<std::int64_t>();
    if (value.is_number()) return value.get<double>();
    if (value.is_string()) return value.get_ref<const std::string&>();
    Json result;
    if (value.is_array()) {
        result = Json::array();
        for (const nlohmann::json& element : value) result.push_back(read(element));
    } else if (value.is_object()) {
        result = Json::object();
        for (const auto& [key, element] : value.items()) result[key] = read(element);
    }
    return result;
}

bool too_deep(std::string_view text) {
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\') ++i;
        if (c == '"') quoted = !quoted;
        if (quoted) continue;
        if (c == '[' || c == '{') ++depth;
        if (c == ']' || c == '}') --depth;
        if (depth > kMaxJsonDepth) return true;
    }
    return false;
}

}  // namespace

Json::Contents& Json::own_contents(Kind kind) {
    if (kind_ != kind) {
        kind_ = kind;
        contents_ = std::make_shared<Contents>();
    } else if (contents_.use_count() > 1) {
        contents_ = std::make_shared<Contents>(*contents_);
    }
    return *contents_;
}

Json::Json(std::string_view text) {
    own_contents(Kind::text).text = text;
}

Json::Json(std::initializer_list<Json> values) {
    const bool all_members = std::all_of(values.begin(), values.end(), [](const Json& value) {
        return value.is_array() && value.elements().size() == 2 && value.elements()[0].is_string();
    });
    if (!all_members) {
        own_contents(Kind::array).elements = values;
        return;
    }
    own_contents(Kind::object);
    for (const Json& value : values) (*this)[value.elements()[0].text()] = value.elements()[1];
}

Json Json::array(std::initializer_list<Json> values) {
    Json result;
    result.own_contents(Kind::array).elements = values;
    return result;
}

Json Json::object() {
    Json result;
    result.own_contents(Kind::object);
    return result;
}

void Json::push_back(Json value) {
    own_contents(Kind::array).elements.push_back(std::move(value));
}

Json& Json::operator[](const std::string& key) {
    auto& members = own_contents(Kind::object).members;
    const auto found =
        std::find_if(members.begin(), members.end(), [&](const Member& member) { return member.key == key; });
    return found != members.end() ? found->value : members.emplace_back(Member{key, {}}).value;
}

Json& Json::operator[](const char* key) {
    return (*this)[std::string(key)];
}

Json& Json::back() {
    return own_contents(Kind::array).elements.back();
}

double Json::number() const {
    switch (kind_) {
        case Kind::integer:
            return static_cast<double>(scalar_.integer);
        case Kind::whole:
            return static_cast<double>(scalar_.whole);
        case Kind::real:
            return scalar_.real;
        default:
            return 0.0;
    }
}

std::int64_t Json::integer() const {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    if (kind_ == Kind::whole)
        return scalar_.whole > std::uint64_t{kMost} ? kMost : static_cast<std::int64_t>(scalar_.whole);
    return kind_ == Kind::integer ? scalar_.integer : 0;
}

std::uint64_t Json::whole() const {
    return kind_ == Kind::whole ? scalar_.whole : 0;
}

std::string Json::text() const {
    return is_string() ? contents_->text : std::string();
}

std::size_t Json::size() const {
    return elements().size() + members().size();
}

std::span<const Json> Json::elements() const {
    return is_array() ? std::span<const Json>(contents_->elements) : std::span<const Json>();
}

std::span<const Json::Member> Json::members() const {
    return is_object() ? std::span<const Member>(contents_->members) : std::span<const Member>();
}

const Json* Json::find(std::string_view key) const {
    for (const Member& member : members())
        if (member.key == key) return &member.value;
    return nullptr;
}

std::string Json::dump(int indent) const {
    return written(*this).dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool parse_json(const std::string& text, Json& document) {
    if (too_deep(text)) return false;
    const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
    if (parsed.is_discarded()) return false;
    document = read(parsed);
    return true;
}

}  // namespace crofton
