// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/measure.hpp"

#include <algorithm>
#include <ctime>

#include <tbb/global_control.h>

#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/progress.hpp"

namespace cinch {
namespace {

constexpr double slow_ms = 100; // a frame of a slow backend, the first one apart, which may build
constexpr std::size_t slow_stride = 4, many_frames = 40; // which is measured once, in every fourth of many frames

double median(std::vector<double> all)
{
    if (all.empty())
        return 0;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
}

// More than any cache holds, read and written.
void evict_caches()
{
    static std::vector<std::uint64_t> other(16u << 20); // 128 MB
    for (std::size_t i = 0; i < other.size(); i += 8)
        other[i] += i;
}

struct Times {
    std::vector<double> evaluate, update, query, total; // per round
};

struct Contestant {
    std::unique_ptr<Backend> backend;
    std::vector<Times> frames;
    std::vector<double> pairs;       // per frame
    std::vector<QueryCounts> counts; // if it counts
    Measured out;
    bool slow = false;
};

void add(QueryCounts& sum, const QueryCounts& c)
{
    sum.body_pairs += c.body_pairs;
    sum.box_tests += c.box_tests;
    sum.leaf_pairs += c.leaf_pairs;
    sum.triangle_tests += c.triangle_tests;
    sum.in_double += c.in_double;
    sum.in_exact += c.in_exact;
    sum.updates.bounds += c.updates.bounds;
    sum.updates.leaves += c.updates.leaves;
    sum.updates.vertices += c.updates.vertices;
    sum.updates.merged += c.updates.merged;
}

// One frame, step by step. The first round also compares and counts.
void run_frame(Contestant& c, std::size_t frame, const MeasureOptions& options, std::vector<TrianglePair>& pairs)
{
    const clockid_t clock = options.threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    auto now = [clock] {
        timespec at{};
        clock_gettime(clock, &at);
        return 1e3 * static_cast<double>(at.tv_sec) + 1e-6 * static_cast<double>(at.tv_nsec);
    };
    throw_if_interrupted();
    if (options.cold)
        evict_caches();
    pairs.clear();
    const double start = now();
    c.backend->evaluate(frame);
    const double evaluated = now();
    throw_if_interrupted();
    c.backend->update();
    const double updated = now();
    throw_if_interrupted();
    c.backend->query(pairs);
    const double end = now();
    Times& t = c.frames[frame];
    t.evaluate.push_back(evaluated - start);
    t.update.push_back(updated - evaluated);
    t.query.push_back(end - updated);
    t.total.push_back(end - start);
}

} // namespace

std::vector<Measured> measure(const CollideScene& scene, const std::vector<BackendKind>& kinds,
                              const MeasureOptions& options)
{
    std::vector<std::vector<TrianglePair>> expected(scene.frames()); // of the first one
    std::vector<Contestant> all(kinds.size());
    {
        Progress progress(scene.name + ": building", kinds.size());
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            throw_if_interrupted();
            all[k].backend = kinds[k].make(scene);
            all[k].frames.resize(scene.frames());
            all[k].pairs.resize(scene.frames());
            all[k].counts.resize(scene.frames());
            all[k].out.backend = kinds[k].name;
            progress.done(k + 1);
        }
        scene.trees.forget();
    }
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
    if (options.threads == 1)
        pin_to_one_core();
    std::vector<TrianglePair> pairs;
    const std::size_t stride = scene.frames() < many_frames ? 1 : slow_stride;
    Progress progress(scene.name, kinds.size() * options.rounds);
    std::size_t done = 0;
    try {
        for (std::size_t round = 0; round < options.rounds; ++round)
            for (std::size_t k = 0; k < kinds.size(); ++k) {
                Contestant& c = all[k];
                for (std::size_t f = 0; f < scene.frames() && !(round > 0 && c.slow); ++f) {
                    if (c.slow && f % stride != 0)
                        continue;
                    run_frame(c, f, options, pairs);
                    if (round > 0)
                        continue;
                    c.slow |= f > 0 && c.frames[f].total[0] > slow_ms;
                    c.pairs[f] = static_cast<double>(pairs.size());
                    if (const QueryCounts* counts = c.backend->counts()) {
                        c.out.counts = true;
                        c.counts[f] = *counts;
                    }
                    std::sort(pairs.begin(), pairs.end());
                    if (k == 0) {
                        expected[f] = pairs;
                    } else {
                        std::vector<TrianglePair> different;
                        std::set_symmetric_difference(pairs.begin(), pairs.end(), expected[f].begin(),
                                                      expected[f].end(), std::back_inserter(different));
                        c.out.differing += different.size();
                    }
                }
                progress.done(++done);
            }
    } catch (const Interrupted&) { // a frame that was not whole left nothing
    }
    std::vector<Measured> results;
    for (Contestant& c : all) {
        std::vector<double> evaluate, update, query;
        std::vector<const Times*> measured;
        for (std::size_t f = 0; f < c.frames.size(); f += c.slow ? stride : 1) {
            const Times& t = c.frames[f];
            ++c.out.frames_wanted;
            c.out.rounds = t.total.size(); // those through all frames: of the last one
            if (t.total.empty())
                continue;
            measured.push_back(&t);
            c.out.pairs_of_frame.push_back(c.pairs[f]);
            add(c.out.sums, c.counts[f]);
            evaluate.push_back(median(t.evaluate));
            update.push_back(median(t.update));
            query.push_back(median(t.query));
            c.out.total_of_frame.push_back(median(t.total));
        }
        if (c.out.total_of_frame.empty())
            continue;
        c.out.frames = c.out.total_of_frame.size();
        c.out.rounds_wanted = c.slow ? 1 : options.rounds;
        c.out.evaluate_ms = median(evaluate);
        c.out.update_ms = median(update);
        c.out.query_ms = median(query);
        c.out.total_ms = median(c.out.total_of_frame);
        c.out.total_ms_low = c.out.total_ms_high = c.out.total_ms;
        for (std::size_t round = 0; round < c.out.rounds; ++round) {
            std::vector<double> of_round;
            for (const Times* t : measured)
                of_round.push_back(t->total[round]);
            const double middle = median(std::move(of_round));
            c.out.total_ms_low = std::min(c.out.total_ms_low, middle);
            c.out.total_ms_high = std::max(c.out.total_ms_high, middle);
        }
        c.out.pairs = median(c.out.pairs_of_frame);
        c.out.megabytes = static_cast<double>(c.backend->bytes()) / 1e6 / static_cast<double>(scene.bodies.size());
        results.push_back(std::move(c.out));
    }
    return results;
}

} // namespace cinch
