#include "eval/precision_change.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>

#include "eval/placing.hpp"

namespace vdna::eval
{

namespace
{

Spread spread_of(std::vector<double> values)
{
    if (values.empty())
        return {};
    std::sort(values.begin(), values.end());
    const size_t half = values.size() / 2;
    const double median =
        values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
    return {median, values.back()};
}

// Sums over the elements of two embeddings.
struct Sums {
    double aa = 0, bb = 0, ab = 0, apart = 0;
};

Sums sums_of(const float *a, const float *b, uint32_t dim)
{
    Sums sums;
    for (uint32_t i = 0; i < dim; i++) {
        const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
        sums.aa += x * x;
        sums.bb += y * y;
        sums.ab += x * y;
        sums.apart += (x - y) * (x - y);
    }
    return sums;
}

// Pairs of references whose order differs between `a` and `b`.
uint32_t swaps_between(const std::vector<Place> &a, const std::vector<Place> &b)
{
    const auto place = [&](size_t reference) {
        return std::find_if(b.begin(), b.end(),
                            [&](const Place &p) { return p.reference == reference; });
    };
    uint32_t swaps = 0;
    for (size_t i = 0; i < a.size(); i++)
        for (size_t j = i + 1; j < a.size(); j++)
            swaps += place(a[j].reference) < place(a[i].reference) ? 1 : 0;
    return swaps;
}

double recall_in(const QueryResult &query, size_t reference)
{
    return std::find_if(query.pairs.begin(), query.pairs.end(),
                        [&](const PairResult &pair) { return pair.reference == reference; })
        ->outcome.recall[0];
}

QueryChange query_change(const Evaluation &a, const Evaluation &b, size_t query)
{
    const std::vector<Place> of_a = predicted_places(a, query, a.methods.front());
    const std::vector<Place> of_b = predicted_places(b, query, b.methods.front());
    const size_t first_a = of_a.front().reference, first_b = of_b.front().reference;
    return {a.queries[query].traversal,
            {first_a, first_b},
            {recall_in(a.queries[query], first_a), recall_in(b.queries[query], first_b)},
            swaps_between(of_a, of_b)};
}

double mean_recall(const Evaluation &evaluation)
{
    double sum = 0;
    size_t pairs = 0;
    for (const double recall : evaluation.recall)
        if (!std::isnan(recall)) {
            sum += recall;
            pairs++;
        }
    return sum / static_cast<double>(pairs);
}

} // namespace

EmbeddingChange embedding_change(const std::vector<Traversal> &a, const std::vector<Traversal> &b,
                                 uint32_t dim)
{
    std::vector<double> l2, cosine;
    for (size_t t = 0; t < a.size(); t++) {
        if (a[t].files != b[t].files)
            throw Error(a[t].name + ": one network gave no numbers for a picture that the other "
                                    "gave numbers for; leave it out");
        const std::vector<float> &of_a = a[t].recording.embeddings;
        const std::vector<float> &of_b = b[t].recording.embeddings;
        for (size_t i = 0; i < of_a.size(); i += dim) {
            const Sums sums = sums_of(&of_a[i], &of_b[i], dim);
            l2.push_back(100 * std::sqrt(sums.apart / sums.aa));
            cosine.push_back(1 - sums.ab / std::sqrt(sums.aa * sums.bb));
        }
    }
    return {l2.size(), spread_of(l2), spread_of(cosine)};
}

RankingChange ranking_change(const Evaluation &a, const Evaluation &b)
{
    RankingChange change{};
    const std::vector<double> &of_a = a.methods.front().distance;
    const std::vector<double> &of_b = b.methods.front().distance;
    std::vector<double> emd;
    for (size_t cell = 0; cell < of_a.size(); cell++)
        if (!std::isnan(of_a[cell]))
            emd.push_back(100 * std::abs(of_b[cell] - of_a[cell]) / of_a[cell]);
    change.pairs = static_cast<uint32_t>(emd.size());
    change.emd_percent = spread_of(emd);
    for (size_t q = 0; q < a.queries.size(); q++)
        change.queries.push_back(query_change(a, b, q));
    change.recall = {mean_recall(a), mean_recall(b)};
    return change;
}

} // namespace vdna::eval
