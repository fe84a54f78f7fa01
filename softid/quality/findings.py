"""What an inspection finds: frozen records of plain numbers, times in seconds.

Values are in the canonical unit of their channel; its display unit and factor stand in
`ChannelReport`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from softid.errors import Issue
from softid.excitation import Quantisation, SampleHold, Stretch
from softid.quality.holding import Hold
from softid.quality.sampling import Sampling

Role = Literal["input", "output", "command", "other"]
Possible = Literal["yes", "partly", "no"]
DropoutCause = Literal["missing", "sentinel", "lost digit", "spike"]
Reason = Literal["stale", "noise vanishes", "input moves"]
"""Why a channel seems to be frozen."""


@dataclass(frozen=True)
class Dropout:
    """A few samples at which the sensor or its line failed.

    Attributes
    ----------
    start, stop
        Half-open range of samples.
    start_s, length_s
        Time of its first sample, and time from there to the next good sample.
    value
        What was recorded, None where nothing was.
    expected
        Mean of the good neighbours, None where there are none.
    cause
        ``"missing"`` (NaN), ``"sentinel"`` (a value that stands for no value, such as 0),
        ``"lost digit"`` (the neighbour without its first digit), or ``"spike"``.
    """

    start: int
    stop: int
    start_s: float
    length_s: float
    value: float | None
    expected: float | None
    cause: DropoutCause


@dataclass(frozen=True)
class Frozen:
    """A stretch on which a live channel repeats one value exactly.

    Attributes
    ----------
    start, stop
        Half-open range of samples.
    start_s, length_s
        Time of its first sample, and time to its last.
    value
        The value.
    reason
        ``"stale"`` where its noise vanishes although the motion goes on, ``"noise vanishes"`` where
        there may be none, ``"input moves"`` where it has no noise.
    """

    start: int
    stop: int
    start_s: float
    length_s: float
    value: float
    reason: Reason

    @property
    def meanwhile(self) -> str:
        """What goes on while it is stuck, as a sentence ends with it."""
        return {
            "stale": "its noise vanishes, though the motion goes on",
            "noise vanishes": "its noise vanishes",
            "input moves": "the input moves",
        }[self.reason]


@dataclass(frozen=True)
class Saturation:
    """Flat tops or bottoms at an exact extreme value.

    Attributes
    ----------
    side
        ``"high"`` or ``"low"``.
    value
        The limit.
    times
        Number of separate flats.
    share
        Share of the samples at the limit.
    first_s, longest_s
        Start of the first flat, length of the longest.
    """

    side: Literal["high", "low"]
    value: float
    times: int
    share: float
    first_s: float
    longest_s: float


@dataclass(frozen=True)
class Hum:
    """A narrow line in the noise at rest.

    Attributes
    ----------
    frequency_hz
        Frequency as sampled.
    amplitude
        Amplitude in the channel's unit.
    mains_hz
        Frequency of the mains or twice it that this is or is folded down from, or None.
    """

    frequency_hz: float
    amplitude: float
    mains_hz: float | None


@dataclass(frozen=True)
class ChannelReport:
    """One channel: what it is and what sampling and sensor did to it.

    Attributes
    ----------
    name, role, column
        Channel, its role in this log, and the file's column.
    unit, display_unit, display_factor
        Unit of the numbers here, unit of the file, and the factor to it.
    low, high
        Extremes; None without a finite sample.
    missing
        Number of samples that are NaN.
    dead
        Constant from the first to the last sample.
    quantisation, hold
        Smallest step and zero-order hold, or None.
    dead_band
        Size of the jumps of a channel that moves only when enough has changed, or None.
    noise_std
        Standard deviation of the white noise; None where the quantisation hides it.
    noise_below
        Its bound where the quantisation hides it; None elsewhere.
    hum
        A line in the noise, or None.
    dropouts, frozen, saturation
        Faults, in order of time.
    """

    name: str
    role: Role
    column: str | None
    unit: str
    display_unit: str
    display_factor: float
    low: float | None
    high: float | None
    missing: int
    dead: bool
    quantisation: Quantisation | None
    hold: SampleHold | None
    dead_band: float | None
    noise_std: float | None
    noise_below: float | None
    hum: Hum | None
    dropouts: tuple[Dropout, ...]
    frozen: tuple[Frozen, ...]
    saturation: tuple[Saturation, ...]


@dataclass(frozen=True)
class SignCheck:
    """How an output goes with the input.

    Attributes
    ----------
    output
        Channel.
    correlation
        Of input and output at the best lag.
    lag_s
        That lag, between 0 and a quarter of the main period.
    inverted
        Whether the output clearly goes the wrong way for its kind.
    """

    output: str
    correlation: float
    lag_s: float
    inverted: bool


@dataclass(frozen=True)
class CommandLag:
    """Rough time by which the measured pressure follows the commanded one.

    Attributes
    ----------
    lag_s
        Lag of the largest cross-correlation.
    correlation
        Its value.
    """

    lag_s: float
    correlation: float


@dataclass(frozen=True)
class StepResponse:
    """How quickly input and output pass from level to level, medians over the transitions.

    Attributes
    ----------
    output
        Channel.
    transitions
        Number of transitions between settled windows that could be timed.
    input_t63_s, output_t63_s
        Time from the end of one hold to 63 % of the way to the next.
    settled
        Share of these transitions before and after which the output settles.
    input_overshoot, overshoot
        Overshoot of input and output beyond their next levels, over the step; None where they
        never settle.
    """

    output: str
    transitions: int
    input_t63_s: float
    output_t63_s: float
    settled: float
    input_overshoot: float | None
    overshoot: float | None


@dataclass(frozen=True)
class Ability:
    """Whether one property of the actuator can be identified from this log.

    Attributes
    ----------
    name
        The property: ``"static curve"``, ``"damping"``, ``"inertia"``, …
    serves
        The parameters of the models that rest on it.
    possible
        ``"yes"``, ``"partly"`` or ``"no"``.
    reason
        Why, one sentence.
    wanted
        The log that would help; None when nothing is missing.
    """

    name: str
    serves: str
    possible: Possible
    reason: str
    wanted: str | None


@dataclass(frozen=True)
class Inspection:
    """Everything an inspection finds in one log.

    Attributes
    ----------
    log, path, file_format
        Name, and file of origin with its format, None for arrays.
    input, outputs
        Roles.
    sampling
        When the samples were taken.
    channels
        One report per channel: input, outputs, then the others.
    excitation
        Stretches of the input.
    command_excitation
        Stretches of the commanded pressure, where there is one beside the input.
    command_lag
        Lag of the measured behind the commanded pressure, where both are there and move.
    signs
        One check per output.
    holds
        Where the input is held, and what the first output that is no pressure does meanwhile.
    responses
        One entry per output with timed transitions.
    abilities
        What can be identified.
    issues
        What the reader noticed and what was found here, most severe first.
    """

    log: str
    path: str | None
    file_format: str | None
    input: str
    outputs: tuple[str, ...]
    sampling: Sampling
    channels: tuple[ChannelReport, ...]
    excitation: tuple[Stretch, ...]
    command_excitation: tuple[Stretch, ...] | None
    command_lag: CommandLag | None
    signs: tuple[SignCheck, ...]
    holds: tuple[Hold, ...]
    responses: tuple[StepResponse, ...]
    abilities: tuple[Ability, ...]
    issues: tuple[Issue, ...]

    def channel(self, name: str) -> ChannelReport:
        """The report of one channel.

        Raises
        ------
        KeyError
            There is no channel of that name.
        """
        for report in self.channels:
            if report.name == name:
                return report
        raise KeyError(name)

    def ability(self, name: str) -> Ability:
        """The judgement about one property.

        Raises
        ------
        KeyError
            There is none of that name.
        """
        for ability in self.abilities:
            if ability.name == name:
                return ability
        raise KeyError(name)
