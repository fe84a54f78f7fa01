"""Units in a record against those of its model: an edit by hand may break their agreement."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

from softid.errors import InputError, SoftidError
from softid.units import CANONICAL_UNIT, CHANNEL_QUANTITY, factor_to_canonical

if TYPE_CHECKING:
    from softid.models.base import Model

_FACTOR_TOLERANCE = 1e-9
_REMEDY = "restore {unit!r}: another unit needs the values converted too, so fit again for it"


def require_units(document: Mapping[str, Any], model: Model, *, where: str) -> None:
    """Refuse a record whose units are not those in which its model computes.

    Parameters
    ----------
    document
        Content of params.json, valid by its schema, with known parameters.
    model
        The model that it describes.
    where
        The file.

    Raises
    ------
    InputError
        The unit of a parameter or channel is another, or a channel's display unit and factor
        contradict each other.
    """
    declared = model.parameters()
    for k, entry in enumerate(document["parameters"]):
        _require(entry["unit"], declared[entry["name"]].unit, f"{where}, $.parameters[{k}].unit")
    channels = document["channels"]
    for name in (document["input"], *document["outputs"]):
        if name not in channels:
            raise InputError(
                f"the channel {name} has a role but no unit",
                where=f"{where}, $.channels",
                remedy="restore the file that softid wrote, or fit again",
            )
    for name, entry in channels.items():
        _require_channel(name, entry, where=f"{where}, $.channels.{name}")
    _require_model_units(document["input"], document["outputs"], channels, model, where=where)


def _require(found: str, expected: str, where: str) -> None:
    if found != expected:
        _refuse(
            f"the model computes in {_told(expected)}, not in this unit", where, found, expected
        )


def _require_channel(name: str, entry: Mapping[str, Any], *, where: str) -> None:
    quantity = CHANNEL_QUANTITY.get(name)
    unit = entry["unit"]
    if quantity is not None:
        _require(unit, CANONICAL_UNIT[quantity], f"{where}.unit")
    if "display_unit" not in entry:
        return
    shown, factor = entry["display_unit"], float(entry["display_factor"])
    expected = 1.0
    if quantity is not None:
        try:
            expected = 1.0 / factor_to_canonical(shown, quantity, where=f"{where}.display_unit")
        except SoftidError as error:
            raise InputError(
                error.what, where=error.where, value=shown, remedy="restore the unit of the log"
            ) from error
    elif shown != unit:
        _refuse(f"the channel is in {_told(unit)}", f"{where}.display_unit", shown, unit)
    if not math.isclose(factor, expected, rel_tol=_FACTOR_TOLERANCE):
        raise InputError(
            f"one {unit} is {expected:.12g} {shown}",
            where=f"{where}.display_factor",
            value=factor,
            remedy="correct the factor, or restore the unit of the log",
        )


def _require_model_units(
    input_name: str,
    outputs: Sequence[str],
    channels: Mapping[str, Mapping[str, Any]],
    model: Model,
    *,
    where: str,
) -> None:
    """Raw channels have any unit, but the one that the parameters were made for."""
    units = {"input": channels[input_name]["unit"]}
    units |= {name: channels[name]["unit"] for name in outputs}
    base = getattr(model, "model", model)  # effects have no sense of motion of their own
    try:
        adapted = model.adapted(units, inverted=bool(getattr(base, "inverted", False)))
    except SoftidError as error:
        raise InputError(
            f"the {model.name} model does not take these channels: {error.what}",
            where=f"{where}, $.channels",
            remedy="restore the file that softid wrote, or fit again",
        ) from error
    declared = model.parameters()
    for name, parameter in adapted.parameters().items():
        if name in declared and parameter.unit != declared[name].unit:
            raise InputError(
                f"with these units {name} would be in {_told(parameter.unit)}, but it is in "
                f"{_told(declared[name].unit)}",
                where=f"{where}, $.channels",
                value=", ".join(f"{key} in {unit}" for key, unit in units.items()),
                remedy="restore the units that softid wrote, or fit again",
            )


def _refuse(what: str, where: str, found: str, expected: str) -> NoReturn:
    raise InputError(what, where=where, value=found, remedy=_REMEDY.format(unit=expected))


def _told(unit: str) -> str:
    return "plain numbers" if unit == "1" else unit
