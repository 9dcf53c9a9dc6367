#include "report/html.hpp"

#include <cmath>

#include "program/print.hpp"
#include "report/page_style.hpp"

namespace vdna::report
{

std::string escaped(const std::string &text)
{
    // File names may be any bytes; JSON replaces invalid UTF-8.
    const std::string json =
        program::Json(text).dump(-1, ' ', false, program::Json::error_handler_t::replace);
    std::string html;
    for (const char c : program::Json::parse(json).get<std::string>()) {
        switch (c) {
        case '&':
            html += "&amp;";
            break;
        case '<':
            html += "&lt;";
            break;
        case '>':
            html += "&gt;";
            break;
        case '"':
            html += "&quot;";
            break;
        case '\'':
            html += "&#39;";
            break;
        default:
            html += c;
        }
    }
    return html;
}

std::string element(const std::string &tag, const std::string &html)
{
    return "<" + tag + ">" + html + "</" + tag.substr(0, tag.find(' ')) + ">";
}

std::string text_element(const std::string &tag, const std::string &text)
{
    return element(tag, escaped(text));
}

std::string table(const std::string &caption_html, const std::string &head_html,
                  const std::string &body_html)
{
    // Focusable, so that the keyboard can scroll it.
    return element("div class=\"scroll\" tabindex=\"0\"",
                   element("table", element("caption", element("span", caption_html)) +
                                        element("thead", head_html) +
                                        element("tbody", body_html))) +
           "\n";
}

std::string foldable(const std::string &summary_html, bool open, const std::string &html)
{
    return element(open ? "details open" : "details", element("summary", summary_html) + html) +
           "\n";
}

std::string page(const std::string &title_text, const std::string &body_html)
{
    const std::string head =
        "<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
        "style-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
        text_element("title", title_text) + "\n" + element("style", page_style);
    return "<!DOCTYPE html>\n" +
           element("html lang=\"en\"", "\n" + element("head", head) + "\n" +
                                           element("body", element("main", body_html))) +
           "\n";
}

std::string number_text(double value, int digits)
{
    return std::isnan(value) ? "\u2013" : program::fixed(value, digits);
}

} // namespace vdna::report
