"""The model and its parameters as the command line describes them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import click

from softid.errors import SoftidError, UsageError, entry_named
from softid_cli.console import say
from softid_cli.options import FILE, assignments, length_mm, named_if, number

if TYPE_CHECKING:
    from softid.effects import Effect
    from softid.models.base import Model
    from softid.parameters import Parameter, ParameterSet

P = ParamSpec("P")
R = TypeVar("R")

GEOMETRY_MODEL = "equilibrium"
"""The model that a geometry file describes."""

_FLAGS = {
    "damping": "--damping",
    "fixed_length_mm": "--fixed-length",
    "diameter_mm": "--diameter",
}


def model_option(help: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Add ``--model`` (keyword: model)."""
    return click.option("--model", metavar="NAME", help=help)


def shape_options(command: Callable[P, R]) -> Callable[P, R]:
    """Add ``--damping``, the geometry and ``--option`` (keywords as in `chosen_model`, option)."""
    for add in reversed(
        (
            click.option(
                "--damping",
                type=click.Choice(["constant", "exponential"]),
                help="Damping of the muscle model.",
            ),
            click.option(
                "--fixed-length",
                callback=length_mm,
                metavar="MM",
                help="Fixed length of the muscle's arc geometry.",
            ),
            click.option(
                "--diameter",
                callback=length_mm,
                metavar="MM",
                help="Diameter of the muscle's arc geometry.",
            ),
            click.option(
                "--geometry",
                type=FILE,
                metavar="FILE.toml",
                help="Geometry of the equilibrium model.",
            ),
            click.option(
                "--option",
                multiple=True,
                metavar="NAME=VALUE",
                help="Other option of the model, such as order=first; may be repeated.",
            ),
        )
    ):
        command = add(command)
    return command


def chosen_model(
    name: str | None,
    *,
    damping: str | None = None,
    fixed_length_mm: float | None = None,
    diameter_mm: float | None = None,
    geometry: Path | None = None,
    other: Sequence[str] = (),
) -> Model | None:
    """The model that the options describe, or None when softid is to choose.

    Raises
    ------
    UsageError
        There is no such model, or it does not have an option that was given.
    """
    _require_both(fixed_length_mm, diameter_mm)
    written = assignments(other, option="--option", form="NAME=VALUE")
    named = {
        "damping": damping,
        "fixed_length_mm": fixed_length_mm,
        "diameter_mm": diameter_mm,
    }
    flags = {key: value for key, value in named.items() if value is not None}
    given: dict[str, str | float] = {**written, **flags}
    if name is None and not given:
        return None

    from softid.models import MODELS
    from softid.models.option_kinds import option_kinds, option_value

    if geometry is not None:
        name = name or GEOMETRY_MODEL
        given = described(geometry, name) | given
    if name is None:
        name = _only_owner(given)
    _require_options(name, given)
    kinds = option_kinds(MODELS[name])
    read = {k: option_value(t, kinds[k], where=f"--option {k}") for k, t in written.items()}
    options: dict[str, Any] = {**given, **read, **flags}
    try:
        return MODELS[name](**options)
    except SoftidError as error:
        typed = {option: f"--option {option}" for option in written}
        typed |= {option: _FLAGS[option] for option in flags}
        raise of_an_option(error, typed) from error


def of_an_option(error: SoftidError, typed: Mapping[str, str]) -> SoftidError:
    """A refusal by the library as one of the option that it is about, if the user typed that one.

    Parameters
    ----------
    error
        What the library said; it names what is wrong by its own word.
    typed
        Word of the library → option that was typed; the first that was named counts.
    """
    words = re.findall(r"\w+", f"{error.where} {error.what}")
    about = [flag for option, flag in typed.items() if option in words]
    if not about:
        return error
    return UsageError(error.what, where=about[0], value=error.value, remedy=error.remedy)


def _flag(option: str) -> str:
    return _FLAGS.get(option, f"--option {option}")


def _require_options(name: str, given: Mapping[str, object]) -> None:
    """Refuse a model that does not exist, and options that it lacks or that are not chosen."""
    from softid.models import MODELS

    model = entry_named(name, MODELS, unknown="there is no such model", where="--model")
    own = {f.name for f in fields(model)}
    known = {option for option in own if not follows_from_logs(option)}
    for option in given:
        if option in own - known:
            raise UsageError(
                "this follows from the logs and cannot be chosen",
                where=f"--option {option}",
                value=given[option],
                remedy="leave it out",
            )
        if option not in known:
            raise UsageError(
                f"the {name} model has no such option",
                where=_flag(option),
                remedy=f"its options are {', '.join(sorted(known))}",
            )


def _only_owner(given: Mapping[str, object]) -> str:
    """The one model that has all of the options."""
    from softid.models import MODELS

    owners = [k for k, m in MODELS.items() if given.keys() <= {f.name for f in fields(m)}]
    if len(owners) == 1:
        return owners[0]
    raise UsageError(
        "several models have these options" if owners else "no model has all of these options",
        where=", ".join(map(_flag, given)),
        remedy=f"name the model with --model, one of {', '.join(owners or MODELS)}",
    )


def _require_both(fixed_length_mm: float | None, diameter_mm: float | None) -> None:
    if (fixed_length_mm is None) == (diameter_mm is None):
        return
    there, missing = ("--diameter", "--fixed-length")
    if diameter_mm is None:
        there, missing = missing, there
    raise UsageError(
        "the arc geometry needs both lengths",
        where=there,
        remedy=f"give {missing} too, or neither",
    )


def warn_of_assumptions(model: Model | None, geometry: Path | None, *, quiet: bool) -> None:
    """Say before a fit of minutes what its result would say: nobody measured the dimensions."""
    if quiet or geometry is not None or model is None or model.name != GEOMETRY_MODEL:
        return
    from softid.models.actuator_geometry import Actuator
    from softid.models.equilibrium_cautions import assumed_geometry

    if isinstance(model, Actuator):
        for issue in assumed_geometry(model):
            say(f"warning: {issue.message}; {issue.remedy}")


def follows_from_logs(option: str) -> bool:
    """Units and the sense of the motion are taken from the channels at every fit."""
    return option.endswith("_unit") or option == "inverted"


def require_parameters(model: Model | None, names: Sequence[str], *, option: str) -> None:
    """Refuse names that the model does not have, if it is known before the work which one it is.

    Raises
    ------
    UsageError
        A name is none of the model's parameters.
    """
    if model is not None:
        declared = model.parameters()
        for name in names:
            _known(declared, name, option=option)


def described(geometry: Path, name: str) -> dict[str, str | float]:
    """Options of a model from a geometry file.

    Raises
    ------
    InputError
        The file is wrong.
    UsageError
        The model has no geometry of that kind.
    """
    from softid.models.actuator_geometry import load_actuator

    if name != GEOMETRY_MODEL:
        raise UsageError(
            f"the {name} model takes no geometry file",
            where="--geometry",
            value=str(geometry),
            remedy=f"leave it out, or name --model {GEOMETRY_MODEL}",
        )
    return asdict(load_actuator(geometry))


def described_models(geometry: Path | None) -> tuple[Model, ...]:
    """Models that a geometry file describes; none without a file."""
    if geometry is None:
        return ()

    from softid.models import MODELS

    options: dict[str, Any] = {**described(geometry, GEOMETRY_MODEL)}
    return (MODELS[GEOMETRY_MODEL](**options),)


def chosen_parameters(
    model: Model | None, *, fix: Sequence[str], bound: Sequence[str], tie: Sequence[str]
) -> ParameterSet | None:
    """The model's parameters with what is fixed, bounded and tied; None when nothing is.

    Raises
    ------
    UsageError
        A text is malformed, names an unknown parameter, or the model was not named.
    """
    if not (fix or bound or tie):
        return None
    if model is None:
        raise UsageError(
            "parameters have no meaning before the model is chosen",
            where=", ".join(named_if({"--fix": fix, "--bound": bound, "--tie": tie})),
            remedy="name the model with --model",
        )
    declared = model.parameters()
    for name, text in assignments(bound, option="--bound", form="NAME=LO:HI").items():
        parameter = _known(declared, name, option="--bound")
        if parameter.fixed:
            raise UsageError(
                f"the model holds {name} at {parameter.value:g} with these options",
                where=f"--bound {name}",
                value=text,
                remedy="leave it out, or choose other options of the model",
            )
        declared = declared.replacing(_bounded(parameter, text))
    for name, text in assignments(tie, option="--tie", form="NAME=EXPR").items():
        parameter = _known(declared, name, option="--tie")
        declared = declared.replacing(_tied(parameter, text))
    if tie:
        declared.to_lmfit()
    held = {}
    for name, text in assignments(fix, option="--fix", form="NAME=VALUE").items():
        parameter = _known(declared, name, option="--fix")
        if parameter.tie is not None:
            raise UsageError(
                f"{name} is fixed and tied at once",
                where="--fix, --tie",
                remedy="give only one of both",
            )
        held[name] = number(text, where=f"--fix {name}")
        if parameter.scale == "log" and held[name] <= 0:
            raise UsageError(
                "this parameter must be positive",
                where=f"--fix {name}",
                value=held[name],
                remedy=_positive_or_dropped(model, name),
            )
    return declared.with_fixed(held)


def _positive_or_dropped(model: Model, name: str) -> str:
    from softid.models.dropped_parameters import option_that_drops

    found = option_that_drops(model, name)
    if found is None:
        return "give a positive value"
    option, choice = found
    joint = " " if option in _FLAGS else "="
    return f"give a positive value, or drop its term with {_flag(option)}{joint}{choice}"


def _known(parameters: ParameterSet, name: str, *, option: str) -> Parameter:
    if name not in parameters:
        raise UsageError(
            "the model has no such parameter",
            where=option,
            value=name,
            remedy=f"choose from {', '.join(parameters.names)}",
        )
    return parameters[name]


def _bounded(parameter: Parameter, text: str) -> Parameter:
    low, colon, high = text.partition(":")
    if not colon:
        raise UsageError(
            "this is not of the form LO:HI",
            where=f"--bound {parameter.name}",
            value=text,
            remedy="write both ends with a colon between them, either end may be empty",
        )
    lower, upper = parameter.lower, parameter.upper
    if low.strip():
        lower = number(low.strip(), where=f"--bound {parameter.name}")
    if high.strip():
        upper = number(high.strip(), where=f"--bound {parameter.name}")
    inside = min(max(parameter.value, lower), max(lower, upper))
    return replace(parameter, lower=lower, upper=upper, value=inside)


def _tied(parameter: Parameter, expression: str) -> Parameter:
    from softid.tie_expressions import names_in_tie

    where = f"--tie {parameter.name}"
    if not names_in_tie(expression, where=where):
        raise UsageError(
            "no other parameter is in the expression",
            where=where,
            value=expression,
            remedy=f"write --fix {parameter.name}=VALUE to hold it at a value",
        )
    return replace(parameter, tie=expression, fixed=False)


def chosen_effects(names: Sequence[str], *, where: str | None = None) -> tuple[Effect, ...]:
    """The effects of some names; without any, the whole catalogue.

    Raises
    ------
    UsageError
        A name is none of the catalogue's, to which a script alone can add.
    """
    from softid.effects import EFFECTS, effects_of, proposed_effects

    for name in names:
        if name not in EFFECTS:
            raise UsageError(
                "there is no such effect", where=where, value=name, remedy=proposed_effects(name)
            )
    return effects_of(names)
