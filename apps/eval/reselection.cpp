#include "eval/reselection.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/experience_localiser.hpp>
#include <vdna/cpp/trust.hpp>

#include "eval/filter.hpp"
#include "eval/reference_maps.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"
#include "record/truth.hpp"

namespace vdna::eval
{

namespace
{

// A frame of the drive after its warmup, followed in one reference.
struct Followed {
    bool judged, good, moving;
    double confidence;
    double nearest; // relative to the reference's own scale
};

struct Candidate {
    size_t traversal;
    std::vector<double> warmup;   // [warmup_frames], as Followed::nearest
    std::vector<Followed> frames; // after the warmup
};

// Several traversals, one after the other.
struct ChangingDrive {
    record::Recording recording;
    uint32_t warmup_frames;
    std::vector<uint32_t> changes; // frames after the warmup: where each traversal begins, and the
                                   // end
};

std::vector<std::string> names_in(const std::string &drive)
{
    std::vector<std::string> names(1);
    for (const char c : drive)
        if (c == '+')
            names.emplace_back();
        else
            names.back() += c;
    return names;
}

class Run
{
  public:
    Run(const Evaluation &evaluation, const std::string &drive)
        : evaluation_(evaluation), name_(drive)
    {
        for (const std::string &name : names_in(drive))
            traversals_.push_back(traversal_of(name));
        const auto query =
            std::find_if(evaluation.queries.begin(), evaluation.queries.end(),
                         [&](const QueryResult &q) { return q.traversal == traversals_.front(); });
        if (query == evaluation.queries.end())
            throw Error(drive + ": " + names_in(drive).front() +
                        " is no query, expected one: its warmup is that of the drive; name it in "
                        "--queries");
        query_ = &*query;
    }

    ReselectionResult result() const
    {
        const ChangingDrive drive = composed();
        std::vector<Candidate> candidates;
        for (const size_t reference : evaluation_.references)
            if (is_candidate(reference))
                candidates.push_back(follow(drive, reference));
        if (candidates.empty())
            throw Error(name_ + ": every reference is part of the drive, expected others");
        return judge(drive, candidates);
    }

  private:
    const Traversal &traversal(size_t index) const { return (*evaluation_.traversals)[index]; }

    size_t traversal_of(const std::string &name) const
    {
        const auto &all = *evaluation_.traversals;
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const Traversal &t) { return t.name == name; });
        if (found == all.end())
            throw Error(name_ + ": no traversal '" + name + "'");
        return static_cast<size_t>(found - all.begin());
    }

    bool is_candidate(size_t reference) const
    {
        return traversal(reference).group == traversal(traversals_.front()).group &&
               std::find(traversals_.begin(), traversals_.end(), reference) == traversals_.end();
    }

    uint32_t dim() const { return evaluation_.backbone.identity.dim; }

    // The frame of a traversal that was taken nearest to a frame of the first one; the same number
    // if that has no ground truth.
    uint32_t same_place(size_t other, uint32_t frame) const
    {
        const record::Recording &first = traversal(traversals_.front()).recording;
        const record::Recording &recording = traversal(other).recording;
        const record::Truth truth(first, map_of(recording, dim()), evaluation_.with_altitude);
        uint32_t nearest = std::min(frame, recording.frames - 1);
        for (uint32_t i = 0; i < recording.frames; i++)
            if (truth.apart(frame, i) < truth.apart(frame, nearest))
                nearest = i;
        return nearest;
    }

    ChangingDrive composed() const
    {
        const record::Recording &first = traversal(traversals_.front()).recording;
        const uint32_t warmup_end = query_->warmup_begin + query_->warmup_frames;
        const uint32_t length = first.frames - warmup_end;
        ChangingDrive drive{{}, query_->warmup_frames, {0}};
        for (uint32_t frame = query_->warmup_begin; frame < warmup_end; frame++)
            append(drive.recording, first, frame, dim());
        for (size_t part = 0; part < traversals_.size(); part++) {
            const auto boundary = [&](size_t number) {
                const auto past = static_cast<uint32_t>(length * number / traversals_.size());
                return same_place(traversals_[part], warmup_end + past - 1) + 1;
            };
            const uint32_t past = boundary(part + 1);
            for (uint32_t frame = boundary(part); frame < past; frame++)
                append(drive.recording, traversal(traversals_[part]).recording, frame, dim());
            drive.changes.push_back(drive.recording.frames - drive.warmup_frames);
        }
        drive.recording = record::projected(drive.recording, query_->projection);
        return drive;
    }

    vdna_experience experience_of(const record::Recording &kept) const
    {
        vdna_experience experience = map_of(kept, dim());
        query_->projection.set_in(experience.identity);
        return about_its_mean(experience);
    }

    static double own_scale(const vdna_experience &map, double tolerance)
    {
        vdna_trust_run run = trust_run_of(map);
        run.position = map.frame_position;
        double scale = 0;
        require(vdna_trust_own_scale(&run, tolerance, &scale), map.name);
        return scale;
    }

    Candidate follow(const ChangingDrive &drive, size_t reference) const
    {
        const record::Recording kept =
            record::projected(traversal(reference).recording, query_->projection);
        const vdna_experience map = experience_of(kept);
        const std::string &name = traversal(reference).name;
        const record::Truth truth(drive.recording, map, evaluation_.with_altitude);
        const double scale = own_scale(map, evaluation_.tolerance);
        const auto nearest = [&](uint32_t frame) {
            double relative = 0;
            require(vdna_trust_nearest(drive.recording.embedding(frame), map.embeddings,
                                       map.identity.dim, map.frames, &relative, nullptr),
                    name);
            return relative / scale;
        };
        Candidate candidate{reference, {}, {}};
        ExperienceLocaliser localiser(map, evaluation_.tolerance);
        localiser.warm_up(
            drive.warmup_frames, [&](uint32_t i) { return drive.recording.embedding(i); }, name);
        for (uint32_t frame = 0; frame < drive.warmup_frames; frame++)
            candidate.warmup.push_back(nearest(frame));
        for (uint32_t frame = drive.warmup_frames; frame < drive.recording.frames; frame++) {
            program::require_not_interrupted();
            vdna_localise_answer answer;
            require(vdna_localise_feed(localiser.get(), drive.recording.embedding(frame), &answer),
                    name);
            const bool good = truth.apart(frame, answer.frame) <= evaluation_.tolerance;
            candidate.frames.push_back(
                {truth.knows(frame), good, answer.moving != 0, answer.confidence, nearest(frame)});
        }
        return candidate;
    }

    ReselectionResult judge(const ChangingDrive &drive,
                            const std::vector<Candidate> &candidates) const;

    const Evaluation &evaluation_;
    std::string name_;
    std::vector<size_t> traversals_;
    const QueryResult *query_ = nullptr;
};

// Trust in the candidates, each frame of which has a number for each of them.
class Choice
{
  public:
    Choice(const std::vector<Candidate> &candidates, const std::string &drive)
        : candidates_(candidates), drive_(drive), row_(candidates.size()),
          block_(config_of(candidates.size()), drive)
    {
    }

    uint32_t of_warmup()
    {
        for (size_t frame = 0; frame < candidates_.front().warmup.size(); frame++)
            require(vdna_trust_feed(block_.get(),
                                    row([&](const Candidate &c) { return c.warmup[frame]; }),
                                    nullptr),
                    drive_);
        std::vector<vdna_trust_prediction> unused(candidates_.size());
        vdna_trust_answer answer;
        require(vdna_trust_predict(block_.get(), nullptr, unused.data(), &answer), drive_);
        require(vdna_trust_choose(block_.get(), answer.choice), drive_);
        return answer.choice;
    }

    // frame: after the warmup.
    uint32_t after(size_t frame)
    {
        std::vector<double> confidence, suits(candidates_.size());
        for (const Candidate &candidate : candidates_)
            confidence.push_back(candidate.frames[frame].confidence);
        require(vdna_trust_suit(block_.get(),
                                row([&](const Candidate &c) { return c.frames[frame].nearest; }),
                                confidence.data(), suits.data()),
                drive_);
        uint32_t choice = 0;
        require(vdna_trust_reconsider(block_.get(), suits.data(), 1, &choice), drive_);
        return choice;
    }

  private:
    static vdna_trust_config config_of(size_t runs)
    {
        vdna_trust_config config = trust_defaults();
        config.runs = static_cast<uint32_t>(runs);
        return config;
    }

    // Numbers made relative distances, 0..2, by a factor that all have in common.
    template <typename Number>
    const double *row(Number number)
    {
        double most = 2;
        for (size_t i = 0; i < candidates_.size(); i++)
            most = std::max(most, row_[i] = number(candidates_[i]));
        for (double &value : row_)
            value *= 2 / most;
        return row_.data();
    }

    const std::vector<Candidate> &candidates_;
    const std::string &drive_;
    std::vector<double> row_;
    TrustBlock block_;
};

// Judged frames from `begin` to before `end` that are good.
uint32_t good_in(const Candidate &candidate, size_t begin, size_t end)
{
    uint32_t good = 0;
    for (size_t frame = begin; frame < end; frame++)
        good += candidate.frames[frame].judged && candidate.frames[frame].good;
    return good;
}

ReselectionResult Run::judge(const ChangingDrive &drive,
                             const std::vector<Candidate> &candidates) const
{
    const size_t frames = candidates.front().frames.size();
    Choice choice(candidates, name_);
    uint32_t chosen = choice.of_warmup(), good = 0, judged = 0;
    ReselectionResult result{name_, {candidates[chosen].traversal}, {0}, drive.changes, {}, 0, 0,
                             0};
    const uint32_t never = good_in(candidates[chosen], 0, frames);
    for (size_t frame = 0; frame < frames; frame++) {
        const Followed &followed = candidates[chosen].frames[frame];
        judged += followed.judged;
        good += followed.judged && followed.good;
        const uint32_t next = followed.moving ? choice.after(frame) : chosen;
        if (next == chosen)
            continue;
        chosen = next;
        result.choices.push_back(candidates[chosen].traversal);
        result.since.push_back(static_cast<uint32_t>(frame) + 1);
        const auto change = std::upper_bound(drive.changes.begin(), drive.changes.end(), frame) - 1;
        if (*change > 0)
            result.delays.push_back(static_cast<uint32_t>(frame) - *change);
    }
    if (judged == 0)
        throw Error(name_ + ": no frame after the warmup has ground truth, expected labels");
    uint32_t best = 0;
    for (size_t part = 0; part + 1 < drive.changes.size(); part++) {
        uint32_t most = 0;
        for (const Candidate &candidate : candidates)
            most = std::max(most, good_in(candidate, drive.changes[part], drive.changes[part + 1]));
        best += most;
    }
    result.again = 100.0 * good / judged;
    result.never = 100.0 * never / judged;
    result.best = 100.0 * best / judged;
    return result;
}

} // namespace

Reselection choose_again(const Evaluation &evaluation, const std::vector<std::string> &drives)
{
    program::Progress progress("choosing again", drives.size());
    Reselection reselection{};
    std::vector<double> again, never, best, gain;
    for (const std::string &drive : drives) {
        reselection.drives.push_back(Run(evaluation, drive).result());
        const ReselectionResult &result = reselection.drives.back();
        again.push_back(result.again);
        never.push_back(result.never);
        best.push_back(result.best);
        gain.push_back(result.again - result.never);
        progress.advance();
    }
    reselection.again = mean_with_interval(again);
    reselection.never = mean_with_interval(never);
    reselection.best = mean_with_interval(best);
    reselection.gain = mean_with_interval(gain);
    return reselection;
}

} // namespace vdna::eval
