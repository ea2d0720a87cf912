// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "cinch/surface.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// The fields of a JSON object that know where they stand, so that every complaint names file and path. Fields that
/// nobody asked for are complained about by finish().
class JsonFields {
public:
    using Json = nlohmann::json;

    JsonFields(const Json& json, std::string file, std::string path);

    [[noreturn]] void fail(const std::string& key, const std::string& expected, const Json& found) const;
    [[noreturn]] void complain(const std::string& key, const std::string& what) const;

    /// One line of printable characters, whatever the file has in its strings.
    static std::string printable(std::string text);

    std::string place(const std::string& key) const;
    bool has(const std::string& key) const;
    const std::string& file() const { return file_; }

    const Json* find(const std::string& key);
    const Json& need(const std::string& key);

    /// A finite number in [least, most], or above `least` where `open`.
    struct Range {
        double least = -HUGE_VAL, most = HUGE_VAL;
        bool open = false;
        const char* expected = "a number";
    };
    static constexpr Range any() { return {}; }
    static constexpr Range positive() { return {0, HUGE_VAL, true, "a number > 0"}; }
    static constexpr Range not_negative() { return {0, HUGE_VAL, false, "a number >= 0"}; }
    static constexpr Range length() { return {1e-30, 1e30, false, "a number from 1e-30 to 1e30 (m)"}; }
    static constexpr Range interval() { return {1e-30, 1e30, false, "a number from 1e-30 to 1e30 (s)"}; }

    double number(const std::string& key, const Range& range);
    double number(const std::string& key, const Range& range, double otherwise);
    std::size_t count(const std::string& key, std::size_t least, std::size_t most,
                      std::optional<std::size_t> otherwise = {});
    std::string text(const std::string& key, std::optional<std::string> otherwise = {});
    bool flag(const std::string& key, bool otherwise);
    Vec3 vector(const std::string& key);
    Vec3 vector(const std::string& key, const Vec3& otherwise);
    Vec3 vector_of(const std::string& key, const Json& json) const;
    Vec3 direction(const std::string& key); ///< of some length; of length 1 from here on
    const Json& array(const std::string& key);
    std::size_t count_of(const std::string& key, const Json& json, std::size_t least, std::size_t most) const;
    double number_of(const std::string& key, const Json& json, const Range& range) const;
    void finish() const;

private:
    const Json* json_;
    std::string file_, path_;
    std::set<std::string> asked_;
};

} // namespace cinch
