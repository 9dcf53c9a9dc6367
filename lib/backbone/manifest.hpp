// Manifests (models/NAME.toml): which network, how its input is prepared, which outputs are used.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <vdna/activation.h>

#include "picture/resample.hpp"

namespace vdna::backbone
{

// What becomes of a picture before the network sees it.
struct Input {
    std::string name;           // of the ONNX input: float [1, 3, height, width]
    uint32_t width, height;     // pixels, 1..Input::side_max
    bool bgr;                   // channel order of the network, and of `mean` and `std`
    std::array<double, 3> mean; // subtracted, in units of 0..255
    std::array<double, 3> std;  // then divided by, > 0
    picture::Interpolation interpolation;
    bool reduced; // decode a JPEG picture no larger than needed for width and height

    static constexpr uint32_t side_max = 4096;
};

// An ONNX output whose activations are counted. Its values are used as the network gives them.
struct TappedOutput {
    std::string output;
    uint32_t layout; // VDNA_LAYOUT_...
};

// The cells of a feature map whose means are the embedding.
struct Grid {
    uint32_t rows, columns; // >= 1
};

// What frames are localised by: an ONNX output, which may also be tapped.
struct Embedding {
    std::string output;
    std::optional<Grid> grid; // none: the whole output
    bool centre;              // localisers subtract a mean; here nothing is subtracted
    bool l2_normalise;        // the embedding only; never a tap
    bool int8;                // experience files store it as codes
    uint32_t dims;            // numbers that experience files keep of it; 0 = all
    std::string last_layer;   // output of the second embedding; "" = none
};

// What the network gives for the test picture of golden.hpp: of each output the means of as many
// equal parts as a list has numbers, all finite.
struct Golden {
    double tolerance; // 0..1 without both, of a list's greatest absolute number
    std::vector<std::vector<double>> taps;     // one list, not empty, for each tap
    std::vector<double> embedding, last_layer; // empty: not compared

    static constexpr size_t parts_max = 64;
};

struct Manifest {
    std::filesystem::path file; // it was read from
    std::string name;
    std::filesystem::path model;
    std::string sha256;         // of the model file: 64 lower-case hexadecimal digits
    std::string precision;      // of its arithmetic: "fp32" or "int8"
    std::string quantised_from; // SHA-256 of the model it was made from; "" = none
    Input input;
    std::vector<TappedOutput> taps; // >= 1, all different
    Embedding embedding;
    std::optional<Golden> golden; // none: not known
};

// Read and check a manifest. Throws Failure with "FILE:LINE: ..." and what was expected.
Manifest read_manifest(const std::filesystem::path &file);

// Everything that shapes what is counted and compared, as a canonical text: two manifests with the
// same text, model and taps give numbers that compare.
std::string preprocessing_text(const Manifest &manifest);

// How the embedding is made, as in an identity: "" for one whole output that is all there is.
std::string embedding_text(const Embedding &embedding);

} // namespace vdna::backbone
