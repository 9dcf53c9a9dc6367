/* Made by make_reference.py; do not edit. */
/* clang-format off */
#define NEURONS 8
#define BINS 1000

static const double golden_emd[] = {
0x1.9a2353ed77221p-1, 0x1.32a92a5f88432p+5, 0x1.4d71efaa4ead8p+6, 0x1.de27386416475p+6,
0x1.ffb6f86f8c938p-1, 0x1.357ad095b871ap+5, 0x1.348e435ff2e4ap+6, 0x0.0p+0};
static const double golden_mean = 0x1.66db47606c8edp+5;
