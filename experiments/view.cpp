// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/view.hpp"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "toolkit/surface/input_error.hpp"

namespace cinch {

int view(const ViewOptions& options)
{
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    const bool there = std::filesystem::exists(options.report);
    std::ofstream file(options.report, std::ios::binary | std::ios::app); // what was there is kept until all is done
    if (!file)
        throw InputError::in_file(options.report, "cannot be written");
    file.close();
    if (!there)
        std::filesystem::remove(options.report);
    catch_interrupt();
    std::vector<nlohmann::ordered_json> views;
    for (const ViewRequest& request : options.request.scene.empty() ? report_views() : std::vector{options.request})
        if (views.empty() || !interrupted())
            views.push_back(make_view(request));
    const std::string page = view_page(views);
    file.open(options.report, std::ios::binary | std::ios::trunc);
    file << page;
    if (!file.flush())
        throw InputError::in_file(options.report, "writing failed; is the disk full?");
    for (const auto& made : views)
        fmt::print("{}: {}, {}\n", made["scene"].get<std::string>(), counted(made["time_s"].size(), "frame", "frames"),
                   counted(made["bounds"].size(), "method", "methods"));
    fmt::print("{}: {:.1f} MB\n", options.report, static_cast<double>(page.size()) / 1e6);
    if (!has_three())
        fmt::print(stderr, "cinch: built without three.js, the page says how to get it\n");
    if (interrupted()) {
        fmt::print(stderr, "cinch: interrupted; the page has what was done until then\n");
        return 130;
    }
    return 0;
}

} // namespace cinch
