/* Private to lib/: filling the vdna_error of a failed call. */
#ifndef VDNA_FAIL_H
#define VDNA_FAIL_H

#include <stdarg.h>
#include <stdio.h>

#include <vdna/status.h>

/* Write the sentence, if the caller wants it, and return the status:
 *     return vdna_fail(error, VDNA_ERR_IO, "%s: cannot open: %s", path, strerror(errno)); */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static inline vdna_status
vdna_fail(vdna_error *error, vdna_status status, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

#endif
