#include <algorithm>
#include <new>

#include <Eigen/QR>
#include <Eigen/SVD>

#include <vdna/baseline.h>

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Frames =
    Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

namespace
{

// A set of embeddings about its mean, scaled so that its covariance is frames^T frames.
struct Centred {
    VectorXd mean;
    MatrixXd frames; // [frames][dim]

    explicit Centred(const Frames &set)
    {
        const MatrixXd all = set.cast<double>();
        mean = all.colwise().mean();
        frames = (all.rowwise() - mean.transpose()) / std::sqrt(double(all.rows() - 1));
    }
    double trace() const { return frames.squaredNorm(); }
};

// A matrix with the same covariance and no more rows than columns: R of a QR decomposition.
MatrixXd compact(const MatrixXd &frames)
{
    if (frames.rows() <= frames.cols())
        return frames;
    const Eigen::HouseholderQR<MatrixXd> qr(frames);
    return qr.matrixQR().topRows(frames.cols()).triangularView<Eigen::Upper>();
}

// tr((S1 S2)^(1/2)): the singular values of S1^(1/2) S2^(1/2) are those of X1 X2^T. With few
// frames, as in a warmup, that product is narrow, so compacting the larger set, by far the greatest
// cost, is left out.
double trace_of_root(const MatrixXd &x1, const MatrixXd &x2)
{
    const MatrixXd &few = x1.rows() < x2.rows() ? x1 : x2, &many = x1.rows() < x2.rows() ? x2 : x1;
    const MatrixXd product = few.rows() < few.cols()
                                 ? MatrixXd(many * few.transpose())
                                 : MatrixXd(compact(many) * compact(few).transpose());
    return Eigen::BDCSVD<MatrixXd>(compact(product)).singularValues().sum();
}

double frechet(const Frames &a, const Frames &b)
{
    const Centred p(a), q(b);
    const double spread = p.trace() + q.trace() - 2 * trace_of_root(p.frames, q.frames);
    // Rounding may leave a hair below zero for equal sets.
    return (p.mean - q.mean).squaredNorm() + std::max(spread, 0.0);
}

} // namespace

// see vdna/baseline.h
vdna_status vdna_frechet(const float *a, uint32_t frames_a, const float *b, uint32_t frames_b,
                         uint32_t dim, double *out_distance)
try {
    if (!a || frames_a < 2 || !b || frames_b < 2 || dim == 0 || !out_distance)
        return VDNA_ERR_ARG;
    const Frames p(a, frames_a, dim), q(b, frames_b, dim);
    if (!p.allFinite() || !q.allFinite())
        return VDNA_ERR_NONFINITE;
    *out_distance = frechet(p, q);
    return VDNA_OK;
} catch (const std::bad_alloc &) {
    return VDNA_ERR_NOMEM;
}
