// vdna watch - shows the messages of a running vdna_selectord, to people and programs.
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>
#include <vdna_messages.h>
#include <vdna_msg_localisation_t.h>

#include <vdna/cpp/error.hpp>
#include <vdna/listener.h>
#include <vdna/transport.h>

#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "telemetry/message_text.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct WatchOptions {
    std::string url;
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

// Prints messages as they arrive, and counts them.
class Printer
{
  public:
    explicit Printer(const WatchOptions &options)
        : json_(options.json), summary_(options.summary), updates_(isatty(STDOUT_FILENO) != 0)
    {
    }
    ~Printer() { end_update(); }

    void take(const telemetry::View &view, const char *channel, const void *message)
    {
        const bool is_ranking = view.type == &vdna_message_ranking;
        const bool is_localisation = view.type == &vdna_message_localisation;
        rankings_ += is_ranking;
        if (is_localisation)
            count(*static_cast<const vdna_msg_localisation_t *>(message));
        if (is_ranking || !summary_)
            print(view, channel, message, is_localisation && updates_);
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
    void count(const vdna_msg_localisation_t &message)
    {
        localisations_++;
        valid_ += message.validity == VDNA_MSG_LOCALISATION_T_VALID;
        unsure_ += message.validity == VDNA_MSG_LOCALISATION_T_UNSURE;
        refused_ += message.validity == VDNA_MSG_LOCALISATION_T_REFUSED;
        latency_us_ += static_cast<double>(message.latency_us);
    }

    // as_update: the next line overwrites this one.
    void print(const telemetry::View &view, const char *channel, const void *message,
               bool as_update)
    {
        if (json_) {
            std::cout << telemetry::json_line(view, channel, message) << std::endl;
            return;
        }
        if (as_update) {
            std::cout << "\r\033[K" << view.text(message) << std::flush;
            open_update_ = true;
            return;
        }
        end_update();
        std::cout << view.text(message) << std::endl;
    }

    void end_update()
    {
        if (open_update_)
            std::cout << std::endl;
        open_update_ = false;
    }

    bool json_, summary_, updates_;
    bool open_update_ = false;
    unsigned long long rankings_ = 0, localisations_ = 0, valid_ = 0, unsure_ = 0, refused_ = 0;
    double latency_us_ = 0; // sum
};

struct CloseListener {
    void operator()(vdna_listener *listener) const { vdna_listener_close(listener); }
};
using Listener = std::unique_ptr<vdna_listener, CloseListener>;

Listener listen(const WatchOptions &options)
{
    const std::vector<telemetry::View> &views = telemetry::views();
    std::vector<vdna_listener_channel> channels;
    for (size_t i = 0; i < views.size(); i++)
        if (!options.channels[i].empty())
            channels.push_back({options.channels[i].c_str(), views[i].type});

    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = options.url.empty() ? nullptr : options.url.c_str();
    config.channels = channels.data();
    config.channel_count = static_cast<uint32_t>(channels.size());
    vdna_listener *listener = nullptr;
    vdna_error error{};
    require(vdna_listener_open(&config, &error, &listener), error);
    return Listener(listener);
}

// Handle the next message, if one arrives within a moment; false at the end of a log.
bool handle_one(vdna_listener *listener, const WatchOptions &options, Printer &printer)
{
    constexpr int32_t moment_ms = 100;
    vdna_listener_message message;
    const vdna_status status = vdna_listener_poll(listener, moment_ms, &message);
    if (status != VDNA_OK) {
        if (status == VDNA_ERR_FORMAT)
            throw Error("parts of the log are damaged and were passed over");
        if (vdna_transport_is_log(options.url.c_str()))
            return false;
        throw Error("the LCM connection is gone; see to the network and start again");
    }
    if (message.rejected)
        std::cerr << "vdna watch: " << message.channel << ": " << message.rejected << ", "
                  << message.size << " bytes; left out\n";
    for (const telemetry::View &view : telemetry::views())
        if (message.data && message.type == view.type)
            printer.take(view, message.channel, message.data);
    return true;
}

void watch(const WatchOptions &options)
{
    const Goal goal = parse_goal(options.until);
    Printer printer(options);
    const Listener listener = listen(options);
    std::cerr << "vdna watch: listening" << std::endl;

    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    const auto is_over = [&] {
        return options.seconds > 0 &&
               Clock::now() - begin >= std::chrono::duration<double>(options.seconds);
    };
    bool more = true;
    while (more && !printer.reached(goal) && !is_over() && !program::interrupted())
        more = handle_one(listener.get(), options, printer);

    if (options.summary)
        printer.print_summary();
    if (!options.until.empty() && !printer.reached(goal))
        throw Error("ended before --until " + options.until +
                    " was reached; is vdna_selectord "
                    "running, and are frames coming in?");
}

} // namespace

void add_watch(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("watch", "Show the messages of a running vdna_selectord");
    const auto options = std::make_shared<WatchOptions>();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network; default: $LCM_DEFAULT_URL, else LCM's")
        ->type_name("URL");
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
                         "channel")
            ->capture_default_str();
    command->callback([options] { watch(*options); });
}

} // namespace vdna::tool
