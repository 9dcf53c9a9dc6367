#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <vdna/identity.h>

#include "text.h"

/* Bytes of ":NEURONS:SAMPLES" at most, a ',' before the name and the NUL. */
#define NUMBERS_SIZE 24

/* Read the number that ends before `end` and begins after a ':' at or after `begin`.
 * @return the ':'; NULL if there is no such number in 1..UINT32_MAX */
static const char *number_before(const char *begin, const char *end, uint32_t *out_number)
{
    uint64_t number = 0, place = 1;
    const char *at = end;
    for (; at > begin && at[-1] >= '0' && at[-1] <= '9' && end - at < 10; at--) {
        number += (uint64_t)(at[-1] - '0') * place;
        place *= 10;
    }
    if (at == begin || at[-1] != ':' || at == end || *at == '0' || number > UINT32_MAX)
        return NULL;
    *out_number = (uint32_t)number;
    return at - 1;
}

/* see vdna/identity.h */
vdna_status vdna_taps_next(const char **text, vdna_tap *out_tap)
{
    if (!text || !*text || !out_tap)
        return VDNA_ERR_ARG;
    if (**text == '\0')
        return VDNA_ERR_EMPTY;

    /* Find the numbers from the end: a NAME may hold a ':' itself. */
    const char *const begin = *text, *const end = begin + strcspn(begin, ",");
    vdna_tap tap = {begin, 0, 0, 0};
    const char *colon = number_before(begin, end, &tap.samples);
    if (colon)
        colon = number_before(begin, colon, &tap.neurons);
    if (!colon || colon == begin || (*end == ',' && end[1] == '\0'))
        return VDNA_ERR_FORMAT;
    tap.name_length = (size_t)(colon - begin);
    *text = *end == ',' ? end + 1 : end;
    *out_tap = tap;
    return VDNA_OK;
}

static int is_tap(const vdna_tap *tap)
{
    if (!tap || !tap->name || tap->name_length == 0 || tap->neurons == 0 || tap->samples == 0)
        return 0;
    for (size_t i = 0; i < tap->name_length; i++)
        if (!vdna_is_printable(tap->name[i]) || tap->name[i] == ',')
            return 0;
    return 1;
}

/* see vdna/identity.h */
vdna_status vdna_taps_append(char *text, size_t text_size, const vdna_tap *tap)
{
    if (!text || !is_tap(tap))
        return VDNA_ERR_ARG;
    char numbers[NUMBERS_SIZE];
    snprintf(numbers, sizeof numbers, ":%" PRIu32 ":%" PRIu32, tap->neurons, tap->samples);
    const size_t used = strlen(text), comma = used > 0, rest = strlen(numbers) + 1;
    /* One by one, because their sum may wrap. */
    if (text_size < used + comma + rest || text_size - used - comma - rest < tap->name_length)
        return VDNA_ERR_NOMEM;

    if (comma)
        text[used] = ',';
    memcpy(text + used + comma, tap->name, tap->name_length);
    memcpy(text + used + comma + tap->name_length, numbers, rest);
    return VDNA_OK;
}
