"""One call from a file to a log."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from softid.given_values import require_names
from softid.log import Log, Source
from softid.readers.assignment import find_channels
from softid.readers.cleaning import clean
from softid.readers.files import require_file
from softid.readers.formats import READERS, split_suffix
from softid.readers.merging import with_rows_of
from softid.readers.roles import choose_roles, fallback_issues
from softid.readers.samples import Samples
from softid.readers.sidecar import Sidecar, find_sidecar, read_sidecar


def load(
    path: str | os.PathLike[str],
    *,
    channels: Mapping[str, str] | None = None,
    input: str | None = None,
    outputs: Sequence[str] | None = (),
    sidecar: str | os.PathLike[str] | None = None,
    time_unit: str | None = None,
    roles_of: str | None = None,
) -> Log:
    r"""Read a log from a file.

    Columns are recognised by name and unit; ``channels`` beats the sidecar, the sidecar beats the
    names. Every other column of numbers becomes a raw channel under its own name, which can be
    input or output too.

    Parameters
    ----------
    path
        CSV or text (also gzip-compressed), MAT, NPZ, Parquet, or a ROS bag (``.bag``, ``.db3`` or
        ``.mcap``).
    channels
        Channel name → ``"COLUMN[:UNIT]"``, a column being a name or a number from 1 and a unit
        possibly with the value of one count before it: ``{"force": "vir:35.15*N"}``. Where a
        message asks for ``--channel angle=tip:deg``, this is ``{"angle": "tip:deg"}``.
    input
        Channel that drives; by default the pressure, else the commanded pressure, else a force on
        something with a position.
    outputs
        Channels to explain; by default the first of the motion channels. None for a log that only
        drives a simulation, where nothing needs to be measured.
    sidecar
        TOML file that says the same; by default the one beside the log, if there is one.
    time_unit
        Unit of the time column, whatever the header or the sidecar says.
    roles_of
        What ``input`` and ``outputs`` come from, such as ``"the model params.json"``, so that a log
        that lacks one of them is at fault and not the request.

    Returns
    -------
    Log
        With times in s, known channels in their canonical units, and issues that say what was
        dropped or left out.

    Raises
    ------
    InputError
        The file cannot be read, or its columns, units or times cannot be settled without asking.
    UsageError
        A role that you gave names no channel, or ``channels`` a column, a unit or a channel that
        is none.
    MissingExtraError
        The format needs a package that is not installed.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "step.csv")
    ...     _ = file.write_text("t_ms;P [bar];theta [deg]\n0;0,0;0\n20;1,5;30\n40;1,5;45\n")
    ...     log = load(file)
    >>> log.input, log.outputs, log.pressure_kpa.tolist()
    ('pressure', ('angle',), [0.0, 150.0, 150.0])
    """
    named = None if outputs is None else require_names(outputs, where="outputs")
    file = Path(path)
    require_file(file)
    stem, suffix = split_suffix(file)
    said = _sidecar(file, stem, sidecar)
    table = READERS[suffix](file)
    wanted_input = input or said.input
    wanted_outputs = None if named is None else named or said.outputs
    found = find_channels(
        table,
        flags=channels or {},
        sidecar=said,
        time_unit=time_unit,
        needed={*(wanted_outputs or ()), wanted_input or ""},
    )
    where = table.head.path
    driving, explained = choose_roles(
        found,
        input=wanted_input,
        outputs=wanted_outputs,
        where=where,
        input_of=roles_of if input else f"the sidecar {said.path}",
        outputs_of=roles_of if named else f"the sidecar {said.path}",
    )
    asked = [*(channels or {}), *said.channels]
    fallback = () if wanted_outputs else fallback_issues(found, asked, driving, explained)
    raw = Samples(where, table.row_word, table.rows, found.times.seconds, found.channels)
    raw = with_rows_of(raw, table, (driving, *explained))
    samples = clean(raw, input=driving, outputs=explained)
    return Log(
        name=stem,
        time_s=samples.time_s,
        channels=samples.channels,
        input=driving,
        outputs=explained,
        source=Source(where, table.head.sha256, table.head.file_format),
        issues=(*table.head.issues, *found.issues, *fallback, *samples.issues),
        metadata={**table.head.metadata, **found.times.metadata, **said.metadata},
        input_read_s=samples.input_read_s,
        input_read_range=samples.input_read_range,
    )


def _sidecar(file: Path, stem: str, given: str | os.PathLike[str] | None) -> Sidecar:
    path = Path(given) if given is not None else find_sidecar(file, stem)
    return read_sidecar(path) if path is not None else Sidecar()
