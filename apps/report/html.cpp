#include "report/html.hpp"

#include <cmath>

#include "program/print.hpp"
#include "report/figure.hpp"
#include "report/page_style.hpp"

namespace vdna::report
{

std::string valid_utf8(const std::string &text)
{
    // JSON replaces what is invalid.
    const std::string json =
        program::Json(text).dump(-1, ' ', false, program::Json::error_handler_t::replace);
    return program::Json::parse(json).get<std::string>();
}

std::string escaped(const std::string &text)
{
    std::string html;
    for (const char c : valid_utf8(text)) {
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
            // XML has no control characters but these.
            html += static_cast<unsigned char>(c) >= ' ' || c == '\n' || c == '\t'
                        ? std::string(1, c)
                        : "\ufffd";
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
    return element("div class=\"scroll\" role=\"region\" aria-label=\"Table\" tabindex=\"0\"",
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

std::string photo_html(const Encoded &picture, const std::string &text)
{
    if (picture.bytes.empty())
        return element("span class=\"gone\"", "this picture cannot be read any more");
    return "<img class=\"photo\" width=\"" + std::to_string(picture.columns) + "\" height=\"" +
           std::to_string(picture.rows) + "\" alt=\"" + escaped(text) +
           "\" src=\"data:image/jpeg;base64," + base64(picture.bytes) + "\">";
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
