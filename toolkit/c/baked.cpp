// SPDX-License-Identifier: Apache-2.0
// The records of `cinch bake --json`, one a line: of each clip intervals of time that follow one another, of each
// interval BVs 0, 1, ...; data that is not finite is null.
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cinch/surface.hpp"
#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;
using Json = nlohmann::json;

struct Baked {
    static constexpr Kind kind = Kind::baked;
    using Handle = cinch_baked;

    struct Clip {
        std::string input, name, statement;
        std::size_t k = 0, bvs = 0; // of each interval
        bool partial = false;
        std::vector<std::array<double, 2>> times;
        std::vector<double> supports;
    };
    std::string file;
    std::vector<Clip> clips;

    const Clip& clip(std::size_t i) const
    {
        if (i >= clips.size())
            throw std::invalid_argument(file + ": there is no clip " + std::to_string(i) + " of " +
                                        std::to_string(clips.size()));
        return clips[i];
    }
};

// Why a record is none; the place is said by who reads lines.
struct Refused {
    std::string why;
};

double number(const Json& value, const char* name)
{
    if (!value.is_number())
        throw Refused{std::string(name) + " is no number"};
    const double x = value.get<double>();
    if (!std::isfinite(x))
        throw Refused{std::string(name) + " is not finite"};
    return x;
}

const Json& field(const Json& record, const char* name)
{
    const auto at = record.find(name);
    if (at == record.end())
        throw Refused{std::string(name) + " is missing"};
    return *at;
}

std::string text(const Json& record, const char* name)
{
    const Json& value = field(record, name);
    if (!value.is_string())
        throw Refused{std::string(name) + " is no text"};
    return value.get<std::string>();
}

std::size_t whole(const Json& record, const char* name)
{
    const Json& value = field(record, name);
    if (!value.is_number_unsigned())
        throw Refused{std::string(name) + " is no whole number from 0 on"};
    return value.get<std::size_t>();
}

const Json& list(const Json& record, const char* name, std::size_t size)
{
    const Json& value = field(record, name);
    if (!value.is_array() || value.size() != size)
        throw Refused{std::string(name) + " is no list of " + std::to_string(size)};
    return value;
}

bool set(const Json& record, const char* name)
{
    const auto at = record.find(name);
    return at != record.end() && at->is_boolean() && at->get<bool>();
}

// Of k directions; null stands for what is infinite.
std::vector<double> supports_of(const Json& record, std::size_t k)
{
    std::vector<double> out;
    auto bound = [](const Json& x, double sign, const char* name) {
        return x.is_null() ? std::numeric_limits<double>::infinity() : sign * number(x, name);
    };
    if (k == 6) {
        const Json &low = list(record, "min", 3), &high = list(record, "max", 3);
        for (std::size_t a = 0; a < 3; ++a) {
            out.push_back(bound(high[a], 1, "max"));
            out.push_back(bound(low[a], -1, "min"));
        }
    } else {
        for (const Json& x : list(record, "supports", k))
            out.push_back(bound(x, 1, "supports"));
    }
    for (std::size_t d = 0; d < k; d += 2)
        if (out[d] < -out[d + 1])
            throw Refused{"the least place is beyond the greatest"};
    return out;
}

class Reader {
public:
    explicit Reader(Baked& to) : to_(to) {}

    void add(const Json& record)
    {
        if (!record.is_object())
            throw Refused{"a record is needed"};
        const auto experiment = record.find("experiment");
        if (experiment == record.end() || *experiment != "bake" || !record.contains("bv"))
            return;
        const std::size_t k = whole(record, "kdop"), bv = whole(record, "bv");
        if (k > most_directions || !is_kdop(static_cast<int>(k)))
            throw Refused{"k must be " + kdop_names()};
        const std::array<double, 2> when{number(field(record, "t0"), "t0"), number(field(record, "t1"), "t1")};
        if (when[0] > when[1])
            throw Refused{"t0 is after t1"};
        const std::vector<double> supports = supports_of(record, k);
        Baked::Clip& clip = clip_of(record, k);
        std::size_t& next = next_.at(&clip - to_.clips.data());
        if (bv == 0) {
            finish(clip, next);
            if (!clip.times.empty() && when[0] < clip.times.back()[0])
                throw Refused{"intervals of a clip do not follow one another"};
            clip.times.push_back(when);
            next = 0;
        } else if (bv != next || clip.times.back() != when) {
            throw Refused{"BVs of an interval are not 0, 1, ... one after the other"};
        }
        ++next;
        clip.partial =
            clip.partial || set(record, "partial") || (record.contains("complete") && !set(record, "complete"));
        clip.supports.insert(clip.supports.end(), supports.begin(), supports.end());
    }

    void finish()
    {
        for (std::size_t i = 0; i < to_.clips.size(); ++i)
            finish(to_.clips[i], next_[i]);
        if (to_.clips.empty())
            throw Refused{"there are no bounds in it"};
    }

private:
    Baked::Clip& clip_of(const Json& record, std::size_t k)
    {
        const std::string input = text(record, "input"), name = text(record, "clip"),
                          statement = text(record, "statement");
        const auto [place, fresh] = place_.try_emplace({input, name}, to_.clips.size());
        if (fresh) {
            to_.clips.push_back({input, name, statement, k, 0, false, {}, {}});
            next_.push_back(0);
        }
        Baked::Clip& clip = to_.clips[place->second];
        if (clip.k != k || clip.statement != statement)
            throw Refused{"kdop or statement is not that of the clip's other records"};
        return clip;
    }

    // An interval ends: it has as many BVs as the first.
    static void finish(Baked::Clip& clip, std::size_t bvs)
    {
        if (clip.times.empty())
            return;
        if (clip.times.size() == 1)
            clip.bvs = bvs;
        if (bvs != clip.bvs)
            throw Refused{"clip '" + clip.name + "': intervals have different numbers of BVs"};
    }

    Baked& to_;
    std::map<std::pair<std::string, std::string>, std::size_t> place_;
    std::vector<std::size_t> next_; // BV of each clip
};

} // namespace

cinch_status cinch_baked_read(const char* path, cinch_baked** baked, size_t* clips)
{
    return call([&] {
        given(baked, "baked") = nullptr;
        auto made = std::make_shared<Baked>();
        made->file = &given(path, "path");
        given(clips, "clips") = 0;
        std::istringstream lines(read_bytes(made->file));
        Reader reader(*made);
        std::size_t number = 0;
        try {
            for (std::string line; std::getline(lines, line);) {
                ++number;
                reader.add(Json::parse(line));
            }
            reader.finish();
        } catch (const Refused& refused) {
            throw InputError::at_line(made->file, number, refused.why);
        } catch (const Json::exception& error) {
            throw InputError::at_line(made->file, number, "no JSON");
        }
        *clips = made->clips.size();
        *baked = put(std::move(made));
    });
}

cinch_status cinch_baked_get_clip(const cinch_baked* baked, size_t clip, cinch_baked_clip* info)
{
    return call([&] {
        const auto of = get<Baked>(baked);
        const Baked::Clip& c = of->clip(clip);
        double last = c.times.front()[1];
        for (const auto& when : c.times)
            last = std::max(last, when[1]);
        given(info, "info") = {c.input.c_str(),
                               c.name.c_str(),
                               c.statement.c_str(),
                               c.times.front()[0],
                               last,
                               c.times.size(),
                               c.bvs,
                               static_cast<std::int32_t>(c.k),
                               c.partial ? 1 : 0};
    });
}

cinch_status cinch_baked_get_supports(const cinch_baked* baked, size_t clip, double* times_s, size_t intervals,
                                      double* supports, size_t support_count)
{
    return call([&] {
        const auto of = get<Baked>(baked);
        const Baked::Clip& c = of->clip(clip);
        const auto when = array_of<std::array<double, 2>>(times_s, intervals, c.times.size(), "times");
        array_of<double>(supports, support_count, c.times.size() * c.bvs, "supports");
        const auto out = array<double>(supports, c.supports.size(), "supports");
        std::copy(c.times.begin(), c.times.end(), when.begin());
        std::copy(c.supports.begin(), c.supports.end(), out.begin());
    });
}

cinch_status cinch_baked_box(const cinch_baked* baked, size_t clip, double time_s, size_t bv, double box[6])
{
    return call([&] {
        const auto of = get<Baked>(baked);
        const Baked::Clip& c = of->clip(clip);
        if (bv >= c.bvs)
            throw std::invalid_argument("there is no BV " + std::to_string(bv) + " of " + std::to_string(c.bvs));
        const auto out = array<Aabb>(box, 1, "box");
        for (std::size_t i = 0; i < c.times.size(); ++i)
            if (c.times[i][0] <= time_s && time_s <= c.times[i][1]) {
                out[0] = Dop(std::span(c.supports).subspan((i * c.bvs + bv) * c.k, c.k)).aabb();
                return;
            }
        throw std::invalid_argument("no interval of clip '" + c.name + "' holds " + std::to_string(time_s) + " s");
    });
}
