// A folder per traversal, each with labels.csv. The protocol of University Parks builds on this.
#include "frames/dataset.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

DatasetTraversal traversal_of(const std::filesystem::path &folder)
{
    const Labels labels(folder / "labels.csv");
    DatasetTraversal traversal{folder.filename().string(), "", {}};
    for (const std::filesystem::path &file : pictures_in(folder))
        traversal.frames.push_back({file, labels.find(file, traversal.frames.size())});
    return traversal;
}

} // namespace

Dataset load_folders(const std::filesystem::path &path)
{
    Dataset dataset;
    for (const std::filesystem::path &folder : folders_in(path))
        dataset.traversals.push_back(traversal_of(folder));
    return dataset;
}

Dataset load_parks(const std::filesystem::path &path)
{
    Dataset dataset = load_folders(path);
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
