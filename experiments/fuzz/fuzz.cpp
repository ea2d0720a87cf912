// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/fuzz/fuzz.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include "cinch/surface.hpp"
#include "experiments/fuzz/fuzz_failure.hpp"
#include "experiments/fuzz/fuzz_rows.hpp"
#include "experiments/fuzz/fuzz_state.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/provenance.hpp"

namespace cinch {
namespace {

using Clock = std::chrono::steady_clock;

// Cases are run in blocks, which a kill loses and an interrupt waits for: long enough to occupy all threads, short
// enough for both.
constexpr std::uint64_t first_block = 64, largest_block = 8192;
constexpr auto shortest = std::chrono::milliseconds(20), longest = std::chrono::milliseconds(80),
               between_saves = std::chrono::milliseconds(100);

class Session {
public:
    explicit Session(const FuzzOptions& options)
        : options_(options), shard_(options.shards.shard.empty() ? Shard{} : parse_shard(options.shards.shard)),
          threads_(options.threads > 0 ? options.threads : tbb::info::default_concurrency()),
          terminal_(draws_over_lines()), output_(options.output, provenance(threads_, options.seed))
    {
        if (options_.resume.empty())
            return;
        const Provenance from = provenance(threads_, options_.seed);
        file_.emplace(options_.resume, FuzzSettings{from.version, from.commit, options_.seed, options_.family,
                                                    shard_.index, shard_.count, name_of(options_.defect)});
        state_ = file_->found();
        resumed_from_ = state_.next;
        seconds_before_ = state_.seconds;
        if (options_.cases && state_.next > *options_.cases)
            throw InputError::in_file(
                options_.resume,
                fmt::format("field \"next\": {} cases are done, more than --cases {}", state_.next, *options_.cases));
    }

    int run()
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads_));
        catch_interrupt();
        start_ = Clock::now();
        while (!interrupted() && !finished()) {
            run_block();
            if (Clock::now() - saved_ > between_saves)
                save_state();
            show();
        }
        save_state();
        if (terminal_)
            fmt::print(stderr, "\r\x1b[K");
        summarise();
        return state_.violations ? 1 : interrupted() ? 130 : 0;
    }

private:
    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    bool finished() const
    {
        return (options_.cases && state_.next >= *options_.cases) ||
               (options_.seconds && elapsed() >= *options_.seconds);
    }

    void run_block()
    {
        const auto start = Clock::now();
        const std::uint64_t first = state_.next;
        const std::uint64_t count = options_.cases ? std::min(block_, *options_.cases - first) : block_;
        std::vector<std::string> faults(count);
        tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 8), [&](const auto& range) {
            for (std::uint64_t i = range.begin(); i < range.end() && !interrupted(); ++i)
                faults[i] = find_fault(draw(first + i), options_.defect);
        });
        if (interrupted())
            return; // not all of it: a resumed run begins with it
        const auto took = Clock::now() - start;
        block_ = took < shortest  ? std::min(2 * block_, largest_block)
                 : took > longest ? std::max(block_ / 2, first_block)
                                  : block_;
        for (std::uint64_t i = 0; i < count; ++i)
            if (!faults[i].empty())
                report(first + i);
        state_.next = first + count;
    }

    FuzzCase draw(std::uint64_t of_shard) const
    {
        return draw_case(options_.seed, of_shard * shard_.count + shard_.index, options_.family);
    }

    void report(std::uint64_t of_shard)
    {
        ++state_.violations;
        const FuzzCase found = draw(of_shard);
        // The first failure of each family is shrunk: a broken bound fails everywhere.
        if (!state_.shrunk.insert(found.family).second)
            return;
        const FuzzFailure failure = shrink_and_save(found, options_.defect, options_.corpus);
        if (terminal_)
            fmt::print(stderr, "\r\x1b[K");
        const std::uint64_t index = of_shard * shard_.count + shard_.index;
        output_.add(record_of(failure, index));
        if (!options_.output.records_only())
            print(failure, index);
        std::fflush(stdout);
    }

    void save_state()
    {
        saved_ = Clock::now();
        state_.seconds = seconds_before_ + elapsed();
        if (file_)
            file_->save(state_);
    }

    void show() const
    {
        if (!terminal_)
            return;
        const double now = elapsed();
        std::string left;
        if (options_.seconds)
            left = ", " + duration(std::max(0.0, *options_.seconds - now)) + " left";
        fmt::print(
            stderr, "\r\x1b[K{} cases, {} per second, {} violations{}", grouped(state_.next),
            grouped(static_cast<std::size_t>(static_cast<double>(state_.next - resumed_from_) / std::max(now, 1e-3))),
            grouped(state_.violations), left);
        std::fflush(stderr);
    }

    void summarise()
    {
        const bool is_complete = !interrupted() || finished();
        output_.set(
            {0, 0, is_complete, is_complete ? "" : fmt::format("interrupted after {} cases", grouped(state_.next))});
        const Provenance from = provenance(threads_, options_.seed);
        const double seconds = state_.seconds;
        output_.add({{"experiment", "fuzz"},
                     {"cases", state_.next},
                     {"violations", state_.violations},
                     {"seconds", seconds},
                     {"family", options_.family},
                     {"shard", shard_.index},
                     {"shards", shard_.count}});
        output_.finish();
        if (options_.output.records_only())
            return;
        if (!is_complete)
            fmt::print("interrupted: not all that was asked for\n");
        fmt::print("{} cases, {} violations\n{}, {} cases per second\n{}\n", grouped(state_.next),
                   grouped(state_.violations), duration(seconds),
                   grouped(static_cast<std::size_t>(static_cast<double>(state_.next) / std::max(seconds, 1e-3))),
                   describe(from));
    }

    const FuzzOptions& options_;
    Shard shard_;
    int threads_;
    bool terminal_;
    RecordOutput output_;
    std::optional<FuzzStateFile> file_;
    FuzzState state_;
    std::uint64_t resumed_from_ = 0, block_ = first_block;
    double seconds_before_ = 0; ///< of a resumed state
    Clock::time_point start_, saved_;
};

} // namespace

int fuzz(const FuzzOptions& options)
{
    if (options.defect != Defect::none && is_of_times(options.defect) != (options.family == "times"))
        throw InputError(fmt::format("--sabotage {} {} --family times", name_of(options.defect),
                                     is_of_times(options.defect) ? "needs" : "is not for"));
    if (options.seconds && !(std::isfinite(*options.seconds) && *options.seconds >= 0)) // NaN is in every range
        throw InputError(fmt::format("--seconds {}: expected seconds >= 0", *options.seconds));
    if (!options.shards.folder.empty())
        return fuzz_in_cells(options);
    return Session(options).run();
}

} // namespace cinch
