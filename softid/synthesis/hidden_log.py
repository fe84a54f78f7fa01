"""Pairs of logs with known truth in which effects are hidden."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from zlib import crc32

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import UsageError
from softid.log import Log
from softid.synthesis.actuators import Actuator, Sizes, random_actuator, slopes
from softid.synthesis.columns import parse_column
from softid.synthesis.hidden import HIDDEN, hidden_named
from softid.synthesis.hidden_base import Law, Occasion, OutputLaw
from softid.synthesis.hidden_truth import HiddenTruth, chain_of, integrate_hidden
from softid.synthesis.protocols import protocol_named
from softid.synthesis.rig import RIG, Rig
from softid.synthesis.sensors import Sensor
from softid.synthesis.waveforms import Piece

Array = npt.NDArray[np.float64]

COARSE_TOLERANCE = 1e-5
COARSE_HZ = 50.0
_LEVELS = 21
"""Tolerance, sampling and levels at which an actuator without a hidden effect is looked at: only
the sizes of effects come from it, and those are drawn at random."""

_STREAMS = ("actuator", "draw", "train", "hold_out")
_LARGEST_SEED = 2**63
"""Seeds are whole numbers below this, as many as the generator draws."""


@dataclass(frozen=True, eq=False)
class HiddenLog:
    """One recording with hidden effects.

    Attributes
    ----------
    name
        Name of the log.
    time_s
        Recorded times, shape (n,).
    columns
        Column → recorded values in the unit of its name, shape (n,); NaN where blank.
    sigma
        Column → standard deviation of what its sensor added.
    zero
        What the output's sensor added as a constant, in the column's unit.
    truth
        Noise-free signals, with x in the unit of the law. For tests alone.
    """

    name: str
    time_s: Array
    columns: Mapping[str, Array]
    sigma: Mapping[str, float]
    zero: float
    truth: HiddenTruth

    @property
    def decimals(self) -> tuple[int, ...]:
        """Decimals of the time and of the columns in a CSV."""
        return (6, 3, 6)

    def to_log(self) -> Log:
        """The recorded columns as a log, the same that the CSV reads back to."""
        parsed = {name: parse_column(name) for name in self.columns}
        return Log.from_arrays(
            self.time_s,
            {parsed[name].channel: values for name, values in self.columns.items()},
            units={column.channel: column.unit for column in parsed.values()},
            name=self.name,
        )


@dataclass(frozen=True, eq=False)
class HiddenPair:
    """A log, its hold-out, and what is true of both.

    Attributes
    ----------
    train, hold_out
        The recordings.
    actuator
        The actuator with its true parameters.
    hidden
        Name of the effect → parameter → true value, in the order given.
    units
        Name of the effect → parameter → unit.
    sizes
        What the effects were scaled by.
    seed, size, protocol
        As asked for.
    rig
        How it was recorded.
    """

    train: HiddenLog
    hold_out: HiddenLog
    actuator: Actuator
    hidden: Mapping[str, Mapping[str, float]]
    units: Mapping[str, Mapping[str, str]]
    sizes: Sizes
    seed: int
    size: float
    protocol: str
    rig: Rig

    @property
    def logs(self) -> tuple[Log, Log]:
        """Both as logs."""
        return self.train.to_log(), self.hold_out.to_log()


def hidden_pair(
    names: Sequence[str] = (),
    *,
    seed: int = 0,
    size: float = 1.0,
    model: str = "muscle",
    protocol: str = "rich",
    rig: Rig = RIG,
    actuator: Actuator | None = None,
    values: Mapping[str, Mapping[str, float]] | None = None,
) -> HiddenPair:
    """Draw an actuator and effects, and record a log and its hold-out.

    Every part has a random stream of its own: another effect, size or rig leaves the actuator,
    and another size leaves the signs of the effects.

    Parameters
    ----------
    names
        Effects of `HIDDEN`; none for an actuator that is its model.
    seed
        Of all that is random.
    size
        Magnitude of the effects; 1 is moderate.
    model
        ``"muscle"``, ``"oscillator"`` or ``"equilibrium"``.
    protocol
        Name in `PROTOCOLS`.
    rig
        How it is recorded.
    actuator
        Taken in place of a random one; its model and unit count.
    values
        Name of an effect → parameters that are given instead of drawn.

    Returns
    -------
    HiddenPair
        Both logs and the truth.

    Raises
    ------
    UsageError
        An unknown effect, parameter, model or protocol, an effect named twice, or a size that is
        not positive.
    InputError
        The effects together leave no finite response.

    Examples
    --------
    >>> pair = hidden_pair(["delay"], seed=3, protocol="step")
    >>> log, hold_out = pair.logs
    >>> len(log), list(pair.hidden["delay"])
    (601, ['tau'])
    """
    _check(names, seed, size, values)
    plan = protocol_named(protocol)
    streams = dict(zip(_STREAMS, np.random.SeedSequence(seed).spawn(len(_STREAMS)), strict=True))
    if actuator is None:
        actuator = random_actuator(
            model, np.random.default_rng(streams["actuator"]), x_unit=rig.x_unit
        )
    top_kpa = actuator.kind.top_kpa
    recordings = {}
    for role in ("train", "hold_out"):
        command_seed, *others = streams[role].spawn(4)
        excitation = plan.excitation(top_kpa, hold_out=role == "hold_out", rest_s=rig.rest_s)
        pieces = excitation.pieces(0.0, np.random.default_rng(command_seed))
        recordings[role] = (pieces, others)
    sizes = measured_sizes(actuator, recordings["train"][0], rig)
    drawn = _drawn(names, sizes, streams["draw"], size, values or {})
    logs = []
    for role, (pieces, others) in recordings.items():
        occasion_seed = int(np.random.default_rng(others[0]).integers(_LARGEST_SEED))
        occasion = Occasion(pieces[-1].stop_s, occasion_seed, later=role == "hold_out")
        laws = [HIDDEN[name].build(drawn[name], sizes, occasion) for name in names]
        logs.append(_record(role, pieces, laws, actuator, sizes, rig, others[1:]))
    return HiddenPair(
        train=logs[0],
        hold_out=logs[1],
        actuator=actuator,
        hidden=MappingProxyType({k: MappingProxyType(v) for k, v in drawn.items()}),
        units=MappingProxyType({name: HIDDEN[name].units_for(sizes) for name in names}),
        sizes=sizes,
        seed=seed,
        size=size,
        protocol=protocol,
        rig=rig,
    )


def hidden_log(
    names: Sequence[str] = (),
    *,
    seed: int = 0,
    size: float = 1.0,
    model: str = "muscle",
    protocol: str = "rich",
    rig: Rig = RIG,
) -> Log:
    """The log of `hidden_pair` alone.

    Parameters
    ----------
    names, seed, size, model, protocol, rig
        As in `hidden_pair`.
    """
    found = hidden_pair(names, seed=seed, size=size, model=model, protocol=protocol, rig=rig)
    return found.train.to_log()


def measured_sizes(actuator: Actuator, pieces: Sequence[Piece], rig: Rig) -> Sizes:
    """Sizes of an actuator under a command, from its statics and a coarse integration.

    Parameters
    ----------
    actuator
        The actuator without effects.
    pieces
        The command.
    rig
        Valve.
    """
    motion = actuator.motion
    time_s = np.arange(0.0, pieces[-1].stop_s, 1.0 / COARSE_HZ)
    plain = integrate_hidden(
        pieces, time_s, chain_of(motion, rig.valve_s, ()), tolerance=COARSE_TOLERANCE
    )
    p_low, p_high = float(plain.pressure_kpa.min()), float(plain.pressure_kpa.max())
    levels = np.linspace(p_low, p_high, _LEVELS).tolist()
    rest = np.array([motion.rest(p) for p in levels])
    stiffness, damping = (float(v) for v in np.median([slopes(motion, p) for p in levels], axis=0))
    speed = np.abs(plain.velocity)
    return Sizes(
        p_low=p_low,
        p_high=p_high,
        x_low=float(rest.min()),
        x_high=float(rest.max()),
        force=float(stiffness * np.ptp(rest)),
        stiffness=stiffness,
        damping=damping,
        motion_s=damping / stiffness,
        v_max=float(np.quantile(speed, 0.99)),
        travel=float(np.sum(speed) / COARSE_HZ),
        duration_s=float(pieces[-1].stop_s),
        x_unit=actuator.x_unit,
        force_unit=actuator.kind.force_unit,
    )


def _check(
    names: Sequence[str],
    seed: int,
    size: float,
    values: Mapping[str, Mapping[str, float]] | None,
) -> None:
    for name in names:
        hidden_named(name)
    if len(set(names)) < len(names):
        raise UsageError("an effect is named twice", value=list(names), remedy="name each once")
    if not 0.0 < size < float("inf"):
        raise UsageError("the size of an effect must be positive", value=size, remedy="try 1")
    if seed < 0:
        raise UsageError("a seed cannot be negative", value=seed, remedy="give 0 or more")
    for name, given in (values or {}).items():
        if name not in names:
            raise UsageError("values are given for an effect that is not hidden", value=name)
        for parameter in given:
            if parameter not in HIDDEN[name].units:
                raise UsageError(
                    f"{name} has no such parameter",
                    value=parameter,
                    remedy=f"choose from {', '.join(HIDDEN[name].units)}",
                )


def _drawn(
    names: Sequence[str],
    sizes: Sizes,
    stream: np.random.SeedSequence,
    size: float,
    values: Mapping[str, Mapping[str, float]],
) -> dict[str, dict[str, float]]:
    """Parameters of every effect, each from a stream that belongs to its name.

    So a draw stays as it is when other effects join the table.
    """
    found = {}
    for name in names:
        own = (*stream.spawn_key, crc32(name.encode()))
        rng = np.random.default_rng(np.random.SeedSequence(stream.entropy, spawn_key=own))
        drawn = HIDDEN[name].draw(sizes, rng, size)
        found[name] = {**{k: float(v) for k, v in drawn.items()}, **values.get(name, {})}
    return found


def _record(
    role: str,
    pieces: Sequence[Piece],
    laws: Sequence[Law],
    actuator: Actuator,
    sizes: Sizes,
    rig: Rig,
    seeds: Sequence[np.random.SeedSequence],
) -> HiddenLog:
    clock_rng, sensor_rng = (np.random.default_rng(seed) for seed in seeds)
    pressure_rng, output_rng = sensor_rng.spawn(2)
    time_s = rig.sampling().times(pieces[-1].stop_s, clock_rng)
    truth = integrate_hidden(pieces, time_s, chain_of(actuator.motion, rig.valve_s, laws))
    factor = float(np.degrees(1.0)) if rig.unit == "deg" else 1.0
    channel = actuator.kind.column if actuator.x_unit == "mm" else "angle"
    unit = "mm" if actuator.x_unit == "mm" else "deg" if rig.unit == "deg" else "rad"
    span = factor * sizes.x_span
    zero = span * rig.zero * float(output_rng.uniform(-1.0, 1.0)) * 3.0**0.5
    sensors = {
        "pressure_kpa": Sensor(decimals=3, noise_sd=actuator.kind.gauge * rig.pressure_noise_kpa),
        f"{channel}_{unit}": rig.output_sensor(span, zero),
    }
    true = (truth.pressure_kpa, factor * truth.reading)
    columns = {
        name: sensor.read(values, rng)
        for (name, sensor), values, rng in zip(
            sensors.items(), true, (pressure_rng, output_rng), strict=True
        )
    }
    sigma = {name: sensor.sigma for name, sensor in sensors.items()}
    filters = [law.afterwards for law in laws if isinstance(law, OutputLaw) and law.afterwards]
    if filters:
        output = f"{channel}_{unit}"
        columns[output] = kept = _filtered(time_s, columns[output], filters)
        reading = _filtered(time_s, true[1], filters)
        sigma[output] = float(np.nanstd(kept - reading))
        truth = replace(truth, reading=reading / factor)
    return HiddenLog(
        name=role,
        time_s=read_only(time_s),
        columns=MappingProxyType({name: read_only(values) for name, values in columns.items()}),
        sigma=MappingProxyType(sigma),
        zero=zero,
        truth=truth,
    )


def _filtered(
    time_s: Array, recorded: Array, filters: Sequence[Callable[[Array, Array], Array]]
) -> Array:
    """What a file holds of a record, with blanks where they were."""
    known = np.isfinite(recorded)
    kept = np.interp(time_s, time_s[known], recorded[known])
    for change in filters:
        kept = change(time_s, kept)
    return np.where(known, kept, np.nan)
