"""Diagnoses of logs in which effects are hidden, each scored against its truth."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from softid.diagnosis import diagnose
from softid.diagnosis.report.remarks import WHAT_IT_IS
from softid.diagnosis.report.unlisted_texts import LAW_BESIDE, LIKE_UNLISTED_LAW
from softid.diagnosis_results import Diagnosis, Gain
from softid.effects import EFFECTS, confusable_with
from softid.identification import fit
from softid.synthesis import HiddenPair, hidden_pair
from softid.synthesis.hidden import names_of
from softid.synthesis.rig import Rig

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))  # pytest knows it by itself
from recovery import all_recovered

SINGLE = tuple(sorted(key for key in EFFECTS if "." not in key))
FORMS = tuple(sorted(key for key in EFFECTS if "." in key))
BACKGROUND_SIZE = (0.1, 0.2)
SCALINGS, SIZES, LEAST_MISFIT, QUIET = 3, (1e-3, 3.0), 1e-3, 2e-4

RIGS: dict[str, dict[str, Any]] = {
    "usual": {},
    "50 Hz": {"rate_hz": 50.0},
    "irregular": {"jitter": 0.2},
    "drop-outs": {"lost_fraction": 0.03, "blank_fraction": 0.03},
    "degrees": {"unit": "deg"},
    "coloured": {"coloured_share": 0.9, "rest_s": 30.0},
    "coloured, no rest": {"coloured_share": 0.9},
    "quick valve": {"valve_s": 0.001},
}

PAIRED = (
    ("delay", "creep"),
    ("pneumatic_lag", "coulomb_friction"),
    ("hysteresis", "sensor_drift"),
    ("creep", "stiffening"),
    ("dead_zone", "asymmetric_damping"),
    ("sensor_clipping", "delay"),
    ("contact", "creep"),
    ("valve_flow", "sensor_warmup"),
    ("quadratic_damping", "hysteresis"),
    ("ageing", "line_resonance"),
    ("softening", "coulomb_friction"),
    ("static_curve", "sensor_lag"),
)
"""Two effects of different kinds, every effect but two of the catalogue at least once."""

PACE, STRETCH = (0.2, 5.0), (0.3, 6.0)
"""Bounds of the factors by which wide cases slow an actuator, and of those of their effects'
times."""

VARIED = ("rich", "levels", "lever", "triangles", "multisine")
"""Protocols of pairs that are drawn at random."""

TIES = (("delay", "sine"), ("pneumatic_lag", "sine"))
"""Effects whose neighbours a protocol cannot split from them."""

TOLD = (*WHAT_IT_IS, LIKE_UNLISTED_LAW, LAW_BESIDE)
"""Codes of what a misfit is told to be beside causes."""


@dataclass(frozen=True)
class Case:
    """One diagnosis to run.

    Attributes
    ----------
    kind
        ``clean``, ``single``, ``form`` for the richer forms, ``other_form``, ``outside``, ``pair``,
        ``any_pair``, ``background``, ``faint``, ``wide`` or ``tie``. In the background of the first
        effect each of the others causes a tenth to a fifth of its misfit; faint ones have a tenth
        to a fifth of the usual size, whatever that causes; wide ones are single effects of much
        longer or shorter times than those usually drawn, and actuators of another pace.
    names
        What is hidden, the dominant effect first.
    seed, size, model, protocol
        As `hidden_pair` takes them.
    rig
        Key of `RIGS`.
    in_blocks
        Whether blocks of the log judge, in place of another log.
    chosen
        Whether the base is chosen in place of named.
    """

    kind: str
    names: tuple[str, ...]
    seed: int
    size: float = 1.0
    model: str = "muscle"
    protocol: str = "rich"
    rig: str = "usual"
    in_blocks: bool = False
    chosen: bool = False

    @property
    def key(self) -> str:
        """A name that no other case has."""
        hidden = "+".join(self.names) or "nothing"
        parts = (self.kind, hidden, self.seed, self.size, self.model, self.protocol, self.rig)
        ways = (*(("blocks",) if self.in_blocks else ()), *(("chosen",) if self.chosen else ()))
        return "/".join(str(part) for part in (*parts, *ways))

    def pair(self) -> HiddenPair:
        """The logs with their truth."""
        values = BEHIND[self.kind](self) if self.kind in BEHIND else {}
        drawn = hidden_pair(
            self.names,
            seed=self.seed,
            size=self.size,
            model=self.model,
            protocol=self.protocol,
            rig=Rig(**RIGS[self.rig]),
            values=values,
        )
        return _wider(drawn) if self.kind == "wide" else drawn


def _wider(drawn: HiddenPair) -> HiddenPair:
    """The same with another pace of the actuator, and other times of the effects beside that."""
    rng = np.random.default_rng((drawn.seed, *map(ord, "".join(drawn.hidden))))
    pace, stretch = (float(np.exp(rng.uniform(*np.log(bounds)))) for bounds in (PACE, STRETCH))
    slower = {"M": pace**2, **dict.fromkeys(("N", "a2", "c2"), pace)}
    usual = drawn.actuator.values.items()
    actuator = replace(drawn.actuator, values={n: v * slower.get(n, 1.0) for n, v in usual})
    asked = {
        "seed": drawn.seed,
        "size": drawn.size,
        "model": actuator.model,
        "protocol": drawn.protocol,
        "rig": drawn.rig,
        "actuator": actuator,
    }
    paced = hidden_pair(tuple(drawn.hidden), **asked)
    values = {
        effect: {n: v * (stretch if drawn.units[effect][n] == "s" else 1.0) for n, v in own.items()}
        for effect, own in paced.hidden.items()
    }
    return hidden_pair(tuple(drawn.hidden), values=values, **asked)


def _faint(case: Case) -> dict[str, dict[str, float]]:
    """Values of the other effects, drawn at a tenth to a fifth of the size."""
    shares = _shares(case)
    return {name: dict(_alone(case, name, share).hidden[name]) for name, share in shares.items()}


def _behind(case: Case) -> dict[str, dict[str, float]]:
    """Values of the other effects at which each causes a tenth to a fifth of the main misfit."""
    main = _misfit(_alone(case, case.names[0], 1.0), case)
    values = {}
    for name, share in _shares(case).items():
        size = share
        for _ in range(SCALINGS):
            found = _alone(case, name, size)
            ratio = share * main / max(_misfit(found, case), LEAST_MISFIT * main)
            size = float(np.clip(size * ratio, *SIZES))
        values[name] = dict(_alone(case, name, size).hidden[name])
    return values


BEHIND = {"background": _behind, "faint": _faint}


def _shares(case: Case) -> dict[str, float]:
    """How strong each of the other effects is beside the first."""
    return {
        name: float(np.random.default_rng((case.seed, number)).uniform(*BACKGROUND_SIZE))
        for number, name in enumerate(case.names[1:])
    }


def _alone(case: Case, name: str, size: float) -> HiddenPair:
    """One of the effects by itself, with hardly any noise."""
    quiet = Rig(**{**RIGS[case.rig], "noise": QUIET, "pressure_noise_kpa": 0.0})
    return hidden_pair([name], seed=case.seed, size=case.size * size, model=case.model, rig=quiet)


def _misfit(pair: HiddenPair, case: Case) -> float:
    """Root mean square error that the base model leaves, in the output's unit."""
    return float(fit(pair.logs[0], model=case.model).statistics[0].rmse)


def cases(
    kind: str,
    draws: int,
    seed: int,
    *,
    size: float = 1.0,
    rig: str = "usual",
    model: str = "muscle",
    in_blocks: bool = False,
    chosen: bool = False,
    protocol: str | None = None,
) -> list[Case]:
    """The cases of one kind.

    Parameters
    ----------
    kind
        As in `Case`.
    draws
        Draws of every hidden effect or combination; of ``clean`` ten times as many.
    seed
        First seed.
    size
        Magnitude of the effects; 1 is moderate.
    rig
        Key of `RIGS`.
    model
        Base model, of the diagnosis and of the truth.
    in_blocks, chosen
        As in `Case`.
    protocol
        In place of the usual one.
    """
    hidden = _any_pairs(draws, seed) if kind == "any_pair" else _hidden(kind, draws, seed)
    return [
        Case(kind, names, s, size, model, protocol or usual, rig, in_blocks, chosen)
        for names, usual, s in hidden
    ]


def _any_pairs(draws: int, seed: int) -> Iterator[tuple[tuple[str, ...], str, int]]:
    """Every effect with another one that it is not easily confused with, under any protocol."""
    rng = np.random.default_rng(seed)
    for k in range(draws * len(SINGLE)):
        name = SINGLE[k % len(SINGLE)]
        near = {name, *confusable_with(EFFECTS[name]())}
        others = [o for o in SINGLE if o not in near]
        yield (name, str(rng.choice(others))), str(rng.choice(VARIED)), seed + k


def _hidden(kind: str, draws: int, seed: int) -> Iterator[tuple[tuple[str, ...], str, int]]:
    count = 10 * draws if kind == "clean" else draws
    for names, protocol in _combinations(kind):
        for k in range(count):
            yield names, protocol, seed + k


def _combinations(kind: str) -> Iterator[tuple[tuple[str, ...], str]]:
    if kind == "clean":
        yield (), "rich"
    elif kind == "tie":
        for name, protocol in TIES:
            yield (name,), protocol
    elif kind == "pair":
        for names in PAIRED:
            yield names, "rich"
    elif kind in BEHIND:
        for k, name in enumerate(SINGLE):
            others = [other for other in SINGLE if other != name]
            yield (name, others[(3 * k) % 20], others[(7 * k + 5) % 20]), "rich"
    else:
        groups = {"single": SINGLE, "form": FORMS, "wide": (*SINGLE, *FORMS)}
        names = groups.get(kind) or names_of(kind)
        for name in names:
            yield (name,), "rich"


@dataclass(frozen=True)
class Score:
    """What one diagnosis answered, and what was true.

    Attributes
    ----------
    key, kind, names
        Of the case.
    verdict
        The answer.
    causes
        Effects that it names, in their order.
    described
        Effects that help without being named.
    tied
        Effects that it says it cannot split from them.
    snr
        Root mean square misfit of the base over the noise.
    gain, oracle_gain
        Fall of the held-out error as a share of it, and that of a diagnosis that considers the true
        effects only; where they are not in the catalogue, what would leave nothing but noise.
    recovered
        Whether every hidden effect that was named is recovered; None where there is none.
    seconds, cpu_seconds
        Of the diagnosis, by the clock and of the processor.
    values
        Parameters of the causes.
    told
        What the misfit is beside them: what changed, or a law in no catalogue, in words.
    explained, structure, structure_limit, excess
        Of the remainder.
    beside_snr
        Least misfit over the noise where one of several hidden effects is not considered and the
        others are refitted, else None: what it does may look like what another or the base can do.
    """

    key: str
    kind: str
    names: tuple[str, ...]
    verdict: str
    causes: tuple[str, ...]
    described: tuple[str, ...]
    tied: tuple[str, ...]
    snr: float
    gain: float
    oracle_gain: float
    recovered: bool | None
    seconds: float
    cpu_seconds: float
    explained: float
    structure: float
    structure_limit: float
    values: dict[str, float] = field(default_factory=dict)
    told: tuple[str, ...] = ()
    excess: float | None = None
    beside_snr: float | None = None

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of the hidden effects, whatever their form."""
        return tuple(name.split(".")[0] for name in self.names)


def run(case: Case) -> Score:
    """Make the logs of a case, diagnose them and score the answer.

    Parameters
    ----------
    case
        What to run.
    """
    pair = case.pair()
    train, *judges = pair.logs if not case.in_blocks else pair.logs[:1]
    base = None if case.chosen else case.model
    begin, begin_cpu = time.perf_counter(), time.process_time()
    found = diagnose([train], hold_out=judges, model=base)
    seconds, cpu_seconds = time.perf_counter() - begin, time.process_time() - begin_cpu
    channel = next(c for c in pair.train.sigma if "pressure" not in c)
    inside, outside = _gain(found, held_out=False), _gain(found, held_out=True)
    factor = 1.0 / train.channels[train.outputs[0]].display_factor
    sigma = factor * pair.train.sigma[channel]
    before, after = outside.rmse_before, outside.rmse_after
    oracle_after, beside_snr = factor * pair.hold_out.sigma[channel], None
    if case.names and set(case.names) <= set(EFFECTS):

        def known(effects: tuple[str, ...]) -> Diagnosis:
            return diagnose([train], hold_out=judges, model=case.model, effects=effects)

        oracle_after = _gain(known(case.names), held_out=True).rmse_after
        if case.kind in ("pair", "any_pair"):
            without = (known(tuple({*case.names} - {name})) for name in case.names)
            left = [_gain(other, held_out=False).rmse_after for other in without]
            beside_snr = _snr(min(left), sigma)
    return Score(
        key=case.key,
        kind=case.kind,
        names=case.names,
        verdict=found.verdict.value,
        causes=tuple(c.effect for c in found.causes),
        described=tuple(c.effect for c in found.descriptive),
        tied=tuple(sorted({e for a in found.alternatives for e in a.effects})),
        snr=_snr(inside.rmse_before, sigma),
        gain=1.0 - after / before,
        oracle_gain=max(1.0 - oracle_after / before, 0.0),
        recovered=all_recovered(found, pair),
        seconds=seconds,
        cpu_seconds=cpu_seconds,
        explained=float(found.remainder.explained_share),
        structure=float(found.remainder.structure_share),
        structure_limit=float(found.remainder.structure_limit),
        values={p.name: float(p.value) for c in found.causes for p in c.parameters},
        told=tuple(issue.message for issue in found.issues if issue.code in TOLD),
        excess=float(found.remainder.excess),
        beside_snr=beside_snr,
    )


def _gain(found: Diagnosis, *, held_out: bool) -> Gain:
    return next(gain for gain in found.gains if gain.held_out is held_out)


def _snr(rmse: float, sigma: float) -> float:
    """Root mean square of what is left beside noise of the standard deviation sigma, over it."""
    return float(np.sqrt(max(rmse**2 / sigma**2 - 1.0, 0.0)))
