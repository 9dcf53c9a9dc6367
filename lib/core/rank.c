#include <math.h>
#include <string.h>

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

/* Whether two neighbours have the very same distance; of a bound that is not known.
 * @param is_bound  by candidate; NULL = none is */
static int are_tied(const vdna_rank_entry *a, const vdna_rank_entry *b, const uint8_t *is_bound)
{
    if (is_bound && (is_bound[a->candidate] || is_bound[b->candidate]))
        return 0;
    return a->distance_bins == b->distance_bins;
}

static void sort_and_mark_ties(vdna_rank_entry *ranking, uint32_t count, const uint8_t *is_bound)
{
    sort(ranking, count);
    for (size_t i = 1; i < count; i++)
        if (are_tied(&ranking[i - 1], &ranking[i], is_bound))
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
    sort_and_mark_ties(out_ranking, count, NULL);
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
    sort_and_mark_ties(out_ranking, count, NULL);
    return VDNA_OK;
}

/* see vdna/rank.h */
size_t vdna_rank_top_scratch_size(uint32_t neurons, uint32_t bins)
{
    const size_t sums = vdna_bounds_size(neurons, bins);
    return sums == 0 ? 0 : vdna_emd_scratch_size(neurons) + sums;
}

/* Order the candidates by the bounds of their distances. */
static vdna_status rank_by_bounds(const vdna_hist_view *live, const vdna_hist_view *candidates,
                                  const uint32_t *sums, uint32_t count, void *scratch,
                                  vdna_rank_entry *ranking)
{
    const size_t size = vdna_emd_scratch_size(live->neurons);
    const size_t numbers = vdna_bounds_size(live->neurons, live->bins) / sizeof *sums;
    uint32_t *const live_sums = (uint32_t *)(void *)((unsigned char *)scratch + size);
    vdna_status status = vdna_bounds_sum(live, scratch, size, live_sums);
    for (uint32_t i = 0; status == VDNA_OK && i < count; i++) {
        double bound_bins = 0;
        status = vdna_bounds_mean(live, live_sums, &candidates[i], sums + i * numbers, scratch,
                                  size, &bound_bins);
        ranking[i] = entry_of(i, bound_bins);
    }
    if (status == VDNA_OK)
        sort(ranking, count);
    return status;
}

/* Of the entries before `at`, the nearest `most` are a heap in front, the farthest of them on top;
 * take in the entry at `at`. */
static void keep_nearest(vdna_rank_entry *ranking, size_t at, size_t most)
{
    if (at >= most) {
        if (comes_before(&ranking[at], &ranking[0])) {
            swap(&ranking[at], &ranking[0]);
            sink(ranking, 0, most);
        }
        return;
    }
    for (; at > 0 && comes_before(&ranking[(at - 1) / 2], &ranking[at]); at = (at - 1) / 2)
        swap(&ranking[at], &ranking[(at - 1) / 2]);
}

/* Replace bounds by distances, from the least on, until the next bound passes the exact-th of the
 * distances: it and those behind are farther away. What has a bound has a distance. */
static void make_exact(const vdna_hist_view *live, const vdna_hist_view *candidates, uint32_t count,
                       uint32_t exact, void *scratch, vdna_rank_entry *ranking, uint8_t *is_bound)
{
    memset(is_bound, 1, count);
    for (uint32_t i = 0; i < count; i++) {
        vdna_rank_entry *const entry = &ranking[i];
        if (i >= exact && entry->distance_bins > ranking[0].distance_bins)
            return;
        vdna_emd_mean(live, &candidates[entry->candidate], scratch,
                      vdna_emd_scratch_size(live->neurons), &entry->distance_bins);
        is_bound[entry->candidate] = 0;
        keep_nearest(ranking, i, exact);
    }
}

/* see vdna/rank.h */
vdna_status vdna_rank_top(const vdna_hist_view *live, const vdna_hist_view *candidates,
                          const uint32_t *sums, uint32_t count, uint32_t exact, void *scratch,
                          size_t scratch_size, vdna_rank_entry *out_ranking, uint8_t *out_is_bound)
{
    if (!candidates || !sums || count == 0 || exact == 0 || !scratch || !out_ranking ||
        !out_is_bound)
        return VDNA_ERR_ARG;
    vdna_status status = vdna_hist_view_check_pair(live, live);
    if (status != VDNA_OK)
        return status;
    if (scratch_size < vdna_rank_top_scratch_size(live->neurons, live->bins))
        return VDNA_ERR_NOMEM;
    status = rank_by_bounds(live, candidates, sums, count, scratch, out_ranking);
    if (status != VDNA_OK)
        return status;
    make_exact(live, candidates, count, exact, scratch, out_ranking, out_is_bound);
    sort_and_mark_ties(out_ranking, count, out_is_bound);
    return VDNA_OK;
}
