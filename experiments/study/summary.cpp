// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/summary.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "experiments/report/table.hpp"

namespace cinch {

Spread spread_of(std::vector<double> values)
{
    Spread out;
    out.count = values.size();
    if (values.empty())
        return out;
    std::sort(values.begin(), values.end());
    const double n = static_cast<double>(values.size());
    for (const double x : values)
        out.mean += x / n;
    double squares = 0;
    for (const double x : values)
        squares += (x - out.mean) * (x - out.mean);
    if (values.size() > 1) {
        const boost::math::students_t t(n - 1);
        out.half_width = boost::math::quantile(t, 0.975) * std::sqrt(squares / (n - 1) / n);
    }
    auto quantile = [&](double q) {
        const double at = q * (n - 1), below = std::floor(at);
        const auto i = static_cast<std::size_t>(below);
        return i + 1 < values.size() ? values[i] + (at - below) * (values[i + 1] - values[i]) : values[i];
    };
    out.least = values.front();
    out.lower = quantile(0.25);
    out.median = quantile(0.5);
    out.upper = quantile(0.75);
    out.greatest = values.back();
    return out;
}

std::string study_table(const Merged& all)
{
    const std::vector<std::string> keys{"input", "motion", "n", "method", "precision", "kdop"};
    const std::vector<std::string> values{"root_ratio", "mean_ratio", "max_ratio", "width_ratio"};
    std::vector<std::vector<std::string>> order; // as they come
    std::map<std::vector<std::string>, std::map<std::string, std::vector<double>>> groups;
    for (const Rows& rows : all.cells)
        for (const auto& row : rows) {
            if (!row.contains("root_max_ratio")) // a detail
                continue;
            std::vector<std::string> key;
            for (const std::string& field : keys)
                key.push_back(row[field].is_string() ? row[field].get<std::string>() : row[field].dump());
            auto [group, is_new] = groups.try_emplace(key);
            if (is_new)
                order.push_back(key);
            for (const std::string& field : values)
                if (row[field].is_number())
                    group->second[field].push_back(row[field]);
        }
    std::vector<std::string> header{"input", "motion", "n",      "method", "precision", "k",   "seeds", "root", "+-",
                                    "least", "25%",    "median", "75%",    "most",      "all", "max",   "width"};
    std::vector<std::vector<std::string>> table_rows;
    for (const auto& key : order) {
        auto& group = groups[key];
        const Spread root = spread_of(group["root_ratio"]);
        std::vector<std::string> row = key;
        row.push_back(std::to_string(root.count));
        auto put = [&](double x, bool known) { row.push_back(known ? fmt::format("{:.3f}", x) : "-"); };
        put(root.mean, root.count > 0);
        put(root.half_width, root.count > 1);
        for (const double x : {root.least, root.lower, root.median, root.upper, root.greatest})
            put(x, root.count > 0);
        const auto& most = group["max_ratio"];
        put(spread_of(group["mean_ratio"]).mean, !group["mean_ratio"].empty());
        put(most.empty() ? 0 : *std::max_element(most.begin(), most.end()), !most.empty());
        put(spread_of(group["width_ratio"]).mean, !group["width_ratio"].empty());
        table_rows.push_back(std::move(row));
    }
    // What is the same in every row is said once, above.
    std::string same;
    for (std::size_t column = 0; column < keys.size() && !table_rows.empty();) {
        const std::string first = table_rows[0][column];
        if (table_rows.size() > 1 &&
            std::all_of(table_rows.begin(), table_rows.end(), [&](const auto& row) { return row[column] == first; }) &&
            header[column] != "method") {
            same += (same.empty() ? "" : ", ") + header[column] + " " + first;
            header.erase(header.begin() + static_cast<std::ptrdiff_t>(column));
            for (auto& row : table_rows)
                row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
            continue;
        }
        if (++column >= header.size() || header[column] == "seeds")
            break;
    }
    return (same.empty() ? "" : same + "\n\n") + table(header, table_rows);
}

} // namespace cinch
