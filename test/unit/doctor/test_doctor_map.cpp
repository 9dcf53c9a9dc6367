// The doctor's checks of map, network and daemon, each broken on purpose.
#include "doctor/map.hpp"
#include "verdicts.hpp"

using namespace vdna::doctor;

namespace
{

const Settings settings;

MapFacts good()
{
    MapFacts map;
    map.experiences = 3;
    map.frames = 360;
    map.hash = "0123456789abcdef";
    map.network = "efficientnet_lite0";
    map.precision = "fp32";
    map.sha256 = std::string(64, 'a');
    map.trust = "predicted recall from 3 labelled of 3 experiences";
    return map;
}

// What a daemon of this machine, `here`, says while all is well.
Heard served()
{
    Heard heard;
    heard.status = {{"host", "here"},       {"version", "1.0"}, {"map_hash", good().hash},
                    {"map_changed", false}, {"state", "VALID"}, {"experience", "winter"}};
    return heard;
}

Verdict daemon_of(const Heard &heard, const MapFacts &map = good())
{
    return check_daemon(settings, map, heard, "1.0", "here");
}

void a_good_map_is_described(void **)
{
    expect_ok(check_files(settings, good()), "3 experiences, 360 frames, hash 01234567");
    expect_ok(check_network(good()), "efficientnet_lite0 fp32, sha256 aaaaaaaa, is the map's");
    expect_ok(check_trust(good()), "predicted recall from 3");
    expect_ok(daemon_of(served()), "1.0 on here, same map: VALID");
}

void a_map_that_cannot_be_opened_fails(void **)
{
    MapFacts map = good();
    map.refusal = "/map: cannot be read: Permission denied; give this user the right to read it";
    expect_failure(check_files(settings, map), "Permission denied", "give this user");
    expect_unknown(check_trust(map), "see files");
    expect_ok(check_network(map), "opens");
}

void a_damaged_experience_is_a_warning(void **)
{
    MapFacts map = good();
    map.left_out = {"/map/dusk.vdna: its checksum is false; copy it again", "another"};
    expect_warning(check_files(settings, map), "dusk.vdna: its checksum is false",
                   "copy it again; 1 more");
}

void a_network_that_cannot_be_opened_or_is_not_the_maps_fails(void **)
{
    MapFacts map = good();
    map.mismatch = "/map: does not compare; use the map's backbone";
    expect_failure(check_network(map), "does not compare", "use the map's");
    map.network_refusal = "x.onnx: SHA-256 is a, expected b; fetch it again";
    expect_failure(check_network(map), "SHA-256 is a", "fetch it again");
}

void a_map_that_predicts_nothing_is_a_warning(void **)
{
    MapFacts map = good();
    map.no_prediction = "trust.safetensors: is stale; make it again with `vdna calibrate --trust`";
    expect_warning(check_trust(map), "no predicted recall: trust.safetensors: is stale",
                   "vdna calibrate --trust");
}

void no_daemon_is_no_failure(void **)
{
    expect_unknown(daemon_of(Heard{}), "none heard on VDNA_STATUS");
}

void a_daemon_of_another_version_fails(void **)
{
    Heard heard = served();
    heard.status["version"] = "0.9";
    expect_failure(daemon_of(heard), "version 0.9, this is 1.0", "restart");
}

void a_daemon_with_another_map_fails(void **)
{
    Heard heard = served();
    heard.status["map_changed"] = true;
    expect_failure(daemon_of(heard), "another map", "reload");
    heard = served();
    heard.status["map_hash"] = "ffffffffffffffff";
    expect_failure(daemon_of(heard), "ffffffff, than /var/lib/vdna/map has, 01234567", "SIGHUP");
    heard.status["host"] = "there"; // whose maps are not ours
    expect_ok(daemon_of(heard), "a machine of its own: VALID");
}

void a_daemon_in_trouble_says_why(void **)
{
    Heard heard = served();
    heard.status["state"] = "STALE";
    heard.status["reason"] = "no frame for 3 s";
    expect_failure(daemon_of(heard), "No place is known: no frame for 3 s", "no-answers.md");
    heard.status["state"] = "DEGRADED";
    expect_warning(daemon_of(heard), "cannot be trusted", "no-answers.md");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_good_map_is_described),
        cmocka_unit_test(a_map_that_cannot_be_opened_fails),
        cmocka_unit_test(a_damaged_experience_is_a_warning),
        cmocka_unit_test(a_network_that_cannot_be_opened_or_is_not_the_maps_fails),
        cmocka_unit_test(a_map_that_predicts_nothing_is_a_warning),
        cmocka_unit_test(no_daemon_is_no_failure),
        cmocka_unit_test(a_daemon_of_another_version_fails),
        cmocka_unit_test(a_daemon_with_another_map_fails),
        cmocka_unit_test(a_daemon_in_trouble_says_why),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
