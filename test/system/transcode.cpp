// transcode FROM TO [CHANGE]: converts a picture file to the kind that the extension of TO names.
//   stored-N  stores the pixels so that orientation N of EXIF turns them back
//   grey      makes them grey, of 8 bits
//   grey16    the same with 16 bits
//   alpha     adds transparency that grows from left to right
//   blurred   leaves no detail smaller than an eighth of the height
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace
{

cv::Mat stored(const cv::Mat &upright, int orientation)
{
    constexpr int left_right = 1, up_down = 0;
    const bool columns_are_rows = orientation >= 5;
    cv::Mat pixels = upright.clone();
    // From the end of the turn to its beginning.
    if (orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7)
        cv::flip(pixels, pixels, left_right);
    if (orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8)
        cv::flip(pixels, pixels, up_down);
    if (columns_are_rows)
        cv::transpose(pixels, pixels);
    return pixels;
}

cv::Mat grey(const cv::Mat &bgr, int depth)
{
    cv::Mat one;
    cv::cvtColor(bgr, one, cv::COLOR_BGR2GRAY);
    one.convertTo(one, depth, depth == CV_16U ? 257 : 1);
    return one;
}

cv::Mat with_alpha(const cv::Mat &bgr)
{
    cv::Mat alpha(bgr.size(), CV_8UC1), pixels;
    for (int x = 0; x < alpha.cols; x++)
        alpha.col(x).setTo(x % 256);
    cv::merge(std::vector<cv::Mat>{bgr, alpha}, pixels);
    return pixels;
}

cv::Mat changed(const cv::Mat &bgr, const std::string &change)
{
    if (change.rfind("stored-", 0) == 0)
        return stored(bgr, std::stoi(change.substr(7)));
    if (change == "blurred") {
        cv::Mat soft;
        cv::GaussianBlur(bgr, soft, cv::Size(), bgr.rows / 16.0);
        return soft;
    }
    if (change == "alpha")
        return with_alpha(bgr);
    if (change == "grey" || change == "grey16")
        return grey(bgr, change == "grey" ? CV_8U : CV_16U);
    return bgr;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3 && argc != 4)
        return std::fprintf(stderr, "usage: transcode FROM TO [CHANGE]\n"), 2;
    const cv::Mat pixels = cv::imread(argv[1], cv::IMREAD_COLOR);
    if (pixels.empty() || !cv::imwrite(argv[2], changed(pixels, argc == 4 ? argv[3] : "")))
        return std::fprintf(stderr, "transcode: %s cannot become %s\n", argv[1], argv[2]), 1;
    return 0;
}
