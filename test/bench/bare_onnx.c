/* bare_onnx LIBRARY MODEL THREADS OUTPUT... - the peer of the daemon: ONNX Runtime alone, on a
 * prepared input, for the outputs that the daemon reads.
 *
 * For each number on standard input, runs that many inferences and prints the seconds of each in
 * one line; exits at the end of input. The options are those of lib/backbone, and nothing else is
 * in the process, so that its memory is the least that this network needs. */
#include <dlfcn.h>
#include <onnxruntime_c_api.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { API = 17, OUTPUTS_MAX = 64, RANK_MAX = 8 };

static const OrtApi *ort;

static void require(OrtStatus *status)
{
    if (!status)
        return;
    fprintf(stderr, "bare_onnx: %s\n", ort->GetErrorMessage(status));
    exit(1);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void load_runtime(const char *path)
{
    void *library = dlopen(path, RTLD_NOW);
    const OrtApiBase *(*get_base)(void) = NULL;
    if (library)
        *(void **)&get_base = dlsym(library, "OrtGetApiBase");
    ort = get_base ? get_base()->GetApi(API) : NULL;
    if (!ort) {
        fprintf(stderr, "bare_onnx: %s: is no ONNX Runtime with API %d\n", path, API);
        exit(1);
    }
}

static OrtSession *open_session(const char *model, int threads)
{
    OrtEnv *env = NULL;
    OrtSessionOptions *options = NULL;
    OrtSession *session = NULL;
    require(ort->CreateEnv(ORT_LOGGING_LEVEL_ERROR, "bare_onnx", &env));
    require(ort->CreateSessionOptions(&options));
    require(ort->SetSessionGraphOptimizationLevel(options, ORT_ENABLE_ALL));
    require(ort->SetIntraOpNumThreads(options, threads));
    require(ort->SetInterOpNumThreads(options, 1));
    require(ort->AddSessionConfigEntry(options, "session.intra_op.allow_spinning", "0"));
    require(ort->AddSessionConfigEntry(options, "session.inter_op.allow_spinning", "0"));
    require(
        ort->AddSessionConfigEntry(options, "session.use_device_allocator_for_initializers", "1"));
    require(ort->CreateSession(env, model, options, &session));
    return session;
}

/* An input of the shape that the model states, filled with a gradient. */
static OrtValue *make_input(const OrtSession *session, OrtAllocator *allocator)
{
    OrtTypeInfo *type = NULL;
    const OrtTensorTypeAndShapeInfo *tensor = NULL;
    int64_t shape[RANK_MAX];
    size_t rank = 0, size = 1;
    require(ort->SessionGetInputTypeInfo(session, 0, &type));
    require(ort->CastTypeInfoToTensorInfo(type, &tensor));
    require(ort->GetDimensionsCount(tensor, &rank));
    if (rank > RANK_MAX)
        exit(1);
    require(ort->GetDimensions(tensor, shape, rank));
    for (size_t d = 0; d < rank; d++) {
        shape[d] = shape[d] < 1 ? 1 : shape[d];
        size *= (size_t)shape[d];
    }
    OrtValue *value = NULL;
    float *values = NULL;
    require(ort->CreateTensorAsOrtValue(allocator, shape, rank, ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT,
                                        &value));
    require(ort->GetTensorMutableData(value, (void **)&values));
    for (size_t i = 0; i < size; i++)
        values[i] = (float)(i % 255) / 127.5f - 1;
    ort->ReleaseTypeInfo(type);
    return value;
}

int main(int argc, char **argv)
{
    if (argc < 5 || argc - 4 > OUTPUTS_MAX) {
        fprintf(stderr, "usage: bare_onnx LIBRARY MODEL THREADS OUTPUT...\n");
        return 2;
    }
    load_runtime(argv[1]);
    OrtSession *session = open_session(argv[2], atoi(argv[3]));
    OrtAllocator *allocator = NULL;
    char *input_name = NULL;
    require(ort->GetAllocatorWithDefaultOptions(&allocator));
    require(ort->SessionGetInputName(session, 0, allocator, &input_name));
    const OrtValue *input = make_input(session, allocator);
    const char *const *output_names = (const char *const *)(argv + 4);
    OrtValue *outputs[OUTPUTS_MAX] = {NULL};

    int inferences = 0;
    while (scanf("%d", &inferences) == 1) {
        for (int i = 0; i < inferences; i++) {
            const double begin = now();
            require(ort->Run(session, NULL, (const char *const *)&input_name, &input, 1,
                             output_names, (size_t)argc - 4, outputs));
            printf("%.9f ", now() - begin);
        }
        printf("\n");
        fflush(stdout);
    }
    return 0;
}
