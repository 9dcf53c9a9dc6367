#include "trust_model.h"

#include <math.h>

#include "elementary.h"
#include "recall_angle.h"

static const double bandwidth = 0.25, pair_spread = 0.2; /* of the distances */
static const double prior_runs = 2;                      /* weight of V, in runs */
static const double window_sd = 0.1;

/* 0.9 quantiles of Student's t for 1, 2, ... degrees of freedom: 80 % lie between -t and t. */
static const double quantiles[] = {
    3.078, 1.886, 1.638, 1.533, 1.476, 1.440, 1.415, 1.397, 1.383, 1.372,
    1.363, 1.356, 1.350, 1.345, 1.341, 1.337, 1.333, 1.330, 1.328, 1.325,
    1.323, 1.321, 1.319, 1.318, 1.316, 1.315, 1.314, 1.313, 1.311, 1.310,
};

/* Fit of some of the labelled runs. */
typedef struct part {
    const uint32_t *ids; /* [count] */
    uint32_t count;      /* >= 2 */
    double slope, variance, spread;
    double *intercept; /* [count] */
    double *mean_y;    /* [count], of each column */
} part;

/* see trust_model.h */
uint32_t vdna_largest_of(const double *values, uint32_t count)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++)
        best = values[i] > values[best] ? i : best;
    return best;
}

/* ---- Reading the tables ---- */

static const vdna_trust_cell *cell_of(const vdna_trust_tables *tables, uint32_t runs, uint32_t a,
                                      uint32_t b)
{
    return &tables->cells[(size_t)a * runs + b];
}

static int lacks_truth(const vdna_trust_tables *tables, uint32_t runs, uint32_t a, uint32_t b)
{
    const vdna_trust_cell *cell = cell_of(tables, runs, a, b);
    const uint32_t windows = vdna_trust_windows(tables->frames[a], NULL, NULL);
    int lacking = 0;
    for (uint32_t i = 0; i < windows; i++)
        lacking |= !isfinite(cell->recall[i]) | !isfinite(cell->distance[i]);
    return lacking;
}

/* Cells of two runs, in either direction, that lack something. */
static uint32_t lacking_cells(const vdna_trust_tables *tables, uint32_t runs, uint32_t a,
                              uint32_t b)
{
    return (uint32_t)lacks_truth(tables, runs, a, b) + (uint32_t)lacks_truth(tables, runs, b, a);
}

/* Leave runs out until no cell is lacking.
 * @param ids      [runs], of which the labelled are written
 * @param lacking  [runs], working memory
 * @return labelled runs */
static uint32_t find_labelled(const vdna_trust_tables *tables, uint32_t runs, uint32_t *ids,
                              uint32_t *lacking)
{
    for (uint32_t i = 0; i < runs; i++) {
        ids[i] = i;
        lacking[i] = 0;
        for (uint32_t j = 0; j < runs; j++)
            lacking[i] += i == j ? 0 : lacking_cells(tables, runs, i, j);
    }
    for (uint32_t count = runs;;) {
        uint32_t worst = 0;
        for (uint32_t i = 1; i < count; i++)
            worst = lacking[ids[i]] >= lacking[ids[worst]] ? i : worst;
        const uint32_t out = ids[worst];
        if (lacking[out] == 0)
            return count > 1 ? count : 0;
        count--;
        for (uint32_t i = worst; i < count; i++)
            ids[i] = ids[i + 1];
        for (uint32_t i = 0; i < count; i++)
            lacking[ids[i]] -= lacking_cells(tables, runs, ids[i], out);
    }
}

/* x of a window. */
static double x_of(const vdna_trust_tables *tables, uint32_t runs, uint32_t a, uint32_t b,
                   uint32_t window)
{
    return vdna_ln(cell_of(tables, runs, a, b)->nearest[window] / tables->own_scale[b]);
}

/* Means over the windows of a run. */
static void take_means(vdna_trust_model *model, const vdna_trust_tables *tables, uint32_t a,
                       uint32_t b)
{
    const vdna_trust_cell *cell = cell_of(tables, model->runs, a, b);
    const uint32_t windows = vdna_trust_windows(tables->frames[a], NULL, NULL);
    const size_t at = (size_t)a * model->runs + b;
    double x = 0, y = 0, distance = 0;
    for (uint32_t i = 0; i < windows; i++) {
        x += x_of(tables, model->runs, a, b, i);
        y += vdna_recall_angle(cell->recall[i]);
        distance += cell->distance[i];
    }
    model->x[at] = x / windows;
    model->y[at] = y / windows;
    model->recall[at] = vdna_angle_recall(y / windows);
    model->distance[at] = distance / windows;
}

/* ---- Fitting ---- */

/* Bandwidth of the transfer: from the deviation of all distances of two runs. */
static double spread_of(const vdna_trust_model *model, const uint32_t *ids, uint32_t count)
{
    const double cells = (double)count * (count - 1);
    double sum = 0, squares = 0;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t j = 0; j < count; j++) {
                const double d = model->distance[(size_t)ids[i] * model->runs + ids[j]];
                if (i != j && pass)
                    squares += (d - sum / cells) * (d - sum / cells);
                else if (i != j)
                    sum += d;
            }
    const double spread = count > 2 ? vdna_sqrt(squares / cells) : pair_spread * sum / cells;
    return bandwidth * spread > 1e-12 ? bandwidth * spread : 1e-12;
}

/* Sums over the cells of a part. */
typedef struct cell_sums {
    double x, xx, xy;
} cell_sums;

/* Sums of a column, about its mean; writes the means of its x and y. */
static void add_column(const vdna_trust_model *model, const part *p, uint32_t column,
                       cell_sums *sums, double *out_mean_x)
{
    double x_sum = 0, y_sum = 0;
    for (uint32_t i = 0; i < p->count; i++)
        x_sum += i == column ? 0 : model->x[(size_t)p->ids[i] * model->runs + p->ids[column]];
    const double mean_x = x_sum / (p->count - 1);
    for (uint32_t i = 0; i < p->count; i++) {
        if (i == column)
            continue;
        const size_t at = (size_t)p->ids[i] * model->runs + p->ids[column];
        const double x = model->x[at] - mean_x;
        sums->xx += x * x;
        sums->xy += x * model->y[at];
        y_sum += model->y[at];
    }
    sums->x += x_sum;
    *out_mean_x = mean_x;
    p->mean_y[column] = y_sum / (p->count - 1);
}

/* Fit the labelled runs `p->ids`. */
static void fit_part(const vdna_trust_model *model, part *p)
{
    const vdna_trust_prior *prior = model->prior;
    const double runs = p->count, pair_var = prior->pair_sd * prior->pair_sd;
    const double slope_var = prior->slope_sd * prior->slope_sd;
    cell_sums sums = {0, 0, 0};
    for (uint32_t b = 0; b < p->count; b++)
        add_column(model, p, b, &sums, &p->intercept[b]);
    p->slope =
        (prior->slope / slope_var + sums.xy / pair_var) / (1 / slope_var + sums.xx / pair_var);

    double level = 0;
    for (uint32_t b = 0; b < p->count; b++) {
        p->intercept[b] = p->mean_y[b] - p->slope * p->intercept[b];
        level += p->intercept[b] / runs;
    }
    const double run_var = prior->run_sd * prior->run_sd;
    const double map_var = prior->intercept_sd * prior->intercept_sd;
    const double column_var = pair_var / (runs - 1), mean_var = (run_var + column_var) / runs;
    const double keep_map = map_var / (map_var + mean_var);
    const double keep_run = run_var / (run_var + column_var);
    const double expected =
        prior->intercept + (prior->slope - p->slope) * sums.x / (runs * (runs - 1));
    const double mean = expected + keep_map * (level - expected);
    for (uint32_t b = 0; b < p->count; b++)
        p->intercept[b] = mean + keep_run * (p->intercept[b] - mean);

    p->variance = prior->error_sd * prior->error_sd;
    if (prior->error_sd == 0)
        p->variance = (1 - keep_run) * run_var +
                      (1 - keep_run) * (1 - keep_run) * keep_map * mean_var + pair_var +
                      window_sd * window_sd;
    p->spread = spread_of(model, p->ids, p->count);
}

/* see trust_model.h */
void vdna_trust_transfer(const vdna_trust_model *model, const uint32_t *ids, uint32_t count,
                         double spread, const double *distance_bins, double *weights,
                         double *out_recall)
{
    double least = distance_bins[0], total = 0;
    for (uint32_t i = 1; i < count; i++)
        least = distance_bins[i] < least ? distance_bins[i] : least;
    for (uint32_t i = 0; i < count; i++) {
        weights[i] = vdna_exp((least - distance_bins[i]) / spread);
        total += weights[i];
    }
    for (uint32_t j = 0; j < count; j++) {
        double votes = 0;
        for (uint32_t i = 0; i < count; i++)
            votes +=
                weights[i] * (i == j ? 1 : model->recall[(size_t)ids[i] * model->runs + ids[j]]);
        out_recall[j] = votes / total;
    }
}

/* ---- Errors, each run being left out in turn ---- */

/* Errors of recall below this are none. */
static const double trust_rounding = 1e-9;

/* Sums over the runs. */
typedef struct errors {
    double ratio, ratio_best; /* squares over the variance expected; of the best alone */
    double off, off_means;    /* of recall; of the columns' means */
} errors;

/* Predict a window of the run that was left out.
 * @param guess  [count], angles */
static void guess_window(const vdna_trust_model *model, const vdna_trust_tables *tables,
                         const part *p, uint32_t live, uint32_t window, double *guess)
{
    double *const weights = model->work + 3 * (size_t)model->runs;
    double *const distances = model->work + 4 * (size_t)model->runs;
    const double share = model->prior->transfer_share;
    for (uint32_t i = 0; i < p->count; i++)
        distances[i] = cell_of(tables, model->runs, live, p->ids[i])->distance[window];
    vdna_trust_transfer(model, p->ids, p->count, p->spread, distances, weights, guess);
    for (uint32_t i = 0; i < p->count; i++)
        guess[i] = (1 - share) * (p->intercept[i] +
                                  p->slope * x_of(tables, model->runs, live, p->ids[i], window)) +
                   share * vdna_recall_angle(guess[i]);
}

static double size_of(double x)
{
    return x < 0 ? -x : x;
}

static void add_errors(const vdna_trust_model *model, const vdna_trust_tables *tables,
                       const part *p, uint32_t live, errors *sums)
{
    double *const guess = model->work + 2 * (size_t)model->runs;
    const uint32_t windows = vdna_trust_windows(tables->frames[live], NULL, NULL);
    const double all = (double)windows * p->count;
    for (uint32_t w = 0; w < windows; w++) {
        guess_window(model, tables, p, live, w, guess);
        const uint32_t best = vdna_largest_of(guess, p->count);
        for (uint32_t i = 0; i < p->count; i++) {
            const double recall = cell_of(tables, model->runs, live, p->ids[i])->recall[w];
            const double error = vdna_recall_angle(recall) - guess[i];
            const double ratio = error * error / p->variance;
            sums->ratio += ratio / all;
            sums->ratio_best += i == best ? ratio / windows : 0;
            sums->off += size_of(recall - vdna_angle_recall(guess[i])) / all;
            sums->off_means += size_of(recall - vdna_angle_recall(p->mean_y[i])) / all;
        }
    }
}

/* see trust_model.h */
void vdna_trust_model_fit(vdna_trust_model *model, const vdna_trust_tables *tables,
                          uint32_t *left_out, vdna_trust_fit *out_fit)
{
    const uint32_t labelled = find_labelled(tables, model->runs, model->ids, left_out);
    out_fit->labelled = model->labelled = labelled;
    for (uint32_t i = 0; i < labelled; i++)
        for (uint32_t j = 0; j < labelled; j++)
            if (i != j)
                take_means(model, tables, model->ids[i], model->ids[j]);
    if (labelled > 1)
        model->spread = spread_of(model, model->ids, labelled);
    if (labelled < VDNA_TRUST_RUNS_MIN)
        return;

    part p = {.ids = left_out,
              .count = labelled - 1,
              .intercept = model->work,
              .mean_y = model->work + model->runs};
    errors sums = {0, 0, 0, 0};
    for (uint32_t out = 0; out < labelled; out++) {
        for (uint32_t i = 0; i < p.count; i++)
            left_out[i] = model->ids[i < out ? i : i + 1];
        fit_part(model, &p);
        add_errors(model, tables, &p, model->ids[out], &sums);
    }
    p.ids = model->ids;
    p.count = labelled;
    fit_part(model, &p);
    for (uint32_t i = 0; i < labelled; i++)
        model->intercept[model->ids[i]] = p.intercept[i];
    const double weight = p.variance / (prior_runs + labelled);
    const double worse = sums.ratio_best > sums.ratio ? sums.ratio_best : sums.ratio;
    const uint32_t last = sizeof quantiles / sizeof *quantiles - 1;
    out_fit->slope = model->slope = p.slope;
    out_fit->sd = vdna_sqrt(weight * (prior_runs + sums.ratio));
    out_fit->sd_best = vdna_sqrt(weight * (prior_runs + worse));
    out_fit->quantile = quantiles[labelled < last ? labelled : last];
    out_fit->skill = sums.off_means > trust_rounding ? 1 - sums.off / sums.off_means : 0;
}
