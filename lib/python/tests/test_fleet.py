"""Collections of experiences: exact searches, and results that do not depend on what was killed."""

import contextlib
import hashlib
import itertools
import json
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="no pyarrow")
pytest.importorskip("fsspec", reason="no fsspec")
zstandard = pytest.importorskip("zstandard", reason="no zstandard")

import pyarrow.parquet as pq

import libvdna
from libvdna import _vdna_fleet, fleet
from libvdna.fleet import collection as layout
from libvdna.fleet import index as indexing
from libvdna.fleet import search
from libvdna.fleet import subset

NEURONS, BINS = 8, 100
RANGE = np.array([[-4, 4]] * NEURONS, np.float32)


def experience(name, mean=0.0, seed=0, frames=30, range=RANGE, **changes):
    """A drive whose only tap is its embedding, along a line of `frames` metres."""
    random = np.random.default_rng(seed)
    embeddings = random.normal(mean, 1, (frames, NEURONS)).astype(np.float32)
    histogram = libvdna.Histogram(range, BINS)
    for embedding in embeddings:
        histogram.add(embedding)
    fields = {
        "name": name,
        "backbone": "tiny",
        "model_sha256": "0123456789abcdef" * 4,
        "preprocessing": "8x8",
        "taps": f"top:{NEURONS}:1",
        "histogram": histogram,
        "embeddings": embeddings,
        "frame_utime": np.arange(frames) * 100000 + seed * 10**9,
        "frame_grey": np.full(frames, 7, np.float32),
        "frame_position": np.arange(frames)[:, None] * np.array([[1.0, 0, 0]]),
    }
    return libvdna.Experience(**{**fields, **changes})


def threads():
    return ThreadPoolExecutor(2)


def written(folder, experiences):
    paths = []
    for one in experiences:
        paths.append(folder / f"{one.name}.vdna")
        one.write(paths[-1])
    return paths


def filled(tmp_path, experiences, routes=("",), uri=None):
    """A collection with an index; routes in turn."""
    paths = written(tmp_path, experiences)
    collection = fleet.Collection(str(uri or tmp_path / "fleet"))
    sources = [
        fleet.Source.of(str(path), fleet.Labels(route, "summer"))
        for path, route in zip(paths, itertools.cycle(routes))
    ]
    ended = fleet.build(collection, sources, threads, "vdna")
    assert (ended.made, ended.failures) == (len(paths), [])
    comparable = collection.only_comparable()
    assert fleet.update(collection, comparable, threads).rows == len(paths)
    return collection, comparable


def drives(count, spread=1.0):
    random = np.random.default_rng(3)
    return [
        experience(f"drive{i:03}", random.normal(0, spread), seed=i + 1) for i in range(count)
    ]


def tree(folder):
    """SHA-256 of each file."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_an_object_is_the_file_compressed_after_its_labels(tmp_path):
    one = experience("monday")
    vdna = one.to_bytes()
    data = layout.pack(vdna, fleet.Labels("ring", "rain"))
    assert data == layout.pack(vdna, fleet.Labels("ring", "rain"))
    assert layout.unpack(data) == (vdna, ("ring", "rain"))
    # An object that zstd itself has written has no labels.
    assert layout.unpack(zstandard.ZstdCompressor().compress(vdna)) == (vdna, ("", ""))
    path = tmp_path / "monday.vdna.zst"
    path.write_bytes(data)
    try:
        plain = subprocess.run(["zstd", "-dc", path], capture_output=True, check=True).stdout
    except FileNotFoundError:
        return
    assert plain == vdna


@pytest.mark.parametrize("bins", [2, 25, 26, 27, 100, 1000])
def test_bounds_are_at_most_the_distance(bins):
    random = np.random.default_rng(bins)
    for _ in range(50):
        weights = random.gamma(0.1, size=(2, bins, 3)) + 1e-12
        counts = [
            np.stack([random.multinomial(mass, w / w.sum()) for w in side.T], axis=1)
            for side, mass in zip(weights, random.integers(1, 2000, 2))
        ]
        p, q = (libvdna.HistogramView([[0, 1]] * 3, c.astype(np.uint32)) for c in counts)
        exact = libvdna.emd_mean(p, q)
        by_means = indexing.bound_by_means(indexing.mean_bins(p), indexing.mean_bins(q), bins)
        by_sums = indexing.Summary.of(p).bound(indexing.Summary.of(q), bins)
        assert by_means <= exact and by_sums <= exact
        assert by_means <= by_sums + 1e-3


def test_block_sums_leave_out_the_last_bin():
    counts = np.zeros((27, 1), np.uint32)
    counts[[0, 25, 26]] = [[2], [3], [5]]
    sums = indexing.Summary.of(libvdna.HistogramView([[0, 1]], counts)).sums
    assert sums.tolist() == [[2 * 25], [5]]


@pytest.mark.parametrize("spread", [0.0, 1.0])
def test_the_nearest_are_those_of_all_distances(tmp_path, spread):
    stored = drives(70, spread)
    stored += [experience(f"same{i}", 0.5, seed=999) for i in range(3)]
    collection, comparable = filled(tmp_path, stored)
    live = experience("now", 0.5, seed=999)
    order = {name: i for i, name in enumerate(sorted(one.name for one in stored))}
    expected = sorted(
        ((libvdna.emd_mean(live.histogram, one.histogram), order[one.name], one.name) for one in stored)
    )
    for k in (1, 2, 5, 100):
        found = fleet.nearest(collection, live.histogram, comparable, k)
        assert [(n.distance_bins, n.name) for n in found.neighbours] == [
            (distance, name) for distance, _, name in expected[:k]
        ]
        assert min(k, len(stored)) <= found.exact <= found.candidates == len(stored)
        if spread and k == 5:
            assert found.exact < len(stored) / 3
    one = fleet.nearest(collection, live.histogram, comparable, 1)
    assert one.bytes_read < found.bytes_read


def test_many_live_runs_are_tasks(tmp_path, capsys):
    collection, comparable = filled(tmp_path, drives(20))
    uri = str(tmp_path / "fleet")
    lives = [str(tmp_path / f"drive{i:03}.vdna") for i in range(3)]
    assert _vdna_fleet.main(["nearest", uri, *lives, "-k", "1", "--workers", "2"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"   0.0000 drive{i:03} to {path}" for i, path in enumerate(lives)
    ]
    assert _vdna_fleet.main(["nearest", uri, lives[0], "no.vdna", "-k", "1", "--workers", "2"]) == 3
    printed = capsys.readouterr()
    assert "no.vdna" in printed.err and printed.out == f"   0.0000 drive000 to {lives[0]}\n"
    results = fleet.nearest_of_each(collection, lives, threads, 2)
    for path, found, _ in results:
        live = libvdna.Experience.open(path).histogram
        assert found == fleet.nearest(collection, live, comparable, 2)


def test_a_damaged_index_is_refused(tmp_path):
    collection, comparable = filled(tmp_path, drives(40))
    (path,) = (tmp_path / "fleet" / "index").iterdir()
    group = pq.ParquetFile(path).metadata.row_group(0)
    sums = group.column(group.num_columns - 1)
    data = bytearray(path.read_bytes())
    data[sums.data_page_offset + sums.total_compressed_size - 9] ^= 1
    path.write_bytes(data)
    with pytest.raises(ValueError, match=f"{comparable}.parquet: damaged: .*CRC.*; remove it"):
        fleet.nearest(collection, experience("now").histogram, comparable, 40)


def test_no_part_of_the_index_is_read_twice(tmp_path, monkeypatch):
    monkeypatch.setattr(indexing, "ROW_GROUP", 2)
    monkeypatch.setattr(indexing, "_GROUPS_CACHED", 1)
    collection, comparable = filled(tmp_path, drives(40, 0.01), ["ring", "yard"])
    live = experience("now", seed=99).histogram
    (index,) = (tmp_path / "fleet" / "index").iterdir()
    objects = sum(collection.names(comparable).values())
    for where in (None, [("route", "==", "yard"), ("name", "!=", "drive007")]):
        found = fleet.nearest(collection, live, comparable, 40, where)
        assert found.exact == found.candidates == len(found.neighbours) == (40 if where is None else 19)
        assert found.bytes_read <= index.stat().st_size + objects


def test_where_chooses_by_columns(tmp_path):
    collection, comparable = filled(tmp_path, drives(9), ["ring", "yard", "hall"])
    live = experience("now").histogram
    found = fleet.nearest(collection, live, comparable, 9, [("route", "==", "yard")])
    assert sorted(n.name for n in found.neighbours) == ["drive001", "drive004", "drive007"]
    where = [("route", "!=", "yard"), ("first_utime", "<", 4 * 10**9)]
    found = fleet.nearest(collection, live, comparable, 9, where)
    assert sorted(n.name for n in found.neighbours) == ["drive000", "drive002"]
    assert fleet.nearest(collection, live, comparable, 9, [("name", "==", "?")]).neighbours == []
    with pytest.raises(ValueError, match="no column 'colour'"):
        fleet.nearest(collection, live, comparable, 9, [("colour", "==", "red")])


def test_the_index_says_what_the_experiences_are(tmp_path):
    stored = drives(3)
    collection, comparable = filled(tmp_path, stored, ["ring"])
    table = pq.read_table(tmp_path / "fleet" / "index" / f"{comparable}.parquet").to_pylist()
    for row, one in zip(table, stored):
        vdna = (tmp_path / f"{one.name}.vdna").read_bytes()
        assert (row["name"], row["route"], row["condition"]) == (one.name, "ring", "summer")
        assert row["sha256"] == hashlib.sha256(vdna).hexdigest()
        assert (row["frames"], row["size"]) == (30, len(vdna))
        assert (row["first_utime"], row["last_utime"]) == (
            one.frame_utime[0], one.frame_utime[-1]
        )  # fmt: skip
        assert row["mass"] == [30] * NEURONS


def test_the_index_follows_the_objects(tmp_path):
    collection, comparable = filled(tmp_path, drives(4))
    first = tree(tmp_path / "fleet")
    assert fleet.update(collection, comparable, threads)[:3] == (4, 0, 0)
    assert tree(tmp_path / "fleet") == first
    collection.remove(collection.object_key(comparable, "drive001"))
    more = written(tmp_path, [experience("later", seed=50)])
    fleet.build(collection, [fleet.Source.of(str(more[0]))], threads, "vdna")
    assert fleet.update(collection, comparable, threads)[:3] == (4, 1, 1)
    assert fleet.Index(collection, comparable).names == ["drive000", "drive002", "drive003", "later"]


def test_the_index_is_the_same_however_it_grew(tmp_path):
    stored = drives(80)
    (tmp_path / "parts").mkdir()
    whole, comparable = filled(tmp_path, stored, ["ring", "yard", "hall"])
    grown = fleet.Collection(str(tmp_path / "parts" / "fleet"))
    for begin, end in ((50, 80), (0, 3), (3, 50)):
        sources = [
            fleet.Source.of(
                str(tmp_path / f"drive{i:03}.vdna"), fleet.Labels(["ring", "yard", "hall"][i % 3], "summer")
            )
            for i in range(begin, end)
        ]
        fleet.build(grown, sources, threads, "vdna")
        assert fleet.update(grown, comparable, threads).added == end - begin
    assert tree(tmp_path / "parts" / "fleet") == tree(tmp_path / "fleet")
    live = experience("now").histogram
    where = [("route", "==", "yard")]
    names = fleet.Index(whole, comparable).names
    assert names == sorted(names, key=lambda name: (["hall", "ring", "yard"][(int(name[5:]) + 1) % 3], name))
    found = fleet.nearest(whole, live, comparable, 3, where)
    yard = {one.name: libvdna.emd_mean(live, one.histogram) for one in stored[1::3]}
    assert [n.name for n in found.neighbours] == sorted(yard, key=yard.get)[:3]
    assert found.bytes_read < fleet.nearest(whole, live, comparable, 3).bytes_read


def test_what_is_there_is_not_added_again(tmp_path):
    collection, comparable = filled(tmp_path, drives(2))
    before = tree(tmp_path / "fleet")
    sources = [fleet.Source.of(str(tmp_path / f"drive00{i}.vdna")) for i in range(2)]
    assert fleet.build(collection, sources, threads, "vdna") == (0, 2, [])
    assert tree(tmp_path / "fleet") == before


def test_collections_merge(tmp_path):
    (tmp_path / "robot").mkdir()
    collection, comparable = filled(tmp_path, drives(3), ["ring"])
    robot, _ = filled(tmp_path / "robot", drives(5), ["yard"])
    damaged = tmp_path / "robot" / "fleet" / robot.object_key(comparable, "drive003")
    damaged.write_bytes(damaged.read_bytes()[:-1])
    ended = fleet.merge(collection, [robot.uri], threads)
    assert ended[:2] == (1, 3) and "drive003.vdna.zst: damaged" in ended.failures[0]
    assert collection.load(comparable, "drive004").labels.route == "yard"
    assert collection.load(comparable, "drive000").labels.route == "ring"
    key = collection.object_key(comparable, "drive004")
    assert collection.get(key) == robot.get(key)


def test_an_object_store_and_any_executor_will_do(tmp_path):
    uri = f"memory://{tmp_path.name}"
    collection, comparable = filled(tmp_path, drives(20), uri=uri)
    local, _ = filled(tmp_path, drives(20))
    live = experience("now").histogram
    found = fleet.nearest(collection, live, comparable)
    assert found == fleet.nearest(local, live, comparable)
    assert fleet.Collection(uri).names(comparable) == local.names(comparable)


def test_duplicates_are_what_an_earlier_one_on_the_route_repeats(tmp_path):
    stored = drives(12)
    counts = np.array(stored[3].histogram.counts)
    for copy, at in (("zcopy", 40), ("other", 41)):
        stored.append(experience(copy, seed=at).with_histogram(libvdna.HistogramView(RANGE, counts)))
    routes = ["ring"] * 13 + ["yard"]
    collection, comparable = filled(tmp_path, stored, routes)
    done = fleet.duplicates(collection, comparable, 0, threads)
    assert done.duplicates == [("zcopy", "drive003", 0.0)]
    assert done.exact < done.pairs == 13 * 12 // 2

    within = 3.0
    kept, expected = [], set()
    for one in stored[:13]:
        if any(libvdna.emd_mean(one.histogram, k.histogram) <= within for k in kept):
            expected.add(one.name)
        else:
            kept.append(one)
    done = fleet.duplicates(collection, comparable, within, threads, [("route", "==", "ring")])
    assert {one.name for one in done.duplicates} == expected


def test_pairs_are_all_distances_and_few_enough(tmp_path, monkeypatch):
    stored = drives(20)
    collection, comparable = filled(tmp_path, stored, ["ring", "yard"])
    out = tmp_path / "pairs.parquet"
    assert fleet.pairs(collection, comparable, str(out), threads) == (190, [])
    by_name = {one.name: one.histogram for one in stored}
    rows = pq.read_table(out).to_pylist()
    assert len({frozenset((row["a"], row["b"])) for row in rows}) == 190
    for row in rows:
        assert row["distance_bins"] == libvdna.emd_mean(by_name[row["a"]], by_name[row["b"]])
    monkeypatch.setattr(search, "PAIRS_MAX", 19)
    with pytest.raises(ValueError, match="20 experiences have 190 pairs; choose some by --where"):
        fleet.pairs(collection, comparable, str(out), threads)
    assert fleet.pairs(collection, comparable, str(out), threads, [("route", "==", "ring")])[0] == 45


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "moved"])
def test_a_damaged_object_is_named_and_left_out(tmp_path, capsys, damage):
    collection, comparable = filled(tmp_path, drives(5))
    key = collection.object_key(comparable, "drive002")
    path = tmp_path / "fleet" / key
    data = bytearray(path.read_bytes())
    if damage == "cut":
        data = data[:-9]
    elif damage == "flipped":
        data[len(data) // 2] ^= 1
    elif damage == "empty":
        data = b""
    else:
        data = (path.parent / "drive001.vdna.zst").read_bytes()
    path.write_bytes(data)
    os.unlink(tmp_path / "fleet" / "index" / f"{comparable}.parquet")
    uri = str(tmp_path / "fleet")
    assert _vdna_fleet.main(["index", uri, "--workers", "1"]) == 3
    printed = capsys.readouterr()
    assert "4 rows, 4 new, 0 removed" in printed.out
    assert f"vdna-fleet: {uri}/{key}: " in printed.err
    assert "drive002" not in fleet.Index(collection, comparable).names


def test_counting_again_is_as_building_anew(tmp_path):
    wider = (RANGE * np.float32(1.5)).astype(np.float32)
    old = [experience(f"drive{i}", i / 4, i) for i in range(3)]
    collection, comparable = filled(tmp_path, old, ["ring"])
    (tmp_path / "fleet" / "ranges.json").write_text(json.dumps({"range": wider.tolist()}))
    assert fleet.rebin(collection, comparable, threads) == (3, 0, [])
    assert fleet.rebin(collection, comparable, threads) == (0, 3, [])
    (new,) = set(collection.comparables()) - {comparable}
    for i in range(3):
        stored = collection.load(new, f"drive{i}")
        assert stored.experience.to_bytes() == experience(f"drive{i}", i / 4, i, range=wider).to_bytes()
        assert stored.labels == ("ring", "summer")


@pytest.mark.skipif("VDNA" not in os.environ, reason="no program vdna; its path goes to $VDNA")
def test_ranges_and_bins_are_those_of_the_program(tmp_path):
    """With the network whose tap is the embedding."""
    vdna, paper = os.environ["VDNA"], ("--backbone", "efficientnet_lite0_paper")

    def run(*arguments):
        subprocess.run([vdna, *map(str, arguments)], check=True, capture_output=True, cwd=tmp_path)

    for drive in ("one", "two"):
        run("simulate", drive, "--frames", 4, "--size", "96x72", "--drive", len(drive) + ord(drive[0]))
    run("calibrate", "one.json", "one", *paper)
    run("calibrate", "two.json", "two", *paper)
    run("calibrate", "both.json", "one", "two", *paper)
    files = [json.loads((tmp_path / f"{name}.json").read_text()) for name in ("one", "two", "both")]
    assert fleet.merged_ranges(files[:2]) == files[2]

    run("build", "old", "two", "--ranges", "one.json", *paper)
    run("build", "new", "two", "--ranges", "both.json", *paper)
    collection = fleet.Collection(str(tmp_path / "fleet"))
    old = (tmp_path / "old" / "two.vdna").read_bytes()
    collection.add(old, fleet.Labels())
    comparable = collection.only_comparable()
    collection.put("ranges.json", (tmp_path / "both.json").read_bytes())
    assert fleet.rebin(collection, comparable, threads) == (1, 0, [])
    (other,) = set(collection.comparables()) - {comparable}
    new = (tmp_path / "new" / "two.vdna").read_bytes()
    assert collection.load(other, "two").experience.to_bytes() == new != old


def test_only_what_was_counted_from_embeddings_is_counted_again():
    one = experience("drive")
    other = one.with_histogram(experience("other", seed=9).histogram)
    with pytest.raises(ValueError, match="drive: its Visual DNA is not that of its embeddings"):
        fleet.rebinned(other, RANGE)


def test_ranges_merge_to_those_of_one_run():
    random = np.random.default_rng(5)
    frames = random.normal(0, [1, 2, 3], (40, 3)).astype(np.float32)

    def file(part, rule="midpoint"):
        ranges = libvdna.Ranges(3)
        for frame in part:
            ranges.observe(frame)
        table = ranges.expand(1.2)
        return {
            "backbone": "tiny", "factor": 1.2, "rule": rule, "range": table.tolist(),
            "observed": ranges.observed.tolist(),
        }  # fmt: skip

    parts = [file(frames[:7]), file(frames[7:9]), file(frames[9:])]
    assert fleet.merged_ranges(parts) == file(frames)
    with pytest.raises(ValueError, match="rule 'zero' and 'midpoint' do not merge"):
        fleet.merged_ranges([parts[0], file(frames, "zero")])
    del parts[1]["observed"]
    with pytest.raises(ValueError, match="does not say what was observed"):
        fleet.merged_ranges(parts)


def test_the_choice_is_within_its_bound_of_the_best():
    random = np.random.default_rng(11)
    for _ in range(40):
        tables = [random.random((5, 5)), random.random((3, 3))]
        sizes = [random.integers(1, 9, 5), random.integers(1, 9, 3)]
        budget = int(random.integers(1, 25))
        flat = [(t, c) for t in range(2) for c in range(len(sizes[t]))]

        def worth(some):
            return sum(
                tables[t][:, [c for of, c in some if of == t]].max(axis=1, initial=0).sum()
                for t in range(2)
            )

        best = max(
            worth(some)
            for n in range(9)
            for some in itertools.combinations(flat, n)
            if sum(sizes[t][c] for t, c in some) <= budget
        )
        chosen, share = subset.choose(tables, sizes, budget)
        assert sum(sizes[t][c] for t, c in chosen) <= budget
        assert worth(chosen) >= share * best - 1e-12
        assert 0.31 < share <= 1


def test_a_subset_is_shipped_within_its_budget(tmp_path, capsys):
    stored = [experience(f"drive{i}", seed=i % 2, frame_utime=np.arange(30) + i) for i in range(6)]
    collection, comparable = filled(tmp_path, stored, ["ring"])
    size = (tmp_path / "drive0.vdna").stat().st_size
    out = tmp_path / "map"
    uri = str(tmp_path / "fleet")
    command = ["ship", uri, str(out), "--budget", str(2 * size), "--workers", "2"]
    assert _vdna_fleet.main(command) == 0
    # Two kinds of drives: one of each is all that is needed.
    kinds = {int(one.name[-1]) % 2 for one in libvdna.open_map(out)}
    assert kinds == {0, 1} and len(list(out.iterdir())) == 2
    assert "ring: expected recall 1.000 of 1.000 with all" in capsys.readouterr().out
    assert not (tmp_path / "fleet" / "parts").exists() or not tree(tmp_path / "fleet" / "parts")


def test_without_labels_the_near_ones_are_shipped(tmp_path):
    stored = [experience(f"drive{i}", i / 9, i, frame_position=None) for i in range(6)]
    collection, comparable = filled(tmp_path, stored, ["ring"])
    done = fleet.ship(collection, comparable, str(tmp_path / "map"), 1, threads)
    assert (done.names, done.size, done.by) == ([], 0, {"ring": "distance"})
    done = fleet.ship(collection, comparable, str(tmp_path / "map"), 10**9, threads)
    assert len(done.names) == 6 and done.worth["ring"][0] == 1 and done.best_share == 1


#: In place of vdna: a recording is the bytes of its experience file. The first call that finds no
#: file `killed` kills its `victim`, the worker or the driver, which is its parent.
STUB = """#!{python}
import os, pathlib, signal, sys
_, _, folder, source, _, name, *_ = sys.argv
killed = pathlib.Path({killed!r})
pathlib.Path(folder).mkdir()
(pathlib.Path(folder) / (name + ".vdna")).write_bytes(pathlib.Path(source).read_bytes())
if source.endswith("3.rec"):
    try:
        killed.touch(exist_ok=False)
    except FileExistsError:
        pass
    else:
        worker = os.getppid()
        driver = int(pathlib.Path(f"/proc/{{worker}}/stat").read_text().rsplit(")", 1)[1].split()[1])
        os.kill({{"worker": worker, "driver": driver}}[{victim!r}], signal.SIGKILL)
"""

PROGRAM = """import sys
from libvdna._vdna_fleet import main
if __name__ == "__main__":
    sys.exit(main())
"""


@pytest.fixture
def recordings(tmp_path):
    """Eight of them, and the collection that one process makes of them."""
    # A short path, because Ray has sockets there.
    (tmp_path / "temporary").symlink_to(tempfile.mkdtemp(dir="/tmp"))
    (tmp_path / "program.py").write_text(PROGRAM)
    stored = drives(8)
    for one in stored:
        (tmp_path / f"{one.name}.rec").write_bytes(one.to_bytes())
    (tmp_path / "killed").touch()
    assert fleet_of(tmp_path, "expected", "worker") == 0
    assert len(tree(tmp_path / "expected")) == 10
    (tmp_path / "killed").unlink()
    yield tmp_path
    shutil.rmtree((tmp_path / "temporary").resolve(), ignore_errors=True)


def fleet_of(folder, name, victim, workers=1, engine="local", **more):
    """Exit status of building and indexing; negative if it was killed. `more` goes into the
    environment."""
    stub = folder / "vdna"
    stub.write_text(STUB.format(python=sys.executable, killed=str(folder / "killed"), victim=victim))
    stub.chmod(0o755)
    (folder / name).mkdir(exist_ok=True)
    (folder / name / "ranges.json").write_text(json.dumps({"range": RANGE.tolist()}))
    # Relative paths: of our working directory, which workers need not have.
    sources = [f"drive{i:03}.rec" for i in range(8)]
    environment = {**environment_in(folder), **more}
    command = (sys.executable, "-B", folder / "program.py")
    options = ("--engine", engine, "--workers", str(workers))
    for arguments in (("build", name, *sources, "--vdna", "./vdna"), ("index", name)):
        done = subprocess.run([*command, *arguments, *options], env=environment, cwd=folder, timeout=200)
        if done.returncode != 0:
            return done.returncode
    return 0


def environment_in(folder):
    """Of programs that have their temporary files there, and our modules."""
    temporary = str((folder / "temporary").resolve())
    return {**os.environ, "TMPDIR": temporary, "HOME": temporary, "PYTHONPATH": os.pathsep.join(sys.path)}


def assert_as_expected(folder):
    assert tree(folder / "fleet") == tree(folder / "expected")
    assert list((folder / "temporary").glob("vdna-fleet*")) == []


def test_a_killed_worker_changes_nothing(recordings):
    assert fleet_of(recordings, "fleet", "worker", workers=2) == 0
    assert (recordings / "killed").exists()
    # What the worker had left aside goes with the next command, as each begins with it.
    assert_as_expected(recordings)


def test_a_killed_driver_goes_on_where_it_was(recordings):
    assert fleet_of(recordings, "fleet", "driver", workers=2) < 0
    whole = {name for name in tree(recordings / "fleet") if ".aside-" not in name}
    assert whole < set(tree(recordings / "expected"))
    temporary = (recordings / "temporary").resolve()
    until = time.monotonic() + 20
    while processes_with(temporary) and time.monotonic() < until:
        time.sleep(0.1)
    assert processes_with(temporary) == []
    assert fleet_of(recordings, "fleet", "driver", workers=2) == 0
    assert_as_expected(recordings)


def processes_with(temporary):
    """Those whose $TMPDIR this is; none of a dead one that nobody has waited for."""
    found = []
    for one in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.fsencode(f"TMPDIR={temporary}") in (one / "environ").read_bytes():
                found.append(one.name)
        except OSError:
            continue
    return found


@pytest.mark.parametrize("task", ["rows", "pairs", "part"])
def test_the_memory_of_a_worker_does_not_grow_with_its_tasks(tmp_path, task):
    """An experience of 1000 x 1000 counts is 4 MB; that of one task is the limit, not of all."""
    edges = np.array([[-4, 4]] * 1000, np.float32)
    counts = np.zeros((1000, 1000), np.uint32)
    counts[500] = 30
    dna = libvdna.HistogramView(edges, counts)
    one = experience("x", taps="top:1000:1", histogram=dna)
    collection = fleet.Collection(str(tmp_path / "fleet"))
    size = len(one.to_bytes()) // 1024
    for i in range(48):
        named = experience(f"x{i:02}", taps="top:1000:1", histogram=dna, seed=i)
        collection.add(named.to_bytes(), fleet.Labels())
    command = [sys.executable, "-B", "-c", PEAK, str(tmp_path / "fleet"), collection.only_comparable(), task]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    begun, one_task, three = (
        int(subprocess.run([*command, str(n)], env=environment, capture_output=True, check=True).stdout)
        for n in (0, 1, 3)
    )
    print(f"peak of a worker: {begun} kB, {one_task} kB after one task, {three} kB after three")
    assert three - one_task < 8 * size
    held = {"rows": 1, "pairs": 16, "part": 5}[task]  # experiences at a time
    assert one_task - begun < (held + 20) * size


#: Runs N tasks on 16 objects each as a worker does, and prints its peak in kB.
PEAK = """
import re, sys
from libvdna.fleet import Collection, index, search, subset
uri, comparable, task, count = *sys.argv[1:4], int(sys.argv[4])
names = list(Collection(uri).names(comparable))
for n in range(count):
    some, key = names[16 * n : 16 * n + 16], f"parts/{n}"
    if task == "rows":
        assert index._rows(uri, comparable, some, key) == []
    elif task == "pairs":
        search._pairs_of_blocks(uri, comparable, some, some, key)
    else:
        subset._part(uri, comparable, some, 0, "distance", 5, key, "")
print(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1])
"""


@contextlib.contextmanager
def ray_of(folder, head):
    """What to add to the environment of programs that use Ray: nothing without a `head`, since they
    start their own, or the address of one that is started here, by an operator with telemetry on."""
    if not head:
        yield {}
        return
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    reach = {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": secrets.token_hex(32)}
    telemetry = {"RAY_USAGE_STATS_ENABLED": "1", "RAY_USAGE_STATS_REPORT_URL": "http://127.0.0.1:9/"}
    command = (
        *(sys.executable, "-m", "ray.scripts.scripts", "start", "--head", "--block"),
        *("--node-ip-address", "127.0.0.1", "--port", str(port), "--num-cpus", "2"),
        *("--include-dashboard", "false"),
    )
    environment = {**environment_in(folder), **reach, **telemetry}
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as ray:
        try:
            until = time.monotonic() + 100
            while socket.socket().connect_ex(("127.0.0.1", port)) != 0:
                assert ray.poll() is None and time.monotonic() < until, "Ray does not start"
                time.sleep(0.2)
            yield {**reach, "RAY_ADDRESS": f"127.0.0.1:{port}"}
        finally:
            ray.terminate()


@pytest.mark.parametrize("head", [False, True])
def test_ray_gives_the_same_and_survives_a_killed_worker(recordings, head):
    pytest.importorskip("ray", reason="no ray")
    with ray_of(recordings, head) as reach:
        assert fleet_of(recordings, "fleet", "worker", workers=2, engine="ray", **reach) == 0
    assert (recordings / "killed").exists()
    assert_as_expected(recordings)


@pytest.mark.parametrize("head", [False, True])
def test_the_telemetry_of_ray_is_off(recordings, head):
    """In a worker too, wherever it runs."""
    pytest.importorskip("ray", reason="no ray")
    with ray_of(recordings, head) as reach:
        done = subprocess.run(
            [sys.executable, "-B", "-c", TELEMETRY],
            env={**environment_in(recordings), **reach}, capture_output=True, text=True, timeout=200,
        )  # fmt: skip
    assert (done.stdout, done.returncode) == ("driver 0, worker 0\n", 0), done.stderr


TELEMETRY = """
import os
from libvdna import fleet
with fleet.on_ray(1)() as ray:
    worker = ray.submit(os.getenv, "RAY_USAGE_STATS_ENABLED").result()
print(f"driver {os.environ['RAY_USAGE_STATS_ENABLED']}, worker {worker}")
"""

DEMO = pathlib.Path(__file__).parents[3] / "apps" / "demo" / "fleet.sh"


@pytest.mark.skipif(
    not {"VDNA", "VDNA_ALL"} <= set(os.environ), reason="takes minutes; ./dev test --all runs it"
)
@pytest.mark.parametrize("engine", ["local", "ray"])
def test_the_demo_shows_what_it_says(recordings, engine):
    if engine == "ray":
        pytest.importorskip("ray", reason="no ray")
    (recordings / "build" / "wheel").mkdir(parents=True)
    (recordings / "build" / "bin").symlink_to(pathlib.Path(os.environ["VDNA"]).parent)
    (recordings / "build" / "wheel" / "bin").symlink_to(pathlib.Path(sys.executable).parent)
    with ray_of(recordings, engine == "ray") as reach:
        done = subprocess.run(
            [DEMO, engine], cwd=recordings, env={**environment_in(recordings), **reach},
            capture_output=True, text=True,
        )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    for expected in (
        "200 traversals in", "200 experiences added, 0 were there", "200 rows, 200 new, 0 removed",
        *(f"0.0000 route{i}_dusk_2copy repeats route{i}_dusk_2" for i in range(1, 6)),
        "route5: expected recall", "route5: recall", "points on average",
    ):  # fmt: skip
        assert expected in done.stdout, done.stdout
    print(done.stdout)


def test_the_program_tells_what_is_wrong(tmp_path, capsys):
    uri = str(tmp_path / "fleet")
    (recording,) = [tmp_path / "drive"]
    recording.mkdir()
    for command, expected in (
        (["build", uri, str(recording)], "ranges.json: is not there; make it of some recordings"),
        (["pairs", uri, "out.parquet"], "none comparable, expected one: add experiences by"),
        (["build", uri, "a/x.vdna", "b/x.vdna"], "x: named twice"),
        (["nearest", uri, "nothing.vdna"], "nothing.vdna"),
    ):
        assert _vdna_fleet.main(command) == 1
        assert expected in capsys.readouterr().err
    with pytest.raises(SystemExit):
        _vdna_fleet.main(["nearest", uri, "x.vdna", "--where", "frames=many"])
    assert "frames is a whole number" in capsys.readouterr().err
