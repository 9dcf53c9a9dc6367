// vdna watch: what a running vdna_selectord says, for people and for programs.
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>

#include <lcm/lcm.h>
#include <poll.h>
#include <unistd.h>
#include <vdna/transport.h>
#include <vdna_messages.h>

#include "commands.hpp"
#include "error.hpp"
#include "interrupt/interrupt.hpp"
#include "message_text.hpp"

namespace vdna
{

namespace
{

struct WatchOptions {
    std::string url;
    bool json = false;
    bool summary = false;
    double seconds = 0; // 0 = for ever
    std::string until;  // "ranking", "localisation:N" or ""
    std::string ranking_channel = "VDNA_RANKING";
    std::string localisation_channel = "VDNA_LOCALISATION";
    std::string status_channel = "VDNA_STATUS";
};

// How many messages of a kind end the watch; 0 = they do not.
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
        throw Error("--until is '" + until + "', expected ranking or localisation:N with N >= 1",
                    exit_usage);
    return {0, count};
}

// Prints messages as they come, and counts them.
class Printer
{
  public:
    explicit Printer(const WatchOptions &options)
        : json_(options.json), summary_(options.summary), updates_(isatty(STDOUT_FILENO) != 0)
    {
    }
    ~Printer() { end_update(); }

    void take(const vdna_msg_ranking_t &message)
    {
        rankings_++;
        print(message, false);
    }

    void take(const vdna_msg_localisation_t &message)
    {
        localisations_++;
        valid_ += message.validity == VDNA_MSG_LOCALISATION_T_VALID;
        refused_ += message.validity == VDNA_MSG_LOCALISATION_T_REFUSED;
        latency_us_ += static_cast<double>(message.latency_us);
        if (!summary_)
            print(message, updates_);
    }

    void take(const vdna_msg_status_t &message)
    {
        if (!summary_)
            print(message, false);
    }

    bool reached(const Goal &goal) const
    {
        return (goal.rankings > 0 && rankings_ >= goal.rankings) ||
               (goal.localisations > 0 && localisations_ >= goal.localisations);
    }

    void print_summary() const
    {
        const double answers = static_cast<double>(localisations_);
        std::printf("%llu frames answered: %llu localised, %llu refused; mean latency %.1f ms\n",
                    localisations_, valid_, refused_,
                    localisations_ > 0 ? latency_us_ / answers / 1000 : 0.0);
    }

  private:
    // An update is a line that the next one overwrites.
    template <typename Message>
    void print(const Message &message, bool as_update)
    {
        if (json_) {
            // A name that is not UTF-8 must not end the watch.
            std::cout << json_of(message).dump(-1, ' ', false,
                                               nlohmann::ordered_json::error_handler_t::replace)
                      << std::endl;
            return;
        }
        if (as_update) {
            std::cout << "\r\033[K" << text_of(message) << std::flush;
            open_update_ = true;
            return;
        }
        end_update();
        std::cout << text_of(message) << std::endl;
    }

    void end_update()
    {
        if (open_update_)
            std::cout << std::endl;
        open_update_ = false;
    }

    bool json_, summary_, updates_;
    bool open_update_ = false;
    unsigned long long rankings_ = 0, localisations_ = 0, valid_ = 0, refused_ = 0;
    double latency_us_ = 0; // sum
};

// Check a message, decode it, hand it to the printer: one such type per message type, because
// lcm-gen writes one set of functions for each.
struct Ranking {
    using Message = vdna_msg_ranking_t;
    static constexpr const vdna_message_type *table = &vdna_message_ranking;
    static constexpr auto decode = vdna_msg_ranking_t_decode;
    static constexpr auto cleanup = vdna_msg_ranking_t_decode_cleanup;
};
struct Localisation {
    using Message = vdna_msg_localisation_t;
    static constexpr const vdna_message_type *table = &vdna_message_localisation;
    static constexpr auto decode = vdna_msg_localisation_t_decode;
    static constexpr auto cleanup = vdna_msg_localisation_t_decode_cleanup;
};
struct Status {
    using Message = vdna_msg_status_t;
    static constexpr const vdna_message_type *table = &vdna_message_status;
    static constexpr auto decode = vdna_msg_status_t_decode;
    static constexpr auto cleanup = vdna_msg_status_t_decode_cleanup;
};

template <typename Type>
void on_message(const lcm_recv_buf_t *received, const char *channel, void *printer)
{
    // The decoders believe every length they read.
    typename Type::Message message;
    if (vdna_transport_check(Type::table, received->data, received->data_size) != VDNA_OK ||
        Type::decode(received->data, 0, static_cast<int>(received->data_size), &message) < 0) {
        std::cerr << "vdna watch: " << channel << ": a message of another type or version, "
                  << received->data_size << " bytes; left out\n";
        return;
    }
    static_cast<Printer *>(printer)->take(message);
    Type::cleanup(&message);
}

struct DestroyLcm {
    void operator()(lcm_t *lcm) const { lcm_destroy(lcm); }
};
using Lcm = std::unique_ptr<lcm_t, DestroyLcm>;

// LCM takes channels for regular expressions; the names of ours are meant literally.
std::string literally(const std::string &channel)
{
    std::string pattern;
    for (const char c : channel)
        pattern += std::isalnum(static_cast<unsigned char>(c)) || c == '_' ? std::string(1, c)
                                                                           : std::string("\\") + c;
    return pattern;
}

void subscribe(lcm_t *lcm, const std::string &channel, lcm_msg_handler_t handler, Printer &printer)
{
    lcm_subscription_t *subscription =
        lcm_subscribe(lcm, literally(channel).c_str(), handler, &printer);
    if (!subscription)
        throw Error(channel + ": LCM cannot subscribe to this channel; see to the network");
    lcm_subscription_set_queue_capacity(subscription, 1000); // of 30; a slow terminal loses none
}

Lcm listen(const WatchOptions &options, Printer &printer)
{
    Lcm lcm(lcm_create(options.url.empty() ? nullptr : options.url.c_str()));
    if (!lcm)
        throw Error("LCM cannot use the URL '" + options.url +
                    "'; expected one such as udpm://239.255.76.67:7667?ttl=0");
    subscribe(lcm.get(), options.ranking_channel, on_message<Ranking>, printer);
    subscribe(lcm.get(), options.localisation_channel, on_message<Localisation>, printer);
    subscribe(lcm.get(), options.status_channel, on_message<Status>, printer);
    return lcm;
}

// Handle the next message, if one comes within a moment.
void handle_one(lcm_t *lcm)
{
    constexpr int moment_ms = 100;
    pollfd incoming{lcm_get_fileno(lcm), POLLIN, 0};
    const int ready = poll(&incoming, 1, moment_ms);
    if ((ready < 0 && errno != EINTR) || (ready > 0 && lcm_handle(lcm) != 0))
        throw Error("the LCM connection is gone; see to the network and start again");
}

void watch(const WatchOptions &options)
{
    const Goal goal = parse_goal(options.until);
    Printer printer(options);
    const Lcm lcm = listen(options, printer);
    std::cerr << "vdna watch: listening" << std::endl;

    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    const auto is_over = [&] {
        return options.seconds > 0 &&
               Clock::now() - begin >= std::chrono::duration<double>(options.seconds);
    };
    while (!printer.reached(goal) && !is_over() && !interrupted())
        handle_one(lcm.get());

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
    CLI::App *command = app.add_subcommand("watch", "show what a running vdna_selectord says");
    const auto options = std::make_shared<WatchOptions>();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network; default: $LCM_DEFAULT_URL, else LCM's")
        ->type_name("URL");
    CLI::Option *json = command->add_flag("--json", options->json, "one JSON object per message");
    command
        ->add_flag("--summary", options->summary,
                   "the rankings, and the localisations in one line at the end")
        ->excludes(json);
    command->add_option("--for", options->seconds, "end after this time")
        ->type_name("SECONDS")
        ->check(CLI::Range(0.001, 1e9));
    command
        ->add_option("--until", options->until,
                     "end after a ranking, or after N localisations; exit 1 if --for ends first")
        ->type_name("ranking|localisation:N");
    command->add_option("--ranking", options->ranking_channel, "channel")->capture_default_str();
    command->add_option("--localisation", options->localisation_channel, "channel")
        ->capture_default_str();
    command->add_option("--status", options->status_channel, "channel")->capture_default_str();
    command->callback([options] { watch(*options); });
}

} // namespace vdna
