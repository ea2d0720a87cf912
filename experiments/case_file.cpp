// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/case_file.hpp"

#include <charconv>
#include <cmath>
#include <iostream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/shipped.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

using nlohmann::json;

class CaseReader {
public:
    explicit CaseReader(const std::string& file) : file_(file) {}

    Case read(const json& root) const
    {
        if (!root.is_object())
            fail("is not a JSON object with the fields n, l, h and b");
        Case out;
        out.l = numbers(field(root, "l"), "l");
        out.h = numbers(field(root, "h"), "h");
        const json& n = field(root, "n");
        if (!n.is_number_integer() || (n.is_number_integer() && n < 1))
            fail("field n: expected a whole number of at least 1, found " + shown(n));
        if (n != out.l.size())
            fail(fmt::format("field l: {} numbers, but n is {}", out.l.size(), n.dump()));
        if (n != out.h.size())
            fail(fmt::format("field h: {} numbers, but n is {}", out.h.size(), n.dump()));
        for (std::size_t j = 0; j < out.l.size(); ++j) {
            if (!(out.l[j] >= 0 && out.l[j] <= 1))
                fail(fmt::format("field l[{}]: {} lies outside 0 to 1", j, out.l[j]));
            if (!(out.h[j] >= out.l[j] && out.h[j] <= 1))
                fail(fmt::format("field h[{}]: {} lies outside l to 1, l = {}", j, out.h[j], out.l[j]));
        }
        if (!root.contains("b"))
            return out;
        const json& rows = root["b"];
        if (!rows.is_array())
            fail("field b: expected an array of rows, found " + shown(rows));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::string name = fmt::format("b[{}]", i);
            out.b.push_back(numbers(rows[i], name));
            if (out.b.back().size() != out.l.size())
                fail(fmt::format("field {}: {} numbers, but n is {}", name, out.b.back().size(), out.l.size()));
        }
        return out;
    }

private:
    [[noreturn]] void fail(const std::string& reason) const { throw InputError::in_file(file_, reason); }

    static std::string shown(const json& value)
    {
        const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
        return text.size() > 40 ? text.substr(0, 40) + "..." : text;
    }

    const json& field(const json& root, const char* name) const
    {
        if (!root.contains(name))
            fail(fmt::format("field {} is missing", name));
        return root[name];
    }

    std::vector<double> numbers(const json& array, const std::string& name) const
    {
        if (!array.is_array())
            fail(fmt::format("field {}: expected an array of numbers, found {}", name, shown(array)));
        std::vector<double> out;
        for (std::size_t i = 0; i < array.size(); ++i)
            out.push_back(number(array[i], fmt::format("{}[{}]", name, i)));
        return out;
    }

    double number(const json& value, const std::string& name) const
    {
        double x = 0;
        if (value.is_number())
            x = value.get<double>();
        else if (!value.is_string() || !parse(value.get_ref<const std::string&>(), x))
            fail(fmt::format("field {}: {} is not a number", name, shown(value)));
        if (!std::isfinite(x))
            fail(fmt::format("field {}: {} is not finite", name, shown(value)));
        return x;
    }

    static bool parse(std::string_view text, double& x)
    {
        const bool negative = text.starts_with('-');
        if (negative || text.starts_with('+'))
            text.remove_prefix(1);
        if (text.starts_with('-') || text.starts_with('+'))
            return false;
        const bool hex = text.starts_with("0x") || text.starts_with("0X");
        if (hex)
            text.remove_prefix(2);
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x,
                                                  hex ? std::chars_format::hex : std::chars_format::general);
        if (error != std::errc{} || end != text.data() + text.size())
            return false;
        x = negative ? -x : x;
        return true;
    }

    const std::string& file_;
};

} // namespace

Case parse_case(const std::string& text, const std::string& file)
{
    json root;
    try {
        root = json::parse(text);
    } catch (const json::exception& error) {
        const std::string message = error.what(); // "[json.exception…] parse error at line 1, column 2: …"
        const std::size_t at = message.find("] ");
        throw InputError::in_file(file, at == std::string::npos ? message : message.substr(at + 2));
    }
    return CaseReader(file).read(root);
}

Case read_case(const std::filesystem::path& path)
{
    if (path == "-")
        return parse_case({std::istreambuf_iterator<char>(std::cin), {}}, "standard input");
    std::error_code error;
    const std::filesystem::path shipped = shipped_folder("cases") / (path.string() + ".json");
    const bool known = path.has_filename() && !path.has_parent_path() && !std::filesystem::exists(path, error) &&
                       std::filesystem::exists(shipped, error);
    return parse_case(read_bytes(known ? shipped : path), path.string());
}

} // namespace cinch
