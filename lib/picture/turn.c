#include "turn.h"

/* see turn.h */
vdna_turn vdna_turn_of(uint32_t orientation, uint32_t width, uint32_t height)
{
    /* Orientations from 5 on make columns of rows; then the stored x runs along the upright y. */
    const int swapped = orientation >= 5;
    const int x_mirrored =
        orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const int y_mirrored =
        orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;

    vdna_turn turn = {swapped ? height : width, swapped ? width : height, 0, 0, 0};
    const ptrdiff_t pixel = VDNA_TURN_CHANNELS, line = pixel * (ptrdiff_t)turn.width;
    turn.pixel_step = (swapped ? line : pixel) * (x_mirrored ? -1 : 1);
    turn.row_step = (swapped ? pixel : line) * (y_mirrored ? -1 : 1);
    if (x_mirrored)
        turn.first += (size_t)-turn.pixel_step * (width - 1);
    if (y_mirrored)
        turn.first += (size_t)-turn.row_step * (height - 1);
    return turn;
}

/* see turn.h */
int vdna_turn_keeps_rows(const vdna_turn *turn)
{
    return turn->pixel_step == VDNA_TURN_CHANNELS;
}

/* see turn.h */
uint8_t *vdna_turn_begin(const vdna_turn *turn, uint8_t *out, size_t y)
{
    return out + turn->first + (ptrdiff_t)y * turn->row_step;
}

/* see turn.h */
void vdna_turn_row(const vdna_turn *turn, const uint8_t *row, size_t width, size_t y, uint8_t *out)
{
    out = vdna_turn_begin(turn, out, y);
    for (size_t x = 0; x < width; x++)
        for (size_t channel = 0; channel < VDNA_TURN_CHANNELS; channel++)
            out[(ptrdiff_t)x * turn->pixel_step + (ptrdiff_t)channel] =
                row[x * VDNA_TURN_CHANNELS + channel];
}
