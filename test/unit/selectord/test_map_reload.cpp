// Opening the map again in the background: what it gives, refuses, and remembers.
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

#include <cmocka.hpp>

#include <vdna/cpp/backbone.hpp>

#include "folder.hpp"
#include "selectord/map_reload.hpp"

using namespace vdna;
using namespace vdna::selectord;

namespace
{

constexpr uint64_t mib = uint64_t{1} << 20;

void write_experience(const Folder &folder, const std::string &name)
{
    const std::string command = VDNA_STUB_MAP " " + folder.path().string() + " " + name;
    assert_int_equal(std::system(command.c_str()), 0);
}

// A map of one experience that serves, and what it takes to open its directory again.
struct Reloads {
    explicit Reloads(MapReload::Room limits, uint32_t budget_mb = 0) : room(limits)
    {
        config.map_directory = folder.path();
        config.budget_mb = budget_mb;
        write_experience(folder, "winter");
        serving = std::make_unique<MapSession>(config, open_map(config), backbone.info());
    }

    // Wait for the end of a reload.
    std::unique_ptr<MapSession> take()
    {
        for (int patience = 0; patience < 10000; patience++) {
            std::unique_ptr<MapSession> next = reload.take();
            if (next)
                return next;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        fail_msg("the reload never ended");
        return nullptr;
    }

    // What it says is wrong.
    std::string refusal()
    {
        requested = true;
        assert_true(reload.begin(*serving));
        try {
            take();
        } catch (const Error &error) {
            return error.what();
        }
        fail_msg("the map was not refused");
        return "";
    }

    Folder folder;
    Config config;
    Backbone backbone{*vdna_backbone_plugin()};
    MapReload::Room room;
    std::atomic<bool> requested{false};
    std::unique_ptr<MapSession> serving;
    MapReload reload{config, backbone.info(), requested, room};
};

// It names the command of the one that runs.
void a_command_requests_one_and_one_more_may_wait(void **)
{
    Reloads reloads({mib, 0});
    assert_true(reloads.reload.request(7));
    assert_false(reloads.reload.request(8));
    assert_true(reloads.reload.begin(*reloads.serving));
    assert_int_equal(reloads.reload.utime(), 7);
    assert_true(reloads.reload.request(8));
    assert_false(reloads.reload.begin(*reloads.serving)); // one is running
    assert_non_null(reloads.take().get());
    reloads.requested = true; // one does for both
    assert_true(reloads.reload.begin(*reloads.serving));
    assert_int_equal(reloads.reload.utime(), 8);
    assert_non_null(reloads.take().get());
    assert_false(reloads.reload.begin(*reloads.serving));
    reloads.requested = true;
    assert_true(reloads.reload.begin(*reloads.serving));
    assert_int_equal(reloads.reload.utime(), 0);
    assert_non_null(reloads.take().get());
}

void nothing_begins_unless_it_is_requested(void **)
{
    Reloads reloads({mib, 0});
    assert_false(reloads.reload.begin(*reloads.serving));
    assert_null(reloads.reload.take().get());
}

void a_reload_gives_the_directory_as_it_is_now(void **)
{
    Reloads reloads({mib, 0});
    write_experience(reloads.folder, "spring");
    reloads.requested = true;
    assert_true(reloads.reload.begin(*reloads.serving));
    const std::unique_ptr<MapSession> next = reloads.take();
    assert_int_equal(next->experiences().size(), 2);
    assert_int_equal(reloads.serving->experiences().size(), 1);
    assert_null(reloads.reload.take().get());
}

void requests_during_a_reload_become_one_that_follows_it(void **)
{
    Reloads reloads({mib, 0});
    reloads.requested = true;
    assert_true(reloads.reload.begin(*reloads.serving));
    for (int i = 0; i < 3; i++) {
        reloads.requested = true;
        assert_false(reloads.reload.begin(*reloads.serving));
    }
    reloads.take();
    assert_true(reloads.reload.begin(*reloads.serving));
    reloads.take();
    assert_false(reloads.reload.begin(*reloads.serving));
}

void counts_go_on_where_the_map_before_ended(void **)
{
    Reloads reloads({mib, 0});
    const uint8_t pixels[64] = {};
    const vdna_image image{pixels, sizeof pixels, 8, 8, 0, VDNA_PIXEL_GREY};
    vdna_backbone_frame seen;
    assert_int_equal(vdna_backbone_run(reloads.backbone.get(), &image, nullptr, &seen), VDNA_OK);
    const vdna_select_frame frame{1000000, seen.taps, seen.tap_count, seen.embedding};
    vdna_select_answer answer;
    assert_int_equal(vdna_select_feed(reloads.serving->select(), &frame, &answer), VDNA_OK);

    reloads.requested = true;
    assert_true(reloads.reload.begin(*reloads.serving));
    const std::unique_ptr<MapSession> next = reloads.take();
    next->count_on_from(*reloads.serving);
    assert_int_equal(next->counts().accepted, 1);
    assert_int_equal(vdna_select_feed(next->select(), &frame, &answer), VDNA_OK);
    assert_int_equal(next->counts().accepted, 2);
}

void a_map_without_experiences_is_refused_by_name(void **)
{
    Reloads reloads({mib, 0});
    std::filesystem::remove(reloads.folder.path() / "winter.vdna");
    const std::string refusal = reloads.refusal();
    assert_non_null(std::strstr(refusal.c_str(), reloads.config.map_directory.c_str()));
}

void two_maps_must_fit_into_the_budget(void **)
{
    const std::string refusal = Reloads({mib, 2 * mib}, 2).refusal();
    assert_non_null(std::strstr(refusal.c_str(), "memory.budget_mb is 2, but 3 MiB"));

    Reloads enough({mib, 2 * mib}, 3);
    enough.requested = true;
    assert_true(enough.reload.begin(*enough.serving));
    assert_non_null(enough.take().get());
}

void a_ranking_must_fit_into_the_message(void **)
{
    const std::string refusal = Reloads({10, 0}).refusal();
    assert_non_null(std::strstr(refusal.c_str(), "expected at most 10"));
}

} // namespace

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_command_requests_one_and_one_more_may_wait),
        cmocka_unit_test(nothing_begins_unless_it_is_requested),
        cmocka_unit_test(a_reload_gives_the_directory_as_it_is_now),
        cmocka_unit_test(requests_during_a_reload_become_one_that_follows_it),
        cmocka_unit_test(counts_go_on_where_the_map_before_ended),
        cmocka_unit_test(a_map_without_experiences_is_refused_by_name),
        cmocka_unit_test(two_maps_must_fit_into_the_budget),
        cmocka_unit_test(a_ranking_must_fit_into_the_message),
    };
    return cmocka_run_group_tests_name("map_reload", tests, nullptr, nullptr);
}
