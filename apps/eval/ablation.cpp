#include "eval/ablation.hpp"

#include <algorithm>

namespace vdna::eval
{

namespace
{

AblationRow row_of(const std::string &value, const Evaluation &evaluation)
{
    AblationRow row{value, {}};
    for (const MethodResult &method : evaluation.methods)
        row.methods.push_back({method.name, {}, method.judged});
    return row;
}

std::vector<AblationRow> over_bins(Frames &frames, const EvaluationSettings &settings,
                                   const AblationPlan &plan)
{
    static const std::vector<uint32_t> usual = {10, 50, 100, 500, 1000};
    Binning binning(frames, settings.taps, plan.range_rule);
    std::vector<AblationRow> rows;
    for (const uint32_t bins : plan.bins.empty() ? usual : plan.bins) {
        EvaluationSettings changed = settings;
        changed.bins = bins;
        rows.push_back(row_of(std::to_string(bins), evaluate(frames, binning, changed)));
    }
    return rows;
}

// Those default lengths that leave a frame to localise in every traversal.
std::vector<std::string> usual_warmups(const std::vector<Traversal> &traversals)
{
    std::vector<std::string> lengths;
    for (const uint32_t frames : {5, 10, 25, 50, 100})
        if (std::all_of(traversals.begin(), traversals.end(),
                        [&](const Traversal &t) { return t.recording.frames > frames; }))
            lengths.push_back(std::to_string(frames));
    return lengths;
}

std::vector<AblationRow> over_warmup(Frames &frames, const EvaluationSettings &settings,
                                     const AblationPlan &plan)
{
    Binning binning(frames, settings.taps, plan.range_rule);
    std::vector<AblationRow> rows;
    for (const std::string &warmup :
         plan.warmup.empty() ? usual_warmups(frames.traversals()) : plan.warmup) {
        EvaluationSettings changed = settings;
        changed.warmup = warmup;
        rows.push_back(row_of(warmup, evaluate(frames, binning, changed)));
    }
    return rows;
}

// Each tap alone, then all taps of the settings together.
std::vector<AblationRow> over_taps(Frames &frames, const EvaluationSettings &settings,
                                   const AblationPlan &plan)
{
    std::vector<AblationRow> rows;
    const std::vector<Tap> taps = Binning(frames, settings.taps, plan.range_rule).taps();
    for (const Tap &tap : taps) {
        Binning binning(frames, {tap.name}, plan.range_rule);
        rows.push_back(row_of(tap.name, evaluate(frames, binning, settings)));
    }
    if (taps.size() > 1) {
        Binning binning(frames, settings.taps, plan.range_rule);
        rows.push_back(row_of("all of them", evaluate(frames, binning, settings)));
    }
    return rows;
}

std::vector<std::string> without(const std::vector<std::string> &names, const std::string &left_out)
{
    std::vector<std::string> others;
    std::copy_if(names.begin(), names.end(), std::back_inserter(others),
                 [&](const std::string &name) { return name != left_out; });
    return others;
}

std::vector<std::string> names_of(const std::vector<Traversal> &traversals,
                                  const std::vector<std::string> &picked)
{
    if (!picked.empty())
        return picked;
    std::vector<std::string> names;
    for (const Traversal &traversal : traversals)
        names.push_back(traversal.name);
    return names;
}

// Leave out one traversal at a time: it is neither a query nor in the map.
std::vector<AblationRow> over_traversals(Frames &frames, const EvaluationSettings &settings,
                                         const AblationPlan &plan)
{
    const std::vector<std::string> queries = names_of(frames.traversals(), settings.queries);
    const std::vector<std::string> references = names_of(frames.traversals(), settings.references);
    Binning binning(frames, settings.taps, plan.range_rule);
    std::vector<AblationRow> rows;
    for (const std::string &left_out : references) {
        EvaluationSettings changed = settings;
        changed.queries = without(queries, left_out);
        changed.references = without(references, left_out);
        if (changed.queries.empty() || changed.references.empty())
            continue; // an empty list would mean all
        rows.push_back(row_of(left_out, evaluate(frames, binning, changed)));
    }
    return rows;
}

} // namespace

const std::vector<std::string> ablation_kinds = {"bins", "warmup", "tap", "leave-one-out"};

Ablation ablate(Frames &frames, const EvaluationSettings &settings, const AblationPlan &plan)
{
    const auto rows = plan.kind == "bins"     ? over_bins
                      : plan.kind == "warmup" ? over_warmup
                      : plan.kind == "tap"    ? over_taps
                                              : over_traversals;
    return {plan.kind, rows(frames, settings, plan)};
}

} // namespace vdna::eval
