#include "json.h"

#include <string.h>

/* Bytes of the longest UTF-8 sequence. */
#define CHARACTER_SIZE 4

int vdna_json_fail(vdna_json *json, const char *expected)
{
    json->expected = expected;
    return 0;
}

static void skip_space(vdna_json *json)
{
    while (json->at < json->end &&
           (*json->at == ' ' || *json->at == '\t' || *json->at == '\n' || *json->at == '\r'))
        json->at++;
}

int vdna_json_try(vdna_json *json, char mark)
{
    skip_space(json);
    if (json->at == json->end || *json->at != (unsigned char)mark)
        return 0;
    json->at++;
    return 1;
}

static const char *name_of(char mark)
{
    switch (mark) {
    case '{':
        return "'{'";
    case '}':
        return "',' or '}'";
    case '[':
        return "'['";
    case ']':
        return "',' or ']'";
    case ':':
        return "':'";
    default:
        return "','";
    }
}

int vdna_json_take(vdna_json *json, char mark)
{
    return vdna_json_try(json, mark) ? 1 : vdna_json_fail(json, name_of(mark));
}

/* Bytes that follow a lead byte; -1 if it starts no sequence. */
static int continuation_bytes(unsigned char lead)
{
    if (lead < 0x80)
        return 0;
    if (lead >= 0xC2 && lead <= 0xDF)
        return 1;
    if (lead >= 0xE0 && lead <= 0xEF)
        return 2;
    return lead >= 0xF0 && lead <= 0xF4 ? 3 : -1;
}

/* Whether the second byte rules out overlong forms and surrogates. */
static int is_second_byte(unsigned char lead, unsigned char second)
{
    const unsigned char least = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
    const unsigned char most = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
    return second >= least && second <= most;
}

/* Take one unescaped character. @return its bytes in `out`, 0 = malformed */
static size_t take_plain(vdna_json *json, unsigned char out[CHARACTER_SIZE])
{
    const unsigned char lead = *json->at;
    const int more = continuation_bytes(lead);
    if (lead < 0x20 || more < 0 || json->end - json->at <= more)
        return 0;
    if (more > 0 && !is_second_byte(lead, json->at[1]))
        return 0;
    for (int i = 2; i <= more; i++)
        if ((json->at[i] & 0xC0) != 0x80)
            return 0;
    const size_t size = (size_t)more + 1;
    memcpy(out, json->at, size);
    json->at += size;
    return size;
}

static int hex_value(unsigned char digit)
{
    if (digit >= '0' && digit <= '9')
        return digit - '0';
    if (digit >= 'a' && digit <= 'f')
        return digit - 'a' + 10;
    return digit >= 'A' && digit <= 'F' ? digit - 'A' + 10 : -1;
}

/* Take "\uXXXX". @return the UTF-16 unit, 0 = malformed or an escaped NUL */
static uint32_t take_unit(vdna_json *json)
{
    if (json->end - json->at < 6 || json->at[0] != '\\' || json->at[1] != 'u')
        return 0;
    uint32_t unit = 0;
    for (int i = 2; i < 6; i++) {
        const int value = hex_value(json->at[i]);
        if (value < 0)
            return 0;
        unit = unit * 16 + (uint32_t)value;
    }
    json->at += 6;
    return unit;
}

/* Take one or, for a surrogate pair, two units. @return the code point, 0 = malformed */
static uint32_t take_code_point(vdna_json *json)
{
    const uint32_t unit = take_unit(json);
    if (unit < 0xD800 || unit > 0xDFFF)
        return unit;
    const uint32_t low = unit < 0xDC00 ? take_unit(json) : 0;
    if (low < 0xDC00 || low > 0xDFFF)
        return 0;
    return 0x10000 + ((unit - 0xD800) << 10) + (low - 0xDC00);
}

static size_t encode(uint32_t code, unsigned char out[CHARACTER_SIZE])
{
    if (code < 0x80) {
        out[0] = (unsigned char)code;
        return 1;
    }
    const size_t size = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    for (size_t i = size - 1; i > 0; i--) {
        out[i] = (unsigned char)(0x80 | (code & 0x3F));
        code >>= 6;
    }
    static const unsigned char lead[] = {0, 0, 0xC0, 0xE0, 0xF0};
    out[0] = (unsigned char)(lead[size] | code);
    return size;
}

/* Take one escaped character. @return its bytes in `out`, 0 = malformed */
static size_t take_escape(vdna_json *json, unsigned char out[CHARACTER_SIZE])
{
    static const char written[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
    if (json->end - json->at < 2)
        return 0;
    if (json->at[1] == 'u') {
        const uint32_t code = take_code_point(json);
        return code == 0 ? 0 : encode(code, out);
    }
    const char *found = memchr(written, json->at[1], sizeof written - 1);
    if (!found)
        return 0;
    out[0] = (unsigned char)meant[found - written];
    json->at += 2;
    return 1;
}

int vdna_json_string(vdna_json *json, char *out, size_t capacity)
{
    if (!vdna_json_try(json, '"'))
        return vdna_json_fail(json, "a string");

    size_t used = 0;
    while (json->at < json->end && *json->at != '"') {
        unsigned char character[CHARACTER_SIZE];
        const size_t size =
            *json->at == '\\' ? take_escape(json, character) : take_plain(json, character);
        if (size == 0)
            return vdna_json_fail(json, "a character of a JSON string in UTF-8");
        if (size >= capacity - used)
            return vdna_json_fail(json, "the end of a string that is too long");
        memcpy(out + used, character, size);
        used += size;
    }
    out[used] = '\0';
    if (json->at == json->end)
        return vdna_json_fail(json, "the end of a string");
    json->at++;
    return 1;
}

int vdna_json_number(vdna_json *json, uint64_t *out_number)
{
    static const char *const expected = "a whole number below 2^64";
    skip_space(json);
    const unsigned char *const first = json->at;
    uint64_t number = 0;
    for (; json->at < json->end && *json->at >= '0' && *json->at <= '9'; json->at++) {
        const uint64_t digit = *json->at - (uint64_t)'0';
        if (number > (UINT64_MAX - digit) / 10)
            return vdna_json_fail(json, expected);
        number = number * 10 + digit;
    }
    /* JSON writes no leading zeros. */
    if (json->at == first || (*first == '0' && json->at - first > 1))
        return vdna_json_fail(json, expected);
    *out_number = number;
    return 1;
}

int vdna_json_end(vdna_json *json)
{
    skip_space(json);
    return json->at == json->end ? 1 : vdna_json_fail(json, "the end of the header");
}
