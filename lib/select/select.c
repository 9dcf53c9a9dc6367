#include <string.h>

#include <vdna/select.h>
#include <vdna/window.h>

#include "elapsed.h"
#include "growth.h"

/* Bytes of vdna_select_config in version 0.1. */
#define OLDEST_SELECT_CONFIG offsetof(vdna_select_config, late_us)

/* Shortest gap in a warmup by frames that begins it anew: short pauses say nothing there. */
#define GAP_US_MIN 10000000u

static const vdna_select_config select_defaults = {
    .late_us = VDNA_TIME_LATE_US_DEFAULT,
    .warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT,
    .top = 1,
};

/* At the beginning of the caller's block; ranking, views, scratch and window follow. */
struct vdna_select {
    vdna_select_config config;
    vdna_window *window;
    vdna_hist_view *views;    /* [candidate_count] */
    vdna_rank_entry *ranking; /* [candidate_count], valid in state SELECTED */
    void *scratch;
    double margin_bins;
    vdna_camera_time time;
    vdna_select_position position; /* valid in state SELECTED, if there are localisers */
    float *leads;                  /* [VDNA_LOCALISE_LEAD_FRAMES][dim], a ring */
    uint64_t lead_count;           /* all so far */
    uint64_t accepted, rejected, restarts;
    uint32_t state, chosen, restart_cause;
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
    return 1;
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
    size_t select, ranking, views, scratch, leads, window; /* bytes of each */
    size_t total;                                          /* 0 if the config is invalid */
    vdna_select_config config;                             /* complete */
} layout;

static size_t aligned(size_t size)
{
    return (size + sizeof(int64_t) - 1) / sizeof(int64_t) * sizeof(int64_t);
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
    l.ranking = aligned(sizeof(vdna_rank_entry) * (size_t)config->candidate_count);
    l.views = aligned(sizeof(vdna_hist_view) * (size_t)config->candidate_count);
    l.scratch = vdna_emd_scratch_size(shape.neurons);
    if (config->localisers)
        l.leads = aligned(sizeof(float) * VDNA_LOCALISE_LEAD_FRAMES * (size_t)config->dim);
    l.window = vdna_window_mem_size(&window);
    if (l.window != 0 && l.scratch != 0)
        l.total = l.select + l.ranking + l.views + l.scratch + l.leads + l.window;
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

static void reset_localisers(const vdna_select_config *config)
{
    for (uint32_t i = 0; config->localisers && i < config->candidate_count; i++)
        vdna_localise_reset(config->localisers[i]);
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

    unsigned char *const ranking = (unsigned char *)mem + l.select;
    unsigned char *const views = ranking + l.ranking, *const scratch = views + l.views;
    unsigned char *const leads = scratch + l.scratch;
    vdna_activations shape;
    const vdna_window_config window = window_config_of(&l.config, &shape);
    vdna_select s;
    memset(&s, 0, sizeof s);
    status = vdna_window_init(&window, leads + l.leads, l.window, &s.window);
    if (status != VDNA_OK)
        return status;
    s.config = l.config;
    s.ranking = (vdna_rank_entry *)(void *)ranking;
    s.views = (vdna_hist_view *)(void *)views;
    s.scratch = scratch;
    s.leads = (float *)(void *)leads;
    vdna_camera_time_init(&s.time, s.config.time_unit, s.config.late_us);
    for (uint32_t i = 0; i < s.config.candidate_count; i++)
        s.views[i] = s.config.candidates[i].dna;
    reset_localisers(&s.config);
    *out_select = mem;
    **out_select = s;
    return VDNA_OK;
}

/* Forget the choice and the window; camera time goes on. */
static void warm_up_again(vdna_select *select)
{
    vdna_window_reset(select->window);
    reset_localisers(&select->config);
    select->state = VDNA_SELECT_WARMUP;
    select->chosen = 0;
    select->margin_bins = 0;
    select->lead_count = 0;
}

/* see vdna/select.h */
void vdna_select_reset(vdna_select *select)
{
    if (!select)
        return;
    warm_up_again(select);
    vdna_camera_time_begin(&select->time);
}

/* Rank the experiences against the window and choose the nearest. */
static vdna_status choose(vdna_select *select)
{
    vdna_hist_view live;
    vdna_select_live(select, &live);
    const uint32_t count = select->config.candidate_count;
    const vdna_status status = vdna_rank(&live, select->views, count, select->scratch,
                                         vdna_emd_scratch_size(live.neurons), select->ranking);
    if (status != VDNA_OK)
        return status;
    select->state = VDNA_SELECT_SELECTED;
    select->chosen = select->ranking[0].candidate;
    if (count > 1)
        select->margin_bins = select->ranking[1].distance_bins - select->ranking[0].distance_bins;
    return VDNA_OK;
}

static vdna_status find_nearest_frame(const vdna_select *select, const float *embedding,
                                      vdna_knn_match *match)
{
    const vdna_select_candidate *chosen = &select->config.candidates[select->chosen];
    return vdna_knn(embedding, select->config.dim, chosen->embeddings, chosen->frames, 1, match);
}

/* Let the localisers of the nearest experiences follow, and hear the most confident. They refuse
 * nothing: the embedding was checked, and they have its size. */
static void follow(vdna_select *select, const float *embedding)
{
    const vdna_select_config *config = &select->config;
    vdna_select_position *const best = &select->position;
    for (uint32_t i = 0; i < config->top && i < config->candidate_count; i++) {
        const uint32_t candidate = select->ranking[i].candidate;
        vdna_localise_answer answer;
        vdna_localise_feed(config->localisers[candidate], embedding, &answer);
        if (i > 0 && answer.confidence <= best->answer.confidence)
            continue;
        best->candidate = candidate;
        best->answer = answer;
    }
}

static vdna_status localise(vdna_select *select, const float *embedding, vdna_select_answer *answer)
{
    if (!select->config.localisers) {
        const vdna_status status = find_nearest_frame(select, embedding, &answer->match);
        answer->localised = status == VDNA_OK;
        return status;
    }
    follow(select, embedding);
    answer->match.index = select->position.answer.nearest;
    answer->match.distance_sq = 2 * select->position.answer.nearest_distance;
    answer->localised = 1;
    return VDNA_OK;
}

static float *lead(const vdna_select *select, uint64_t number)
{
    return select->leads + select->config.dim * (number % VDNA_LOCALISE_LEAD_FRAMES);
}

/* Take a frame of the window: the one that it pushes out of the leads goes into the live means. */
static void take_lead(vdna_select *select, const float *embedding)
{
    const vdna_select_config *config = &select->config;
    if (!config->localisers)
        return;
    float *const place = lead(select, select->lead_count);
    if (select->lead_count >= VDNA_LOCALISE_LEAD_FRAMES)
        for (uint32_t i = 0; i < config->candidate_count; i++)
            vdna_localise_warm_up(config->localisers[i], place);
    memcpy(place, embedding, config->dim * sizeof *embedding);
    select->lead_count++;
}

/* Let the localisers of the chosen follow the leads to where the robot is. */
static void follow_leads(vdna_select *select)
{
    uint64_t number = 0;
    if (select->lead_count > VDNA_LOCALISE_LEAD_FRAMES)
        number = select->lead_count - VDNA_LOCALISE_LEAD_FRAMES;
    for (; number < select->lead_count; number++)
        follow(select, lead(select, number));
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
    warm_up_again(select);
    select->restarts++;
    select->restart_cause = cause;
}

/* Give a frame to the window, and choose once the window is complete. */
static vdna_status warm_up(vdna_select *select, const vdna_select_frame *frame, uint32_t order,
                           int64_t utime, vdna_select_answer *answer)
{
    answer->restarted = restart_of(select, order, utime);
    if (answer->restarted != VDNA_RESTART_NONE)
        restart(select, answer->restarted);
    uint32_t events = 0;
    vdna_status status =
        vdna_window_add(select->window, utime, frame->taps, frame->tap_count, &events);
    if (events & VDNA_WINDOW_ADDED)
        take_lead(select, frame->embedding);
    if (status == VDNA_OK && (events & VDNA_WINDOW_COMPLETE))
        status = choose(select);
    if (status != VDNA_OK) {
        warm_up_again(select);
        return status;
    }
    if (events & VDNA_WINDOW_COMPLETE)
        follow_leads(select);
    answer->newly_ranked = (events & VDNA_WINDOW_COMPLETE) != 0;
    /* A frame that is too far from all to have a distance is not localised; the choice stands. */
    if (!(events & VDNA_WINDOW_ADDED))
        localise(select, frame->embedding, answer);
    return VDNA_OK;
}

/* All checks of a frame, before any of it is used. */
static vdna_status check_frame(const vdna_select *select, const vdna_select_frame *frame)
{
    if (!frame || !frame->embedding)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_activations_check(frame->taps, frame->tap_count,
                                                      vdna_window_hist(select->window)->neurons);
    if (status != VDNA_OK)
        return status;
    /* Check the embedding for non-finite values by treating it as a one-sample tap. */
    const vdna_activations embedding = {frame->embedding, select->config.dim, 1, 0};
    return vdna_activations_check(&embedding, 1, select->config.dim);
}

static vdna_status take(vdna_select *select, const vdna_select_frame *frame,
                        vdna_select_answer *answer)
{
    const vdna_status status = check_frame(select, frame);
    if (status != VDNA_OK)
        return status;
    int64_t utime;
    const uint32_t order = vdna_camera_time_take(&select->time, frame->utime, &utime);
    if (order == VDNA_TIME_LATE)
        return VDNA_ERR_LATE;
    return select->state == VDNA_SELECT_WARMUP ? warm_up(select, frame, order, utime, answer)
                                               : localise(select, frame->embedding, answer);
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
        select->rejected += status != VDNA_ERR_LATE;
        return status;
    }
    select->accepted++;
    answer.state = select->state;
    *out_answer = answer;
    return VDNA_OK;
}

/* see vdna/select.h */
uint32_t vdna_select_state(const vdna_select *select)
{
    return select ? select->state : VDNA_SELECT_WARMUP;
}

/* see vdna/select.h */
double vdna_select_progress(const vdna_select *select)
{
    return select ? vdna_window_progress(select->window) : 0;
}

/* see vdna/select.h */
uint32_t vdna_select_chosen(const vdna_select *select)
{
    return select ? select->chosen : 0;
}

/* see vdna/select.h */
double vdna_select_margin_bins(const vdna_select *select)
{
    return select ? select->margin_bins : 0;
}

/* see vdna/select.h */
const vdna_select_position *vdna_select_where(const vdna_select *select)
{
    const int is_placed =
        vdna_select_state(select) == VDNA_SELECT_SELECTED && select->lead_count > 0;
    return is_placed ? &select->position : NULL;
}

/* see vdna/select.h */
const vdna_rank_entry *vdna_select_ranking(const vdna_select *select, uint32_t *out_count)
{
    const int selected = vdna_select_state(select) == VDNA_SELECT_SELECTED;
    if (out_count)
        *out_count = selected ? select->config.candidate_count : 0;
    return selected ? select->ranking : NULL;
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
