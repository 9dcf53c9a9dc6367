// vdna metrics - evaluates published tables of recalls and distances, without pictures.
#include <fstream>
#include <set>
#include <vector>

#include "eval/published_table.hpp"
#include "report/result_json.hpp"
#include "report/result_tables.hpp"
#include "report/wording.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct MetricsOptions {
    std::string file;
    bool json = false;
};

// The parser would keep the last of two members of one name, so that a table would lose a row.
class Names
{
  public:
    explicit Names(const std::string &file) : file_(file) {}

    void see(program::Json::parse_event_t event, const program::Json &parsed)
    {
        if (event == program::Json::parse_event_t::object_start)
            of_objects_.emplace_back();
        else if (event == program::Json::parse_event_t::object_end)
            of_objects_.pop_back();
        else if (event == program::Json::parse_event_t::key)
            add(parsed.get<std::string>());
    }

  private:
    void add(const std::string &name)
    {
        if (!of_objects_.back().insert(name).second)
            throw Error(file_ + ": an object has the member '" + name +
                        "' twice, expected once; remove one of them");
    }

    const std::string &file_;
    std::vector<std::set<std::string>> of_objects_; // that are not complete, the innermost last
};

program::Json parse(std::istream &stream, const std::string &name)
{
    Names names(name);
    try {
        return program::Json::parse(stream, [&](int, auto event, const program::Json &parsed) {
            names.see(event, parsed);
            return true;
        });
    } catch (const program::Json::parse_error &e) {
        // The parser's message repeats bytes of the file, so leave it out.
        throw Error(name + ": not JSON at byte " + std::to_string(e.byte) +
                    ", expected an object of recalls and distances");
    } catch (const program::Json::exception &) {
        throw Error(name + ": not JSON, expected an object of recalls and distances");
    }
}

std::vector<eval::MethodResult> judge(const std::string &file)
{
    if (file == "-")
        return eval::judge_published(parse(std::cin, "standard input"), "standard input");
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw Error(file + ": cannot open, expected a JSON file of recalls and distances");
    return eval::judge_published(parse(stream, file), file);
}

void report(const MetricsOptions &options)
{
    const std::vector<eval::MethodResult> results = judge(options.file);
    if (!options.json) {
        std::cout << report::error_table(results);
        return;
    }
    program::Json methods = program::Json::object();
    for (const eval::MethodResult &result : results)
        methods[result.name] = report::json_of(result.judged);
    program::print_json(
        {{"methods", methods}, {"note", report::left_out_text(results.front().judged.metrics)}});
}

} // namespace

void add_metrics(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "metrics", "Evaluate tables of recalls and distances, such as published ones");
    const auto options = std::make_shared<MetricsOptions>();
    command
        ->add_option(
            "FILE", options->file,
            "JSON with \"recall\" and \"distance\" as `vdna eval --json` writes them; - is "
            "standard input")
        ->type_name("PATH")
        ->required();
    command->add_flag("--json", options->json, "report as JSON");
    command->footer(
        "Pairs may be missing: a method is evaluated on those with recall and distance.\n\n"
        "Examples:\n"
        "  vdna metrics table1.json --json");
    command->callback([options] { report(*options); });
}

} // namespace vdna::tool
