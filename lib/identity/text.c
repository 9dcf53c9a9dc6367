#include "text.h"

#include <fail.h>

#include <vdna/identity.h>

static int is_name(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
}

int vdna_is_printable(char c)
{
    return c >= ' ' && c <= '~';
}

vdna_status vdna_text_check(const char *called, const char *text, size_t size,
                            vdna_alphabet *alphabet, const char *expected, vdna_error *error)
{
    size_t i = 0;
    while (i < size && text[i] != '\0' && alphabet(text[i]))
        i++;
    if (i > 0 && i < size && text[i] == '\0')
        return VDNA_OK;
    return vdna_fail(error, VDNA_ERR_ARG, "%s%s, expected 1 to %zu %s", called,
                     i == size         ? "is too long"
                     : text[i] == '\0' ? "is empty"
                                       : "has a character that is not allowed",
                     size - 1, expected);
}

vdna_status vdna_text_check_name(const char *called, const char *text, size_t size,
                                 vdna_error *error)
{
    return vdna_text_check(called, text, size, is_name, VDNA_NAME_ALPHABET, error);
}

/* see vdna/identity.h */
vdna_status vdna_name_check(const char *name, vdna_error *error)
{
    if (!name)
        return vdna_fail(error, VDNA_ERR_ARG, "is missing, expected a name");
    return vdna_text_check_name("", name, VDNA_NAME_SIZE, error);
}

/* see vdna/identity.h */
void vdna_name_replace(char *name)
{
    for (; name && *name != '\0'; name++)
        if (!is_name(*name))
            *name = '_';
}
