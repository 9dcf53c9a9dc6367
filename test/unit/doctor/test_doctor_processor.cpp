// The doctor's checks of what computes, each broken on purpose.
#include "doctor/processor.hpp"
#include "system_root.hpp"
#include "verdicts.hpp"

using namespace vdna::doctor;

namespace
{

// Two processors with these instructions, governor and driver.
ProcessorFacts with(const std::string &about, const std::string &governor,
                    const std::string &driver = "acpi-cpufreq")
{
    SystemRoot root;
    root.write("proc/cpuinfo", about);
    root.write("proc/self/status", "Name:\tvdna\nCpus_allowed:\t3\nCpus_allowed_list:\t0-1\n");
    for (const char *cpu : {"cpu0", "cpu1"}) {
        const std::string folder = std::string("sys/devices/system/cpu/") + cpu + "/cpufreq/";
        root.write(folder + "scaling_governor", governor + "\n");
        root.write(folder + "scaling_driver", driver + "\n");
    }
    return read_processor(root.path());
}

constexpr const char *with_vnni = "processor\t: 0\nflags\t\t: fpu avx2 avx512f avx512_vnni\n";

void a_good_processor_is_described(void **)
{
    const ProcessorFacts processor = with(with_vnni, "performance");
    expect_ok(check_features(processor, {}), "avx512f; int8 networks run, by avx512_vnni");
    expect_ok(check_governor(processor), "performance on 2 processors");
    expect_ok(check_cores(processor, {}), "2 for 2 threads");
    expect_ok(check_features(with("Features\t: fp asimd asimddp\n", ""), {}), "asimd");
}

void a_system_that_tells_nothing_is_no_failure(void **)
{
    const SystemRoot root;
    const ProcessorFacts processor = read_processor(root.path());
    expect_unknown(check_features(processor, {}), "instructions");
    expect_unknown(check_governor(processor), "frequency");
    expect_unknown(check_cores(processor, {}), "processors");
    expect_unknown(check_runtime({}, 28), "see network");
}

void an_older_runtime_is_a_warning(void **)
{
    MapFacts map;
    map.runtime = "onnxruntime 1.28.0";
    expect_ok(check_runtime(map, 28), "onnxruntime 1.28.0, built with 1.28");
    expect_warning(check_runtime(map, 29), "is older than onnxruntime 1.29", "vdna-networks");
    map.runtime = "grey levels";
    expect_ok(check_runtime(map, 29), "grey levels");
}

void an_int8_network_without_its_instructions_fails(void **)
{
    MapFacts map;
    map.precision = "int8";
    expect_ok(check_features(with(with_vnni, ""), map), "int8 networks run");
    expect_failure(check_features(with("flags\t: avx2\n", ""), map), "no VNNI", "32-bit floats");
    expect_failure(check_features(with("Features\t: asimd\n", ""), map), "no asimddp", "floats");
}

void a_processor_without_vectors_is_a_warning(void **)
{
    expect_warning(check_features(with("flags\t: fpu sse2\n", ""), {}), "no AVX2",
                   "frames a second");
}

void a_governor_that_saves_power_is_a_warning(void **)
{
    expect_warning(check_governor(with(with_vnni, "powersave")), "lowest frequency",
                   "echo performance | sudo tee");
    expect_ok(check_governor(with(with_vnni, "powersave", "intel_pstate")), "powersave");
}

void fewer_processors_than_threads_are_a_warning(void **)
{
    Settings settings;
    settings.threads = 4;
    expect_warning(check_cores(with(with_vnni, ""), settings), "2 for 4 threads", "threads = 2");
    settings.affinity = "1";
    expect_warning(check_cores(with(with_vnni, ""), settings), "1 for 4 threads", "threads = 1");
}

void processors_that_are_not_there_fail(void **)
{
    Settings settings;
    for (const char *affinity : {"0,7", "x", "1-"}) {
        settings.affinity = affinity;
        expect_failure(check_cores(with(with_vnni, ""), settings), affinity, "correct affinity");
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_good_processor_is_described),
        cmocka_unit_test(a_system_that_tells_nothing_is_no_failure),
        cmocka_unit_test(an_older_runtime_is_a_warning),
        cmocka_unit_test(an_int8_network_without_its_instructions_fails),
        cmocka_unit_test(a_processor_without_vectors_is_a_warning),
        cmocka_unit_test(a_governor_that_saves_power_is_a_warning),
        cmocka_unit_test(fewer_processors_than_threads_are_a_warning),
        cmocka_unit_test(processors_that_are_not_there_fail),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
