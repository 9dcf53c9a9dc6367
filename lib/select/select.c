#include <string.h>
#include <vdna/select.h>

/* see vdna/select.h */
void vdna_select_config_init(vdna_select_config *config)
{
    if (!config)
        return;
    memset(config, 0, sizeof *config);
    config->struct_size = sizeof *config;
}

static int is_config(const vdna_select_config *config)
{
    if (!config || config->struct_size != sizeof *config || !config->candidates ||
        config->candidate_count == 0 || config->dim == 0)
        return 0;
    const int by_frames = config->warmup_frames > 0, by_time = config->warmup_us > 0;
    if (by_frames == by_time || config->warmup_us < 0)
        return 0;
    for (uint32_t i = 0; i < config->candidate_count; i++)
        if (!config->candidates[i].embeddings || config->candidates[i].frames == 0)
            return 0;
    return 1;
}

/* The parts of the caller's block, in order; each size keeps the next part aligned. */
typedef struct layout {
    size_t ranking, views, scratch, hist; /* bytes of each */
    size_t total;                         /* 0 if the config is invalid */
    vdna_hist_config live;
} layout;

static size_t aligned(size_t size)
{
    return (size + sizeof(int64_t) - 1) / sizeof(int64_t) * sizeof(int64_t);
}

static layout layout_of(const vdna_select_config *config)
{
    layout l;
    memset(&l, 0, sizeof l);
    if (!is_config(config))
        return l;

    const vdna_hist_view *first = &config->candidates[0].dna;
    vdna_hist_config_init(&l.live);
    l.live.neurons = first->neurons;
    l.live.bins = first->bins;
    l.live.range = first->range;

    l.ranking = aligned(sizeof(vdna_rank_entry) * (size_t)config->candidate_count);
    l.views = aligned(sizeof(vdna_hist_view) * (size_t)config->candidate_count);
    l.scratch = vdna_emd_scratch_size(first->neurons);
    l.hist = vdna_hist_mem_size(&l.live);
    if (l.hist != 0 && l.scratch != 0)
        l.total = l.ranking + l.views + l.scratch + l.hist;
    return l;
}

/* see vdna/select.h */
size_t vdna_select_mem_size(const vdna_select_config *config)
{
    return layout_of(config).total;
}

/* Candidates that compare with the first one compare with the live histogram, which has its
 * shape and range. */
static vdna_status check_candidates(const vdna_select_config *config)
{
    for (uint32_t i = 0; i < config->candidate_count; i++) {
        const vdna_status status =
            vdna_hist_view_check_pair(&config->candidates[0].dna, &config->candidates[i].dna);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}

/* see vdna/select.h */
vdna_status vdna_select_init(const vdna_select_config *config, void *mem, size_t mem_size,
                             vdna_select *out_select)
{
    const layout l = layout_of(config);
    if (l.total == 0 || !mem || !out_select || (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < l.total)
        return VDNA_ERR_NOMEM;
    vdna_status status = check_candidates(config);
    if (status != VDNA_OK)
        return status;

    unsigned char *block = mem;
    vdna_select s;
    memset(&s, 0, sizeof s);
    s.config = *config;
    s.ranking = (vdna_rank_entry *)(void *)block;
    s.views = (vdna_hist_view *)(void *)(block + l.ranking);
    s.scratch = block + l.ranking + l.views;
    s.scratch_size = l.scratch;
    status = vdna_hist_init(&l.live, block + l.ranking + l.views + l.scratch, l.hist, &s.live);
    if (status != VDNA_OK)
        return status;

    for (uint32_t i = 0; i < config->candidate_count; i++)
        s.views[i] = config->candidates[i].dna;
    *out_select = s;
    return VDNA_OK;
}

/* see vdna/select.h */
void vdna_select_reset(vdna_select *select)
{
    if (!select)
        return;
    vdna_hist_reset(&select->live);
    select->state = VDNA_SELECT_WARMUP;
    select->chosen = 0;
    select->margin_bins = 0;
}

/* Camera time between two stamps, which may be any int64: never negative when later >= earlier. */
static uint64_t elapsed_us(int64_t earlier, int64_t later)
{
    return (uint64_t)later - (uint64_t)earlier;
}

/* Does a frame of this stamp lie beyond a window that is measured in time? */
static int ends_window(const vdna_select *select, int64_t utime)
{
    return select->config.warmup_us > 0 && select->live.frames > 0 &&
           elapsed_us(select->first_utime, utime) >= (uint64_t)select->config.warmup_us;
}

/* Rank the experiences against the window and choose the nearest. */
static vdna_status choose(vdna_select *select, vdna_select_answer *answer)
{
    vdna_hist_view live;
    vdna_hist_view_of(&select->live, &live);
    const vdna_status status = vdna_rank(&live, select->views, select->config.candidate_count,
                                         select->scratch, select->scratch_size, select->ranking);
    if (status != VDNA_OK) {
        vdna_select_reset(select);
        return status;
    }
    select->state = VDNA_SELECT_SELECTED;
    select->chosen = select->ranking[0].candidate;
    if (select->config.candidate_count > 1)
        select->margin_bins = select->ranking[1].distance_bins - select->ranking[0].distance_bins;
    answer->newly_ranked = 1;
    return VDNA_OK;
}

static vdna_status localise(const vdna_select *select, const float *embedding,
                            vdna_select_answer *answer)
{
    const vdna_select_candidate *chosen = &select->config.candidates[select->chosen];
    const vdna_status status = vdna_knn(embedding, select->config.dim, chosen->embeddings,
                                        chosen->frames, 1, &answer->match);
    if (status == VDNA_OK)
        answer->localised = 1;
    return status;
}

/* Add a frame to the window; the N-th one completes a window that is measured in frames. */
static vdna_status warm_up(vdna_select *select, const vdna_select_frame *frame,
                           vdna_select_answer *answer)
{
    if (select->live.frames > 0 && frame->utime < select->last_utime) {
        vdna_select_reset(select);
        select->restarts++;
        answer->restarted = 1;
    }
    const vdna_status status = vdna_hist_add(&select->live, frame->taps, frame->tap_count);
    if (status != VDNA_OK) {
        vdna_select_reset(select);
        return status;
    }
    if (select->live.frames == 1)
        select->first_utime = frame->utime;
    select->last_utime = frame->utime;
    return select->live.frames == select->config.warmup_frames ? choose(select, answer) : VDNA_OK;
}

/* Everything that can be wrong with a frame, before any of it is used. */
static vdna_status check_frame(const vdna_select *select, const vdna_select_frame *frame)
{
    if (!frame || !frame->embedding)
        return VDNA_ERR_ARG;
    const vdna_status status =
        vdna_activations_check(frame->taps, frame->tap_count, select->live.neurons);
    if (status != VDNA_OK)
        return status;
    /* To be finite is asked of the embedding just as of a tap with one sample. */
    const vdna_activations embedding = {frame->embedding, select->config.dim, 1, 0};
    return vdna_activations_check(&embedding, 1, select->config.dim);
}

static vdna_status take(vdna_select *select, const vdna_select_frame *frame,
                        vdna_select_answer *answer)
{
    vdna_status status = check_frame(select, frame);
    if (status != VDNA_OK)
        return status;

    if (select->state == VDNA_SELECT_WARMUP && ends_window(select, frame->utime) &&
        frame->utime >= select->last_utime)
        status = choose(select, answer);
    else if (select->state == VDNA_SELECT_WARMUP)
        return warm_up(select, frame, answer);

    return status == VDNA_OK ? localise(select, frame->embedding, answer) : status;
}

/* see vdna/select.h */
vdna_status vdna_select_feed(vdna_select *select, const vdna_select_frame *frame,
                             vdna_select_answer *out_answer)
{
    if (!select || !out_answer)
        return VDNA_ERR_ARG;
    vdna_select_answer answer;
    memset(&answer, 0, sizeof answer);
    const vdna_status status = take(select, frame, &answer);
    if (status != VDNA_OK) {
        select->rejected++;
        return status;
    }
    select->accepted++;
    answer.state = select->state;
    *out_answer = answer;
    return VDNA_OK;
}

/* see vdna/select.h */
double vdna_select_progress(const vdna_select *select)
{
    if (!select || select->state == VDNA_SELECT_SELECTED)
        return select ? 1 : 0;
    if (select->live.frames == 0)
        return 0;
    if (select->config.warmup_frames > 0)
        return (double)select->live.frames / select->config.warmup_frames;
    return (double)elapsed_us(select->first_utime, select->last_utime) /
           (double)select->config.warmup_us;
}
