/* How config structs grow. Private to the library; also C++.
 *
 * A config struct begins with `uint32_t struct_size`, which tells the library how much of it the
 * caller knows. New fields are only ever appended, and the first begins where the struct ended
 * before, padding included, because callers that do not know it never wrote there. A caller
 * compiled against an older header gets the defaults of the fields that it lacks; one compiled
 * against a newer header is refused, because it may rely on features that this library lacks.
 *
 * vdna_X_config_init() never writes more than the struct of version 0.1: old callers, and bindings
 * with a copy of the struct, have no more room. A struct that has grown also has
 * vdna_X_config_init_sized(), which takes the size of the caller's struct, and a macro through
 * which C and C++ call that instead.
 *
 * To grow one: append the field; turn OLDEST_..._CONFIG from sizeof into the offset of that field;
 * add the function and the macro, as in vdna/window.h. test/contract/abi/old_caller.c, whose
 * structs are those of version 0.1, fails if a step is left out. */
#ifndef VDNA_CORE_GROWTH_H
#define VDNA_CORE_GROWTH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Write as much of the defaults as the caller has room for.
 * @param out_config  the caller's, `struct_size` bytes; NULL is allowed
 * @param defaults    a config struct of today, `size` bytes */
void vdna_config_write(void *out_config, size_t struct_size, const void *defaults, size_t size);

/* Overwrite the defaults with the fields that the caller has.
 * @param given   the caller's; NULL is refused
 * @param oldest  bytes of the struct in version 0.1
 * @param config  in: the defaults, a config struct of today of `size` bytes; out: complete
 * @return 1; 0 if the caller's struct is smaller than the oldest or larger than that of today */
int vdna_config_read(const void *given, size_t oldest, void *config, size_t size);

#ifdef __cplusplus
}
#endif

#endif
