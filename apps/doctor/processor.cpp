#include "doctor/processor.hpp"

#include <algorithm>
#include <sstream>

#include "doctor/network.hpp"
#include "doctor/system_files.hpp"

namespace vdna::doctor
{

namespace
{

std::vector<std::string> read_governors(const std::filesystem::path &root)
{
    std::vector<std::string> governors;
    std::error_code none;
    for (const auto &entry :
         std::filesystem::directory_iterator(root / "sys/devices/system/cpu", none))
        if (const std::string governor = read_line(entry.path() / "cpufreq/scaling_governor");
            !governor.empty())
            governors.push_back(governor);
    return governors;
}

bool is_arm(const ProcessorFacts &processor)
{
    return processor.instructions.count("asimd") > 0;
}

// By which products of 8-bit numbers are summed in 32 bits; "" if by none.
std::string int8_instructions(const ProcessorFacts &processor)
{
    for (const char *name : {"avx512_vnni", "avx_vnni", "asimddp"})
        if (processor.instructions.count(name) > 0)
            return name;
    return "";
}

// What networks are computed by; "" if the processor has nothing of it.
std::string vector_instructions(const ProcessorFacts &processor)
{
    for (const char *name : {"avx512f", "avx2", "asimd"})
        if (processor.instructions.count(name) > 0)
            return name;
    return "";
}

bool saves_power(const ProcessorFacts &processor)
{
    // With these drivers, powersave is dynamic.
    const bool is_dynamic =
        processor.driver == "intel_pstate" || processor.driver.rfind("amd-pstate", 0) == 0;
    const std::vector<std::string> &all = processor.governors;
    return !is_dynamic && std::find(all.begin(), all.end(), "powersave") != all.end();
}

} // namespace

ProcessorFacts read_processor(const std::filesystem::path &root)
{
    ProcessorFacts processor;
    const std::string about = read_text(root / "proc/cpuinfo").value_or("");
    std::istringstream names(value_of(about, "flags") + value_of(about, "Features"));
    for (std::string name; names >> name;)
        processor.instructions.insert(name);
    processor.governors = read_governors(root);
    processor.driver = read_line(root / "sys/devices/system/cpu/cpu0/cpufreq/scaling_driver");
    const std::string self = read_text(root / "proc/self/status").value_or("");
    processor.allowed =
        numbers_of_list(value_of(self, "Cpus_allowed_list")).value_or(std::set<unsigned>{});
    return processor;
}

Verdict check_runtime(const MapFacts &map, unsigned built_with)
{
    constexpr const char *ours = "onnxruntime 1.";
    const std::string expected = ours + std::to_string(built_with);
    if (map.runtime.empty())
        return unknown("the network is not open: see network");
    if (map.runtime.rfind(ours, 0) != 0)
        return ok(map.runtime); // a plug-in's
    const uint64_t minor = number_in(map.runtime.substr(std::string(ours).size())).value_or(0);
    if (minor < built_with)
        return warn(map.runtime + " is older than " + expected + ", with which this was built",
                    "install the package vdna-networks, or set VDNA_ONNXRUNTIME to a newer "
                    "libonnxruntime.so");
    return ok(map.runtime + ", built with 1." + std::to_string(built_with));
}

Verdict check_features(const ProcessorFacts &processor, const MapFacts &map)
{
    if (processor.instructions.empty())
        return unknown("the system does not name the processor's instructions");
    const std::string vectors = vector_instructions(processor);
    const std::string products = int8_instructions(processor);
    if (map.precision == "int8" && products.empty())
        return broken("no " + std::string(is_arm(processor) ? "asimddp" : "VNNI") +
                          ": an int8 network gives other numbers here",
                      "use the network of 32-bit floats: manifest in [backbone], and its map");
    if (vectors.empty())
        return warn("no AVX2: a network takes several times as long",
                    "expect fewer frames a second, or take a newer processor");
    return ok(vectors + "; int8 networks " +
              (products.empty() ? "do not run" : "run, by " + products));
}

Verdict check_governor(const ProcessorFacts &processor)
{
    const std::vector<std::string> &all = processor.governors;
    if (all.empty())
        return unknown("no frequency is scaled here, or none is told");
    const std::set<std::string> names(all.begin(), all.end());
    std::string list;
    for (const std::string &name : names)
        list += (list.empty() ? "" : ", ") + name;
    if (saves_power(processor))
        return warn(list + ": the processor stays at its lowest frequency",
                    "echo performance | sudo tee "
                    "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
    return ok(list + " on " + std::to_string(all.size()) + " processors");
}

Verdict check_cores(const ProcessorFacts &processor, const Settings &settings)
{
    if (processor.allowed.empty())
        return unknown("the system does not tell which processors may be used");
    std::set<unsigned> used = processor.allowed;
    if (!settings.affinity.empty()) {
        used = numbers_of_list(settings.affinity).value_or(std::set<unsigned>{});
        if (used.empty() || !std::includes(processor.allowed.begin(), processor.allowed.end(),
                                           used.begin(), used.end()))
            return broken("affinity is \"" + settings.affinity +
                              "\", but not all of these processors may be used here",
                          "correct affinity " + section_of("cpu", settings) +
                              "; see `taskset -p $$`");
    }
    const std::string found = std::to_string(used.size()) + " for " +
                              std::to_string(settings.threads) + " threads of the network";
    if (used.size() < settings.threads)
        return warn(found, "set threads = " + std::to_string(used.size()) + " " +
                               section_of("backbone", settings));
    return ok(found);
}

} // namespace vdna::doctor
