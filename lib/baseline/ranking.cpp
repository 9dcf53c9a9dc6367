#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <vector>

#include <vdna/baseline.h>

namespace
{

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

using Numbers = std::vector<double>;

// The pairs of one query that take part.
struct Query {
    Numbers recall, distance; // distance is empty for a random ranking

    size_t size() const { return recall.size(); }
};

std::vector<Query> queries_of(const vdna_ranking_table &table)
{
    std::vector<Query> queries;
    for (size_t q = 0; q < table.queries; q++) {
        Query query;
        for (size_t r = 0; r < table.references; r++) {
            const size_t cell = q * table.references + r;
            if (std::isnan(table.recall[cell]))
                continue;
            query.recall.push_back(table.recall[cell]);
            if (table.distance)
                query.distance.push_back(table.distance[cell]);
        }
        if (query.size() > 0)
            queries.push_back(std::move(query));
    }
    return queries;
}

// Whether the recalls tell a better reference from a worse one. Recalls are quotients of counts, so
// those that differ do so by far more than rounding.
bool ranks(const Query &query)
{
    const auto [least, most] = std::minmax_element(query.recall.begin(), query.recall.end());
    return *most - *least > 1e-9;
}

bool all_finite(const Numbers &values)
{
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// Indices in ascending order of `key`; equal ones keep their order.
std::vector<size_t> order_by(const Numbers &key)
{
    std::vector<size_t> order(key.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return key[a] < key[b]; });
    return order;
}

std::vector<size_t> true_order(const Query &query)
{
    Numbers loss;
    for (double recall : query.recall)
        loss.push_back(-recall);
    return order_by(loss);
}

// Each unordered pair that is confused at some rank, once.
double swap_once(const Query &query)
{
    const auto truth = true_order(query), predicted = order_by(query.distance);
    std::vector<std::pair<size_t, size_t>> confused;
    for (size_t rank = 0; rank < truth.size(); rank++)
        if (truth[rank] != predicted[rank])
            confused.push_back(std::minmax({truth[rank], predicted[rank]}));
    std::sort(confused.begin(), confused.end());
    confused.erase(std::unique(confused.begin(), confused.end()), confused.end());

    double sum = 0;
    for (const auto &[a, b] : confused)
        sum += std::fabs(query.recall[a] - query.recall[b]);
    return sum;
}

double half_l1(const Query &query)
{
    const auto truth = true_order(query), predicted = order_by(query.distance);
    double sum = 0;
    for (size_t rank = 0; rank < truth.size(); rank++)
        sum += std::fabs(query.recall[predicted[rank]] - query.recall[truth[rank]]) / 2;
    return sum;
}

double best(const Query &query)
{
    return *std::max_element(query.recall.begin(), query.recall.end());
}

double regret(const Query &query)
{
    return best(query) - query.recall[order_by(query.distance).front()];
}

// The sum of |R_a - R_b| over all unordered pairs.
double spread(const Query &query)
{
    double sum = 0;
    for (size_t a = 0; a < query.size(); a++)
        for (size_t b = 0; b < a; b++)
            sum += std::fabs(query.recall[a] - query.recall[b]);
    return sum;
}

// A random permutation puts b at a's rank with probability 1/K, a at b's with 1/K, and does both
// with 1/(K(K-1)).
double random_swap_once(const Query &query)
{
    const double k = double(query.size()); // >= 2, because it ranks
    return spread(query) * (2 / k - 1 / (k * (k - 1)));
}

// At each rank every candidate is as likely: each unordered pair occurs twice among K^2.
double random_half_l1(const Query &query)
{
    return spread(query) / double(query.size());
}

double random_regret(const Query &query)
{
    const double sum = std::accumulate(query.recall.begin(), query.recall.end(), 0.0);
    return best(query) - sum / double(query.size());
}

int sign(double x)
{
    return (x > 0) - (x < 0);
}

// tau-b of "nearer" against "better"; undefined if one of them is all ties.
double kendall_tau(const Query &query)
{
    double agreement = 0, distance_pairs = 0, recall_pairs = 0;
    for (size_t a = 0; a < query.size(); a++)
        for (size_t b = 0; b < a; b++) {
            const int nearer = sign(query.distance[b] - query.distance[a]);
            const int better = sign(query.recall[a] - query.recall[b]);
            agreement += nearer * better;
            distance_pairs += nearer * nearer;
            recall_pairs += better * better;
        }
    const double scale = std::sqrt(distance_pairs * recall_pairs);
    return scale > 0 ? agreement / scale : undefined;
}

// Correlation coefficient; undefined if one side is constant.
double pearson(const Numbers &x, const Numbers &y)
{
    const double n = double(x.size());
    const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
    const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / n;
    double xx = 0, yy = 0, xy = 0;
    for (size_t i = 0; i < x.size(); i++) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        yy += (y[i] - mean_y) * (y[i] - mean_y);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    const double scale = std::sqrt(xx) * std::sqrt(yy);
    // Rounding may carry the quotient beyond what a correlation can be.
    return scale > 0 ? std::clamp(xy / scale, -1.0, 1.0) : undefined;
}

// Ranks from 1; equal values share the mean of their ranks.
Numbers ranks_of(const Numbers &values)
{
    const auto order = order_by(values);
    Numbers ranks(values.size());
    for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && values[order[end]] == values[order[begin]])
            end++;
        for (size_t i = begin; i < end; i++)
            ranks[order[i]] = double(begin + 1 + end) / 2;
    }
    return ranks;
}

double spearman(const Numbers &x, const Numbers &y)
{
    return pearson(ranks_of(x), ranks_of(y));
}

// The mean of `metric` over the queries for which it is defined.
template <typename Metric>
double mean_over(const std::vector<Query> &queries, Metric metric)
{
    double sum = 0;
    size_t defined = 0;
    for (const Query &query : queries) {
        const double value = metric(query);
        if (std::isnan(value))
            continue;
        sum += value;
        defined++;
    }
    return defined > 0 ? sum / double(defined) : undefined;
}

// The sum of `error` over the queries, divided by the number of pairs.
template <typename Error>
double per_pair(const std::vector<Query> &queries, Error error)
{
    double sum = 0;
    size_t pairs = 0;
    for (const Query &query : queries) {
        sum += error(query);
        pairs += query.size();
    }
    return sum / double(pairs);
}

Query pooled(const std::vector<Query> &queries)
{
    Query all;
    for (const Query &query : queries) {
        all.recall.insert(all.recall.end(), query.recall.begin(), query.recall.end());
        all.distance.insert(all.distance.end(), query.distance.begin(), query.distance.end());
    }
    return all;
}

vdna_ranking_metrics nothing_to_judge()
{
    return {undefined, undefined, undefined, undefined, undefined,
            undefined, undefined, undefined, 0,         0};
}

vdna_ranking_metrics judge_random(const std::vector<Query> &queries)
{
    vdna_ranking_metrics m{};
    m.ranking_error_swap_once = per_pair(queries, random_swap_once);
    m.ranking_error_half_l1 = per_pair(queries, random_half_l1);
    m.regret = mean_over(queries, random_regret);
    // Every permutation is as likely as its reverse: no correlation, by symmetry.
    return m;
}

vdna_ranking_metrics judge(const std::vector<Query> &queries)
{
    const auto pearson_of = [](const Query &q) { return pearson(q.distance, q.recall); };
    const auto spearman_of = [](const Query &q) { return spearman(q.distance, q.recall); };
    const Query all = pooled(queries);
    vdna_ranking_metrics m{};
    m.ranking_error_swap_once = per_pair(queries, swap_once);
    m.ranking_error_half_l1 = per_pair(queries, half_l1);
    m.regret = mean_over(queries, regret);
    m.kendall_tau = mean_over(queries, kendall_tau);
    m.pearson_within = mean_over(queries, pearson_of);
    m.spearman_within = mean_over(queries, spearman_of);
    m.pearson_pooled = pearson_of(all);
    m.spearman_pooled = spearman_of(all);
    return m;
}

} // namespace

// see vdna/baseline.h
vdna_status vdna_judge_ranking(const vdna_ranking_table *table, vdna_ranking_metrics *out_metrics)
try {
    if (!table || !table->recall || table->queries == 0 || table->references == 0 || !out_metrics)
        return VDNA_ERR_ARG;
    std::vector<Query> queries = queries_of(*table);
    if (queries.empty())
        return VDNA_ERR_EMPTY;
    for (const Query &query : queries)
        if (!all_finite(query.recall) || !all_finite(query.distance))
            return VDNA_ERR_NONFINITE;
    const auto end = std::stable_partition(queries.begin(), queries.end(), ranks);
    const auto left_out = static_cast<uint32_t>(queries.end() - end);
    queries.erase(end, queries.end());
    *out_metrics = queries.empty()   ? nothing_to_judge()
                   : table->distance ? judge(queries)
                                     : judge_random(queries);
    out_metrics->queries = static_cast<uint32_t>(queries.size());
    out_metrics->left_out = left_out;
    return VDNA_OK;
} catch (const std::bad_alloc &) {
    return VDNA_ERR_NOMEM;
}
