/* Pictures as a network is given them, without the network. */
#include <new>
#include <vector>

#include "backbone/preprocess.hpp"
#include "failure.hpp"
#include "frame.h"

using namespace vdna;

struct bench_preparation {
    explicit bench_preparation(const backbone::Input &input)
        : preprocessor(input), out(size_t{3} * input.width * input.height)
    {
    }

    picture::Decoder decoder;
    backbone::Preprocessor preprocessor;
    std::vector<float> out;
};

/* see frame.h */
bench_preparation *bench_preparation_open(uint32_t side, uint32_t reduced)
{
    backbone::Input input{};
    input.width = input.height = side;
    input.std = {1, 1, 1};
    input.reduced = reduced != 0;
    return new (std::nothrow) bench_preparation(input);
}

/* see frame.h */
vdna_status bench_prepare(bench_preparation *p, const uint8_t *data, size_t size)
{
    return fail::guarded(nullptr, [&] {
        const vdna_image image = {data, size, 0, 0, 0, VDNA_PIXEL_ENCODED};
        p->preprocessor.run(p->decoder.decode(image, p->preprocessor.least()), p->out.data());
    });
}
