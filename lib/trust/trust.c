#include <math.h>
#include <string.h>

#include <vdna/trust.h>

#include "growth.h"
#include "recall_angle.h"
#include "trust_model.h"

/* Bytes of vdna_trust_config in the version that brought it. */
#define OLDEST_TRUST_CONFIG sizeof(vdna_trust_config)

enum { RETURNS = 8, MEMORY_FRAMES = 100 };

static const double relative_limit = 2;
static const double settled_deviations = 1.645; /* one-sided, 5 % */
static const double likeness_margin = 0.10;     /* of `unlike`, on the last layer */
static const double blank_margin = 0.05;        /* of a run that hardly varies */
static const double blank_variation = 0.025;    /* its standard deviation over its mean */
static const double switch_slack = 0.02;        /* in correct frames per frame */

static const vdna_trust_prior priors[] = {
    {-0.45, 0.43, 1.33, 0.16, 0.04, 0.13, 0.5, 0.12, 0.20},
    {-0.90, 0.10, 1.00, 0.13, 0.08, 0.10, 0.0, 0.00, 0.10},
};

static const vdna_trust_config trust_defaults = {.switch_cost = 5};

/* At the beginning of the caller's block; arrays of [runs] follow, and those of the model. */
struct vdna_trust {
    vdna_trust_fit fit;
    vdna_trust_model model;
    double *own;              /* w */
    double *mean;             /* rho of the live frames */
    double *mean_likeness;    /* the same on the last layer */
    double *likeness_squares; /* sum of squares about that mean */
    double *products; /* [runs (runs + 1) / 2], sums of products of two candidates' rho about
                         their means */
    double *gain;     /* G */
    int64_t *left;    /* when a candidate was left, in frames since the first choice */
    int64_t returns[RETURNS]; /* when candidates were returned to, the newest ones; at a cost of at
                                 least one frame, which doubles, no more fit into MEMORY_FRAMES */
    int64_t time;
    double typical; /* ln rho of the median stored run to its nearest; NaN as `far` */
    double min_recall, switch_cost;
    uint32_t frames, settled_frames, chosen, return_count;
    int32_t has_tables, is_comparable, has_chosen;
};

/* ---- Construction ---- */

/* see vdna/trust.h */
void vdna_trust_config_init(vdna_trust_config *config)
{
    vdna_config_write(config, OLDEST_TRUST_CONFIG, &trust_defaults, sizeof trust_defaults);
}

static int is_from_to(double x, double least, double most)
{
    return x >= least && x <= most;
}

static int read_trust_config(const vdna_trust_config *given, vdna_trust_config *out_config)
{
    *out_config = trust_defaults;
    return vdna_config_read(given, OLDEST_TRUST_CONFIG, out_config, sizeof *out_config) &&
           is_from_to(out_config->runs, 1, VDNA_TRUST_RUNS_MAX) &&
           out_config->localiser <= VDNA_TRUST_EUCLIDEAN &&
           is_from_to(out_config->min_recall, 0, 1) && is_from_to(out_config->switch_cost, 1, 1e6);
}

static size_t size_of_trust(size_t runs)
{
    const size_t arrays = 6 + 1 + VDNA_TRUST_WORK; /* of doubles; `left` is as wide */
    return sizeof(vdna_trust) + sizeof(double) * (4 * runs * runs + arrays * runs) +
           sizeof(uint32_t) * (runs + runs % 2);
}

/* see vdna/trust.h */
size_t vdna_trust_mem_size(const vdna_trust_config *config)
{
    vdna_trust_config complete;
    return read_trust_config(config, &complete) ? size_of_trust(complete.runs) : 0;
}

static int is_known(double x, double most)
{
    return isnan(x) || is_from_to(x, 0, most);
}

static int is_cell(const vdna_trust_cell *cell, uint32_t windows)
{
    int good = 1;
    for (uint32_t i = 0; i < windows; i++)
        good &= is_from_to(cell->nearest[i], 0, relative_limit) &
                is_known(cell->likeness[i], relative_limit) & is_known(cell->recall[i], 1) &
                is_known(cell->distance[i], 1e18);
    return good;
}

/* see vdna/trust.h */
vdna_status vdna_trust_tables_check(const vdna_trust_tables *tables, uint32_t runs)
{
    if (!tables || runs == 0 || runs > VDNA_TRUST_RUNS_MAX || !tables->frames ||
        !tables->own_scale || !tables->correlation || !tables->cells)
        return VDNA_ERR_ARG;
    for (uint32_t a = 0; a < runs; a++) {
        const uint32_t windows = vdna_trust_windows(tables->frames[a], NULL, NULL);
        if (windows == 0)
            return VDNA_ERR_ARG;
        if (!is_from_to(tables->own_scale[a], 1e-6, relative_limit) ||
            !is_known(tables->correlation[a], 1e9))
            return VDNA_ERR_NONFINITE;
        for (uint32_t b = 0; b < runs; b++)
            if (a != b && !is_cell(&tables->cells[(size_t)a * runs + b], windows))
                return VDNA_ERR_NONFINITE;
    }
    return VDNA_OK;
}

/* Values by which `unlike` is judged. */
static const double *likeness_of(const vdna_trust_cell *cell, uint32_t by_likeness)
{
    return by_likeness ? cell->likeness : cell->nearest;
}

static uint32_t has_likeness(const vdna_trust_tables *tables, uint32_t runs)
{
    uint32_t all = runs > 1;
    for (uint32_t a = 0; a < runs; a++) {
        const uint32_t windows = vdna_trust_windows(tables->frames[a], NULL, NULL);
        for (uint32_t b = 0; b < runs; b++)
            for (uint32_t i = 0; i < windows && a != b; i++)
                all &= isnan(tables->cells[(size_t)a * runs + b].likeness[i]) ? 0u : 1u;
    }
    return all;
}

/* ln rho of a stored run to its nearest, mean over its windows. */
static double loneliness_of(const vdna_trust_tables *tables, uint32_t runs, uint32_t a,
                            uint32_t by_likeness)
{
    const uint32_t windows = vdna_trust_windows(tables->frames[a], NULL, NULL);
    double sum = 0;
    for (uint32_t i = 0; i < windows; i++) {
        double least = relative_limit;
        for (uint32_t b = 0; b < runs; b++) {
            const double x = likeness_of(&tables->cells[(size_t)a * runs + b], by_likeness)[i];
            least = a != b && x < least ? x : least;
        }
        sum += vdna_ln(least) / windows;
    }
    return sum;
}

/* Put a value among `count` ascending ones. */
static void insert_ascending(double *sorted, uint32_t count, double value)
{
    uint32_t at = count;
    for (; at > 0 && sorted[at - 1] > value; at--)
        sorted[at] = sorted[at - 1];
    sorted[at] = value;
}

/* How lonely the stored runs are: the loneliest, and the median (the upper of two).
 * @param sorted  [runs], working memory */
static void take_loneliness(vdna_trust *trust, const vdna_trust_tables *tables, double *sorted)
{
    const uint32_t runs = trust->model.runs;
    if (runs == 1)
        return;
    for (uint32_t a = 0; a < runs; a++)
        insert_ascending(sorted, a, loneliness_of(tables, runs, a, trust->fit.by_likeness));
    trust->fit.far = sorted[runs - 1];
    trust->typical = sorted[runs / 2];
}

/* Median of the tau that are known, at least 1; NaN if none is.
 * @param sorted  [runs], working memory */
static double correlation_of(const vdna_trust_tables *tables, uint32_t runs, double *sorted)
{
    uint32_t count = 0;
    for (uint32_t a = 0; a < runs; a++) {
        const double tau = tables->correlation[a];
        if (!isnan(tau))
            insert_ascending(sorted, count++, tau);
    }
    if (count == 0)
        return NAN;
    const double median = (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
    return median > 1 ? median : 1;
}

static void set_arrays(vdna_trust *trust)
{
    const size_t runs = trust->model.runs;
    double *next = (double *)(void *)(trust + 1);
    double **const squares[] = {&trust->model.recall, &trust->model.distance, &trust->model.x,
                                &trust->model.y};
    for (size_t i = 0; i < sizeof squares / sizeof *squares; i++, next += runs * runs)
        *squares[i] = next;
    double **const rows[] = {&trust->own,           &trust->mean,
                             &trust->mean_likeness, &trust->likeness_squares,
                             &trust->gain,          &trust->model.intercept};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++, next += runs)
        *rows[i] = next;
    trust->model.work = next;
    trust->left = (int64_t *)(void *)(next + VDNA_TRUST_WORK * runs);
    trust->model.ids = (uint32_t *)(void *)(trust->left + runs);
    /* The fit is over when products begin, which are half a square. */
    trust->products = trust->model.x;
}

/* see vdna/trust.h */
vdna_status vdna_trust_init(const vdna_trust_config *config, void *mem, size_t mem_size,
                            vdna_trust **out_trust)
{
    vdna_trust_config c;
    if (!read_trust_config(config, &c) || !mem || !out_trust ||
        (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < size_of_trust(c.runs))
        return VDNA_ERR_NOMEM;
    const vdna_status status = c.tables ? vdna_trust_tables_check(c.tables, c.runs) : VDNA_OK;
    if (status != VDNA_OK)
        return status;

    vdna_trust *trust = mem;
    memset(trust, 0, sizeof *trust);
    trust->model.runs = c.runs;
    trust->model.prior = &priors[c.localiser];
    trust->min_recall = c.min_recall;
    trust->switch_cost = c.switch_cost;
    trust->has_tables = c.tables != NULL;
    vdna_trust_fit *fit = &trust->fit;
    fit->skill = fit->slope = fit->sd = fit->sd_best = fit->quantile = NAN;
    fit->far = trust->typical = fit->correlation = NAN;
    set_arrays(trust);
    for (uint32_t b = 0; b < c.runs; b++) {
        trust->own[b] = c.tables ? c.tables->own_scale[b] : 1;
        trust->model.intercept[b] = NAN;
    }
    if (c.tables) {
        fit->by_likeness = has_likeness(c.tables, c.runs);
        take_loneliness(trust, c.tables, trust->gain);
        fit->correlation = correlation_of(c.tables, c.runs, trust->gain);
        /* `left` is free until a choice is watched, and wider than what the fit needs. */
        vdna_trust_model_fit(&trust->model, c.tables, (uint32_t *)(void *)trust->left, fit);
    }
    trust->is_comparable = fit->labelled == c.runs && c.runs >= VDNA_TRUST_RUNS_MIN;
    vdna_trust_reset(trust);
    *out_trust = trust;
    return VDNA_OK;
}

/* see vdna/trust.h */
void vdna_trust_reset(vdna_trust *trust)
{
    if (!trust)
        return;
    const size_t runs = trust->model.runs;
    trust->frames = trust->settled_frames = 0;
    trust->has_chosen = 0;
    for (size_t b = 0; b < runs; b++)
        trust->mean[b] = trust->mean_likeness[b] = trust->likeness_squares[b] = 0;
    for (size_t i = 0; i < runs * (runs + 1) / 2; i++)
        trust->products[i] = 0;
}

/* ---- Live frames ---- */

static int are_relative(const double *values, uint32_t count)
{
    int good = 1;
    for (uint32_t i = 0; i < count; i++)
        good &= is_from_to(values[i], 0, relative_limit);
    return good;
}

/* Take a frame's likeness into the means and the sums of squares. */
static void take_likeness(vdna_trust *trust, const double *likeness)
{
    for (uint32_t b = 0; b < trust->model.runs; b++) {
        const double before = likeness[b] - trust->mean_likeness[b];
        trust->mean_likeness[b] += before / trust->frames;
        trust->likeness_squares[b] += before * (likeness[b] - trust->mean_likeness[b]);
    }
}

/* Take a frame into the means and the sums of products. */
static void take_frame(vdna_trust *trust, const double *nearest)
{
    const uint32_t runs = trust->model.runs;
    double *const before = trust->model.work, *products = trust->products;
    for (uint32_t b = 0; b < runs; b++) {
        before[b] = nearest[b] - trust->mean[b];
        trust->mean[b] += before[b] / trust->frames;
    }
    for (uint32_t a = 0; a < runs; a++)
        for (uint32_t b = 0; b <= a; b++)
            *products++ += before[a] * (nearest[b] - trust->mean[b]);
}

static double product_of(const vdna_trust *trust, uint32_t a, uint32_t b)
{
    return a < b ? trust->products[(size_t)b * (b + 1) / 2 + a]
                 : trust->products[(size_t)a * (a + 1) / 2 + b];
}

/* z of all candidates.
 * @return the first of the highest */
static uint32_t take_z(const vdna_trust *trust, double *out_z)
{
    const vdna_trust_model *model = &trust->model;
    for (uint32_t b = 0; b < model->runs; b++)
        out_z[b] = trust->is_comparable ? model->intercept[b] +
                                              model->slope * vdna_ln(trust->mean[b] / trust->own[b])
                                        : model->prior->slope * vdna_ln(trust->mean[b]);
    return vdna_largest_of(out_z, model->runs);
}

/* Variance of the difference of two candidates' distances, each over its mean. */
static double variance_between(const vdna_trust *trust, uint32_t a, uint32_t b)
{
    const double scale_a =
        1 / (trust->mean[a] > 1e-6 * trust->own[a] ? trust->mean[a] : 1e-6 * trust->own[a]);
    const double scale_b =
        1 / (trust->mean[b] > 1e-6 * trust->own[b] ? trust->mean[b] : 1e-6 * trust->own[b]);
    const double sum = product_of(trust, a, a) * scale_a * scale_a +
                       product_of(trust, b, b) * scale_b * scale_b -
                       2 * (product_of(trust, a, b) * scale_a * scale_b);
    return sum > 0 ? sum / (trust->frames - 1) : 0;
}

static int is_settled(const vdna_trust *trust)
{
    const vdna_trust_fit *fit = &trust->fit;
    const uint32_t runs = trust->model.runs;
    if (trust->frames < VDNA_TRUST_SETTLED_FRAMES)
        return 0;
    if (runs == 1)
        return 1;
    if (isnan(fit->correlation) || (fit->labelled >= VDNA_TRUST_SKILL_RUNS_MIN && fit->skill <= 0))
        return 0;
    double *const z = trust->model.work;
    const uint32_t best = take_z(trust, z);
    const double slope = trust->is_comparable ? trust->model.slope : trust->model.prior->slope;
    const double per_variance =
        settled_deviations * settled_deviations * slope * slope * fit->correlation / trust->frames;
    int settled = 1;
    for (uint32_t b = 0; b < runs; b++) {
        const double lead = z[best] - z[b];
        settled &= lead * lead >= variance_between(trust, best, b) * per_variance;
    }
    return settled;
}

/* see vdna/trust.h */
vdna_status vdna_trust_feed(vdna_trust *trust, const double *nearest, const double *likeness)
{
    if (!trust || !nearest || (trust->fit.by_likeness && !likeness))
        return VDNA_ERR_ARG;
    const uint32_t runs = trust->model.runs;
    if (!are_relative(nearest, runs) || (trust->fit.by_likeness && !are_relative(likeness, runs)))
        return VDNA_ERR_NONFINITE;
    if (trust->frames == VDNA_TRUST_FRAMES_MAX)
        return VDNA_ERR_FULL;

    trust->frames++;
    take_frame(trust, nearest);
    if (trust->fit.by_likeness)
        take_likeness(trust, likeness);
    if (trust->settled_frames == 0 && is_settled(trust))
        trust->settled_frames = trust->frames;
    return VDNA_OK;
}

/* see vdna/trust.h */
uint32_t vdna_trust_settled_frames(const vdna_trust *trust)
{
    return trust ? trust->settled_frames : 0;
}

/* ---- Predictions ---- */

static const double *likeness_means(const vdna_trust *trust)
{
    return trust->fit.by_likeness ? trust->mean_likeness : trust->mean;
}

static uint32_t nearest_of(const vdna_trust *trust)
{
    const double *means = likeness_means(trust);
    uint32_t nearest = 0;
    for (uint32_t b = 1; b < trust->model.runs; b++)
        nearest = means[b] < means[nearest] ? b : nearest;
    return nearest;
}

/* How much farther the live run is from a candidate than the loneliest stored run from its
 * nearest. */
static double unlike_in(const vdna_trust *trust, uint32_t candidate)
{
    return trust->frames == 0 ? (double)NAN
                              : vdna_ln(likeness_means(trust)[candidate]) - trust->fit.far;
}

/* Whether frames hardly differ in how far they are from a candidate, which is farther than usual.
 */
static int is_blank(const vdna_trust *trust, uint32_t candidate)
{
    if (!trust->fit.by_likeness)
        return 0;
    const double mean = trust->mean_likeness[candidate];
    const double deviation = blank_variation * mean;
    return vdna_ln(mean) - trust->typical > blank_margin &&
           trust->likeness_squares[candidate] < deviation * deviation * trust->frames;
}

/* Whether the live run fits a candidate, by its looks. Too few frames cannot tell; what is not
 * known does not speak against it. */
static uint32_t looks_in(const vdna_trust *trust, uint32_t candidate)
{
    const double margin =
        trust->fit.by_likeness ? likeness_margin : trust->model.prior->unlike_margin;
    if (trust->frames < VDNA_TRUST_FRAMES_MIN)
        return VDNA_TRUST_FITS;
    if (unlike_in(trust, candidate) > margin)
        return VDNA_TRUST_UNLIKE;
    return is_blank(trust, candidate) ? VDNA_TRUST_BLANK : VDNA_TRUST_FITS;
}

/* Reason that holds for all labelled candidates. */
static uint32_t reason_of(const vdna_trust *trust, int unlike, int has_distances)
{
    if (!trust->has_tables)
        return VDNA_TRUST_REASON_NO_TABLES;
    if (trust->frames < VDNA_TRUST_FRAMES_MIN)
        return VDNA_TRUST_REASON_FEW_FRAMES;
    if (unlike)
        return VDNA_TRUST_REASON_UNLIKE;
    if (trust->fit.labelled < VDNA_TRUST_RUNS_MIN)
        return VDNA_TRUST_REASON_FEW_RUNS;
    if (!has_distances && trust->model.prior->transfer_share > 0)
        return VDNA_TRUST_REASON_NO_DISTANCE;
    return VDNA_TRUST_REASON_NONE;
}

/* Nothing but distances, for a reason that spares no candidate.
 * @param z  [runs], valid if there is a frame */
static void write_without(const vdna_trust *trust, const double *z, uint32_t reason,
                          vdna_trust_prediction *out)
{
    for (uint32_t b = 0; b < trust->model.runs; b++) {
        const vdna_trust_prediction none = {NAN, NAN, NAN, NAN, NAN, NAN, reason, 0};
        out[b] = none;
        if (trust->frames == 0)
            continue;
        out[b].nearest = trust->mean[b] / trust->own[b];
        out[b].score = z[b];
    }
}

/* Transfer of the labelled runs, if there are two.
 * @param out_transfer  [labelled] */
static void write_transfer(const vdna_trust *trust, const double *distance_bins,
                           double *out_transfer, vdna_trust_prediction *out)
{
    const vdna_trust_model *model = &trust->model;
    double *const distances = model->work, *const weights = model->work + model->runs;
    if (model->labelled == 0)
        return;
    for (uint32_t i = 0; i < model->labelled; i++)
        distances[i] = distance_bins[model->ids[i]];
    vdna_trust_transfer(model, model->ids, model->labelled, model->spread, distances, weights,
                        out_transfer);
    for (uint32_t i = 0; i < model->labelled; i++)
        out[model->ids[i]].transfer = out_transfer[i];
}

/* Recall and interval of the labelled runs.
 * @param transfer  [labelled]; ignored if it has no share
 * @return the recall of the best */
static double write_recall(const vdna_trust *trust, const double *transfer,
                           vdna_trust_prediction *out)
{
    const vdna_trust_model *model = &trust->model;
    const double share = model->prior->transfer_share;
    double *const y = model->work;
    for (uint32_t i = 0; i < model->labelled; i++) {
        const uint32_t b = model->ids[i];
        y[i] = model->intercept[b] + model->slope * vdna_ln(out[b].nearest);
        if (share > 0)
            y[i] = (1 - share) * y[i] + share * vdna_recall_angle(transfer[i]);
    }
    const uint32_t best = vdna_largest_of(y, model->labelled);
    for (uint32_t i = 0; i < model->labelled; i++) {
        vdna_trust_prediction *const p = &out[model->ids[i]];
        const double within =
            trust->fit.quantile * (i == best ? trust->fit.sd_best : trust->fit.sd);
        p->recall = vdna_angle_recall(y[i]);
        p->low = vdna_angle_recall(y[i] - within);
        p->high = vdna_angle_recall(y[i] + within);
        p->reason = VDNA_TRUST_REASON_NONE;
    }
    return vdna_angle_recall(y[best]);
}

/* see vdna/trust.h */
vdna_status vdna_trust_predict(vdna_trust *trust, const double *distance_bins,
                               vdna_trust_prediction *out_predictions,
                               vdna_trust_answer *out_answer)
{
    if (!trust || !out_predictions || !out_answer)
        return VDNA_ERR_ARG;
    for (uint32_t b = 0; b < trust->model.runs && distance_bins; b++)
        if (!is_from_to(distance_bins[b], 0, 1e18))
            return VDNA_ERR_NONFINITE;

    const vdna_trust_model *model = &trust->model;
    vdna_trust_answer answer = {VDNA_TRUST_FITS, trust->frames, 0, trust->settled_frames, 0};
    answer.choice = trust->frames > 0 ? take_z(trust, model->work) : 0;
    const uint32_t nearest = nearest_of(trust);
    answer.unlike = unlike_in(trust, nearest);
    answer.verdict = looks_in(trust, nearest);
    const uint32_t reason =
        reason_of(trust, answer.verdict != VDNA_TRUST_FITS, distance_bins != NULL);
    const int is_predicted = reason == VDNA_TRUST_REASON_NONE;
    write_without(trust, model->work, is_predicted ? VDNA_TRUST_REASON_NOT_LABELLED : reason,
                  out_predictions);
    double *const transfer = model->work + 2 * (size_t)model->runs;
    if (distance_bins)
        write_transfer(trust, distance_bins, transfer, out_predictions);
    if (is_predicted && write_recall(trust, transfer, out_predictions) < trust->min_recall)
        answer.verdict = VDNA_TRUST_POOR;
    *out_answer = answer;
    return VDNA_OK;
}

/* see vdna/trust.h */
vdna_status vdna_trust_judge(const vdna_trust *trust, uint32_t candidate,
                             const vdna_trust_prediction *predictions, vdna_trust_answer *answer)
{
    if (!trust || candidate >= trust->model.runs || !predictions || !answer)
        return VDNA_ERR_ARG;
    answer->unlike = unlike_in(trust, candidate);
    answer->verdict = looks_in(trust, candidate);
    if (answer->verdict == VDNA_TRUST_FITS && predictions[candidate].recall < trust->min_recall)
        answer->verdict = VDNA_TRUST_POOR;
    return VDNA_OK;
}

/* ---- Choosing again ---- */

/* see vdna/trust.h */
vdna_status vdna_trust_choose(vdna_trust *trust, uint32_t candidate)
{
    if (!trust || candidate >= trust->model.runs)
        return VDNA_ERR_ARG;
    trust->chosen = candidate;
    trust->has_chosen = 1;
    trust->time = 0;
    trust->return_count = 0;
    for (uint32_t i = 0; i < RETURNS; i++)
        trust->returns[i] = -MEMORY_FRAMES;
    for (uint32_t b = 0; b < trust->model.runs; b++) {
        trust->gain[b] = 0;
        trust->left[b] = -MEMORY_FRAMES;
    }
    return VDNA_OK;
}

/* see vdna/trust.h */
vdna_status vdna_trust_expect(const vdna_trust *trust, const double *nearest, double *out_recall)
{
    if (!trust || !nearest || !out_recall)
        return VDNA_ERR_ARG;
    if (!are_relative(nearest, trust->model.runs))
        return VDNA_ERR_NONFINITE;
    for (uint32_t b = 0; b < trust->model.runs; b++) {
        const double intercept = trust->model.intercept[b];
        out_recall[b] =
            isnan(intercept)
                ? NAN
                : vdna_angle_recall(intercept +
                                    trust->model.slope * vdna_ln(nearest[b] / trust->own[b]));
    }
    return VDNA_OK;
}

/* see vdna/trust.h */
vdna_status vdna_trust_suit(const vdna_trust *trust, const double *nearest,
                            const double *confidence, double *out_suits)
{
    if (!trust || !nearest || !out_suits)
        return VDNA_ERR_ARG;
    const uint32_t runs = trust->model.runs;
    for (uint32_t b = 0; b < runs && confidence; b++)
        if (!is_from_to(confidence[b], 0, 1))
            return VDNA_ERR_ARG;
    if (!are_relative(nearest, runs))
        return VDNA_ERR_NONFINITE;
    double least = INFINITY;
    for (uint32_t b = 0; b < runs; b++) {
        const double relative = nearest[b] / trust->own[b];
        out_suits[b] = relative > 1e-6 ? relative : 1e-6;
        least = out_suits[b] < least ? out_suits[b] : least;
    }
    for (uint32_t b = 0; b < runs; b++) {
        const double likeness = least / out_suits[b];
        out_suits[b] = confidence ? (likeness + confidence[b]) / 2 : likeness;
    }
    return VDNA_OK;
}

static int is_recent(const vdna_trust *trust, int64_t time)
{
    return trust->time - time < MEMORY_FRAMES;
}

/* Gain at which a switch pays, without regard to the candidate. */
static double common_cost(const vdna_trust *trust)
{
    double cost = trust->switch_cost;
    for (uint32_t i = 0; i < RETURNS; i++)
        cost *= is_recent(trust, trust->returns[i]) ? 2 : 1;
    return cost;
}

static void switch_to(vdna_trust *trust, uint32_t candidate)
{
    if (is_recent(trust, trust->left[candidate]))
        trust->returns[trust->return_count++ % RETURNS] = trust->time;
    trust->left[trust->chosen] = trust->time;
    trust->chosen = candidate;
    for (uint32_t b = 0; b < trust->model.runs; b++)
        trust->gain[b] = 0;
}

/* see vdna/trust.h */
vdna_status vdna_trust_reconsider(vdna_trust *trust, const double *recall, uint32_t frames,
                                  uint32_t *out_choice)
{
    if (!trust || !trust->has_chosen || !recall || !is_from_to(frames, 1, 1e6) || !out_choice)
        return VDNA_ERR_ARG;
    for (uint32_t b = 0; b < trust->model.runs; b++)
        if (!is_known(recall[b], 1))
            return VDNA_ERR_ARG;

    const double cost = common_cost(trust), of_choice = recall[trust->chosen];
    uint32_t best = 0;
    double most = -INFINITY;
    for (uint32_t b = 0; b < trust->model.runs; b++) {
        /* NaN is not above 0, and nor is what the choice gains on itself. */
        const double gain = trust->gain[b] + frames * (recall[b] - of_choice - switch_slack);
        trust->gain[b] = gain > 0 ? gain : 0;
        const double over = trust->gain[b] - (is_recent(trust, trust->left[b]) ? 2 : 1) * cost;
        best = over > most ? b : best;
        most = over > most ? over : most;
    }
    if (most > 0)
        switch_to(trust, best);
    trust->time += frames;
    *out_choice = trust->chosen;
    return VDNA_OK;
}

/* ---- Accessors ---- */

/* see vdna/trust.h */
uint32_t vdna_trust_runs(const vdna_trust *trust)
{
    return trust ? trust->model.runs : 0;
}

/* see vdna/trust.h */
const vdna_trust_fit *vdna_trust_fitted(const vdna_trust *trust)
{
    return trust ? &trust->fit : NULL;
}

/* see vdna/trust.h */
const double *vdna_trust_intercepts(const vdna_trust *trust)
{
    return trust ? trust->model.intercept : NULL;
}

/* see vdna/trust.h */
const char *vdna_trust_reason_text(uint32_t reason)
{
    switch (reason) {
    case VDNA_TRUST_REASON_NO_TABLES:
        return "the map knows nothing about itself";
    case VDNA_TRUST_REASON_FEW_FRAMES:
        return "too few live frames";
    case VDNA_TRUST_REASON_UNLIKE:
        return "the live frames look like none of the experiences";
    case VDNA_TRUST_REASON_FEW_RUNS:
        return "fewer than 3 experiences are labelled";
    case VDNA_TRUST_REASON_NOT_LABELLED:
        return "this experience is not labelled";
    case VDNA_TRUST_REASON_NO_DISTANCE:
        return "the distance of the live Visual DNA is not known";
    default:
        return "";
    }
}
