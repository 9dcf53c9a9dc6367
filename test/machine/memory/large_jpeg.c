// large_jpeg WIDTH HEIGHT FILE: a progressive JPEG in colour, without subsampling: the kind that
// takes the most memory to decode, in few bytes.
#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

static void set_up(struct jpeg_compress_struct *jpeg, unsigned width, unsigned height, FILE *file)
{
    jpeg_create_compress(jpeg);
    jpeg_stdio_dest(jpeg, file);
    jpeg->image_width = width;
    jpeg->image_height = height;
    jpeg->input_components = 3;
    jpeg->in_color_space = JCS_RGB;
    jpeg_set_defaults(jpeg);
    jpeg->comp_info[0].h_samp_factor = jpeg->comp_info[0].v_samp_factor = 1;
    jpeg_simple_progression(jpeg);
    jpeg_start_compress(jpeg, TRUE);
}

int main(int argc, char **argv)
{
    FILE *file = argc == 4 ? fopen(argv[3], "wb") : NULL;
    if (!file)
        return fprintf(stderr, "usage: large_jpeg WIDTH HEIGHT FILE\n"), 2;
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    set_up(&jpeg, (unsigned)atoi(argv[1]), (unsigned)atoi(argv[2]), file);

    unsigned char *row = malloc(3 * (size_t)jpeg.image_width);
    if (!row)
        return 1;
    while (jpeg.next_scanline < jpeg.image_height) {
        for (unsigned x = 0; x < 3 * jpeg.image_width; x++)
            row[x] = (unsigned char)(x / 64 + jpeg.next_scanline / 32);
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    free(row);
    return fclose(file) == 0 ? 0 : 1;
}
