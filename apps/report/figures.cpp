#include "report/figures.hpp"

#include "program/progress.hpp"
#include "program/replaced_file.hpp"
#include "report/file_names.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"

namespace vdna::report
{

std::string charts(const std::vector<Figure> &figures)
{
    std::string html;
    for (const Figure &figure : figures)
        html +=
            element("figure",
                    svg_element(figure) +
                        (figure.caption.empty() ? "" : text_element("figcaption", figure.caption)));
    return element("div class=\"charts\"", html);
}

void write_figures(const eval::Evaluation &evaluation, const std::string &directory)
{
    std::vector<Figure> figures;
    for (const auto made : {match_figures, matrix_figures, correlation_figures, localiser_figures,
                            trust_figures, reselection_figures, neuron_figures})
        for (Figure &figure : made(evaluation))
            figures.push_back(std::move(figure));

    program::make_directory(directory);
    FileNames names;
    program::Progress progress("writing figures", figures.size());
    for (const Figure &figure : figures) {
        const std::string path = directory + "/" + names.unique(figure.name);
        program::replace_file(path + ".svg", svg_file(figure));
        program::replace_file(path + ".pdf", pdf_file(figure));
        progress.advance();
    }
}

} // namespace vdna::report
