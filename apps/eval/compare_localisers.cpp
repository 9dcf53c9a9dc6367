#include "eval/compare_localisers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>

#include "eval/bayesian_fusion.hpp"
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

// Collects the answers that make a score.
class Scoring
{
  public:
    // One query, in one map or in several.
    void add(double recall, const std::vector<Judgement> &judgements)
    {
        uint32_t off_route = 0, answered = 0;
        for (const Judgement &judgement : judgements) {
            off_route += judgement.off_route;
            answered += judgement.off_route_answered;
            confident_.insert(confident_.end(), judgement.confident.begin(),
                              judgement.confident.end());
        }
        recall_.push_back(recall);
        if (off_route > 0)
            off_route_percent_.push_back(100.0 * answered / off_route);
    }

    LocaliserScore score() const
    {
        LocaliserScore score{mean_with_interval(recall_), {}, {}};
        if (confident_.empty())
            return score;
        score.confidence = judge_confidence(confident_);
        if (!off_route_percent_.empty())
            score.off_route = mean_with_interval(off_route_percent_);
        return score;
    }

  private:
    std::vector<double> recall_; // [queries]
    std::vector<JudgedAnswer> confident_;
    std::vector<double> off_route_percent_; // [queries with frames off the route]
};

// One localiser on all queries.
class Run
{
  public:
    Run(const Evaluation &evaluation, const Localiser &by, const DriveKind &drive)
        : evaluation_(evaluation), by_(by), kind_(drive), dim_(evaluation.backbone.identity.dim)
    {
        result_.name = by.key;
        result_.drive = drive.key;
        result_.in_each = by.map == MapKind::each;
        const size_t columns = result_.in_each ? evaluation.references.size() : 1;
        result_.recall.assign(evaluation.queries.size() * columns, no_pair);
    }

    void localise(size_t q)
    {
        const QueryResult &query = evaluation_.queries[q];
        if (is_known())
            copy_known(q);
        else
            localise(q, drive_through(kind_, query, recording(query.traversal), dim_,
                                      evaluation_.stride, static_cast<uint32_t>(q + 1)));
    }

    LocaliserResult result()
    {
        result_.mean = mean_.score();
        result_.chosen = chosen_.score();
        return std::move(result_);
    }

  private:
    const Traversal &traversal(size_t index) const { return (*evaluation_.traversals)[index]; }
    const record::Recording &recording(size_t index) const { return traversal(index).recording; }

    // The nearest frames are known: the ranking is judged by them.
    bool is_known() const
    {
        return by_.find == nearest && by_.map != MapKind::fused && &kind_ == &drive_kinds.front();
    }

    double &recall(size_t q, size_t reference)
    {
        return result_.in_each ? result_.recall[q * evaluation_.references.size() +
                                                column_of(evaluation_, reference)]
                               : result_.recall[q];
    }

    void copy_known(size_t q)
    {
        const QueryResult &query = evaluation_.queries[q];
        for (const PairResult &pair : query.pairs)
            recall(q, pair.reference) = (result_.in_each ? pair.outcome : query.all).recall[0];
        mean_.add(mean_over_references(evaluation_, result_, q), {});
        chosen_.add(recall(q, ranked_references(q).front()), {});
    }

    // Nearest by Visual DNA first.
    std::vector<size_t> ranked_references(size_t q) const
    {
        std::vector<size_t> ranked;
        for (const Place &place : predicted_places(evaluation_, q, evaluation_.methods.front()))
            ranked.push_back(place.reference);
        return ranked;
    }

    // The references of each map to localise in.
    std::vector<std::vector<size_t>> maps_of(size_t q) const
    {
        std::vector<size_t> ranked = ranked_references(q), all;
        if (by_.map == MapKind::top) {
            if (by_.top > 0)
                ranked.resize(std::min<size_t>(by_.top, ranked.size()));
            return {ranked};
        }
        std::vector<std::vector<size_t>> each;
        for (const PairResult &pair : evaluation_.queries[q].pairs) {
            each.push_back({pair.reference});
            all.push_back(pair.reference);
        }
        return result_.in_each ? each : std::vector<std::vector<size_t>>{all};
    }

    void localise(size_t q, const DrivenQuery &driven)
    {
        const QueryResult &query = evaluation_.queries[q];
        const size_t choice = ranked_references(q).front();
        std::vector<Judgement> found, found_in_choice;
        for (const std::vector<size_t> &references : maps_of(q)) {
            found.push_back(localise_in(references, query, driven));
            if (found.back().on_route == 0)
                throw Error(kind_.key + (": no frame of " + traversal(query.traversal).name) +
                            " on the route has ground truth; leave the drive out of --drives");
            recall(q, references.front()) = 100.0 * found.back().good / found.back().on_route;
            if (!result_.in_each || references.front() == choice)
                found_in_choice.push_back(found.back());
        }
        mean_.add(mean_over_references(evaluation_, result_, q), found);
        chosen_.add(recall(q, choice), found_in_choice);
    }

    Judgement localise_in(const std::vector<size_t> &references, const QueryResult &query,
                          const DrivenQuery &driven) const
    {
        std::vector<record::Recording> parts;
        for (const size_t reference : references)
            parts.push_back(part_of(reference, query, driven));
        if (by_.map == MapKind::fused_centred)
            give_one_mean(parts, dim_);
        const record::Recording map = map_of_parts(parts);
        if (map.frames == 0)
            throw Error(std::string(by_.key) + ": no reference of " +
                        traversal(query.traversal).name +
                        " has a frame with ground truth, which tells frames of one place; leave " +
                        by_.key + " out of --localisers");
        const record::Recording live = record::projected(driven.recording, query.projection);
        const record::Recording kept = record::projected(map, query.projection);
        const vdna_experience experience = experience_of(kept, query);
        const Drive drive = {live,
                             0,
                             query.warmup_frames,
                             driven.live,
                             experience.identity.dim,
                             evaluation_.tolerance};
        return judge(find(drive, experience, parts, map, query), driven, experience, evaluation_);
    }

    std::vector<Answer> find(const Drive &drive, const vdna_experience &experience,
                             const std::vector<record::Recording> &parts,
                             const record::Recording &map, const QueryResult &query) const
    {
        if (by_.map == MapKind::top)
            return find_in_each(drive, parts, query);
        if (by_.map == MapKind::likelihood)
            return find_most_likely(drive, parts, map, query);
        return by_.find(drive, experience);
    }

    // A map that keeps of embeddings what a map of all references would.
    vdna_experience experience_of(const record::Recording &kept, const QueryResult &query) const
    {
        vdna_experience experience = map_of(kept, dim_);
        query.projection.set_in(experience.identity);
        return experience;
    }

    record::Recording map_of_parts(const std::vector<record::Recording> &parts) const
    {
        std::vector<const record::Recording *> borrowed;
        for (const record::Recording &part : parts)
            borrowed.push_back(&part);
        const bool has_places = by_.map == MapKind::fused || by_.map == MapKind::fused_centred ||
                                by_.map == MapKind::likelihood;
        return has_places ? fused(borrowed, dim_, evaluation_.tolerance, evaluation_.with_altitude)
                          : joined(borrowed, dim_);
    }

    // What the drive leaves of a reference.
    record::Recording part_of(size_t reference, const QueryResult &query,
                              const DrivenQuery &driven) const
    {
        record::Recording part = without_off_route(
            recording(reference), driven, dim_, evaluation_.tolerance, evaluation_.with_altitude);
        if (part.frames == 0)
            throw Error(kind_.key + (": no frame of " + traversal(reference).name) +
                        " is beyond the tolerance of the places of " +
                        traversal(query.traversal).name +
                        " off the route; set a lower --tolerance, or leave the drive out of "
                        "--drives");
        return part;
    }

    std::vector<Answer> find_in_each(const Drive &drive,
                                     const std::vector<record::Recording> &parts,
                                     const QueryResult &query) const
    {
        std::vector<std::vector<Answer>> answers;
        std::vector<uint32_t> frames;
        for (const record::Recording &part : parts) {
            const record::Recording kept = record::projected(part, query.projection);
            answers.push_back(by_.find(drive, experience_of(kept, query)));
            frames.push_back(part.frames);
        }
        return most_confident(answers, frames);
    }

    std::vector<Answer> find_most_likely(const Drive &drive,
                                         const std::vector<record::Recording> &parts,
                                         const record::Recording &places,
                                         const QueryResult &query) const
    {
        std::vector<record::Recording> kept;
        for (const record::Recording &part : parts)
            kept.push_back(record::projected(part, query.projection));
        std::vector<Reference> references;
        for (const record::Recording &part : kept)
            references.push_back(
                {experience_of(part, query),
                 frames_at(places, part, evaluation_.tolerance, evaluation_.with_altitude)});
        return most_likely(drive, references);
    }

    const Evaluation &evaluation_;
    const Localiser &by_;
    const DriveKind &kind_;
    uint32_t dim_;
    LocaliserResult result_;
    Scoring mean_, chosen_;
};

} // namespace

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

Judgement judge(const std::vector<Answer> &answers, const DrivenQuery &driven,
                const vdna_experience &map, const Evaluation &evaluation)
{
    const record::Truth truth(driven.recording, map, evaluation.with_altitude);
    Judgement judgement;
    for (size_t i = 0; i < answers.size(); i++) {
        const uint32_t live = driven.live[i];
        const std::optional<double> &confidence = answers[i].confidence;
        if (!truth.knows(live))
            continue;
        if (driven.off_route[live]) {
            judgement.off_route++;
            judgement.off_route_answered += confidence >= usual_min_confidence;
            continue;
        }
        const bool good = truth.apart(live, answers[i].frame) <= evaluation.tolerance;
        judgement.on_route++;
        judgement.good += good;
        if (confidence)
            judgement.confident.push_back({*confidence, good});
    }
    return judgement;
}

std::vector<LocaliserResult> compare_localisers(const Evaluation &evaluation,
                                                const std::vector<std::string> &keys,
                                                const DriveKind &drive)
{
    for (const std::string &key : keys)
        localiser_of(key);
    program::Progress progress("comparing localisers, drive " + std::string(drive.key),
                               keys.size() * evaluation.queries.size());
    std::vector<LocaliserResult> results;
    for (const Localiser &by : localisers) {
        if (std::find(keys.begin(), keys.end(), by.key) == keys.end())
            continue;
        Run run(evaluation, by, drive);
        for (size_t query = 0; query < evaluation.queries.size(); query++) {
            run.localise(query);
            progress.advance();
        }
        results.push_back(run.result());
    }
    return results;
}

} // namespace vdna::eval
