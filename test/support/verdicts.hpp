// Expectations of what a check of the doctor says.
#pragma once

#include <string>

#include "cmocka.hpp"
#include "doctor/verdict.hpp"

inline void expect(const vdna::doctor::Verdict &verdict, vdna::doctor::Grade grade,
                   const std::string &found)
{
    if (verdict.grade != grade || verdict.found.find(found) == std::string::npos)
        fail_msg("expected grade %d and '%s', found %d and '%s'", static_cast<int>(grade),
                 found.c_str(), static_cast<int>(verdict.grade), verdict.found.c_str());
    const bool has_remedy = !verdict.remedy.empty();
    assert_int_equal(has_remedy,
                     grade == vdna::doctor::Grade::warn || grade == vdna::doctor::Grade::fail);
}

inline void expect_ok(const vdna::doctor::Verdict &verdict, const std::string &found)
{
    expect(verdict, vdna::doctor::Grade::ok, found);
}

inline void expect_unknown(const vdna::doctor::Verdict &verdict, const std::string &found)
{
    expect(verdict, vdna::doctor::Grade::unknown, found);
}

// remedy: a part of it
inline void expect_warning(const vdna::doctor::Verdict &verdict, const std::string &found,
                           const std::string &remedy)
{
    expect(verdict, vdna::doctor::Grade::warn, found);
    if (verdict.remedy.find(remedy) == std::string::npos)
        fail_msg("expected the remedy '%s', found '%s'", remedy.c_str(), verdict.remedy.c_str());
}

inline void expect_failure(const vdna::doctor::Verdict &verdict, const std::string &found,
                           const std::string &remedy)
{
    expect(verdict, vdna::doctor::Grade::fail, found);
    if (verdict.remedy.find(remedy) == std::string::npos)
        fail_msg("expected the remedy '%s', found '%s'", remedy.c_str(), verdict.remedy.c_str());
}
