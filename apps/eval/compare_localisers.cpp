#include "eval/compare_localisers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>

#include "eval/placing.hpp"
#include "eval/reference_maps.hpp"
#include "program/progress.hpp"
#include "record/truth.hpp"

namespace vdna::eval
{

namespace
{

constexpr double no_pair = std::numeric_limits<double>::quiet_NaN();

size_t column_of(const Evaluation &evaluation, size_t reference)
{
    const auto &references = evaluation.references;
    return static_cast<size_t>(std::find(references.begin(), references.end(), reference) -
                               references.begin());
}

// One localiser on all queries.
class Run
{
  public:
    Run(const Evaluation &evaluation, const Localiser &by) : evaluation_(evaluation), by_(by)
    {
        result_.name = by.key;
        result_.in_each = by.map == MapKind::each;
        const size_t columns = result_.in_each ? evaluation.references.size() : 1;
        result_.recall.assign(evaluation.queries.size() * columns, no_pair);
    }

    void localise(size_t q)
    {
        const QueryResult &query = evaluation_.queries[q];
        if (result_.in_each)
            for (const PairResult &pair : query.pairs)
                result_.recall[q * evaluation_.references.size() +
                               column_of(evaluation_, pair.reference)] =
                    recall_in_pair(query, pair);
        else
            result_.recall[q] = recall_in_all(query);
    }

    LocaliserResult result()
    {
        std::vector<double> means, chosen;
        for (size_t q = 0; q < evaluation_.queries.size(); q++) {
            means.push_back(mean_over_references(evaluation_, result_, q));
            chosen.push_back(recall_in_first_choice(q));
        }
        result_.mean = mean_with_interval(means);
        result_.chosen = mean_with_interval(chosen);
        if (!judged_.empty())
            result_.confidence = judge_confidence(judged_);
        return std::move(result_);
    }

  private:
    const record::Recording &recording(size_t traversal) const
    {
        return (*evaluation_.traversals)[traversal].recording;
    }

    // The nearest frames are known: the ranking is judged by them.
    bool is_known() const { return by_.find == nearest && by_.map != MapKind::fused; }

    double recall_in_pair(const QueryResult &query, const PairResult &pair)
    {
        return is_known() ? pair.outcome.recall[0] : recall_in(query, recording(pair.reference));
    }

    double recall_in_all(const QueryResult &query)
    {
        if (is_known())
            return query.all.recall[0];
        std::vector<const record::Recording *> parts;
        for (const PairResult &pair : query.pairs)
            parts.push_back(&recording(pair.reference));
        const uint32_t dim = evaluation_.backbone.identity.dim;
        return recall_in(query, by_.map == MapKind::fused ? fused(parts, dim, evaluation_.tolerance,
                                                                  evaluation_.with_altitude)
                                                          : joined(parts, dim));
    }

    double recall_in(const QueryResult &query, const record::Recording &map)
    {
        const uint32_t dim = evaluation_.backbone.identity.dim;
        if (map.frames == 0)
            throw Error(std::string(by_.key) + ": no reference of " +
                        (*evaluation_.traversals)[query.traversal].name +
                        " has a frame with ground truth, which tells frames of one place; leave " +
                        by_.key + " out of --localisers");
        const record::Recording live =
            record::projected(recording(query.traversal), query.projection);
        const record::Recording kept = record::projected(map, query.projection);
        vdna_experience experience = map_of(kept, dim);
        query.projection.set_in(experience.identity);
        const Drive drive = {live,       query.warmup_begin,      query.warmup_frames,
                             query.live, experience.identity.dim, evaluation_.tolerance};
        return recall_of(by_.find(drive, experience), drive, experience, evaluation_, judged_);
    }

    double recall_in_first_choice(size_t q) const
    {
        if (!result_.in_each)
            return result_.recall[q];
        const size_t choice =
            predicted_places(evaluation_, q, evaluation_.methods.front()).front().reference;
        return result_.recall[q * evaluation_.references.size() + column_of(evaluation_, choice)];
    }

    const Evaluation &evaluation_;
    const Localiser &by_;
    LocaliserResult result_;
    std::vector<JudgedAnswer> judged_; // answers with a confidence, of all queries
};

} // namespace

double recall_of(const std::vector<Answer> &answers, const Drive &drive, const vdna_experience &map,
                 const Evaluation &evaluation, std::vector<JudgedAnswer> &out_judged)
{
    const record::Truth truth(drive.recording, map, evaluation.with_altitude);
    uint32_t judged = 0, right = 0;
    for (size_t i = 0; i < answers.size(); i++) {
        if (!truth.knows(drive.live[i]))
            continue;
        const bool good = truth.apart(drive.live[i], answers[i].frame) <= evaluation.tolerance;
        judged++;
        right += good;
        if (answers[i].confidence)
            out_judged.push_back({*answers[i].confidence, good});
    }
    return 100.0 * right / judged;
}

double mean_over_references(const Evaluation &evaluation, const LocaliserResult &result,
                            size_t query)
{
    if (!result.in_each)
        return result.recall[query];
    const size_t columns = evaluation.references.size();
    double sum = 0;
    for (size_t column = 0; column < columns; column++)
        if (!std::isnan(result.recall[query * columns + column]))
            sum += result.recall[query * columns + column];
    return sum / static_cast<double>(evaluation.queries[query].pairs.size());
}

std::vector<LocaliserResult> compare_localisers(const Evaluation &evaluation,
                                                const std::vector<std::string> &keys)
{
    for (const std::string &key : keys)
        localiser_of(key);
    program::Progress progress("comparing localisers", keys.size() * evaluation.queries.size());
    std::vector<LocaliserResult> results;
    for (const Localiser &by : localisers) {
        if (std::find(keys.begin(), keys.end(), by.key) == keys.end())
            continue;
        Run run(evaluation, by);
        for (size_t query = 0; query < evaluation.queries.size(); query++) {
            run.localise(query);
            progress.advance();
        }
        results.push_back(run.result());
    }
    return results;
}

} // namespace vdna::eval
