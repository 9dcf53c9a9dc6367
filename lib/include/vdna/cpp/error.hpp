/** @file vdna/cpp/error.hpp
 *  @brief The exception thrown for failed calls of the C ABI; it carries a sentence for people.
 */
#ifndef VDNA_CPP_ERROR_HPP
#define VDNA_CPP_ERROR_HPP

#include <stdexcept>
#include <string>

#include <vdna/status.h>

namespace vdna
{

/** what() is one sentence: where, what was found, what was expected, what to do. */
class Error : public std::runtime_error
{
  public:
    using std::runtime_error::runtime_error;
};

/** Throw if a call failed that fills a vdna_error. */
inline void require(vdna_status status, const vdna_error &error)
{
    if (status != VDNA_OK)
        throw Error(error.text);
}

/** Throw if a call of the core failed, which gives a status but no text.
 *  @param where  names the file or frame in question */
inline void require(vdna_status status, const std::string &where)
{
    if (status != VDNA_OK)
        throw Error(where + ": " + vdna_status_text(status));
}

} // namespace vdna

#endif
