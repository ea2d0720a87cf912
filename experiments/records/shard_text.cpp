// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/shard_text.hpp"

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int format = 1;
// The end of a line: ,"sum":"0123456789abcdef"}
constexpr std::string_view seal_begin = ",\"sum\":\"", seal_end = "\"}";
constexpr std::size_t seal_bytes = seal_begin.size() + 16 + seal_end.size();

std::string sealed_line(const Json& fields)
{
    std::string text = fields.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.pop_back();
    return fmt::format("{}{}{:016x}{}\n", text, seal_begin, checksum(text), seal_end);
}

// The fields of a line without its end; none if it is not what sealed_line made.
std::optional<Json> fields_of_line(std::string_view line)
{
    if (line.size() < seal_bytes)
        return std::nullopt;
    const std::string_view body = line.substr(0, line.size() - seal_bytes);
    if (line.substr(body.size()) != fmt::format("{}{:016x}{}", seal_begin, checksum(body), seal_end))
        return std::nullopt;
    Json fields = Json::parse(line, nullptr, false);
    return fields.is_object() ? std::optional(std::move(fields)) : std::nullopt;
}

Json header(const Campaign& c, const Shard& shard)
{
    return {{"cinch_rows", format}, {"command", c.command}, {"plan", c.plan},         {"cells", c.cells},
            {"version", c.version}, {"commit", c.commit},   {"compiler", c.compiler}, {"flags", c.flags},
            {"shard", shard.index}, {"shards", shard.count}};
}

[[noreturn]] void damaged(const fs::path& file, std::size_t line, const std::string& why)
{
    throw InputError::at_line(file.string(), line, why + "; remove the file and run its shard again");
}

} // namespace

std::string first_line(const Campaign& campaign, const Shard& shard) { return sealed_line(header(campaign, shard)); }

std::string cell_line(std::size_t cell, const Rows& rows) { return sealed_line({{"cell", cell}, {"rows", rows}}); }

fs::path file_of(const fs::path& folder, const Shard& shard)
{
    return folder / fmt::format("shard-{:06}-of-{:06}.jsonl", shard.index, shard.count);
}

std::optional<ShardText> read_shard(const fs::path& file)
{
    const std::string bytes = fs::file_size(file) == 0 ? "" : read_bytes(file);
    ShardText out;
    std::size_t number = 0;
    bool has_header = false;
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t end = bytes.find('\n', at);
        if (end == std::string::npos)
            break;
        ++number;
        const auto fields = fields_of_line(std::string_view(bytes).substr(at, end - at));
        if (!fields) {
            if (end + 1 == bytes.size()) // torn, and ended by whatever follows in the file system's block
                break;
            damaged(file, number, "is not as it was written");
        }
        try {
            if (!has_header) {
                if (fields->at("cinch_rows") != format)
                    damaged(file, number, "has rows of another version of this program");
                out.campaign = {fields->at("command"), fields->at("plan"),   fields->at("cells"),
                                fields->at("version"), fields->at("commit"), fields->at("compiler"),
                                fields->at("flags")};
                out.shard = {fields->at("shard"), fields->at("shards")};
                has_header = true;
            } else {
                const std::size_t cell = fields->at("cell");
                if (cell >= out.campaign.cells || !out.shard.has(cell))
                    damaged(file, number, fmt::format("has cell {}, which is not of this shard", cell));
                if (!out.cells.emplace(cell, fields->at("rows").get<Rows>()).second)
                    damaged(file, number, fmt::format("has cell {} a second time", cell));
            }
        } catch (const Json::exception&) {
            damaged(file, number, "is no line of rows");
        }
        at = out.whole_bytes = end + 1;
    }
    out.is_torn = out.whole_bytes < bytes.size();
    return has_header ? std::optional(std::move(out)) : std::nullopt;
}

std::string difference(const Campaign& a, const Campaign& b)
{
    for (const auto& [what, one, other] :
         {std::tuple("command", a.command, b.command), std::tuple("version", a.version, b.version),
          std::tuple("commit", a.commit, b.commit), std::tuple("compiler", a.compiler, b.compiler),
          std::tuple("flags", a.flags, b.flags)})
        if (one != other)
            return fmt::format("{} '{}' instead of '{}'", what, one, other);
    if (a.plan != b.plan || a.cells != b.cells) {
        for (const auto& [name, value] : a.plan.items())
            if (!b.plan.contains(name) || b.plan[name] != value)
                return fmt::format("another plan: its \"{}\" is {}", name, value.dump().substr(0, 60));
        return "another plan";
    }
    return "";
}

} // namespace cinch
