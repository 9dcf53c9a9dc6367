/* Private to lib/identity: which characters a text may have, and how long it may be. */
#ifndef VDNA_IDENTITY_TEXT_H
#define VDNA_IDENTITY_TEXT_H

#include <stddef.h>

#include <vdna/status.h>

/* An alphabet: whether it contains a character. */
typedef int vdna_alphabet(char c);

/* The characters that every JSON writer writes alike; no newline. */
int vdna_is_printable(char c);

/* Check a text in a field of `size` bytes, which may lack a NUL.
 * @param called    its name in the message, with a space after it; "" = none
 * @param expected  the alphabet in words: "printable ASCII characters"
 * @param error     filled on failure, without quoting the text, which may hold anything
 * @return VDNA_OK; VDNA_ERR_ARG */
vdna_status vdna_text_check(const char *called, const char *text, size_t size,
                            vdna_alphabet *alphabet, const char *expected, vdna_error *error);

/* The same for a text in the alphabet of names. */
vdna_status vdna_text_check_name(const char *called, const char *text, size_t size,
                                 vdna_error *error);

#endif
