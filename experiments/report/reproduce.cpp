// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/reproduce.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/records/shard.hpp"
#include "experiments/report/chart.hpp"
#include "experiments/report/child.hpp"
#include "experiments/report/file_lock.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/page/page.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/report/results.hpp"
#include "experiments/report/stages.hpp"
#include "experiments/report/whole_file.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string command_of(const std::vector<std::string>& arguments)
{
    return fmt::format("cinch {}", fmt::join(arguments, " "));
}

/// Whether the stored file is what this run would make, or all of what a quick run makes a part of.
bool is_stored(const fs::path& file, const Stage& stage, const ReproduceOptions& options)
{
    std::error_code error;
    if (!fs::exists(file, error))
        return false;
    std::vector<Damage> damage;
    const std::vector<Record> records = read_results(file, damage);
    if (records.empty())
        return false;
    const Record& closing = records.back();
    if (closing.number("status") != 0 || closing.word("commit") != provenance(1, 0).commit)
        return false;
    const std::string by = closing.word("measured_by");
    return by == command_of(arguments_of(stage, options.quick, options.seed)) ||
           by == command_of(arguments_of(stage, false, options.seed));
}

/// The last line of a file: what makes it whole.
std::string closing_line(const Stage& stage, const ReproduceOptions& options, std::size_t lines, int status,
                         double seconds)
{
    return json_line({{"experiment", "reproduce"},
                      {"stage", stage.name},
                      {"what", stage.what},
                      {"lines", lines},
                      {"status", status},
                      {"seconds", seconds},
                      {"measured_by", command_of(arguments_of(stage, options.quick, options.seed))},
                      {"quick", options.quick},
                      {"finished", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))}},
                     provenance(1, options.seed));
}

enum class Outcome { stored, check_failed, failed, interrupted };

Outcome run(const Stage& stage, const ReproduceOptions& options)
{
    const fs::path file = fs::path(options.out) / (stage.name + ".jsonl"),
                   part = fs::path(options.out) / (stage.name + ".part");
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> arguments = arguments_of(stage, options.quick, options.seed);
    const fs::path cells =
        fs::path(options.out) /
        fmt::format("{}-{}-{:016x}.cells", stage.name, provenance(1, 0).commit, checksum(command_of(arguments)));
    if (stage.runs_in_cells())
        arguments.insert(arguments.end(), {"--out", cells.string()});
    const int status = run_child(arguments, part);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::error_code ignored;
    if (interrupted() || status == 130) {
        fs::remove(part, ignored);
        return Outcome::interrupted;
    }
    if (status != 0 && status != 1) { // 1: complete, but a check failed
        fs::remove(part, ignored);
        return Outcome::failed;
    }
    std::size_t lines = 0;
    {
        std::ifstream in(part);
        for (std::string line; std::getline(in, line);)
            ++lines;
    }
    if (lines == 0)
        return Outcome::failed;
    write_whole(file, sealed(read_bytes(part), closing_line(stage, options, lines, status, seconds)));
    fs::remove(part, ignored);
    fs::remove_all(cells, ignored);
    return status == 0 ? Outcome::stored : Outcome::check_failed;
}

/// Reads what is stored and writes the page. Damage goes to standard error too.
std::vector<Damage> write_page(const fs::path& folder, const fs::path& page)
{
    for (const Stage& stage : stages())
        guard_input(folder / (stage.name + ".jsonl"));
    WholeFile whole(page);
    Results results;
    ReportNotes notes;
    std::vector<std::string> never_quick;
    bool is_quick = false;
    for (const Stage& stage : stages()) {
        const fs::path file = folder / (stage.name + ".jsonl");
        std::error_code error;
        if (!fs::exists(file, error)) {
            (stage.quick.empty() ? never_quick : notes.missing).push_back(stage.what);
            continue;
        }
        for (Record& record : read_results(file, notes.damage)) {
            is_quick |= is_closing(record) && record.fields.value("quick", false);
            results.add(std::move(record));
        }
    }
    std::vector<std::string>& left_out = is_quick ? notes.left_out : notes.missing;
    left_out.insert(left_out.end(), never_quick.begin(), never_quick.end());
    whole.write(report_page(results, notes));
    whole.commit();
    for (const Damage& damage : notes.damage)
        fmt::print(stderr, "cinch: {}\n",
                   describe({(folder / damage.file).string(), damage.line, damage.what + "; the file is left out"}));
    return notes.damage;
}

} // namespace

int reproduce(const ReproduceOptions& options)
{
    require_gnuplot("cinch reproduce");
    std::error_code error;
    fs::create_directories(options.out, error);
    // Two runs at once would take turns in spoiling each other's measurements.
    const Shard shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
    const std::string lock_name = shard.count == 1 ? ".lock" : fmt::format(".lock-{}-{}", shard.index, shard.count);
    const FileLock lock(fs::path(options.out) / lock_name, options.out,
                        "another 'cinch reproduce' is writing there; wait for it, or use another --out");
    catch_interrupt();
    std::vector<Stage> wanted;
    double left = 0;
    std::size_t number = 0, stored = 0;
    for (Stage& stage : stages()) {
        if ((options.quick && stage.quick.empty()) || !shard.has(number++))
            continue;
        if (is_stored(fs::path(options.out) / (stage.name + ".jsonl"), stage, options)) {
            fmt::print(stderr, "{}: stored\n", stage.name);
            ++stored;
            continue;
        }
        left += options.quick ? stage.quick_seconds : stage.seconds;
        wanted.push_back(std::move(stage));
    }
    const double planned = left;
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> bad;
    bool refuted = false;
    for (std::size_t i = 0; i < wanted.size() && !interrupted(); ++i) {
        const Stage& stage = wanted[i];
        // What is left in proportion to how long the others took, once they say something about this machine.
        const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                     done = planned - left;
        fmt::print(stderr, "{}/{} {}: {}; {} left\n", i + 1, wanted.size(), stage.name, stage.what,
                   duration(left * (done > 0.05 * planned ? elapsed / done : 1)));
        switch (run(stage, options)) {
        case Outcome::stored:
            ++stored;
            break;
        case Outcome::check_failed:
            ++stored;
            bad.push_back(stage.name + ": a check failed");
            refuted = true;
            break;
        case Outcome::failed:
            bad.push_back(stage.name + ": 'cinch' failed, nothing is stored");
            break;
        case Outcome::interrupted:
            continue;
        }
        left -= options.quick ? stage.quick_seconds : stage.seconds;
    }
    const fs::path page = fs::path(options.out) / "report.html";
    std::vector<Damage> damage;
    if (shard.count == 1)
        damage = write_page(options.out, page);
    for (const std::string& what : bad)
        fmt::print(stderr, "cinch: {}\n", what);
    if (interrupted()) {
        fmt::print(stderr, "cinch: interrupted; what is finished is kept, and the same command continues\n");
        return 130;
    }
    if (shard.count == 1)
        fmt::print("{}\n", page.string());
    else
        fmt::print("shard {} of {}: {} are stored in {}; when all shards are, run 'cinch merge {}'\n", shard.index,
                   shard.count, counted(stored, "experiment", "experiments"), options.out, options.out);
    return refuted ? 1 : bad.empty() && damage.empty() ? 0 : 2;
}

bool holds_results(const std::string& folder)
{
    std::error_code error;
    const auto all = stages();
    return std::any_of(all.begin(), all.end(), [&](const Stage& stage) {
        return fs::exists(fs::path(folder) / (stage.name + ".jsonl"), error);
    });
}

int merge_results(const std::string& folder)
{
    ReproduceOptions options{folder, false, 0, ""};
    for (const Stage& stage : stages()) { // of what run: as the first one stored says
        const fs::path file = fs::path(folder) / (stage.name + ".jsonl");
        std::vector<Damage> damage;
        const auto records = fs::exists(file) ? read_results(file, damage) : std::vector<Record>{};
        if (records.empty())
            continue;
        options.quick = records.back().fields.value("quick", false);
        options.seed = records.back().fields.value("seed", std::uint64_t{0});
        break;
    }
    std::vector<std::string> missing;
    for (const Stage& stage : stages())
        if (!(options.quick && stage.quick.empty()) &&
            !is_stored(fs::path(folder) / (stage.name + ".jsonl"), stage, options))
            missing.push_back(stage.name);
    if (!missing.empty())
        throw InputError::in_file(folder,
                                  fmt::format("lacks {}; 'cinch reproduce{}{} --out {}' runs what is missing",
                                              fmt::join(missing, ", "), options.quick ? " --quick" : "",
                                              options.seed ? fmt::format(" --seed {}", options.seed) : "", folder));
    return report({folder, ""});
}

int report(const ReportOptions& options)
{
    require_gnuplot("cinch report");
    const fs::path folder = options.folder;
    if (!holds_results(options.folder))
        throw InputError::in_file(options.folder,
                                  "holds no results; 'cinch reproduce --out " + options.folder + "' makes them");
    const fs::path page = options.page.empty() ? folder / "report.html" : fs::path(options.page);
    const auto damage = write_page(folder, page);
    fmt::print("{}\n", page.string());
    return damage.empty() ? 0 : 2;
}

} // namespace cinch
