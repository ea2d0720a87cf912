// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/view.hpp"

#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/surface.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/report/whole_file.hpp"

namespace cinch {

using Json = nlohmann::ordered_json;

int view(const ViewOptions& options)
{
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (options.report.empty() && !options.json)
        throw InputError("view: --report FILE.html or --json is needed");
    std::optional<WholeFile> file;
    if (!options.report.empty())
        file.emplace(options.report);
    OutputOptions records;
    records.json = options.json;
    RecordOutput output(records, provenance(threads, options.request.seed));
    std::vector<Json> views;
    std::vector<ViewRequest> wanted = options.request.scene.empty() ? report_views() : std::vector{options.request};
    for (ViewRequest& request : wanted)
        request.seed = options.request.seed;
    catch_interrupt();
    std::size_t whole = 0;
    try {
        for (const ViewRequest& request : wanted) {
            throw_if_interrupted();
            Json view = make_view(request);
            const std::size_t done = view["bounds"].size(), methods = view["methods"].get<std::size_t>(),
                              frames = view["time_s"].size();
            if (done < methods)
                view["text"] = fmt::format("{} ({})", view["text"].get<std::string>(),
                                           interrupted_after(done, methods, "methods"));
            whole += done == methods;
            output.describe({{"partial", !view["missing"].empty()}, {"missing", view["missing"]}});
            output.add({{"experiment", "view"},
                        {"scene", view["scene"]},
                        {"frames_done", frames},
                        {"frames", frames},
                        {"complete", done == methods},
                        {"view", view}});
            views.push_back(std::move(view));
        }
    } catch (const Interrupted&) { // the views before are kept
        if (views.empty())
            throw;
    }
    const std::string note =
        whole == wanted.size() ? "" : interrupted_after(whole, wanted.size(), wanted.size() == 1 ? "view" : "views");
    if (!note.empty()) // those that came before had no way to know
        output.add({{"experiment", "view"}, {"views_done", whole}, {"views", wanted.size()}, {"complete", false}});
    output.finish();
    if (file) {
        const std::string page = view_page(views, note);
        file->write(page);
        file->commit();
        if (!note.empty())
            fmt::print(options.json ? stderr : stdout, "{}:\n", note);
        for (const auto& made : views)
            fmt::print(options.json ? stderr : stdout, "{}: {}, {}\n", made["scene"].get<std::string>(),
                       counted(made["time_s"].size(), "frame", "frames"),
                       counted(made["bounds"].size(), "method", "methods"));
        fmt::print(options.json ? stderr : stdout, "{}: {:.1f} MB\n", options.report,
                   static_cast<double>(page.size()) / 1e6);
        if (!has_three())
            fmt::print(stderr, "cinch: built without three.js, the page says how to get it\n");
    }
    if (!note.empty()) {
        std::fflush(stdout);
        fmt::print(stderr, "cinch: {}\n", note);
        return 130;
    }
    return 0;
}

} // namespace cinch
