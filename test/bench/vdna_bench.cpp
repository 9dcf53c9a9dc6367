// Times the parts that run on the robot. Each figure is the median over rounds; in every round a
// part and its peer run right after one another, so that the ratio holds when the machine drifts.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include <vdna/vdna.h>

namespace
{

// Keeps the compiler from removing a computation whose result nobody reads.
volatile double sink;

double seconds(const std::function<void()> &work)
{
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values)
{
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

// Run both `rounds` times in turn and print the medians and the median ratio.
void compare(const char *name, const char *peer, int rounds, double per, const char *unit,
             const std::function<void()> &ours, const std::function<void()> &theirs)
{
    ours();
    theirs();
    std::vector<double> a, b, ratio;
    for (int i = 0; i < rounds; i++) {
        a.push_back(seconds(ours));
        b.push_back(seconds(theirs));
        ratio.push_back(a.back() / b.back());
    }
    std::printf("%-44s %10.3f %-14s %6.2f x %s\n", name, median(a) * per, unit, median(ratio),
                peer);
}

// A random VDNA of `mass` samples per neuron, and all it points to.
struct RandomDna {
    std::vector<float> range;
    std::vector<uint32_t> counts, mass;
    vdna_hist_view view{};

    RandomDna(uint32_t neurons, uint32_t bins, uint32_t samples, unsigned seed)
        : counts(size_t(neurons) * bins), mass(neurons, samples)
    {
        std::mt19937 random(seed);
        std::normal_distribution<float> normal(0.5f, 0.1f);
        for (uint32_t n = 0; n < neurons; n++) {
            range.insert(range.end(), {0.f, 1.f});
            for (uint32_t s = 0; s < samples; s++) {
                const float x = std::clamp(normal(random), 0.f, 0.999f);
                counts[size_t(x * float(bins)) * neurons + n]++;
            }
        }
        view = {range.data(), counts.data(), mass.data(), neurons, bins};
    }
};

// The peer of the distance: the formula as one would write it first, in double.
double textbook_emd(const vdna_hist_view &p, const vdna_hist_view &q)
{
    double total = 0;
    for (uint32_t n = 0; n < p.neurons; n++) {
        double below_p = 0, below_q = 0;
        for (uint32_t b = 0; b < p.bins; b++) {
            below_p += double(p.counts[size_t(b) * p.neurons + n]) / p.mass[n];
            below_q += double(q.counts[size_t(b) * q.neurons + n]) / q.mass[n];
            total += std::fabs(below_p - below_q);
        }
    }
    return total / p.neurons;
}

// The peer of the layout: the exact distance of tables with one row of bins per neuron, in the same
// integers. What vdna_emd_mean() would be if the file held them so.
double neuron_major_emd(const uint32_t *p, const uint32_t *q, const vdna_hist_view &shape_p,
                        const vdna_hist_view &shape_q)
{
    double total = 0;
    for (uint32_t n = 0; n < shape_p.neurons; n++) {
        const uint32_t *row_p = p + size_t(n) * shape_p.bins, *row_q = q + size_t(n) * shape_p.bins;
        const uint64_t mass_p = shape_p.mass[n], mass_q = shape_q.mass[n];
        int64_t difference = 0, sum = 0;
        for (uint32_t b = 0; b + 1 < shape_p.bins; b++) {
            difference += int64_t(row_p[b] * mass_q - row_q[b] * mass_p);
            sum += difference < 0 ? -difference : difference;
        }
        total += double(sum) / double(mass_p * mass_q);
    }
    return total / shape_p.neurons;
}

// The same counts, [neurons][bins].
std::vector<uint32_t> transposed(const vdna_hist_view &view)
{
    std::vector<uint32_t> rows(size_t(view.neurons) * view.bins);
    for (uint32_t b = 0; b < view.bins; b++)
        for (uint32_t n = 0; n < view.neurons; n++)
            rows[size_t(n) * view.bins + b] = view.counts[size_t(b) * view.neurons + n];
    return rows;
}

// The limit of anything that looks at every byte once.
uint64_t sum_bytes(const void *data, size_t size)
{
    const uint64_t *words = static_cast<const uint64_t *>(data);
    uint64_t sum = 0;
    for (size_t i = 0; i < size / sizeof *words; i++)
        sum += words[i];
    return sum;
}

// Random activations of one tap, and a range that holds them.
struct RandomTap {
    std::vector<float> values, range;
    vdna_activations tap{};

    RandomTap(uint32_t neurons, uint32_t samples) : values(size_t(neurons) * samples)
    {
        std::mt19937 random(1);
        std::normal_distribution<float> normal;
        for (float &v : values)
            v = normal(random);
        for (uint32_t n = 0; n < neurons; n++)
            range.insert(range.end(), {-4.f, 4.f});
        tap = {values.data(), neurons, samples, VDNA_LAYOUT_SAMPLES_NEURONS};
    }
};

// Counting, and counting in a full window, where each frame also takes one out.
void bench_hist(uint32_t neurons, uint32_t samples)
{
    const RandomTap random(neurons, samples);
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = neurons;
    config.range = random.range.data();
    std::vector<uint32_t> mem(vdna_hist_mem_size(&config) / sizeof(uint32_t));
    vdna_hist hist;
    vdna_hist_init(&config, mem.data(), mem.size() * sizeof(uint32_t), &hist);

    vdna_window_config window_config;
    vdna_window_config_init(&window_config);
    window_config.capacity = 4;
    window_config.taps = &random.tap;
    window_config.tap_count = 1;
    window_config.range = random.range.data();
    std::vector<int64_t> window_mem(vdna_window_mem_size(&window_config) / sizeof(int64_t) + 1);
    vdna_window window;
    vdna_window_init(&window_config, window_mem.data(), window_mem.size() * sizeof(int64_t),
                     &window);

    const size_t size = random.values.size();
    const int frames = int(std::max<size_t>(1, 400000 / size));
    const auto count = [&] {
        for (int i = 0; i < frames; i++)
            vdna_hist_add(&hist, &random.tap, 1);
    };
    char name[64];
    std::snprintf(name, sizeof name, "count %u neurons x %u samples", neurons, samples);
    compare(name, "reading the activations", 31, 1e9 / double(size) / frames, "ns/activation",
            count, [&] {
                for (int i = 0; i < frames; i++)
                    sink = double(sum_bytes(random.values.data(), size * sizeof(float)));
            });
    std::snprintf(name, sizeof name, "window %u neurons x %u samples", neurons, samples);
    compare(
        name, "counting alone", 31, 1e9 / double(size) / frames, "ns/activation",
        [&] {
            for (int i = 0; i < frames; i++)
                vdna_window_add(&window, 0, &random.tap, 1);
        },
        count);
}

void bench_emd(uint32_t neurons)
{
    const uint32_t bins = VDNA_HIST_BINS_DEFAULT;
    const RandomDna p(neurons, bins, 100, 1), q(neurons, bins, 1150, 2);
    std::vector<int64_t> scratch(vdna_emd_scratch_size(neurons) / sizeof(int64_t));
    const auto ours = [&] {
        double distance = 0;
        vdna_emd_mean(&p.view, &q.view, scratch.data(), scratch.size() * sizeof(int64_t),
                      &distance);
        sink = distance;
    };
    char name[64];
    std::snprintf(name, sizeof name, "exact EMD, %u neurons x %u bins", neurons, bins);
    compare(name, "textbook loop in double", 31, 1e6, "us", ours,
            [&] { sink = textbook_emd(p.view, q.view); });
    const std::vector<uint32_t> rows_p = transposed(p.view), rows_q = transposed(q.view);
    compare(name, "the same, neuron-major", 31, 1e6, "us", ours,
            [&] { sink = neuron_major_emd(rows_p.data(), rows_q.data(), p.view, q.view); });
    compare(name, "reading both histograms", 31, 1e6, "us", ours, [&] {
        const size_t size = p.counts.size() * sizeof(uint32_t);
        sink = double(sum_bytes(p.counts.data(), size) + sum_bytes(q.counts.data(), size));
    });
}

void bench_knn(uint32_t rows, uint32_t dim)
{
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    std::vector<float> map(size_t(rows) * dim), query(dim);
    for (float &v : map)
        v = normal(random);
    for (float &v : query)
        v = normal(random);
    char name[64];
    std::snprintf(name, sizeof name, "nearest of %u frames, %u numbers each", rows, dim);
    compare(
        name, "reading the embeddings", 31, 1e6, "us",
        [&] {
            vdna_knn_match match{};
            vdna_knn(query.data(), dim, map.data(), rows, 1, &match);
            sink = match.distance_sq;
        },
        [&] { sink = double(sum_bytes(map.data(), map.size() * sizeof(float))); });
}

} // namespace

int main()
{
    std::printf("vdna %s, medians of interleaved rounds on one thread\n\n", vdna_version());
    std::printf("%-44s %10s %-14s %8s\n", "part", "median", "", "ratio to");
    bench_hist(128, 1);
    bench_hist(1280, 1);
    bench_hist(768, 197);
    bench_emd(128);
    bench_emd(768);
    bench_emd(1280);
    bench_knn(1150, 128);
    bench_knn(1150, 1280);
    return 0;
}
