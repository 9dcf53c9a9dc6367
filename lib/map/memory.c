#include <fail.h>

#include <vdna/map.h>

#include "read.h"

/* see vdna/map.h */
vdna_status vdna_experience_open_memory(const void *bytes, size_t size, vdna_error *error,
                                        vdna_experience *out_experience)
{
    if (!bytes || !out_experience)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "experience in memory: no bytes or no place for what is in them");
    if ((uintptr_t)bytes % VDNA_EXPERIENCE_ALIGNMENT != 0)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "experience in memory: its bytes begin at address %p, expected a multiple"
                         " of %u; align the array, as `vdna export --c-array` does",
                         bytes, VDNA_EXPERIENCE_ALIGNMENT);
    vdna_error reason;
    const vdna_status status = vdna_read(bytes, size, VDNA_READ_IN_PLACE, &reason, out_experience);
    if (status != VDNA_OK)
        return vdna_fail(error, status, "experience in memory: %s; %s", reason.text,
                         vdna_read_remedy(status));
    return VDNA_OK;
}
