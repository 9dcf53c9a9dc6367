// vdna eval - runs the paper's evaluation on a data set.
#include <algorithm>
#include <set>

#include <unistd.h>

#include "eval/ablation.hpp"
#include "eval/compare_localisers.hpp"
#include "eval/reselection.hpp"
#include "eval/trust.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/replaced_file.hpp"
#include "record/ranges.hpp"
#include "record/warmup.hpp"
#include "report/figures.hpp"
#include "report/latex.hpp"
#include "report/report.hpp"
#include "report/result_json.hpp"
#include "report/result_npy.hpp"
#include "report/result_tables.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

struct EvalOptions {
    std::string dataset;
    std::string format; // "" = detected
    size_t partition_frames = frames::nordland_partition_frames;
    NetworkOptions network;
    eval::FramesOptions frames;
    std::vector<std::string> exclude, queries, references, taps;
    std::vector<std::string> warmup;
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT;
    std::vector<uint32_t> bins;
    std::optional<double> tolerance;
    bool with_altitude = false;
    std::optional<uint32_t> stride;
    uint32_t range_rule = VDNA_RANGE_ABOUT_MIDPOINT;
    std::vector<std::string> ablate;
    std::vector<std::string> localisers = eval::usual_localisers;
    std::vector<std::string> drives;
    std::vector<std::string> reselect;
    bool trust = false;
    std::string cache, json, csv, npy, html, latex, figures;
    std::string command_line; // as given
};

bool contains(const std::vector<std::string> &names, const std::string &name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

void require_known(const frames::Dataset &dataset, const std::vector<std::string> &names,
                   const std::string &option)
{
    std::string known;
    for (const frames::DatasetTraversal &traversal : dataset.traversals)
        known += " " + traversal.name;
    for (const std::string &name : names)
        if (std::none_of(dataset.traversals.begin(), dataset.traversals.end(),
                         [&](const frames::DatasetTraversal &t) { return t.name == name; }))
            throw program::UsageError(option + ": no traversal '" + name + "' in " + dataset.path +
                                      ", expected one of:" + known);
}

// Names given to --exclude that are no folders, which are left out before they are looked into.
std::vector<std::string> excluded_traversals(const EvalOptions &o)
{
    std::vector<std::string> names;
    for (const std::string &name : o.exclude)
        if (!std::filesystem::is_directory(std::filesystem::path(o.dataset) / name))
            names.push_back(name);
    return names;
}

// The traversals that take part; only these go through the network.
frames::Dataset dataset_of(const EvalOptions &o)
{
    frames::Dataset dataset =
        frames::load_dataset(o.dataset, {o.format, o.partition_frames, o.exclude});
    for (const std::string &note : dataset.notes)
        std::cerr << "vdna: " << note << '\n';
    for (const frames::DatasetTraversal &traversal : dataset.traversals)
        tell(traversal.name, traversal.account);
    require_known(dataset, excluded_traversals(o), "--exclude");
    require_known(dataset, o.queries, "--queries");
    require_known(dataset, o.references, "--references");
    const auto is_idle = [&](const frames::DatasetTraversal &t) {
        const bool query = o.queries.empty() || contains(o.queries, t.name);
        const bool reference = o.references.empty() || contains(o.references, t.name);
        return contains(o.exclude, t.name) || (!query && !reference);
    };
    dataset.traversals.erase(
        std::remove_if(dataset.traversals.begin(), dataset.traversals.end(), is_idle),
        dataset.traversals.end());
    if (dataset.traversals.size() < 2)
        throw program::UsageError(o.dataset +
                                  ": the options leave fewer than two traversals to compare");
    return dataset;
}

// A list is only for an ablation; a single value is a setting.
template <typename Value>
void require_single(const std::vector<Value> &values, const std::string &option,
                    const std::vector<std::string> &ablate, const std::string &kind)
{
    if (values.size() > 1 && !contains(ablate, kind))
        throw program::UsageError(option + ": found " + std::to_string(values.size()) +
                                  " values, expected one; a list needs --ablate " + kind);
}

eval::EvaluationSettings settings_of(const EvalOptions &o, const frames::Dataset &dataset)
{
    require_single(o.bins, "--bins", o.ablate, "bins");
    require_single(o.warmup, "--warmup", o.ablate, "warmup");
    for (const std::string &text : o.warmup)
        record::warmup_of(text);
    eval::EvaluationSettings settings;
    settings.bins = o.bins.size() == 1 ? o.bins[0] : VDNA_HIST_BINS_DEFAULT;
    settings.warmup = o.warmup.size() == 1 ? o.warmup[0] : frames::usual_warmup(dataset);
    settings.warmup_frames_min = o.warmup_frames_min;
    settings.tolerance = o.tolerance.value_or(dataset.tolerance);
    settings.with_altitude = o.with_altitude;
    settings.stride = o.stride.value_or(dataset.stride);
    settings.taps = o.taps;
    settings.queries = o.queries;
    settings.references = o.references;
    return settings;
}

// The pairs, and beside them the averages: result.csv and result_averages.csv.
void write_csv(const std::string &path, const eval::Evaluation &evaluation,
               const std::vector<eval::Ablation> &ablations)
{
    program::replace_file(path, report::csv_of(evaluation));
    const bool has_ending = path.size() >= 4 && path.compare(path.size() - 4, 4, ".csv") == 0;
    program::replace_file(path.substr(0, path.size() - (has_ending ? 4 : 0)) + "_averages.csv",
                          report::averages_csv_of(evaluation, ablations));
}

void write_results(const EvalOptions &o, const eval::Evaluation &evaluation,
                   const std::vector<eval::Ablation> &ablations)
{
    if (o.json == "-")
        program::print_json(report::json_of(evaluation, ablations));
    else
        std::cout << report::tables_of(evaluation, isatty(STDOUT_FILENO) == 1);
    for (const eval::Ablation &ablation : ablations)
        if (o.json != "-")
            std::cout << "\nAblation: " << ablation.kind << '\n' << report::table_of(ablation);
    if (!o.json.empty() && o.json != "-")
        program::replace_file(
            o.json, report::json_of(evaluation, ablations)
                            .dump(2, ' ', false, program::Json::error_handler_t::replace) +
                        "\n");
    if (!o.csv.empty())
        write_csv(o.csv, evaluation, ablations);
    if (!o.npy.empty())
        report::write_npy_files(evaluation, o.npy);
    if (!o.html.empty())
        program::replace_file(o.html, report::report_of(evaluation, ablations, o.command_line));
    if (!o.latex.empty())
        program::replace_file(o.latex, report::latex_of(evaluation));
    if (!o.figures.empty())
        report::write_figures(evaluation, o.figures);
}

// The given options, in the order of the help.
std::string command_line_of(const CLI::App &command)
{
    std::string line = "vdna " + command.get_name();
    for (const CLI::Option *option : command.get_options()) {
        if (option->count() == 0)
            continue;
        if (!option->get_positional())
            line += " " + option->get_name();
        if (option->get_items_expected_max() > 0)
            line += " " + CLI::detail::join(option->results(), ",");
    }
    return line;
}

// The localisers in each of the drives.
std::vector<eval::LocaliserResult> drives_of(const eval::Evaluation &evaluation,
                                             const EvalOptions &o)
{
    std::vector<eval::LocaliserResult> results;
    for (const eval::DriveKind &kind : eval::drive_kinds)
        if (contains(o.drives, kind.key))
            for (eval::LocaliserResult &result :
                 eval::compare_localisers(evaluation, o.localisers, kind))
                results.push_back(std::move(result));
    return results;
}

void run(const EvalOptions &o)
{
    const frames::Dataset dataset = dataset_of(o);
    const eval::EvaluationSettings settings = settings_of(o, dataset);
    Backbone backbone(o.network.backbone.empty() ? VDNA_BACKBONE_DEFAULT : o.network.backbone,
                      o.network.threads);
    const eval::Cache cache(o.cache);
    eval::Frames frames(dataset, backbone, cache, o.frames);
    eval::Binning binning(frames, o.taps, o.range_rule);
    eval::Evaluation evaluation = eval::evaluate(frames, binning, settings);
    evaluation.dataset = o.dataset;
    evaluation.localisers = eval::compare_localisers(evaluation, o.localisers);
    evaluation.drives = drives_of(evaluation, o);
    if (!o.reselect.empty())
        evaluation.reselection = eval::choose_again(evaluation, o.reselect);
    if (o.trust)
        evaluation.trust = eval::evaluate_trust(frames, binning, evaluation);
    std::vector<eval::Ablation> ablations;
    for (const std::string &kind : o.ablate)
        ablations.push_back(eval::ablate(frames, settings, {kind, o.bins, o.warmup, o.range_rule}));
    write_results(o, evaluation, ablations);
}

void add_dataset_options(CLI::App &command, EvalOptions &o)
{
    command.add_option("DATASET", o.dataset, "directory of the data set")
        ->type_name("DIR")
        ->required();
    command
        .add_option("--format,--protocol", o.format,
                    "folders (labels.csv in each), manifest (manifest.csv), nordland, parks (like "
                    "folders, with 45 s of warmup and GPS), utm (positions in picture names) "
                    "(default: auto-detected; parks must be named)")
        ->check(CLI::IsMember(frames::dataset_formats))
        ->type_name("NAME");
    command
        .add_option("--partition-frames", o.partition_frames,
                    "frames per partition, if a Nordland season is one folder")
        ->check(CLI::Range(size_t{1}, size_t{1} << 32).description(""))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--queries", o.queries, "traversals that take the live role (default: all)")
        ->delimiter(',')
        ->type_name("NAME");
    command.add_option("--references", o.references, "traversals of the map (default: all)")
        ->delimiter(',')
        ->type_name("NAME");
    command.add_option("--exclude", o.exclude, "leave these traversals out entirely")
        ->delimiter(',')
        ->type_name("NAME");
    command.add_option("--rate", o.frames.rate_hz, "frames per second, if labels have no utime")
        ->check(program::within(1e-6, 1e6))
        ->type_name("HZ")
        ->capture_default_str();
    command.add_flag("--skip-bad", o.frames.skip_bad,
                     "leave out pictures that cannot be decoded, and count them");
}

void add_protocol_options(CLI::App &command, EvalOptions &o)
{
    command
        .add_option("--warmup", o.warmup,
                    "first N frames or T seconds of the live traversal (default: the data set's, "
                    "else two fifths of the shortest, at most 100 frames)")
        ->delimiter(',')
        ->type_name("N|Ts");
    add_warmup_min_option(command, o.warmup_frames_min);
    command
        .add_option("--tolerance", o.tolerance,
                    "a match is good within T places or metres (default: the data set's, else 5)")
        ->check(program::within(0, 1e9))
        ->type_name("T");
    add_altitude_option(command, o.with_altitude);
    command
        .add_option("--stride", o.stride,
                    "localise every S-th frame after the warmup (default: 1, Nordland 5)")
        ->check(CLI::Range(uint32_t{1}, UINT32_MAX).description(""))
        ->type_name("S");
    command.add_option("--taps", o.taps, "activation taps to count (default: all)")
        ->delimiter(',')
        ->type_name("NAME");
    command.add_option("--bins", o.bins, "bins per neuron (default: 1000)")
        ->delimiter(',')
        ->check(CLI::Range(VDNA_HIST_BINS_MIN, VDNA_HIST_BINS_MAX).description(""))
        ->type_name("2..65536");
    add_range_rule_option(command, o.range_rule);
    command
        .add_option(
            "--ablate", o.ablate,
            "also vary one thing and report the effect on the ranking: bins, warmup (--bins "
            "and --warmup may then be lists: 10,50,100), tap, leave-one-out")
        ->delimiter(',')
        ->check(CLI::IsMember(eval::ablation_kinds))
        ->type_name("WHAT");
    command
        .add_option(
            "--localisers", o.localisers,
            "ways to localise to compare: nn (nearest frame, in each reference), centred "
            "(the same about the means), filter (place filter, in each), filter_top2, "
            "filter_top3, filter_all (the most confident of the filters in the best "
            "references), seqslam (sequences of 10 frames, in each), fused (nearest frame "
            "in the mean of all references), bayesian (the place that is most likely by all "
            "references together), all (nearest frame of all references)")
        ->delimiter(',')
        ->check(CLI::IsMember(eval::localiser_keys()))
        ->type_name("NAME")
        ->default_str("nn,all");
    command
        .add_option("--drives", o.drives,
                    "also compare the localisers in these drives: plain (as recorded), varied "
                    "(half to twice the speed, stops, carried elsewhere once), replaced (30 % of "
                    "the pictures from elsewhere), gap (a quarter of the route missing in the "
                    "map), off-route (leaves the route halfway)")
        ->delimiter(',')
        ->check(CLI::IsMember(eval::drive_keys()))
        ->type_name("NAME");
    command
        .add_option("--reselect", o.reselect,
                    "also drive through these traversals in turn, from the warmup of the first on, "
                    "with the others as the map, and report what choosing again on the way gains: "
                    "summer+dusk+night; one name alone is a drive whose look does not change")
        ->delimiter(',')
        ->type_name("NAME+NAME");
    command.add_flag("--trust", o.trust,
                     "also predict each recall, tell live runs that are like none of the map, end "
                     "warmups early, and report how well that goes, in maps of 3, 4 and all "
                     "references");
}

void add_output_options(CLI::App &command, EvalOptions &o)
{
    command
        .add_option("--cache", o.cache,
                    "directory for cached results, by content (default: $XDG_CACHE_HOME/vdna)")
        ->type_name("DIR");
    command.add_option("--json", o.json, "write the results as JSON; - is standard output")
        ->type_name("FILE");
    command
        .add_option(
            "--csv", o.csv,
            "write a row for each query and reference, and beside it FILE_averages.csv with "
            "the averages")
        ->type_name("FILE");
    command
        .add_option(
            "--npy", o.npy,
            "write matrices and embeddings for NumPy, with an index.json; in file names, all but "
            "letters, digits, '-' and '_' become '_'")
        ->type_name("DIR");
    command
        .add_option("--html", o.html,
                    "write a report to read in a browser: one file with pictures, charts, tables")
        ->type_name("FILE");
    command
        .add_option("--latex", o.latex,
                    "write the tables for LaTeX, as the paper prints them; its head names the "
                    "packages they need")
        ->type_name("FILE");
    command
        .add_option("--figures", o.figures,
                    "write every figure of the report as an SVG and a PDF file")
        ->type_name("DIR");
}

} // namespace

void add_eval(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "eval", "Evaluate ranking and localisation on a data set, as the paper does");
    const auto options = std::make_shared<EvalOptions>();
    add_dataset_options(*command, *options);
    add_network_options(*command, options->network, VDNA_BACKBONE_DEFAULT);
    add_protocol_options(*command, *options);
    add_output_options(*command, *options);
    command->footer(
        "Each traversal in turn is the live one: its warmup ranks the others, and its remaining "
        "frames are localised in each. Misplaced references are orange (one rank) or red (more), "
        "* or ** in files. An interrupted run continues where it stopped.\n\n"
        "Examples:\n"
        "  vdna eval runs/ --tolerance 5 --json result.json\n"
        "  vdna eval nordland/ --protocol nordland --backbone cosplace_resnet101_128\n"
        "  vdna eval runs/ --ablate bins --bins 10,100,1000\n"
        "  vdna eval runs/ --localisers nn,filter,seqslam,all --html report.html\n"
        "  vdna eval runs/ --localisers nn,filter --drives plain,varied,replaced,gap,off-route\n"
        "  vdna eval runs/ --reselect summer+dusk+night,summer\n"
        "  vdna eval runs/ --trust --html report.html\n"
        "  vdna eval runs/ --latex tables.tex --figures figures/");
    command->callback([options, command] {
        options->command_line = command_line_of(*command);
        run(*options);
    });
}

} // namespace vdna::tool
