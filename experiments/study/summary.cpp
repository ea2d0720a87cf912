// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/summary.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "experiments/report/table.hpp"

namespace cinch {
namespace {

const std::vector<std::string> keys{"input", "motion", "n", "method", "precision", "kdop"};

std::string shown(const nlohmann::ordered_json& value)
{
    return value.is_string() ? value.get<std::string>() : value.dump();
}

} // namespace

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

std::vector<Chart> study_charts(const Merged& all)
{
    std::vector<std::string> order;
    std::map<std::string, std::map<double, std::vector<double>>> lines; // by name and simulation nodes
    std::map<std::string, std::set<std::string>> different;             // values of a key
    for (const Rows& rows : all.cells)
        for (const auto& row : rows)
            for (const std::string& field : keys)
                different[field].insert(shown(row[field]));
    for (const Rows& rows : all.cells)
        for (const auto& row : rows) {
            if (!row.contains("root_max_ratio") || !row["root_ratio"].is_number())
                continue;
            std::string name;
            for (const std::string& field : keys)
                if (field != "n" && (different[field].size() > 1 || field == "method"))
                    name += std::string(name.empty() ? "" : ", ") + (field == "kdop" ? "k = " : "") + shown(row[field]);
            if (!lines.contains(name))
                order.push_back(name);
            lines[name][row["n"].get<double>()].push_back(row["root_ratio"]);
        }
    Chart chart{"root against simulation nodes",
                "simulation nodes",
                "radius over the true one, mean over frames",
                true,
                false,
                {}};
    bool is_line = false;
    for (const std::string& name : order) {
        Series series{name, {}, {}, false, {}, {}};
        bool has_band = false;
        for (const auto& [n, ratios] : lines[name]) {
            const Spread spread = spread_of(ratios);
            series.x.push_back(n);
            series.y.push_back(spread.mean);
            series.low.push_back(spread.mean - spread.half_width);
            series.high.push_back(spread.mean + spread.half_width);
            has_band |= spread.count > 1;
        }
        if (!has_band)
            series.low.clear(), series.high.clear();
        is_line |= series.x.size() > 1;
        chart.series.push_back(std::move(series));
    }
    return is_line ? std::vector<Chart>{chart} : std::vector<Chart>{};
}

std::string study_table(const Merged& all)
{
    const std::vector<std::string> values{"root_ratio", "mean_ratio", "max_ratio", "width_ratio"};
    std::vector<std::vector<std::string>> order; // as they come
    std::map<std::vector<std::string>, std::map<std::string, std::vector<double>>> groups;
    for (const Rows& rows : all.cells)
        for (const auto& row : rows) {
            if (!row.contains("root_max_ratio")) // a detail
                continue;
            std::vector<std::string> key;
            for (const std::string& field : keys)
                key.push_back(shown(row[field]));
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
