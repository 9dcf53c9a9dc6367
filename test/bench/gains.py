"""docs/gains.svg, a picture of the README: time to the choice, memory and size of the installation
beside others, from the measurements."""
from figures import find
from plot import COLOURS, OTHERS, shown, text

NETWORK = "efficientnet_lite0"
WIDTH, HEIGHT, MARGIN, GAP = 860, 330, 24, 34
COLUMN = (WIDTH - 2 * MARGIN - 2 * GAP) / 3
MUTED = 'fill="#5b6570"'
NAMES = {"ONNX Runtime alone": "ONNX Runtime alone, without choosing",
         "vdna package": "reference package, PyTorch"}


def write(stored, docs):
    """The picture, if all of it was measured."""
    columns = [time_column(stored), size_column(stored, "memory", "of memory at its peak"),
               size_column(stored, "installed", "installed, network included")]
    if all(columns):
        machine = stored["machine"]
        more = find(stored, "drive", f"decision {NETWORK} fp32")["more"]
        (docs / "gains.svg").write_text(
            drawn(columns, f"Default network, JPEG pictures, {machine['cores']} cores of "
                           f"{machine['cpu']}. The early choice is as good as that of 100 frames in "
                           f"{shown(more['as_good_percent'])} % of {more['drives']:.0f} drives."),
            encoding="utf-8")


def time_column(stored):
    """(number, what it is, unit, [(name, value, is ours)])"""
    drive = find(stored, "drive", f"drive {NETWORK} fp32")
    settled = {precision: find(stored, "drive", f"decision {NETWORK} {precision}")
               for precision in ("fp32", "int8")}
    if not drive or not all(settled.values()):
        return None
    more = settled["fp32"]["more"]
    [whole] = settled["fp32"]["peers"].values()
    rows = [("vdna, int8 network", settled["int8"]["median"], True),
            ("vdna", settled["fp32"]["median"], True),
            ("vdna, all 100 frames as in the paper", whole["median"], True)]
    rows += [(NAMES[peer.partition(",")[0]].replace("without choosing", "100 frames")
              .replace("PyTorch", "100 frames"), numbers["median"], False)
             for peer, numbers in drive["peers"].items()]
    return (f"{shown(settled['fp32']['median'])} s",
            f"of computing to the choice, {more['frames']:.0f} frames", "s", rows)


def size_column(stored, name, what):
    result = find(stored, "footprint", f"{name}, {NETWORK}")
    if not result:
        return None
    rows = [("vdna", result["median"], True)]
    rows += [(NAMES[peer], numbers["median"], False) for peer, numbers in result["peers"].items()]
    return f"{shown(result['median'])} MiB", what, "MiB", rows


def drawn(columns, caption):
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="13" '
            'fill="#1f2328">\n<rect width="100%" height="100%" rx="8" fill="#fff"/>')
    parts = [head]
    for index, column in enumerate(columns):
        parts += column_parts(MARGIN + index * (COLUMN + GAP), *column)
    parts.append(text(MARGIN, HEIGHT - 16, caption, more=f'font-size="11" {MUTED}'))
    return "\n".join([*parts, "</svg>\n"])


def column_parts(x, number, what, unit, rows):
    """A number to see first, what it is, and a bar for each program."""
    parts = [text(x, 48, number, more=f'font-size="32" font-weight="bold" fill="{COLOURS[0]}"'),
             text(x, 70, what, more=MUTED)]
    y, longest = 100, max(value for _, value, _ in rows)
    for name, value, is_ours in rows:
        length = max(2, (COLUMN - 72) * value / longest)
        parts += [text(x, y, name, more='font-size="12"'),
                  f'<rect x="{x:.1f}" y="{y + 5}" width="{length:.1f}" height="12" rx="2" '
                  f'fill="{COLOURS[0] if is_ours else OTHERS}"/>',
                  text(x + length + 6, y + 15.5, f"{shown(value)} {unit}", more='font-size="12"')]
        y += 40
    return parts
