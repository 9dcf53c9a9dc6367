"""Which recorded experience should a robot localise against now?

The C library libvdna for NumPy: activation histograms ("Visual DNA"), the exact Earth Mover's
Distance, ranking, nearest neighbours, the selector, the localiser, trust in the choice, experience files,
what makes two of them comparable, and the networks of the robot.

Memory. Arrays go in without a copy when they have the stated dtype and are C-contiguous, and are
converted otherwise. Arrays that come out are read-only views of the library's memory, which stays
as long as one of them does; those of a histogram follow its changes.

Errors. What the library refuses raises VdnaError, with its status and its text. What does not fit
before it is asked (a shape, a dtype, an integer out of range) raises ValueError or TypeError. After
either, the object is as it was.

Threads. Different objects may be used from different threads; one object by one thread at a time.
The library runs without the interpreter lock.

Units. Distances of histograms are in bins; times are integers of microseconds.
"""

from ._library import Status, VdnaError, version
from .activations import FeatureMap
from .backbone import Backbone, BackboneFrame, BackboneInfo, NamedTap
from .distance import (
    RankEntry,
    bound_from_sums,
    bound_sums,
    emd,
    emd_block,
    emd_bound,
    emd_mean,
    rank,
    rank_top,
)
from .experience import PLACE_NONE, Experience, open_map
from .histogram import Histogram, HistogramView
from .identity import Identity, TapShape, clean_name, format_taps, parse_taps
from .localiser import Gear, Localiser, Place
from .neighbours import Neighbours, nearest
from .ranges import Ranges
from .reference import ReferenceVdna
from .selector import Answer, Candidate, Match, Selector
from .trust import TRUST_CELL, TRUST_WINDOWS, MapTrust, Prediction, StoredRun, Trust, TrustAnswer
from .trust import TrustFit, TrustTables, Verdict, trust_recall, trust_tables, trust_windows

__version__ = version()

__all__ = [
    "Answer",
    "Backbone",
    "BackboneFrame",
    "BackboneInfo",
    "Candidate",
    "Experience",
    "FeatureMap",
    "Gear",
    "Histogram",
    "HistogramView",
    "Identity",
    "Localiser",
    "MapTrust",
    "Match",
    "NamedTap",
    "Neighbours",
    "PLACE_NONE",
    "Place",
    "Prediction",
    "RankEntry",
    "Ranges",
    "ReferenceVdna",
    "Selector",
    "Status",
    "StoredRun",
    "TRUST_CELL",
    "TRUST_WINDOWS",
    "TapShape",
    "Trust",
    "TrustAnswer",
    "TrustFit",
    "TrustTables",
    "VdnaError",
    "Verdict",
    "bound_from_sums",
    "bound_sums",
    "clean_name",
    "emd",
    "emd_block",
    "emd_bound",
    "emd_mean",
    "format_taps",
    "nearest",
    "open_map",
    "parse_taps",
    "rank",
    "rank_top",
    "trust_recall",
    "trust_tables",
    "trust_windows",
]
