#include "selectord/config.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <type_traits>
#include <variant>
#include <vector>

#include <toml++/toml.h>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/image.h>
#include <vdna/parked.h>

#include "program/exit_code.hpp"

namespace vdna::selectord
{

namespace
{

using Member = std::variant<std::string Config::*, uint32_t Config::*, int32_t Config::*,
                            double Config::*, bool Config::*>;

// What a text is: relative paths are those of the file's folder.
enum class Text {
    plain,
    path,
    name_or_path, // a path if it has a '/' or ends in .toml
};

// One key of the file. The limits apply to a number, or to the length of a text in bytes; a boolean
// has none. about: what print_config() says of it, beside limits and default.
struct Setting {
    const char *section;
    const char *key;
    Member member;
    double least;
    double most;
    const char *about;
    Text text = Text::plain;
};

constexpr double path_max = 4095; // bytes: PATH_MAX
constexpr double channel_max = VDNA_CHANNEL_BYTES_MAX;
constexpr double threads_max = 256;
constexpr double image_bytes_min = 1024, image_bytes_max = VDNA_MESSAGE_BYTES_MAX;
constexpr double backbone_budget_ms_max = 60000;
constexpr double budget_mb_max = 1u << 20;
constexpr double nice_max = 19;
constexpr double tolerance_max = 1e6;
constexpr double switch_cost_max = 1e6;
constexpr double every_max = 1e6;
constexpr double rate_hz_max = 1000;
constexpr double parked_max = VDNA_PARKED_LIMIT_MAX / 100.0;

const std::array<Setting, 46> settings{{
    {"map", "directory", &Config::map_directory, 1, path_max, "the map: folder of experience files",
     Text::path},
    {"map", "copy", &Config::copy_map, 0, 0,
     "hold the map in memory; false: map its files, which the system may take back and must read "
     "again"},
    {"map", "leave_out_damaged", &Config::leave_out_damaged, 0, 0,
     "serve a map without the experiences that are damaged; false: do not start"},
    {"backbone", "manifest", &Config::manifest, 1, path_max,
     "network that the map was built with: a name, the path of a .toml, or of a plug-in, "
     "./libNAME.so",
     Text::name_or_path},
    {"backbone", "threads", &Config::threads, 1, threads_max, "compute threads of the network"},
    {"backbone", "runtime", &Config::runtime, 0, path_max,
     "path of libonnxruntime.so; \"\" finds the installed one", Text::name_or_path},
    {"backbone", "process", &Config::backbone_process, 0, 0,
     "run the network in a process of its own, which is started again if it crashes or hangs"},
    {"backbone", "budget_ms", &Config::budget_ms, 0, backbone_budget_ms_max,
     "longest time for a picture in that process, milliseconds; 0: ten times what it takes at the "
     "start, at least 500"},
    {"warmup", "frames", &Config::warmup_frames, 1, UINT32_MAX,
     "choose after this many frames, or sooner: see stop_early"},
    {"warmup", "seconds", &Config::warmup_seconds, warmup_seconds_min, warmup_seconds_max,
     "choose after this much camera time, seconds"},
    {"warmup", "frames_min", &Config::warmup_frames_min, 1, UINT32_MAX,
     "fewest frames of a warmup in seconds, which goes on until it has them"},
    {"warmup", "distinct", &Config::warmup_distinct, 0, 0,
     "leave out pictures of a parked camera (see [camera] parked), so that a robot that stands "
     "chooses only after it has driven"},
    {"select", "top", &Config::top, 1, UINT32_MAX,
     "localise in this many of the first experiences of the ranking; the most confident answers"},
    {"select", "rank", &Config::rank, 1, path_max,
     "\"transfer\": by predicted recall where labels of the map allow it, else by distance; "
     "\"emd\": by distance"},
    {"select", "exact_distances", &Config::exact_distances, 0, UINT32_MAX,
     "this many of the first experiences of the ranking have their distance, the rest a lower "
     "bound of it, which saves time with many experiences; 0: all"},
    {"select", "min_recall", &Config::min_recall, 0, 1,
     "no experience fits if less than this share of right answers is predicted of the best"},
    {"select", "stop_early", &Config::stop_early, 0, 0,
     "choose as soon as the choice has settled, at the latest after the whole warmup"},
    {"select", "reselect", &Config::reselect, 0, 0,
     "choose again while driving; needs [localise] filter"},
    {"select", "switch_cost", &Config::switch_cost, 1, switch_cost_max,
     "frames that another experience must be better by before it replaces the choice"},
    {"select", "pin", &Config::pin, 0, VDNA_NAME_SIZE - 1,
     "experience to localise in from the start, whatever the ranking says; \"\": the ranking "
     "chooses"},
    {"select", "shadow", &Config::shadow, 0, 0,
     "recommend only: the first choice stays, and better ones are told"},
    {"localise", "filter", &Config::place_filter, 0, 0,
     "follow the robot by all frames, with a confidence; false: the nearest frame alone"},
    {"localise", "min_confidence", &Config::min_confidence, 0, 1,
     "answers of less confidence are UNSURE in place of VALID"},
    {"localise", "tolerance", &Config::tolerance, 0, tolerance_max,
     "frames within this distance are one place: metres if the map has positions, else place "
     "numbers"},
    {"localise", "every_m", &Config::every_m, 0, every_max,
     "while less than this is driven since the last frame that went through the network, by the "
     "speed of the place filter, answer from that frame; unit as of tolerance; 0: never"},
    {"camera", "health", &Config::frame_health, 0, 0,
     "leave out pictures that show nothing, or nothing new: black, covered, frozen"},
    {"camera", "parked", &Config::parked, 0, parked_max,
     "answer from the last frame, without the network, if the picture is the same up to the "
     "camera's noise, and by no more than this, grey levels; 0: never"},
    {"camera", "max_rate_hz", &Config::max_rate_hz, 0, rate_hz_max,
     "skip frames that come faster, a second; 0: none"},
    {"camera", "stale_seconds", &Config::stale_seconds, 0, warmup_seconds_max,
     "time without a used frame after which the answer is STALE, seconds; 0: 1 s and the time of "
     "two frames"},
    {"lcm", "url", &Config::url, 0, path_max,
     "LCM network, udpm://ADDRESS:PORT?ttl=N; \"\": $LCM_DEFAULT_URL, else that of LCM"},
    {"lcm", "sources", &Config::sources, 0, path_max,
     "IPv4 addresses that may send, \"10.0.0.2,10.0.0.3\"; \"\": this machine alone with ttl=0, "
     "else every one"},
    {"lcm", "require_protection", &Config::require_protection, 0, 0,
     "refuse camera frames that carry no checksum"},
    {"lcm", "standby", &Config::standby, 0, 0,
     "stand by while another daemon serves on these channels"},
    {"lcm", "camera", &Config::camera_channel, 1, channel_max, "channel of the camera frames"},
    {"lcm", "late_seconds", &Config::late_seconds, 0, warmup_seconds_max,
     "leave out a frame up to this much older than the newest, seconds; an older one is a step "
     "back of camera time"},
    {"lcm", "command", &Config::command_channel, 1, channel_max,
     "channel of the commands that come in"},
    {"lcm", "command_result", &Config::command_result_channel, 1, channel_max,
     "channel of the results of commands that go out"},
    {"lcm", "ranking", &Config::ranking_channel, 1, channel_max,
     "channel of the rankings that go out"},
    {"lcm", "localisation", &Config::localisation_channel, 1, channel_max,
     "channel of the answers that go out, one for each frame"},
    {"lcm", "status", &Config::status_channel, 1, channel_max,
     "channel of the status that goes out once a second"},
    {"lcm", "max_image_bytes", &Config::max_image_bytes, image_bytes_min, image_bytes_max,
     "refuse larger messages of the camera, bytes; sets how much memory is held"},
    {"lcm", "max_image_pixels", &Config::max_image_pixels, 1, VDNA_IMAGE_PIXELS_MAX,
     "refuse larger pictures, pixels; sets how much memory is held"},
    {"memory", "budget_mb", &Config::budget_mb, 0, budget_mb_max,
     "do not start if more memory would be held, MiB; 0: no limit"},
    {"memory", "lock", &Config::lock_memory, 0, 0, "lock all memory, so that none is swapped out"},
    {"cpu", "affinity", &Config::affinity, 0, path_max,
     "processors to run on, as for taskset: \"0,2-3\"; \"\": all"},
    {"cpu", "nice", &Config::nice, -20, nice_max,
     "added to the niceness of the process: above 0 leaves others first"},
}};

[[noreturn]] void fail(const std::string &path, const toml::source_position &at,
                       const std::string &sentence)
{
    throw program::UsageError(path + ":" + std::to_string(at.line) + ":" +
                              std::to_string(at.column) + ": " + sentence);
}

// A value as TOML writes it: 10.0, not 10.000000. Texts are in double quotes and on one line:
// toml++ itself does not read all texts that it writes in other ways.
template <typename T>
std::string toml_text(const T &value)
{
    constexpr bool is_integer = std::is_integral_v<T> && !std::is_same_v<T, bool>;
    using Stored = std::conditional_t<is_integer, int64_t, T>; // TOML's one integer type
    std::ostringstream out;
    const toml::value<Stored> stored(static_cast<Stored>(value));
    const auto flags =
        toml::toml_formatter::default_flags &
        ~(toml::format_flags::allow_literal_strings | toml::format_flags::allow_multi_line_strings);
    out << toml::toml_formatter(stored, flags);
    return out.str();
}

std::string describe_found(const toml::node &node)
{
    std::ostringstream out;
    if (node.is_table() || node.is_array())
        out << "an " << node.type(); // its contents may be long
    else
        node.visit([&](const auto &value) { out << value; });
    return node.is_table() ? "a table" : out.str();
}

std::string whole(double number)
{
    return std::to_string(static_cast<int64_t>(number));
}

std::string describe_expected(const Setting &setting)
{
    if (std::holds_alternative<bool Config::*>(setting.member))
        return "true or false";
    if (std::holds_alternative<std::string Config::*>(setting.member))
        return "a string of " + whole(setting.least) + " to " + whole(setting.most) + " bytes";
    if (!std::holds_alternative<double Config::*>(setting.member))
        return "an integer from " + whole(setting.least) + " to " + whole(setting.most);
    return "a number from " + toml_text(setting.least) + " to " + toml_text(setting.most);
}

bool is_within(const Setting &setting, double number)
{
    return number >= setting.least && number <= setting.most; // false for NaN
}

// Store the value of a node if it has the setting's type and is within its limits.
bool take(const toml::node &node, const Setting &setting, std::string &out)
{
    const toml::value<std::string> *text = node.as_string();
    // A NUL would truncate the text when passed to C.
    if (!text || !is_within(setting, static_cast<double>(text->get().size())) ||
        text->get().find('\0') != std::string::npos)
        return false;
    out = text->get();
    return true;
}

template <typename Integer>
bool take_integer(const toml::node &node, const Setting &setting, Integer &out)
{
    const toml::value<int64_t> *number = node.as_integer();
    if (!number || !is_within(setting, static_cast<double>(number->get())))
        return false;
    out = static_cast<Integer>(number->get());
    return true;
}

bool take(const toml::node &node, const Setting &setting, uint32_t &out)
{
    return take_integer(node, setting, out);
}

bool take(const toml::node &node, const Setting &setting, int32_t &out)
{
    return take_integer(node, setting, out);
}

bool take(const toml::node &node, const Setting &, bool &out)
{
    const toml::value<bool> *truth = node.as_boolean();
    if (truth)
        out = truth->get();
    return truth != nullptr;
}

bool take(const toml::node &node, const Setting &setting, double &out)
{
    // `seconds = 10` means 10.0
    const std::optional<double> number = node.value<double>();
    if (!node.is_number() || !number || !is_within(setting, *number))
        return false;
    out = *number;
    return true;
}

bool is_path(const Setting &setting, const std::string &text)
{
    const bool named_path =
        text.find('/') != std::string::npos || std::filesystem::path(text).extension() == ".toml";
    return !text.empty() &&
           (setting.text == Text::path || (setting.text == Text::name_or_path && named_path));
}

// A path in a file, as an absolute one: ~/ is the home directory, a relative one begins in the
// file's folder.
std::string resolved(const std::string &file, const Setting &setting, const std::string &text)
{
    namespace fs = std::filesystem;
    if (text != "~" && text.rfind("~/", 0) != 0)
        return (fs::absolute(file).parent_path() / text).lexically_normal();
    const char *home = std::getenv("HOME");
    if (!home || home[0] != '/')
        throw program::UsageError(file + ": [" + setting.section + "] " + setting.key + " is \"" +
                                  text + "\", but HOME is no absolute path; write the path out");
    return (fs::path(home) / text.substr(std::min<size_t>(2, text.size()))).lexically_normal();
}

void read_setting(const std::string &path, const Setting &setting, const toml::node &node,
                  Config &config)
{
    const bool taken = std::visit([&](auto member) { return take(node, setting, config.*member); },
                                  setting.member);
    if (!taken)
        fail(path, node.source().begin,
             std::string("[") + setting.section + "] " + setting.key + " is " +
                 describe_found(node) + ", expected " + describe_expected(setting) +
                 "; correct it, or remove it to get the default");
    if (const auto *member = std::get_if<std::string Config::*>(&setting.member))
        if (std::string &text = config.**member; is_path(setting, text)) {
            text = resolved(path, setting, text);
            if (!is_within(setting, static_cast<double>(text.size())))
                fail(path, node.source().begin,
                     std::string("[") + setting.section + "] " + setting.key + " has " +
                         std::to_string(text.size()) + " bytes with the folder of this file, " +
                         "expected at most " + whole(path_max) + "; shorten it");
        }
}

void read_section(const std::string &path, const toml::key &section, const toml::table &table,
                  Config &config)
{
    std::string known;
    for (const Setting &setting : settings)
        if (section == setting.section)
            known += (known.empty() ? "" : ", ") + std::string(setting.key);

    for (const auto &[key, node] : table) {
        const auto setting =
            std::find_if(settings.begin(), settings.end(), [&, &name = key](const Setting &s) {
                return section == s.section && name == s.key;
            });
        if (setting == settings.end())
            fail(path, key.source().begin,
                 "unknown key '" + std::string(key.str()) + "' in [" + std::string(section.str()) +
                     "], expected one of: " + known + "; correct or remove it");
        read_setting(path, *setting, node, config);
    }
}

// A warmup is measured in frames or in seconds; the one in the file replaces the default.
void settle_warmup(const std::string &path, const toml::table &root, Config &config)
{
    const toml::node_view<const toml::node> frames = root["warmup"]["frames"];
    const toml::node_view<const toml::node> seconds = root["warmup"]["seconds"];
    if (frames && seconds)
        fail(path, std::max(frames.node()->source().begin, seconds.node()->source().begin),
             "[warmup] has both frames and seconds, expected one of them; remove the other");
    if (seconds)
        config.warmup_frames = 0;
}

void require_known_rank(const std::string &path, const toml::table &root, const Config &config)
{
    if (config.rank != "transfer" && config.rank != "emd")
        fail(path, root["select"]["rank"].node()->source().begin,
             "[select] rank is \"" + config.rank +
                 "\", expected \"transfer\" or \"emd\"; correct it, or remove it to get the "
                 "default");
}

std::string read_text(const std::string &path)
{
    constexpr size_t size_max = 64 * 1024;
    std::error_code error;
    if (const auto kind = std::filesystem::status(path, error).type();
        kind != std::filesystem::file_type::not_found &&
        kind != std::filesystem::file_type::regular) // a pipe may never end, nor begin
        throw program::UsageError(path + ": is no regular file, expected one of TOML");
    std::string text(size_max + 1, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!file.is_open() || file.bad())
        throw program::UsageError(path + ": cannot be read: " + std::strerror(errno) +
                                  "; name an existing TOML file");
    text.resize(static_cast<size_t>(file.gcount()));
    if (text.size() > size_max)
        throw program::UsageError(path + ": is longer than 64 KiB, expected a configuration as "
                                         "`vdna_selectord --print-config` writes it");
    return text;
}

toml::table parse(const std::string &path)
{
    try {
        return toml::parse(read_text(path), path);
    } catch (const toml::parse_error &error) {
        fail(path, error.source().begin,
             std::string(error.description()) + "; expected TOML as `vdna_selectord "
                                                "--print-config` writes it");
    }
}

std::string text_of(const Setting &setting, const Config &config)
{
    return std::visit([&](auto member) { return toml_text(config.*member); }, setting.member);
}

// " (1 to 256, default 2)"
std::string limits_and_default(const Setting &setting)
{
    const std::string by_default = "default " + text_of(setting, Config());
    if (std::holds_alternative<bool Config::*>(setting.member) ||
        std::holds_alternative<std::string Config::*>(setting.member))
        return " (" + by_default + ")";
    const std::string limits = std::holds_alternative<double Config::*>(setting.member)
                                   ? toml_text(setting.least) + " to " + toml_text(setting.most)
                                   : whole(setting.least) + " to " + whole(setting.most);
    const bool has_default = setting.member != Member(&Config::warmup_seconds);
    return " (" + limits + (has_default ? ", " + by_default : "") + ")";
}

// One channel for two things would send our own messages to us, or mix them.
void require_different_channels(const std::string &path, const Config &config)
{
    std::vector<Setting> channels;
    for (const Setting &setting : settings)
        if (setting.most == channel_max && std::string(setting.section) == "lcm")
            channels.push_back(setting);
    const auto name_of = [&](const Setting &setting) {
        return config.*std::get<std::string Config::*>(setting.member);
    };
    for (size_t b = 1; b < channels.size(); b++)
        for (size_t a = 0; a < b; a++)
            if (name_of(channels[a]) == name_of(channels[b]))
                throw program::UsageError(path + ": [lcm] " + channels[a].key + " and " +
                                          channels[b].key + " are both \"" + name_of(channels[a]) +
                                          "\", expected a channel for each; rename one");
}

} // namespace

Config read_config(const std::string &path)
{
    const toml::table root = parse(path);
    Config config;
    for (const auto &[section, node] : root) {
        const bool known = std::any_of(
            settings.begin(), settings.end(),
            [&name = section](const Setting &setting) { return name == setting.section; });
        if (!known || !node.is_table())
            fail(path, section.source().begin,
                 "unknown entry '" + std::string(section.str()) +
                     "', expected the sections [map], [backbone], [warmup], [select], [localise], "
                     "[camera], [lcm], [memory] and [cpu]; correct or remove it");
        read_section(path, section, *node.as_table(), config);
    }
    settle_warmup(path, root, config);
    require_known_rank(path, root, config);
    require_different_channels(path, config);
    return config;
}

void make_paths_absolute(Config &config)
{
    for (const Setting &setting : settings)
        if (const auto *member = std::get_if<std::string Config::*>(&setting.member))
            if (std::string &text = config.**member; is_path(setting, text))
                text = std::filesystem::absolute(text).lexically_normal();
}

void print_config(const Config &config, std::ostream &out)
{
    out << "# Settings of vdna_selectord. A key that is left out has its default. In paths, ~/ is "
           "the\n"
           "# home directory, and what does not begin with / begins in the folder of this file.\n";
    const bool by_frames = config.warmup_frames > 0;
    const std::string used = by_frames ? "frames" : "seconds";
    const std::string unused = by_frames ? "seconds" : "frames";
    std::string section;
    for (const Setting &setting : settings) {
        if (section != setting.section)
            out << "\n[" << setting.section << "]\n";
        section = setting.section;
        const bool is_unused = section == "warmup" && setting.key == unused;
        out << "# " << (is_unused ? unused + ", in place of " + used + ": " : "") << setting.about
            << limits_and_default(setting) << '\n';
        if (!is_unused)
            out << setting.key << " = " << text_of(setting, config) << '\n';
    }
}

} // namespace vdna::selectord
