// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/report/provenance.hpp"
#include "experiments/verify.hpp"
#include "experiments/verify_lazy.hpp"
#include "experiments/verify_totals.hpp"

namespace cinch {

void print_table(const Inputs& input, const VerifyOptions& options, const VerifyTotals& totals, const Provenance& from);
/// The lines that both kinds of `verify` print of violations.
void print_examples(const VerifyTotals& totals, int kdop);
void print_json(const Inputs& input, const VerifyOptions& options, const VerifyTotals& totals, const Provenance& from);

void print_lazy_table(const Inputs& input, const VerifyOptions& options, const VerifyTotals& totals, const LazyTotals& lazy, const Provenance& from);
void print_lazy_json(const Inputs& input, const VerifyOptions& options, const VerifyTotals& totals, const LazyTotals& lazy, const Provenance& from);

} // namespace cinch
