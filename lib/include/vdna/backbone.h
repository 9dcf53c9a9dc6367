/** @file vdna/backbone.h
 *  @brief A frozen network: picture in; activations, embedding and mean grey level out.
 *
 *  A backbone is a table of operations and a state. Ours runs an ONNX file: a manifest
 *  (models/NAME.toml) says which, how its input is prepared and which outputs are tapped; nothing
 *  here knows a network by name. ONNX Runtime is loaded with dlopen when such a backbone is opened.
 *  A plug-in, a shared library that vdna_backbone_open() loads, brings a table of its own and with
 *  it any other network; vdna_backbone_open_with() takes a table directly.
 *
 *  The border is message-like on purpose: no state is shared with the caller between two calls.
 *  Whatever the table, the functions below check what it gives before the caller sees it.
 */
#ifndef VDNA_BACKBONE_H
#define VDNA_BACKBONE_H

#include <vdna/activation.h>
#include <vdna/health.h>
#include <vdna/identity.h>
#include <vdna/image.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_BACKBONE_DEFAULT \
    "efficientnet_lite0"                 /**< network of programs that are told no other */
#define VDNA_BACKBONE_THREADS_DEFAULT 2u /**< compute threads of a network */
#define VDNA_BACKBONE_THREADS_MAX 256u   /**< most compute threads of a network */
#define VDNA_BACKBONE_OPERATIONS 3u      /**< version of the table of operations */

/** An open network. One thread at a time, except for vdna_backbone_cancel(). */
typedef struct vdna_backbone vdna_backbone;

/** How to open one. Fill with vdna_backbone_config_init(), then set `manifest`. */
typedef struct vdna_backbone_config {
    uint32_t struct_size; /**< bytes of this struct, set by vdna_backbone_config_init() */
    uint32_t threads;     /**< compute threads of the network, 1..VDNA_BACKBONE_THREADS_MAX;
                               default VDNA_BACKBONE_THREADS_DEFAULT */
    uint32_t max_pixels;  /**< largest width x height that is decoded, 1..VDNA_IMAGE_PIXELS_MAX,
                               which is the default: bounds the memory for decoding */
    uint32_t reserved;    /**< 0 */
    const char *manifest; /**< path of a TOML manifest (with a '/' or ending in ".toml"; paths
                               within it are relative to it), or the bare name of one in
                               $VDNA_MODELS, the running program's installation (share/vdna/models
                               beside its bin) or /usr/share/vdna/models. A path with a '/' that
                               ends in ".so" is a plug-in. */
    const char *runtime;  /**< path of libonnxruntime.so; NULL = $VDNA_ONNXRUNTIME, then that of
                               the running program's installation (lib/vdna beside its bin), then
                               the system's (default) */
} vdna_backbone_config;

/** What an open network is. */
typedef struct vdna_backbone_info {
    vdna_identity identity; /**< what experiences made with it carry; bins and range are not known.
                                 Of a manifest, the SHA-256 was checked when it was opened */
    char quantised_from[VDNA_SHA256_SIZE]; /**< SHA-256 of the ONNX file that this one was made
                                                from; "" = none */
    char runtime[64];                      /**< "onnxruntime 1.28.0"; a plug-in names itself */
    uint32_t tap_count;                    /**< >= 1 */
    uint32_t input_width;                  /**< pixels; 0 = the backbone does not show its input */
    uint32_t input_height;                 /**< pixels; as input_width */
    uint64_t decode_bytes;   /**< most memory that decoding a camera's picture of max_pixels takes
                                  after opening: MJPG, also progressive, or any raw format */
    uint32_t last_layer_dim; /**< numbers in the second embedding, of the last layer; 0 = none */
    uint32_t embedding_int8; /**< 1 = experience files have embeddings as codes of vdna/int8.h, with
                                a scale for each frame; 0 = as floats. A frame has floats always */
    uint32_t embedding_dims; /**< numbers that experience files keep of an embedding, by a
                                  projection that each new map learns, 1..dim; 0 = all of them.
                                  A frame has all of them always */
    uint32_t reserved;       /**< 0 */
} vdna_backbone_info;

/** What one picture gave. All pointers are borrowed until the next call with this backbone. */
typedef struct vdna_backbone_frame {
    const vdna_activations *taps; /**< [tap_count] */
    const float *embedding;       /**< [dim], made as `embedding` in the identity says, not about
                                       any mean; L2-normalised if the manifest says so */
    const float *input;           /**< [3][input_height][input_width], what the network was given;
                                       NULL if input_width is 0 */
    size_t tap_count;             /**< as in vdna_backbone_info */
    uint32_t dim;                 /**< as in the identity */
    float grey;                   /**< mean grey level of the whole picture, 0..255 (BT.601) */
    uint32_t decode_us;           /**< time spent decoding and converting */
    uint32_t resize_us;           /**< time spent resizing and normalising */
    uint32_t inference_us;        /**< time spent in the network */
    uint32_t last_layer_dim;      /**< as in vdna_backbone_info */
    const float *last_layer;      /**< [last_layer_dim], the second embedding, which tells whether
                                       a run is like any of a map's; NULL if last_layer_dim is 0 */
    vdna_health_picture health;   /**< measured of the decoded picture; of width 0 if the backbone
                                       does not measure */
} vdna_backbone_frame;

/** How one kind of backbone works. None of the pointers is NULL. A state belongs to the table that
 *  opened it and may be NULL. Operations on one state are called by one thread at a time, except
 *  for `cancel`. No exception may leave one. */
typedef struct vdna_backbone_operations {
    uint32_t struct_size; /**< sizeof(vdna_backbone_operations) */
    uint32_t version; /**< VDNA_BACKBONE_OPERATIONS, which changes whenever the table or a struct
                           that it fills does: another one is refused, because it would write
                           to other places than the library reads */

    /** Open a network. `config` is needed for this call only; its `struct_size` says how much of it
     *  there is, its fields are within their limits, and `manifest` is the plug-in's own path.
     *  Returns VDNA_OK or what is wrong, in `error` (never NULL) as one sentence. */
    vdna_status (*open)(const vdna_backbone_config *config, vdna_error *error, void **out_state);

    /** Close. Never called during another operation. */
    void (*close)(void *state);

    /** Describe it: `out_info` is zeroed before. The identity must pass vdna_identity_check()
     *  without bins and range, and have as many taps as `tap_count` says. Its `embedding` is
     *  "" if that says all: one output as it is, no mean to be subtracted. `model_sha256` is 64
     *  lower-case hexadecimal digits that no other network has: maps are refused by it. */
    void (*describe)(const void *state, vdna_backbone_info *out_info);

    /** Run one picture, as a camera sent it: vdna_decoder_decode() makes pixels of it. `out_frame`
     *  is zeroed before; taps, embeddings and their sizes must be as described, what they point to
     *  stays until the next operation. Finite values are checked by the library. Returns VDNA_OK or
     *  what is wrong, in `error` (never NULL) as one sentence: VDNA_ERR_FORMAT and
     *  VDNA_ERR_UNSUPPORTED blame the picture, all others the network. */
    vdna_status (*run)(void *state, const vdna_image *image, vdna_error *error,
                       vdna_backbone_frame *out_frame);

    /** End a `run` in progress early if that is possible, from another thread. No run follows. */
    void (*cancel)(void *state);
} vdna_backbone_operations;

/** Give the table of a plug-in. Not a function of this library: a plug-in defines and exports it.
 *  @return a table that stays as long as the process; checked before it is used */
extern VDNA_API const vdna_backbone_operations *vdna_backbone_plugin(void);

/** Write the defaults: two threads, runtime found by itself; the caller must set `manifest`.
 *  @param config  NULL is allowed */
VDNA_API void vdna_backbone_config_init(vdna_backbone_config *config);

/** Open a network: read the manifest, check the model's SHA-256, load the runtime, bind inputs and
 *  outputs, run twice on a grey picture so that later calls are warm, and compare what a test
 *  picture gives with the manifest's golden numbers, if it has any. Or load the plug-in, which
 *  then stays loaded, and have it open its network.
 *
 *  A plug-in is code and does what the process may do: load only what you trust.
 *
 *  For a manifest, it sets ORT_DISABLE_TELEMETRY=1 in the environment, which is the whole
 * process's: some builds of ONNX Runtime write files and start a thread as soon as they are loaded,
 * and nothing else stops them. Open before other threads read the environment, or set it yourself.
 *  @param config  needed for this call only
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_backbone  the caller's, to be closed with vdna_backbone_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO; VDNA_ERR_FORMAT (manifest, or what a plug-in says of
 *          itself); VDNA_ERR_CHECKSUM (model); VDNA_ERR_MISMATCH (a tap or shape the model does not
 *          have, other numbers than its golden ones); VDNA_ERR_UNSUPPORTED (runtime too old, an
 *          int8 network on an x86 processor without VNNI or an ARM one without asimddp, or a
 *          library that is no plug-in of this version); VDNA_ERR_RUNTIME; VDNA_ERR_NOMEM; any
 *          other that a plug-in gives */
VDNA_API vdna_status vdna_backbone_open(const vdna_backbone_config *config, vdna_error *error,
                                        vdna_backbone **out_backbone);

/** Open a network by a table of your own, checked as that of a plug-in is.
 *  @param operations  copied
 *  @param config  handed to `open`; `manifest` may be NULL
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_backbone  the caller's, to be closed with vdna_backbone_close()
 *  @return as vdna_backbone_open() for a plug-in */
VDNA_API vdna_status vdna_backbone_open_with(const vdna_backbone_operations *operations,
                                             const vdna_backbone_config *config, vdna_error *error,
                                             vdna_backbone **out_backbone);

/** Close; everything borrowed from it ends.
 *  @param backbone  NULL is allowed */
VDNA_API void vdna_backbone_close(vdna_backbone *backbone);

/** Describe an open network.
 *  @param backbone  an open one
 *  @param out_info  copies: they outlive the network */
VDNA_API void vdna_backbone_describe(const vdna_backbone *backbone, vdna_backbone_info *out_info);

/** Run one picture.
 *  @param backbone  an open one
 *  @param image  any content; checked in full before a byte of it is used; decoded as
 *                vdna_decoder_decode() does, or as vdna_decoder_decode_reduced() does for the size
 *                of the network's input if the manifest says `decode = "reduced"`
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_frame  borrowed until the next call with this backbone
 *  @return VDNA_OK; VDNA_ERR_FORMAT if the picture cannot be decoded; VDNA_ERR_UNSUPPORTED for an
 *          unknown pixel format, an encoded picture that is no JPEG, or a picture too large;
 *          VDNA_ERR_NONFINITE if the network gave a NaN or an infinity; VDNA_ERR_MISMATCH if a
 *          plug-in gave something else than it says of itself; VDNA_ERR_RUNTIME, also after
 *          vdna_backbone_cancel(); any other that a plug-in gives */
VDNA_API vdna_status vdna_backbone_run(vdna_backbone *backbone, const vdna_image *image,
                                       vdna_error *error, vdna_backbone_frame *out_frame);

/** End a vdna_backbone_run() in progress early, and refuse all later ones. Any thread.
 *  @param backbone  an open one; NULL is allowed */
VDNA_API void vdna_backbone_cancel(vdna_backbone *backbone);

#ifdef __cplusplus
}
#endif

#endif
