// Why one experience and not another: tables of neurons, and a page of its own.
#pragma once

#include <string>
#include <vector>

#include <vdna/cpp/explainer.hpp>

namespace vdna::report
{

// Thumbnails of the frames that have most and least of a neuron; "" = there is none.
struct ExamplePictures {
    std::string most, least;
};

// Of the live run and of both experiences.
struct ReasonPictures {
    ExamplePictures live, winner, against;
};

// Borrows from the explainer.
struct Explanation {
    std::string winner, against; // names
    const Explainer &explainer;
    std::vector<ReasonPictures> pictures = {}; // [reasons], or empty
};

// How much the neurons that are named make of the margin, without a full stop.
std::string sentence_of(const Explanation &explanation);

// Share of the margin in percent, "31.2"; a dash where there is no margin.
std::string share_text(const Explainer &explainer, const vdna_reason &part);

// The neurons that are named, with what is known of them.
std::string reasons_table(const Explanation &explanation);

// What each tap makes of the margin.
std::string taps_table(const Explanation &explanation);

// The page of `vdna explain --html`.
// facts: sentences, each a paragraph
std::string explanation_page(const Explanation &explanation, const std::string &headline,
                             const std::vector<std::string> &facts);

} // namespace vdna::report
