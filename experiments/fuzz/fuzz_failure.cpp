// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/fuzz/fuzz_failure.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/report/whole_file.hpp"

namespace cinch {

FuzzFailure shrink_and_save(const FuzzCase& found, Defect defect, const std::string& corpus)
{
    const FuzzCase smallest = shrink(found, defect);
    FuzzFailure out{found.family, smallest.nodes(), find_fault(smallest, defect), "", ""};
    out.text = to_json(smallest, out.fault);
    if (corpus.empty())
        return out;
    std::error_code error;
    std::filesystem::create_directories(corpus, error);
    if (!std::filesystem::is_directory(corpus, error))
        throw InputError::in_file(corpus, "is no folder and cannot be made one");
    const auto path = std::filesystem::path(corpus) /
                      fmt::format("{}-{:x}.json", smallest.family, std::hash<std::string>{}(out.text));
    write_whole(path, out.text + "\n");
    out.place = path.string();
    return out;
}

nlohmann::ordered_json record_of(const FuzzFailure& failure, std::uint64_t index)
{
    nlohmann::ordered_json record{{"experiment", "fuzz"}, {"index", index}, {"saved", failure.place}};
    record.update(nlohmann::ordered_json::parse(failure.text));
    return record;
}

void print(const FuzzFailure& failure, std::uint64_t index)
{
    fmt::print("violated: case {} of family {}, shrunk to n = {}:\n  {}\n  {}\n", index, failure.family, failure.nodes,
               failure.fault, failure.place.empty() ? failure.text : failure.place);
}

} // namespace cinch
