// What viewers are told, and what is kept for them.
#include <string>
#include <thread>

#include "cmocka.hpp"
#include "serve/live_state.hpp"

namespace
{

using namespace std::chrono_literals;
using vdna::serve::LiveState;

constexpr auto patience = 60s;

void who_joins_late_gets_the_newest_of_each_kind(void **)
{
    LiveState state;
    state.put("status", "1");
    state.put("ranking", "2");
    state.put("status", "3");
    const LiveState::News news = state.news_after(0, patience);
    assert_string_equal(news.text.c_str(), "event: ranking\ndata: 2\n\nevent: status\ndata: 3\n\n");
    assert_string_equal(state.news_after(news.seen, 0ms).text.c_str(), "");
}

void only_what_is_new_is_told(void **)
{
    LiveState state;
    state.put("status", "1");
    state.put("ranking", "2");
    const uint64_t seen = state.news_after(0, patience).seen;
    state.put("status", "1"); // as before
    assert_string_equal(state.news_after(seen, 0ms).text.c_str(), "");
    state.put("status", "4");
    assert_string_equal(state.news_after(seen, patience).text.c_str(),
                        "event: status\ndata: 4\n\n");
}

void the_oldest_points_go(void **)
{
    LiveState state;
    for (size_t i = 0; i <= LiveState::points_max; i++)
        state.add_point("p" + std::to_string(i) + ".");
    const LiveState::News news = state.news_after(0, patience);
    assert_int_equal(news.text.find("event: point\ndata: p1.\n\n"), 0);
    assert_true(news.text.find("p" + std::to_string(LiveState::points_max) + ".") !=
                std::string::npos);
}

void closing_ends_every_wait(void **)
{
    LiveState state;
    std::thread waiting([&] {
        state.news_after(0, patience);
        state.pause(patience);
    });
    const auto begin = std::chrono::steady_clock::now();
    state.close();
    waiting.join();
    assert_true(std::chrono::steady_clock::now() - begin < patience / 2);
    assert_true(state.is_closed());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(who_joins_late_gets_the_newest_of_each_kind),
        cmocka_unit_test(only_what_is_new_is_told),
        cmocka_unit_test(the_oldest_points_go),
        cmocka_unit_test(closing_ends_every_wait),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
