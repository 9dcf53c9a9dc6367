"""Medians of interleaved rounds, and ratios to peers that run right after.

The machine may be shared. So single-threaded work is measured in processor time; each round records
how long its threads waited for a processor, and only the half of the rounds that waited least is
used.
"""
import math
import os
import statistics
import time

SHORTEST = 0.004  # seconds: shorter calls are repeated within a round
LEAST_ROUNDS = 4


def waited(process="self"):
    """Seconds that all threads of a process have waited for a processor so far."""
    return scheduled(process)[1]


def ran(process):
    """Seconds that all threads of a process have had of a processor so far."""
    return scheduled(process)[0]


def scheduled(process):
    """Seconds that all threads ran, and waited to run."""
    total = [0, 0]
    folder = f"/proc/{process}/task"
    for task in os.listdir(folder):
        try:
            with open(f"{folder}/{task}/schedstat", encoding="ascii") as file:
                total = [a + int(b) for a, b in zip(total, file.read().split())]
        except OSError:  # the thread has ended, or the kernel does not count
            pass
    return total[0] / 1e9, total[1] / 1e9


def seconds_of(work, repeat, clock):
    """Seconds of one call, and its threads' waiting time as a share of that."""
    before, begin = waited(), clock()
    for _ in range(repeat):
        work()
    elapsed = clock() - begin
    return elapsed / repeat, (waited() - before) / elapsed


def repeats_of(work, clock):
    """Number of calls that hides the overhead of the clock and of Python; warms up too."""
    work()
    seconds, _ = seconds_of(work, 1, clock)
    return max(1, math.ceil(SHORTEST / max(seconds, 1e-7)))


def calmest(rounds, wait_of):
    """The half of the rounds that waited least, at least LEAST_ROUNDS, in their order."""
    count = max(LEAST_ROUNDS, math.ceil(len(rounds) / 2))
    chosen = sorted(range(len(rounds)), key=lambda i: wait_of(rounds[i]))[:count]
    return [rounds[i] for i in sorted(chosen)]


def compare(ours, peers=None, seconds=2.0, rounds=40, clock=time.process_time):
    """Time `ours` and each peer in turn: ours, peer, ours, other peer, and again.

    peers: {name: callable that does the same work}
    seconds: when to stop, unless there are fewer than LEAST_ROUNDS yet
    clock: perf_counter for work that waits for a disk
    returns: median, least and greatest seconds of ours; of each peer the median, and how many times
             faster than it ours is (the median over the rounds)
    """
    peers = peers or {}
    pairs = {name: [] for name in peers} or {"": []}
    repeat = repeats_of(ours, clock)
    repeat_peer = {name: repeats_of(work, clock) for name, work in peers.items()}
    end = time.monotonic() + seconds
    for done in range(rounds):
        if done >= LEAST_ROUNDS and time.monotonic() > end:
            break
        for name, taken in pairs.items():
            mine, wait = seconds_of(ours, repeat, clock)
            other, wait_other = (seconds_of(peers[name], repeat_peer[name], clock) if name
                                 else (mine, 0))
            taken.append((mine, other, max(wait, wait_other)))

    used = {name: calmest(taken, lambda pair: pair[2]) for name, taken in pairs.items()}
    every = [pair for taken in used.values() for pair in taken]
    mine = [pair[0] for pair in every]
    return {
        "median": statistics.median(mine), "least": min(mine), "most": max(mine),
        "rounds": len(mine), "waited": statistics.median(pair[2] for pair in every),
        "peers": {name: {"median": statistics.median(pair[1] for pair in taken),
                         "speedup": statistics.median(pair[1] / pair[0] for pair in taken)}
                  for name, taken in used.items() if name},
    }


def exponent(sizes, values):
    """b of value = a * size^b, by least squares on logarithms."""
    x, y = ([math.log(v) for v in numbers] for numbers in (sizes, values))
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) /
            sum((a - mean_x) ** 2 for a in x))
