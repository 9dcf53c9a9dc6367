"""The C library: its structs and functions as in lib/include/vdna, and its errors."""

from __future__ import annotations

import ctypes
import enum
import functools
import os
from ctypes import POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int32, c_int64
from ctypes import c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from typing import Any, Dict, Tuple


class Status(enum.IntEnum):
    """Result of a call of the C library."""

    OK = 0
    ARG = 1
    NOMEM = 2
    NONFINITE = 3
    FULL = 4
    EMPTY = 5
    MISMATCH = 6
    OVERFLOW = 7
    UNDERFLOW = 8
    IO = 9
    FORMAT = 10
    CHECKSUM = 11
    UNSUPPORTED = 12
    RUNTIME = 13
    LATE = 14


class VdnaError(Exception):
    """The library refused a call; `status` says why, str() says it in words."""

    def __init__(self, status: Status, text: str) -> None:
        super().__init__(status, text)
        self.status = status
        self.text = text

    def __str__(self) -> str:
        return self.text


class Error(Structure):
    _fields_ = [("text", c_char * 512)]


class Activations(Structure):
    _fields_ = [
        ("values", c_void_p),
        ("neurons", c_uint32),
        ("samples", c_uint32),
        ("layout", c_uint32),
    ]


class HistConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("neurons", c_uint32),
        ("bins", c_uint32),
        ("range", c_void_p),
    ]


class Hist(Structure):
    _fields_ = [
        ("range", c_void_p),
        ("counts", c_void_p),
        ("mass", c_void_p),
        ("saturated", c_void_p),
        ("neurons", c_uint32),
        ("bins", c_uint32),
        ("frames", c_uint32),
    ]


class HistView(Structure):
    _fields_ = [
        ("range", c_void_p),
        ("counts", c_void_p),
        ("mass", c_void_p),
        ("neurons", c_uint32),
        ("bins", c_uint32),
    ]


class RankPlace(Structure):
    _fields_ = [("distance_bins", c_double), ("candidate", c_uint32), ("tied", c_uint32)]


class KnnMatch(Structure):
    _fields_ = [("distance_sq", c_double), ("index", c_uint32), ("reserved", c_uint32)]


class LocaliseMapConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("frames", c_uint32),
        ("dim", c_uint32),
        ("centred", c_uint32),
        ("embeddings", c_void_p),
    ]


class GearFields(Structure):
    _fields_ = [("first", c_int32), ("reserved", c_uint32), ("share", c_double * 6)]


class LocaliseConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("tolerance", c_uint32),
        ("map", c_void_p),
        ("place", POINTER(c_int64)),
        ("gears", POINTER(GearFields)),
        ("gear_count", c_uint32),
        ("mean_frames", c_uint32),
        ("mean_frames_max", c_uint32),
        ("reserved", c_uint32),
        ("gate", c_double),
        ("sharpness", c_double),
        ("clutter", c_double),
        ("jump", c_double),
        ("gear_change", c_double),
        ("evidence_share", c_double),
        ("confidence", c_double * 4),
    ]


class LocaliseAnswer(Structure):
    _fields_ = [
        ("frame", c_uint32),
        ("nearest", c_uint32),
        ("moving", c_uint32),
        ("reserved", c_uint32),
        ("confidence", c_double),
        ("mass", c_double),
        ("nearest_distance", c_double),
    ]


class TrustRunFields(Structure):
    _fields_ = [
        ("embeddings", c_void_p),
        ("last_layer", c_void_p),
        ("last_layer_scale", c_void_p),
        ("place", c_void_p),
        ("position", c_void_p),
        ("codes", c_void_p),
        ("frames", c_uint32),
        ("dim", c_uint32),
        ("last_layer_dim", c_uint32),
        ("reserved", c_uint32),
    ]


class TrustCell(Structure):
    _fields_ = [
        ("nearest", c_double * 7),
        ("likeness", c_double * 7),
        ("recall", c_double * 7),
        ("distance", c_double * 7),
    ]


class TrustTablesFields(Structure):
    _fields_ = [
        ("frames", c_void_p),
        ("own_scale", c_void_p),
        ("correlation", c_void_p),
        ("cells", c_void_p),
    ]


class MapTrustFields(Structure):
    _fields_ = [
        ("tables", TrustTablesFields),
        ("tolerance", c_double),
        ("runs", c_uint32),
        ("localiser", c_uint32),
        ("memory", c_void_p),
    ]


class TrustConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("runs", c_uint32),
        ("tables", POINTER(TrustTablesFields)),
        ("localiser", c_uint32),
        ("reserved", c_uint32),
        ("min_recall", c_double),
        ("switch_cost", c_double),
    ]


class TrustPredictionFields(Structure):
    _fields_ = [
        ("recall", c_double),
        ("low", c_double),
        ("high", c_double),
        ("transfer", c_double),
        ("nearest", c_double),
        ("score", c_double),
        ("reason", c_uint32),
        ("reserved", c_uint32),
    ]


class TrustAnswerFields(Structure):
    _fields_ = [
        ("verdict", c_uint32),
        ("frames", c_uint32),
        ("choice", c_uint32),
        ("settled_frames", c_uint32),
        ("unlike", c_double),
    ]


class TrustFitFields(Structure):
    _fields_ = [
        ("labelled", c_uint32),
        ("by_likeness", c_uint32),
        ("skill", c_double),
        ("slope", c_double),
        ("sd", c_double),
        ("sd_best", c_double),
        ("quantile", c_double),
        ("far", c_double),
        ("correlation", c_double),
    ]


class SelectCandidate(Structure):
    _fields_ = [
        ("dna", HistView),
        ("embeddings", c_void_p),
        ("frames", c_uint32),
        ("reserved", c_uint32),
    ]


class SelectConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("candidate_count", c_uint32),
        ("candidates", POINTER(SelectCandidate)),
        ("dim", c_uint32),
        ("warmup_frames", c_uint32),
        ("warmup_us", c_int64),
        ("late_us", c_int64),
        ("warmup_frames_min", c_uint32),
        ("time_unit", c_uint32),
        ("localisers", POINTER(c_void_p)),
        ("top", c_uint32),
        ("rank", c_uint32),
        ("trust", c_void_p),
        ("runs", POINTER(TrustRunFields)),
        ("stop_early", c_uint32),
        ("reselect", c_uint32),
        ("exact", c_uint32),
        ("reserved", c_uint32),
    ]


class SelectPosition(Structure):
    _fields_ = [("candidate", c_uint32), ("reserved", c_uint32), ("answer", LocaliseAnswer)]


class CameraTime(Structure):
    _fields_ = [
        ("distinct", c_int64 * 9),
        ("late_us", c_int64),
        ("newest_us", c_int64),
        ("before_us", c_int64),
        ("frames", c_uint64),
        ("still", c_uint64),
        ("late", c_uint64),
        ("backwards", c_uint64),
        ("unit", c_uint32),
        ("distinct_count", c_uint32),
    ]


class SelectFrame(Structure):
    _fields_ = [
        ("utime", c_int64),
        ("taps", POINTER(Activations)),
        ("tap_count", c_size_t),
        ("embedding", c_void_p),
    ]


class SelectAnswer(Structure):
    _fields_ = [
        ("state", c_uint32),
        ("newly_ranked", c_uint32),
        ("restarted", c_uint32),
        ("localised", c_uint32),
        ("match", KnnMatch),
    ]


class IdentityFields(Structure):
    _fields_ = [
        ("backbone", c_char * 64),
        ("model_sha256", c_char * 65),
        ("preprocessing", c_char * 512),
        ("precision", c_char * 16),
        ("taps", c_char * 2048),
        ("neurons", c_uint32),
        ("dim", c_uint32),
        ("bins", c_uint32),
        ("range", c_void_p),
        ("embedding", c_char * 256),
        ("projection", c_void_p),
        ("raw_dim", c_uint32),
        ("reserved", c_uint32),
    ]


class TapFields(Structure):
    _fields_ = [
        ("name", c_void_p),
        ("name_length", c_size_t),
        ("neurons", c_uint32),
        ("samples", c_uint32),
    ]


class ExperienceFile(Structure):
    _fields_ = [
        ("name", c_char * 64),
        ("identity", IdentityFields),
        ("comparable", c_char * 65),
        ("frames", c_uint32),
        ("counts", c_void_p),
        ("mass", c_void_p),
        ("embeddings", c_void_p),
        ("frame_utime", c_void_p),
        ("frame_place", c_void_p),
        ("frame_position", c_void_p),
        ("frame_grey", c_void_p),
        ("file_bytes", c_void_p),
        ("file_size", c_size_t),
        ("position_frame", c_char * 64),
        ("order", c_char * 32),
        ("last_layer", c_void_p),
        ("last_layer_scale", c_void_p),
        ("last_layer_dim", c_uint32),
        ("checksum", c_uint32),
        ("embedding_codes", c_void_p),
        ("embedding_scale", c_void_p),
        ("thumbnails", c_void_p),
        ("thumbnail_end", c_void_p),
        ("thumbnail_bytes", c_uint32),
        ("source", c_char * 128),
    ]


class Image(Structure):
    _fields_ = [
        ("data", c_void_p),
        ("size", c_size_t),
        ("width", c_uint32),
        ("height", c_uint32),
        ("row_stride", c_uint32),
        ("pixelformat", c_uint32),
    ]


class BackboneConfig(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("threads", c_uint32),
        ("max_pixels", c_uint32),
        ("reserved", c_uint32),
        ("manifest", c_char_p),
        ("runtime", c_char_p),
    ]


class BackboneFields(Structure):
    _fields_ = [
        ("identity", IdentityFields),
        ("quantised_from", c_char * 65),
        ("runtime", c_char * 64),
        ("tap_count", c_uint32),
        ("input_width", c_uint32),
        ("input_height", c_uint32),
        ("decode_bytes", c_uint64),
        ("last_layer_dim", c_uint32),
        ("embedding_int8", c_uint32),
        ("embedding_dims", c_uint32),
        ("reserved", c_uint32),
    ]


class HealthPicture(Structure):
    _fields_ = [
        ("hash", c_uint64),
        ("width", c_uint32),
        ("height", c_uint32),
        ("mean", c_uint32),
        ("contrast", c_uint32),
        ("structure", c_uint32),
        ("grain", c_uint32),
        ("bright", c_uint32),
        ("reserved", c_uint32),
    ]


class BackboneOutput(Structure):
    _fields_ = [
        ("taps", POINTER(Activations)),
        ("embedding", c_void_p),
        ("input", c_void_p),
        ("tap_count", c_size_t),
        ("dim", c_uint32),
        ("grey", c_float),
        ("decode_us", c_uint32),
        ("resize_us", c_uint32),
        ("inference_us", c_uint32),
        ("last_layer_dim", c_uint32),
        ("last_layer", c_void_p),
        ("health", HealthPicture),
    ]


def _raise_refusal(status: int, function: Any, arguments: Any) -> None:
    if status == Status.OK:
        return
    errors = [argument for argument in arguments if isinstance(argument, Error)]
    if errors:
        text = errors[0].text.decode("utf-8", "replace")
    else:
        text = f"{function.__name__}: {lib.vdna_status_text(status).decode()}"
    raise VdnaError(Status(status), text)


def _declare(library: ctypes.CDLL) -> ctypes.CDLL:
    """Give the functions their types: those that may fail, then those that answer directly.

    An object with private state, such as a selector, is an address.
    """
    path, address, size = c_char_p, c_void_p, c_size_t
    taps = (POINTER(Activations), size)
    may_fail: Dict[str, Tuple[Any, ...]] = {
        "vdna_range_check": (address, c_uint32),
        "vdna_range_clear": (address, c_uint32),
        "vdna_range_observe": (address, c_uint32, *taps),
        "vdna_range_expand": (address, c_uint32, c_float, c_uint32),
        "vdna_hist_init": (POINTER(HistConfig), address, size, POINTER(Hist)),
        "vdna_hist_add": (POINTER(Hist), *taps),
        "vdna_hist_merge": (POINTER(Hist), POINTER(Hist)),
        "vdna_hist_subtract": (POINTER(Hist), POINTER(Hist)),
        "vdna_emd": (POINTER(HistView), POINTER(HistView), address, size, address),
        "vdna_emd_mean": (POINTER(HistView), POINTER(HistView), address, size, POINTER(c_double)),
        "vdna_emd_block": (
            POINTER(HistView),
            c_uint32,
            POINTER(HistView),
            c_uint32,
            address,
            size,
            address,
        ),
        "vdna_rank": (
            POINTER(HistView),
            POINTER(HistView),
            c_uint32,
            address,
            size,
            POINTER(RankPlace),
        ),
        "vdna_bounds_sum": (POINTER(HistView), address, size, address),
        "vdna_bounds_mean": (
            POINTER(HistView),
            address,
            POINTER(HistView),
            address,
            address,
            size,
            POINTER(c_double),
        ),
        "vdna_bounds_from_sums": (
            address,
            address,
            address,
            address,
            c_uint32,
            c_uint32,
            address,
            size,
            POINTER(c_double),
        ),
        "vdna_rank_top": (
            POINTER(HistView),
            POINTER(HistView),
            address,
            c_uint32,
            c_uint32,
            address,
            size,
            POINTER(RankPlace),
            POINTER(c_uint8),
        ),
        "vdna_knn": (address, c_uint32, address, c_uint32, c_uint32, address),
        "vdna_knn_encode": (address, c_uint32, c_uint32, address, size),
        "vdna_knn_nearest": (address, c_uint32, address, c_uint32, address, address),
        "vdna_experience_localise_config": (
            POINTER(ExperienceFile),
            c_double,
            address,
            POINTER(LocaliseConfig),
        ),
        "vdna_localise_map_init": (POINTER(LocaliseMapConfig), address, size, POINTER(c_void_p)),
        "vdna_localise_init": (POINTER(LocaliseConfig), address, size, POINTER(c_void_p)),
        "vdna_localise_warm_up": (address, address),
        "vdna_localise_feed": (address, address, POINTER(LocaliseAnswer)),
        "vdna_localise_feed_distances": (address, address, POINTER(LocaliseAnswer)),
        "vdna_trust_nearest": (
            address,
            address,
            c_uint32,
            c_uint32,
            POINTER(c_double),
            POINTER(c_uint32),
        ),
        "vdna_trust_nearest_int8": (
            address,
            c_float,
            address,
            address,
            c_uint32,
            c_uint32,
            POINTER(c_double),
        ),
        "vdna_trust_own_scale": (POINTER(TrustRunFields), c_double, POINTER(c_double)),
        "vdna_trust_pair": (
            POINTER(TrustRunFields),
            POINTER(TrustRunFields),
            c_double,
            c_uint32,
            address,
            size,
            address,
            POINTER(TrustCell),
        ),
        "vdna_trust_correlation_time": (address, c_uint32, c_uint32, address, POINTER(c_double)),
        "vdna_trust_init": (POINTER(TrustConfig), address, size, POINTER(c_void_p)),
        "vdna_trust_feed": (address, address, address),
        "vdna_trust_predict": (
            address,
            address,
            POINTER(TrustPredictionFields),
            POINTER(TrustAnswerFields),
        ),
        "vdna_trust_choose": (address, c_uint32),
        "vdna_trust_expect": (address, address, address),
        "vdna_trust_suit": (address, address, address, address),
        "vdna_trust_reconsider": (address, address, c_uint32, POINTER(c_uint32)),
        "vdna_select_init": (POINTER(SelectConfig), address, size, POINTER(c_void_p)),
        "vdna_select_feed_seen": (address, POINTER(SelectFrame), address, POINTER(SelectAnswer)),
        "vdna_identity_check": (POINTER(IdentityFields), POINTER(Error)),
        "vdna_identity_compare": (
            POINTER(IdentityFields),
            POINTER(IdentityFields),
            POINTER(Error),
        ),
        "vdna_identity_text": (POINTER(IdentityFields), address),
        "vdna_identity_hash": (POINTER(IdentityFields), address),
        "vdna_identity_project": (POINTER(IdentityFields), address, address),
        "vdna_int8_encode": (address, size, address, address),
        "vdna_taps_append": (address, size, POINTER(TapFields)),
        "vdna_experience_open": (path, POINTER(Error), POINTER(ExperienceFile)),
        "vdna_experience_open_memory": (c_void_p, c_size_t, POINTER(Error), POINTER(ExperienceFile)),
        "vdna_experience_write": (POINTER(ExperienceFile), path, POINTER(Error)),
        "vdna_experience_compare": (
            POINTER(ExperienceFile),
            POINTER(ExperienceFile),
            POINTER(Error),
        ),
        "vdna_experience_thumbnail": (
            POINTER(ExperienceFile),
            c_uint32,
            POINTER(c_void_p),
            POINTER(c_size_t),
        ),
        "vdna_map_count": (path, POINTER(Error), POINTER(c_uint32)),
        "vdna_map_open": (
            path,
            c_uint32,
            POINTER(Error),
            POINTER(ExperienceFile),
            POINTER(c_uint32),
        ),
        "vdna_map_trust_open": (
            path,
            POINTER(ExperienceFile),
            c_uint32,
            POINTER(Error),
            POINTER(MapTrustFields),
        ),
        "vdna_map_trust_write": (
            path,
            POINTER(ExperienceFile),
            POINTER(MapTrustFields),
            POINTER(Error),
        ),
    }
    direct: Dict[str, Tuple[Any, Tuple[Any, ...]]] = {
        "vdna_version": (c_char_p, ()),
        "vdna_status_text": (c_char_p, (c_int32,)),
        "vdna_hist_config_init": (None, (POINTER(HistConfig),)),
        "vdna_hist_mem_size": (size, (POINTER(HistConfig),)),
        "vdna_hist_reset": (None, (POINTER(Hist),)),
        "vdna_hist_view_of": (None, (POINTER(Hist), POINTER(HistView))),
        "vdna_emd_scratch_size": (size, (c_uint32,)),
        "vdna_emd_block_scratch_size": (size, (c_uint32,)),
        "vdna_bounds_size": (size, (c_uint32, c_uint32)),
        "vdna_rank_top_scratch_size": (size, (c_uint32, c_uint32)),
        "vdna_localise_map_config_init": (None, (POINTER(LocaliseMapConfig),)),
        "vdna_localise_map_mem_size": (size, (POINTER(LocaliseMapConfig),)),
        "vdna_localise_map_step": (c_double, (address,)),
        "vdna_localise_config_init": (None, (POINTER(LocaliseConfig),)),
        "vdna_localise_mem_size": (size, (POINTER(LocaliseConfig),)),
        "vdna_localise_reset": (None, (address,)),
        "vdna_localise_frames": (c_uint32, (address,)),
        "vdna_localise_dim": (c_uint32, (address,)),
        "vdna_localise_distances": (address, (address,)),
        "vdna_localise_posterior": (None, (address, address)),
        "vdna_localise_mean": (address, (address,)),
        "vdna_localise_evidence": (c_double, (address,)),
        "vdna_localise_jumps": (c_uint32, (address,)),
        "vdna_trust_windows": (c_uint32, (c_uint32, address, POINTER(c_uint32))),
        "vdna_trust_pair_scratch_size": (size, (POINTER(TrustRunFields), POINTER(TrustRunFields))),
        "vdna_trust_config_init": (None, (POINTER(TrustConfig),)),
        "vdna_trust_mem_size": (size, (POINTER(TrustConfig),)),
        "vdna_trust_reset": (None, (address,)),
        "vdna_knn_codes_size": (size, (c_uint32, c_uint32)),
        "vdna_trust_settled_frames": (c_uint32, (address,)),
        "vdna_trust_fitted": (POINTER(TrustFitFields), (address,)),
        "vdna_trust_intercepts": (address, (address,)),
        "vdna_trust_reason_text": (c_char_p, (c_uint32,)),
        "vdna_map_trust_close": (None, (POINTER(MapTrustFields),)),
        "vdna_select_config_init_sized": (None, (POINTER(SelectConfig), size)),
        "vdna_select_mem_size": (size, (POINTER(SelectConfig),)),
        "vdna_select_reset": (None, (address,)),
        "vdna_select_state": (c_uint32, (address,)),
        "vdna_select_progress": (c_double, (address,)),
        "vdna_select_chosen": (c_uint32, (address,)),
        "vdna_select_margin_bins": (c_double, (address,)),
        "vdna_select_where": (POINTER(SelectPosition), (address,)),
        "vdna_select_is_bound": (c_uint32, (address, c_uint32)),
        "vdna_select_ranking": (POINTER(RankPlace), (address, POINTER(c_uint32))),
        "vdna_select_ranked_by": (c_uint32, (address,)),
        "vdna_select_trust": (POINTER(TrustAnswerFields), (address,)),
        "vdna_select_predictions": (POINTER(TrustPredictionFields), (address, POINTER(c_uint32))),
        "vdna_select_switches": (c_uint64, (address,)),
        "vdna_select_previous": (c_uint32, (address,)),
        "vdna_select_live": (None, (address, POINTER(HistView))),
        "vdna_select_window_frames": (c_uint32, (address,)),
        "vdna_select_first_utime": (c_int64, (address,)),
        "vdna_select_last_utime": (c_int64, (address,)),
        "vdna_select_accepted": (c_uint64, (address,)),
        "vdna_select_rejected": (c_uint64, (address,)),
        "vdna_select_restarts": (c_uint64, (address,)),
        "vdna_select_time": (POINTER(CameraTime), (address,)),
        "vdna_identity_precision": (c_char_p, (POINTER(IdentityFields),)),
        "vdna_identity_is_centred": (c_int32, (POINTER(IdentityFields),)),
        # Its refusals are the end of a list.
        "vdna_taps_next": (c_int32, (POINTER(c_void_p), POINTER(TapFields))),
        "vdna_name_replace": (None, (address,)),
        "vdna_experience_close": (None, (POINTER(ExperienceFile),)),
        "vdna_experience_view": (None, (POINTER(ExperienceFile), POINTER(HistView))),
    }
    return _typed(library, may_fail, direct)


def _typed(
    library: ctypes.CDLL,
    may_fail: Dict[str, Tuple[Any, ...]],
    direct: Dict[str, Tuple[Any, Tuple[Any, ...]]],
) -> ctypes.CDLL:
    for name, arguments in may_fail.items():
        function = getattr(library, name)
        function.restype, function.argtypes = c_int32, arguments
        function.errcheck = _raise_refusal
    for name, (result, arguments) in direct.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def _path_of(name: str) -> str:
    return os.path.join(os.path.dirname(os.path.abspath(__file__)), name)


lib = _declare(ctypes.CDLL(_path_of("libvdna.so")))


@functools.lru_cache(maxsize=None)
def backbone_lib() -> ctypes.CDLL:
    """The library that runs networks, which not every wheel has."""
    path = _path_of("libvdna_backbone.so")
    if not os.path.exists(path):
        raise VdnaError(
            Status.UNSUPPORTED,
            f"{path}: is not there: this wheel was built without libjpeg, toml++ or ONNX Runtime's"
            " header; build it again where they are (on Debian, ./dev setup gets them)",
        )
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise VdnaError(
            Status.UNSUPPORTED,
            f"{path}: cannot be loaded: {error}; install what it names (on Debian, libjpeg62-turbo)",
        ) from None
    return _typed(
        library,
        {
            "vdna_backbone_open": (POINTER(BackboneConfig), POINTER(Error), POINTER(c_void_p)),
            "vdna_backbone_run": (
                c_void_p,
                POINTER(Image),
                POINTER(Error),
                POINTER(BackboneOutput),
            ),
        },
        {
            "vdna_backbone_config_init": (None, (POINTER(BackboneConfig),)),
            "vdna_backbone_describe": (None, (c_void_p, POINTER(BackboneFields))),
            "vdna_backbone_cancel": (None, (c_void_p,)),
            "vdna_backbone_close": (None, (c_void_p,)),
        },
    )


def version() -> str:
    """MAJOR.MINOR.PATCH of the C library inside this package."""
    text: bytes = lib.vdna_version()
    return text.decode()
