/* Private to lib/map: the rules of a valid experience, for writing and reading. */
#ifndef VDNA_RULES_H
#define VDNA_RULES_H

#include <vdna/map.h>

/* Check every field except `comparable` against the rules of vdna/map.h and
 * docs/reference/SPEC-map.md.
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE; VDNA_ERR_MISMATCH for numbers that contradict
 *         each other */
vdna_status vdna_rules_check(const vdna_experience *experience, vdna_error *reason);

/* Check what a header says by itself: the texts except `comparable`, and the sizes that they must
 * fit.
 * @param reason, @return  as above */
vdna_status vdna_rules_check_header(const vdna_experience *header, vdna_error *reason);

#endif
