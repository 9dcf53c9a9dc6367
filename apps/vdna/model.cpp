// vdna model - compares two precisions of a network or two preparations of its input, writes the
// inputs of a network, and prints the golden numbers for its manifest.
#include <algorithm>
#include <cstring>

#include "backbone/golden.hpp"
#include "backbone/test_picture.hpp"
#include "eval/evaluate.hpp"
#include "eval/precision_change.hpp"
#include "frames/camera_image.hpp"
#include "program/median.hpp"
#include "program/text_table.hpp"
#include "record/pass.hpp"
#include "report/npy.hpp"
#include "report/result_json.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

namespace fs = std::filesystem;

constexpr size_t timed_pictures = 50;

struct CheckOptions {
    std::array<std::string, 2> manifests; // the original, and its other precision or preparation
    std::string pictures;
    uint32_t threads = VDNA_BACKBONE_THREADS_DEFAULT;
    std::string cache;
    bool json = false;
};

struct InputsOptions {
    NetworkOptions network;
    std::vector<std::string> sources;
    frames::SourceOptions source;
    std::string npy;
};

// A network and its results for the pictures.
struct Side {
    Backbone backbone;
    std::optional<eval::Frames> frames;
    std::optional<eval::Binning> binning;
    std::optional<eval::Evaluation> evaluation; // none if the pictures are not a data set

    Side(const std::string &manifest, uint32_t threads) : backbone(manifest, threads) {}
};

struct Latency {
    std::array<double, 2> ms; // of inference, medians
    double ratio;             // second to first, median over pictures
};

struct CheckResult {
    Latency latency;
    eval::EmbeddingChange embedding;
    std::optional<eval::RankingChange> ranking;
};

void require_one_network(const vdna_backbone_info &a, const vdna_backbone_info &b)
{
    const std::string names = std::string(a.identity.backbone) + " and " + b.identity.backbone;
    const char *const expected = "; expected two precisions of one network, or one model whose "
                                 "input is prepared in two ways";
    const bool one_model = std::strcmp(a.identity.model_sha256, b.identity.model_sha256) == 0;
    // Either their models or their preprocessing differ, so compare everything else.
    vdna_identity as_a = b.identity;
    if (one_model)
        std::memcpy(as_a.preprocessing, a.identity.preprocessing, sizeof as_a.preprocessing);
    else
        std::memcpy(as_a.model_sha256, a.identity.model_sha256, sizeof as_a.model_sha256);
    vdna_error why{};
    if (vdna_identity_compare(&a.identity, &as_a, &why) != VDNA_OK)
        throw Error(names + " do not compare: " + why.text + expected);
    if (!one_model && b.quantised_from[0] != '\0' &&
        std::strcmp(b.quantised_from, a.identity.model_sha256) != 0)
        throw Error(names + " do not compare: model_sha256 of the first is " +
                    a.identity.model_sha256 + ", the original is " + b.quantised_from +
                    " for the second" + expected);
}

// Treat a folder of pictures as a data set of one traversal, without localisation.
frames::Dataset dataset_of(const std::string &path)
{
    if (fs::exists(fs::path(path) / "manifest.csv") || !frames::holds_pictures(path))
        return frames::load_dataset(path);
    frames::Dataset dataset;
    dataset.path = path;
    dataset.traversals.push_back(
        frames::traversal_of(path, frames::list_pictures(path, nullptr),
                             [](const frames::ListedPicture &) { return frames::Label{}; }));
    return dataset;
}

double inference_ms(Backbone &backbone, const std::vector<uint8_t> &picture, const fs::path &file)
{
    const vdna_image encoded = {picture.data(), picture.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
    picture::FileConverter converter;
    const vdna_image image = frames::camera_image(encoded, file.string(), converter);
    vdna_error error{};
    vdna_backbone_frame frame;
    if (vdna_backbone_run(backbone.get(), &image, &error, &frame) != VDNA_OK)
        throw Error(file.string() + ": " + error.text);
    return frame.inference_us / 1e3;
}

// Alternate both networks on the same pictures, so that the ratio is robust to drift.
Latency time(std::array<Side, 2> &sides, const frames::Dataset &dataset)
{
    std::vector<fs::path> files;
    for (const frames::DatasetTraversal &traversal : dataset.traversals)
        for (const frames::DatasetFrame &frame : traversal.frames)
            files.push_back(frame.file);
    std::vector<double> a, b, ratio;
    for (size_t i = 0; i < files.size(); i += std::max<size_t>(files.size() / timed_pictures, 1)) {
        const std::vector<uint8_t> picture = frames::read_picture(files[i]);
        a.push_back(inference_ms(sides[0].backbone, picture, files[i]));
        b.push_back(inference_ms(sides[1].backbone, picture, files[i]));
        ratio.push_back(b.back() / a.back());
    }
    return {{program::median_of(a), program::median_of(b)}, program::median_of(ratio)};
}

void evaluate_side(Side &side, const frames::Dataset &dataset)
{
    eval::EvaluationSettings settings;
    settings.warmup = frames::usual_warmup(dataset);
    settings.tolerance = dataset.tolerance;
    settings.stride = dataset.stride;
    side.binning.emplace(*side.frames, settings.taps, VDNA_RANGE_ABOUT_MIDPOINT);
    side.evaluation = eval::evaluate(*side.frames, *side.binning, settings);
}

CheckResult compare(std::array<Side, 2> &sides, const frames::Dataset &dataset,
                    const eval::Cache &cache)
{
    for (Side &side : sides)
        side.frames.emplace(dataset, side.backbone, cache, eval::FramesOptions{});
    CheckResult result{};
    result.embedding =
        eval::embedding_change(sides[0].frames->traversals(), sides[1].frames->traversals(),
                               sides[0].backbone.info().identity.dim);
    if (dataset.traversals.size() > 1) {
        for (Side &side : sides)
            evaluate_side(side, dataset);
        result.ranking = eval::ranking_change(*sides[0].evaluation, *sides[1].evaluation);
    }
    result.latency = time(sides, dataset);
    return result;
}

program::Json json_of_spread(const eval::Spread &spread)
{
    return {{"median", spread.median}, {"max", spread.max}};
}

program::Json json_of_network(const vdna_backbone_info &backbone)
{
    return {{"name", backbone.identity.backbone},
            {"precision", vdna_identity_precision(&backbone.identity)},
            {"model_sha256", backbone.identity.model_sha256}};
}

program::Json json_of_check(const std::array<Side, 2> &sides, const CheckResult &result)
{
    program::Json json = {
        {"networks",
         {json_of_network(sides[0].backbone.info()), json_of_network(sides[1].backbone.info())}},
        {"runtime", sides[0].backbone.info().runtime},
        {"pictures", result.embedding.pictures},
        {"inference_ms", result.latency.ms},
        {"inference_ratio", result.latency.ratio},
        {"embedding_l2_percent", json_of_spread(result.embedding.l2_percent)},
        {"embedding_cosine_distance", json_of_spread(result.embedding.cosine_distance)}};
    if (!result.ranking)
        return json;
    const std::vector<eval::Traversal> &traversals = sides[0].frames->traversals();
    json["pairs"] = result.ranking->pairs;
    json["emd_change_percent"] = json_of_spread(result.ranking->emd_percent);
    json["recall_percent"] = result.ranking->recall;
    for (const Side &side : sides)
        json["methods"].push_back(report::json_of(side.evaluation->methods.front().judged));
    for (const eval::QueryChange &query : result.ranking->queries)
        json["queries"].push_back(
            {{"query", traversals[query.traversal].name},
             {"swaps", query.swaps},
             {"first", {traversals[query.first[0]].name, traversals[query.first[1]].name}},
             {"recall_of_first_percent", query.recall}});
    return json;
}

void print_spread(program::TextTable &table, const std::string &what, const eval::Spread &spread,
                  int digits)
{
    table.add_row(
        {what, program::fixed(spread.median, digits), program::fixed(spread.max, digits)});
}

void print_both(program::TextTable &table, const std::string &what, double a, double b, int digits)
{
    table.add_row({what, program::fixed(a, digits), program::fixed(b, digits)});
}

// What the columns of both networks are called.
std::array<std::string, 2> titles_of(const std::array<Side, 2> &sides)
{
    const std::string a = sides[0].backbone.info().identity.precision,
                      b = sides[1].backbone.info().identity.precision;
    return a != b ? std::array<std::string, 2>{a, b}
                  : std::array<std::string, 2>{"first", "second"};
}

void print_queries(const std::array<Side, 2> &sides, const eval::RankingChange &ranking)
{
    const std::vector<eval::Traversal> &traversals = sides[0].frames->traversals();
    const auto [a, b] = titles_of(sides);
    program::TextTable table;
    table.add_row({"query", "swaps", "first choice, " + a, b, "its recall/%, " + a, b});
    for (const eval::QueryChange &query : ranking.queries)
        table.add_row({traversals[query.traversal].name, std::to_string(query.swaps),
                       traversals[query.first[0]].name, traversals[query.first[1]].name,
                       program::fixed(query.recall[0], 2), program::fixed(query.recall[1], 2)});
    size_t swaps = 0, changed = 0;
    for (const eval::QueryChange &query : ranking.queries) {
        swaps += query.swaps;
        changed += query.first[0] != query.first[1] ? 1 : 0;
    }
    std::cout << '\n'
              << table.text() << '\n'
              << swaps << " pairs of references swap places; the first choice changes for "
              << changed << " of " << ranking.queries.size() << " queries\n";
}

void print_text(const std::array<Side, 2> &sides, const CheckResult &result)
{
    const vdna_identity &a = sides[0].backbone.info().identity,
                        &b = sides[1].backbone.info().identity;
    std::cout << a.backbone << " (" << a.precision << ") and " << b.backbone << " (" << b.precision
              << "), " << result.embedding.pictures << " pictures\n\n";
    program::TextTable changes;
    changes.add_row({"change", "median", "greatest"});
    print_spread(changes, "embedding, relative L2/%", result.embedding.l2_percent, 2);
    print_spread(changes, "embedding, cosine distance", result.embedding.cosine_distance, 6);
    if (result.ranking)
        print_spread(changes, "EMD of " + std::to_string(result.ranking->pairs) + " pairs/%",
                     result.ranking->emd_percent, 2);
    std::cout << changes.text() << '\n';

    program::TextTable both;
    const auto [title_a, title_b] = titles_of(sides);
    both.add_row({"", title_a, title_b});
    print_both(both, "inference/ms, median", result.latency.ms[0], result.latency.ms[1], 2);
    both.add_row({"  ratio", "1", program::fixed(result.latency.ratio, 2)});
    if (result.ranking) {
        const vdna_ranking_metrics &of_a = sides[0].evaluation->methods.front().judged.metrics;
        const vdna_ranking_metrics &of_b = sides[1].evaluation->methods.front().judged.metrics;
        print_both(both, "Recall@1/%, mean over pairs", result.ranking->recall[0],
                   result.ranking->recall[1], 2);
        print_both(both, "ranking error/%", of_a.ranking_error_swap_once,
                   of_b.ranking_error_swap_once, 2);
        print_both(both, "regret of the first choice/%", of_a.regret, of_b.regret, 2);
    }
    std::cout << both.text();
    if (result.ranking)
        print_queries(sides, *result.ranking);
}

void check(const CheckOptions &o)
{
    std::array<Side, 2> sides = {Side(o.manifests[0], o.threads), Side(o.manifests[1], o.threads)};
    require_one_network(sides[0].backbone.info(), sides[1].backbone.info());
    const CheckResult result = compare(sides, dataset_of(o.pictures), eval::Cache(o.cache));
    if (o.json)
        program::print_json(json_of_check(sides, result));
    else
        print_text(sides, result);
}

void write_inputs(InputsOptions o)
{
    o.source.labelled = false;
    Backbone backbone(o.network.backbone, o.network.threads);
    const size_t height = backbone.info().input_height, width = backbone.info().input_width;
    if (width == 0)
        throw Error(o.network.backbone + ": this plug-in does not show what its network is given; "
                                         "name a network with a manifest");
    std::vector<float> inputs;
    for (const std::string &source : o.sources)
        for (record::Pass pass(source, o.source, backbone); pass.next();)
            inputs.insert(inputs.end(), pass.output().input,
                          pass.output().input + 3 * height * width);
    const size_t pictures = inputs.size() / (3 * height * width);
    if (pictures == 0)
        throw Error(o.sources.front() + ": none of its frames can be used");
    report::write_npy(o.npy, {pictures, 3, height, width}, inputs);
    std::cout << o.npy << ": " << pictures << " pictures\n";
}

void print_golden(const NetworkOptions &o)
{
    const Backbone network(o.backbone, o.threads);
    const vdna_image picture = backbone::test_picture();
    vdna_error error{};
    vdna_backbone_frame frame;
    require(vdna_backbone_run(network.get(), &picture, &error, &frame), error);
    std::cout << backbone::golden_text(frame);
}

void add_check(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "check", "Compare a network on pictures with one of another precision, or "
                 "one model with input prepared in another way");
    const auto o = std::make_shared<CheckOptions>();
    command
        ->add_option("FP32", o->manifests[0],
                     "network: name of a manifest, or path of a .toml or a .so")
        ->type_name("NETWORK|PATH")
        ->required();
    command
        ->add_option("INT8", o->manifests[1],
                     "the same network in another precision, or with other keys in [input]")
        ->type_name("NETWORK|PATH")
        ->required();
    command
        ->add_option(
            "PICTURES", o->pictures,
            "data set as for `vdna eval`, or a folder of pictures, which gives no rankings "
            "and no recall")
        ->type_name("PATH")
        ->required();
    add_threads_option(*command, o->threads);
    command
        ->add_option("--cache", o->cache,
                     "directory for cached results, by content (default: $XDG_CACHE_HOME/vdna)")
        ->type_name("DIR");
    command->add_flag("--json", o->json, "report as JSON");
    command->footer(
        "Each network is evaluated on its own maps, as in real use: Visual DNA of different "
        "precisions or preprocessing never compares. Inference times alternate between both "
        "networks on "
        "the same pictures.\n\n"
        "Examples:\n"
        "  vdna model check efficientnet_lite0 my/efficientnet_lite0_int8.toml runs/");
    command->callback([o] { check(*o); });
}

void add_inputs(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "inputs", "Write the network inputs of pictures: resized and normalised");
    const auto o = std::make_shared<InputsOptions>();
    command->add_option("NETWORK", o->network.backbone, "name of a manifest, or path of a .toml")
        ->type_name("NETWORK|PATH")
        ->required();
    command->add_option("SOURCE", o->sources, "folder of pictures, video, LCM log or MCAP file")
        ->type_name("PATH")
        ->required();
    command->add_option("--npy", o->npy, "file to write: float32 [pictures, 3, height, width]")
        ->type_name("FILE")
        ->required();
    add_source_options(*command, o->source);
    command->footer("models/quantise.py uses them to find the ranges of activations.\n\n"
                    "Examples:\n"
                    "  vdna model inputs efficientnet_lite0 winter/ --every 10 --npy inputs.npy");
    command->callback([o] { write_inputs(*o); });
}

void add_golden(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "golden", "Print a network's numbers for a test picture, for its manifest");
    const auto o = std::make_shared<NetworkOptions>();
    command->add_option("NETWORK", o->backbone, "name of a manifest, or path of a .toml")
        ->type_name("NETWORK|PATH")
        ->required();
    add_threads_option(*command, o->threads);
    command->footer(
        "A network whose manifest has them is refused wherever it gives others: with another file, "
        "other preprocessing, or on a processor that computes wrongly. Compare the network with "
        "its "
        "original first, then append them.\n\n"
        "Examples:\n"
        "  vdna model golden my/network.toml >golden.txt && cat golden.txt >>my/network.toml");
    command->callback([o] { print_golden(*o); });
}

} // namespace

void add_model(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "model",
        "Compare a network with one of another precision or preprocessing, prepare pictures for "
        "networks, and print known numbers");
    command->require_subcommand(1);
    command->footer("Examples:\n"
                    "  vdna model check efficientnet_lite0 my/efficientnet_lite0_int8.toml runs/");
    add_check(*command);
    add_golden(*command);
    add_inputs(*command);
}

} // namespace vdna::tool
