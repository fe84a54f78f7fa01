"""The response of a model to a log's input, on the log's own times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.log import Log
from softid.models.base import Model
from softid.results import LogNuisance, Simulation

Array = npt.NDArray[np.float64]


def parameter_vector(model: Model, values: Mapping[str, float]) -> Array:
    """Named values as the model's vector θ, shape (K,).

    Raises
    ------
    UsageError
        A parameter is missing or unknown.
    """
    names = model.parameters().names
    odd = sorted(set(values) ^ set(names))
    if odd:
        raise UsageError(
            f"the {model.name} model needs exactly the parameters {', '.join(names)}",
            value=odd,
            remedy="give each of them one value",
        )
    return np.array([values[name] for name in names], dtype=np.float64)


def simulate(
    model: Model,
    values: Mapping[str, float],
    log: Log,
    *,
    nuisance: LogNuisance | None = None,
) -> Simulation:
    """Simulate a model on one log, which is taken as it is.

    Parameters
    ----------
    model
        The model with its options.
    values
        Parameter name → value.
    log
        Supplies times, input and, for comparison, measured outputs.
    nuisance
        Sensor zeros and initial states; without it every segment starts at rest and zeros are 0.

    Returns
    -------
    Simulation
        Free-run response of every output channel, sensor zero included; NaN at a lone sample
        between two stalls.

    Raises
    ------
    UsageError
        A parameter is missing or unknown.
    IdentificationError
        The response is not finite.

    Examples
    --------
    >>> from softid.models import MODELS
    >>> model = MODELS["oscillator"](order="static")  # Q x = G (u − offset)
    >>> steps = {"pressure": [0.0, 30.0, 60.0], "angle": [0.0, 0.5, 1.0]}
    >>> log = Log.from_arrays([0.0, 0.1, 0.2], steps)
    >>> values = {"M": 0.0, "N": 0.0, "Q": 60.0, "G": 1.0, "offset": 0.0}
    >>> simulate(model, values, log).outputs["angle"].tolist()
    [0.0, 0.5, 1.0]
    """
    theta = parameter_vector(model, values)
    simulated = {name: np.full(len(log), np.nan) for name in log.outputs}
    used = {name: np.zeros(len(log), bool) for name in log.outputs}
    for segment in log.segments():
        start = _start(nuisance, segment.index)
        with np.errstate(all="ignore"):  # what is not finite is told below
            response = model.response(theta, segment, log.outputs, start=start, derivatives=False)
        span = slice(segment.start, segment.stop)
        for name in log.outputs:
            zero = nuisance.zero.get(name, 0.0) if nuisance else 0.0
            simulated[name][span] = segment.samples_of(response.outputs[name]) + zero
            used[name][span] = segment.samples_of(segment.used[name])
            if not np.all(np.isfinite(response.outputs[name])):
                raise IdentificationError(
                    f"the simulated {name} is not finite",
                    where=log.place,
                    remedy="check the parameter values and the unit of the input",
                )
    return _simulation(log, simulated, used)


def simulation_left(log: Log, residuals: Mapping[str, Sequence[Array]]) -> Simulation:
    """The simulation of a log of which a fit has left residuals at every sample.

    Parameters
    ----------
    log
        The log.
    residuals
        Output channel → measured less simulated, one array per segment, shape (n_s,).
    """
    simulated = {name: np.full(len(log), np.nan) for name in log.outputs}
    used = {name: np.zeros(len(log), bool) for name in log.outputs}
    for k, segment in enumerate(log.segments()):
        span = slice(segment.start, segment.stop)
        for name in log.outputs:
            measured = segment.samples_of(segment.outputs[name])
            np.subtract(measured, residuals[name][k], out=simulated[name][span])
            used[name][span] = segment.samples_of(segment.used[name])
    return _simulation(log, simulated, used)


def _simulation(
    log: Log, simulated: Mapping[str, Array], used: Mapping[str, npt.NDArray[np.bool_]]
) -> Simulation:
    return Simulation(
        log=log.name,
        time_s=log.time_s,
        input_name=log.input,
        input=log.channels[log.input].values,
        input_unit=log.channels[log.input].unit,
        outputs=simulated,
        measured={name: log.channels[name].values for name in log.outputs},
        used=used,
        units={name: log.channels[name].unit for name in log.outputs},
        segment_starts=tuple(first for first, _ in log.stretches),
    )


def _start(nuisance: LogNuisance | None, index: int) -> Array | None:
    if nuisance is None or index >= len(nuisance.starts) or nuisance.starts[index].at_rest:
        return None
    return np.array(nuisance.starts[index].state, dtype=np.float64)
