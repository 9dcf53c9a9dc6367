#include "record/projection.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Eigenvalues>

#include <vdna/cpp/error.hpp>

namespace vdna::record
{

namespace
{

using Matrix = Eigen::MatrixXd;

// The embeddings of all frames as rows, each part about its own mean.
Matrix centred(const std::vector<const Recording *> &parts, uint32_t raw_dim)
{
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Index frames = 0;
    for (const Recording *part : parts)
        frames += part->frames;
    Matrix all(frames, raw_dim);
    Eigen::Index first = 0;
    for (const Recording *part : parts) {
        auto rows = all.middleRows(first, part->frames);
        rows =
            Eigen::Map<const Rows>(part->embeddings.data(), part->frames, raw_dim).cast<double>();
        const Eigen::RowVectorXd mean = rows.colwise().mean();
        rows.rowwise() -= mean;
        first += part->frames;
    }
    return all;
}

// Products of its rows with one another.
Matrix gram(const Matrix &rows)
{
    Matrix products = Matrix::Zero(rows.rows(), rows.rows());
    products.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    return products;
}

// How many eigenvalues, in ascending order, are more than rounding makes of 0.
Eigen::Index rank_of(const Eigen::VectorXd &eigenvalues, Eigen::Index terms)
{
    const double noise = eigenvalues[eigenvalues.size() - 1] * static_cast<double>(terms) *
                         std::numeric_limits<double>::epsilon();
    return (eigenvalues.array() > std::max(noise, 0.0)).count();
}

// Unit length, and a sign that is the same on every machine.
Eigen::VectorXd normalised(Eigen::VectorXd direction)
{
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    return direction / (direction[largest] < 0 ? -direction.norm() : direction.norm());
}

} // namespace

uint32_t Projection::dims() const
{
    return directions.empty() ? 0 : static_cast<uint32_t>(directions.size() / raw_dim);
}

void Projection::set_in(vdna_identity &identity) const
{
    if (directions.empty())
        return;
    identity.projection = directions.data();
    identity.raw_dim = raw_dim;
    identity.dim = dims();
}

Projection projection_of(const vdna_identity &identity)
{
    const float *const from = identity.projection;
    return {{from, from + size_t{identity.dim} * identity.raw_dim}, identity.raw_dim};
}

Projection principal_directions(const std::vector<const Recording *> &parts, uint32_t raw_dim,
                                uint32_t dims, const std::string &where)
{
    const Matrix frames = centred(parts, raw_dim);
    // Both have the same eigenvalues; those of the smaller matrix cost less.
    const bool by_frames = frames.rows() < frames.cols();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(by_frames ? gram(frames)
                                                                 : gram(frames.transpose()));
    const Eigen::Index rank = rank_of(solver.eigenvalues(), std::max(frames.rows(), frames.cols()));
    if (dims > rank)
        throw Error(where + ": " + std::to_string(dims) +
                    " numbers of each embedding are to be kept ('dims'), but the " +
                    std::to_string(frames.rows()) + " frames of " + std::to_string(parts.size()) +
                    (parts.size() == 1 ? " experience" : " experiences") + " vary in " +
                    std::to_string(rank) +
                    " directions, expected at least as many; begin the map with more frames, or "
                    "set fewer dims");

    Projection projection{{}, raw_dim};
    for (Eigen::Index d = 0; d < dims; d++) {
        const Eigen::VectorXd vector = solver.eigenvectors().rightCols(d + 1).col(0);
        const Eigen::VectorXd direction =
            normalised(by_frames ? Eigen::VectorXd(frames.transpose() * vector) : vector);
        for (const double number : direction)
            projection.directions.push_back(static_cast<float>(number));
    }
    return projection;
}

void project(Recording &recording, const vdna_identity &identity)
{
    if (!identity.projection)
        return;
    std::vector<float> kept(size_t{recording.frames} * identity.dim);
    for (size_t i = 0; i < recording.frames; i++)
        require(vdna_identity_project(&identity, &recording.embeddings[i * identity.raw_dim],
                                      &kept[i * identity.dim]),
                "projection");
    recording.embeddings = std::move(kept);
}

Recording projected(Recording recording, const Projection &projection)
{
    vdna_identity identity{};
    projection.set_in(identity);
    project(recording, identity);
    return recording;
}

} // namespace vdna::record
