// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/bounds.hpp"
#include "cinch/surface.hpp"
#include "experiments/fuzz/fuzz_case.hpp"

namespace cinch {
namespace {

using nlohmann::json;

json hex(double x) { return fmt::format("{:a}", x); }

json hex_array(std::span<const double> values)
{
    json out = json::array();
    for (double x : values)
        out.push_back(hex(x));
    return out;
}

std::vector<double> numbers(const json& array, const std::string& file, const std::string& field, std::size_t count)
{
    std::vector<double> out;
    for (const json& value : array) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        char* end = nullptr;
        out.push_back(std::strtod(text.c_str(), &end)); // decimal or hexadecimal; too small a number is 0 or subnormal
        if (text.empty() || end != text.c_str() + text.size() || !std::isfinite(out.back()))
            throw InputError::in_file(file, fmt::format("field {}: '{}' is not a finite number", field, text));
    }
    if (out.size() != count)
        throw InputError::in_file(file, fmt::format("field {}: {} numbers, expected {}", field, out.size(), count));
    return out;
}

} // namespace

std::string to_json(const FuzzCase& c, const std::string& fault)
{
    json out{{"family", c.family}, {"n", c.nodes()}, {"fault", fault}};
    if (c.is_of_times()) {
        out = {{"family", c.family}, {"fault", fault},   {"drawn", c.drawn},
               {"kdop", c.kdop},     {"trial", c.trial}, {"passes", c.passes}};
        return out.dump();
    }
    if (!c.is_surface()) {
        out["l"] = hex_array(c.space.l);
        out["h"] = hex_array(c.space.h);
        out["b"] = json::array({hex_array(c.space.b[0])});
        return out.dump();
    }
    out["kdop"] = c.kdop;
    out["trial"] = c.trial;
    out["passes"] = c.passes;
    for (const Vec3& p : c.rest)
        out["rest"].push_back(hex_array({p.data(), 3}));
    for (const auto& row : c.weights)
        out["weights"].push_back(hex_array(row));
    for (const AffineMap& map : c.maps)
        out["maps"].push_back(hex_array({&map.m[0][0], 12}));
    return out.dump();
}

FuzzCase fuzz_case_from_json(const std::string& text, const std::string& file)
{
    FuzzCase out;
    try {
        const json root = json::parse(text);
        out.family = root.value("family", "");
        if (!root.contains("rest") && !out.is_of_times()) {
            out.space = parse_case(text, file);
            if (out.space.b.empty())
                throw InputError::in_file(file, "field b has no row");
            return out;
        }
        auto whole = [&](const char* field, std::uint64_t least, std::uint64_t most) {
            const json& value = root.at(field);
            if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most)
                throw InputError::in_file(file, fmt::format("field {}: {} is no whole number from {} to {}", field,
                                                            value.dump(), least, most));
            return value.get<std::uint64_t>();
        };
        out.kdop = static_cast<int>(whole("kdop", 6, 26));
        if (!is_kdop(out.kdop))
            throw InputError::in_file(file, fmt::format("field kdop: {} is none of {}", out.kdop, kdop_names()));
        if (out.is_of_times()) {
            out.drawn = whole("drawn", 0, ~std::uint64_t{0});
            out.trial = static_cast<std::uint32_t>(whole("trial", 0, 5));
            out.passes = static_cast<int>(whole("passes", 0, 1));
            return out;
        }
        const std::size_t n = whole("n", 1, 65535);
        out.trial = root.contains("trial") ? static_cast<std::uint32_t>(whole("trial", 0, surface_trials)) : 0;
        out.passes = root.contains("passes") ? static_cast<int>(whole("passes", 1, 100)) : 1;
        for (const json& p : root.at("rest")) {
            const auto x = numbers(p, file, "rest", 3);
            out.rest.emplace_back(x[0], x[1], x[2]);
        }
        for (const json& row : root.at("weights")) {
            out.weights.push_back(numbers(row, file, "weights", n));
            for (const double w : out.weights.back())
                if (!(w >= 0 && w <= 1))
                    throw InputError::in_file(file, fmt::format("field weights: {} lies outside 0 to 1", w));
        }
        for (const json& map : root.at("maps")) {
            const auto x = numbers(map, file, "maps", 12);
            out.maps.emplace_back();
            std::copy(x.begin(), x.end(), &out.maps.back().m[0][0]);
        }
        if (out.maps.size() != n || out.weights.size() != out.rest.size())
            throw InputError::in_file(file, "fields n, rest, weights and maps contradict each other");
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError::in_file(file, error.what());
    }
    return out;
}

} // namespace cinch
