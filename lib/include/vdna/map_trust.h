/** @file vdna/map_trust.h
 *  @brief What a map knows about itself (vdna/trust.h), in a file of its own beside its
 *         experiences, written crash-safely.
 *
 *  The file can be made again from the experiences at any time, and without it everything but
 *  predictions works. It lists its members by name and checksum, so it tells when it is stale,
 *  whatever became of the map in the meantime. The format is in docs/reference/SPEC-map.md.
 */
#ifndef VDNA_MAP_TRUST_H
#define VDNA_MAP_TRUST_H

#include <vdna/map.h>
#include <vdna/trust.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_MAP_TRUST_FORMAT 1u                /**< version of the file format */
#define VDNA_MAP_TRUST_FILE "trust.safetensors" /**< name of the file in a map's directory */

/** What a map knows about itself. Opening fills it; to write one, fill it and call
 *  vdna_map_trust_write(). */
typedef struct vdna_map_trust {
    vdna_trust_tables tables; /**< of the runs; they pass vdna_trust_tables_check(). After opening
                                   they end with vdna_map_trust_close() */
    double tolerance;   /**< metres or place numbers, finite, >= 0: as far apart were frames of one
                             place */
    uint32_t runs;      /**< K, 1..VDNA_TRUST_RUNS_MAX */
    uint32_t localiser; /**< whose recall the tables have: VDNA_TRUST_CENTRED or _EUCLIDEAN */
    void *memory;       /**< of the tables after opening; ignored when writing */
} vdna_map_trust;

/** Open the file of a map, check every byte of it, and copy what it knows about these experiences.
 *  @param directory    the map's path
 *  @param experiences  [count], open ones of this map, in any order; those that the file knows
 *                      beside them do not matter
 *  @param count        1..VDNA_TRUST_RUNS_MAX
 *  @param error        filled on failure, and says what to do; NULL = not wanted
 *  @param out_trust    runs are the experiences, in their order; to be ended with
 *                      vdna_map_trust_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_EMPTY if there is no such file; VDNA_ERR_MISMATCH if it
 *          is of another map, or does not know one of the experiences as it is now;
 *          VDNA_ERR_FORMAT; VDNA_ERR_CHECKSUM; VDNA_ERR_UNSUPPORTED for a newer format version or
 *          a big-endian machine; VDNA_ERR_IO; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_map_trust_open(const char *directory, const vdna_experience *experiences,
                                         uint32_t count, vdna_error *error,
                                         vdna_map_trust *out_trust);

/** Open the file of a map for those of the experiences that it knows, to renew it: one that was
 *  added or replaced since is left out. Any of them would make vdna_map_trust_open() refuse.
 *  @param directory, experiences, count, error  as for vdna_map_trust_open()
 *  @param out_known  [count], 1 for an experience that the file knows as it is now, else 0; not to
 *                    be used after an error
 *  @param out_trust  runs are the experiences that it knows, at least one, in their order; to be
 *                    ended with vdna_map_trust_close()
 *  @return what vdna_map_trust_open() returns; VDNA_ERR_MISMATCH if it knows none of them */
VDNA_API vdna_status vdna_map_trust_open_known(const char *directory,
                                               const vdna_experience *experiences, uint32_t count,
                                               vdna_error *error, uint8_t *out_known,
                                               vdna_map_trust *out_trust);

/** Free the tables.
 *  @param trust  open, closed or zeroed; NULL is allowed; zeroed afterwards */
VDNA_API void vdna_map_trust_close(vdna_map_trust *trust);

/** Write the file of a map: temporary file beside it, fsync, rename, fsync of the directory. An
 *  interrupted call leaves it as it was.
 *  @param directory    the map's path
 *  @param experiences  [runs], open ones of this map, in the order of the tables
 *  @param trust        needed for this call only
 *  @param error        filled on failure; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG, also for an experience that is not from a file;
 *          VDNA_ERR_NONFINITE for a number of the tables beyond its range; VDNA_ERR_MISMATCH if
 *          the experiences do not compare, two have one name, or one has other frames than the
 *          tables say; VDNA_ERR_IO; VDNA_ERR_NOMEM; VDNA_ERR_UNSUPPORTED on a big-endian machine */
VDNA_API vdna_status vdna_map_trust_write(const char *directory, const vdna_experience *experiences,
                                          const vdna_map_trust *trust, vdna_error *error);

#ifdef __cplusplus
}
#endif

#endif
