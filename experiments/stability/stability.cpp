// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/stability/stability.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/info.h>

#include "cinch/refit.hpp"
#include "cinch/surface.hpp"
#include "exact/verifier.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/provenance.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

constexpr const char* proof_expected = "every bound of its states proven";

std::string observed(const StabilityProof& proof)
{
    return fmt::format("{} of {} proven", grouped(proof.proven), grouped(proof.bounds));
}

} // namespace

std::vector<StabilityCase> stability_cases()
{
    std::vector<StabilityCase> all;
    for (const auto& cases : {model_cases(), bound_cases(), solver_cases(), contact_cases()})
        all.insert(all.end(), cases.begin(), cases.end());
    std::stable_sort(all.begin(), all.end(), [](const StabilityCase& a, const StabilityCase& b) {
        return a.name.substr(0, 2) < b.name.substr(0, 2);
    });
    return all;
}

StabilityProof prove(const std::vector<StabilityState>& states)
{
    StabilityProof proof;
    for (const StabilityState& state : states) {
        const Bvh bvh = build_bvh(state.surface, 1);
        if (bvh.bvs.empty())
            continue;
        const exact::Verifier verifier(state.surface, bvh, throw_if_interrupted);
        for (const Method method : kernel_methods)
            for (const Precision precision : {Precision::float32, Precision::float64})
                for (const int kdop : {6, 14}) {
                    Refitter refit(bvh, state.surface, {method, kdop, Rounding::proven, precision});
                    std::vector<double> supports(bvh.bvs.size() * static_cast<std::size_t>(kdop));
                    for (const auto& maps : state.frames) {
                        refit(maps, supports);
                        const exact::FrameVerdict verdict = verifier.check(maps, method, kdop, supports);
                        proof.bounds += supports.size();
                        proof.proven +=
                            static_cast<std::size_t>(std::count(verdict.failed.begin(), verdict.failed.end(), 0));
                    }
                }
    }
    return proof;
}

int stability(const StabilityOptions& options)
{
    std::vector<StabilityCase> cases;
    for (StabilityCase& c : stability_cases())
        if (options.cases.empty() ||
            std::any_of(options.cases.begin(), options.cases.end(),
                        [&](const std::string& part) { return c.name.find(part) != std::string::npos; }))
            cases.push_back(std::move(c));
    if (cases.empty())
        throw InputError(fmt::format("--case {}: no case has that in its name (see --list)", options.cases.front()));
    if (options.list) {
        for (const StabilityCase& c : cases)
            fmt::print("{}: {}\n", c.name, c.expected);
        return 0;
    }
    catch_interrupt();
    const Provenance from = provenance(tbb::info::default_concurrency(), 0);
    RecordOutput output(options.output, from);
    std::size_t run = 0, failed = 0;
    auto report = [&](const std::string& name, const std::string& expected, const std::string& seen, bool pass) {
        failed += !pass;
        ++run;
        output.add(
            {{"experiment", "stability"}, {"case", name}, {"expected", expected}, {"observed", seen}, {"pass", pass}});
        if (!options.output.records_only())
            fmt::print("{} {}\n     expected: {}\n     observed: {}\n", pass ? "pass" : "FAIL", name, expected, seen);
        std::fflush(stdout);
    };
    std::size_t done = 0;
    try {
        Progress progress("hard cases", cases.size());
        for (const StabilityCase& c : cases) {
            throw_if_interrupted();
            StabilityOutcome outcome;
            try {
                outcome = c.run(options.missing);
            } catch (const std::exception& error) {
                outcome = {false, std::string("threw: ") + error.what(), {}};
            }
            report(c.name, c.expected, outcome.observed, outcome.pass);
            if (!outcome.states.empty()) {
                const StabilityProof proof = prove(outcome.states);
                report(c.name + ": bounds", proof_expected, observed(proof),
                       proof.bounds > 0 && proof.proven == proof.bounds);
            }
            progress.done(++done);
        }
    } catch (const Interrupted&) { // cases before it are kept
    }
    const bool is_complete = done == cases.size();
    const Completeness completeness{0, 0, is_complete,
                                    is_complete ? "" : interrupted_after(done, cases.size(), "cases")};
    output.set(completeness);
    if (!is_complete) // those that came before had no way to know
        output.add({{"experiment", "stability"}, {"cases_done", done}, {"cases", cases.size()}});
    output.finish();
    if (!options.output.records_only() && !is_complete)
        fmt::print("\n{}", completeness.note);
    if (!options.output.records_only())
        fmt::print("\n{} of {} rows pass\n{}\n", run - failed, run, describe(from));
    if (failed)
        return 1;
    if (!is_complete) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}\n", completeness.note);
        return 130;
    }
    return 0;
}

} // namespace cinch
