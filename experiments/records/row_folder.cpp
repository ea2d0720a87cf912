// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/row_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <unistd.h>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/report/file_lock.hpp"
#include "toolkit/simulate/frame_file.hpp"
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

// What two campaigns differ in, for people; empty if in nothing.
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

fs::path file_of(const fs::path& folder, const Shard& shard)
{
    return folder / fmt::format("shard-{:06}-of-{:06}.jsonl", shard.index, shard.count);
}

// A shard's file as far as it is whole.
struct Content {
    Campaign campaign;
    Shard shard;
    std::map<std::size_t, Rows> cells;
    std::size_t whole_bytes = 0;
    bool torn = false; ///< bytes that are no line follow
};

[[noreturn]] void damaged(const fs::path& file, std::size_t line, const std::string& why)
{
    throw InputError::at_line(file.string(), line, why + "; remove the file and run its shard again");
}

// No campaign: not even the first line is whole.
std::optional<Content> content_of(const fs::path& file, const std::string& bytes)
{
    Content out;
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
    out.torn = out.whole_bytes < bytes.size();
    return has_header ? std::optional(std::move(out)) : std::nullopt;
}

std::string bytes_of(const fs::path& file) { return fs::file_size(file) == 0 ? "" : read_bytes(file); }

[[noreturn]] void cannot(const fs::path& file, int error)
{
    throw InputError::in_file(file.string(), fmt::format("cannot be written: {}", std::strerror(error)));
}

} // namespace

struct ShardFile::Handle {
    Handle(fs::path path, const Campaign& campaign, const Shard& of)
        : name(std::move(path)), shard(of),
          lock(name.string() + ".lock", name.string(),
               "another process computes this shard; wait for it, or give each shard to one process")
    {
        file = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (file < 0)
            cannot(name, errno);
        std::size_t keep = 0;
        if (auto found = content_of(name, bytes_of(name))) {
            if (const std::string what = difference(found->campaign, campaign); !what.empty())
                throw InputError::in_file(name.string(), "has rows of " + what + "; give this run a folder of its own");
            if (found->shard.index != shard.index || found->shard.count != shard.count)
                throw InputError::in_file(name.string(), "says that it is of another shard");
            for (const auto& cell : found->cells)
                done.push_back(cell.first);
            keep = found->whole_bytes;
        }
        if (::ftruncate(file, static_cast<off_t>(keep)) != 0 || ::lseek(file, 0, SEEK_END) < 0)
            cannot(name, errno);
        size = keep;
        if (keep == 0)
            append(sealed_line(header(campaign, shard)));
    }
    ~Handle() { ::close(file); }

    // All of it or, where the disk is full, nothing.
    void append(std::string_view text)
    {
        for (std::size_t written = 0; written < text.size();) {
            const ssize_t n = ::write(file, text.data() + written, text.size() - written);
            if (n < 0 && errno == EINTR)
                continue;
            if (n < 0) {
                const int error = errno;
                if (::ftruncate(file, static_cast<off_t>(size)) != 0) // the next run cuts off what is left of it
                    ::lseek(file, 0, SEEK_END);
                cannot(name, error);
            }
            written += static_cast<std::size_t>(n);
        }
        size += text.size();
    }

    fs::path name;
    Shard shard;
    FileLock lock;
    int file = -1;
    std::size_t size = 0;
    std::vector<std::size_t> done; ///< ascending
};

ShardFile::ShardFile(const fs::path& folder, const Campaign& campaign, const Shard& shard)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw InputError::in_file(folder.string(), "cannot be made a folder: " + error.message());
    handle_ = std::make_unique<Handle>(file_of(folder, shard), campaign, shard);
}

ShardFile::~ShardFile() = default;
ShardFile::ShardFile(ShardFile&&) noexcept = default;

bool ShardFile::has(std::size_t cell) const
{
    return std::binary_search(handle_->done.begin(), handle_->done.end(), cell);
}

std::size_t ShardFile::finished() const { return handle_->done.size(); }

void ShardFile::add(std::size_t cell, const Rows& rows)
{
    handle_->append(sealed_line({{"cell", cell}, {"rows", rows}}));
    auto& done = handle_->done;
    done.insert(std::upper_bound(done.begin(), done.end(), cell), cell);
}

namespace {

// "0-3,7", for sbatch --array.
std::string ranges(const std::vector<std::size_t>& ascending)
{
    std::string out;
    for (std::size_t i = 0; i < ascending.size();) {
        std::size_t end = i;
        while (end + 1 < ascending.size() && ascending[end + 1] == ascending[end] + 1)
            ++end;
        out += (out.empty() ? "" : ",") + std::to_string(ascending[i]) +
               (end > i ? "-" + std::to_string(ascending[end]) : "");
        i = end + 1;
    }
    return out;
}

} // namespace

Merged merge(const fs::path& folder)
{
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw InputError::in_file(folder.string(), "is no folder of rows (--out)");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".jsonl" && entry.path().filename().string().starts_with("shard-"))
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    if (files.empty())
        throw InputError::in_file(folder.string(), "has no shards; were they written with --out of this folder?");
    Merged out;
    std::optional<std::size_t> shards;
    std::vector<std::size_t> unfinished;
    std::vector<std::string> why;
    std::vector<char> seen;
    for (const fs::path& file : files) {
        auto content = content_of(file, bytes_of(file));
        if (!content)
            continue; // counted as missing
        if (!shards) {
            shards = content->shard.count;
            out.campaign = content->campaign;
            out.cells.resize(out.campaign.cells);
            seen.assign(*shards, 0);
        }
        if (const std::string what = difference(content->campaign, out.campaign); !what.empty())
            throw InputError::in_file(
                file.string(), fmt::format("has rows of {} ({}); remove one of the two", what, files[0].string()));
        if (content->shard.count != *shards)
            throw InputError::in_file(
                file.string(),
                fmt::format("is one of {} shards, {} of {}: cells would be there twice; remove one of the two",
                            content->shard.count, files[0].string(), *shards));
        if (seen[content->shard.index]++)
            throw InputError::in_file(
                file.string(), fmt::format("is shard {} again: it is there twice; remove one", content->shard.index));
        const std::size_t wanted = content->shard.of(out.campaign.cells);
        if (content->cells.size() < wanted) {
            unfinished.push_back(content->shard.index);
            why.push_back(fmt::format("shard {} has {} of {} cells{}", content->shard.index, content->cells.size(),
                                      wanted, content->torn ? ", and a torn line" : ""));
        }
        for (auto& [cell, rows] : content->cells)
            out.cells[cell] = std::move(rows);
    }
    if (!shards)
        throw InputError::in_file(folder.string(), "has no shard with a whole first line; run them again");
    for (std::size_t i = 0; i < *shards; ++i)
        if (!seen[i] && Shard{i, *shards}.of(out.campaign.cells) > 0) {
            unfinished.push_back(i);
            why.push_back(fmt::format("shard {} is missing", i));
        }
    if (unfinished.empty())
        return out;
    std::sort(unfinished.begin(), unfinished.end());
    const std::size_t shown = std::min<std::size_t>(why.size(), 5);
    throw InputError::in_file(
        folder.string(),
        fmt::format("{}{}. Run --shard I/{} for I = {}, or sbatch --array={} --export=ALL,CINCH_SHARDS={}",
                    fmt::join(why.begin(), why.begin() + static_cast<std::ptrdiff_t>(shown), "; "),
                    why.size() > shown ? fmt::format("; and {} more", why.size() - shown) : "", *shards,
                    ranges(unfinished), ranges(unfinished), *shards));
}

} // namespace cinch
