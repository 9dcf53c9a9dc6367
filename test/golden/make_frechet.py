#!/usr/bin/env python3
"""Write frechet_golden.h: Frechet distances by SciPy's sqrtm, for test_frechet.c.

Only cases of full rank (more frames than dimensions), for which the textbook formula is sound.

    test/golden/make_frechet.py > test/golden/frechet_golden.h      (NumPy 2.4.6, SciPy 1.17.1)
"""
import textwrap

import numpy as np
from scipy.linalg import sqrtm

DIM, FRAMES_A, FRAMES_B = 8, 40, 25


def frechet(a, b):
    mean_a, mean_b = a.mean(0), b.mean(0)
    cov_a, cov_b = np.cov(a, rowvar=False), np.cov(b, rowvar=False)
    root = sqrtm(cov_a @ cov_b).real
    return ((mean_a - mean_b) ** 2).sum() + np.trace(cov_a + cov_b - 2 * root)


def c_array(name, values):
    text = textwrap.fill(", ".join(f"{v:.9g}f" for v in values.ravel()), 96)
    return f"static const float {name}[] = {{\n{text}}};\n"


def main():
    random = np.random.default_rng(20260402)
    mix_a, mix_b = random.normal(0, 1, (2, DIM, DIM))
    a = (random.normal(0, 1, (FRAMES_A, DIM)) @ mix_a).astype(np.float32)
    b = (random.normal(0.3, 1, (FRAMES_B, DIM)) @ mix_b).astype(np.float32)
    distance = frechet(a.astype(np.float64), b.astype(np.float64))

    print("/* Made by make_frechet.py; do not edit. */\n/* clang-format off */")
    print(f"#define DIM {DIM}\n#define FRAMES_A {FRAMES_A}\n#define FRAMES_B {FRAMES_B}\n")
    print(c_array("golden_a", a))
    print(c_array("golden_b", b))
    print(f"static const double golden_distance = {float(distance).hex()};")


if __name__ == "__main__":
    main()
