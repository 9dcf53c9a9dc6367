// How the inside of lib/backbone fails: what the C ABI turns into a status and a sentence.
#pragma once

#include <stdexcept>
#include <string>

#include <vdna/status.h>

namespace vdna::backbone
{

class Failure : public std::runtime_error
{
  public:
    Failure(vdna_status status, const std::string &sentence)
        : std::runtime_error(sentence), status_(status)
    {
    }
    vdna_status status() const { return status_; }

  private:
    vdna_status status_;
};

} // namespace vdna::backbone
