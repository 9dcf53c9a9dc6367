"""Natural order of names, times in names, and the time axis against plain Python: 10^5 cases.

    test_order_and_time.py ORDER_AND_TIME [SEED]
"""

import calendar
import random
import re
import subprocess
import sys
import time

CASES = 100_000
INT64 = range(-2**63, 2**63)
AUTO, US, NS, MS, S = range(5)
PER_US = {AUTO: 1, US: 1, MS: 1000, S: 10**6}


# ---- the rules, as docs and headers state them

def natural_key(name):
    """Runs of digits by value, everything else byte by byte, then all of it byte by byte."""
    parts = re.findall(rb"\d+|\D", name.encode())
    return [(int(part), b"") if part.isdigit() else (None, part) for part in parts], name.encode()


def before(a, b):
    (x, whole_x), (y, whole_y) = natural_key(a), natural_key(b)
    for (number_x, byte_x), (number_y, byte_y) in zip(x, y):
        if (number_x is None) != (number_y is None):
            # A digit against another byte: the first bytes decide.
            first_x = byte_x or b"%d" % 0
            first_y = byte_y or b"%d" % 0
            return (b"0" if number_x is not None else first_x) < (b"0" if number_y is not None else first_y)
        if number_x is not None and number_x != number_y:
            return number_x < number_y
        if number_x is None and byte_x != byte_y:
            return byte_x < byte_y
    return len(x) < len(y) if len(x) != len(y) else whole_x < whole_y


def ordered(names):
    """By insertion, from pairwise comparison alone."""
    result = []
    for name in names:
        place = len(result)
        while place > 0 and before(name, result[place - 1]):
            place -= 1
        result.insert(place, name)
    return result


def unit_of(stamps):
    if stamps[0] >= 10**17:
        return NS
    if stamps[0] >= 10**14:
        return US
    spacings = sorted([abs(b - a) for a, b in zip(stamps, stamps[1:]) if a != b][:8])
    if not spacings:
        return AUTO
    spacing = spacings[len(spacings) // 2]
    if spacing >= 500:
        return US
    if 10**12 <= stamps[0] < 4 * 10**12:
        return MS
    if 10**9 <= stamps[0] < 4 * 10**9:
        return S
    return S if spacing <= 2 else MS


def microseconds(unit, stamp):
    if unit == NS:
        return abs(stamp) // 1000 * (1 if stamp >= 0 else -1)
    return max(INT64[0], min(INT64[-1], stamp * PER_US[unit]))


def axis(unit, late_us, stamps):
    """The final unit, and what is said of each stamp with its microseconds."""
    told, distinct, count, newest, previous = [], [], 0, None, None
    for stamp in stamps:
        changed = False
        if unit == AUTO:
            if len(distinct) < 9 and (not distinct or distinct[-1] != stamp):
                distinct.append(stamp)
            unit = unit_of(distinct if count + 1 >= 9 else distinct[:1])
            changed = unit not in (AUTO, US)
        us = microseconds(unit, stamp)
        if newest is None or changed:
            told.append((0 if newest is None else 3, us))
            newest, previous, count = us, None, 1
        elif us >= newest:
            told.append((0, us))
            if us > newest:
                previous = newest
            newest, count = us, count + 1
        elif newest - us <= late_us or (previous is not None and us >= previous):
            told.append((1, us))
        else:
            told.append((2, us))
            newest, previous, count = us, None, 1
    return unit, told


def time_in_name(name):
    body = name[:name.rindex(".")]
    fields = body.split("@")[1:]
    if body.endswith("@"):
        fields = fields[:-1]
    text = fields[12] if len(fields) > 12 else ""
    if not re.fullmatch(r"\d{9,}", text):
        return text, None
    if len(text) == 14:
        year, month, day, hour, minute, second = (
            int(text[a:b]) for a, b in ((0, 4), (4, 6), (6, 8), (8, 10), (10, 12), (12, 14)))
        if year < 1970 or not 1 <= month <= 12 or not 1 <= day <= 31 or hour > 23 or minute > 59 or second > 60:
            return text, None
        return text, calendar.timegm((year, month, day, hour, minute, second)) * 10**6
    return text, int(text) if int(text) in INT64 else None


# ---- cases

def names(chance):
    pieces = ["0", "00", "1", "9", "10", "010", "2", "a", "B", "_", "-", ".", "frame_", "99999999999999999999",
              "é"]
    return ["".join(chance.choice(pieces) for _ in range(chance.randrange(1, 6)))
            for _ in range(chance.randrange(1, 8))]


def stamps(chance):
    """Stamps of a camera, in some unit, with swaps, steps, gaps and stand-stills."""
    unit = chance.choice([10**6, 10**9, 10**3, 1])
    begin = chance.choice([0, 17 * 10**8 * unit, 5 * unit, -3 * unit, 12345])
    period = chance.choice([1 / 30, 0.1, 1, 5, 0, 500 / unit, 499 / unit, 2 / unit])
    times = [begin + int(i * period * unit) for i in range(chance.randrange(1, 30))]
    for _ in range(chance.choice([0, 0, 1, 3])):
        i = chance.randrange(len(times))
        j = min(len(times) - 1, i + chance.choice([1, 1, 2, 9]))
        times[i], times[j] = times[j], times[i]
    for _ in range(chance.choice([0, 0, 1])):
        i, step = chance.randrange(len(times)), chance.choice([-30, 30, 1000, -2]) * unit
        times[i:] = [t + step for t in times[i:]]
    if chance.random() < 0.05:
        times = [chance.choice([INT64[0], INT64[-1], 0, 1, 10**14, 10**17]) for _ in times]
    return [max(INT64[0], min(INT64[-1], t)) for t in times]


def utm_name(chance):
    fields = [chance.choice(["", "5", "551187.03", "S", "10"]) for _ in range(12)]
    fields.append(chance.choice(["", "201611", "20240613000039", "20241399000039", "20240229235960", "1718236800",
                                 "1718236800123456", "99999999999999999999", "2024-06-13", "123"]))
    fields.append(chance.choice(["", "note"]))
    fields = fields[:chance.choice([2, 3, 12, 13, 14])]
    return "@" + "@".join(fields) + chance.choice(["@", "@", ""]) + chance.choice([".jpg", ".png"])


def case(seed):
    """A line for ORDER_AND_TIME, and the line that is right."""
    chance = random.Random(seed)
    kind = chance.randrange(3)
    if kind == 0:
        given = names(chance)
        return "order " + " ".join(given), " ".join(ordered(given)) + " "
    if kind == 1:
        unit, late_us, given = chance.choice([AUTO, AUTO, AUTO, US, NS, MS, S]), chance.choice([0, 50000, 10**6]), stamps(chance)
        final, told = axis(unit, late_us, given)
        return (f"time {unit} {late_us} " + " ".join(map(str, given)),
                f"{final}" + "".join(f" {what}:{us}" for what, us in told))
    given = utm_name(chance)
    text, stamp = time_in_name(given)
    return f"name {given}", f"{text} {'-' if stamp is None else stamp}"


def main():
    seeds = [int(sys.argv[2])] if len(sys.argv) > 2 else range(CASES)
    begin = time.monotonic()
    cases = [case(seed) for seed in seeds]
    done = subprocess.run([sys.argv[1]], input="".join(line + "\n" for line, _ in cases).encode(),
                          capture_output=True, check=True)
    answers = done.stdout.decode().split("\n")[:-1]
    assert len(answers) == len(cases), f"{len(answers)} answers to {len(cases)} cases"
    verdicts = set()
    for seed, (line, expected), found in zip(seeds, cases, answers):
        if found != expected:
            sys.exit(f"case {seed}, again with: {' '.join(sys.argv[:2])} {seed}\n{line}\n"
                     f"found    {found}\nexpected {expected}")
        if line.startswith("time"):
            verdicts |= {word[0] for word in found.split()[1:]}
    print(f"{len(cases)} cases in {time.monotonic() - begin:.0f} s")
    if len(cases) == CASES and verdicts != set("0123"):
        sys.exit(f"the stamps only led to the verdicts {sorted(verdicts)}: they try too little")


if __name__ == "__main__":
    main()
