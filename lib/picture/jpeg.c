#include "jpeg.h"

#include <jerror.h>
#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h>

/* Cameras pad their frames before the end marker, by a few bytes. */
#define PADDING_MAX 16
/* Progressive pictures have about ten; a crafted one can ask for hours of work in a few kB. */
#define SCANS_MAX 100

typedef struct jpeg_reader {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    jmp_buf refused;
    char *reason;
    const uint8_t *data;
    size_t size;
    uint32_t divisor;
    const vdna_turn *turn;
    uint8_t *row;
    uint8_t *out_bgr;
} jpeg_reader;

/* libjpeg cannot return from an error, so its handlers leave by longjmp. */
static void refuse(j_common_ptr jpeg)
{
    jpeg_reader *reader = jpeg->client_data;
    char text[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, text);
    snprintf(reader->reason, VDNA_JPEG_REASON_MAX, "%.*s", VDNA_JPEG_REASON_MAX - 1, text);
    longjmp(reader->refused, 1);
}

/* Level -1 is a warning: libjpeg would go on, with grey in place of missing data. */
static void refuse_warnings(j_common_ptr jpeg, int level)
{
    const struct jpeg_error_mgr *errors = jpeg->err;
    const int padding =
        errors->msg_code == JWRN_EXTRANEOUS_DATA && errors->msg_parm.i[0] <= PADDING_MAX;
    if (level < 0 && !padding)
        refuse(jpeg);
}

static void limit_scans(j_common_ptr jpeg)
{
    jpeg_reader *reader = jpeg->client_data;
    if (reader->jpeg.input_scan_number <= SCANS_MAX)
        return;
    snprintf(reader->reason, VDNA_JPEG_REASON_MAX, "more than %d scans", SCANS_MAX);
    longjmp(reader->refused, 1);
}

static void read_header(jpeg_reader *reader)
{
    jpeg_create_decompress(&reader->jpeg);
    reader->jpeg.progress = &reader->progress;
    jpeg_mem_src(&reader->jpeg, reader->data, reader->size);
    jpeg_read_header(&reader->jpeg, TRUE);
}

static void read_picture(jpeg_reader *reader)
{
    struct jpeg_decompress_struct *jpeg = &reader->jpeg;
    const vdna_turn *turn = reader->turn;
    read_header(reader);
    jpeg->out_color_space = JCS_EXT_BGR;
    jpeg->scale_num = 1;
    jpeg->scale_denom = reader->divisor;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height) {
        const size_t y = jpeg->output_scanline;
        const int in_place = vdna_turn_keeps_rows(turn);
        JSAMPROW row = in_place ? vdna_turn_begin(turn, reader->out_bgr, y) : reader->row;
        jpeg_read_scanlines(jpeg, &row, 1);
        if (!in_place)
            vdna_turn_row(turn, row, jpeg->output_width, y, reader->out_bgr);
    }
    /* Reads on to the end marker, which a picture that was cut short lacks. */
    jpeg_finish_decompress(jpeg);
}

/* Run `step`, and free libjpeg's memory whether it returned or left by longjmp. */
static int attempt(jpeg_reader *reader, void (*step)(jpeg_reader *))
{
    reader->jpeg.err = jpeg_std_error(&reader->errors);
    reader->jpeg.client_data = reader;
    reader->errors.error_exit = refuse;
    reader->errors.emit_message = refuse_warnings;
    reader->progress.progress_monitor = limit_scans;

    if (setjmp(reader->refused)) {
        jpeg_destroy_decompress(&reader->jpeg);
        return 0;
    }
    step(reader);
    jpeg_destroy_decompress(&reader->jpeg);
    return 1;
}

/* see jpeg.h */
int vdna_jpeg_begins(const uint8_t *data, size_t size)
{
    return size >= 3 && data[0] == 0xFF && data[1] == 0xD8 && data[2] == 0xFF;
}

/* see jpeg.h */
int vdna_jpeg_shape_of(const uint8_t *data, size_t size, vdna_jpeg_shape *out_shape, char *reason)
{
    jpeg_reader reader = {.reason = reason, .data = data, .size = size};
    if (!attempt(&reader, read_header))
        return 0;
    out_shape->width = reader.jpeg.image_width;
    out_shape->height = reader.jpeg.image_height;
    out_shape->channels = (uint32_t)reader.jpeg.num_components;
    return 1;
}

/* see jpeg.h */
int vdna_jpeg_decode(const uint8_t *data, size_t size, uint32_t divisor, const vdna_turn *turn,
                     uint8_t *row, uint8_t *out_bgr, char *reason)
{
    jpeg_reader reader = {.reason = reason,
                          .data = data,
                          .size = size,
                          .divisor = divisor,
                          .turn = turn,
                          .row = row,
                          .out_bgr = out_bgr};
    return attempt(&reader, read_picture);
}
