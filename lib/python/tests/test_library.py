"""What the package says of C agrees with C; errors carry status and text; the wheel is complete."""

import ctypes
import importlib.metadata
import os
import pathlib
import pickle
import re
import subprocess

import pytest

import libvdna
from libvdna import _library

PACKAGE = pathlib.Path(libvdna.__file__).parent
HAS_BACKBONE = (PACKAGE / "libvdna_backbone.so").exists()
ROOT = pathlib.Path(__file__).resolve().parents[3]

STRUCTS = {
    "vdna_error": _library.Error,
    "vdna_activations": _library.Activations,
    "vdna_hist_config": _library.HistConfig,
    "vdna_hist": _library.Hist,
    "vdna_hist_view": _library.HistView,
    "vdna_rank_entry": _library.RankPlace,
    "vdna_knn_match": _library.KnnMatch,
    "vdna_localise_map_config": _library.LocaliseMapConfig,
    "vdna_gear": _library.GearFields,
    "vdna_localise_config": _library.LocaliseConfig,
    "vdna_localise_answer": _library.LocaliseAnswer,
    "vdna_trust_run": _library.TrustRunFields,
    "vdna_trust_cell": _library.TrustCell,
    "vdna_trust_tables": _library.TrustTablesFields,
    "vdna_map_trust": _library.MapTrustFields,
    "vdna_trust_config": _library.TrustConfig,
    "vdna_trust_prediction": _library.TrustPredictionFields,
    "vdna_trust_answer": _library.TrustAnswerFields,
    "vdna_trust_fit": _library.TrustFitFields,
    "vdna_select_candidate": _library.SelectCandidate,
    "vdna_select_config": _library.SelectConfig,
    "vdna_select_position": _library.SelectPosition,
    "vdna_select_frame": _library.SelectFrame,
    "vdna_select_answer": _library.SelectAnswer,
    "vdna_identity": _library.IdentityFields,
    "vdna_tap": _library.TapFields,
    "vdna_experience": _library.ExperienceFile,
    "vdna_image": _library.Image,
    "vdna_backbone_config": _library.BackboneConfig,
    "vdna_backbone_info": _library.BackboneFields,
    "vdna_backbone_frame": _library.BackboneOutput,
}


def layout_of(struct):
    yield "", 0, ctypes.sizeof(struct)
    for name, _ in struct._fields_:
        yield name, getattr(struct, name).offset, getattr(struct, name).size


def test_structs_lie_in_memory_as_the_c_compiler_lays_them():
    program = os.environ.get("LIBVDNA_STRUCTS")
    if program is None:
        pytest.skip("LIBVDNA_STRUCTS, the program made from test/contract/language/structs.c, is not set")
    output = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    ours = {
        f"{name}.{field}": (offset, size)
        for name, struct in STRUCTS.items()
        for field, offset, size in layout_of(struct)
    }
    theirs = {
        name: (int(offset), int(size))
        for name, offset, size in (line.split() for line in output.splitlines())
    }
    assert ours == theirs


def test_status_codes_are_those_of_the_header():
    header = (ROOT / "lib/include/vdna/status.h").read_text()
    codes = {name: int(code) for name, code in re.findall(r"VDNA_(?:ERR_)?(\w+) = (\d+)", header)}
    assert codes == {status.name: status.value for status in libvdna.Status}


def test_an_error_says_the_status_and_the_text_of_the_library():
    with pytest.raises(libvdna.VdnaError) as caught:
        libvdna.Histogram([[1, 1]])
    assert caught.value.status is libvdna.Status.ARG
    assert str(caught.value) == "vdna_range_check: invalid argument"


def test_an_error_says_the_sentence_of_the_library_where_it_has_one(tmp_path):
    with pytest.raises(libvdna.VdnaError, match=r"nowhere\.vdna: cannot open") as caught:
        libvdna.Experience.open(tmp_path / "nowhere.vdna")
    assert caught.value.status is libvdna.Status.IO


def test_an_error_survives_the_way_between_processes():
    error = libvdna.VdnaError(libvdna.Status.FULL, "no more")
    again = pickle.loads(pickle.dumps(error))
    assert (again.status, str(again)) == (libvdna.Status.FULL, "no more")


def test_the_version_is_that_of_the_project():
    project = (ROOT / "CMakeLists.txt").read_text()
    assert f"project(vdna VERSION {libvdna.__version__} " in project


def needed_and_shown_by(library):
    path = str(PACKAGE / library)
    dynamic = subprocess.run(["readelf", "-dW", path], capture_output=True, text=True).stdout
    symbols = subprocess.run(["nm", "-D", "--defined-only", path], capture_output=True, text=True)
    names = [line.split()[-1] for line in symbols.stdout.splitlines()]
    return re.findall(r"NEEDED.*\[(.*)\]", dynamic), names


def test_the_library_needs_libc_and_libm_only_and_shows_its_own_symbols_only():
    needed, names = needed_and_shown_by("libvdna.so")
    assert set(needed) == {"libc.so.6", "libm.so.6"}
    assert len(names) > 30
    assert [name for name in names if not name.startswith("vdna_")] == []


@pytest.mark.skipif(not HAS_BACKBONE, reason="the wheel was built without networks")
def test_the_library_of_networks_needs_libc_and_libjpeg_at_most_and_shows_its_own_symbols_only():
    needed, names = needed_and_shown_by("libvdna_backbone.so")
    allowed = {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
    assert [name for name in needed if name not in allowed and "libjpeg" not in name] == []
    assert len(names) > 10
    assert [name for name in names if not name.startswith(("vdna_", "VDNA_BACKBONE_0"))] == []


def test_the_wheel_has_its_library_types_and_licence_and_nothing_else():
    files = importlib.metadata.files("libvdna")
    folders = {file.parts[0] for file in files}
    # vdna-mcap and vdna-fleet are in the environment's folder of programs; auditwheel adds libjpeg.
    own = {"..", "libvdna", f"libvdna-{libvdna.__version__}.dist-info"}
    assert folders - {"libvdna.libs"} == own
    others = {
        file.name
        for file in files
        if file.parts[0] == "libvdna" and not file.suffix.startswith((".py", ".lcm"))
    }
    # Licences of others are there where Debian's packages of them are.
    others = {name for name in others if not name.startswith("LICENSE.")}
    assert others - {"libvdna_backbone.so"} == {"LICENSE", "libvdna.so", "py.typed"}
