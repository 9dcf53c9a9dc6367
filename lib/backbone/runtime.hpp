// ONNX Runtime, loaded when it is needed: a linked one would demand its exact version.
#pragma once

#include <string>

#include <onnxruntime_c_api.h>

namespace vdna::backbone
{

class Runtime
{
  public:
    // Load libonnxruntime.so from `path`, or, if it is NULL, from $VDNA_ONNXRUNTIME, else from
    // the installation of the running program, else the system's. It stays loaded until the
    // process ends.
    // Throws Failure (VDNA_ERR_RUNTIME, VDNA_ERR_UNSUPPORTED).
    explicit Runtime(const char *path);

    const OrtApi &api() const { return *api_; }
    const std::string &version() const { return version_; }

    // Throw Failure (VDNA_ERR_RUNTIME) with what was being done, unless a call went well.
    void require(OrtStatus *status, const std::string &doing) const;

  private:
    const OrtApi *api_;
    std::string version_;
};

} // namespace vdna::backbone
