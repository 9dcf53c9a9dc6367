#include "watch/display_text.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include <utf8proc.h>

namespace vdna::watch
{

namespace
{

// One character of a text.
struct Glyph {
    std::string bytes;
    utf8proc_int32_t codepoint; // -1 = invalid byte
};

std::vector<Glyph> glyphs_of(const std::string &text)
{
    std::vector<Glyph> glyphs;
    for (size_t at = 0; at < text.size();) {
        utf8proc_int32_t codepoint = -1;
        const auto *const bytes = reinterpret_cast<const utf8proc_uint8_t *>(text.data() + at);
        const auto left = static_cast<utf8proc_ssize_t>(text.size() - at);
        const utf8proc_ssize_t taken = utf8proc_iterate(bytes, left, &codepoint);
        const size_t size = taken > 0 ? static_cast<size_t>(taken) : 1;
        glyphs.push_back({text.substr(at, size), taken > 0 ? codepoint : -1});
        at += size;
    }
    return glyphs;
}

bool can_be_shown(utf8proc_int32_t codepoint)
{
    switch (codepoint < 0 ? UTF8PROC_CATEGORY_CN : utf8proc_category(codepoint)) {
    case UTF8PROC_CATEGORY_CC: // control
    case UTF8PROC_CATEGORY_CF: // format, such as the direction of writing
    case UTF8PROC_CATEGORY_CN: // not assigned
    case UTF8PROC_CATEGORY_CO: // private
    case UTF8PROC_CATEGORY_CS: // surrogate
    case UTF8PROC_CATEGORY_ZL: // line separator
    case UTF8PROC_CATEGORY_ZP: // paragraph separator
        return false;
    default:
        return true;
    }
}

int width_of(const Glyph &glyph)
{
    return utf8proc_charwidth(glyph.codepoint);
}

} // namespace

std::string printable(const std::string &text)
{
    std::string shown;
    for (const Glyph &glyph : glyphs_of(text))
        shown += can_be_shown(glyph.codepoint) ? glyph.bytes : "?";
    return shown;
}

int width_of(const std::string &text)
{
    int width = 0;
    for (const Glyph &glyph : glyphs_of(text))
        width += width_of(glyph);
    return width;
}

std::string first(const std::string &text, int cells)
{
    std::string kept;
    int used = 0;
    for (const Glyph &glyph : glyphs_of(text)) {
        used += width_of(glyph);
        if (used > cells)
            break;
        kept += glyph.bytes;
    }
    return kept;
}

std::string cut(const std::string &text, int cells)
{
    if (width_of(text) <= cells)
        return text;
    return cells < 1 ? "" : first(text, cells - 1) + "…";
}

namespace
{

// A percent sign stays with its number.
std::vector<std::string> words_of(const std::string &text)
{
    std::vector<std::string> words;
    std::istringstream in(text);
    for (std::string word; in >> word;) {
        if (!words.empty() && word[0] == '%')
            words.back() += " " + word;
        else
            words.push_back(word);
    }
    return words;
}

} // namespace

std::vector<std::string> wrapped(const std::string &text, int cells)
{
    std::vector<std::string> lines;
    for (const std::string &word : words_of(text)) {
        if (!lines.empty() && width_of(lines.back()) + 1 + width_of(word) <= cells)
            lines.back() += " " + word;
        else
            lines.push_back(cut(word, cells));
    }
    return lines;
}

std::string in_ascii(const std::string &text)
{
    static const std::map<std::string, std::string> marks{{"█", "#"}, {"▌", "="}, {"░", "."},
                                                          {"…", "~"}, {"–", "-"}, {"·", "|"}};
    std::string ascii;
    for (const Glyph &glyph : glyphs_of(text)) {
        const auto mark = marks.find(glyph.bytes);
        if (glyph.bytes.size() == 1)
            ascii += glyph.bytes;
        else if (mark != marks.end())
            ascii += mark->second;
        else
            ascii += std::string(static_cast<size_t>(width_of(glyph)), '?');
    }
    return ascii;
}

} // namespace vdna::watch
