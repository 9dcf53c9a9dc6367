/* Private to lib/map: one hash over all that two experiences must share to be compared. */
#ifndef VDNA_COMPARABLE_H
#define VDNA_COMPARABLE_H

#include <vdna/map.h>

/* SHA-256, in hexadecimal, over the canonical text of docs/reference/SPEC-map.md and the range's
 * bytes. The experience has passed vdna_rules_check(): no text holds the newline that ends it. */
void vdna_comparable_of(const vdna_experience *experience, char out_sha256[VDNA_MAP_SHA256_SIZE]);

#endif
