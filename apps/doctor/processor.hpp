// What computes: ONNX Runtime, the processor's instructions, its frequency, the number of cores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "doctor/map.hpp"

namespace vdna::doctor
{

struct ProcessorFacts {
    std::set<std::string> instructions; // as /proc/cpuinfo names them; none = it does not tell
    std::vector<std::string> governors; // of each processor that has one
    std::string driver;                 // of the frequency
    std::set<unsigned> allowed;         // processors that this process may use; none = not known
};

ProcessorFacts read_processor(const std::filesystem::path &root);

// built_with: the minor version of ONNX Runtime 1 whose header we were built with
Verdict check_runtime(const MapFacts &map, unsigned built_with);
Verdict check_features(const ProcessorFacts &processor, const MapFacts &map);
Verdict check_governor(const ProcessorFacts &processor);
Verdict check_cores(const ProcessorFacts &processor, const Settings &settings);

} // namespace vdna::doctor
