/** @file vdna/identity.h
 *  @brief The identity of a Visual DNA: the network, its input, its taps, the bins, the embedding.
 *
 *  A distance between histograms means something only if the same network saw pictures prepared the
 *  same way and the same activations were counted in the same bins. An experience file, an open
 *  backbone and a file of ranges each carry an identity and are all compared alike.
 *
 *  A field that is not known yet (dim, bins, range) is not compared: a backbone, for instance,
 *  knows neither bins nor ranges. The definition of the embedding is known if `dim` is, the
 *  projection of embeddings, or that there is none, if `range` is.
 */
#ifndef VDNA_IDENTITY_H
#define VDNA_IDENTITY_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_NAME_SIZE 64u            /**< bytes of a name, its NUL included */
#define VDNA_SHA256_SIZE 65u          /**< 64 lower-case hexadecimal digits and a NUL */
#define VDNA_PREPROCESSING_SIZE 512u  /**< bytes of the preprocessing text, its NUL included */
#define VDNA_PRECISION_SIZE 16u       /**< bytes of a precision, its NUL included */
#define VDNA_TAPS_SIZE 2048u          /**< bytes of the list of taps, its NUL included */
#define VDNA_EMBEDDING_SIZE 256u      /**< bytes of the embedding's definition, its NUL included */
#define VDNA_IDENTITY_TEXT_SIZE 2944u /**< bytes of the canonical text, its NUL included */

#define VDNA_PRECISION_DEFAULT "fp32" /**< precision of a network that states none */
#define VDNA_NAME_ALPHABET "letters, digits, '.', '_' or '-'" /**< of names, for error messages */

/** Everything that must agree for two Visual DNAs to be compared. Texts are NUL-terminated. */
typedef struct vdna_identity {
    char backbone[VDNA_NAME_SIZE]; /**< name in the backbone's manifest, passes vdna_name_check();
                                        for people: one network may have several names */
    char model_sha256[VDNA_SHA256_SIZE];         /**< of the ONNX file */
    char preprocessing[VDNA_PREPROCESSING_SIZE]; /**< canonical text from the backbone, 1 to 511
                                                      printable ASCII characters */
    char precision[VDNA_PRECISION_SIZE]; /**< of the network's arithmetic: "fp32", "int8"; alphabet
                                              of a name; "" means VDNA_PRECISION_DEFAULT */
    char taps[VDNA_TAPS_SIZE]; /**< "NAME:NEURONS:SAMPLES[,...]" in the order of the neurons; read
                                    with vdna_taps_next(), written with vdna_taps_append() */
    uint32_t neurons;          /**< of all taps, >= 1 */
    uint32_t dim;              /**< numbers in an embedding, after the projection if there is one;
                                    0 = not known yet */
    uint32_t bins;             /**< VDNA_HIST_BINS_MIN..VDNA_HIST_BINS_MAX; 0 = not known yet */
    const float *range;        /**< [neurons][2], passes vdna_range_check(); NULL = not known yet.
                                    Borrowed; the code that fills the identity says for how long */
    char embedding[VDNA_EMBEDDING_SIZE]; /**< how embeddings are made of the network's outputs:
                                              words of printable ASCII characters, one blank between
                                              two (docs/reference/SPEC-map.md). "" = one whole
                                              output, as in all files before format 3 */
    const float
        *projection;   /**< [dim][raw_dim], finite: directions that a map learned, of which an
                            experience keeps the coordinates of its embeddings; NULL = none,
                            embeddings are kept as the network gives them. Borrowed as range */
    uint32_t raw_dim;  /**< numbers that the network gives, >= dim; 0 = no projection */
    uint32_t reserved; /**< 0 */
} vdna_identity;

/** One entry of a list of taps. */
typedef struct vdna_tap {
    const char *name;   /**< [name_length], not NUL-terminated; may hold a ':' but no ',' */
    size_t name_length; /**< bytes, >= 1 */
    uint32_t neurons;   /**< >= 1 */
    uint32_t samples;   /**< per neuron and frame, >= 1 */
} vdna_tap;

/** Check the fields: alphabets and lengths of the texts, taps that parse and add up to `neurons`,
 *  bins and range if known, the definition of the embedding unless it is "", the projection if
 *  there is one.
 *  @param identity  any bytes
 *  @param error  names the field, what was found and what was expected; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_MISMATCH if the taps do not add up */
VDNA_API vdna_status vdna_identity_check(const vdna_identity *identity, vdna_error *error);

/** Check that Visual DNAs of two identities may be compared: same model, preprocessing, taps,
 *  neurons, and, if known to both, embedding, what the network gives for it (raw_dim, or dim
 *  without a projection), bins, range and projection (by their bits). So a backbone compares with
 *  the maps of its embeddings, projected or not.
 *  @param a, b   texts are NUL-terminated; `range` has `neurons` rows or is NULL, `projection`
 *                [dim][raw_dim] or is NULL
 *  @param error  names the first field that differs and both values: "bins is 4 in one and 8 in the
 *                other", `one` being a. If models differ because their precision does, it names the
 *                precision. Long values are shown from where they differ. The caller adds the place
 *                and the remedy. NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_MISMATCH */
VDNA_API vdna_status vdna_identity_compare(const vdna_identity *a, const vdna_identity *b,
                                           vdna_error *error);

/** Write the canonical text (docs/reference/SPEC-map.md): one line each for its version, model,
 *  preprocessing, taps, dim and bins, embedding unless that is "", and embedding and raw_dim if
 *  there is a projection.
 *  @param identity  passes vdna_identity_check()
 *  @param out_text  NUL-terminated
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_identity_text(const vdna_identity *identity,
                                        char out_text[VDNA_IDENTITY_TEXT_SIZE]);

/** Compute the SHA-256 of the canonical text and the bytes of the range and of the projection, if
 *  any. Complete identities compare if and only if their hashes are equal; experience files carry
 *  it as `comparable`.
 *  @param identity  passes vdna_identity_check()
 *  @param out_sha256  NUL-terminated
 *  @return VDNA_OK; VDNA_ERR_ARG, also if dim, bins or range is not known */
VDNA_API vdna_status vdna_identity_hash(const vdna_identity *identity,
                                        char out_sha256[VDNA_SHA256_SIZE]);

/** Get the precision, or the default if the identity states none.
 *  @param identity  NULL gives the default
 *  @return `precision`, or VDNA_PRECISION_DEFAULT if that is empty; valid as long as `identity` */
VDNA_API const char *vdna_identity_precision(const vdna_identity *identity);

/** Tell whether embeddings are compared about a mean, which a localiser must then subtract: the
 *  definition of the embedding ends in the word "centred".
 *  @param identity  its `embedding` is NUL-terminated; NULL is allowed
 *  @return 1 if so, else 0 */
VDNA_API int vdna_identity_is_centred(const vdna_identity *identity);

/** Make of an embedding what experiences of this identity keep of it, for a live frame that meets
 *  them: its scalar product with each direction of the projection, summed in double precision from
 *  the first number to the last and then rounded to float: within half a unit in the last place,
 *  and raw_dim 2^-53 of the sum of magnitudes, of the exact value, and the same bits on every
 *  machine. Without a projection, a copy. A product beyond the floats is infinite.
 *  @param identity  passes vdna_identity_check(); dim is known
 *  @param embedding  as the network gives it: [raw_dim], or [dim] without a projection
 *  @param out_embedding  [dim], apart from `embedding`
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_identity_project(const vdna_identity *identity, const float *embedding,
                                           float *out_embedding);

/** Read the next tap of a list.
 *  @param text  at first points to a list of taps; after VDNA_OK to the text after the tap;
 *               otherwise unchanged
 *  @param out_tap  its name is borrowed from the list
 *  @return VDNA_OK; VDNA_ERR_EMPTY at the end of the list; VDNA_ERR_FORMAT if the next entry is not
 *          NAME:NEURONS:SAMPLES, or a ',' ends the list; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_taps_next(const char **text, vdna_tap *out_tap);

/** Append a tap to a list.
 *  @param text  "" or a list of taps; unchanged after an error
 *  @param text_size  bytes of `text`, usually VDNA_TAPS_SIZE
 *  @param tap  its name must not point into `text`
 *  @return VDNA_OK; VDNA_ERR_ARG for a name that is empty or has a ',' or anything but printable
 *          ASCII characters, or for a number that is 0; VDNA_ERR_NOMEM if it does not fit */
VDNA_API vdna_status vdna_taps_append(char *text, size_t text_size, const vdna_tap *tap);

/** Check a name (of an experience or a backbone): 1 to 63 of VDNA_NAME_ALPHABET.
 *  @param name   NUL-terminated, or VDNA_NAME_SIZE bytes
 *  @param error  what is wrong and what was expected, worded to follow a subject: "has a character
 *                that is not allowed, expected ..."; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_name_check(const char *name, vdna_error *error);

/** Replace each character not allowed in a name by '_'; the length stays.
 *  @param name  NUL-terminated; NULL is allowed */
VDNA_API void vdna_name_replace(char *name);

#ifdef __cplusplus
}
#endif

#endif
