// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/fuzz/fuzz_state.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/fuzz/fuzz_case.hpp"
#include "experiments/report/whole_file.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const FuzzSettings& s)
{
    return {{"version", s.version}, {"commit", s.commit}, {"seed", s.seed},        {"family", s.family},
            {"shard", s.shard},     {"shards", s.shards}, {"sabotage", s.sabotage}};
}

class Fields {
public:
    Fields(const Json& root, const std::string& file) : root_(root), file_(file) {}

    [[noreturn]] void fail(const char* name, const std::string& why) const
    {
        throw InputError::in_file(file_, fmt::format("field \"{}\": {}", name, why));
    }

    const Json& at(const char* name) const
    {
        if (!root_.contains(name))
            fail(name, "is missing");
        return root_[name];
    }
    static std::string shown(const Json& value)
    {
        const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
        return text.size() > 40 ? text.substr(0, 40) + "..." : text;
    }
    std::uint64_t count(const char* name, std::uint64_t most, const std::string& of_what) const
    {
        const Json& value = at(name);
        if (!value.is_number_unsigned())
            fail(name, fmt::format("{} is no whole number from 0 on", shown(value)));
        const auto number = value.get<std::uint64_t>();
        if (number > most)
            fail(name, fmt::format("{} is more than {}, {}", number, most, of_what));
        return number;
    }
    double seconds(const char* name) const
    {
        const Json& value = at(name);
        if (!value.is_number() || !(value.get<double>() >= 0) || !std::isfinite(value.get<double>()))
            fail(name, fmt::format("{} is no time in seconds", shown(value)));
        return value.get<double>();
    }
    std::set<std::string> families(const char* name) const
    {
        const Json& value = at(name);
        const auto known = fuzz_families();
        std::set<std::string> out;
        for (const Json& entry : value)
            if (!entry.is_string() ||
                std::find(known.begin(), known.end(), entry.get_ref<const std::string&>()) == known.end())
                fail(name, fmt::format("{} is no family of cases", shown(entry)));
            else
                out.insert(entry);
        if (!value.is_array())
            fail(name, fmt::format("{} is no list of families", shown(value)));
        return out;
    }

private:
    const Json& root_;
    const std::string& file_;
};

} // namespace

std::string fuzz_state_text(const FuzzSettings& settings, const FuzzState& state)
{
    Json out = to_json(settings);
    out["next"] = state.next;
    out["violations"] = state.violations;
    out["seconds"] = state.seconds;
    out["shrunk"] = state.shrunk;
    out["checksum"] = fmt::format("{:016x}", checksum(out.dump()));
    return out.dump() + "\n";
}

FuzzState parse_fuzz_state(const std::string& text, const std::string& file, const FuzzSettings& settings)
{
    const Json root = Json::parse(text, nullptr, false);
    if (!root.is_object())
        throw InputError::in_file(file, "is no state file of 'cinch fuzz': no JSON object");
    const Fields fields(root, file);
    const Json own = to_json(settings);
    for (const auto& [name, mine] : own.items())
        if (const Json& found = fields.at(name.c_str()); found != mine)
            fields.fail(name.c_str(),
                        fmt::format("{} there, {} in this run; use the same program and options, or another file",
                                    Fields::shown(found), Fields::shown(mine)));
    // Case i of the shard is case i · shards + shard of all, a number of 64 bits.
    const std::uint64_t most = (std::numeric_limits<std::uint64_t>::max() - settings.shard) / settings.shards;
    FuzzState state;
    state.next = fields.count("next", most, "all there are");
    state.violations = fields.count("violations", state.next, "the cases that were run");
    state.seconds = fields.seconds("seconds");
    state.shrunk = fields.families("shrunk");
    if (text != fuzz_state_text(settings, state)) // spacing, other fields, a field twice, the checksum
        throw InputError::in_file(
            file, "was changed after 'cinch fuzz' wrote it, or is damaged; begin anew with another file");
    return state;
}

FuzzStateFile::FuzzStateFile(const std::string& file, const FuzzSettings& settings)
    : file_(file), settings_(settings),
      lock_(file + ".lock", file, "another 'cinch fuzz' is using it; wait for it, or give each run a file of its own")
{
    std::error_code error;
    const auto there = std::filesystem::status(file, error);
    if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
        throw InputError::in_file(file, "is no regular file");
    if (std::filesystem::exists(there))
        found_ = parse_fuzz_state(read_bytes(file), file, settings_);
    else
        save(found_);
}

void FuzzStateFile::save(const FuzzState& state) const { write_whole(file_, fuzz_state_text(settings_, state)); }

} // namespace cinch
