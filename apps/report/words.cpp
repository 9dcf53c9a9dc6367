// The words of the report.
#include "eval/confidence.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"

namespace vdna::report
{

std::string words_section(const eval::Evaluation &evaluation)
{
    std::string list;
    const auto add = [&](const std::string &term, const std::string &text) {
        list += text_element("dt", term) + text_element("dd", text);
    };
    add("Query and references",
        "A robot has driven the same route several times, in different conditions: these are its "
        "references. It drives again: this is the query. Which reference is the best map for this "
        "drive? Each method answers from the first frames of the query alone, the warmup. Then the "
        "remaining frames are localised in every reference.");
    add("Recall@1", "Share of frames found at the right place; it tells which reference was best.");
    add("All references at once",
        "The composite map of all references, one after another, searched as one.");
    add("95 % intervals",
        "By bootstrap over queries: what the average would be with other queries of this kind.");
    add("Difference matrix",
        "Distance of the embeddings of each live frame (downwards) and each map frame (to the "
        "right): near is black, far is white, with the same shades for all references of a query. "
        "Where the dark line follows the true places, they can be recognised.");
    add("Distance against recall",
        "For a good method, the dots lie on a falling line: the smaller the distance, the more "
        "frames are localised. The correlation is Pearson's; the nearer to -1 the better.");
    add("Errors", "In percentage points of Recall@1, averaged over all queries; lower is better.");
    add("Swap-once", "The paper's ranking error: each pair of swapped references costs the "
                     "difference of their recalls.");
    add("Half-L1", "Half of the recall difference summed over all ranks.");
    add("Regret", "Recall lost by taking the first choice instead of the best.");
    add("Kendall tau", "1 for the true order and -1 for its reverse.");
    add("Correlations", "Of distance and recall, best at -1: the nearer, the better; \"within\" is "
                        "within each query, \"pooled\" over all.");
    add("Rankings",
        "Each column lists the references of a query from best to worst. The first table is the "
        "ground truth, with the recall in all references at once beside the query's name; the "
        "others are the predictions of each method from the warmup alone.");
    add("Localiser", "Finds the place of each live frame in a map: one reference, or all of them "
                     "at once.");
    add("Confidence",
        "Answers in ten bins of confidence, over all queries; on the diagonal, answers are right "
        "as often as their confidence says. AUROC is the chance that a right answer is more "
        "confident than a wrong one.");
    add("Disturbed drives",
        "Recall@1 counts the frames on the route. Precision, right answers kept, and frames "
        "answered off the route are at a confidence of at least " +
            number_text(eval::usual_min_confidence, 2) + ".");
    add("Predictions", "In ten bins: on the diagonal, as much is achieved as was predicted.");
    add("Contributions of single neurons",
        "The distance of Visual DNA is the mean of one Earth Mover's Distance (EMD) per neuron: "
        "the mean number of histogram bins, of " +
            std::to_string(evaluation.bins) +
            ", by which its activations in the warmup must move to match those of the reference. "
            "Shown is what tells the first choice of each query from the second: the margin, the "
            "distance of the second less that of the first, is the sum of what the neurons add, "
            "above 0 for the first and below 0 for the second.");
    return "<h2>What the words mean</h2>" + element("dl", list);
}

} // namespace vdna::report
