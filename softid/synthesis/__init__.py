"""Logs with known truth: recipes, an independent integration of the textbook laws, sensors."""

from softid.synthesis.bundle import (
    DataSet,
    bundled_datasets,
    bundled_recipes,
    check_dataset,
    make_dataset,
    write_dataset,
)
from softid.synthesis.laws import Arc
from softid.synthesis.manifest import KnownLog, read_manifest
from softid.synthesis.random_truth import muscle_log, random_muscle_truth
from softid.synthesis.recipe import Recipe, load_recipe
from softid.synthesis.sensors import Sampling, Sensor
from softid.synthesis.synthetic import SyntheticLog, synthesize, to_csv_bytes
from softid.synthesis.truth import Valve

__all__ = [
    "Arc",
    "DataSet",
    "KnownLog",
    "Recipe",
    "Sampling",
    "Sensor",
    "SyntheticLog",
    "Valve",
    "bundled_datasets",
    "bundled_recipes",
    "check_dataset",
    "load_recipe",
    "make_dataset",
    "muscle_log",
    "random_muscle_truth",
    "read_manifest",
    "synthesize",
    "to_csv_bytes",
    "write_dataset",
]
