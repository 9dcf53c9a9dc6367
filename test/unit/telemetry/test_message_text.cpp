// Messages as text. Samples are made from the tables of their types.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include <vdna_messages.h>
#include <vdna_msg_command_result_t.h>
#include <vdna_msg_command_t.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

#include "cmocka.hpp"
#include "message_sample.h"
#include "telemetry/message_text.hpp"

namespace
{

using vdna::telemetry::View;
using vdna::telemetry::views;

// The number that a sample has in each int64_t.
constexpr int64_t sample_number = 0x3131313131313131;

void every_kind_of_message_is_shown_as_the_type_that_it_is(void **)
{
    for (const View &view : views()) {
        void *const message = sample_new(view.type);
        const nlohmann::ordered_json json = view.json(message);
        assert_string_equal(json["type"].get<std::string>().c_str(), view.name);
        assert_int_equal(json["utime"].get<int64_t>(), sample_number);
        assert_int_equal(view.text(message).find(view.name), 0);
        sample_free(view.type, message);
    }
}

void a_line_of_json_is_the_message_after_its_channel(void **)
{
    for (const View &view : views()) {
        void *const message = sample_new(view.type);
        const std::string line = vdna::telemetry::json_line(view, "FRONT\xff", message);
        assert_int_equal(line.find("{\"channel\":\"FRONT\xef\xbf\xbd\",\"type\":"), 0);
        assert_int_equal(line.find('\n'), std::string::npos);
        nlohmann::ordered_json json = nlohmann::ordered_json::parse(line);
        json.erase("channel");
        assert_string_equal(json.dump().c_str(), view.json(message).dump().c_str());
        assert_ptr_equal(&vdna::telemetry::view_of(*view.type), &view);
        sample_free(view.type, message);
    }
}

// Is there a member whose values have names in the .lcm file?
bool has_named_values(const vdna_message_type &type)
{
    const std::set<std::string> named{"state", "validity"};
    return std::any_of(
        type.members, type.members + type.member_count,
        [&](const vdna_message_member &member) { return named.count(member.name) > 0; });
}

void a_value_of_a_later_version_is_shown_as_unknown(void **)
{
    for (const View &view : views()) {
        if (!has_named_values(*view.type))
            continue;
        void *const message = sample_new(view.type);
        assert_true(view.text(message).find("UNKNOWN") != std::string::npos);
        assert_true(view.json(message).dump().find("\"UNKNOWN\"") != std::string::npos);
        sample_free(view.type, message);
    }
}

const View &view_of(const vdna_message_type &type)
{
    return *std::find_if(views().begin(), views().end(),
                         [&](const View &view) { return view.type == &type; });
}

// The text and JSON of a valid answer with a position in this frame.
std::pair<std::string, nlohmann::ordered_json> answer_in(const char *frame)
{
    char experience[] = "snow", nothing[] = "";
    std::string name = frame;
    vdna_msg_localisation_t answer{};
    answer.validity = VDNA_MSG_LOCALISATION_T_VALID;
    answer.experience = experience;
    answer.reason = nothing;
    answer.has_position = 1;
    answer.position_frame = name.data();
    answer.position[0] = 48.12345678;
    answer.position[1] = -11.5;
    answer.position[2] = 519.25;
    const View &view = view_of(vdna_message_localisation);
    return {view.text(&answer), view.json(&answer)};
}

void a_position_on_the_globe_is_shown_in_degrees_to_the_centimetre(void **)
{
    const auto [text, json] = answer_in("wgs84");
    assert_true(text.find("position 48.1234568 -11.5000000, height 519.25 m") != std::string::npos);
    assert_string_equal(json["position_frame"].get<std::string>().c_str(), "wgs84");
    assert_true(json["position"] == nlohmann::ordered_json({48.12345678, -11.5, 519.25}));
}

void a_position_in_a_local_frame_is_shown_in_metres_with_the_frame(void **)
{
    const auto [text, json] = answer_in("depot");
    assert_true(text.find("position 48.12 -11.50 519.25 m in depot") != std::string::npos);
    assert_string_equal(json["position_frame"].get<std::string>().c_str(), "depot");
}

void an_unsure_answer_says_how_unsure(void **)
{
    char experience[] = "snow", frame[] = "", nothing[] = "";
    vdna_msg_localisation_t answer{};
    answer.validity = VDNA_MSG_LOCALISATION_T_UNSURE;
    answer.experience = experience;
    answer.reason = nothing;
    answer.position_frame = frame;
    answer.frame = 7;
    answer.confidence = 0.25;
    answer.nearest_frame = 9;
    answer.distance = 0.5;
    const View &view = view_of(vdna_message_localisation);
    assert_string_equal(view.text(&answer).c_str(), "localisation UNSURE snow frame 7, confidence "
                                                    "0.25 (standing), nearest 9 at 0.500 (0.0 ms)");
    const nlohmann::ordered_json json = view.json(&answer);
    assert_string_equal(json["validity"].get<std::string>().c_str(), "UNSURE");
    assert_true(json["confidence"] == 0.25 && json["moving"] == false);
    assert_true(json["frame"] == 7 && json["nearest_frame"] == 9 && json["distance"] == 0.5);
}

// A message of a type, made from its table, to be changed.
template <typename Message>
class Sample
{
  public:
    explicit Sample(const vdna_message_type &type)
        : type_(type), message_(static_cast<Message *>(sample_new(&type)))
    {
    }
    ~Sample() { sample_free(&type_, message_); }
    Sample(const Sample &) = delete;
    Sample &operator=(const Sample &) = delete;
    Message *operator->() { return message_; }
    std::string text() const { return view_of(type_).text(message_); }
    nlohmann::ordered_json json() const { return view_of(type_).json(message_); }

  private:
    const vdna_message_type &type_;
    Message *const message_;
};

// Give a message another text; it frees its texts.
void set_text(char *&member, const char *text)
{
    std::free(member);
    member = strdup(text);
}

// A ranking of one experience, "text".
void fill_ranking(Sample<vdna_msg_ranking_t> &ranking)
{
    set_text(ranking->ranked_by, "emd");
    set_text(ranking->verdict, "");
    set_text(ranking->previous, "");
    set_text(ranking->no_prediction, "");
    ranking->validity = VDNA_MSG_RANKING_T_VALID;
    ranking->window_frames = 42;
    ranking->margin_bins = 1.75;
    ranking->count = 1;
    ranking->distance_bins[0] = 5.5;
    ranking->tied[0] = 0;
    ranking->predicted_recall[0] = 0.75;
    ranking->predicted_low[0] = 0.5;
    ranking->predicted_high[0] = 1;
    ranking->skill = NAN;
    ranking->unlike = NAN;
}

void a_ranking_says_by_what_it_ranks_and_what_to_expect(void **)
{
    Sample<vdna_msg_ranking_t> ranking(vdna_message_ranking);
    fill_ranking(ranking);
    assert_string_equal(ranking.text().c_str(),
                        "ranking      VALID after 42 frames, by emd, margin 1.750 bins, backbone "
                        "text\n             selected text of 1 after 42 frames: expects 75 % (50 "
                        "to 100) of frames right\n          1  text                             "
                        "    5.500 bins, predicted recall 0.75 (0.50 to 1.00)");
    set_text(ranking->no_prediction, "why");
    assert_true(ranking.text().find("; no prediction: why\n") != std::string::npos);
    set_text(ranking->previous, "snow");
    assert_true(ranking.text().find(" in place of snow, ") != std::string::npos);
    ranking->repeated = 0;
    assert_true(ranking.json()["repeated"] == false);
    ranking->repeated = 1;
    assert_true(ranking.json()["repeated"] == true);
    ranking->count = SAMPLE_COUNT; // for the end of it
}

void a_ranking_says_what_does_not_fit_and_what_would_help(void **)
{
    Sample<vdna_msg_ranking_t> ranking(vdna_message_ranking);
    fill_ranking(ranking);
    ranking->validity = VDNA_MSG_RANKING_T_NONE_FITS;
    set_text(ranking->verdict, "unlike");
    ranking->predicted_recall[0] = NAN;
    assert_string_equal(ranking.text().c_str(),
                        "ranking      NONE_FITS unlike after 42 frames, by emd, margin 1.750 "
                        "bins, backbone text\n             none of 1 experiences looks like this "
                        "run; record one now with `vdna build`\n          1  text                "
                        "                 5.500 bins");
    assert_true(ranking.json()["ranking"][0]["predicted_low"] == 0.5);
    ranking->count = SAMPLE_COUNT;
}

void a_ranking_says_why_with_the_neurons_that_tell_its_first_two_apart(void **)
{
    Sample<vdna_msg_ranking_t> ranking(vdna_message_ranking);
    fill_ranking(ranking);
    ranking->count = ranking->reasons = 2;
    ranking->neurons = 1280;
    for (int i = 0; i < 2; i++) {
        ranking->reason_neuron[i] = 512 + i;
        ranking->reason_bins[i] = i == 0 ? 0.5 : -0.25;
        ranking->live_bin[i] = 100.5;
        ranking->winner_bin[i] = 110.25;
        ranking->runner_up_bin[i] = 400.75;
        ranking->winner_most[i] = i == 0 ? 7 : -1;
    }
    const std::string text = ranking.text();
    assert_true(
        text.find("\n             text is 1.75 bins nearer than text: 2 of 1280 neurons make "
                  "14 % of it\n             text 512: +0.5000 bins, mean bin live 100.5, "
                  "first 110.2, second 400.8\n             text 513: -0.2500 bins") !=
        std::string::npos);
    const nlohmann::ordered_json json = ranking.json();
    assert_true(json["neurons"] == 1280 && json["reasons"].size() == 2);
    assert_true(json["reasons"][0]["tap"] == "text" && json["reasons"][0]["neuron"] == 512);
    assert_true(json["reasons"][0]["winner_most"] == 7 && json["reasons"][1]["bins"] == -0.25);
    assert_true(json["reasons"][1]["runner_up_bin"] == 400.75);

    ranking->reasons = 0;
    assert_true(ranking.text().find("nearer") == std::string::npos);
    assert_true(ranking.json()["reasons"].empty());
    ranking->count = ranking->reasons = SAMPLE_COUNT;
}

void where_no_experience_fits_there_is_a_place_and_in_a_changed_map_none(void **)
{
    Sample<vdna_msg_localisation_t> answer(vdna_message_localisation);
    answer->frame = 7;
    answer->validity = VDNA_MSG_LOCALISATION_T_NONE_FITS;
    assert_int_equal(answer.text().find("localisation NONE_FITS text frame 7"), 0);
    assert_true(answer.json()["frame"] == 7);
    answer->validity = VDNA_MSG_LOCALISATION_T_FAULT;
    assert_int_equal(answer.text().find("localisation FAULT: text"), 0);
    assert_true(answer.json()["frame"].is_null());
}

void every_state_has_a_name_of_its_own(void **)
{
    std::set<std::string> names;
    Sample<vdna_msg_status_t> status(vdna_message_status);
    for (status->state = 0; status->state <= VDNA_MSG_STATUS_T_STANDBY; status->state++)
        names.insert(status.json()["state"].get<std::string>());
    assert_int_equal(names.size(), 8);
    assert_int_equal(names.count("UNKNOWN"), 0);
}

void a_status_says_what_of_the_map_is_not_in_use(void **)
{
    Sample<vdna_msg_status_t> status(vdna_message_status);
    status->left_out = 1;
    status->predicted_recall = NAN;
    const std::string text = status.text();
    assert_true(text.find(", 1 experience left out, the map's directory has changed\n") !=
                std::string::npos);
    assert_int_equal(status.json()["left_out"].get<int>(), 1);
    assert_true(status.json()["map_changed"] == true);
    status->left_out = status->map_changed = 0;
    assert_true(status.text().find("left out") == std::string::npos);
    assert_true(status.text().find("changed") == std::string::npos);
}

void a_status_says_what_an_operator_wants(void **)
{
    Sample<vdna_msg_status_t> status(vdna_message_status);
    assert_true(status.text().find(", pinned: text, in shadow, excluded: text text text, ") !=
                std::string::npos);
    assert_string_equal(status.json()["pinned"].get<std::string>().c_str(), "text");
    assert_true(status.json()["shadow"] == true);
    assert_int_equal(status.json()["excluded"].size(), 3);
    const int32_t excluded = std::exchange(status->excluded_count, 0);
    status->pinned[0] = '\0';
    status->shadow = 0;
    for (const char *const word : {"pinned", "shadow", "excluded"})
        assert_true(status.text().find(word) == std::string::npos);
    status->excluded_count = excluded; // so that all are freed
}

void a_result_says_what_became_of_which_command(void **)
{
    Sample<vdna_msg_command_result_t> result(vdna_message_command_result);
    result->command = VDNA_MSG_COMMAND_T_PIN;
    assert_string_equal(result.text().c_str(), "result       pin accepted: text (map text)");
    assert_string_equal(result.json()["command"].get<std::string>().c_str(), "pin");
    result->accepted = 0;
    result->command = 77;
    assert_int_equal(result.text().find("result       unknown command refused: "), 0);
}

void the_frames_that_came_too_late_are_shown(void **)
{
    void *const status = sample_new(&vdna_message_status);
    const View &view = view_of(vdna_message_status);
    assert_true(view.text(status).find(", late " + std::to_string(sample_number)) !=
                std::string::npos);
    assert_int_equal(view.json(status)["late"].get<int64_t>(), sample_number);
    sample_free(&vdna_message_status, status);
}

void every_kind_of_message_has_a_type_a_name_and_a_channel_of_its_own(void **)
{
    std::set<const vdna_message_type *> types;
    std::set<std::string> names, channels;
    for (const View &view : views()) {
        types.insert(view.type);
        names.insert(view.name);
        channels.insert(view.channel);
    }
    assert_int_equal(types.size(), views().size());
    assert_int_equal(names.size(), views().size());
    assert_int_equal(channels.size(), views().size());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_line_of_json_is_the_message_after_its_channel),
        cmocka_unit_test(every_kind_of_message_is_shown_as_the_type_that_it_is),
        cmocka_unit_test(a_status_says_what_an_operator_wants),
        cmocka_unit_test(a_result_says_what_became_of_which_command),
        cmocka_unit_test(a_value_of_a_later_version_is_shown_as_unknown),
        cmocka_unit_test(a_position_on_the_globe_is_shown_in_degrees_to_the_centimetre),
        cmocka_unit_test(a_position_in_a_local_frame_is_shown_in_metres_with_the_frame),
        cmocka_unit_test(an_unsure_answer_says_how_unsure),
        cmocka_unit_test(a_ranking_says_by_what_it_ranks_and_what_to_expect),
        cmocka_unit_test(a_ranking_says_what_does_not_fit_and_what_would_help),
        cmocka_unit_test(a_ranking_says_why_with_the_neurons_that_tell_its_first_two_apart),
        cmocka_unit_test(where_no_experience_fits_there_is_a_place_and_in_a_changed_map_none),
        cmocka_unit_test(every_state_has_a_name_of_its_own),
        cmocka_unit_test(a_status_says_what_of_the_map_is_not_in_use),
        cmocka_unit_test(the_frames_that_came_too_late_are_shown),
        cmocka_unit_test(every_kind_of_message_has_a_type_a_name_and_a_channel_of_its_own),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
