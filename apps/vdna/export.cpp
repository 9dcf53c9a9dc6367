// vdna export - turns experiences into C arrays, for programs without a file system.
#include <cctype>
#include <filesystem>
#include <iostream>
#include <map>
#include <string_view>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"
#include "program/replaced_file.hpp"
#include "record/experiences.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct ExportOptions {
    std::vector<std::string> paths;
    bool c_array = false;
    std::string out = ".";
};

// A prefix keeps it from beginning with a digit, from being a keyword, and from being a function of
// the library.
std::string identifier_of(const vdna_experience &e)
{
    std::string identifier = "experience_";
    for (const char c : std::string_view(e.name))
        identifier += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return identifier;
}

// Decimal numbers, which take the least space, in lines of at most 100 characters.
void append_numbers(std::string_view bytes, std::string &text)
{
    std::string line = "   ";
    for (const char byte : bytes) {
        const std::string number = std::to_string(static_cast<unsigned char>(byte)) + ',';
        if (line.size() + number.size() > 100) {
            text += line + '\n';
            line = "   ";
        }
        line += number;
    }
    text += line + '\n';
}

std::string identity_of(const vdna_experience &e)
{
    const vdna_identity &identity = e.identity;
    return " * frames         " + std::to_string(e.frames) + //
           "\n * backbone       " + identity.backbone +      //
           " (" + vdna_identity_precision(&identity) + ")" + //
           "\n * model_sha256   " + identity.model_sha256 +  //
           "\n * neurons, bins  " + std::to_string(identity.neurons) + ", " +
           std::to_string(identity.bins) + //
           "\n * embeddings     " + std::to_string(identity.dim) +
           (e.embedding_codes ? " codes of vdna/int8.h" : " floats") + //
           "\n * comparable     " + e.comparable + '\n';
}

std::string c_source_of(const vdna_experience &e, const std::string &identifier)
{
    const std::string size = std::to_string(e.file_size);
    std::string text = "/* " + identifier + ": the experience " + e.name + ", " + size +
                       " bytes, written by `vdna export --c-array`.\n *\n" + identity_of(e) +
                       R"( *
 * For vdna_experience_open_memory(). In another file:
 *
 *     extern const unsigned char )" +
                       identifier + "[];\n *     extern const size_t " + identifier + "_size;\n" +
                       R"( *
 * VDNA_FLASH places it in a section of your own: -DVDNA_FLASH='section(".flash")'. */
#include <stddef.h>

#if !defined(__GNUC__)
#define VDNA_PLACED _Alignas(8)
#elif defined(VDNA_FLASH)
#define VDNA_PLACED __attribute__((aligned(8), VDNA_FLASH))
#else
#define VDNA_PLACED __attribute__((aligned(8)))
#endif

extern const unsigned char )" +
                       identifier + "[" + size + "];\nextern const size_t " + identifier +
                       "_size;\n\nVDNA_PLACED const unsigned char " + identifier + "[" + size +
                       "] = {\n";
    append_numbers({static_cast<const char *>(e.file_bytes), e.file_size}, text);
    return text + "};\n\nconst size_t " + identifier + "_size = sizeof " + identifier + ";\n";
}

// Two symbols of an experience: its bytes and their size.
void refuse_collisions(const std::vector<Experience> &files)
{
    std::map<std::string, std::string> symbols;
    for (const Experience &file : files)
        for (const std::string &symbol :
             {identifier_of(*file.get()), identifier_of(*file.get()) + "_size"}) {
            const auto [first, is_new] = symbols.try_emplace(symbol, file.path().string());
            if (!is_new)
                throw Error(file.path().string() + ": would be " + symbol + " in C, as " +
                            first->second +
                            " is; export them into programs of their own, or rebuild one with "
                            "--name");
        }
}

bool names_a_file(const std::string &out)
{
    return std::filesystem::path(out).extension() == ".c";
}

void export_arrays(const ExportOptions &options)
{
    const std::vector<Experience> files = record::open_experiences(options.paths);
    if (names_a_file(options.out) && files.size() != 1)
        throw program::UsageError("--output " + options.out +
                                  ": a file for one experience, but there are " +
                                  std::to_string(files.size()) + "; give a folder");
    refuse_collisions(files);
    if (!names_a_file(options.out))
        program::make_directory(options.out);
    for (const Experience &file : files) {
        const std::string identifier = identifier_of(*file.get());
        const std::filesystem::path path =
            names_a_file(options.out) ? std::filesystem::path(options.out)
                                      : std::filesystem::path(options.out) / (identifier + ".c");
        program::replace_file(path.string(), c_source_of(*file.get(), identifier));
        std::cout << path.string() << ": " << identifier << ", " << file->file_size << " bytes\n";
    }
}

} // namespace

void add_export(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("export", "Turn experiences into C arrays, for flash memory");
    const auto options = std::make_shared<ExportOptions>();
    command->add_option("PATH", options->paths, "experience files, or map directories")
        ->type_name("PATH")
        ->required();
    command
        ->add_flag("--c-array", options->c_array,
                   "write C: for each experience NAME an array experience_NAME of the bytes of its "
                   "file, aligned, and experience_NAME_size; other characters than letters and "
                   "digits become '_'")
        ->required();
    command
        ->add_option("-o,--output", options->out,
                     "folder for experience_NAME.c, made if it is not there; or, for one "
                     "experience, a file that ends in .c")
        ->type_name("PATH")
        ->capture_default_str();
    command->footer("Thumbnails are for people: build a map for flash with --no-thumbnails.\n\n"
                    "Examples:\n"
                    "  vdna export park --c-array -o firmware\n"
                    "  vdna export park/winter.vdna --c-array -o winter.c");
    command->callback([options] { export_arrays(*options); });
}

} // namespace vdna::tool
