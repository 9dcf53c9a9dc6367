// The daemon's state in a sentence.
#include <string>

#include "cmocka.hpp"
#include "telemetry/headline.hpp"

namespace
{

using Json = nlohmann::ordered_json;

Json status_of(const char *state)
{
    return {
        {"state", state}, {"experience", "winter"}, {"reason", "it is dark"}, {"progress", 0.42}};
}

const Json by_distance{{"ranking",
                        {{{"experience", "winter"}, {"distance_bins", 7.409}},
                         {{"experience", "summer"}, {"distance_bins", 9.716}}}}};

void expect(const Json &status, const Json &ranking, double silent_s, const char *tone,
            const char *text)
{
    const vdna::telemetry::Headline line =
        vdna::telemetry::headline(status, ranking, silent_s, "udpm://x");
    assert_string_equal(line.text.c_str(), text);
    assert_string_equal(line.tone, tone);
}

void a_choice_by_distance_says_how_far(void **)
{
    expect(status_of("VALID"), by_distance, 0, "good",
           "Localising in winter, because it looks most like the warmup's frames: 7.41 bins away, "
           "summer 2.31 farther.");
    Json unsure = status_of("UNSURE");
    expect(unsure, by_distance, 0, "doubt", "Unsure of the place in winter: it is dark.");
    unsure["reason"] = "";
    expect(unsure, by_distance, 0, "doubt",
           "Unsure of the place, localising in winter, because it looks most like the warmup's "
           "frames: 7.41 bins away, summer 2.31 farther.");
}

void a_choice_by_recall_says_how_good(void **)
{
    Json ranking = by_distance;
    ranking["ranked_by"] = "transfer";
    Json &first = ranking["ranking"][0], &second = ranking["ranking"][1];
    first["predicted_recall"] = 0.94;
    second["predicted_recall"] = 0.89;
    expect(status_of("VALID"), ranking, 0, "good",
           "Localising in winter, because 94 % of its frames should be found, in summer 5 points "
           "fewer.");
    first["predicted_low"] = 0.88;
    first["predicted_high"] = 0.97;
    second["predicted_recall"] = 0.95; // the order is by another figure
    expect(
        status_of("VALID"), ranking, 0, "good",
        "Localising in winter, because 94 % of its frames should be found (88 to 97 %), in summer "
        "1 points more.");
    second["predicted_recall"] = nullptr;
    expect(status_of("VALID"), ranking, 0, "good",
           "Localising in winter, because it looks most like the warmup's frames: 7.41 bins away, "
           "summer 2.31 farther.");
}

void a_choice_says_no_reason_that_it_does_not_know(void **)
{
    expect(status_of("VALID"), nullptr, 0, "good",
           "Localising in winter; why was said before this program listened.");
    Json other = by_distance;
    other["ranking"][0]["experience"] = "night";
    expect(status_of("VALID"), other, 0, "good", "Localising in winter.");
    expect(status_of("VALID"), {{"ranking", {by_distance["ranking"][0]}}}, 0, "good",
           "Localising in winter, because the map has no other experience.");
}

void an_operator_is_a_reason(void **)
{
    Json status = status_of("VALID");
    status["pinned"] = "winter";
    expect(status, by_distance, 0, "good", "Localising in winter, because it is pinned.");
    status["state"] = "NONE_FITS";
    expect(status, by_distance, 0, "doubt",
           "Localising in winter, which does not fit: it is dark.");
    status = status_of("VALID");
    status["shadow"] = true;
    Json other = by_distance;
    other["ranking"][0]["experience"] = "night";
    expect(status, other, 0, "good", "Localising in winter, kept by shadow; recommended is night.");
}

void every_state_has_a_sentence(void **)
{
    expect(nullptr, nullptr, 7, "wait",
           "No daemon heard on udpm://x for 7 s: is vdna_selectord running, on this LCM network?");
    expect(status_of("VALID"), by_distance, 12.2, "bad",
           "No daemon heard on udpm://x for 12 s: it has ended, or the network is gone.");
    expect(status_of("WARMUP"), nullptr, 0, "wait",
           "Warming up: 42 % of the frames to choose by have come.");
    expect(status_of("STALE"), nullptr, 0, "bad", "No place is known: it is dark.");
    expect(status_of("DEGRADED"), nullptr, 0, "doubt",
           "The camera's frames cannot be trusted: it is dark.");
    expect(status_of("NONE_FITS"), nullptr, 0, "doubt",
           "No experience fits, winter is the least bad: it is dark.");
    expect(status_of("FAULT"), nullptr, 0, "bad", "No place is given: it is dark.");
    expect(status_of("STANDBY"), nullptr, 0, "wait", "Standing by: it is dark.");
    Json later = status_of("DREAMING");
    later.erase("reason");
    expect(later, nullptr, 0, "doubt", "In a state that this program does not know, DREAMING.");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_choice_by_distance_says_how_far),
        cmocka_unit_test(a_choice_by_recall_says_how_good),
        cmocka_unit_test(a_choice_says_no_reason_that_it_does_not_know),
        cmocka_unit_test(an_operator_is_a_reason),
        cmocka_unit_test(every_state_has_a_sentence),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
