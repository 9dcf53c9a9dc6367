#include <math.h>

#include <vdna/rank.h>

/* The order of a ranking: by distance, then by place in the map, so no two entries are equal. */
static int comes_before(const vdna_rank_entry *a, const vdna_rank_entry *b)
{
    if (a->distance_bins != b->distance_bins)
        return a->distance_bins < b->distance_bins;
    return a->candidate < b->candidate;
}

static void swap(vdna_rank_entry *a, vdna_rank_entry *b)
{
    const vdna_rank_entry kept = *a;
    *a = *b;
    *b = kept;
}

/* Let the entry at `root` sink until no child comes after it. */
static void sink(vdna_rank_entry *heap, size_t root, size_t count)
{
    for (size_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
        if (child + 1 < count && comes_before(&heap[child], &heap[child + 1]))
            child++;
        if (!comes_before(&heap[root], &heap[child]))
            return;
        swap(&heap[root], &heap[child]);
        root = child;
    }
}

/* Heapsort: in place, without recursion, never quadratic. */
static void sort(vdna_rank_entry *entries, size_t count)
{
    for (size_t root = count / 2; root-- > 0;)
        sink(entries, root, count);
    for (size_t end = count; end-- > 1;) {
        swap(&entries[0], &entries[end]);
        sink(entries, 0, end);
    }
}

static void sort_and_mark_ties(vdna_rank_entry *ranking, uint32_t count)
{
    sort(ranking, count);
    for (size_t i = 1; i < count; i++)
        if (ranking[i].distance_bins == ranking[i - 1].distance_bins)
            ranking[i].tied = ranking[i - 1].tied = 1;
}

static vdna_rank_entry entry_of(uint32_t candidate, double distance_bins)
{
    const vdna_rank_entry entry = {distance_bins, candidate, 0};
    return entry;
}

/* see vdna/rank.h */
vdna_status vdna_rank_sort(const double *distance_bins, uint32_t count,
                           vdna_rank_entry *out_ranking)
{
    if (!distance_bins || count == 0 || !out_ranking)
        return VDNA_ERR_ARG;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(distance_bins[i]))
            return VDNA_ERR_NONFINITE;

    for (uint32_t i = 0; i < count; i++)
        out_ranking[i] = entry_of(i, distance_bins[i]);
    sort_and_mark_ties(out_ranking, count);
    return VDNA_OK;
}

/* see vdna/rank.h */
vdna_status vdna_rank(const vdna_hist_view *live, const vdna_hist_view *candidates, uint32_t count,
                      void *scratch, size_t scratch_size, vdna_rank_entry *out_ranking)
{
    if (!candidates || count == 0 || !out_ranking)
        return VDNA_ERR_ARG;
    for (uint32_t i = 0; i < count; i++) {
        double distance_bins;
        const vdna_status status =
            vdna_emd_mean(live, &candidates[i], scratch, scratch_size, &distance_bins);
        if (status != VDNA_OK)
            return status;
        out_ranking[i] = entry_of(i, distance_bins);
    }
    sort_and_mark_ties(out_ranking, count);
    return VDNA_OK;
}
