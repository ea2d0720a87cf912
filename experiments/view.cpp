// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/view.hpp"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/record_output.hpp"
#include "toolkit/surface/input_error.hpp"

namespace cinch {

int view(const ViewOptions& options)
{
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (options.report.empty() && !options.json)
        throw InputError("view: --report FILE.html or --json is needed");
    std::ofstream file;
    if (!options.report.empty()) { // what was there is kept until all is done
        const bool there = std::filesystem::exists(options.report);
        file.open(options.report, std::ios::binary | std::ios::app);
        if (!file)
            throw InputError::in_file(options.report, "cannot be written");
        file.close();
        if (!there)
            std::filesystem::remove(options.report);
    }
    catch_interrupt();
    RecordOutput output({options.json, false, {}, {}}, provenance(threads, options.request.seed));
    std::vector<nlohmann::ordered_json> views;
    std::vector<ViewRequest> wanted = options.request.scene.empty() ? report_views() : std::vector{options.request};
    for (ViewRequest& request : wanted)
        request.seed = options.request.seed;
    for (const ViewRequest& request : wanted)
        if (views.empty() || !interrupted()) {
            views.push_back(make_view(request));
            output.describe({{"partial", !views.back()["missing"].empty()}, {"missing", views.back()["missing"]}});
            output.add({{"experiment", "view"}, {"scene", views.back()["scene"]}, {"frames", views.back()["time_s"].size()}, {"view", views.back()}});
        }
    output.finish();
    if (interrupted() && options.report.empty())
        return 130;
    if (options.report.empty())
        return 0;
    const std::string page = view_page(views);
    file.open(options.report, std::ios::binary | std::ios::trunc);
    file << page;
    if (!file.flush())
        throw InputError::in_file(options.report, "writing failed; is the disk full?");
    for (const auto& made : views)
        fmt::print(options.json ? stderr : stdout, "{}: {}, {}\n", made["scene"].get<std::string>(), counted(made["time_s"].size(), "frame", "frames"),
                   counted(made["bounds"].size(), "method", "methods"));
    fmt::print(options.json ? stderr : stdout, "{}: {:.1f} MB\n", options.report, static_cast<double>(page.size()) / 1e6);
    if (!has_three())
        fmt::print(stderr, "cinch: built without three.js, the page says how to get it\n");
    if (interrupted()) {
        fmt::print(stderr, "cinch: interrupted; the page has what was done until then\n");
        return 130;
    }
    return 0;
}

} // namespace cinch
