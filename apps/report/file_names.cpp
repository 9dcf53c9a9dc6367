#include "report/file_names.hpp"

namespace vdna::report
{

namespace
{

// Whatever the locale.
bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

bool is_portable(char c)
{
    return is_upper(c) || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

std::string lower(std::string text)
{
    for (char &c : text)
        c = is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

} // namespace

std::string portable(const std::string &name)
{
    std::string text;
    for (const char c : name)
        if (is_portable(c))
            text += c;
        else if ((static_cast<unsigned char>(c) & 0xc0u) != 0x80) // a character begins
            text += '_';
    return text;
}

std::string FileNames::unique(const std::string &name)
{
    const std::string first = portable(name);
    std::string found = first;
    for (size_t i = 2; !taken_.insert(lower(found)).second; i++)
        found = first + "-" + std::to_string(i);
    return found;
}

} // namespace vdna::report
