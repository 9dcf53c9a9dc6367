// Failures inside a C++ library, and their translation at its C ABI.
#pragma once

#include <new>
#include <stdexcept>
#include <string>

#include <vdna/status.h>

#include "fail.h"

namespace vdna::fail
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

// Run `body`, and turn anything it throws into a status and a sentence: no exception escapes.
template <class Body>
vdna_status guarded(vdna_error *error, Body body) noexcept
{
    try {
        body();
        return VDNA_OK;
    } catch (const Failure &failure) {
        return vdna_fail(error, failure.status(), "%s", failure.what());
    } catch (const std::bad_alloc &) {
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s", vdna_status_text(VDNA_ERR_NOMEM));
    } catch (const std::exception &failure) {
        return vdna_fail(error, VDNA_ERR_RUNTIME, "%s", failure.what());
    } catch (...) {
        return vdna_fail(error, VDNA_ERR_RUNTIME, "unknown exception");
    }
}

} // namespace vdna::fail
