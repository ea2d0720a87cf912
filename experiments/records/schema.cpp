// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/schema.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "experiments/embedded.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// As JSON Schema calls the kind of a value; whole numbers are numbers too.
const char* type_of(const Json& value)
{
    switch (value.type()) {
    case Json::value_t::string:
        return "string";
    case Json::value_t::boolean:
        return "boolean";
    case Json::value_t::array:
        return "array";
    case Json::value_t::object:
        return "object";
    case Json::value_t::null:
        return "null";
    case Json::value_t::number_unsigned:
    case Json::value_t::number_integer:
        return "integer";
    default:
        return "number";
    }
}

// The types of a field, one or several.
Json types_of(const Json& field)
{
    const Json& type = field.at("type");
    return type.is_array() ? type : Json::array({type});
}

bool fits(const Json& value, const Json& field)
{
    if (value.is_number() && field.contains("minimum") && value < field["minimum"])
        return false;
    const std::string type = type_of(value);
    for (const Json& one : types_of(field))
        if (one == type || (one == "number" && type == "integer"))
            return true;
    return false;
}

// "a text or null"
std::string words_of(const Json& field)
{
    constexpr std::array<std::pair<const char*, const char*>, 7> words{{{"string", "a text"},
                                                                        {"integer", "a count"},
                                                                        {"number", "a number"},
                                                                        {"boolean", "true or false"},
                                                                        {"array", "a list"},
                                                                        {"object", "an object"},
                                                                        {"null", "null"}}};
    std::string out;
    const Json types = types_of(field);
    for (const auto& [type, word] : words)
        if (std::find(types.begin(), types.end(), type) != types.end()) {
            out += (out.empty() ? "" : " or ") + std::string(word);
            if (type == std::string("number") && field.contains("minimum"))
                out += " from 0 on";
        }
    return out;
}

} // namespace

const Json& record_schema()
{
    static const Json schema = Json::parse(embedded::record_schema);
    return schema;
}

std::string fault_of(const Json& record)
{
    if (!record.is_object())
        return "expected a JSON object";
    for (const auto& name : record_schema()["required"])
        if (!record.contains(name.get<std::string>()))
            return fmt::format("has no {}, so it cannot be traced", name.dump());
    for (const auto& [name, field] : record_schema()["properties"].items())
        if (const auto value = record.find(name); value != record.end() && !fits(*value, field)) {
            const std::string found = value->dump(-1, ' ', true, Json::error_handler_t::replace);
            return fmt::format("\"{}\" must be {}, not {}", name, words_of(field), found.substr(0, 40));
        }
    return "";
}

int print_schema()
{
    fmt::print("{}\n", record_schema().dump(2));
    return 0;
}

} // namespace cinch
