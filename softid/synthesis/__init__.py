"""Logs with known truth: recipes, an independent integration of the textbook laws, sensors."""

from softid.synthesis.actuators import Actuator, Sizes, random_actuator
from softid.synthesis.bundle import (
    DataSet,
    bundled_datasets,
    bundled_recipes,
    check_dataset,
    make_dataset,
    write_dataset,
)
from softid.synthesis.hidden import HIDDEN, names_of
from softid.synthesis.hidden_base import Hidden
from softid.synthesis.hidden_files import truth_document, write_hidden_pair
from softid.synthesis.hidden_log import HiddenLog, HiddenPair, hidden_log, hidden_pair
from softid.synthesis.laws import Arc
from softid.synthesis.manifest import KnownLog, read_manifest
from softid.synthesis.protocols import PROTOCOLS, Protocol
from softid.synthesis.random_truth import muscle_log, random_muscle_truth
from softid.synthesis.recipe import Recipe, load_recipe
from softid.synthesis.rig import Rig
from softid.synthesis.sensors import Sampling, Sensor
from softid.synthesis.synthetic import SyntheticLog, synthesize, to_csv_bytes
from softid.synthesis.truth import Valve

__all__ = [
    "HIDDEN",
    "PROTOCOLS",
    "Actuator",
    "Arc",
    "DataSet",
    "Hidden",
    "HiddenLog",
    "HiddenPair",
    "KnownLog",
    "Protocol",
    "Recipe",
    "Rig",
    "Sampling",
    "Sensor",
    "Sizes",
    "SyntheticLog",
    "Valve",
    "bundled_datasets",
    "bundled_recipes",
    "check_dataset",
    "hidden_log",
    "hidden_pair",
    "load_recipe",
    "make_dataset",
    "muscle_log",
    "names_of",
    "random_actuator",
    "random_muscle_truth",
    "read_manifest",
    "synthesize",
    "to_csv_bytes",
    "truth_document",
    "write_dataset",
    "write_hidden_pair",
]
