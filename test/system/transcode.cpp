// transcode FROM TO: converts a picture file to the kind that the extension of TO names.
#include <cstdio>

#include <opencv2/imgcodecs.hpp>

int main(int argc, char **argv)
{
    if (argc != 3)
        return std::fprintf(stderr, "usage: transcode FROM TO\n"), 2;
    const cv::Mat pixels = cv::imread(argv[1], cv::IMREAD_COLOR);
    if (pixels.empty() || !cv::imwrite(argv[2], pixels))
        return std::fprintf(stderr, "transcode: %s cannot become %s\n", argv[1], argv[2]), 1;
    return 0;
}
