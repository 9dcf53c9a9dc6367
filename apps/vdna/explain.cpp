// vdna explain - says which neurons make the first experience nearer to a live run than the second.
#include <algorithm>
#include <functional>
#include <optional>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/experience.hpp>
#include <vdna/cpp/explainer.hpp>

#include "program/exit_code.hpp"
#include "program/print.hpp"
#include "program/replaced_file.hpp"
#include "program/text_table.hpp"
#include "record/thumbnails.hpp"
#include "report/explanation.hpp"
#include "vdna/commands.hpp"
#include "vdna/live_ranking.hpp"

namespace vdna::tool
{

namespace
{

struct ExplainOptions {
    LiveOptions live;
    std::string winner, against; // names; "" = the first and the second of the ranking
    uint32_t top = 5;
    bool json = false;
    std::string html; // file; "" = none
};

// The frames of a warmup, with how much they have of each neuron.
class LiveFrames
{
  public:
    explicit LiveFrames(bool with_thumbnails)
    {
        if (with_thumbnails)
            thumbnails_.emplace();
    }

    void add(const record::Pass &pass)
    {
        frames_.push_back({pass.frame().utime,
                           pass.frame().name,
                           thumbnails_ ? thumbnails_->of(pass.frame()) : "",
                           {}});
        for (size_t t = 0; t < pass.output().tap_count; t++)
            add(pass.output().taps[t], frames_.back().neurons);
    }

    // Keep those of the window alone.
    void keep(int64_t first_utime, int64_t last_utime)
    {
        frames_.erase(std::remove_if(frames_.begin(), frames_.end(),
                                     [=](const Live &frame) {
                                         return frame.utime < first_utime ||
                                                frame.utime > last_utime;
                                     }),
                      frames_.end());
    }

    struct Live {
        int64_t utime;
        std::string name;
        std::string thumbnail;      // JPEG; "" = none
        std::vector<float> neurons; // means over the samples
    };
    const Live &most(uint32_t neuron) const
    {
        return *std::max_element(frames_.begin(), frames_.end(), less_of(neuron));
    }
    const Live &least(uint32_t neuron) const
    {
        return *std::min_element(frames_.begin(), frames_.end(), less_of(neuron));
    }

  private:
    using Less = std::function<bool(const Live &, const Live &)>;

    static Less less_of(uint32_t neuron)
    {
        return [neuron](const Live &a, const Live &b) {
            return a.neurons[neuron] < b.neurons[neuron];
        };
    }

    static void add(const vdna_activations &tap, std::vector<float> &out_means)
    {
        const bool by_neuron = tap.layout == VDNA_LAYOUT_NEURONS_SAMPLES;
        for (size_t n = 0; n < tap.neurons; n++) {
            float sum = 0;
            for (size_t s = 0; s < tap.samples; s++)
                sum += tap.values[by_neuron ? n * tap.samples + s : s * tap.neurons + n];
            out_means.push_back(sum / static_cast<float>(tap.samples));
        }
    }

    std::optional<record::Thumbnails> thumbnails_;
    std::vector<Live> frames_;
};

std::string list_of(const std::vector<std::string> &names)
{
    std::string list;
    for (const std::string &name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list;
}

// The candidate of this name, or without one the first of the ranking that is not `other`.
uint32_t candidate_of(const Ranking &ranking, const std::string &option, const std::string &name,
                      const std::string &other)
{
    for (const vdna_rank_entry &entry : ranking.entries)
        if (name.empty() ? ranking.names[entry.candidate] != other
                         : ranking.names[entry.candidate] == name)
            return entry.candidate;
    throw program::UsageError(option + " is " + name + ", expected one of " +
                              list_of(ranking.names));
}

struct Pair {
    uint32_t winner, against; // candidates
};

Pair pair_of(const ExplainOptions &options, const Ranking &ranking)
{
    if (ranking.names.size() < 2)
        throw Error(options.live.map + ": there is only one experience to choose, " +
                    ranking.names[0] + ", expected another to compare it with");
    if (!options.winner.empty() && options.winner == options.against)
        throw program::UsageError("--winner and --against are both " + options.winner +
                                  ", expected two experiences");
    const uint32_t winner = candidate_of(ranking, "--winner", options.winner,
                                         options.winner.empty() ? options.against : "");
    return {winner, candidate_of(ranking, "--against", options.against, ranking.names[winner])};
}

// All there is to tell.
struct Told {
    const Ranking &ranking;
    const report::Explanation &explanation;
    const LiveFrames &live;
    const vdna_experience &winner, &against;
    bool has_examples; // of the map
};

std::string frames_text(const ExampleFrames &frames)
{
    return frames.most < 0 ? "-"
                           : std::to_string(frames.most) + " | " + std::to_string(frames.least);
}

std::string reasons_text(const Told &told)
{
    const Explainer &explainer = told.explanation.explainer;
    const std::string &winner = told.explanation.winner, &against = told.explanation.against;
    program::TextTable table;
    table.add_row({"tap", "neuron", "margin/bins", "share/%", "live bin", winner + " bin",
                   against + " bin", winner + " most | least", against + " most | least"});
    for (const Reason &reason : explainer.reasons())
        table.add_row({explainer.taps()[reason.tap].name, std::to_string(reason.index),
                       program::fixed(reason.part.margin_bins, 4),
                       report::share_text(explainer, reason.part),
                       program::fixed(reason.live_bin, 1), program::fixed(reason.winner_bin, 1),
                       program::fixed(reason.against_bin, 1), frames_text(reason.of_winner),
                       frames_text(reason.of_against)});
    return table.text();
}

std::string taps_text(const Told &told)
{
    const Explainer &explainer = told.explanation.explainer;
    program::TextTable table;
    table.add_row({"tap", "neurons", "margin/bins", "share/%", told.explanation.winner + "/bins",
                   told.explanation.against + "/bins"});
    for (const Tap &tap : explainer.taps()) {
        const vdna_reason part = explainer.of_tap(tap);
        table.add_row({tap.name, std::to_string(part.count), program::fixed(part.margin_bins, 4),
                       report::share_text(explainer, part), program::fixed(part.winner_bins, 4),
                       program::fixed(part.against_bins, 4)});
    }
    return table.text();
}

void print(const Told &told)
{
    std::cout << told.ranking.expectation->sentence << '\n'
              << sentence_of(told.explanation) << "\n\n"
              << reasons_text(told) << '\n'
              << taps_text(told);
    if (!told.has_examples)
        std::cout << '\n' << no_example_frames << '\n';
}

program::Json json_of(const Explainer &explainer, const vdna_reason &part)
{
    const double margin = explainer.whole().margin_bins;
    return {{"margin_bins", part.margin_bins},
            {"share", margin == 0 ? program::Json() : program::Json(part.margin_bins / margin)},
            {"winner_bins", part.winner_bins},
            {"against_bins", part.against_bins}};
}

// null where it is not known.
program::Json json_of(const ExampleFrames &frames)
{
    return frames.most < 0 ? program::Json()
                           : program::Json{{"most", frames.most}, {"least", frames.least}};
}

program::Json json_of(const Told &told, const Reason &reason)
{
    const Explainer &explainer = told.explanation.explainer;
    program::Json json = {{"tap", explainer.taps()[reason.tap].name}, {"neuron", reason.index}};
    json.update(json_of(explainer, reason.part));
    json.update({{"live_mean_bin", reason.live_bin},
                 {"winner_mean_bin", reason.winner_bin},
                 {"against_mean_bin", reason.against_bin},
                 {"winner_frames", json_of(reason.of_winner)},
                 {"against_frames", json_of(reason.of_against)},
                 {"live_frames",
                  {{"most", told.live.most(reason.part.neuron).name},
                   {"least", told.live.least(reason.part.neuron).name}}}});
    return json;
}

void print_json(const Told &told)
{
    const Explainer &explainer = told.explanation.explainer;
    program::Json reasons = program::Json::array(), taps = program::Json::array();
    for (const Reason &reason : explainer.reasons())
        reasons.push_back(json_of(told, reason));
    for (const Tap &tap : explainer.taps()) {
        taps.push_back({{"tap", tap.name}, {"neurons", tap.end - tap.begin}});
        taps.back().update(json_of(explainer, explainer.of_tap(tap)));
    }
    const vdna_reason whole = explainer.whole();
    program::Json json = {{"query", told.ranking.query},
                          {"frames", told.ranking.frames},
                          {"sentence", told.ranking.expectation->sentence},
                          {"winner", told.explanation.winner},
                          {"against", told.explanation.against},
                          {"neurons", whole.count}};
    json.update(json_of(explainer, whole));
    json.update({{"no_example_frames", told.has_examples ? "" : no_example_frames},
                 {"reasons", reasons},
                 {"taps", taps}});
    program::print_json(json);
}

report::ExamplePictures pictures_of(const vdna_experience &e, const ExampleFrames &frames)
{
    if (frames.most < 0)
        return {};
    return {std::string(thumbnail_of(e, static_cast<uint32_t>(frames.most))),
            std::string(thumbnail_of(e, static_cast<uint32_t>(frames.least)))};
}

std::vector<report::ReasonPictures> pictures_of(const Told &told)
{
    std::vector<report::ReasonPictures> pictures;
    for (const Reason &reason : told.explanation.explainer.reasons())
        pictures.push_back({{told.live.most(reason.part.neuron).thumbnail,
                             told.live.least(reason.part.neuron).thumbnail},
                            pictures_of(told.winner, reason.of_winner),
                            pictures_of(told.against, reason.of_against)});
    return pictures;
}

void write_page(const Told &told, const std::string &path)
{
    report::Explanation explanation = told.explanation;
    explanation.pictures = pictures_of(told);
    std::vector<std::string> facts = {told.ranking.expectation->sentence + ".",
                                      sentence_of(explanation) + "."};
    if (!told.has_examples)
        facts.push_back(std::string(no_example_frames) + ".");
    program::replace_file(
        path,
        explanation_page(explanation,
                         "Why " + explanation.winner + " and not " + explanation.against, facts));
}

void explain(const ExplainOptions &options)
{
    LiveFrames frames(!options.html.empty());
    const LiveRanking live(options.live, [&](const record::Pass &pass) { frames.add(pass); });
    frames.keep(vdna_select_first_utime(&live.select()), vdna_select_last_utime(&live.select()));
    const Pair pair = pair_of(options, live.ranking());
    const vdna_experience &winner = live.candidates()[pair.winner];
    const vdna_experience &against = live.candidates()[pair.against];
    Explainer explainer(live.identity(), options.top);
    require(explainer.explain(live.live(), winner, against), options.live.path);
    const report::Explanation explanation{winner.name, against.name, explainer};
    const Told told{live.ranking(),
                    explanation,
                    frames,
                    winner,
                    against,
                    explainer.reasons().front().of_winner.most >= 0 &&
                        explainer.reasons().front().of_against.most >= 0};
    if (!options.html.empty())
        write_page(told, options.html);
    options.json ? print_json(told) : print(told);
}

} // namespace

void add_explain(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "explain", "Say which neurons make one experience nearer to a live run than another");
    const auto options = std::make_shared<ExplainOptions>();
    command
        ->add_option("LIVE", options->live.path,
                     "folder of pictures, video file or LCM log of the live run")
        ->type_name("PATH")
        ->required();
    command->add_option("MAP", options->live.map, "the map to choose from")
        ->type_name("DIR")
        ->required();
    command
        ->add_option("--winner", options->winner,
                     "the experience whose choice is explained (default: the first of the ranking)")
        ->type_name("NAME");
    command
        ->add_option("--against", options->against,
                     "the one it is compared with (default: the next of the ranking)")
        ->type_name("NAME");
    command->add_option("--top", options->top, "neurons to name, those that add most to the margin")
        ->check(CLI::Range(1u, 10000u).description(""))
        ->type_name("N")
        ->capture_default_str();
    add_live_options(*command, options->live, "");
    add_network_options(*command, options->live.network, "that of the map");
    add_source_options(*command, options->live.source);
    add_labels_option(*command, options->live.source);
    add_track_options(*command, options->live.source);
    command->add_flag("--json", options->json, "report as JSON");
    command->add_option("--html", options->html, "also write a page, with pictures of the frames")
        ->type_name("FILE");
    command->footer("The contributions of all neurons sum to the margin between both experiences, "
                    "and to both distances: see docs/concepts/visual-dna.md.\n\n"
                    "Examples:\n"
                    "  vdna explain today/ park\n"
                    "  vdna explain --top 10 --against summer --html why.html today/ park");
    command->callback([options] { explain(*options); });
}

} // namespace vdna::tool
