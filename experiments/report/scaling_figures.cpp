// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/scaling_figures.hpp"

#include <string>

#include <fmt/format.h>

namespace cinch {

const PaperFigure& ScalingSize::eq12(std::size_t nodes) const
{
    return paper_figure("Table 1", paper, std::to_string(nodes));
}

const Record* ScalingFigures::record(const char* method, std::size_t vertices, std::size_t n) const
{
    for (const Record* r :
         results.where({{"experiment", "scaling"}, {"method", method}, {"vertices", vertices}, {"n", n}}))
        if (!r->fields.contains("input") && r->number("ns_per_bound") > 0)
            return r;
    return nullptr;
}

Traced ScalingFigures::us(const char* method, std::size_t vertices, std::size_t n) const
{
    const Record* r = record(method, vertices, n);
    return r ? Results::number(*r, "ns_per_bound") / 1e3 : Traced{};
}

Traced ScalingFigures::over_default(const char* method, std::size_t vertices, std::size_t n) const
{
    const Record* r = record(method, vertices, n);
    return r ? Results::number(*r, "over_default") : Traced{};
}

Traced ScalingFigures::exponent(const char* method, std::size_t vertices) const
{
    std::vector<double> n, us_of_n;
    std::vector<Range> range;
    Traced all{0, {}};
    for (const std::size_t nodes : scaling_nodes) {
        const Traced time = us(method, vertices, nodes);
        n.push_back(static_cast<double>(nodes));
        us_of_n.push_back(time.value);
        range.push_back(time.range());
        all = all + time;
    }
    if (all.known()) {
        all.value = log_slope(n, us_of_n);
        std::vector<double> flat = us_of_n, steep = us_of_n; // as far as the quartiles allow
        flat.front() = range.front().high;
        flat.back() = range.back().low;
        steep.front() = range.front().low;
        steep.back() = range.back().high;
        all.low = log_slope(n, flat);
        all.high = log_slope(n, steep);
    }
    return all;
}

Traced ScalingFigures::over_fewest_vertices(const char* method, std::size_t n) const
{
    return us(method, 145000, n) / us(method, 3500, n);
}

std::vector<Figure> ScalingFigures::with_targets() const
{
    std::vector<Figure> figures;
    auto figure = [&](std::string what, const Traced& x, const char* format, std::string target, Verdict is) {
        figures.emplace_back(std::move(what), fmt::format(fmt::runtime(format), x.value) + mark(x.range()),
                             std::move(target), is);
    };
    auto over = [&](const char* method) { return over_default(method, 30000, 509); };
    const Record* of_default = record("best", 30000, 509);
    const int times = of_default && of_default->word("precision") == "double" ? 18 : 25;
    const Traced textbook = over("textbook"), eq12 = 1 / over("eq12"), proof = 1 / over("unproven");
    figure("textbook Eq. 12 / default, n = 509", textbook, "{:.1f}", fmt::format(">= {}", times),
           at_least(textbook.range(), times));
    figure("textbook by centre and axes / default", over("textbook-axes"), "{:.1f}", "-", Verdict::holds);
    figure("default / own SIMD eq12, n = 509", eq12, "{:.2f}", "<= 1", at_most(eq12.range(), 1));
    figure("proven / unproven default, n = 509", proof, "{:.2f}", "<= 1.10", at_most(proof.range(), 1.1));
    for (const std::size_t n : scaling_nodes) {
        const Traced invariance = over_fewest_vertices("best", n);
        figure(fmt::format("145K vertices / 3.5K, n = {}", n), invariance, "{:.2f}", "<= 1.1",
               at_most(invariance.range(), 1.1));
    }
    const Traced slope = exponent("best", 30000), optimal = over_default("optimal", 145000, 509);
    figure("exponent of n in the default's time", slope, "{:.2f}", "<= 1", at_most(slope.range(), 1));
    figure("optimal AABB at 145K / default, n = 509", optimal, "{:.0f}", ">= 2000", at_least(optimal.range(), 2000));
    return figures;
}

} // namespace cinch
