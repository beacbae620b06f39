"""The approved models of a satellite's equipment, in a simulator written in Python.

    with reident.Client(spacecraft="CBERS-4") as client:
        bdr = client.runner("CBERS-4", "BDR", inputs={"I_BDRIN1": "A", "I_BDRIN2": "A"},
                            outputs={"I_BDROUT": "A"})
        y, flags = bdr.step([1.2, 0.5])

A client works on a thread of its own; a runner, and a client, are for one thread at a time.
Vectors are anything with a length and numbers in it: lists, tuples, NumPy arrays. Times are
nanoseconds since 1970-01-01T00:00:00 UTC. service/client/README.md has the details.
"""

import ctypes
import json
from typing import Iterator, Mapping, NamedTuple, Optional, Sequence, Tuple

from . import _abi
from ._abi import EventKind, Flags, library

__all__ = ["BadArgument", "Client", "ClientError", "Event", "EventKind", "Flags", "Runner",
           "RunnerState", "Unavailable", "library_version"]


class ClientError(Exception):
    """A call could not do what it was asked to; says why and what would mend it."""


class BadArgument(ClientError, ValueError):
    """The request can never be met."""


class Unavailable(ClientError):
    """Not now: no model, no offer, no answer from a service."""


_ERRORS = {_abi.BAD_ARGUMENT: BadArgument, _abi.UNAVAILABLE: Unavailable}


def _last_error() -> str:
    return library.reident_last_error().decode()


def _checked(result: int) -> int:
    if result < 0:
        raise _ERRORS.get(result, ClientError)(_last_error())
    return result


def _text(value: Optional[str]) -> Optional[bytes]:
    return None if value is None else value.encode()


def library_version() -> str:
    return library.reident_library_version().decode()


class Event(NamedTuple):
    """What happened; `kind` is an EventKind, or a number that this module does not know."""

    kind: int
    spacecraft: str
    equipment: str
    text: str  # one sentence for a log
    version: int
    from_cache: bool
    time_ns: int
    decided_ns: int
    published_ns: int
    remaining_step: float
    transition_steps: int
    matched_rows: int


class RunnerState(NamedTuple):
    version: int  # 0: none
    offered_version: int  # 0: none
    decided_ns: int
    age_ns: int
    swapped_ns: int
    following: bool
    from_cache: bool
    sample_period_s: float
    running_mrse_percent: float
    steps: int
    steps_outside: int
    steps_missing: int
    remaining_step: float
    transition_steps: int
    transition_left: int


class Client:
    """Subscribes to the approved versions of a partition."""

    def __init__(self, simulator: Optional[str] = None, domain: int = 0,
                 partition: str = "operations", spacecraft: str = "*",
                 equipment: Sequence[str] = (), cache_folder: Optional[str] = None,
                 security_folder: Optional[str] = None):
        """`spacecraft` and `equipment` are names or patterns with * and ?; without equipment every
        one. `cache_folder` keeps the last good versions: None is the user's, "" none.
        `security_folder` has the simulator's certificate on a secured domain: None is what
        REIDENT_SECURITY names, if anything, "" not secured."""
        if isinstance(equipment, str):
            equipment = [equipment]
        options = _abi.Options(size=ctypes.sizeof(_abi.Options))
        names = (ctypes.c_char_p * len(equipment))(*map(_text, equipment))
        options.simulator, options.domain = _text(simulator), domain
        options.partition, options.spacecraft = _text(partition), _text(spacecraft)
        options.equipment, options.equipment_count = names, len(equipment)
        options.cache_folder = _text(cache_folder)
        options.security_folder = _text(security_folder)
        self._handle = library.reident_client_open(ctypes.byref(options))
        self._runners = []
        if not self._handle:
            raise ClientError(_last_error())

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self):
        self.close()

    def close(self) -> None:
        """Ends the client and its runners."""
        for runner in getattr(self, "_runners", []):
            runner.close()
        handle, self._handle = getattr(self, "_handle", None), None
        library.reident_client_close(handle)

    def _open(self):
        if not self._handle:
            raise ClientError("the client is closed")
        return self._handle

    def next_event(self, timeout: Optional[float] = 0) -> Optional[Event]:
        """The next event, waiting for it at most `timeout` seconds (None: for ever)."""
        event = _abi.Event(size=ctypes.sizeof(_abi.Event))
        wait_ms = -1 if timeout is None else round(timeout * 1000)
        if _checked(library.reident_next_event(self._open(), ctypes.byref(event), wait_ms)) == 0:
            return None
        values = {name: getattr(event, name) for name in Event._fields}
        for name in ("spacecraft", "equipment", "text"):
            values[name] = values[name].decode()
        values["from_cache"] = bool(event.from_cache)
        if event.kind in list(EventKind):
            values["kind"] = EventKind(event.kind)
        return Event(**values)

    def events(self, timeout: Optional[float] = 0) -> Iterator[Event]:
        """Events as they come, until none has come for `timeout` seconds (None: without end)."""
        while (event := self.next_event(timeout)) is not None:
            yield event

    def version(self, spacecraft: str, equipment: str) -> Optional[dict]:
        """The newest verified version of an equipment; its "model" has signals, matrices, scores."""
        found = library.reident_version_json(self._open(), _text(spacecraft), _text(equipment))
        return None if found is None else json.loads(found)

    def history(self, subject: str = "versions", spacecraft: Optional[str] = None,
                equipment: Optional[str] = None, begin_ns: int = 0, end_ns: int = 0,
                version: int = 0, page_size: Optional[int] = None,
                timeout: float = 10) -> Iterator[dict]:
        """Rows of the running service's history, fetched page by page as they are asked for."""
        query = _abi.HistoryQuery(size=ctypes.sizeof(_abi.HistoryQuery))
        query.subject, query.version = _text(subject), version
        query.spacecraft, query.equipment = _text(spacecraft), _text(equipment)
        query.begin_ns, query.end_ns = begin_ns, end_ns
        query.page_size = page_size or 0
        cursor, following = b"", ctypes.create_string_buffer(4096)
        while True:
            rows = []
            row = _abi.HistoryRow(lambda text, _, rows=rows: rows.append(json.loads(text)))
            _checked(library.reident_history_page(
                self._open(), ctypes.byref(query), cursor, round(timeout * 1000), row, None,
                following, len(following)))
            yield from rows
            cursor = following.value
            if not cursor:
                return

    def runner(self, spacecraft: str, equipment: str, inputs, outputs) -> "Runner":
        """A runner of one equipment. `inputs` and `outputs` are names in the order of the vectors,
        as {name: unit} or [name, ...]; a unit of None is not checked."""
        runner = Runner(self, spacecraft, equipment, inputs, outputs)
        self._runners.append(runner)
        return runner


def _signals(signals) -> Tuple[list, ctypes.Array]:
    units = signals if isinstance(signals, Mapping) else dict.fromkeys(signals)
    if len(units) != len(signals):
        raise BadArgument("a signal is named twice; name each input and output once")
    made = [_abi.Signal(_text(name), _text(unit)) for name, unit in units.items()]
    return list(units), (_abi.Signal * len(made))(*made)


class Runner:
    """Runs the model of one equipment, a step each sample period. Made by Client.runner()."""

    def __init__(self, client: Client, spacecraft: str, equipment: str, inputs, outputs):
        self._handle = None
        self.inputs, c_inputs = _signals(inputs)
        self.outputs, c_outputs = _signals(outputs)
        self._u = (ctypes.c_double * len(c_inputs))()
        self._y = (ctypes.c_double * len(c_outputs))()
        self._measured = (ctypes.c_double * len(c_outputs))()
        self._handle = library.reident_runner_open(
            client._open(), _text(spacecraft), _text(equipment), c_inputs, len(c_inputs),
            c_outputs, len(c_outputs))
        if not self._handle:
            raise BadArgument(_last_error())

    def close(self) -> None:
        handle, self._handle = self._handle, None
        library.reident_runner_close(handle)

    def _open(self):
        if not self._handle:
            raise ClientError("the runner is closed")
        return self._handle

    @staticmethod
    def _fill(vector, values, names) -> None:
        if len(values) != len(vector):
            raise BadArgument(f"{len(values)} values for {', '.join(names)}; give {len(vector)}")
        vector[:] = values

    def step(self, u: Sequence[float]) -> Tuple[Tuple[float, ...], Flags]:
        """Runs free; returns the outputs and the flags. An input that is NaN is missing."""
        self._fill(self._u, u, self.inputs)
        flags = library.reident_step(self._open(), self._u, self._y)
        return tuple(self._y), Flags(_checked(flags))

    def follow(self, u: Sequence[float],
               measured: Sequence[float]) -> Tuple[Tuple[float, ...], Flags]:
        """Follows the satellite, corrected by the measured outputs (NaN where one is missing)."""
        self._fill(self._u, u, self.inputs)
        self._fill(self._measured, measured, self.outputs)
        flags = library.reident_follow(self._open(), self._u, self._measured, self._y)
        return tuple(self._y), Flags(_checked(flags))

    def observe(self, measured: Sequence[float]) -> None:
        """Tells a free run what was measured at its last step."""
        self._fill(self._measured, measured, self.outputs)
        library.reident_observe(self._open(), self._measured)

    def accept(self) -> None:
        """Takes the version that is offered at the next step. Raises Unavailable."""
        _checked(library.reident_accept(self._open()))

    def input_flags(self, name: str) -> Flags:
        """What one input was at the last step: INPUT_MISSING, INPUT_OUTSIDE, both or none."""
        if name not in self.inputs:
            raise BadArgument(f"no input {name}; there are {', '.join(self.inputs)}")
        return Flags(_checked(library.reident_input_flags(self._open(), self.inputs.index(name))))

    def state(self) -> RunnerState:
        state = _abi.RunnerState(size=ctypes.sizeof(_abi.RunnerState))
        _checked(library.reident_runner_get_state(self._open(), ctypes.byref(state)))
        values = {name: getattr(state, name) for name in RunnerState._fields}
        return RunnerState(**{**values, "following": bool(state.following),
                              "from_cache": bool(state.from_cache)})
