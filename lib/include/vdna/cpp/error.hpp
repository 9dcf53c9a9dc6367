/** @file vdna/cpp/error.hpp
 *  @brief The exception that carries a sentence for people, and how a call of the C ABI becomes
 * one.
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

/** Throw unless a call went well that fills a vdna_error. */
inline void require(vdna_status status, const vdna_error &error)
{
    if (status != VDNA_OK)
        throw Error(error.text);
}

/** Throw unless a call of the core went well, which has a status and no text of its own.
 *  @param where  names the file or frame that was worked on */
inline void require(vdna_status status, const std::string &where)
{
    if (status != VDNA_OK)
        throw Error(where + ": " + vdna_status_text(status));
}

} // namespace vdna

#endif
