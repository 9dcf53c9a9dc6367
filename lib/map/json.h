/* Private to lib/map: a reader for the JSON of a safetensors header, token by token from untrusted
 * bytes. Nothing is allocated and nothing recurses; strings go to the caller's buffers.
 */
#ifndef VDNA_JSON_H
#define VDNA_JSON_H

#include <stddef.h>
#include <stdint.h>

/* A position in the text. After a failure it only tells where that was. */
typedef struct vdna_json {
    const unsigned char *at, *end;
    const char *expected; /* after a failure: the token expected at `at` */
} vdna_json;

/* Record a failure at the current place. @return 0 */
int vdna_json_fail(vdna_json *json, const char *expected);

/* Take `mark`, one of {}[]:, and the white space before it. @return 1 if it is there */
int vdna_json_try(vdna_json *json, char mark);

/* As vdna_json_try(), but a missing mark is a failure. */
int vdna_json_take(vdna_json *json, char mark);

/* Take a string, decoded to UTF-8 and NUL-terminated. Escaped NULs, lone surrogates, malformed
 * UTF-8 and strings of more than `capacity` - 1 bytes are failures. @return 1 if taken */
int vdna_json_string(vdna_json *json, char *out, size_t capacity);

/* Take a whole number, 0..UINT64_MAX, without sign, fraction or exponent. @return 1 if taken */
int vdna_json_number(vdna_json *json, uint64_t *out_number);

/* Check that only white space is left. @return 1 if so */
int vdna_json_end(vdna_json *json);

#endif
