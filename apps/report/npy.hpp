// NumPy's .npy files, format version 1.0: a short header and the numbers, row by row.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vdna::report
{

// Each writes a whole file or throws Error. The numbers fill the shape.
void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<float> &values);
void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<double> &values);
void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<int64_t> &values);

} // namespace vdna::report
