// What a check says.
#pragma once

#include <string>

namespace vdna::doctor
{

// unknown: the check needs something that is not there, such as a running daemon.
enum class Grade { ok, unknown, warn, fail };

struct Verdict {
    Grade grade;
    std::string found;
    std::string remedy; // of a warning or a failure: the command or setting that mends it
};

struct Check {
    const char *group;
    const char *name;
    Verdict verdict;
};

inline Verdict ok(const std::string &found)
{
    return {Grade::ok, found, ""};
}

inline Verdict unknown(const std::string &found)
{
    return {Grade::unknown, found, ""};
}

inline Verdict warn(const std::string &found, const std::string &remedy)
{
    return {Grade::warn, found, remedy};
}

inline Verdict broken(const std::string &found, const std::string &remedy)
{
    return {Grade::fail, found, remedy};
}

// A failure from an error's sentence, which says after its first semicolon what to do.
inline Verdict failed(const std::string &sentence)
{
    const size_t end = sentence.find("; ");
    return end == std::string::npos ? broken(sentence, "see the message")
                                    : broken(sentence.substr(0, end), sentence.substr(end + 2));
}

// The same as a warning.
inline Verdict warned(const std::string &sentence)
{
    Verdict verdict = failed(sentence);
    verdict.grade = Grade::warn;
    return verdict;
}

} // namespace vdna::doctor
