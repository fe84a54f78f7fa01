"""All effects that can be hidden in a synthetic log, by name."""

from __future__ import annotations

from softid.errors import entry_named
from softid.synthesis.hidden_base import Hidden
from softid.synthesis.hidden_heat import HEAT
from softid.synthesis.hidden_inputs import INPUTS
from softid.synthesis.hidden_motions import MOTIONS
from softid.synthesis.hidden_outputs import OUTPUTS
from softid.synthesis.hidden_random import RANDOM
from softid.synthesis.hidden_sensors import SENSORS
from softid.synthesis.hidden_springs import SPRINGS
from softid.synthesis.hidden_strange import OTHER_FORMS, OUTSIDE

ENTRIES: tuple[Hidden, ...] = (
    *INPUTS,
    *MOTIONS,
    *OTHER_FORMS,
    *OUTSIDE,
    *SPRINGS,
    *HEAT,
    *OUTPUTS,
    *SENSORS,
    *RANDOM,
)
"""All of them, each with a name of its own."""

HIDDEN: dict[str, Hidden] = {hidden.name: hidden for hidden in ENTRIES}


def names_of(relation: str) -> tuple[str, ...]:
    """Names of one relation to the catalogue of effects.

    Parameters
    ----------
    relation
        ``"catalogue"``, ``"other_form"`` or ``"outside"``.

    Examples
    --------
    >>> "pleats" in names_of("outside")
    True
    """
    return tuple(name for name, hidden in HIDDEN.items() if hidden.relation == relation)


def hidden_named(name: str) -> Hidden:
    """The entry of a name.

    Raises
    ------
    UsageError
        There is no such effect; the error lists all.
    """
    return entry_named(name, HIDDEN, unknown="no effect of this name can be hidden")
