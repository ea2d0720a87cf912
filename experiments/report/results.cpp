// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>

#include <fmt/format.h>

#include "experiments/records/schema.hpp"
#include "toolkit/surface/checksum.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// The operation on values, and on all ends of what they may be.
template <class Operation> Traced combined(const Traced& a, const Traced& b, Operation operation)
{
    Traced out{operation(a.value, b.value), a.from};
    if (!std::isnan(a.low) || !std::isnan(b.low)) {
        const Range x = a.range(), y = b.range();
        const auto [low, high] = std::minmax(
            {operation(x.low, y.low), operation(x.low, y.high), operation(x.high, y.low), operation(x.high, y.high)});
        out.low = low;
        out.high = high;
    }
    for (const Source& source : b.from)
        if (std::find(out.from.begin(), out.from.end(), source) == out.from.end())
            out.from.push_back(source);
    return out;
}

template <class Better> Traced extreme(const std::vector<Traced>& all, Better better)
{
    Traced best;
    for (const Traced& x : all)
        if (x.known() && (!best.known() || better(x.value, best.value)))
            best = x;
    return best;
}

// The end of a closing line: ,"checksum":"0123456789abcdef"}
constexpr std::string_view seal_begin = ",\"checksum\":\"", seal_end = "\"}";
constexpr std::size_t seal_bytes = seal_begin.size() + 16 + seal_end.size();

std::string seal(std::uint64_t sum) { return fmt::format("{}{:016x}{}", seal_begin, sum, seal_end); }

} // namespace

std::string sealed(const std::string& lines, std::string_view closing)
{
    std::string text = lines;
    text += closing.substr(0, closing.find_last_of('}'));
    return text + seal(checksum(text)) + "\n";
}

std::string Record::word(const char* field) const
{
    const auto at_field = fields.find(field);
    return at_field != fields.end() && at_field->is_string() ? at_field->get<std::string>() : "";
}

double Record::number(const char* field) const
{
    const auto at_field = fields.find(field);
    return at_field != fields.end() && at_field->is_number() ? at_field->get<double>() : NAN;
}

Traced operator+(const Traced& a, const Traced& b) { return combined(a, b, std::plus<>()); }
Traced operator-(const Traced& a, const Traced& b) { return combined(a, b, std::minus<>()); }
Traced operator*(const Traced& a, const Traced& b) { return combined(a, b, std::multiplies<>()); }
Traced operator/(const Traced& a, const Traced& b) { return combined(a, b, std::divides<>()); }
Traced operator/(double a, const Traced& b) { return Traced{a, {}} / b; }
Traced operator-(double a, const Traced& b) { return Traced{a, {}} - b; }
Traced operator/(const Traced& a, double b) { return a / Traced{b, {}}; }

Results results_of(const std::vector<Json>& records, const Json& from)
{
    Results results;
    for (Json record : records) {
        record.update(from);
        const std::string text = record.dump(-1, ' ', false, Json::error_handler_t::replace);
        results.add({{record.value("experiment", "records"), results.all().size() + 1}, std::move(record), text});
    }
    return results;
}

Traced mean(const std::vector<Traced>& all)
{
    Traced sum{0, {}};
    double count = 0;
    for (const Traced& x : all)
        if (x.known()) {
            sum = sum + x;
            ++count;
        }
    return count > 0 ? sum / count : Traced{};
}

Traced least(const std::vector<Traced>& all) { return extreme(all, std::less<>()); }
Traced greatest(const std::vector<Traced>& all) { return extreme(all, std::greater<>()); }

std::vector<const Record*> Results::where(const Json& fields) const
{
    std::vector<const Record*> found;
    for (const Record& record : records_)
        if (std::all_of(fields.items().begin(), fields.items().end(), [&](const auto& field) {
                const auto at = record.fields.find(field.key());
                return at != record.fields.end() && *at == field.value();
            }))
            found.push_back(&record);
    return found;
}

Traced Results::number(const Record& record, const char* field)
{
    const double value = record.number(field);
    if (!std::isfinite(value))
        return {};
    return {value,
            {record.at},
            record.number((std::string(field) + "_low").c_str()),
            record.number((std::string(field) + "_high").c_str())};
}

Traced Results::number(const Json& fields, const char* field) const
{
    for (const Record* record : where(fields))
        if (const Traced found = number(*record, field); found.known())
            return found;
    return {};
}

std::string describe(const Damage& damage)
{
    return damage.line ? fmt::format("{}:{}: {}", damage.file, damage.line, damage.what)
                       : fmt::format("{}: {}", damage.file, damage.what);
}

bool is_view(const Record& record)
{
    if (record.word("experiment") != "view" || !record.fields.contains("view") || !record.fields["view"].is_object())
        return false;
    const Json& view = record.fields["view"];
    auto all = [&](std::initializer_list<const char*> fields, auto&& is) {
        return std::all_of(fields.begin(), fields.end(),
                           [&](const char* f) { return view.contains(f) && is(view[f]); });
    };
    return all({"title", "text", "scene"}, [](const Json& j) { return j.is_string(); }) &&
           all({"positions", "corners", "bounds", "first", "bvs"}, [](const Json& j) { return j.is_object(); });
}

bool is_closing(const Record& record) { return record.fields.contains("stage") && record.fields.contains("lines"); }

std::vector<Record> read_results(const std::filesystem::path& file, std::vector<Damage>& damage)
{
    const std::string name = file.filename().string(), stem = file.stem().string();
    const std::size_t before = damage.size();
    std::vector<Record> records;
    std::ifstream in(file, std::ios::binary);
    if (!in) {
        damage.push_back({name, 0, "cannot be read"});
        return {};
    }
    std::size_t line = 0;
    std::uint64_t sum = checksum_of_nothing;
    bool closed = false;
    for (std::string text; std::getline(in, text);) {
        ++line;
        const std::uint64_t before_line = sum;
        sum = checksum("\n", checksum(text, sum));
        auto bad = [&](std::string what) { damage.push_back({name, line, std::move(what)}); };
        if (in.eof()) {
            bad("ends in the middle of the line");
            break;
        }
        if (closed) {
            bad("something follows the closing line");
            break;
        }
        const Json fields = Json::parse(text, nullptr, false);
        if (fields.is_discarded()) {
            bad("is not JSON");
            continue;
        }
        if (std::string what = fault_of(fields); !what.empty()) {
            bad(std::move(what));
            continue;
        }
        Record record{{stem, line}, fields, std::move(text)};
        if (is_closing(record)) {
            closed = true;
            const double said = record.number("lines"), found = static_cast<double>(line - 1);
            const std::string_view whole = record.text,
                                   body = whole.substr(0, whole.size() - std::min(whole.size(), seal_bytes));
            if (said != found)
                bad(said > found ? "lines are missing before it" : "there are more lines before it than it says");
            else if (!whole.substr(body.size()).starts_with(seal_begin))
                bad("has no checksum");
            else if (whole.substr(body.size()) != seal(checksum(body, before_line)) && damage.size() == before)
                bad("its checksum is not that of the lines: something was changed");
        }
        records.push_back(std::move(record));
    }
    if (!closed && damage.size() == before)
        damage.push_back({name, line, "is the last line, and the closing one is missing: the file is truncated"});
    return damage.size() == before ? std::move(records) : std::vector<Record>();
}

} // namespace cinch
