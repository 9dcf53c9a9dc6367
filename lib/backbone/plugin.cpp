#include "plugin.hpp"

#include <cstddef>

#include <dlfcn.h>

#include "failure.hpp"

namespace vdna::backbone
{

namespace
{

constexpr const char *extension = ".so";
constexpr const char *entry = "vdna_backbone_plugin";

bool ends_with(const std::string &text, const std::string &end)
{
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Of a table that has as many bytes as ours.
std::string version_text(const vdna_backbone_operations &table)
{
    return table.struct_size == sizeof table ? " of version " + std::to_string(table.version) : "";
}

// The first operation that is missing; nullptr if none is.
const char *missing_in(const vdna_backbone_operations &table)
{
    return !table.open       ? "open"
           : !table.close    ? "close"
           : !table.describe ? "describe"
           : !table.run      ? "run"
           : !table.cancel   ? "cancel"
                             : nullptr;
}

} // namespace

bool is_plugin(const std::string &manifest)
{
    if (!ends_with(manifest, extension))
        return false;
    if (manifest.find('/') == std::string::npos)
        throw fail::Failure(VDNA_ERR_ARG, manifest +
                                              ": is no name of a manifest, and a plug-in is "
                                              "given by a path with a '/': ./" +
                                              manifest);
    return true;
}

vdna_backbone_operations checked(const vdna_backbone_operations *table, const std::string &whose)
{
    if (!table)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            whose + ": there is no table of operations; expected the address of "
                                    "a vdna_backbone_operations");
    // Beyond its stated size nothing of the table is there.
    if (table->struct_size != sizeof *table || table->version != VDNA_BACKBONE_OPERATIONS)
        throw fail::Failure(
            VDNA_ERR_UNSUPPORTED,
            whose + ": the table of operations has " + std::to_string(table->struct_size) +
                " bytes" + version_text(*table) + ", expected " + std::to_string(sizeof *table) +
                " bytes of version " + std::to_string(VDNA_BACKBONE_OPERATIONS) +
                "; build it with the vdna/backbone.h of this version");
    if (const char *const missing = missing_in(*table))
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            whose + ": the table of operations has no " + missing +
                                "; expected open, close, describe, run and cancel");
    return *table;
}

vdna_backbone_operations load_plugin(const std::string &path)
{
    // Never unloaded: its threads and thread-local destructors may outlive a network.
    void *const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!library)
        throw fail::Failure(VDNA_ERR_IO, path + ": the plug-in cannot be loaded: " + dlerror() +
                                             "; expected a shared library for this processor");
    using GetTable = const vdna_backbone_operations *(*)();
    const auto get_table = reinterpret_cast<GetTable>(dlsym(library, entry));
    if (!get_table)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            path + ": is no plug-in of vdna: it does not export " + entry +
                                "(); define that as vdna/backbone.h says");
    return checked(get_table(), path);
}

} // namespace vdna::backbone
