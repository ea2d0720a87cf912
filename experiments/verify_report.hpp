// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/report/provenance.hpp"
#include "experiments/verify.hpp"
#include "experiments/verify_lazy.hpp"
#include "experiments/verify_rows.hpp"
#include "experiments/verify_totals.hpp"

namespace cinch {

void print_table(const VerifiedInput& input, const VerifyOptions& options, const VerifyTotals& totals,
                 const Provenance& from);
/// By level, then violations, the exact attribution of the root, and totals.
std::vector<nlohmann::ordered_json> records_of(const VerifiedInput& input, const VerifyOptions& options,
                                               const VerifyTotals& totals);
/// The lines that both kinds of `verify` print of violations.
void print_examples(const VerifyTotals& totals, int kdop);

void print_lazy_table(const VerifiedInput& input, const VerifyOptions& options, const VerifyTotals& totals,
                      const LazyTotals& lazy, const Provenance& from);
std::vector<nlohmann::ordered_json> lazy_records_of(const VerifiedInput& input, const VerifyOptions& options,
                                                    const VerifyTotals& totals, const LazyTotals& lazy);

} // namespace cinch
