/* Private: the options of an LCM URL, as in file:///a.log?speed=1&mode=r. */
#ifndef VDNA_URL_H
#define VDNA_URL_H

#include <stdbool.h>
#include <string.h>

static inline bool url_has_scheme(const char *url, const char *scheme)
{
    return strncmp(url, scheme, strlen(scheme)) == 0;
}

/* The value of an option, up to the next '&' or the end; NULL = not given. */
static inline const char *url_option(const char *url, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = strchr(url, '?'); at; at = strchr(at + 1, '&'))
        if (strncmp(at + 1, name, length) == 0 && at[1 + length] == '=')
            return at + 1 + length + 1;
    return NULL;
}

#endif
