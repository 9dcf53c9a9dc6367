// Pieces of HTML as strings. Arguments called `text` are escaped, those called `html` are not.
#pragma once

#include <string>

#include "report/picture.hpp"

namespace vdna::report
{

// Invalid UTF-8 is replaced: file names may be any bytes.
std::string valid_utf8(const std::string &text);

// For content and for attributes in double quotes. Invalid UTF-8 and control characters are
// replaced.
std::string escaped(const std::string &text);

// tag: with its attributes, "td class=\"off1\"".
std::string element(const std::string &tag, const std::string &html);
std::string text_element(const std::string &tag, const std::string &text);

// A table of rows (<tr>), which scrolls in its own box if it is wider than the page.
std::string table(const std::string &caption_html, const std::string &head_html,
                  const std::string &body_html);

// A foldable part of the page.
std::string foldable(const std::string &summary_html, bool open, const std::string &html);

// A small picture with its size; without bytes, a sentence that there is none any more.
std::string photo_html(const Encoded &picture, const std::string &text);

// A whole page, which fetches nothing, whatever names it contains.
std::string page(const std::string &title_text, const std::string &body_html);

// "12.35", or a dash for an undefined number.
std::string number_text(double value, int digits);

} // namespace vdna::report
