// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "exact/corners.hpp"
#include "exact/optimum.hpp"
#include "experiments/bench/measure.hpp"
#include "experiments/report/number.hpp"

namespace cinch::bench {
namespace {

using cinch::exact::Exact;

struct Space {
    std::vector<double> l, h;
    WeightSpace view() const { return {l, h}; }
};

Space generic(std::size_t n, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    Space s;
    for (std::size_t j = 0; j < n; ++j) {
        s.l.push_back(uniform(random) / static_cast<double>(2 * n));
        s.h.push_back(s.l[j] + (1 + 2 * uniform(random)) / static_cast<double>(n));
    }
    return s;
}

Space hypersimplex(std::size_t n)
{
    return {std::vector<double>(n, 0), std::vector<double>(n, 2.0 / static_cast<double>(n))};
}

std::uint64_t visit_all(const Space& s)
{
    return cinch::exact::visit_corners(s.view(), [](const auto&, const auto&) { return true; });
}

void write_for_lrs(const Space& s, const std::filesystem::path& path)
{
    const std::size_t n = s.l.size();
    std::ofstream out(path);
    out << "case\nH-representation\nlinearity 1 " << 2 * n + 1 << "\nbegin\n"
        << 2 * n + 1 << ' ' << n + 1 << " rational\n";
    for (std::size_t j = 0; j < n; ++j)
        for (const bool upper : {false, true}) {
            out << cinch::exact::as_fraction(upper ? Exact(s.h[j]) : -Exact(s.l[j]));
            for (std::size_t i = 0; i < n; ++i)
                out << (i != j ? " 0" : upper ? " -1" : " 1");
            out << '\n';
        }
    out << "-1";
    for (std::size_t j = 0; j < n; ++j)
        out << " 1";
    out << "\nend\n";
}

// Corners per second of lrs; one that is cut off after a minute counts with what it printed.
double lrs_rate(const Space& s)
{
    const auto path = std::filesystem::temp_directory_path() / ("cinch-bench-" + std::to_string(getpid()) + ".ine");
    write_for_lrs(s, path);
    const Child child = run({"lrs", path.string()}, 60);
    std::filesystem::remove(path);
    std::size_t corners = 0;
    std::istringstream lines(child.out);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("begin"))
            corners = 0; // it starts anew in wider arithmetic
        corners += line.starts_with(" 1 ");
    }
    return static_cast<double>(corners) / child.seconds;
}

void corner_figures(std::vector<Figure>& figures)
{
    for (std::size_t n : {16u, 18u})
        for (const bool is_generic : {true, false}) {
            const Space s = is_generic ? generic(n, 1) : hypersimplex(n);
            const std::uint64_t corners = visit_all(s);
            const double ours = static_cast<double>(corners) / median_seconds([&] { visit_all(s); }, 0.3),
                         theirs = lrs_rate(s);
            figures.push_back({fmt::format("corners per second over lrs, n = {}, {}, {} corners", n,
                                           is_generic ? "generic" : "h = 2/n", grouped(corners)),
                               fmt::format("{:.3g} / {:.3g} = {:.0f}", ours, theirs, ours / theirs), ">= 1000",
                               ours / theirs >= 1000});
        }
    const Space wide = generic(22, 3);
    std::uint64_t corners = 0;
    const double seconds = median_seconds([&] { corners = visit_all(wide); }, 1);
    const double rate = static_cast<double>(corners) / seconds;
    figures.push_back({fmt::format("corners per second in 128-bit integers, n = 22, {}", grouped(corners)),
                       fmt::format("{:.3g}", rate), ">= 1e7", rate >= 1e7});

    const Space forty = generic(40, 5);
    const double counting = median_seconds([&] { cinch::exact::count_corners(forty.view()); }, 1);
    figures.push_back(
        {fmt::format("seconds to count n = 40, {} corners", *cinch::exact::count_corners(forty.view()).count),
         fmt::format("{:.3f}", counting), "< 1", counting < 1});

    const Space many = hypersimplex(24);
    const Child streamed = run([&] { visit_all(many); });
    figures.push_back({fmt::format("peak MB while streaming {} corners, h = 2/n, n = 24",
                                   *cinch::exact::count_corners(many.view()).count),
                       fmt::format("{:.0f}", streamed.peak_mb), "< 64", streamed.status == 0 && streamed.peak_mb < 64});
}

void optimum_figure(std::vector<Figure>& figures)
{
    constexpr std::size_t n = 500;
    const Space s = generic(n, 7);
    std::mt19937_64 random(9);
    std::vector<double> b(n);
    CGAL::Quadratic_program<double> program(CGAL::EQUAL, false, 0, false, 0);
    for (std::size_t j = 0; j < n; ++j) {
        const int column = static_cast<int>(j);
        b[j] = std::uniform_real_distribution<double>(-100, 100)(random);
        program.set_a(column, 0, 1);
        program.set_l(column, true, s.l[j]);
        program.set_u(column, true, s.h[j]);
        program.set_c(column, -b[j]);
    }
    program.set_b(0, 1);
    const std::vector<Exact> exact(b.begin(), b.end());
    std::optional<cinch::exact::Optimum> found;
    const double ours = median_seconds([&] { found = cinch::exact::optimum(s.view(), exact); }, 0.5);
    CGAL::Quadratic_program_solution<Exact> solution;
    const double theirs = median_seconds([&] { solution = CGAL::solve_linear_program(program, Exact()); }, 0.5);
    const bool equal =
        found && solution.is_optimal() &&
        -solution.objective_value().numerator() == found->value * solution.objective_value().denominator();
    figures.push_back(
        {fmt::format("optimum over CGAL's solve_linear_program, n = 500, {}", equal ? "equal" : "DIFFERENT"),
         fmt::format("{:.0f}", theirs / ours), ">= 20", equal && theirs / ours >= 20});
}

void program_figures(const std::string& program, std::vector<Figure>& figures)
{
    using nlohmann::json;
    auto last = [](const Child& child) {
        return json::parse(child.out.substr(child.out.rfind("\n{") == std::string::npos ? 0 : child.out.rfind("\n{")));
    };
    const Child verified = run({program, "verify", "brain-30000", "--frames", "1", "--threads", "1", "--json"}, 300);
    const json v = last(verified);
    const bool proven = verified.status == 0 && v["violated"] == 0;
    const double hit_rate = v["filter_hit_rate"];
    figures.push_back(
        {fmt::format("seconds to verify {} bounds, 30K brain, one triangle per leaf", grouped(v["bounds"])),
         fmt::format("{:.1f}", verified.seconds), "< 15", proven && verified.seconds < 15});
    figures.push_back({"  its filter hit rate", fmt::format("{:.4f}", hit_rate), "> 0.95", hit_rate > 0.95});
    figures.push_back({"  its peak MB", fmt::format("{:.0f}", verified.peak_mb), "< 1000", verified.peak_mb < 1000});
    const Child fuzzed = run({program, "fuzz", "--cases", "105000", "--threads", "1", "--json"}, 300);
    const json f = last(fuzzed);
    const double rate = f["cases"].get<double>() / f["seconds"].get<double>();
    figures.push_back({"differential fuzz cases per second, n <= 16, all methods",
                       grouped(static_cast<std::size_t>(rate)), ">= 20,000", fuzzed.status == 0 && rate >= 20000});
}

} // namespace

int exact(const std::string& program)
{
    std::vector<Figure> figures;
    corner_figures(figures);
    optimum_figure(figures);
    program_figures(program, figures);
    print(figures);
    return std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.reached; }) ? 0 : 1;
}

} // namespace cinch::bench
