// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/picture_output.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/page.hpp"
#include "experiments/report/whole_file.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

class Files : public PictureOutput {
public:
    explicit Files(const OutputOptions& options) : options_(options)
    {
        if (!options.plot.empty()) {
            picture_of(options.plot);
            require_gnuplot("--plot");
            plot_.emplace(options.plot);
        }
        if (!options.plot_data.empty())
            plot_data_.emplace(options.plot_data);
        if (!options.report.empty()) {
            require_gnuplot("--report");
            page_.emplace(options.report);
        }
    }

    void write(const std::vector<Json>& records, const Json& from, const std::vector<Chart>& more,
               const std::string& note) override
    {
        const Results results = results_of(records, from);
        std::vector<Chart> charts = more;
        for (const html::ChartFigure& chart : charts_of(results))
            if (std::any_of(chart.chart.series.begin(), chart.chart.series.end(),
                            [](const Series& series) { return !series.x.empty(); }))
                charts.push_back(chart.chart);
        draw(charts, note);
        if (page_) {
            page_->write(command_page(results, note));
            page_->commit();
        }
    }

private:
    void draw(const std::vector<Chart>& charts, const std::string& note)
    {
        if (plot_data_) {
            plot_data_->write(data_of(charts));
            plot_data_->commit();
        }
        if (!plot_ || charts.empty())
            return;
        const Picture picture = picture_of(options_.plot);
        plot_->write(drawn(charts[0], picture, note));
        plot_->commit();
        const std::size_t dot = options_.plot.rfind('.');
        for (std::size_t i = 1; i < charts.size(); ++i) {
            const std::string name =
                fmt::format("{}-{}{}", options_.plot.substr(0, dot), i + 1, options_.plot.substr(dot));
            write_whole(name, drawn(charts[i], picture, note));
            fmt::print(stderr, "{}: {}\n", name, charts[i].title);
        }
    }

    OutputOptions options_;
    std::optional<WholeFile> plot_, plot_data_, page_;
};

} // namespace

std::unique_ptr<PictureOutput> picture_output(const OutputOptions& options)
{
    if (options.plot.empty() && options.plot_data.empty() && options.report.empty())
        return nullptr;
    return std::make_unique<Files>(options);
}

} // namespace cinch
