#include <string.h>

#include "elapsed.h"
#include "growth.h"
#include "select_state.h"

/* Bytes of vdna_select_config in version 0.1. */
#define OLDEST_SELECT_CONFIG offsetof(vdna_select_config, late_us)

/* Shortest gap in a warmup by frames that begins it anew: short pauses say nothing there. */
#define GAP_US_MIN 10000000u

static const vdna_select_config select_defaults = {
    .late_us = VDNA_TIME_LATE_US_DEFAULT,
    .warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT,
    .top = 1,
};

/* see vdna/select.h; in parentheses, because the header has a macro of this name */
void(vdna_select_config_init)(vdna_select_config *config)
{
    vdna_config_write(config, OLDEST_SELECT_CONFIG, &select_defaults, sizeof select_defaults);
}

/* see vdna/select.h */
void vdna_select_config_init_sized(vdna_select_config *config, size_t struct_size)
{
    vdna_config_write(config, struct_size, &select_defaults, sizeof select_defaults);
}

/* Whether frames can be localised in a candidate. */
static int is_candidate(const vdna_select_config *config, uint32_t i)
{
    const vdna_select_candidate *candidate = &config->candidates[i];
    if (!config->localisers)
        return candidate->embeddings && candidate->frames > 0;
    const vdna_localise *by = config->localisers[i];
    return candidate->frames > 0 && vdna_localise_frames(by) == candidate->frames &&
           vdna_localise_dim(by) == config->dim;
}

static int is_config(const vdna_select_config *config)
{
    if (!config->candidates || config->candidate_count == 0 || config->dim == 0)
        return 0;
    const int by_frames = config->warmup_frames > 0, by_time = config->warmup_us > 0;
    if (by_frames == by_time || config->warmup_us < 0 || config->late_us < 0 ||
        config->time_unit > VDNA_TIME_UNIT_S)
        return 0;
    if (config->top == 0 || (config->top > 1 && !config->localisers))
        return 0;
    for (uint32_t i = 0; i < config->candidate_count; i++)
        if (!is_candidate(config, i))
            return 0;
    return vdna_select_may_trust(config);
}

/* The window: the first frames, in the candidates' shape. Their taps are not known yet and may
 * change; only the sum of the neurons counts. */
static vdna_window_config window_config_of(const vdna_select_config *config,
                                           vdna_activations *out_shape)
{
    const vdna_hist_view *first = &config->candidates[0].dna;
    const vdna_activations shape = {NULL, first->neurons, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    *out_shape = shape;
    vdna_window_config window;
    vdna_window_config_init(&window);
    window.which = VDNA_WINDOW_FIRST;
    window.capacity = config->warmup_frames > 0 ? config->warmup_frames : UINT32_MAX;
    window.length_us = config->warmup_us;
    window.least_frames = config->warmup_us > 0 ? config->warmup_frames_min : 0;
    window.taps = out_shape;
    window.tap_count = 1;
    window.range = first->range;
    window.bins = first->bins;
    return window;
}

/* The parts of the caller's block, in order; each size keeps the next part aligned. */
typedef struct layout {
    size_t select, ranking, views, scratch, leads, answers, predictions; /* bytes of each */
    size_t of_candidates, likeness, codes, excluded, is_bound, sums, window;
    size_t total;              /* 0 if the config is invalid */
    vdna_select_config config; /* complete */
} layout;

static size_t aligned(size_t size)
{
    return (size + sizeof(int64_t) - 1) / sizeof(int64_t) * sizeof(int64_t);
}

/* Whether a ranking may have bounds. */
static int has_bounds(const vdna_select_config *config)
{
    return config->exact > 0 && config->exact < config->candidate_count;
}

static layout layout_of(const vdna_select_config *given)
{
    layout l;
    memset(&l, 0, sizeof l);
    l.config = select_defaults;
    const vdna_select_config *config = &l.config;
    if (!vdna_config_read(given, OLDEST_SELECT_CONFIG, &l.config, sizeof l.config) ||
        !is_config(config))
        return l;

    vdna_activations shape;
    const vdna_window_config window = window_config_of(config, &shape);
    l.select = aligned(sizeof(vdna_select));
    const size_t count = config->candidate_count;
    l.ranking = aligned(sizeof(vdna_rank_entry) * count);
    l.views = aligned(sizeof(vdna_hist_view) * count);
    l.scratch = vdna_emd_scratch_size(shape.neurons);
    if (has_bounds(config)) {
        l.scratch = aligned(vdna_rank_top_scratch_size(shape.neurons, window.bins));
        l.sums = aligned(vdna_bounds_size(shape.neurons, window.bins) * count);
    }
    if (config->localisers) {
        l.leads = aligned(sizeof(float) * VDNA_LOCALISE_LEAD_FRAMES * (size_t)config->dim);
        l.answers = aligned(sizeof(vdna_localise_answer) * count);
    }
    if (config->trust) {
        l.predictions = aligned(sizeof(vdna_trust_prediction) * count);
        l.of_candidates = l.likeness = sizeof(double) * count;
        l.codes = aligned(vdna_select_codes(config));
    }
    l.excluded = l.is_bound = aligned(sizeof(uint8_t) * count);
    l.window = vdna_window_mem_size(&window);
    if (l.window != 0 && l.scratch != 0)
        l.total = l.select + l.ranking + l.views + l.scratch + l.leads + l.answers + l.predictions +
                  l.of_candidates + l.likeness + l.codes + l.excluded + l.is_bound + l.sums +
                  l.window;
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

/* see select_state.h; in NONE_FITS the choice stays meanwhile. The localisers begin anew all the
 * same, because a live mean of frames unlike the map would spoil the next choice's places for long.
 */
void vdna_select_warm_up_again(vdna_select *select)
{
    vdna_window_reset(select->window);
    vdna_trust_reset(select->config.trust);
    vdna_select_forget(select);
    select->is_over = 0;
    if (select->state == VDNA_SELECT_NONE_FITS)
        return;
    select->state = VDNA_SELECT_WARMUP;
    select->is_placed = 0;
    select->ranked_by = VDNA_SELECT_BY_EMD;
    vdna_select_decide(select);
}

/* What bounds of distances are made of, if there are to be any. */
static vdna_status sum_candidates(const vdna_select *select)
{
    const vdna_hist_view *const views = select->views;
    const size_t numbers = vdna_bounds_size(views->neurons, views->bins) / sizeof *select->sums;
    const size_t scratch_size = vdna_emd_scratch_size(views->neurons);
    vdna_status status = VDNA_OK;
    for (uint32_t i = 0; select->sums && status == VDNA_OK && i < select->config.candidate_count;
         i++)
        status =
            vdna_bounds_sum(&views[i], select->scratch, scratch_size, select->sums + i * numbers);
    return status;
}

/* The next part of the caller's block, which ends at `*end`, and begins there. */
static void *next_part(unsigned char **end, size_t size)
{
    unsigned char *const begin = *end;
    *end += size;
    return begin;
}

/* see vdna/select.h */
vdna_status vdna_select_init(const vdna_select_config *config, void *mem, size_t mem_size,
                             vdna_select **out_select)
{
    const layout l = layout_of(config);
    if (l.total == 0 || !mem || !out_select || (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < l.total)
        return VDNA_ERR_NOMEM;
    vdna_status status = check_candidates(&l.config);
    if (status != VDNA_OK)
        return status;

    unsigned char *end = (unsigned char *)mem + l.select;
    vdna_select s;
    memset(&s, 0, sizeof s);
    s.config = l.config;
    s.ranking = next_part(&end, l.ranking);
    s.views = next_part(&end, l.views);
    s.scratch = next_part(&end, l.scratch);
    s.leads = next_part(&end, l.leads);
    s.answers = next_part(&end, l.answers);
    s.predictions = next_part(&end, l.predictions);
    s.of_candidates = next_part(&end, l.of_candidates);
    s.likeness = next_part(&end, l.likeness);
    s.codes = next_part(&end, l.codes);
    s.excluded = next_part(&end, l.excluded);
    memset(s.excluded, 0, l.excluded);
    s.is_bound = next_part(&end, l.is_bound);
    memset(s.is_bound, 0, l.is_bound);
    s.sums = next_part(&end, l.sums);
    if (l.sums == 0)
        s.sums = NULL;
    s.pinned = s.kept = VDNA_SELECT_NONE;
    vdna_activations shape;
    const vdna_window_config window = window_config_of(&l.config, &shape);
    status = vdna_window_init(&window, end, l.window, &s.window);
    if (status != VDNA_OK)
        return status;
    vdna_camera_time_init(&s.time, s.config.time_unit, s.config.late_us);
    for (uint32_t i = 0; i < s.config.candidate_count; i++)
        s.views[i] = s.config.candidates[i].dna;
    status = sum_candidates(&s);
    if (status != VDNA_OK)
        return status;
    vdna_select_warm_up_again(&s);
    *out_select = mem;
    **out_select = s;
    return VDNA_OK;
}

/* see vdna/select.h */
void vdna_select_reset(vdna_select *select)
{
    if (!select)
        return;
    select->state = VDNA_SELECT_WARMUP;
    vdna_select_forget_held(select);
    vdna_select_warm_up_again(select);
    vdna_camera_time_begin(&select->time);
}

/* Rank the experiences by distance. What is excluded takes none of the places to have exactly. */
static vdna_status rank(vdna_select *select, const vdna_hist_view *live)
{
    const uint32_t count = select->config.candidate_count;
    if (!select->sums)
        return vdna_rank(live, select->views, count, select->scratch,
                         vdna_emd_scratch_size(live->neurons), select->ranking);
    uint32_t exact = select->config.exact;
    for (uint32_t i = 0; i < count; i++)
        exact += select->excluded[i];
    return vdna_rank_top(live, select->views, select->sums, count, exact, select->scratch,
                         vdna_rank_top_scratch_size(live->neurons, live->bins), select->ranking,
                         select->is_bound);
}

/* Rank the experiences against the window, and choose the first, or what is held.
 * @param is_early  whether the choice has settled before the window is complete */
static vdna_status choose(vdna_select *select, int is_early)
{
    vdna_hist_view live;
    vdna_select_live(select, &live);
    const vdna_status status = rank(select, &live);
    if (status != VDNA_OK)
        return status;
    select->is_early = (uint32_t)is_early;
    vdna_select_judge(select);
    vdna_select_put_excluded_last(select);
    select->is_over = 1;
    if (select->config.reselect)
        vdna_trust_choose(select->config.trust, select->ranking[0].candidate);
    const uint32_t held = vdna_select_held(select);
    if (held != VDNA_SELECT_NONE)
        vdna_trust_judge(select->config.trust, held, select->predictions, &select->trusted);
    select->state =
        select->trusted.verdict == VDNA_TRUST_FITS ? VDNA_SELECT_SELECTED : VDNA_SELECT_NONE_FITS;
    vdna_select_decide(select);
    return VDNA_OK;
}

/* Whether a frame in order comes later than a whole warmup after the newest of the window. */
static int is_gap(const vdna_select *select, int64_t utime)
{
    const uint32_t frames = vdna_select_window_frames(select);
    if (frames == 0)
        return 0;
    const int64_t newest = vdna_select_last_utime(select);
    const uint64_t gap = vdna_elapsed_us(newest, utime);
    if (select->config.warmup_us > 0)
        return gap > (uint64_t)select->config.warmup_us;
    if (frames < 2 || gap < GAP_US_MIN)
        return 0;
    const uint64_t spacing =
        vdna_elapsed_us(vdna_select_first_utime(select), newest) / (frames - 1);
    return gap / select->config.warmup_frames > spacing;
}

/* What a frame's time, which is not late, does to the warmup: VDNA_RESTART_... */
static uint32_t restart_of(const vdna_select *select, uint32_t order, int64_t utime)
{
    if (order == VDNA_TIME_BACKWARDS)
        return VDNA_RESTART_BACKWARDS;
    if (order == VDNA_TIME_RECOGNISED)
        return VDNA_RESTART_UNIT;
    return is_gap(select, utime) ? VDNA_RESTART_GAP : VDNA_RESTART_NONE;
}

static void restart(vdna_select *select, uint32_t cause)
{
    vdna_select_forget_held(select);
    vdna_select_warm_up_again(select);
    select->restarts++;
    select->restart_cause = cause;
}

/* Give a frame to the window and to trust.
 * @param out_events  VDNA_WINDOW_ bits */
static vdna_status add_to_window(vdna_select *select, const vdna_select_frame *frame, int64_t utime,
                                 uint32_t *out_events)
{
    const vdna_status status =
        vdna_window_add(select->window, utime, frame->taps, frame->tap_count, out_events);
    if (!(*out_events & VDNA_WINDOW_ADDED))
        return status;
    vdna_select_count(select);
    if (select->state == VDNA_SELECT_WARMUP)
        vdna_select_take_lead(select, frame->embedding);
    return status;
}

/* Warm up with a frame, and choose once the warmup is complete. */
static vdna_status warm_up(vdna_select *select, const vdna_select_frame *frame, uint32_t order,
                           int64_t utime, vdna_select_answer *answer)
{
    vdna_status status = vdna_select_measure_for_warmup(select, frame->embedding);
    if (status != VDNA_OK)
        return status;
    if (select->is_over)
        vdna_select_warm_up_again(select);
    answer->restarted = restart_of(select, order, utime);
    if (answer->restarted != VDNA_RESTART_NONE)
        restart(select, answer->restarted);

    const uint32_t held = vdna_select_held(select); /* in shadow, more may be from the choice on */
    uint32_t events = 0;
    status = add_to_window(select, frame, utime, &events);
    const int is_complete = (events & VDNA_WINDOW_COMPLETE) != 0;
    const int is_first = select->state == VDNA_SELECT_WARMUP;
    answer->newly_ranked = is_complete || vdna_select_may_stop(select);
    if (status == VDNA_OK && answer->newly_ranked)
        status = choose(select, !is_complete);
    if (status != VDNA_OK) { /* the ranking is lost, too */
        select->state = VDNA_SELECT_WARMUP;
        vdna_select_warm_up_again(select);
        return status;
    }
    if (answer->newly_ranked && is_first)
        vdna_select_follow_leads(select, held);
    /* A frame that is too far from all to have a distance is not localised; the choice stands. A
     * frame of the first warmup is localised only in what is held: it leads all others. */
    if (!is_first || !(events & VDNA_WINDOW_ADDED))
        vdna_select_localise(select, frame->embedding, answer);
    else
        vdna_select_localise_in_held(select, held, frame->embedding, answer);
    return VDNA_OK;
}

/* All checks of a frame, before any of it is used. */
static vdna_status check_frame(vdna_select *select, const vdna_select_frame *frame,
                               const float *last_layer)
{
    if (!frame || !frame->embedding)
        return VDNA_ERR_ARG;
    vdna_status status = vdna_activations_check(frame->taps, frame->tap_count,
                                                vdna_window_hist(select->window)->neurons);
    if (status != VDNA_OK)
        return status;
    /* Check the embedding for non-finite values by treating it as a one-sample tap. */
    const vdna_activations embedding = {frame->embedding, select->config.dim, 1, 0};
    status = vdna_activations_check(&embedding, 1, select->config.dim);
    return status == VDNA_OK ? vdna_select_encode(select, last_layer) : status;
}

static vdna_status take(vdna_select *select, const vdna_select_frame *frame,
                        const float *last_layer, vdna_select_answer *answer)
{
    const vdna_status status = check_frame(select, frame, last_layer);
    if (status != VDNA_OK)
        return status;
    int64_t utime;
    const uint32_t order = vdna_camera_time_take(&select->time, frame->utime, &utime);
    if (order == VDNA_TIME_LATE)
        return VDNA_ERR_LATE;
    return select->state == VDNA_SELECT_SELECTED
               ? vdna_select_localise(select, frame->embedding, answer)
               : warm_up(select, frame, order, utime, answer);
}

/* see vdna/select.h */
vdna_status vdna_select_feed_seen(vdna_select *select, const vdna_select_frame *frame,
                                  const float *last_layer, vdna_select_answer *out_answer)
{
    if (!select || !out_answer)
        return VDNA_ERR_ARG;
    vdna_select_answer answer;
    memset(&answer, 0, sizeof answer);
    const vdna_status status = take(select, frame, last_layer, &answer);
    if (status != VDNA_OK) {
        select->rejected += status != VDNA_ERR_LATE;
        return status;
    }
    select->accepted++;
    answer.state = select->state;
    *out_answer = answer;
    return VDNA_OK;
}

/* see vdna/select.h */
vdna_status vdna_select_feed(vdna_select *select, const vdna_select_frame *frame,
                             vdna_select_answer *out_answer)
{
    return vdna_select_feed_seen(select, frame, NULL, out_answer);
}

/* see vdna/select.h */
uint32_t vdna_select_state(const vdna_select *select)
{
    return select ? select->state : VDNA_SELECT_WARMUP;
}

/* see vdna/select.h */
double vdna_select_progress(const vdna_select *select)
{
    if (!select)
        return 0;
    return select->is_over ? 1 : vdna_window_progress(select->window);
}

/* see vdna/select.h */
uint32_t vdna_select_chosen(const vdna_select *select)
{
    return select ? select->chosen : 0;
}

static int is_ranked(const vdna_select *select)
{
    return vdna_select_state(select) != VDNA_SELECT_WARMUP;
}

/* see vdna/select.h */
uint32_t vdna_select_has_choice(const vdna_select *select)
{
    return select && (is_ranked(select) || vdna_select_held(select) != VDNA_SELECT_NONE);
}

/* see vdna/select.h */
double vdna_select_margin_bins(const vdna_select *select)
{
    if (!is_ranked(select) || select->config.candidate_count == 1)
        return 0;
    return select->ranking[1].distance_bins - select->ranking[0].distance_bins;
}

/* see vdna/select.h */
const vdna_select_position *vdna_select_where(const vdna_select *select)
{
    return vdna_select_has_choice(select) && select->is_placed ? &select->position : NULL;
}

/* see vdna/select.h */
uint32_t vdna_select_is_lost(const vdna_select *select)
{
    const vdna_select_position *where = vdna_select_where(select);
    return where && vdna_localise_jumps(select->config.localisers[where->candidate]) >=
                        VDNA_LOCALISE_LOST_JUMPS;
}

/* see vdna/select.h */
const vdna_rank_entry *vdna_select_ranking(const vdna_select *select, uint32_t *out_count)
{
    const int is_there = is_ranked(select);
    if (out_count)
        *out_count = is_there ? select->config.candidate_count : 0;
    return is_there ? select->ranking : NULL;
}

/* see vdna/select.h */
uint32_t vdna_select_is_bound(const vdna_select *select, uint32_t candidate)
{
    return is_ranked(select) && candidate < select->config.candidate_count
               ? select->is_bound[candidate]
               : 0;
}

/* see vdna/select.h */
uint32_t vdna_select_is_early(const vdna_select *select)
{
    return is_ranked(select) ? select->is_early : 0;
}

/* see vdna/select.h */
uint32_t vdna_select_ranked_by(const vdna_select *select)
{
    return select ? select->ranked_by : VDNA_SELECT_BY_EMD;
}

/* see vdna/select.h */
uint64_t vdna_select_switches(const vdna_select *select)
{
    return select ? select->switches : 0;
}

/* see vdna/select.h */
uint32_t vdna_select_previous(const vdna_select *select)
{
    return select ? select->previous : 0;
}

/* see vdna/select.h */
void vdna_select_live(const vdna_select *select, vdna_hist_view *out_view)
{
    if (select)
        vdna_hist_view_of(vdna_window_hist(select->window), out_view);
}

/* see vdna/select.h */
uint32_t vdna_select_window_frames(const vdna_select *select)
{
    return select ? vdna_window_hist(select->window)->frames : 0;
}

/* see vdna/select.h */
int64_t vdna_select_first_utime(const vdna_select *select)
{
    return select ? vdna_window_first_utime(select->window) : 0;
}

/* see vdna/select.h */
int64_t vdna_select_last_utime(const vdna_select *select)
{
    return select ? vdna_window_last_utime(select->window) : 0;
}

/* see vdna/select.h */
uint64_t vdna_select_accepted(const vdna_select *select)
{
    return select ? select->accepted : 0;
}

/* see vdna/select.h */
uint64_t vdna_select_rejected(const vdna_select *select)
{
    return select ? select->rejected : 0;
}

/* see vdna/select.h */
uint64_t vdna_select_restarts(const vdna_select *select)
{
    return select ? select->restarts : 0;
}

/* see vdna/select.h */
uint32_t vdna_select_restart_cause(const vdna_select *select)
{
    return select ? select->restart_cause : VDNA_RESTART_NONE;
}

/* see vdna/select.h */
const char *vdna_restart_text(uint32_t cause)
{
    switch (cause) {
    case VDNA_RESTART_BACKWARDS:
        return "because camera time stepped back";
    case VDNA_RESTART_GAP:
        return "because no frame came for longer than the warmup";
    case VDNA_RESTART_UNIT:
        return "because the stamps are not microseconds";
    default:
        return "";
    }
}

/* see vdna/select.h */
const vdna_camera_time *vdna_select_time(const vdna_select *select)
{
    return select ? &select->time : NULL;
}
