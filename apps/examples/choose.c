/* choose LIVE.vdna CANDIDATE.vdna...: which recorded experience looks most like the live one? */
#include <stdio.h>
#include <stdlib.h>

#include <vdna/map.h>
#include <vdna/vdna.h>

enum { MOST = 16 };

int main(int argc, char **argv)
{
    vdna_experience experience[MOST];
    vdna_hist_view dna[MOST];
    vdna_rank_entry ranking[MOST];
    vdna_error error;
    const int count = argc - 1;
    if (count < 2 || count > MOST)
        return 2;
    for (int i = 0; i < count; i++) {
        if (vdna_experience_open(argv[1 + i], &error, &experience[i]) != VDNA_OK)
            return fprintf(stderr, "%s\n", error.text), 1;
        vdna_experience_view(&experience[i], &dna[i]);
    }
    const size_t size = vdna_emd_scratch_size(dna[0].neurons);
    const vdna_status status =
        vdna_rank(&dna[0], &dna[1], (uint32_t)count - 1, malloc(size), size, ranking);
    if (status != VDNA_OK)
        return fprintf(stderr, "%s\n", vdna_status_text(status)), 1;
    printf("%s (%.2f bins away)\n", experience[1 + ranking[0].candidate].name,
           ranking[0].distance_bins);
    return 0;
}
