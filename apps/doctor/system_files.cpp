#include "doctor/system_files.hpp"

#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

#include "program/print.hpp"

namespace vdna::doctor
{

std::optional<std::string> read_text(const std::filesystem::path &file)
{
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        return {};
    return std::string{std::istreambuf_iterator<char>(stream), {}};
}

std::string read_line(const std::filesystem::path &file)
{
    std::string line;
    std::ifstream stream(file, std::ios::binary);
    std::getline(stream, line);
    return line;
}

std::optional<uint64_t> number_in(const std::string &text)
{
    uint64_t number = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
    return result.ec == std::errc() ? std::optional<uint64_t>(number) : std::nullopt;
}

std::string value_of(const std::string &text, const std::string &name)
{
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.compare(0, name.size(), name) != 0)
            continue;
        const size_t begin = line.find_first_not_of(" \t:=", name.size());
        if (begin != name.size()) // else it is a longer name
            return begin == std::string::npos ? "" : line.substr(begin);
    }
    return "";
}

std::optional<std::set<unsigned>> numbers_of_list(const std::string &list)
{
    constexpr unsigned most = 4096;
    std::set<unsigned> numbers;
    std::istringstream parts(list);
    for (std::string part; std::getline(parts, part, ',');) {
        const size_t dash = part.find('-');
        const std::optional<uint64_t> first = number_in(part);
        const std::optional<uint64_t> last =
            dash == std::string::npos ? first : number_in(part.substr(dash + 1));
        if (!first || !last || *last < *first || *last > most)
            return {};
        for (uint64_t number = *first; number <= *last; number++)
            numbers.insert(static_cast<unsigned>(number));
    }
    return numbers;
}

std::string bytes_text(uint64_t bytes)
{
    constexpr double kib = 1024, mib = 1024 * kib, gib = 1024 * mib;
    const double size = static_cast<double>(bytes);
    if (size >= gib)
        return program::fixed(size / gib, 1) + " GiB";
    return size >= mib ? program::fixed(size / mib, size < 10 * mib ? 1 : 0) + " MiB"
                       : program::fixed(size / kib, 0) + " KiB";
}

} // namespace vdna::doctor
