// A folder per traversal, each with labels.csv. The protocol of University Parks builds on this.
#include "frames/dataset.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

DatasetTraversal labelled_traversal(const std::filesystem::path &folder)
{
    const Labels labels(folder / "labels.csv");
    return traversal_of(folder, list_pictures(folder, &labels), [&](const ListedPicture &picture) {
        return labels.find(picture.file, picture.number);
    });
}

} // namespace

Dataset load_folders(const std::filesystem::path &path, const DatasetOptions &options)
{
    Dataset dataset;
    for (const std::filesystem::path &folder : traversal_folders(path, options, dataset.notes))
        dataset.traversals.push_back(labelled_traversal(folder));
    return dataset;
}

Dataset load_parks(const std::filesystem::path &path, const DatasetOptions &options)
{
    Dataset dataset = load_folders(path, options);
    dataset.warmup = "45s";
    for (const DatasetTraversal &traversal : dataset.traversals) {
        const Label &first = traversal.frames.front().label;
        if (!first.position || !first.utime)
            throw Error((path / traversal.name / "labels.csv").string() +
                        ": no positions or times, expected the columns utime, and lat,lon or x,y, "
                        "for a tolerance in metres and a warmup in seconds");
    }
    return dataset;
}

} // namespace vdna::frames
