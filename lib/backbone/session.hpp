// One network in ONNX Runtime, its input and outputs bound once.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "manifest.hpp"
#include "model.hpp"
#include "runtime.hpp"

namespace vdna::backbone
{

template <class T>
using Handle = std::unique_ptr<T, void (*)(T *)>;

// What one output holds after each Session::run(), at an address that never changes.
struct Output {
    std::vector<int64_t> shape; // without the batch, which is 1
    const float *values;
    size_t size; // product of `shape`
};

class Session
{
  public:
    // Load the model when it is there, check it against the manifest, and run it twice on the mean
    // colour, so that later runs are warm. `runtime` must outlive the session. Throws Failure
    // (VDNA_ERR_IO, VDNA_ERR_MISMATCH, VDNA_ERR_RUNTIME).
    Session(const Runtime &runtime, const Manifest &manifest, std::future<Model> model,
            uint32_t threads);

    // [3][height][width], to be filled before run().
    float *input() { return input_.data(); }

    // One per tap in the manifest's order, that of the embedding, and that of the last layer,
    // without values if the manifest names none. Nothing else is computed.
    const std::vector<Output> &taps() const { return taps_; }
    const Output &embedding() const { return embedding_; }
    const Output &last_layer() const { return last_layer_; }

    // Throws Failure (VDNA_ERR_RUNTIME).
    void run();

    // End a run() in progress early, and all later ones. Any thread.
    void terminate() noexcept;

  private:
    using CountNames = decltype(OrtApi::SessionGetOutputCount);
    using GetName = decltype(OrtApi::SessionGetOutputName);

    Handle<OrtEnv> make_env() const;
    Handle<OrtSession> make_session(std::future<Model> checked, uint32_t threads) const;
    Handle<OrtRunOptions> make_run_options() const;
    Handle<OrtValue> bind_input();
    void check_input(const Manifest &manifest) const;
    std::vector<std::string> model_names(CountNames count_names, GetName get_name) const;
    void request(const std::string &output);
    void bind_outputs();
    Output observe(const std::string &output, const Manifest &manifest) const;

    const Runtime &runtime_;
    const OrtApi &api_;
    std::string input_name_;
    std::vector<int64_t> input_shape_;
    std::vector<float> input_;
    Handle<OrtEnv> env_;
    Handle<OrtSession> session_;
    Handle<OrtRunOptions> run_options_;
    Handle<OrtValue> input_value_;

    // What is requested, each output once, in the form that OrtApi::Run takes.
    std::vector<std::string> output_names_;
    std::vector<const char *> output_name_texts_;
    std::vector<OrtValue *> output_values_;
    std::vector<Handle<OrtValue>> output_owners_;

    std::vector<Output> taps_;
    Output embedding_;
    Output last_layer_{};
};

} // namespace vdna::backbone
