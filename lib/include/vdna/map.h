/** @file vdna/map.h
 *  @brief Experience files: one recorded traversal each, read by mmap without a copy, written
 *         crash-safely. A map is a directory of them.
 *
 *  The format, docs/reference/SPEC-map.md: the safetensors layout, with our checksums and metadata.
 */
#ifndef VDNA_MAP_H
#define VDNA_MAP_H

#include <vdna/hist.h>
#include <vdna/identity.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_MAP_FORMAT 4u           /**< version of the experience file format */
#define VDNA_MAP_EXTENSION ".vdna"   /**< file name ending of an experience */
#define VDNA_MAP_FILE_SIZE 256u      /**< bytes of a file's name in a map, its NUL included */
#define VDNA_PLACE_NONE INT64_MIN    /**< place number of a frame without ground truth */
#define VDNA_FRAME_WGS84 "wgs84"     /**< position frame: Earth-centred metres made from GPS */
#define VDNA_FRAME_LOCAL "local"     /**< position frame: metres of a map of one's own, unnamed */
#define VDNA_ORDER_SIZE 32u          /**< bytes of `order` in vdna_experience, its NUL included */
#define VDNA_SOURCE_SIZE 128u        /**< bytes of `source` there, its NUL included */
#define VDNA_THUMBNAIL_MAX 4096u     /**< most bytes of a frame's thumbnail */
#define VDNA_EXPERIENCE_ALIGNMENT 8u /**< of the bytes for vdna_experience_open_memory() */
#define VDNA_EMBEDDING_MAX                                                 \
    1e15f /**< greatest magnitude of a number of an embedding: the squared \
               distance of two frames is then far within a float */

/** One experience. Reading fills it; to write one, fill it and call vdna_experience_write(). */
typedef struct vdna_experience {
    char name[VDNA_NAME_SIZE];         /**< of the traversal: "winter"; passes vdna_name_check() */
    vdna_identity identity;            /**< what it compares with; complete in an experience.
                                            `range` and `projection` belong to the file, or to the
                                            code that fills this */
    char comparable[VDNA_SHA256_SIZE]; /**< vdna_identity_hash(); the writer computes it */
    uint32_t frames;                   /**< >= 1 */
    const uint32_t *counts;            /**< [bins][neurons] */
    const uint32_t *mass;              /**< [neurons], sums of the counts */
    const float *embeddings;           /**< [frames][dim], each number within
                                            VDNA_EMBEDDING_MAX: what frames are localised by; NULL
                                            = `embedding_codes` alone, as
                                            vdna_experience_open_memory() leaves them; a
                                            live frame's is vdna_identity_project() of what the
                                            network gives */
    const int64_t *frame_utime;        /**< [frames], camera stamps in microseconds */
    const int64_t *frame_place;   /**< [frames], place numbers, VDNA_PLACE_NONE = this frame has
                                       none; NULL = not labelled with places */
    const double *frame_position; /**< [frames][3], metres in `position_frame`, three NaNs = this
                                       frame has no position; NULL = no positions */
    const float *frame_grey;      /**< [frames], mean grey level 0..255 */
    const void *file_bytes;       /**< [file_size], the file, mapped or copied, read-only: the whole
                                       of it, or what is left without thumbnails
                                       (`no_thumbnails` of vdna_map_config); NULL = not from a
                                       file. Closing unmaps it */
    size_t file_size;             /**< bytes; 0 = not from a file */
    char position_frame[VDNA_NAME_SIZE]; /**< the Cartesian frame of the positions, which only
                                              compare within it: VDNA_FRAME_WGS84, or the name of a
                                              local one, which passes vdna_name_check(); ignored
                                            without positions, and "" after reading. The writer
                                            takes "" beside positions for VDNA_FRAME_WGS84 if all of
                                            them lie 6.3e6 to 6.5e6 m from the origin, else for
                                            VDNA_FRAME_LOCAL, and so does the reader of a file that
                                            says nothing */
    char order[VDNA_ORDER_SIZE];   /**< what ordered the frames: "utime", "numbers" or "names" of
                                        pictures, "log", "video" or "manifest"; alphabet as for names;
                                        "" = not known */
    const int8_t *last_layer;      /**< [frames][last_layer_dim], a second embedding of each frame:
                                        that of the network's last layer, which tells whether a run
                                        is like any of the map's. Codes of vdna/int8.h; NULL = not
                                        stored */
    const float *last_layer_scale; /**< [frames], of the codes: from 0 to VDNA_EMBEDDING_MAX / 127;
                                        NULL = not stored */
    uint32_t last_layer_dim;       /**< >= 1; 0 = not stored */
    uint32_t checksum;             /**< CRC-32C of the file; 0 = not from a file */
    const int8_t *embedding_codes; /**< [frames][dim], codes of vdna/int8.h that the file has in
                                        place of `embeddings`, which vdna_experience_open() decodes
                                        into memory of the experience; NULL = the file has floats */
    const float *embedding_scale;  /**< [frames], of the codes: from 0 to VDNA_EMBEDDING_MAX / 127;
                                        NULL = no codes */
    const uint8_t *thumbnails;     /**< [thumbnail_bytes], small JPEG pictures of the frames, one
                                        after the other, for people: vdna_experience_thumbnail()
                                        finds one. Nothing here decodes them. NULL = none */
    const uint32_t *thumbnail_end; /**< [frames], where each frame's thumbnail ends in
                                        `thumbnails`; it begins where the one before it ends, and
                                        has 0 (there is none) to VDNA_THUMBNAIL_MAX bytes; NULL =
                                        none */
    uint32_t thumbnail_bytes;      /**< of all, the last end; 0 = none */
    char source[VDNA_SOURCE_SIZE]; /**< what it was made from, for people: printable ASCII;
                                        "" = not known */
} vdna_experience;

/** Open an experience file: map it, check every byte of it, point into it.
 *  @param path  a regular file; while it is open it may be replaced by a rename or deleted, but not
 *               written to or cut short in place: its pages are shared with the file system, and
 *               reading one that is gone raises SIGBUS. vdna_experience_write() renames;
 *               vdna_map_open_as() can copy files instead
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_experience  holds the file, to be ended with vdna_experience_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO; VDNA_ERR_FORMAT; VDNA_ERR_CHECKSUM;
 *          VDNA_ERR_UNSUPPORTED for a newer format version or a big-endian machine; VDNA_ERR_NOMEM
 *          for embeddings to be decoded */
VDNA_API vdna_status vdna_experience_open(const char *path, vdna_error *error,
                                          vdna_experience *out_experience);

/** Read what the header of an experience file says, and check its names and texts, but not its
 *  checksum or any tensor: enough to list a map, or to tell by `comparable` what compares with it.
 *  The call takes up to 128 KiB of stack.
 *  @param path  as for vdna_experience_open()
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_experience  its texts and sizes; every pointer is NULL and `checksum` 0. `comparable`
 *                         is as the file has it; `position_frame` is "" also if there are positions
 *                         and the file does not state their frame. It holds nothing, so
 *                         vdna_experience_close() only zeroes it, and need not be called
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO; VDNA_ERR_FORMAT; VDNA_ERR_UNSUPPORTED for a newer
 *          format version or a big-endian machine */
VDNA_API vdna_status vdna_experience_read_header(const char *path, vdna_error *error,
                                                 vdna_experience *out_experience);

/** Open the bytes of an experience file where they are, in flash for instance: check every byte as
 *  vdna_experience_open() does, point into them. Nothing is copied and nothing allocated;
 *  the call takes up to 128 KiB of stack, for the header of the file.
 *  Embeddings that are stored as codes stay so: `embeddings` is NULL then, and vdna_int8_decode()
 *  gives those of a frame. `vdna export --c-array` makes a C array of a file.
 *  @param bytes  [size], aligned to VDNA_EXPERIENCE_ALIGNMENT; borrowed and unchanged as long as
 * the experience is in use
 *  @param size  bytes
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_experience  `file_bytes` is NULL; it holds nothing, so vdna_experience_close() only
 *                         zeroes it, and need not be called
 *  @return VDNA_OK; VDNA_ERR_ARG, also for bytes that are not aligned; VDNA_ERR_FORMAT;
 *          VDNA_ERR_CHECKSUM; VDNA_ERR_UNSUPPORTED for a newer format version or a big-endian
 *          machine */
VDNA_API vdna_status vdna_experience_open_memory(const void *bytes, size_t size, vdna_error *error,
                                                 vdna_experience *out_experience);

/** Unmap; all pointers into the experience end.
 *  @param experience  open, closed or zeroed; NULL is allowed; zeroed afterwards */
VDNA_API void vdna_experience_close(vdna_experience *experience);

/** Write an experience: temporary file beside `path`, fsync, rename, fsync of the directory. An
 *  interrupted call leaves `path` as it was. `comparable` is computed, not read. If an update of
 *  the directory was interrupted when it was final, it is finished first (vdna_map_update_open()).
 *  @param experience  needed for this call only
 *  @param path  replaced if it exists
 *  @param error  filled on failure; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG, VDNA_ERR_NONFINITE or VDNA_ERR_MISMATCH (mass and counts) for an
 *          experience that breaks the rules above; VDNA_ERR_IO; VDNA_ERR_UNSUPPORTED on a
 *          big-endian machine; VDNA_ERR_FORMAT for a damaged record of an interrupted update */
VDNA_API vdna_status vdna_experience_write(const vdna_experience *experience, const char *path,
                                           vdna_error *error);

/** Check that two experiences may be compared, as vdna_identity_compare() does; names and lengths
 *  may differ.
 *  @param a, b  open ones, or filled as for vdna_experience_write()
 *  @param error  filled on failure; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_MISMATCH, and `error` names the first field that differs
 */
VDNA_API vdna_status vdna_experience_compare(const vdna_experience *a, const vdna_experience *b,
                                             vdna_error *error);

/** Look at the Visual DNA of an experience.
 *  @param experience  borrowed: the view ends when it is closed
 *  @param out_view  untouched if an argument is NULL */
VDNA_API void vdna_experience_view(const vdna_experience *experience, vdna_hist_view *out_view);

/** Look at the thumbnail of a frame.
 *  @param experience  borrowed: the bytes end when it is closed
 *  @param frame  0 to experience->frames - 1
 *  @param out_jpeg  a JPEG file, which nobody has decoded: its content may be anything
 *  @param out_size  bytes, at least 1 and at most VDNA_THUMBNAIL_MAX
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_EMPTY if the frame has none */
VDNA_API vdna_status vdna_experience_thumbnail(const vdna_experience *experience, uint32_t frame,
                                               const uint8_t **out_jpeg, size_t *out_size);

/** Tell whether the codes of the last layer stand for the activations that the Visual DNA counts:
 *  they do if that layer, with one sample per neuron, is the only tap.
 *  @param experience  NULL gives 0
 *  @return 1 if so; 0 if not, and without codes */
VDNA_API uint32_t vdna_experience_counts_last_layer(const vdna_experience *experience);

/** Count the experience files of a directory: names ending in VDNA_MAP_EXTENSION, hidden ones (a
 *  leading '.') left out. An update of the map counts as a whole or not at all.
 *  @param directory  a path
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_count  0 for a directory without any
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NOMEM; VDNA_ERR_IO, also if the directory changes all
 *          the time; VDNA_ERR_FORMAT for a damaged record of an interrupted update */
VDNA_API vdna_status vdna_map_count(const char *directory, vdna_error *error, uint32_t *out_count);

/** One experience file of a map. */
typedef struct vdna_map_file {
    char name[VDNA_MAP_FILE_SIZE]; /**< "winter.vdna" */
    char file[VDNA_MAP_FILE_SIZE]; /**< file with its bytes: the same name, unless an update was
                                        interrupted after becoming final and before all new files
                                        had their names; the next update finishes that */
} vdna_map_file;

/** List the experience files of a directory in the byte order of their names, as they were at one
 *  moment. An update may rename them before you open them: vdna_map_open() gets all of one moment.
 *  @param directory  a path
 *  @param capacity  the most that `out_files` can hold
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_files  [capacity], of which *out_count are filled
 *  @param out_count  0 for a directory without any
 *  @return VDNA_OK; VDNA_ERR_NOMEM if there are more than `capacity`; what vdna_map_count() returns
 */
VDNA_API vdna_status vdna_map_list(const char *directory, uint32_t capacity, vdna_error *error,
                                   vdna_map_file *out_files, uint32_t *out_count);

/** Open all experiences of a map, in the byte order of their file names, and check that they
 *  compare and that their names differ. All are of one moment: an update that others commit
 *  meanwhile is in all of them or in none.
 *  @param directory  a path
 *  @param capacity  the most that `out_experiences` can hold
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_experiences  [capacity]; the first *out_count are open after VDNA_OK, none after an
 *                          error
 *  @param out_count  number of open experiences
 *  @return VDNA_OK; VDNA_ERR_EMPTY if there is none; VDNA_ERR_NOMEM if there are more than
 *          `capacity` (an update may have added some since they were counted); what
 * vdna_map_count(), vdna_experience_open() and vdna_experience_compare() return */
VDNA_API vdna_status vdna_map_open(const char *directory, uint32_t capacity, vdna_error *error,
                                   vdna_experience *out_experiences, uint32_t *out_count);

/** How to open a map. Fill with vdna_map_config_init(). */
typedef struct vdna_map_config {
    uint32_t struct_size; /**< set by vdna_map_config_init() */
    uint32_t copy;        /**< 0 = map the files, as vdna_experience_open() does (default); 1 = copy
                               them into memory of the process, which the system cannot take back:
                               whatever happens to a file then, the experience stays as it was */
    uint32_t no_thumbnails; /**< 0 = with thumbnails (default); 1 = without: they are checked with
                                 the rest of their file, and then given back, so that no memory
                                 holds them. Opening holds one file with them at a time */
    uint32_t reserved;      /**< 0 */
    /** Leave out files that are damaged or cannot be read, and report each one here; NULL = refuse
     *  a map with such a file (default). Called by vdna_map_open_as() before it succeeds.
     *  @param context  `context`
     *  @param reason  names the file, says what is wrong and what to do; ends with the call */
    void (*left_out)(void *context, const char *reason);
    void *context; /**< for `left_out` */
} vdna_map_config;

/** Write the defaults.
 *  @param config  overwritten; NULL is allowed */
VDNA_API void vdna_map_config_init(vdna_map_config *config);

/** Open a map as vdna_map_open() does, and as `config` says.
 *  @param config  needed for this call only
 *  @param directory, capacity, error, out_experiences, out_count  as for vdna_map_open();
 * *out_count does not count what is left out
 *  @return what vdna_map_open() returns; VDNA_ERR_ARG for a bad config. Files that are left out are
 *          those for which vdna_experience_open() would return VDNA_ERR_FORMAT, VDNA_ERR_CHECKSUM
 * or VDNA_ERR_IO; if all would be, the map is refused for the first one */
VDNA_API vdna_status vdna_map_open_as(const vdna_map_config *config, const char *directory,
                                      uint32_t capacity, vdna_error *error,
                                      vdna_experience *out_experiences, uint32_t *out_count);

/** A change of a map: experience files that appear, or replace others, together or not at all. One
 *  thread at a time. It keeps to the directory that was opened, whatever becomes of its path. */
typedef struct vdna_map_update vdna_map_update;

/** Begin an update of a map. Nobody else can until it is closed or the process ends. First finishes
 *  an update that was interrupted after becoming final, and removes leftovers.
 *  @param directory  a path, which exists
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_update  the caller's, to be ended with vdna_map_update_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO, also if another program is changing the map;
 *          VDNA_ERR_FORMAT; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_map_update_open(const char *directory, vdna_error *error,
                                          vdna_map_update **out_update);

/** Write an experience beside the map's files; vdna_map_update_commit() makes it NAME.vdna.
 *  @param update  an open one that is not committed; unchanged after an error
 *  @param experience  as for vdna_experience_write(); needed for this call only; its name may not
 *                     begin with '.', which would hide its file
 *  @param error  filled on failure; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG, also for more than 4096 experiences in one update;
 *          VDNA_ERR_NOMEM; what vdna_experience_write() returns */
VDNA_API vdna_status vdna_map_update_add(vdna_map_update *update, const vdna_experience *experience,
                                         vdna_error *error);

/** Put all that was added in its place. Readers, and a machine that loses its power at any moment,
 *  find all of it or nothing (docs/reference/SPEC-map.md says how).
 *  @param update  an open one; if the error says that the map is unchanged, this may be repeated;
 *                 otherwise the update is over, and only to be closed
 *  @param error  filled on failure: says whether the map is unchanged, or the update is final and
 *                the next one finishes it; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG, also if one name was added twice; VDNA_ERR_MISMATCH if what was
 *          added does not compare with itself or with an experience that stays in the map, or has
 *          the name of one that is in a file of another name; VDNA_ERR_NOMEM; VDNA_ERR_IO */
VDNA_API vdna_status vdna_map_update_commit(vdna_map_update *update, vdna_error *error);

/** End it; what was added and not committed is removed.
 *  @param update  NULL is allowed */
VDNA_API void vdna_map_update_close(vdna_map_update *update);

#ifdef __cplusplus
}
#endif

#endif
