#include "runtime.hpp"

#include <cstdlib>
#include <vector>

#include <dlfcn.h>

#include "beside_program.hpp"
#include "failure.hpp"

namespace vdna::backbone
{

namespace
{

// The first version of the C API that has all that is used here; later runtimes still offer it.
constexpr uint32_t api_version = 17;

std::vector<std::string> candidates(const char *path)
{
    if (path)
        return {path};
    if (const char *chosen = std::getenv("VDNA_ONNXRUNTIME"))
        return {chosen};
    std::vector<std::string> all = {"libonnxruntime.so", "libonnxruntime.so.1"};
    const std::string installed = beside_program(VDNA_INSTALLED_ONNXRUNTIME);
    if (!installed.empty())
        all.insert(all.begin(), installed);
    return all;
}

void *load(const char *path)
{
    // Official builds from 1.29 on write files below the home directory and start a thread when
    // they are loaded, and only the environment, which is the whole process's, can stop it: the
    // API's own switch comes too late.
    setenv("ORT_DISABLE_TELEMETRY", "1", 0);

    std::string tried;
    for (const std::string &candidate : candidates(path)) {
        // Never unloaded: its threads and thread-local destructors may outlive a session.
        if (void *library = dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE))
            return library;
        tried += (tried.empty() ? "" : "; ") + std::string(dlerror());
    }
    throw fail::Failure(VDNA_ERR_RUNTIME, "ONNX Runtime cannot be loaded: " + tried +
                                              "; set VDNA_ONNXRUNTIME to a libonnxruntime.so");
}

} // namespace

Runtime::Runtime(const char *path)
{
    void *library = load(path);
    using GetApiBase = const OrtApiBase *(*)();
    const auto get_api_base = reinterpret_cast<GetApiBase>(dlsym(library, "OrtGetApiBase"));
    if (!get_api_base)
        throw fail::Failure(VDNA_ERR_RUNTIME, std::string(dlerror()) + "; this is no ONNX Runtime");
    version_ = get_api_base()->GetVersionString();
    api_ = get_api_base()->GetApi(api_version);
    if (!api_)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED, "ONNX Runtime " + version_ + " is too old: 1." +
                                                      std::to_string(api_version) +
                                                      " or later is needed");
}

void Runtime::require(OrtStatus *status, const std::string &doing) const
{
    if (!status)
        return;
    const std::string reason = api_->GetErrorMessage(status);
    api_->ReleaseStatus(status);
    throw fail::Failure(VDNA_ERR_RUNTIME,
                        "ONNX Runtime " + version_ + ": " + doing + ": " + reason);
}

} // namespace vdna::backbone
