// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/measure/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace cinch {

Range operator/(const Range& a, const Range& b) { return {a.value / b.value, a.low / b.high, a.high / b.low}; }

Range range_of(std::vector<double> values)
{
    auto at = [&](std::size_t quarters) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * quarters / 4);
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    const double low = at(1), median = at(2), high = at(3);
    return {median, low, high};
}

Verdict at_most(const Range& measured, double limit)
{
    if (std::isnan(measured.value))
        return Verdict::unknown;
    return measured.high <= limit ? Verdict::holds : measured.low > limit ? Verdict::fails : Verdict::inconclusive;
}

Verdict at_least(const Range& measured, double limit)
{
    if (std::isnan(measured.value))
        return Verdict::unknown;
    return measured.low >= limit ? Verdict::holds : measured.high < limit ? Verdict::fails : Verdict::inconclusive;
}

Verdict all_of(const std::vector<Verdict>& verdicts)
{
    for (const Verdict worst : {Verdict::fails, Verdict::inconclusive, Verdict::holds})
        if (std::find(verdicts.begin(), verdicts.end(), worst) != verdicts.end())
            return worst;
    return Verdict::unknown;
}

const char* said_of_target(Verdict verdict)
{
    constexpr const char* words[] = {"reached", "FALLS SHORT", "inconclusive: spread too large", "not measured"};
    return words[static_cast<int>(verdict)];
}

const char* name_of(Verdict verdict)
{
    constexpr const char* words[] = {"holds", "fails", "inconclusive", "unknown"};
    return words[static_cast<int>(verdict)];
}

} // namespace cinch
