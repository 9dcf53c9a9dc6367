// Localising on a route that passes its places again and again, with the default network.
#include <filesystem>

#include <vdna/cpp/experience_localiser.hpp>

#include "cmocka.hpp"
#include "folder.hpp"
#include "record/truth.hpp"
#include "simulate/recording.hpp"

namespace
{

namespace record = vdna::record;
namespace simulate = vdna::simulate;

constexpr double tolerance_m = 5, step_m = 3;
constexpr uint32_t lap = 84, warmup = 10; // frames: 252 m

// The default network's view of a rendered drive along the figure of eight.
record::Recording drive(vdna::Backbone &backbone, const std::string &condition, uint32_t frames,
                        uint64_t seed)
{
    const Folder scratch;
    const simulate::Route route(11, simulate::Shape::eight);
    simulate::DriveConfig config;
    config.step_m = step_m;
    config.variation = .6f;
    config.seed = seed;
    simulate::RecordingConfig recording;
    recording.size = {96, 72};
    recording.frames = frames;
    const std::string pictures = (scratch.path() / "pictures").string();
    simulate::record_drive(pictures, route, simulate::find_condition(condition),
                           simulate::Drive(route, config), recording);
    record::Recording recorded;
    for (record::Pass pass(pictures, {}, backbone); pass.next();)
        recorded.add(pass);
    return recorded;
}

struct Figures {
    double recall, confidence; // means over the frames after the warmup, 0..1
};

Figures figures_of(vdna_localise *localiser, const record::Recording &live,
                   const vdna_experience &map)
{
    const record::Truth truth(live, map);
    Figures sum{};
    for (uint32_t i = 0; i < live.frames; i++) {
        vdna_localise_answer answer{};
        if (i < warmup)
            assert_int_equal(vdna_localise_warm_up(localiser, live.embedding(i)), VDNA_OK);
        else
            assert_int_equal(vdna_localise_feed(localiser, live.embedding(i), &answer), VDNA_OK);
        sum.recall += i >= warmup && truth.apart(i, answer.frame) <= tolerance_m;
        sum.confidence += answer.confidence;
    }
    const double frames = live.frames - warmup;
    return {sum.recall / frames, sum.confidence / frames};
}

void places_make_the_filter_surer_where_the_map_passes_them_twice(void **)
{
    vdna::Backbone backbone("efficientnet_lite0", 2);
    const record::Recording laps = drive(backbone, "summer", 2 * lap, 1),
                            live = drive(backbone, "autumn", lap + lap / 4, 2);
    vdna_experience map{};
    map.identity = backbone.info().identity;
    map.frames = laps.frames;
    map.embeddings = laps.embeddings.data();
    map.frame_position = laps.position.data();
    laps.position_frame.copy(map.position_frame, VDNA_NAME_SIZE - 1);

    vdna::ExperienceLocaliser by_place(map, tolerance_m);
    const vdna::LocaliserMap frames(map.embeddings, map.frames, map.identity.dim, "summer");
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.tolerance = vdna::places_of(map, tolerance_m).tolerance;
    vdna::Localiser by_frame(frames, config, "summer");

    const Figures places = figures_of(by_place.get(), live, map),
                  alone = figures_of(by_frame.get(), live, map);
    print_message("places: recall %.3f, confidence %.3f; frames alone: %.3f, %.3f\n", places.recall,
                  places.confidence, alone.recall, alone.confidence);
    assert_true(places.recall >= .94 && places.recall >= alone.recall);
    assert_true(places.confidence > alone.confidence);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(places_make_the_filter_surer_where_the_map_passes_them_twice),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
