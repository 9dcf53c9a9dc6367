#include "session.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "failure.hpp"

namespace vdna::backbone
{

namespace
{

std::string shape_text(const std::vector<int64_t> &shape)
{
    std::string text;
    for (const int64_t side : shape)
        text += (text.empty() ? "" : "x") + (side < 0 ? "?" : std::to_string(side));
    return text;
}

std::string listed(const std::vector<std::string> &names)
{
    std::string list;
    for (const std::string &name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list;
}

// Element type and shape of a tensor or of an input's declaration.
struct TensorType {
    ONNXTensorElementDataType element;
    std::vector<int64_t> shape; // -1 where it is left open
};

TensorType read_type(const Runtime &runtime, const OrtTensorTypeAndShapeInfo *info)
{
    const OrtApi &api = runtime.api();
    TensorType type{};
    size_t rank = 0;
    runtime.require(api.GetTensorElementType(info, &type.element), "read a type");
    runtime.require(api.GetDimensionsCount(info, &rank), "read a shape");
    type.shape.resize(rank);
    runtime.require(api.GetDimensions(info, type.shape.data(), rank), "read a shape");
    return type;
}

} // namespace

Session::Session(const Runtime &runtime, const Manifest &manifest, std::future<Model> model,
                 uint32_t threads)
    : runtime_(runtime), api_(runtime.api()), input_name_(manifest.input.name),
      input_shape_{1, 3, manifest.input.height, manifest.input.width},
      input_(size_t{3} * manifest.input.height * manifest.input.width), env_(make_env()),
      session_(make_session(std::move(model), threads)), run_options_(make_run_options()),
      input_value_(bind_input())
{
    check_input(manifest);

    // All of them before the first run: only what is requested is bound and handed out.
    const std::vector<std::string> available =
        model_names(api_.SessionGetOutputCount, api_.SessionGetOutputName);
    std::vector<std::string> wanted;
    for (const TappedOutput &tap : manifest.taps)
        wanted.push_back(tap.output);
    wanted.push_back(manifest.embedding.output);
    if (!manifest.embedding.last_layer.empty())
        wanted.push_back(manifest.embedding.last_layer);
    for (const std::string &output : wanted) {
        if (std::find(available.begin(), available.end(), output) == available.end())
            throw fail::Failure(VDNA_ERR_MISMATCH, manifest.model.string() + ": has no output '" +
                                                       output + "'; it has: " + listed(available));
        request(output);
    }
    bind_outputs();

    for (const TappedOutput &tap : manifest.taps)
        taps_.push_back(observe(tap.output, manifest));
    embedding_ = observe(manifest.embedding.output, manifest);
    if (!manifest.embedding.last_layer.empty())
        last_layer_ = observe(manifest.embedding.last_layer, manifest);
}

Handle<OrtEnv> Session::make_env() const
{
    OrtEnv *env = nullptr;
    runtime_.require(api_.CreateEnv(ORT_LOGGING_LEVEL_ERROR, "vdna", &env), "start");
    Handle<OrtEnv> owner(env, api_.ReleaseEnv);
    runtime_.require(api_.DisableTelemetryEvents(env), "disable telemetry");
    return owner;
}

Handle<OrtSession> Session::make_session(std::future<Model> checked, uint32_t threads) const
{
    OrtSessionOptions *options = nullptr;
    runtime_.require(api_.CreateSessionOptions(&options), "make options");
    const Handle<OrtSessionOptions> owner(options, api_.ReleaseSessionOptions);

    const auto set = [this](OrtStatus *status) { runtime_.require(status, "set an option"); };
    set(api_.SetSessionGraphOptimizationLevel(options, ORT_ENABLE_ALL));
    set(api_.SetIntraOpNumThreads(options, static_cast<int>(threads)));
    set(api_.SetInterOpNumThreads(options, 1));
    // Waiting threads would otherwise burn the cores that the robot needs for something else.
    set(api_.AddSessionConfigEntry(options, "session.intra_op.allow_spinning", "0"));
    set(api_.AddSessionConfigEntry(options, "session.inter_op.allow_spinning", "0"));
    // The arena is for what a run needs, so that memory is flat from the second run on; weights,
    // which it would round up to a power of two, are kept outside.
    set(api_.AddSessionConfigEntry(options, "session.use_device_allocator_for_initializers", "1"));

    const Model model = checked.get();
    OrtSession *session = nullptr;
    runtime_.require(api_.CreateSession(env_.get(), model.path().c_str(), options, &session),
                     "load " + model.name().string());
    Handle<OrtSession> loaded(session, api_.ReleaseSession);
    model.require_unchanged();
    return loaded;
}

Handle<OrtRunOptions> Session::make_run_options() const
{
    OrtRunOptions *options = nullptr;
    runtime_.require(api_.CreateRunOptions(&options), "make options");
    return {options, api_.ReleaseRunOptions};
}

Handle<OrtValue> Session::bind_input()
{
    OrtMemoryInfo *memory = nullptr;
    runtime_.require(api_.CreateCpuMemoryInfo(OrtDeviceAllocator, OrtMemTypeDefault, &memory),
                     "describe memory");
    const Handle<OrtMemoryInfo> owner(memory, api_.ReleaseMemoryInfo);
    OrtValue *value = nullptr;
    runtime_.require(
        api_.CreateTensorWithDataAsOrtValue(memory, input_.data(), input_.size() * sizeof input_[0],
                                            input_shape_.data(), input_shape_.size(),
                                            ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &value),
        "bind the input");
    return {value, api_.ReleaseValue};
}

std::vector<std::string> Session::model_names(CountNames count_names, GetName get_name) const
{
    OrtAllocator *allocator = nullptr;
    runtime_.require(api_.GetAllocatorWithDefaultOptions(&allocator), "find an allocator");
    size_t count = 0;
    runtime_.require(count_names(session_.get(), &count), "count names");
    std::vector<std::string> names;
    for (size_t i = 0; i < count; i++) {
        char *name = nullptr;
        runtime_.require(get_name(session_.get(), i, allocator, &name), "read a name");
        names.emplace_back(name);
        runtime_.require(api_.AllocatorFree(allocator, name), "free a name");
    }
    return names;
}

void Session::check_input(const Manifest &manifest) const
{
    const std::vector<std::string> names =
        model_names(api_.SessionGetInputCount, api_.SessionGetInputName);
    if (names != std::vector<std::string>{input_name_})
        throw fail::Failure(VDNA_ERR_MISMATCH, manifest.model.string() +
                                                   ": its inputs are: " + listed(names) +
                                                   "; the manifest expects only: " + input_name_);

    OrtTypeInfo *info = nullptr;
    runtime_.require(api_.SessionGetInputTypeInfo(session_.get(), 0, &info), "read the input");
    const Handle<OrtTypeInfo> owner(info, api_.ReleaseTypeInfo);
    const OrtTensorTypeAndShapeInfo *tensor = nullptr;
    runtime_.require(api_.CastTypeInfoToTensorInfo(info, &tensor), "read the input");
    const TensorType type = tensor ? read_type(runtime_, tensor) : TensorType{};

    bool fits = type.element == ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT &&
                type.shape.size() == input_shape_.size();
    for (size_t d = 0; fits && d < type.shape.size(); d++)
        fits = type.shape[d] < 0 || type.shape[d] == input_shape_[d];
    if (!fits)
        throw fail::Failure(VDNA_ERR_MISMATCH, manifest.model.string() + ": input '" + input_name_ +
                                                   "' has shape " + shape_text(type.shape) +
                                                   "; the manifest expects floats, " +
                                                   shape_text(input_shape_));
}

void Session::request(const std::string &output)
{
    if (std::find(output_names_.begin(), output_names_.end(), output) == output_names_.end())
        output_names_.push_back(output);
}

// The first run makes the output tensors, into which all later ones write, and shows how much
// memory a run needs; the second, of the test picture, takes that in one piece.
void Session::bind_outputs()
{
    for (const std::string &name : output_names_)
        output_name_texts_.push_back(name.c_str());
    output_values_.resize(output_names_.size(), nullptr);
    output_owners_.reserve(output_names_.size());
    run();
    for (OrtValue *value : output_values_)
        output_owners_.emplace_back(value, api_.ReleaseValue);
}

Output Session::observe(const std::string &output, const Manifest &manifest) const
{
    const auto found = std::find(output_names_.begin(), output_names_.end(), output);
    OrtValue *value = output_values_[static_cast<size_t>(found - output_names_.begin())];
    OrtTensorTypeAndShapeInfo *info = nullptr;
    runtime_.require(api_.GetTensorTypeAndShape(value, &info), "read an output");
    const Handle<OrtTensorTypeAndShapeInfo> owner(info, api_.ReleaseTensorTypeAndShapeInfo);
    const TensorType type = read_type(runtime_, info);

    const int64_t size = std::accumulate(type.shape.begin(), type.shape.end(), int64_t{1},
                                         [](int64_t a, int64_t b) { return a * b; });
    if (type.element != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT || type.shape.size() < 2 ||
        type.shape[0] != 1 || size < 1 || size > UINT32_MAX)
        throw fail::Failure(VDNA_ERR_MISMATCH, manifest.model.string() + ": output '" + output +
                                                   "' has shape " + shape_text(type.shape) +
                                                   "; expected floats, 1xN or 1xNxM...");
    float *values = nullptr;
    runtime_.require(api_.GetTensorMutableData(value, reinterpret_cast<void **>(&values)),
                     "read an output");
    return {{type.shape.begin() + 1, type.shape.end()}, values, static_cast<size_t>(size)};
}

void Session::run()
{
    const char *input_name = input_name_.c_str();
    const OrtValue *input = input_value_.get();
    runtime_.require(api_.Run(session_.get(), run_options_.get(), &input_name, &input, 1,
                              output_name_texts_.data(), output_name_texts_.size(),
                              output_values_.data()),
                     "run");
}

void Session::terminate() noexcept
{
    // It only raises a flag; should it fail, the caller's own flag still ends the next run.
    api_.ReleaseStatus(api_.RunOptionsSetTerminate(run_options_.get()));
}

} // namespace vdna::backbone
