// Embeddings and rankings in another precision, on numbers to check by hand.
#include <cmath>

#include <cmocka.hpp>

#include <vdna/cpp/error.hpp>

#include "eval/precision_change.hpp"

using namespace vdna;
using namespace vdna::eval;

// One query, traversal 0, against references 1, 2 and 3.
static Evaluation evaluation(const std::vector<double> &distance, const std::vector<double> &recall)
{
    Evaluation e;
    e.references = {1, 2, 3};
    e.recall = recall;
    e.methods.push_back({"vdna", distance, {}});
    e.queries.push_back({0, 0, 2, {}, {}, {}, {}});
    for (size_t i = 0; i < recall.size(); i++) {
        PairResult pair{e.references[i], {}, {}};
        pair.outcome.recall[0] = recall[i];
        e.queries.front().pairs.push_back(pair);
    }
    return e;
}

static Traversal traversal(const std::vector<float> &embeddings)
{
    Traversal t;
    t.recording.frames = static_cast<uint32_t>(embeddings.size() / 2);
    t.recording.embeddings = embeddings;
    t.files.resize(t.recording.frames);
    return t;
}

static void assert_near(double found, double expected)
{
    if (!(std::fabs(found - expected) < 1e-9))
        fail_msg("found %g, expected %g", found, expected);
}

static void pairs_in_another_order_are_counted(void **)
{
    const RankingChange change =
        ranking_change(evaluation({1, 2, 4}, {90, 80, 70}), evaluation({3, 2, 1}, {60, 50, 40}));
    assert_int_equal(change.queries.size(), 1);
    assert_int_equal(change.queries[0].swaps, 3);
    assert_int_equal(change.queries[0].first[0], 1);
    assert_int_equal(change.queries[0].first[1], 3);
    assert_near(change.queries[0].recall[0], 90);
    assert_near(change.queries[0].recall[1], 40);
    assert_near(change.recall[0], 80);
    assert_near(change.recall[1], 50);

    const RankingChange once =
        ranking_change(evaluation({1, 2, 4}, {90, 80, 70}), evaluation({1, 5, 4}, {90, 80, 70}));
    assert_int_equal(once.queries[0].swaps, 1);
    assert_int_equal(once.queries[0].first[1], 1);
}

static void distances_change_relative_to_the_first_network(void **)
{
    const RankingChange change =
        ranking_change(evaluation({1, 2, 4}, {90, 80, 70}), evaluation({1.5, 2, 3}, {90, 80, 70}));
    assert_int_equal(change.pairs, 3);
    assert_near(change.emd_percent.median, 25);
    assert_near(change.emd_percent.max, 50);
}

static void embeddings_change_relative_to_the_first_network(void **)
{
    const EmbeddingChange change =
        embedding_change({traversal({3, 4, 1, 0}), traversal({2, 0})},
                         {traversal({3, 3, 0, 1}), traversal({1, 0})}, 2);
    assert_int_equal(change.pictures, 3);
    assert_near(change.l2_percent.median, 50);
    assert_near(change.l2_percent.max, 100 * std::sqrt(2.0));
    assert_near(change.cosine_distance.median, 1 - 21 / (5 * std::sqrt(18.0)));
    assert_near(change.cosine_distance.max, 1);
}

static void pictures_that_only_one_network_could_use_are_told(void **)
{
    try {
        embedding_change({traversal({3, 4, 1, 0})}, {traversal({3, 4})}, 2);
    } catch (const Error &error) {
        assert_true(std::string(error.what()).find("one network gave no numbers") !=
                    std::string::npos);
        return;
    }
    fail_msg("%s", "two frames were compared with one");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(pairs_in_another_order_are_counted),
        cmocka_unit_test(distances_change_relative_to_the_first_network),
        cmocka_unit_test(embeddings_change_relative_to_the_first_network),
        cmocka_unit_test(pictures_that_only_one_network_could_use_are_told),
    };
    return cmocka_run_group_tests_name("precision_change", tests, nullptr, nullptr);
}
