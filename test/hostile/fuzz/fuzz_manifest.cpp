// Any bytes as the manifest of a network: refused with a sentence about the file, or read within
// the limits that the header states.
#include <cmath>
#include <cstring>

#include <vdna/identity.h>

#include "failure.hpp"
#include "manifest.hpp"
#include "memory_file.hpp"

using namespace vdna::backbone;

static void check(const std::vector<double> &means, size_t least)
{
    MUST(means.size() >= least && means.size() <= Golden::parts_max);
    for (const double mean : means)
        MUST(std::isfinite(mean));
}

static void check(const Golden &golden, size_t taps)
{
    MUST(golden.tolerance > 0 && golden.tolerance < 1);
    MUST(golden.taps.size() == taps);
    for (const std::vector<double> &tap : golden.taps)
        check(tap, 1);
    check(golden.embedding, 0); // none with the paper's protocol
    check(golden.last_layer, 0);
}

static void check(const Manifest &manifest)
{
    const Input &input = manifest.input;
    MUST(vdna_name_check(manifest.name.c_str(), nullptr) == VDNA_OK);
    MUST(manifest.sha256.size() == 64 && !manifest.model.empty() && !input.name.empty());
    MUST(manifest.precision == "fp32" || manifest.precision == "int8");
    MUST(input.width >= 1 && input.width <= Input::side_max);
    MUST(input.height >= 1 && input.height <= Input::side_max);
    for (size_t c = 0; c < 3; c++)
        MUST(std::isfinite(input.mean[c]) && std::isfinite(input.std[c]) && input.std[c] > 0);
    MUST(!manifest.taps.empty());
    for (const TappedOutput &tap : manifest.taps)
        MUST(!tap.output.empty() && tap.layout <= VDNA_LAYOUT_NEURONS_SAMPLES);
    const Embedding &embedding = manifest.embedding;
    MUST(!embedding.output.empty());
    MUST(!embedding.grid || (embedding.grid->rows >= 1 && embedding.grid->columns >= 1));
    MUST(!preprocessing_text(manifest).empty());
    if (manifest.golden)
        check(*manifest.golden, manifest.taps.size());
    MUST(embedding_text(embedding).empty() ==
         (!embedding.grid && !embedding.centre && embedding.last_layer.empty()));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static MemoryFile file;
    file.hold(bytes, size);
    try {
        check(read_manifest(file.path()));
    } catch (const vdna::fail::Failure &failure) {
        MUST(failure.status() == VDNA_ERR_FORMAT);
        MUST(std::strncmp(failure.what(), (file.path() + ":").c_str(), file.path().size() + 1) ==
             0);
    }
    return 0;
}

// A network as in the paper, one with all that may be left out, and one with golden numbers.
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    const std::string hash(64, 'a');
    const std::string begin = "name = \"tiny\"\nmodel = \"tiny.onnx\"\nsha256 = \"" + hash +
                              "\"\nsource = \"drawn\"\nlicence = \"MIT\"\n";
    const std::string input =
        "[input]\nname = \"image\"\nwidth = 320\nheight = 240\ncolour = \"BGR\"\n"
        "mean = [123.675, 116.28, 0]\nstd = [58.395, 57.12, 1e-1]\nresize = \"stretch\"\n"
        "interpolation = \"cubic\"\n[[taps]]\noutput = \"tokens\"\nlayout = \"samples_neurons\"\n";
    const std::string whole = "[embedding]\noutput = \"map\"\nl2_normalise = true\n";
    const std::string golden = "[golden]\ntolerance = 0.001\n";
    const std::string seeds[] = {
        begin + input + whole,
        begin + "precision = \"int8\"\nprotocol = \"paper\"\n[quantised]\nfrom_sha256 = \"" + hash +
            "\"\nmethod = \"QDQ\"\n" + input +
            "[[taps]]\noutput = \"map\"\nlayout = \"neurons_samples\"\n[embedding]\noutput = "
            "\"map\"\ngrid = [3, 1]\ndims = 64\ncentre = true\nlast_layer = \"tokens\"\n"
            "l2_normalise = false\nstorage = \"int8\"\n" +
            golden + "taps = [[1, -2.5], [3]]\nembedding = [4, 5]\nlast_layer = [6]\n",
        begin + input + whole + golden + "taps = [[1e-3]]\nembedding = [-4.5, 0]\n"};
    if (index >= sizeof seeds / sizeof *seeds || seeds[index].size() > capacity)
        return 0;
    std::memcpy(out, seeds[index].data(), seeds[index].size());
    return seeds[index].size();
}
