#include "report/npy.hpp"

#include "program/replaced_file.hpp"

namespace vdna::report
{

namespace
{

// Numbers are written as they are in memory; all our machines are little-endian ('<').
template <typename Number>
void write(const std::string &path, const char *type, const std::vector<size_t> &shape,
           const std::vector<Number> &values)
{
    std::string header =
        std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (";
    for (const size_t side : shape)
        header += std::to_string(side) + ", ";
    header += "), }";
    // Magic, version, length and header add up to a multiple of 64 bytes and end in a newline.
    constexpr size_t before = 10;
    header.append(63 - (before + header.size()) % 64, ' ');
    header += '\n';

    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size() & 0xff);
    bytes += static_cast<char>(header.size() >> 8);
    bytes += header;
    bytes.append(reinterpret_cast<const char *>(values.data()), values.size() * sizeof(Number));
    program::replace_file(path, bytes);
}

} // namespace

void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<float> &values)
{
    write(path, "<f4", shape, values);
}

void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<double> &values)
{
    write(path, "<f8", shape, values);
}

void write_npy(const std::string &path, const std::vector<size_t> &shape,
               const std::vector<int64_t> &values)
{
    write(path, "<i8", shape, values);
}

} // namespace vdna::report
