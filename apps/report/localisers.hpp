// The localisers of an evaluation, side by side, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::report
{

// What every localiser recalled of a query in one reference, or in "all".
struct LocaliserRow {
    std::string query, reference;
    std::vector<double> recall; // [localisers], percent; NaN for those that got another map
};

// For each query: its references in their order, then "all".
std::vector<LocaliserRow> localiser_rows(const eval::Evaluation &evaluation);

// Indices of the localisers whose recalls the other tables do not have.
std::vector<size_t> beyond_usual_localisers(const eval::Evaluation &evaluation);

// Means with intervals, the recalls unless the other tables have them, confidences, and drives.
std::string localiser_tables(const eval::Evaluation &evaluation);

// {name: {"mean", "first_choice", "recall"}}; the first two have "confidence" inside
program::Json localisers_json(const eval::Evaluation &evaluation);

// {drive: {name: {"mean", "first_choice"}}}, which also have "off_route" inside
program::Json drives_json(const eval::Evaluation &evaluation);

// The table of drives: its heads, and its rows, in which a localiser in each reference has two.
extern const std::vector<std::string> drive_heads;
std::vector<std::vector<std::string>> drive_rows(const eval::Evaluation &evaluation);

} // namespace vdna::report
