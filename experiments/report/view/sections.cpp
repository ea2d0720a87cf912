// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "experiments/embedded.hpp"
#include "experiments/report/view.hpp"

namespace cinch {
namespace {

std::string escaped(const std::string& text)
{
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
    return out;
}

// JSON that may stand within <script>.
std::string script_safe(const nlohmann::ordered_json& view)
{
    std::string out;
    for (const char c : view.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace))
        out += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return out;
}

constexpr const char* no_three = "The 3-D view needs three.js, which was not there when this program was built. "
                                 "On Debian: <code>apt-get install libjs-three</code>, then configure and build again.";

} // namespace

bool has_three() { return !embedded::three_js.empty(); }

std::string view_sections(std::span<const nlohmann::ordered_json> views)
{
    std::string out = fmt::format("<style>\n{}</style>\n", embedded::view_css);
    std::size_t number = 0;
    for (const auto& view : views) {
        out += fmt::format("<section class=\"view\" id=\"view-{}\">\n<h2>{}</h2>\n<p>{}</p>\n", ++number,
                           escaped(view["title"].get<std::string>()), escaped(view["text"].get<std::string>()));
        if (view.contains("missing") && !view["missing"].empty())
            out += fmt::format(
                "<p class=\"view-note\"><strong>Partial</strong>, without {}</p>\n",
                escaped(fmt::format("{}", fmt::join(view["missing"].get<std::vector<std::string>>(), "; "))));
        if (has_three())
            out += fmt::format("<noscript><p class=\"view-note\">The 3-D view needs "
                               "JavaScript.</p></noscript>\n<script type=\"application/json\">{}</script>\n",
                               script_safe(view));
        else
            out += fmt::format("<p class=\"view-note\">{}</p>\n", no_three);
        out += "</section>\n";
    }
    if (has_three())
        out += fmt::format("<script>\n/* three.js r111, MIT licence, (c) 2010-2019 three.js authors "
                           "*/\n{}\n</script>\n<script>\n(() => {{\n'use strict';\n{}}})();\n</script>\n",
                           embedded::three_js, embedded::view_js);
    return out;
}

std::string view_page(std::span<const nlohmann::ordered_json> views, const std::string& note)
{
    const std::string title = views.empty() ? "cinch" : escaped(views[0]["title"].get<std::string>());
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
        "style-src 'unsafe-inline'; img-src data:\">\n"
        "<title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n</head>\n<body "
        "class=\"view-page\">\n{}{}</body>\n</html>\n",
        title,
        note.empty() ? ""
                     : fmt::format("<p class=\"view-note\"><strong>Not all of it:</strong> {}</p>\n", escaped(note)),
        view_sections(views));
}

} // namespace cinch
