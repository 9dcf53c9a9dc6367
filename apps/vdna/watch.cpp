// vdna watch - shows a running vdna_selectord: to people on a screen or in lines, to programs as
// JSON.
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <vdna_messages.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>

#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/listener.hpp>
#include <vdna/transport.h>

#include "program/clock.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "telemetry/message_text.hpp"
#include "telemetry/network_url.hpp"
#include "telemetry/newest.hpp"
#include "vdna/commands.hpp"
#include "watch/display_text.hpp"
#include "watch/screen.hpp"
#include "watch/terminal.hpp"

namespace vdna::tool
{

namespace
{

struct WatchOptions {
    std::string url;
    bool log = false;
    bool json = false;
    bool summary = false;
    double seconds = 0;                // 0 = forever
    std::string until;                 // "ranking", "localisation:N" or ""
    std::vector<std::string> channels; // of each view; "" = not listened to
};

// The number of messages of a kind that ends the watch; 0 = none.
struct Goal {
    uint64_t rankings = 0;
    uint64_t localisations = 0;
};

Goal parse_goal(const std::string &until)
{
    const std::string prefix = "localisation:";
    if (until.empty())
        return {};
    if (until == "ranking")
        return {1, 0};
    char *end = nullptr;
    const unsigned long long count =
        until.compare(0, prefix.size(), prefix) == 0 &&
                std::isdigit(static_cast<unsigned char>(until[prefix.size()]))
            ? std::strtoull(until.c_str() + prefix.size(), &end, 10)
            : 0;
    if (count == 0 || *end != '\0')
        throw program::UsageError("--until is '" + until +
                                  "', expected ranking or localisation:N with N >= 1");
    return {0, count};
}

// A text of several lines without anything that would control a terminal.
std::string lines_of(const std::string &text)
{
    std::string lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        lines += watch::printable(line) + "\n";
    return lines;
}

// Prints messages as they arrive, and counts them.
class Printer
{
  public:
    explicit Printer(const WatchOptions &options) : json_(options.json), summary_(options.summary)
    {
    }

    void take(const vdna_listener_message &message)
    {
        const telemetry::View &view = telemetry::view_of(*message.type);
        const bool is_ranking = message.type == &vdna_message_ranking;
        const bool is_known =
            is_ranking && is_known_choice(*static_cast<const vdna_msg_ranking_t *>(message.data));
        if (message.type == &vdna_message_localisation)
            count(*static_cast<const vdna_msg_localisation_t *>(message.data));
        if (json_)
            std::cout << telemetry::json_line(view, message.channel, message.data) << std::endl;
        else if (is_ranking ? !is_known : !summary_)
            std::cout << lines_of(view.text(message.data)) << std::flush;
    }

    bool reached(const Goal &goal) const
    {
        return (goal.rankings > 0 && rankings_ >= goal.rankings) ||
               (goal.localisations > 0 && localisations_ >= goal.localisations);
    }

    void print_summary() const
    {
        const double answers = static_cast<double>(localisations_);
        std::printf("%llu frames answered: %llu localised, %llu unsure, %llu refused; mean latency "
                    "%.1f ms\n",
                    localisations_, valid_, unsure_, refused_,
                    localisations_ > 0 ? latency_us_ / answers / 1000 : 0.0);
    }

  private:
    // Whether it repeats a choice that we have seen. Only new choices count.
    bool is_known_choice(const vdna_msg_ranking_t &ranking)
    {
        rankings_ += ranking.repeated == 0;
        return std::exchange(has_ranking_, true) && ranking.repeated != 0;
    }

    void count(const vdna_msg_localisation_t &message)
    {
        localisations_++;
        valid_ += message.validity == VDNA_MSG_LOCALISATION_T_VALID;
        unsure_ += message.validity == VDNA_MSG_LOCALISATION_T_UNSURE;
        refused_ += message.validity == VDNA_MSG_LOCALISATION_T_REFUSED;
        latency_us_ += static_cast<double>(message.latency_us);
    }

    bool json_, summary_, has_ranking_ = false;
    unsigned long long rankings_ = 0, localisations_ = 0, valid_ = 0, unsure_ = 0, refused_ = 0;
    double latency_us_ = 0; // sum
};

Listener listen(const WatchOptions &options)
{
    const std::vector<telemetry::View> &views = telemetry::views();
    std::vector<vdna_listener_channel> channels;
    for (size_t i = 0; i < views.size(); i++)
        if (!options.channels[i].empty())
            channels.push_back({options.channels[i].c_str(), views[i].type});

    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = url_or_default(options.url);
    config.channels = channels.data();
    config.channel_count = static_cast<uint32_t>(channels.size());
    return open_listener(config);
}

// Wait a moment for the next message, whose type is NULL if none comes; false at the end of a log.
bool poll(vdna_listener *listener, const WatchOptions &options, vdna_listener_message &out_message)
{
    constexpr int32_t moment_ms = 100;
    const vdna_status status = vdna_listener_poll(listener, moment_ms, &out_message);
    if (status == VDNA_OK)
        return true;
    if (status == VDNA_ERR_FORMAT)
        throw Error("parts of the log are damaged and were passed over");
    if (vdna_transport_is_log(options.url.c_str()))
        return false;
    throw Error("the LCM connection is gone; see to the network and start again");
}

// Whether the time of --for is over, or somebody wants us to end.
class End
{
  public:
    explicit End(const WatchOptions &options)
        : at_us_(options.seconds > 0
                     ? program::monotonic_us() + static_cast<int64_t>(1e6 * options.seconds)
                     : INT64_MAX)
    {
    }
    bool has_come() const { return program::interrupted() || program::monotonic_us() >= at_us_; }

  private:
    const int64_t at_us_;
};

void print_lines(const WatchOptions &options)
{
    const Goal goal = parse_goal(options.until);
    Printer printer(options);
    const Listener listener = listen(options);
    std::cerr << "vdna watch: listening" << std::endl;

    const End end(options);
    vdna_listener_message message;
    while (!printer.reached(goal) && !end.has_come() && poll(listener.get(), options, message)) {
        if (message.rejected)
            std::cerr << "vdna watch: " << message.channel << ": " << message.rejected << ", "
                      << message.size << " bytes; left out\n";
        if (message.data)
            printer.take(message);
    }

    if (options.summary)
        printer.print_summary();
    if (!options.until.empty() && !printer.reached(goal))
        throw Error("ended before --until " + options.until +
                    " was reached; is vdna_selectord "
                    "running, and are frames coming in?");
}

void take(const vdna_listener_message &message, int64_t now_us, telemetry::Newest &newest)
{
    if (message.rejected)
        newest.note_rejected(message.channel, message.rejected);
    if (!message.data)
        return;
    const telemetry::View &view = telemetry::view_of(*message.type);
    newest.take(view.name, view.json(message.data), now_us);
}

void show_screen(const WatchOptions &options)
{
    constexpr int64_t draw_every_us = 200000;
    const std::string url = telemetry::network_url(options.url);
    const Listener listener = listen(options);
    telemetry::Newest newest(program::monotonic_us());
    watch::Terminal terminal;

    const End end(options);
    int64_t drawn_us = 0;
    vdna_listener_message message;
    while (!end.has_come() && !terminal.is_left() && poll(listener.get(), options, message)) {
        const int64_t now_us = program::monotonic_us();
        take(message, now_us, newest);
        if (now_us - drawn_us < draw_every_us)
            continue;
        terminal.show(watch::screen(newest, url, now_us, terminal.size()));
        drawn_us = now_us;
    }
}

// A log ends, and who waits for something or wants a summary reads on: these get lines.
bool wants_screen(const WatchOptions &options)
{
    const bool wants_lines =
        options.log || options.json || options.summary || !options.until.empty();
    return !wants_lines && watch::has_terminal() && !vdna_transport_is_log(options.url.c_str());
}

void run(const WatchOptions &options)
{
    if (wants_screen(options))
        show_screen(options);
    else
        print_lines(options);
}

} // namespace

void add_watch(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("watch", "Show a running vdna_selectord: a live screen on a terminal, "
                                    "otherwise its messages as lines");
    const auto options = std::make_shared<WatchOptions>();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->add_flag("--log", options->log,
                      "print messages as lines, even on a terminal, which otherwise gets a screen");
    CLI::Option *json = command->add_flag("--json", options->json, "one JSON object per message");
    command
        ->add_flag("--summary", options->summary,
                   "print rankings, and one line about all localisations at the end")
        ->excludes(json);
    command->add_option("--for", options->seconds, "end after this time")
        ->type_name("SECONDS")
        ->check(program::within(0.001, 1e9));
    command
        ->add_option("--until", options->until,
                     "end after a ranking, or after N localisations; exit 1 if --for ends first")
        ->type_name("ranking|localisation:N");
    for (const telemetry::View &view : telemetry::views())
        options->channels.push_back(view.channel);
    for (size_t i = 0; i < options->channels.size(); i++)
        command
            ->add_option(std::string("--") + telemetry::views()[i].name, options->channels[i],
                         "channel of that name")
            ->type_name("CHANNEL")
            ->capture_default_str();
    command->footer(
        "The screen has state, candidates, margin, place, rates and problems; q ends it.\n\n"
        "Examples:\n"
        "  vdna watch\n"
        "  vdna watch --json --until localisation:10 --for 60");
    command->callback([options] { run(*options); });
}

} // namespace vdna::tool
