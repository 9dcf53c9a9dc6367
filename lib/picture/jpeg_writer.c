#include "jpeg_writer.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

typedef struct jpeg_writer {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    jmp_buf failed;
    unsigned char *data; /* libjpeg's, from malloc() */
    unsigned long size;
} jpeg_writer;

/* libjpeg cannot return from an error, so its handler leaves by longjmp. */
static void leave(j_common_ptr jpeg)
{
    jpeg_writer *writer = jpeg->client_data;
    longjmp(writer->failed, 1);
}

static J_COLOR_SPACE colours_of(const vdna_pixels *pixels)
{
    const int red_first = pixels->rgb[0] == 0;
    if (pixels->channels == 1)
        return JCS_GRAYSCALE;
    if (pixels->channels == 3)
        return red_first ? JCS_EXT_RGB : JCS_EXT_BGR;
    return red_first ? JCS_EXT_RGBX : JCS_EXT_BGRX;
}

static void write_picture(jpeg_writer *writer, const vdna_pixels *pixels, int quality, int small)
{
    struct jpeg_compress_struct *jpeg = &writer->jpeg;
    jpeg_create_compress(jpeg);
    jpeg_mem_dest(jpeg, &writer->data, &writer->size);
    jpeg->image_width = pixels->width;
    jpeg->image_height = pixels->height;
    jpeg->input_components = (int)pixels->channels;
    jpeg->in_color_space = colours_of(pixels);
    jpeg_set_defaults(jpeg);
    jpeg_set_quality(jpeg, quality, TRUE);
    jpeg->optimize_coding = small ? TRUE : FALSE;
    jpeg_start_compress(jpeg, TRUE);
    while (jpeg->next_scanline < jpeg->image_height) {
        /* libjpeg only reads it. */
        JSAMPROW row = (JSAMPROW)(uintptr_t)(pixels->data + jpeg->next_scanline * pixels->stride);
        jpeg_write_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_compress(jpeg);
}

/* see jpeg_writer.h */
int vdna_jpeg_write(const vdna_pixels *pixels, int quality, int small, uint8_t **out_data,
                    size_t *out_size)
{
    jpeg_writer writer = {.data = NULL};
    writer.jpeg.err = jpeg_std_error(&writer.errors);
    writer.jpeg.client_data = &writer;
    writer.errors.error_exit = leave;

    if (setjmp(writer.failed)) {
        jpeg_destroy_compress(&writer.jpeg);
        free(writer.data);
        return 0;
    }
    write_picture(&writer, pixels, quality, small);
    jpeg_destroy_compress(&writer.jpeg);
    *out_data = writer.data;
    *out_size = writer.size;
    return 1;
}
