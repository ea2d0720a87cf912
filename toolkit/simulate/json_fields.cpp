// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/json_fields.hpp"

#include <nlohmann/json.hpp>

namespace cinch {

JsonFields::JsonFields(const Json& json, std::string file, std::string path)
    : json_(&json), file_(std::move(file)), path_(std::move(path))
{
    if (!json.is_object())
        fail("", "an object", json);
}

void JsonFields::fail(const std::string& key, const std::string& expected, const Json& found) const
{
    std::string text = found.is_array()    ? "an array"
                       : found.is_object() ? "an object"
                                           : found.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (text.size() > 60)
        text = text.substr(0, 57) + "...";
    complain(key, "expected " + expected + ", found " + text);
}

void JsonFields::complain(const std::string& key, const std::string& what) const
{
    throw InputError::in_file(file_, printable(place(key) + ": " + what));
}

std::string JsonFields::printable(std::string text)
{
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text.size() > 400 ? text.substr(0, 397) + "..." : text;
}

std::string JsonFields::place(const std::string& key) const
{
    return key.empty() ? (path_.empty() ? "/" : path_) : path_ + "/" + key;
}

bool JsonFields::has(const std::string& key) const { return json_->contains(key); }

const JsonFields::Json* JsonFields::find(const std::string& key)
{
    asked_.insert(key);
    const auto it = json_->find(key);
    return it == json_->end() ? nullptr : &*it;
}

const JsonFields::Json& JsonFields::need(const std::string& key)
{
    const Json* json = find(key);
    if (!json)
        complain(key, "is missing");
    return *json;
}

double JsonFields::number(const std::string& key, const Range& range) { return number_of(key, need(key), range); }
double JsonFields::number(const std::string& key, const Range& range, double otherwise)
{
    const Json* json = find(key);
    return json ? number_of(key, *json, range) : otherwise;
}

std::size_t JsonFields::count(const std::string& key, std::size_t least, std::size_t most,
                              std::optional<std::size_t> otherwise)
{
    const Json* json = otherwise ? find(key) : &need(key);
    return json ? count_of(key, *json, least, most) : *otherwise;
}

std::string JsonFields::text(const std::string& key, std::optional<std::string> otherwise)
{
    const Json* json = otherwise ? find(key) : &need(key);
    if (!json)
        return *otherwise;
    if (!json->is_string())
        fail(key, "a string", *json);
    return json->get<std::string>();
}

bool JsonFields::flag(const std::string& key, bool otherwise)
{
    const Json* json = find(key);
    if (!json)
        return otherwise;
    if (!json->is_boolean())
        fail(key, "true or false", *json);
    return json->get<bool>();
}

Vec3 JsonFields::vector(const std::string& key) { return vector_of(key, need(key)); }
Vec3 JsonFields::vector(const std::string& key, const Vec3& otherwise)
{
    const Json* json = find(key);
    return json ? vector_of(key, *json) : otherwise;
}

Vec3 JsonFields::vector_of(const std::string& key, const Json& json) const
{
    if (!json.is_array() || json.size() != 3)
        fail(key, "an array of 3 numbers", json);
    Vec3 v;
    for (std::size_t i = 0; i < 3; ++i)
        v[static_cast<Eigen::Index>(i)] = number_of(key + "/" + std::to_string(i), json[i], any());
    return v;
}

Vec3 JsonFields::direction(const std::string& key)
{
    const Vec3 v = vector(key);
    if (!(v.stableNorm() > 0))
        complain(key, "must not be 0");
    return v.stableNormalized();
}

const JsonFields::Json& JsonFields::array(const std::string& key)
{
    const Json& json = need(key);
    if (!json.is_array())
        fail(key, "an array", json);
    return json;
}

std::size_t JsonFields::count_of(const std::string& key, const Json& json, std::size_t least, std::size_t most) const
{
    const std::string expected = "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
    if (!json.is_number_unsigned() || json.get<std::uint64_t>() < least || json.get<std::uint64_t>() > most)
        fail(key, expected, json);
    return json.get<std::size_t>();
}

double JsonFields::number_of(const std::string& key, const Json& json, const Range& range) const
{
    if (!json.is_number())
        fail(key, range.expected, json);
    const double value = json.get<double>();
    if (!std::isfinite(value) || value < range.least || value > range.most || (range.open && value == range.least))
        fail(key, range.expected, json);
    return value;
}

void JsonFields::finish() const
{
    for (const auto& [key, value] : json_->items())
        if (!asked_.count(key)) {
            std::string known;
            for (const std::string& k : asked_)
                known += (known.empty() ? "" : ", ") + k;
            complain(key, "is unknown; known here are " + known);
        }
}

} // namespace cinch
