// The live terminal's screen: exactly, in screen_*.txt beside this file, and within any window.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "cmocka.hpp"
#include "watch/display_text.hpp"
#include "watch/screen.hpp"

namespace
{

using namespace vdna::watch;
using vdna::telemetry::Newest;
using Json = Newest::Json;

constexpr const char *url = "udpm://239.255.76.67:7667?ttl=0";
constexpr int64_t second_us = 1000000;
constexpr int64_t now_us = 100 * second_us;

const Json status{
    {"utime", 1700000001000000},
    {"state", "VALID"},
    {"instance", 1},
    {"host", "robot"},
    {"reason", ""},
    {"frame_age_us", 140000},
    {"progress", 1},
    {"experience", "winter"},
    {"experiences", 3},
    {"backbone", "efficientnet_lite0"},
    {"version", "0.1.0"},
    {"received", 1210},
    {"processed", 1204},
    {"skipped", 6},
    {"total", {{"p50_us", 16600}, {"p99_us", 68640}}},
    {"resident_bytes", 86000000},
    {"resident_bytes_max", 91000000},
    {"message", "frames come late, 2 so far"},
};

const Json ranking{
    {"window_frames", 40},
    {"margin_bins", 2.314},
    {"ranked_by", "transfer"},
    {"previous", ""},
    {"no_prediction", ""},
    {"ranking",
     {{{"experience", "winter"},
       {"distance_bins", 7.4},
       {"tied", false},
       {"predicted_recall", 0.94},
       {"predicted_low", 0.88},
       {"predicted_high", 0.97}},
      {{"experience", "summer 2024"},
       {"distance_bins", 9.714},
       {"tied", true},
       {"predicted_recall", 0.61},
       {"predicted_low", 0.5},
       {"predicted_high", 0.7}},
      {{"experience", "夜の道"},
       {"distance_bins", 9.714},
       {"tied", true},
       {"predicted_recall", nullptr}}}},
};

const Json answer{
    {"validity", "VALID"},          {"experience", "winter"}, {"frame", 79},
    {"confidence", 0.97},           {"moving", true},         {"position_frame", "local"},
    {"position", {39.5, -1.83, 0}},
};

// What a listener knows that has heard all of these half a second ago; null is not heard.
Newest heard(const Json &of_status, const Json &of_ranking, const Json &of_answer)
{
    Newest newest(now_us - 9 * second_us);
    const int64_t then_us = now_us - second_us / 2;
    if (of_status.is_object()) {
        Json older = of_status;
        older["utime"] = of_status["utime"].get<int64_t>() - second_us;
        older["received"] = of_status["received"].get<int64_t>() - 10;
        newest.take("status", older, then_us);
        newest.take("status", of_status, then_us);
    }
    if (of_ranking.is_object())
        newest.take("ranking", of_ranking, then_us);
    if (of_answer.is_object())
        newest.take("localisation", of_answer, then_us);
    return newest;
}

Json with(Json message, const char *name, const Json &value)
{
    message[name] = value;
    return message;
}

// Lines as text, without the blanks at their ends.
std::string text_of(const std::vector<Line> &lines)
{
    std::string text;
    for (const Line &line : lines) {
        for (const Span &span : line)
            text += span.text;
        text.erase(text.find_last_not_of(' ') + 1);
        text += "\n";
    }
    return text;
}

std::string shown(const Newest &newest, Size size, int64_t at_us = now_us)
{
    return text_of(screen(newest, url, at_us, size));
}

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

void expect_contains(const std::string &text, const std::string &part)
{
    if (!contains(text, part))
        fail_msg("no \"%s\" in\n%s", part.c_str(), text.c_str());
}

void expect_fits(const Newest &newest, Size size, int64_t at_us = now_us)
{
    const std::vector<Line> lines = screen(newest, url, at_us, size);
    assert_true(static_cast<int>(lines.size()) <= size.rows);
    for (const Line &line : lines)
        if (width_of(line) > size.columns)
            fail_msg("%d cells of %d:\n%s", width_of(line), size.columns, text_of(lines).c_str());
}

void expect_screen(Size size)
{
    const std::string name =
        "screen_" + std::to_string(size.columns) + "x" + std::to_string(size.rows) + ".txt";
    std::stringstream expected;
    expected << std::ifstream(std::string(VDNA_SCREENS) + "/" + name).rdbuf();
    const std::string found = shown(heard(status, ranking, answer), size);
    if (found != expected.str()) {
        std::ofstream(name) << found;
        fail_msg("differs from %s/%s; it is in ./%s:\n%s", VDNA_SCREENS, name.c_str(), name.c_str(),
                 found.c_str());
    }
}

void screens_are_exactly_these(void **)
{
    expect_screen({80, 24});
    expect_screen({40, 10});
    expect_screen({200, 60});
}

Json many(int count)
{
    Json large = ranking;
    for (int i = 3; i < count; i++)
        large["ranking"].push_back({{"experience", "drive " + std::to_string(i)},
                                    {"distance_bins", 10 + i},
                                    {"tied", false},
                                    {"bound", i >= 5},
                                    {"predicted_recall", 0.5}});
    return large;
}

void of_a_hundred_candidates_the_first_are_shown_and_the_chosen_one(void **)
{
    const Newest newest = heard(with(status, "experience", "drive 99"), many(100), answer);
    const std::string text = shown(newest, {80, 24});
    expect_contains(text, "Candidates  7 of 100");
    expect_contains(text, "  winter");
    expect_contains(text, "> drive 99");
    assert_false(contains(text, "  drive 99"));
    const std::string all = shown(newest, {80, 120});
    expect_contains(all, "  drive 98");
    expect_contains(all, " 14.00 ");
    expect_contains(all, " ≥15.00 ");
}

void every_window_is_kept_to(void **)
{
    const Json controls = with(with(status, "experience", "\x1b[2J\n\xff"), "host", "\x1b]0;x\x07");
    const Newest all[] = {
        heard(status, ranking, answer),
        heard(status, many(100), answer),
        heard(controls, ranking, with(answer, "experience", std::string(300, '\x01'))),
        heard(with(status, "message", std::string(3000, 'x')), ranking, answer),
        heard(with(status, "experience", ""), nullptr, nullptr),
        heard(with(status, "experience", ""), {{"ranking", Json::array()}}, nullptr),
        heard(status, {{"ranking", {{{"experience", "冬"}, {"distance_bins", nullptr}}}}}, answer),
        heard(nullptr, ranking, nullptr),
        heard(nullptr, nullptr, nullptr),
    };
    for (const Newest &newest : all)
        for (const int64_t at_us : {now_us, now_us + 9 * second_us})
            for (int columns = 1; columns <= 210; columns += columns < 90 ? 1 : 40)
                for (const int rows : {1, 2, 3, 9, 10, 23, 24, 60})
                    expect_fits(newest, {columns, rows}, at_us);
}

void no_text_has_a_control_character(void **)
{
    const Json named = with(ranking, "previous", "a\x1b[31mb\xc2\x9b");
    const std::string text =
        shown(heard(with(status, "state", "\x1b[5m"), named, answer), {80, 24});
    for (const char c : text)
        assert_true(c == '\n' || static_cast<unsigned char>(c) >= ' ');
    expect_contains(text, "a?[31mb?");
}

void a_silent_daemon_is_one_of_the_past(void **)
{
    const Newest newest = heard(status, ranking, answer);
    const std::vector<Line> lines = screen(newest, url, now_us + 9 * second_us, {80, 24});
    const std::string text = text_of(lines);
    expect_contains(text, "SILENT ");
    expect_contains(text, "for 10 s");
    expect_contains(text, "newest 9.6 s ago");
    int faint = 0;
    for (const Line &line : lines)
        faint += !line.empty() && line.front().tone == Tone::faint;
    assert_in_range(faint, 12, 20); // all but the first lines
    expect_contains(shown(Newest(now_us), {80, 24}, now_us + 4 * second_us), "WAITING ");
}

void a_warmup_has_its_progress_in_place_of_a_place(void **)
{
    Json warmup = with(with(status, "experience", ""), "state", "WARMUP");
    warmup["progress"] = 0.42;
    const std::string text = shown(heard(warmup, ranking, answer), {80, 24});
    expect_contains(text, "Warmup      ████████▌░░░░░░░░░░░ 42 %");
    expect_contains(text, "of the last warmup");
    assert_false(contains(text, "Place"));
    expect_contains(shown(heard(warmup, nullptr, nullptr), {80, 24}), "none ranked yet");
}

void what_is_not_known_is_not_shown(void **)
{
    Json bare = ranking;
    bare["ranked_by"] = "emd";
    bare["no_prediction"] = "the map knows nothing about itself";
    for (Json &entry : bare["ranking"])
        entry["predicted_recall"] = nullptr;
    const Json refused{{"validity", "REFUSED"}, {"reason", "it is dark"}, {"experience", nullptr}};
    const std::string text =
        shown(heard(with(status, "frame_age_us", -1), bare, refused), {80, 24});
    expect_contains(text, "by distance\n");
    expect_contains(text, "Recall is not predicted: the map knows nothing about itself");
    expect_contains(text, "Place       none, REFUSED: it is dark");
    expect_contains(text, "Camera      10.0 frames/s, 1204 of 1210 used");
    assert_false(contains(text, "%"));
    expect_contains(
        shown(heard(with(with(status, "received", 0), "processed", 0), bare, refused), {80, 24}),
        "Camera      no frame yet");
}

void what_cannot_be_read_is_a_problem_even_without_a_daemon(void **)
{
    Newest newest(now_us);
    newest.note_rejected("VDNA_STATUS", "a message of another type or version");
    expect_contains(shown(newest, {80, 24}), "Problems    A message was left out: VDNA_STATUS: a");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(screens_are_exactly_these),
        cmocka_unit_test(of_a_hundred_candidates_the_first_are_shown_and_the_chosen_one),
        cmocka_unit_test(every_window_is_kept_to),
        cmocka_unit_test(no_text_has_a_control_character),
        cmocka_unit_test(a_silent_daemon_is_one_of_the_past),
        cmocka_unit_test(a_warmup_has_its_progress_in_place_of_a_place),
        cmocka_unit_test(what_is_not_known_is_not_shown),
        cmocka_unit_test(what_cannot_be_read_is_a_problem_even_without_a_daemon),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
