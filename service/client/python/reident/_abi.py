"""The C interface (reident/client.h) for ctypes: structures, constants, prototypes."""

import ctypes
import enum
from ctypes import (CFUNCTYPE, POINTER, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t,
                    c_uint32, c_uint64, c_void_p)

from ._location import LIBRARY

BAD_ARGUMENT, UNAVAILABLE = -1, -2


class EventKind(enum.IntEnum):
    AVAILABLE = 1  # a verified version; runners whose signals it has change to it
    SWAPPED = 2  # a runner made its first step on the version
    REFUSED = 3  # the version must not run; the one before goes on
    OFFERED = 4  # its signals differ from those that run: Runner.accept() takes it
    CACHE = 5  # the file of last good versions could not be read or written
    FAULT = 6  # the middleware would not; the runs go on
    UNPUBLISHED = 7  # none was published within 5 s after a runner was opened


class Flags(enum.IntFlag):
    """What a step says; 0 where all is well."""

    NO_MODEL = 1  # no version yet: the outputs are NaN
    SWAPPED = 2  # the first step on another version
    IN_TRANSITION = 4  # the output still moves over from the version before
    INPUT_MISSING = 8  # an input was not finite: its last value is used
    INPUT_OUTSIDE = 16  # an input was outside the range that the model was identified in
    NOT_FOLLOWING = 32  # follow() ran free: the version has no gain, or a measured one is missing
    DIVERGED = 64  # not finite: the run started over at the operating point


class Options(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("simulator", c_char_p), ("domain", c_uint32),
                ("partition", c_char_p), ("spacecraft", c_char_p),
                ("equipment", POINTER(c_char_p)), ("equipment_count", c_size_t),
                ("cache_folder", c_char_p), ("security_folder", c_char_p)]


class Event(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("kind", c_int32), ("from_cache", c_int32),
                ("spacecraft", c_char_p), ("equipment", c_char_p), ("text", c_char_p),
                ("version", c_int64), ("time_ns", c_int64), ("decided_ns", c_int64),
                ("published_ns", c_int64), ("remaining_step", c_double),
                ("transition_steps", c_int32), ("matched_rows", c_int32)]


class HistoryQuery(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("subject", c_char_p), ("spacecraft", c_char_p),
                ("equipment", c_char_p), ("begin_ns", c_int64), ("end_ns", c_int64),
                ("version", c_int64), ("page_size", c_uint32), ("newest_first", c_int32),
                ("simulated", c_int32), ("parameter", c_uint32)]


class Signal(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p)]


class RunnerState(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("version", c_int64), ("offered_version", c_int64),
                ("decided_ns", c_int64), ("age_ns", c_int64), ("swapped_ns", c_int64),
                ("following", c_int32), ("from_cache", c_int32), ("sample_period_s", c_double),
                ("running_mrse_percent", c_double), ("steps", c_uint64),
                ("steps_outside", c_uint64), ("steps_missing", c_uint64),
                ("remaining_step", c_double), ("transition_steps", c_int32),
                ("transition_left", c_int32)]


HistoryRow = CFUNCTYPE(None, c_char_p, c_void_p)

_VECTOR = POINTER(c_double)
_PROTOTYPES = {  # name: result, arguments
    "reident_last_error": (c_char_p, []),
    "reident_library_version": (c_char_p, []),
    "reident_client_open": (c_void_p, [POINTER(Options)]),
    "reident_client_close": (None, [c_void_p]),
    "reident_next_event": (c_int, [c_void_p, POINTER(Event), c_int]),
    "reident_version_json": (c_char_p, [c_void_p, c_char_p, c_char_p]),
    "reident_history_page": (c_int, [c_void_p, POINTER(HistoryQuery), c_char_p, c_int, HistoryRow,
                                     c_void_p, c_char_p, c_size_t]),
    "reident_runner_open": (c_void_p, [c_void_p, c_char_p, c_char_p, POINTER(Signal), c_size_t,
                                       POINTER(Signal), c_size_t]),
    "reident_runner_close": (None, [c_void_p]),
    "reident_step": (c_int, [c_void_p, _VECTOR, _VECTOR]),
    "reident_follow": (c_int, [c_void_p, _VECTOR, _VECTOR, _VECTOR]),
    "reident_observe": (None, [c_void_p, _VECTOR]),
    "reident_accept": (c_int, [c_void_p]),
    "reident_input_flags": (c_int, [c_void_p, c_size_t]),
    "reident_runner_get_state": (c_int, [c_void_p, POINTER(RunnerState)]),
}

library = ctypes.CDLL(LIBRARY)
for _name, (_result, _arguments) in _PROTOTYPES.items():
    _function = getattr(library, _name)
    _function.restype, _function.argtypes = _result, _arguments
