#include <cmath>

#include "cmocka.hpp"
#include "eval/reference_maps.hpp"
#include "eval/seqslam.hpp"
#include "record/localisation.hpp"
#include "seqslam_golden.h"

using namespace vdna;

namespace
{

record::Recording recording_of(const float *embeddings, uint32_t frames)
{
    record::Recording recording;
    recording.frames = frames;
    recording.embeddings.assign(embeddings, embeddings + size_t{DIM} * frames);
    return recording;
}

void answers_are_those_of_numpy(void **)
{
    const record::Recording live = recording_of(golden_live, LIVE_FRAMES);
    const record::Recording map = recording_of(golden_map, MAP_FRAMES);
    const std::vector<uint32_t> asked(std::begin(golden_asked), std::end(golden_asked));
    const std::vector<eval::Answer> answers =
        eval::seqslam({live, BEGIN, asked.front() - BEGIN, asked, DIM}, eval::map_of(map, DIM));
    assert_int_equal(answers.size(), asked.size());
    for (size_t i = 0; i < answers.size(); i++) {
        assert_int_equal(answers[i].frame, golden_answers[i]);
        assert_false(answers[i].confidence.has_value());
    }
}

void local_contrasts_agree_with_numpy(void **)
{
    std::vector<double> distances;
    for (uint32_t j = 0; j < MAP_FRAMES; j++)
        distances.push_back(record::embedding_distance(golden_live + size_t{DIM} * BEGIN,
                                                       golden_map + size_t{DIM} * j, DIM));
    const std::vector<double> contrast = eval::local_contrast(distances);
    for (size_t j = 0; j < MAP_FRAMES; j++)
        assert_true(std::fabs(contrast[j] - golden_contrast[j]) <= 1e-12);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(answers_are_those_of_numpy),
        cmocka_unit_test(local_contrasts_agree_with_numpy),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
