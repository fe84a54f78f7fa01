"""Results to files and back: validated JSON, atomic writes, a simulation as CSV."""

from softid.records.diagnosis import diagnosis_files, save_diagnosis
from softid.records.params import fit_document, save_fit
from softid.records.plain import dump_json, to_jsonable
from softid.records.reading import plot_fingerprints, recorded_plots
from softid.records.saved import SavedModel, load_params
from softid.records.simulated import simulation_csv
from softid.records.validations import save_validation, validation_document
from softid.records.writing import write_atomic, write_folder

__all__ = [
    "SavedModel",
    "diagnosis_files",
    "dump_json",
    "fit_document",
    "load_params",
    "plot_fingerprints",
    "recorded_plots",
    "save_diagnosis",
    "save_fit",
    "save_validation",
    "simulation_csv",
    "to_jsonable",
    "validation_document",
    "write_atomic",
    "write_folder",
]
