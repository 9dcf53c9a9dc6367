// round_trip SAMPLES OUT: decode each sample, encode it again. <messages.h> includes the generated
// headers and lists the types.
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <messages.h>

namespace
{

template <typename Message>
void round_trip(const std::string &from, const std::string &to, const std::string &name)
{
    std::ifstream in(from + "/" + name, std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    const int size = static_cast<int>(bytes.size());
    Message message;
    if (message.decode(bytes.data(), 0, size) != size)
        throw std::runtime_error("cannot decode " + name);
    bytes.assign(static_cast<size_t>(message.getEncodedSize()), '\0');
    if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0)
        throw std::runtime_error("cannot encode " + name);
    std::ofstream(to + "/" + name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

} // namespace

int main(int argc, char **argv)
try {
    const std::vector<std::string> folders(argv + 1, argv + argc);
#define MESSAGE(package, type) \
    round_trip<package::type>(folders.at(0), folders.at(1), #package "." #type);
    MESSAGES
} catch (const std::exception &error) {
    std::cerr << "round_trip: " << error.what() << '\n';
    return 1;
}
