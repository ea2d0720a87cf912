// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/plan.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <glob.h>
#include <set>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/study/lists.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> details{"run", "levels", "frames", "bvs"};

class Reader {
public:
    Reader(const Json& root, std::string file) : root_(root), file_(std::move(file)) {}

    [[noreturn]] void fail(const std::string& field, const std::string& why) const
    {
        throw InputError::in_file(file_, fmt::format("\"{}\": {}", field, why));
    }

    // A word, or a list of words, each read by `read`; what it throws is said of the field.
    template <class T>
    void words(const char* field, std::vector<T>& out, const std::function<std::vector<T>(const std::string&)>& read)
    {
        if (!take(field))
            return;
        out.clear();
        for (const Json& value : as_list(field)) {
            if (!value.is_string())
                fail(field, fmt::format("expected a name or a list of names, found {}", value.dump()));
            for (T& one : read(value.get<std::string>())) {
                if (std::find(out.begin(), out.end(), one) != out.end())
                    fail(field, fmt::format("'{}' is there twice", value.get<std::string>()));
                out.push_back(std::move(one));
            }
        }
        if (out.empty())
            fail(field, "is empty");
    }
    // A whole number, a range of them ("1-20", "16..512"), or a list of these.
    void numbers(const char* field, std::vector<std::uint64_t>& out)
    {
        if (!take(field))
            return;
        std::string text;
        for (const Json& value : as_list(field)) {
            if (!value.is_string() && !value.is_number_unsigned())
                fail(field, fmt::format("expected whole numbers or ranges, found {}", value.dump()));
            text += (text.empty() ? "" : ",") + (value.is_string() ? value.get<std::string>() : value.dump());
        }
        out = parse_list(text, fmt::format("{}: \"{}\"", file_, field));
    }
    void number(const char* field, std::uint64_t& out, std::uint64_t least)
    {
        if (!take(field))
            return;
        if (!root_[field].is_number_unsigned() || root_[field].get<std::uint64_t>() < least)
            fail(field, fmt::format("expected a whole number from {} on, found {}", least, root_[field].dump()));
        out = root_[field].get<std::uint64_t>();
    }
    void real(const char* field, double& out, double least, double most)
    {
        if (!take(field))
            return;
        if (!root_[field].is_number() || !(root_[field].get<double>() >= least && root_[field].get<double>() <= most))
            fail(field, fmt::format("expected a number from {} to {}, found {}", least, most, root_[field].dump()));
        out = root_[field].get<double>();
    }
    void flag(const char* field, bool& out)
    {
        if (!take(field))
            return;
        if (!root_[field].is_boolean())
            fail(field, fmt::format("expected true or false, found {}", root_[field].dump()));
        out = root_[field].get<bool>();
    }
    void nothing_else() const
    {
        for (const auto& [name, value] : root_.items())
            if (!known_.count(name))
                throw InputError::in_file(
                    file_, fmt::format("\"{}\" is no field of a plan; known are {}", name, fmt::join(known_, ", ")));
    }

private:
    bool take(const char* field)
    {
        known_.insert(field);
        return root_.contains(field);
    }
    std::vector<Json> as_list(const char* field) const
    {
        const Json& value = root_[field];
        return value.is_array() ? value.get<std::vector<Json>>() : std::vector<Json>{value};
    }

    const Json& root_;
    std::string file_;
    std::set<std::string> known_;
};

std::vector<std::string> files_of(const std::string& pattern)
{
    if (pattern.find_first_of("*?[") == std::string::npos)
        return {pattern};
    glob_t found{};
    const int status = ::glob(pattern.c_str(), 0, nullptr, &found);
    std::vector<std::string> out(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    ::globfree(&found);
    if (status != 0 && status != GLOB_NOMATCH)
        throw InputError(fmt::format("'{}' cannot be searched for", pattern));
    return out;
}

std::string named(const std::vector<std::string_view>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

} // namespace

Plan parse_plan(const std::string& text, const std::string& file)
{
    Json root;
    try {
        root = Json::parse(text);
    } catch (const Json::parse_error& error) {
        throw InputError::at_byte(file, error.byte, "is no JSON");
    }
    if (!root.is_object())
        throw InputError::in_file(file, "a plan is a JSON object, as {\"inputs\": [\"brain\"], \"seeds\": \"1-5\"}");
    Plan plan;
    Reader reader(root, file);
    reader.words<std::string>("inputs", plan.inputs, [&](const std::string& name) {
        auto files = files_of(name);
        if (files.empty())
            reader.fail("inputs", fmt::format("no file matches '{}'", name));
        return files;
    });
    reader.numbers("nodes", plan.nodes);
    reader.numbers("seeds", plan.seeds);
    auto as_it_is = [](const std::string& word) { return std::vector{word}; };
    reader.words<std::string>("motions", plan.motions, as_it_is);
    reader.words<std::string>("clips", plan.clips, as_it_is);
    reader.words<Methods>("methods", plan.methods, [&](const std::string& word) {
        const auto methods = named_methods(word);
        if (!methods)
            reader.fail("methods", fmt::format("'{}' is none; there are {}", word, named(method_names())));
        return std::vector{*methods};
    });
    reader.words<Precision>("precisions", plan.precisions, [&](const std::string& word) {
        for (const Precision precision : {Precision::float32, Precision::float64})
            if (name_of(precision) == word)
                return std::vector{precision};
        reader.fail("precisions", fmt::format("'{}' is neither float nor double", word));
    });
    std::vector<std::uint64_t> kdops_wanted(plan.kdops.begin(), plan.kdops.end());
    reader.numbers("kdops", kdops_wanted);
    plan.kdops.clear();
    for (const std::uint64_t k : kdops_wanted) {
        if (k > most_directions || !is_kdop(static_cast<int>(k)))
            reader.fail("kdops", fmt::format("there is no {}-DOP, but {}", k, kdop_names()));
        plan.kdops.push_back(static_cast<int>(k));
    }
    reader.number("frames", plan.frames, 1);
    reader.number("leaf", plan.leaf, 1);
    reader.number("passes", plan.passes, 0);
    if (plan.passes > 64)
        reader.fail("passes", fmt::format("expected a whole number from 0 to 64, found {}", plan.passes));
    reader.real("fps", plan.fps, 1e-3, 1e6);
    reader.real("support", plan.support, 1e-3, 1e3);
    reader.flag("partial", plan.partial);
    std::vector<std::string> detail{"run"};
    reader.words<std::string>("detail", detail, as_it_is);
    const auto* const found = std::find(details.begin(), details.end(), detail[0]);
    if (detail.size() != 1 || found == details.end())
        reader.fail("detail", fmt::format("expected one of {}", fmt::join(details, ", ")));
    plan.detail = static_cast<Detail>(found - details.begin());
    reader.nothing_else();
    return plan;
}

Json to_json(const Plan& plan)
{
    Json methods = Json::array(), precisions = Json::array();
    for (const Methods m : plan.methods)
        methods.push_back(name_of(m));
    for (const Precision p : plan.precisions)
        precisions.push_back(name_of(p));
    Json out{{"inputs", plan.inputs},
             {"nodes", plan.nodes},
             {"seeds", plan.seeds},
             {"motions", plan.motions},
             {"clips", plan.clips},
             {"methods", methods},
             {"precisions", precisions},
             {"kdops", plan.kdops},
             {"frames", plan.frames},
             {"leaf", plan.leaf},
             {"passes", plan.passes},
             {"partial", plan.partial},
             {"detail", details[static_cast<std::size_t>(plan.detail)]}};
    if (plan.fps > 0)
        out["fps"] = plan.fps;
    if (plan.support > 0)
        out["support"] = plan.support;
    return out;
}

std::size_t cell_count(const Plan& plan)
{
    return plan.inputs.size() * plan.nodes.size() * plan.motions.size() * plan.clips.size() * plan.seeds.size();
}

InputOptions cell_of(const Plan& plan, std::size_t cell)
{
    auto next = [&](const auto& list) {
        const auto& value = list[cell % list.size()];
        cell /= list.size();
        return value;
    };
    InputOptions what; // the seed changes fastest, the input slowest
    what.seed = next(plan.seeds);
    what.clip = next(plan.clips);
    what.motion = next(plan.motions);
    what.nodes = next(plan.nodes);
    what.input = next(plan.inputs);
    what.frames = plan.frames;
    what.fps = plan.fps;
    what.support = plan.support;
    what.partial = plan.partial;
    return what;
}

} // namespace cinch
