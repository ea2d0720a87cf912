// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace cinch {

/// A measured value and how far it is known: the quartiles of its rounds; the value itself where it is exact.
struct Range {
    double value, low, high;

    Range(double exact) : Range(exact, exact, exact) {}
    Range(double median, double quarter, double three_quarters) : value(median), low(quarter), high(three_quarters) {}

    /// Whether its quartiles are at most a tenth apart: else what is printed of it is marked.
    bool is_settled() const { return high - low <= 0.1 * value; }
};

/// Of positive ranges that were not measured together: everything between the extremes.
Range operator/(const Range& a, const Range& b);

/// Of values, none NaN; at least one.
Range range_of(std::vector<double> values);

/// What a measurement says of a statement. Every table, figure and claim is decided here.
enum class Verdict { holds, fails, inconclusive, unknown };

/// Inconclusive where the limit lies between the quartiles; unknown where nothing was measured (NaN).
Verdict at_most(const Range& measured, double limit);
Verdict at_least(const Range& measured, double limit);

/// Of several statements together: unknown ones are left out, unless there are no others.
Verdict all_of(const std::vector<Verdict>& verdicts);

/// "reached", "FALLS SHORT", "inconclusive: spread too large", "not measured".
const char* said_of_target(Verdict verdict);
/// "holds", "fails", "inconclusive", "unknown", as records have it.
const char* name_of(Verdict verdict);

} // namespace cinch
