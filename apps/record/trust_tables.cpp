#include "record/trust_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/histogram.hpp>
#include <vdna/cpp/trust.hpp>
#include <vdna/emd.h>
#include <vdna/int8.h>

#include "program/interrupt.hpp"
#include "program/progress.hpp"
#include "record/played_recall.hpp"
#include "record/truth.hpp"

namespace vdna::record
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// The Visual DNA of windows, one after the other, and its distances.
class Windows
{
  public:
    explicit Windows(Members experiences)
        : experiences_(std::move(experiences)),
          range_(experiences_[0]->identity.range,
                 experiences_[0]->identity.range + 2 * size_t{experiences_[0]->identity.neurons}),
          scratch_(vdna_emd_scratch_size(experiences_[0]->identity.neurons) / sizeof(int64_t) + 1)
    {
    }

    double distance(size_t run, uint32_t first, uint32_t frames, size_t candidate)
    {
        if (!window_ || run != run_ || first != first_ || (*window_)->frames != frames)
            count(run, first, frames);
        const vdna_hist_view live = window_->view();
        vdna_hist_view all{};
        vdna_experience_view(experiences_[candidate], &all);
        double distance = 0;
        require(vdna_emd_mean(&live, &all, scratch_.data(), scratch_.size() * sizeof(int64_t),
                              &distance),
                experiences_[candidate]->name);
        return distance;
    }

  private:
    void count(size_t run, uint32_t first, uint32_t frames)
    {
        const vdna_experience &e = *experiences_[run];
        const size_t dim = e.last_layer_dim;
        std::vector<float> decoded(dim);
        const vdna_activations tap = {decoded.data(), e.last_layer_dim, 1,
                                      VDNA_LAYOUT_SAMPLES_NEURONS};
        run_ = run;
        first_ = first;
        window_.emplace(range_, e.identity.bins);
        for (size_t f = first; f < size_t{first} + frames; f++) {
            vdna_int8_decode(e.last_layer + f * dim, dim, e.last_layer_scale[f], decoded.data());
            window_->add(&tap, 1, e.name);
        }
    }

    Members experiences_;
    std::vector<float> range_;
    std::vector<int64_t> scratch_;
    std::optional<Histogram> window_; // from frame first_ of run_ on
    size_t run_ = 0;
    uint32_t first_ = 0;
};

// An experience as a run, with positions on the ground.
struct Run {
    explicit Run(const vdna_experience &e)
        : name(e.name), position_frame(e.position_frame), fields(trust_run_of(e))
    {
        if (e.frame_position)
            ground = on_the_ground(e.frame_position, e.frames, position_frame == VDNA_FRAME_WGS84);
        fields.position = ground.empty() ? nullptr : ground.data();
    }
    Run(Run &&) = default;

    std::string name, position_frame;
    std::vector<double> ground;
    vdna_trust_run fields;
};

class TableMaker
{
  public:
    TableMaker(const Members &experiences, double tolerance, const WindowDistance &distance,
               const KnownTables &known)
        : experiences_(experiences), tolerance_(tolerance), distance_(distance), known_(known),
          localiser_(trust_localiser_of(*experiences.front())), row_(experiences.size())
    {
        for (const vdna_experience *experience : experiences)
            runs_.emplace_back(*experience);
        if (known.runs.size() >= VDNA_TRUST_RUNS_MIN)
            for (size_t k = 0; k < known.runs.size(); k++)
                row_[known.runs[k]] = k;
    }

    TrustTables tables()
    {
        const size_t count = runs_.size();
        program::Progress bar("playing each experience against the others", count);
        TrustTables made;
        vdna_trust_cell nothing{};
        for (double *numbers :
             {nothing.nearest, nothing.likeness, nothing.recall, nothing.distance})
            std::fill_n(numbers, VDNA_TRUST_WINDOWS, unknown);
        made.cells.assign(count * count, nothing);
        for (size_t a = 0; a < count; a++, bar.advance()) {
            made.frames.push_back(runs_[a].fields.frames);
            made.own_scale.push_back(row_[a] ? known_.tables.own_scale[*row_[a]] : own_scale(a));
            made.correlation.push_back(make_row(a, &made.cells[a * count]));
        }
        return made;
    }

  private:
    double own_scale(size_t a) const
    {
        double own = 1;
        require(vdna_trust_own_scale(&runs_[a].fields, tolerance_, &own), runs_[a].name);
        return own;
    }

    // Returns the correlation time.
    double make_row(size_t a, vdna_trust_cell *cells)
    {
        std::vector<double> relative; // [candidates][frames], of those that are not known
        std::vector<size_t> made;
        for (size_t b = 0; b < runs_.size(); b++) {
            if (b == a)
                continue;
            if (row_[a] && row_[b]) {
                cells[b] = known_.tables.cells[*row_[a] * known_.runs.size() + *row_[b]];
                continue;
            }
            program::require_not_interrupted();
            play(runs_[a], runs_[b], relative, cells[b]);
            play_on(*experiences_[a], *experiences_[b], cells[b]);
            made.push_back(b);
        }
        add_distances(a, made, cells);
        return row_[a] ? known_.tables.correlation[*row_[a]]
                       : correlation_of(relative, made.size(), runs_[a].fields.frames);
    }

    void play(const Run &live, const Run &candidate, std::vector<double> &relative,
              vdna_trust_cell &cell)
    {
        vdna_trust_run a = live.fields, b = candidate.fields;
        if (live.position_frame != candidate.position_frame)
            a.position = b.position = nullptr;
        const size_t before = relative.size();
        relative.resize(before + a.frames);
        scratch_.resize(vdna_trust_pair_scratch_size(&a, &b) / sizeof(double) + 1);
        require(vdna_trust_pair(&a, &b, tolerance_, localiser_, scratch_.data(),
                                scratch_.size() * sizeof(double), &relative[before], &cell),
                live.name + " in " + candidate.name);
    }

    // In place of the recall outside of each window, which knows the whole run's mean. What is not
    // known stays so.
    void play_on(const vdna_experience &live, const vdna_experience &candidate,
                 vdna_trust_cell &cell) const
    {
        const double recall = played_recall(live, candidate, tolerance_);
        for (double &of_window : cell.recall)
            if (!std::isnan(of_window) && !std::isnan(recall))
                of_window = recall;
    }

    void add_distances(size_t a, const std::vector<size_t> &candidates,
                       vdna_trust_cell *cells) const
    {
        uint32_t first[VDNA_TRUST_WINDOWS], frames = 0;
        const uint32_t windows = vdna_trust_windows(runs_[a].fields.frames, first, &frames);
        for (uint32_t i = 0; i < windows; i++)
            for (const size_t b : candidates)
                cells[b].distance[i] = distance_(a, first[i], frames, b);
    }

    static double correlation_of(const std::vector<double> &relative, size_t candidates,
                                 uint32_t frames)
    {
        double time = unknown;
        if (candidates == 0)
            return time;
        std::vector<double> pairs(candidates * candidates + 1);
        require(vdna_trust_correlation_time(relative.data(), static_cast<uint32_t>(candidates),
                                            frames, pairs.data(), &time),
                "correlation time");
        return time;
    }

    const Members &experiences_;
    double tolerance_;
    const WindowDistance &distance_;
    const KnownTables &known_;
    uint32_t localiser_;
    std::vector<std::optional<size_t>> row_; // of each run in the known tables
    std::vector<Run> runs_;
    std::vector<double> scratch_;
};

} // namespace

vdna_trust_tables TrustTables::view() const
{
    return {frames.data(), own_scale.data(), correlation.data(), cells.data()};
}

WindowDistance distance_of_codes(const Members &experiences)
{
    if (!std::all_of(experiences.begin(), experiences.end(), [](const vdna_experience *e) {
            return vdna_experience_counts_last_layer(e) != 0;
        }))
        return [](size_t, uint32_t, uint32_t, size_t) { return unknown; };
    const auto windows = std::make_shared<Windows>(experiences);
    return [windows](size_t run, uint32_t first, uint32_t frames, size_t candidate) {
        return windows->distance(run, first, frames, candidate);
    };
}

void require_few_for_tables(size_t experiences)
{
    if (experiences > VDNA_TRUST_RUNS_MAX)
        throw Error("the map has " + std::to_string(experiences) +
                    " experiences, expected at most " + std::to_string(VDNA_TRUST_RUNS_MAX) +
                    " for it to know itself; divide it");
}

TrustTables make_trust_tables(const Members &experiences, double tolerance,
                              const WindowDistance &distance, const KnownTables &known)
{
    require_few_for_tables(experiences.size());
    return TableMaker(experiences, tolerance, distance, known).tables();
}

} // namespace vdna::record
