#!/usr/bin/env python3
"""Write trust_golden.h: numbers of the reference implementations of trust, for test_trust.c.

They are predict.py, trust.py and localise.py of $VDNA_SHARED/reference (default: ../shared beside the
project). Numbers that the references print themselves as golden are compared with theirs here. Made-up
runs, of which the library gets the tables, in doubles; and for what makes the tables the runs, rounded
to float32, before the references see them. So all must agree to 1e-9, the difference of sums in
another order.

    test/golden/make_trust.py > test/golden/trust_golden.h      (NumPy 1.24, Python 3.11)
"""
import os
import pathlib
import sys

import numpy as np

from make_localise import as_float, c_array

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("VDNA_SHARED", ROOT.parent / "shared"))
sys.path.insert(0, str(SHARED / "reference"))
import localise  # noqa: E402
import predict  # noqa: E402
import trust  # noqa: E402

WINDOWS = 7
KEYS = ("w", "beta", "c", "sd", "sd_best", "t90")


def distance_to(runs):
    """Stands in for the EMD, as in the references."""
    return lambda frames, b: float(np.abs(frames.mean(0) - runs[b].mean(0)).mean())


def relative(live, run):
    return trust.nearest(live, run)[1]


def cells_of(runs, places, tolerance, correct):
    """[run][candidate][nearest, likeness, recall, distance][window]"""
    k = len(runs)
    cells, distance = np.full((k, k, 4, WINDOWS), np.nan), distance_to(runs)
    for a in range(k):
        for b in range(k):
            if a == b:
                continue
            rho = relative(runs[a], runs[b])
            good = correct(runs[a], places[a], runs[b], places[b], tolerance)
            for i, frames in enumerate(predict.windows(len(runs[a]))):
                cells[a, b, 0, i] = rho[frames].mean()
                cells[a, b, 2, i] = np.delete(good, frames).mean()
                cells[a, b, 3, i] = distance(runs[a][frames], b)
    return cells


def by_euclid(live, live_place, run, place, tolerance):
    index = trust.nearest(live, run)[0]
    return np.abs(live_place - place[index]) <= tolerance


def correlations(runs, w):
    """tau of each run: the median of the reference's values of it."""
    def of(a):
        rows = [relative(runs[a], runs[b]) / w[b] for b in range(len(runs)) if b != a]
        times = trust.correlation_times(np.array(rows))
        return float(np.median(times)) if times else float("nan")
    return [of(a) for a in range(len(runs))]


def skill_of(cells, w):
    """That of trust.py, of predictions by predict.py's model."""
    k = len(w)
    frames = [~np.isnan(cells[a, a - 1, 0]) for a in range(k)]
    x = [predict.ln(cells[a, :, 0][:, frames[a]].T / w) for a in range(k)]
    y = [predict.to_y(cells[a, :, 2][:, frames[a]].T) for a in range(k)]
    d = [cells[a, :, 3][:, frames[a]].T for a in range(k)]
    error = error_of_means = 0.0
    for a in range(k):
        r = np.arange(k) != a
        part = predict.Model(*([v[i][:, r] for i in np.flatnonzero(r)] for v in (x, y, d)))
        guess = np.array([part(x[a][i, r], d[a][i, r]) for i in range(len(x[a]))])
        truth = predict.to_recall(y[a][:, r])
        error += np.abs(truth - predict.to_recall(guess)).mean()
        means = predict.to_recall(np.nanmean(part.y, 0))
        error_of_means += np.abs(truth - means).mean()
    return 1 - error / error_of_means


def number(x):
    return "NAN" if np.isnan(x) else repr(float(x))


def doubles(name, values):
    print(c_array("double", f"golden_{name}", np.ravel(values), number))


def integers(name, values):
    print(c_array("uint32_t", f"golden_{name}", values, lambda v: str(int(v))))


def print_tables(name, runs, places, tolerance, correct, w):
    integers(f"{name}_frames", [len(r) for r in runs])
    doubles(f"{name}_own", w)
    doubles(f"{name}_correlation", correlations(runs, w))
    doubles(f"{name}_cells", cells_of(runs, places, tolerance, correct))


def print_live(name, live, runs):
    """rho [frames][runs]"""
    doubles(f"{name}_live", np.array([relative(live, r) for r in runs]).T)


def check(found, golden, names):
    for name in names:
        assert np.allclose(found[name], golden[name], rtol=0, atol=1e-9), name


def print_centred(name, live, runs, places):
    """predict.py"""
    distance = distance_to(runs)
    distances = [distance(live, b) for b in range(len(runs))]
    cal = predict.calibrate(runs, places, 2.0, distance)
    recall, low, high = predict.predict(cal, live, runs, distances)
    m = cal["model"]
    transfer = predict.to_recall(predict.transfer(np.array(distances), m.d, m.y))
    found = {**{k: cal[k] for k in ("w", "sd", "sd_best", "t90")}, "beta": m.beta, "c": m.c,
             "transfer": transfer, "recall": recall, "low": low, "high": high}
    print_tables(name, runs, places, 2.0, predict.correct, cal["w"])
    print_live(name, live, runs)
    doubles(f"{name}_distances", distances)
    doubles(f"{name}_skill", [skill_of(cells_of(runs, places, 2.0, predict.correct), cal["w"])])
    for key in ("c", "transfer", "recall", "low", "high"):
        doubles(f"{name}_{key}", found[key])
    doubles(f"{name}_fit", [found[key] for key in ("beta", "sd", "sd_best", "t90")])
    return found


def print_euclidean(name, live, runs, places):
    """trust.py"""
    cal = trust.calibrate(runs, places, 2.0)
    s = trust.live_s(cal, live, runs)
    y, recall, low, high = trust.predict(cal, s)
    assert cal["tau"] == max(1, np.median(correlations(runs, cal["w"]))) or len(runs) > 3
    print_tables(name, runs, places, 2.0, by_euclid, cal["w"])
    print_live(name, live, runs)
    doubles(f"{name}_c", cal["c"])
    doubles(f"{name}_nearest", s.mean(1))
    doubles(f"{name}_recall", recall)
    doubles(f"{name}_low", low)
    doubles(f"{name}_high", high)
    doubles(f"{name}_unlike", [trust.unlike(cal, s)])
    doubles(f"{name}_skill", [cal["skill"]])
    doubles(f"{name}_far", [cal["far"]])
    doubles(f"{name}_fit", [cal[key] for key in ("beta", "sd", "sd_best", "t90")])
    tau = max(1, np.nanmedian(correlations(runs, cal["w"])))
    doubles(f"{name}_tau", [tau])
    cal["tau"] = tau
    settled = [trust.settled(cal, s[:, :n]) for n in range(1, s.shape[1] + 1)]
    integers(f"{name}_settled", [settled.index(True) + 1 if True in settled else 0])
    return cal


def print_drive(cal, runs, drive):
    """The choice of every frame, and of every third frame at other costs."""
    print_live("drive", drive, runs)
    s = trust.live_s(cal, drive, runs)
    doubles("drive_expected", predict.to_recall(cal["c"][:, None] + cal["beta"] * trust.ln(s)).T)
    again = trust.Reselect(cal, 2, cost=3.0)
    integers("drive_choice", [again.feed(frame) for frame in s.T])


def print_settling(cal):
    """Frames after which the choice settles, the more the louder the noise of the candidates."""
    t = np.arange(120)
    noise = np.array([np.sin((1.1 + 0.7 * b) * t + b) + np.sin(0.31 * (b + 1) * t) for b in range(3)]).T
    doubles("settling_noise", noise)
    base = np.array([0.2, 0.22, 0.25])
    settled = []
    for level in range(20):
        s = (base * (1 + 0.02 * level * noise)).T / cal["w"][:, None]
        settled.append(next((n for n in range(1, 121) if trust.settled(cal, s[:, :n])), 0))
    assert len(set(settled)) > 6, settled
    integers("settling", settled)


def print_flicker():
    """Recall of three candidates that take turns, each for longer than the last, with returns."""
    cal, k, frames = {"c": np.zeros(3), "beta": 1.0}, 3, 400
    t = np.arange(frames)
    best = (np.sqrt(t) * 1.3).astype(int) % k
    recall = 0.2 + 0.7 * (best[:, None] == np.arange(k)) + 0.05 * np.sin(t[:, None] + np.arange(k))
    # s of which the reference makes this recall
    s = np.exp(predict.to_y(recall))
    doubles("flicker", predict.to_recall(trust.ln(s)))
    integers("flicker_choice", feed_all(trust.Reselect(cal, 1, cost=1.0), s, 1))
    integers("flicker_strided", feed_all(trust.Reselect(cal, 1, cost=2.0), s[::3], 3))


def feed_all(again, s, stride):
    choices = [again.feed(frame, stride) for frame in s]
    assert len(again.returns) > 2 and len(set(choices)) == 3, (again.returns, choices)
    return choices


def other_runs(lengths, dim=8):
    """Runs like those of the references, of other lengths and looks."""
    out, places = [], []
    for r, frames in enumerate(lengths):
        t, d = np.arange(frames)[:, None] * (60 / max(lengths)), np.arange(dim)[None]
        place = np.sin(0.07 * t * (1 + d % 4) + 1.3 * d) + np.sin(0.11 * t * (1 + d % 3) + 0.7 * d)
        look = 0.25 * r * np.cos(2.1 * d)
        noise = (0.3 + 0.1 * r) * np.sin(12.9898 * (t + 7 * r + 1) + 78.233 * (d + 3 * r) + 0.5 * t * d)
        out.append(3.0 + place + look + noise)
        places.append(np.round(t[:, 0]))
    return out, places


def floats(name, values):
    print(c_array("float", f"golden_{name}", np.ravel(values), as_float))


def print_runs(lengths):
    """Runs, rounded to float32, and what the references make of them."""
    runs, places = other_runs(lengths)
    rounded = [np.float32(r) for r in runs]
    runs = [r.astype(float) for r in rounded]
    for i, run in enumerate(rounded):
        floats(f"run{i}", run)
    integers("run_places", np.concatenate(places))
    positions = [np.stack([3 * p, 4 * p, 0 * p], 1) for p in places]  # 5 m from place to place
    doubles("run_own", [trust.own_scale(r, p, 2.0) for r, p in zip(runs, places)])
    doubles("run_own_metres", [trust.own_scale(r, p, 7.0) for r, p in zip(runs, positions)])
    doubles("run_cells", cells_of(runs, places, 2.0, predict.correct))
    doubles("run_cells_euclidean", cells_of(runs, places, 2.0, by_euclid))
    doubles("run_correlation", correlations(runs, [1] * len(runs)))
    scales = [np.abs(r).max(1) / 127 for r in rounded]
    codes = [np.round(r.astype(float) / s.astype(np.float32)[:, None].astype(float)) for r, s in zip(rounded, scales)]
    coded = [c * s.astype(np.float32)[:, None].astype(float) for c, s in zip(codes, scales)]
    doubles("run_likeness", [relative(coded[0], c).mean() for c in coded[1:]])


def print_transfer():
    """localise.py; a run of one frame has one window."""
    live = np.array([5., 9., 6.])
    d = np.array([[0, 8, 5], [8.5, 0, 9], [5.5, 9.5, 0]])
    r = np.array([[100, 40, 90], [55, 100, 35], [92, 30, 100]])
    doubles("transfer_live", live)
    doubles("transfer_distance", d)
    doubles("transfer_recall", r / 100)
    three = localise.predicted_recall(live, d, r)
    assert np.allclose(three, localise.GOLDEN_PREDICTION, rtol=0, atol=1e-9)
    doubles("transfer_of_three", three / 100)
    doubles("transfer_of_two", localise.predicted_recall(live[:2], d[:2, :2], r[:2, :2]) / 100)


def main():
    print("/* Made by make_trust.py; do not edit. */\n/* clang-format off */")
    runs, places = predict.tiny()
    found = print_centred("centred", runs[4][5:25], runs[:4], places[:4])
    check(found, predict.GOLDEN, (*KEYS, "transfer", "recall", "low", "high"))

    runs, places = trust.tiny()
    live, runs, places = runs[3], runs[:3], places[:3]
    cal = print_euclidean("euclidean", live[5:25], runs, places)
    check(cal, trust.GOLDEN, (*KEYS, "skill", "far", "tau"))
    drive = np.concatenate([live[:24], runs[0][24:] + 0.3 * np.cos(np.arange(8))])
    print_drive(cal, runs, drive)
    print_settling(cal)
    print_live("clear", drive[24:44], runs)
    s = trust.live_s(cal, drive[24:44], runs)
    assert [n for n in range(1, 21) if trust.settled(cal, s[:, :n])][0] == trust.GOLDEN["settled_at"][1] == 10

    lengths = [60, 48, 20, 40, 5, 120, 33]
    runs, places = other_runs(lengths)
    print_centred("six", runs[3][8:30] + 0.1, [*runs[:3], *runs[4:]], [*places[:3], *places[4:]])
    print_euclidean("six_euclidean", runs[3][8:30] + 0.1, [*runs[:3], *runs[4:]], [*places[:3], *places[4:]])
    print_flicker()
    print_transfer()
    print_runs([40, 17, 5])


if __name__ == "__main__":
    main()
