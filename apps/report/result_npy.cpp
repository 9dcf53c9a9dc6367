#include "report/result_npy.hpp"

#include <set>

#include "program/print.hpp"
#include "program/progress.hpp"
#include "program/replaced_file.hpp"
#include "report/file_names.hpp"
#include "report/npy.hpp"

namespace vdna::report
{

namespace
{

// One directory of files.
class NpyFiles
{
  public:
    NpyFiles(const eval::Evaluation &evaluation, const std::string &directory)
        : evaluation_(evaluation), directory_(directory)
    {
        program::make_directory(directory);
        FileNames names;
        for (const eval::Traversal &t : *evaluation.traversals)
            names_.push_back(names.unique(t.name));
    }

    void write_tables()
    {
        const std::vector<size_t> shape = {evaluation_.queries.size(),
                                           evaluation_.references.size()};
        write_npy(path("recall"), shape, evaluation_.recall);
        for (const eval::MethodResult &method : evaluation_.methods)
            if (!method.distance.empty())
                write_npy(path("distance_" + portable(method.name)), shape, method.distance);
        for (const eval::LocaliserResult &result : evaluation_.localisers)
            write_npy(path("recall_" + result.name),
                      result.in_each ? shape : std::vector<size_t>{shape[0]}, result.recall);
        program::Json index;
        for (const eval::QueryResult &query : evaluation_.queries)
            index["queries"].push_back(traversal(query.traversal).name);
        for (const size_t reference : evaluation_.references)
            index["references"].push_back(traversal(reference).name);
        for (size_t i = 0; i < names_.size(); i++)
            index["files"][traversal(i).name] = names_[i];
        program::replace_file(directory_ + "/index.json",
                              index.dump(2, ' ', false, program::Json::error_handler_t::replace) +
                                  "\n");
    }

    void write_traversals()
    {
        for (size_t i = 0; i < names_.size(); i++) {
            const std::string &name = names_[i];
            const record::Recording &r = traversal(i).recording;
            write_npy(path("embeddings_" + name), {r.frames, evaluation_.backbone.identity.dim},
                      r.embeddings);
            const std::vector<float> &last_layer = r.last_layer_or_only();
            write_npy(path("last_layer_" + name), {r.frames, last_layer.size() / r.frames},
                      last_layer);
            write_npy(path("grey_" + name), {r.frames}, r.grey);
            if (evaluation_.unit == record::Unit::metres)
                write_npy(path("position_" + name), {r.frames, 3}, r.position);
            else
                write_npy(path("place_" + name), {r.frames}, r.place);
        }
    }

    void write_query(const eval::QueryResult &query)
    {
        const std::string &name = names_[query.traversal];
        std::vector<double> emd;
        for (const eval::PairResult &pair : query.pairs) {
            const eval::Traversal &reference = traversal(pair.reference);
            const std::string names = name + "_" + names_[pair.reference];
            const std::vector<size_t> shape = {query.live.size(), reference.recording.frames};
            write_npy(path("difference_" + names), shape,
                      eval::difference_matrix(evaluation_, query, pair.reference));
            write_npy(path("ground_truth_" + names), shape,
                      eval::ground_truth_matrix(evaluation_, query, pair.reference));
            emd.insert(emd.end(), pair.neuron_emd_bins.begin(), pair.neuron_emd_bins.end());
        }
        write_npy(path("range_" + name), {query.range.size() / 2, 2}, query.range);
        write_npy(path("emd_" + name), {query.pairs.size(), emd.size() / query.pairs.size()}, emd);
    }

  private:
    const eval::Traversal &traversal(size_t index) const
    {
        return (*evaluation_.traversals)[index];
    }

    // name: portable. No other result has it.
    std::string path(const std::string &name)
    {
        if (!written_.insert(name).second)
            throw Error(directory_ + "/" + name +
                        ".npy: two results have this name; rename one of their traversals");
        return directory_ + "/" + name + ".npy";
    }

    const eval::Evaluation &evaluation_;
    std::string directory_;
    std::vector<std::string> names_; // of traversals in file names
    std::set<std::string> written_;  // names without directory and ending
};

} // namespace

void write_npy_files(const eval::Evaluation &evaluation, const std::string &directory)
{
    NpyFiles files(evaluation, directory);
    files.write_tables();
    files.write_traversals();
    program::Progress progress("writing .npy files", evaluation.queries.size());
    for (const eval::QueryResult &query : evaluation.queries) {
        files.write_query(query);
        progress.advance();
    }
}

} // namespace vdna::report
